;;;; reports.lisp -- what is added to the reports of Lisp's own errors, in whatever debugger.

(in-package :ars-magna.host)

(export '(*report-addition*))

;;; A debugger of Lisp's or of an editor writes a report as PRINC does.

(defvar *report-addition* (constantly nil)
  "A function of an error of Lisp's own that returns a sentence to stand behind its report, or
NIL.")

(defun write-addition (condition stream)
  (unless *print-escape*
    (let ((text (ignore-errors (funcall *report-addition* condition))))
      (when text (format stream "~&~A" text)))))

(macrolet ((define-additions (&rest types)
             `(progn ,@(loop for type in types
                             collect `(defmethod print-object :after ((condition ,type) stream)
                                        (write-addition condition stream))))))
  (define-additions undefined-function unbound-variable reader-error type-error))
