;;;; writing.lisp -- writing a file anew, or saying in a sentence why that cannot be.

(in-package :ars-magna.base)

(defun write-file-anew (function file what)
  "Do as CALL-REPLACING-FILE does with FUNCTION and FILE. Signals MISUSE if WHAT, such as
\"the run\", cannot be written there; then FILE is as it was."
  (handler-case (call-replacing-file function file)
    (ars-magna-error (trouble) (error trouble))
    (error (trouble)
      (reject-use "~@(~A~) cannot be written to ~A: ~A. What was there is as before."
                  what (cut (princ-to-string (shown-name file)) 200)
                  (cut (one-line-text trouble) 200)))))
