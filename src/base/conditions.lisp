;;;; conditions.lisp -- what goes wrong when the simulator is misused.

(in-package :ars-magna.base)

;;; A misused library signals one of these. A robot that fails in a task does not: it
;;; reports an error code through its command's continuation (manual 3.1.1).

(addition ars-magna-error)
(define-condition ars-magna-error (error)
  ()
  (:documentation "The root of every error that ARS MAGNA signals."))

(addition wrong-argument)
(define-condition wrong-argument (ars-magna-error)
  ((operator :initarg :operator :reader wrong-argument-operator)
   (name     :initarg :name     :reader wrong-argument-name)
   (value    :initarg :value    :reader wrong-argument-value)
   (expected :initarg :expected :reader wrong-argument-expected))
  (:report (lambda (condition stream)
             (format stream "~(~A~): ~(~A~) is ~S; give ~A."
                     (wrong-argument-operator condition)
                     (wrong-argument-name condition)
                     (wrong-argument-value condition)
                     (wrong-argument-expected condition))))
  (:documentation "A function was called with an argument that it cannot use."))

(defun reject-argument (operator name value expected)
  "Signal WRONG-ARGUMENT."
  (error 'wrong-argument :operator operator :name name :value value :expected expected))

(defmacro check-argument (operator place test expected)
  "Signal WRONG-ARGUMENT unless TEST holds; EXPECTED says in words what PLACE should be."
  `(unless ,test (reject-argument ',operator ',place ,place ,expected)))

(addition malformed-definition)
(define-condition malformed-definition (ars-magna-error)
  ((definition :initarg :definition :reader malformed-definition-definition)
   (clause     :initarg :clause     :reader malformed-definition-clause)
   (expected   :initarg :expected   :reader malformed-definition-expected))
  (:report (lambda (condition stream)
             (let ((*print-case* :downcase))
               (format stream "~A: cannot use the clause~%  ~S~%Expected ~A."
                       (malformed-definition-definition condition)
                       (malformed-definition-clause condition)
                       (malformed-definition-expected condition)))))
  (:documentation "A defining form (DEFMAP, DEFROBOT ...) has a clause that makes no sense."))

(defun reject-clause (definition clause expected)
  "Signal MALFORMED-DEFINITION about CLAUSE of DEFINITION (a string such as \"defmap watson\")."
  (error 'malformed-definition :definition definition :clause clause :expected expected))

(addition unknown-name)
(define-condition unknown-name (ars-magna-error)
  ((kind    :initarg :kind    :reader unknown-name-kind)
   (name    :initarg :name    :reader unknown-name-name)
   (nearest :initarg :nearest :initform nil :reader unknown-name-nearest)
   (known   :initarg :known   :initform '() :reader unknown-name-known))
  (:report (lambda (condition stream)
             (format stream "There is no ~A called ~S.~@[ Did you mean ~A?~]~
                             ~@[ Known: ~{~A~^, ~}.~]"
                     (unknown-name-kind condition)
                     (unknown-name-name condition)
                     (unknown-name-nearest condition)
                     (unknown-name-known condition))))
  (:documentation "A name was given that nothing of that kind has."))

(addition misuse)
(define-condition misuse (ars-magna-error)
  ((text :initarg :text :reader misuse-text))
  (:report (lambda (condition stream) (write-string (misuse-text condition) stream)))
  (:documentation "An operation was asked for at a moment or in a state that forbids it."))

(defun reject-use (control &rest arguments)
  "Signal MISUSE with a text formatted from CONTROL and ARGUMENTS; it should name the remedy."
  (error 'misuse :text (apply #'format nil control arguments)))
