;;;; exits.lisp -- code that would end the Lisp in which it runs together with others'.

(in-package :ars-magna.basics)

(export '(call-refusing-exits refuse-exits call-allowing-exits))

(defvar *refusal* nil
  "What is said, a string, while code runs that is not to end this Lisp; else NIL.")

(defun refuse-exit (function &rest arguments)
  "Apply FUNCTION, which ends this Lisp, to ARGUMENTS. Signals MISUSE if that is refused."
  (when *refusal*
    (reject-use "~A" *refusal*))
  (apply function arguments))

(wrap-function 'sb-ext:exit #'refuse-exit)

(defun call-refusing-exits (function &optional (text "EXIT would end the whole program here. ~
                                                        Signal an error instead, or return."))
  "Call FUNCTION, in which EXIT signals MISUSE, with TEXT."
  (let ((*refusal* (format nil text))) (funcall function)))

(defun refuse-exits (text)
  "Let EXIT signal MISUSE with TEXT in each thread of this Lisp, where nothing else is said; or with
NIL end this Lisp again."
  (setf (global-value '*refusal*) text))

(defun call-allowing-exits (function)
  "Call FUNCTION, in which EXIT ends this Lisp, whatever goes on around it."
  (let ((*refusal* nil)) (funcall function)))
