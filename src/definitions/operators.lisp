;;;; operators.lisp -- what can be asked of a run, by name: all that a journal may do.

(in-package :ars-magna.definitions)

(export '(define-operator check-operands find-operator))

;;; An operator says what its arguments are, and how it is done again when a journal is replayed.
;;; Nothing else is ever called because a journal says so.

(define-record (askable (:conc-name operator-)
                        (:constructor make-operator (name types rest function))
                        (:predicate operator-p))
  "Something that can be asked of a run."
  (name nil symbol "the name of the operator, a symbol" :export)
  (types '() list "the types of the arguments")
  (rest nil symbol "the type of any further arguments, or NIL")
  (function nil function "the function of the operator's arguments that asks it again" :export))

(define-registry operator "operator" :object-p operator-p :fixed t :internal t)

(defun define-operator (name types function &key rest)
  "Let NAME be an operator that takes arguments of TYPES, names of argument types, and of the type
REST after them, if that is given. FUNCTION, of these, asks it again in the current simulation."
  (register *operators* name (make-operator name types rest function))
  name)

(defun check-operands (operator arguments)
  "Signal WRONG-ARGUMENT unless OPERATOR takes ARGUMENTS, a list."
  (let ((types (operator-types operator)) (name (operator-name operator)))
    (unless (and (<= (length types) (length arguments))
                 (or (operator-rest operator) (= (length types) (length arguments))))
      (reject-argument name "argument list" arguments
                       (format nil "~:[~;at least ~]~D argument~:P"
                               (operator-rest operator) (length types))))
    (loop for argument in arguments
          for number from 1
          for rest = types then (rest rest)
          for type = (if rest (first rest) (operator-rest operator))
          do (check-of-type name (format nil "argument ~D" number) argument type))))
