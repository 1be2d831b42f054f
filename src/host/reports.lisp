;;;; reports.lisp -- what is added to the reports of Lisp's own errors, in whatever debugger.

(in-package :ars-magna.host)

(export '(*report-addition*))

;;; A debugger of Lisp's or of an editor writes a report as PRINC does.

(defvar *report-addition* (constantly nil)
  "A function of an error of Lisp's own that returns a sentence to stand behind its report, or
NIL.")

(defun write-addition (condition stream)
  "Write behind the report of CONDITION what *REPORT-ADDITION* returns for it, if anything."
  (unless *print-escape*
    (let ((text (ignore-errors (funcall *report-addition* condition))))
      (when text (format stream "~&~A" text)))))

(defmethod print-object :after ((condition undefined-function) stream)
  (write-addition condition stream))

(defmethod print-object :after ((condition unbound-variable) stream)
  (write-addition condition stream))

(defmethod print-object :after ((condition reader-error) stream)
  (write-addition condition stream))

(defmethod print-object :after ((condition type-error) stream)
  (write-addition condition stream))
