;;;; asking.lisp -- a program that reads what is typed, as (READ) does, says so.

(in-package :ars-magna.cli)

(export '(tell-asking))

;;; What is typed next is for the program then, and for the prompt only after that.

(defgeneric tell-asking (console)
  (:documentation "Let the user of CONSOLE know that a program reads what he types next.")
  (:method ((console console))
    (unless (shiftf (console-asking-told-p console) t)
      (write-fitted console "A program waits for your answer; control-C ends the program.~%"))
    (finish-output console)))

(defun call-asking (console function)
  "Call FUNCTION, which lets a program read a line that is typed on CONSOLE."
  ;; A question that the program has written stands before the line.
  (when (zerop (console-column console)) (write-string "Answer> " console))
  (setf (console-asked-p console) t)
  (unwind-protect (funcall function)
    (setf (console-asked-p console) nil)))
