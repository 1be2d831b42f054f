;;;; contradictions.lisp -- objects that were put together from a file, found to make no sense.

(in-package :ars-magna.copying)

(export '(contradiction contradict must-hold proper-list-of-p))

;;; What is put together from a file may contradict itself. Each layer checks its own kinds: nothing
;;; of a run that was read is used before all of it has been looked at.

(define-condition contradiction (error)
  ((text :initarg :text :reader contradiction-text))
  (:report (lambda (condition stream) (write-string (contradiction-text condition) stream)))
  (:documentation "Objects that belong together do not fit each other."))

(defun contradict (control &rest arguments)
  "Signal a CONTRADICTION with a text formatted from CONTROL and ARGUMENTS."
  (error 'contradiction :text (apply #'format nil control arguments)))

(defmacro must-hold (test control &rest arguments)
  "Signal a CONTRADICTION with a text formatted from CONTROL and ARGUMENTS unless TEST holds."
  `(unless ,test (contradict ,control ,@arguments)))

(defun proper-list-of-p (predicate object)
  "True if OBJECT is a list that ends, and PREDICATE is true of each of its elements."
  (and (proper-list-p object) (every predicate object)))
