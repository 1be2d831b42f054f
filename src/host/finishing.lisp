;;;; finishing.lisp -- what has been begun is finished, however that is left.

(in-package :ars-magna.host)

(export '(in-any-case call-opening call-each))

(declaim (inline call-opening))
(defun call-opening (open-p function)
  "Call FUNCTION, in which this thread can be interrupted if OPEN-P."
  (if open-p
      (call-allowing-interrupts function)
      (funcall (the function function))))

(defun call-in-any-case (first &rest others)
  "Do what IN-ANY-CASE does with functions for its forms."
  (declare (dynamic-extent others))
  (let ((open-p (not (held-off-p))))
    (labels ((call-rest (functions)
               (when functions
                 (unwind-protect (funcall (the function (first functions)))
                   (call-rest (rest functions))))))
      (deferring-interrupts
        (unwind-protect (call-opening open-p first)
          (call-rest others))))))

;; See PROTECTING-STRICTLY. That is for little work that is done often, and lets nothing in.
(defmacro in-any-case (&body forms)
  "Run FORMS in order, those that follow also if one is left, as by THROW; interrupts of this thread
wait for the end of these, but at waits and in users' code. Return the values of the first."
  (let ((names (loop for nil in forms collect (gensym "PART"))))
    `(flet ,(loop for name in names
                  for form in forms
                  collect `(,name () ,form))
       (declare (dynamic-extent ,@(loop for name in names collect `(function ,name))))
       (call-in-any-case ,@(loop for name in names collect `(function ,name))))))

(defun call-each (function list)
  "Call FUNCTION with each element of LIST in order, with the rest also if a call is left."
  (unwind-protect (loop while list do (funcall function (pop list)))
    (when list (call-each function list))))
