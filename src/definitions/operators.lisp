;;;; operators.lisp -- the requests that a run accepts, by name, and the types of their arguments.

(in-package :ars-magna.definitions)

(export '(define-argument-type argument-type-text argument-of-type-p find-argument-type
          similar-argument-type argument-trouble-text perhaps-degrees-p degrees-advice
          check-argument-type define-operator check-operands find-operator))

(defstruct (argument-type (:constructor make-argument-type (name predicate words trouble))
                          (:copier nil))
  "A type of arguments: a predicate, descriptive WORDS, and TROUBLE as in DEFINE-ARGUMENT-TYPE."
  (name nil :type symbol :read-only t)
  (predicate nil :type function :read-only t)
  (words "" :type string :read-only t)
  (trouble nil :type (or null function) :read-only t))

(define-registry argument-type "argument type" :object-p argument-type-p :fixed t :internal t)

(defun define-argument-type (name predicate text &optional trouble)
  "Define the argument type NAME, of values for which PREDICATE is true. TEXT describes such a
value. TROUBLE is NIL if TEXT says enough, or a function that returns a text about a wrong value."
  (register *argument-types* name (make-argument-type name predicate text trouble))
  name)

(defun similar-argument-type (name)
  "Return the name of an argument type that the symbol NAME may misspell; or NIL."
  (find-if (lambda (known) (misspelling-p name known))
           (mapcar #'argument-type-name (all-argument-types))))

(defun argument-of-type-p (value type)
  "True if VALUE can be an argument of TYPE, an argument type or its name."
  (funcall (argument-type-predicate (find-argument-type type)) value))

(defun argument-trouble-text (value type)
  "Return a text that says what is wrong with VALUE as an argument of TYPE, an argument type or its
name; NIL if the description of the type says enough."
  (let ((trouble (argument-type-trouble (find-argument-type type))))
    (and trouble (funcall trouble value))))

(defun argument-type-text (type &optional (value nil value-p))
  "Return a text that describes the arguments of TYPE, an argument type or its name. If VALUE is
given, the text also says what is wrong with VALUE."
  (format nil "~A~@[: ~A~]" (argument-type-words (find-argument-type type))
          (and value-p (argument-trouble-text value type))))

(defun check-argument-type (operator name value type)
  "Signal WRONG-ARGUMENT for the argument NAME of OPERATOR unless VALUE is of TYPE."
  (unless (argument-of-type-p value type)
    (reject-argument operator name value (argument-type-text type value))))

;;; One for each kind of number; see basics/conditions.lisp for the limits.

(define-argument-type 'number #'sane-number-p "a number from -1e9 to 1e9")
(define-argument-type 'angle #'sane-number-p "an angle in radians, from -1e9 to 1e9")
(define-argument-type 'metres #'sane-number-p "a number of metres, from -1e9 to 1e9")
(define-argument-type 'speed #'sane-number-p "a speed in metres per tick, from -1e9 to 1e9")
(define-argument-type 'ticks #'sane-number-p "a number of ticks, from -1e9 to 1e9")
(define-argument-type 'tick-span #'whole-p "a whole number of ticks, from 0 to 1e9")
(define-argument-type 'duration (lambda (value) (and (sane-number-p value) (not (minusp value))))
  "a number of ticks, from 0 to 1e9")
(define-argument-type 'quantity #'bounded-number-p "a number from -1e15 to 1e15")
(define-argument-type 'amount #'amount-p "a number not below 0, up to 1e15")
(define-argument-type 'probability #'probability-p "a probability from 0 to 1")
(define-argument-type 'integer #'integerp "a whole number")
(define-argument-type 'truth (constantly t) "a boolean: NIL is false, anything else is true")
(define-argument-type 'datum (constantly t) "anything")
(define-argument-type 'name (lambda (value) (and value (typep value '(or symbol string))))
  "a name: a symbol or string")
(define-argument-type 'keyword #'keywordp "a keyword")
(define-argument-type 'function #'functionp "a function")

;;; Radians.

(defun perhaps-degrees-p (angle)
  "True if the user perhaps meant ANGLE, in radians, as degrees: if ANGLE is more than a full turn,
but not a whole number of degrees. (An angle computed with a unit or pi usually is a whole number.)"
  (and (< (* 2 pi) (abs angle))
       (let ((degrees (* angle (/ 180 pi))))
         (< 1d-6 (abs (- degrees (fround degrees)))))))

(defun degrees-advice (angle)
  "Return a text that says how many turns ANGLE radians are, and what to write for degrees."
  (let ((number (if (integerp angle) angle (format nil "~,2F" angle))))
    (format nil "~A radians are ~,1F full turns. If you mean ~A degrees, write (* ~A (/ pi 180)), ~
                 or at the prompt ~A deg."
            number (/ (abs angle) 2 pi) number number number)))

;;;; Operators: everything that a journal can do

;;; An operator has argument types, and a function that repeats the request when a journal is
;;; replayed. A journal can call nothing else.

(define-record (journalled-operator (:conc-name operator-)
                                    (:constructor make-operator (name types rest function))
                                    (:predicate operator-p))
  "An operator whose requests a run accepts and journals."
  (name nil symbol "the name of the operator, a symbol" :export)
  (types '() list "the types of the arguments")
  (rest nil symbol "the type of all further arguments, or NIL")
  (function nil function "the function, of the operator's arguments, that makes the request again"
            :export))

(define-registry operator "operator" :object-p operator-p :fixed t :internal t)

(defun define-operator (name types function &key rest)
  "Define the operator NAME. Its arguments have TYPES, a list of names of argument types; further
arguments have the type REST, if given. FUNCTION is called with the arguments and repeats the
request in the current simulation."
  (register *operators* name (make-operator name types rest function))
  name)

(defun check-operands (operator arguments)
  "Signal WRONG-ARGUMENT unless OPERATOR accepts ARGUMENTS, a list."
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
          do (check-argument-type name (format nil "argument ~D" number) argument type))))
