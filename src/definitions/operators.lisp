;;;; operators.lisp -- what can be asked of a run, by name, and what it can be asked with.

(in-package :ars-magna.definitions)

(export '(define-argument-type argument-type-text argument-of-type-p find-argument-type
          argument-type-like trouble-with perhaps-degrees-p degrees-advice check-of-type
          define-operator check-operands find-operator))

(defstruct (argument-type (:constructor make-argument-type (name predicate words trouble))
                          (:copier nil))
  "A kind of argument: a test for it, and what it is in words. TROUBLE, if any, is a function that
returns in words what is wrong with a value that is none, or NIL."
  (name nil :type symbol :read-only t)
  (predicate nil :type function :read-only t)
  (words "" :type string :read-only t)
  (trouble nil :type (or null function) :read-only t))

(define-registry argument-type "argument type" :object-p argument-type-p :fixed t :internal t)

(defun define-argument-type (name predicate text &optional trouble)
  "Let NAME be an argument type: what satisfies PREDICATE, which TEXT says in words. TROUBLE is a
function that returns in words what is wrong with a value, or NIL for no more than TEXT."
  (register *argument-types* name (make-argument-type name predicate text trouble))
  name)

(defun argument-type-like (name)
  "Return the name of the argument type that NAME, a symbol, may be a slip for, or NIL."
  (find-if (lambda (known) (resembles-p name known))
           (mapcar #'argument-type-name (all-argument-types))))

(defun argument-of-type-p (value type)
  "True if VALUE can be an argument of TYPE, an argument type or the name of one."
  (funcall (argument-type-predicate (find-argument-type type)) value))

(defun trouble-with (value type)
  "Return in words what is wrong with VALUE as an argument of TYPE, an argument type or the name of
one; NIL if there is no more to say than what such arguments are."
  (let ((trouble (argument-type-trouble (find-argument-type type))))
    (and trouble (funcall trouble value))))

(defun argument-type-text (type &optional (value nil value-p))
  "Return in words what an argument of TYPE, an argument type or the name of one, is, and what is
wrong with VALUE."
  (format nil "~A~@[: ~A~]" (argument-type-words (find-argument-type type))
          (and value-p (trouble-with value type))))

(defun check-of-type (operator name value type)
  "Signal WRONG-ARGUMENT, by OPERATOR and of its argument NAME, unless VALUE is of TYPE."
  (unless (argument-of-type-p value type)
    (reject-argument operator name value (argument-type-text type value))))

;;; One for each kind of number; see basics/conditions.lisp for the limits.

(define-argument-type 'number #'within-reason-p "a number from -1e9 to 1e9")
(define-argument-type 'angle #'within-reason-p "an angle in radians, from -1e9 to 1e9")
(define-argument-type 'metres #'within-reason-p "a number of metres, from -1e9 to 1e9")
(define-argument-type 'speed #'within-reason-p "a speed in metres per tick, from -1e9 to 1e9")
(define-argument-type 'ticks #'within-reason-p "a number of ticks, from -1e9 to 1e9")
(define-argument-type 'tick-span #'tick-span-p "a whole number of ticks, from 0 to 1e9")
(define-argument-type 'quantity #'quantity-p "a number from -1e15 to 1e15")
(define-argument-type 'amount #'amount-p "a number not below 0, up to 1e15")
(define-argument-type 'probability #'probability-p "a probability from 0 to 1")
(define-argument-type 'integer #'integerp "a whole number")
(define-argument-type 'truth (constantly t) "anything, of which NIL is false")
(define-argument-type 'datum (constantly t) "anything")
(define-argument-type 'name (lambda (value) (and value (typep value '(or symbol string))))
  "a name, a symbol or string")
(define-argument-type 'keyword #'keywordp "a keyword")
(define-argument-type 'function #'functionp "a function")

;;; Radians.

(defun perhaps-degrees-p (angle)
  "True if ANGLE, in radians, is more than a whole turn, and was perhaps meant in degrees: it is no
whole number of these, as what was said in degrees, or by pi, is."
  (and (< (* 2 pi) (abs angle))
       (let ((degrees (* angle (/ 180 pi))))
         (< 1d-6 (abs (- degrees (fround degrees)))))))

(defun degrees-advice (angle)
  "Return in words what ANGLE, in radians and perhaps meant in degrees, is, and what to write."
  (let ((number (if (integerp angle) angle (format nil "~,2F" angle))))
    (format nil "~A radians are ~,1F whole turns. If ~A degrees are meant, write ~
                 (* ~A (/ pi 180)), or at the prompt ~A deg."
            number (/ (abs angle) 2 pi) number number number)))

;;;; Operators: all that a journal may do

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
