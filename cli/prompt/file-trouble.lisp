;;;; file-trouble.lisp -- where in a user's file something is wrong.

(in-package :ars-magna.cli)

(define-condition file-trouble (ars-magna-error)
  ((file  :initarg :file  :reader file-trouble-file)
   (line  :initarg :line  :reader file-trouble-line)
   (cause :initarg :cause :reader file-trouble-cause))
  (:report (lambda (condition stream)
             (format stream "~A, line ~D: ~A"
                     (file-trouble-file condition) (file-trouble-line condition)
                     (condition-text (file-trouble-cause condition)))))
  (:documentation "A form in a file that is being loaded has failed; those before it have not."))
