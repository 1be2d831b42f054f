;;;; exits.lisp -- code that would end the Lisp in which it runs together with others'.

(in-package :ars-magna.base)

(defvar *exits-refused-p* nil
  "True while code runs that is not to end this Lisp.")

(defun refuse-exit (function &rest arguments)
  "Apply FUNCTION, which ends this Lisp, to ARGUMENTS. Signals MISUSE if that is refused."
  (when *exits-refused-p*
    (reject-use "EXIT would end the whole program here. Signal an error instead, or return."))
  (apply function arguments))

(wrap-function 'sb-ext:exit #'refuse-exit)

(defun call-refusing-exits (function)
  "Call FUNCTION, in which EXIT signals MISUSE."
  (let ((*exits-refused-p* t)) (funcall function)))

(defun call-allowing-exits (function)
  "Call FUNCTION, in which EXIT ends this Lisp, whatever goes on around it."
  (let ((*exits-refused-p* nil)) (funcall function)))
