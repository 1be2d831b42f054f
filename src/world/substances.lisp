;;;; substances.lisp -- what walls and things are made of.

(in-package :ars-magna.world)

(export '(substance substance-value-type substance-value-parameter *substances*))

;;; A substance has a type, a symbol, and a parameter, a number, as when a camera views it
;;; (manual 2.1). Walls give both. The value of a thing's :substance is a number (the
;;; parameter), a symbol (the type, its parameter as defined here) or a list of both.

(addition substance-p)
(define-record (substance (:constructor make-substance (name %parameter)))
  "A type of substance, such as wood, with its default parameter."
  (name nil symbol "the symbol that names the substance" :addition)
  (%parameter 0d0 double-float "the default parameter of things of the substance"))

(defmethod print-object ((substance substance) stream)
  (print-unreadable-object (substance stream :type t)
    (format stream "~(~A~) ~A" (substance-name substance) (substance-%parameter substance))))

(define-registry substance "substance" :object-p substance-p)

;; The first substances are defined below, where compiled functions are not yet available.
(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun reject-parameter (name parameter)
    (reject-clause (definition-title "defsubstance" name) parameter
                   "a number as the parameter of the substance, such as 60, from -1e15 to 1e15"))

  (defun check-parameter-form (name form)
    "Signal MALFORMED-DEFINITION if FORM, given as the parameter of NAME, cannot return a number."
    (when (and (atom form)
               (or (not (symbolp form)) (null form) (keywordp form))
               (not (bounded-number-p form)))
      (reject-parameter name form))))

(defun define-substance (name parameter)
  "Define or redefine the substance NAME for DEFSUBSTANCE, and return NAME."
  (unless (bounded-number-p parameter) (reject-parameter name parameter))
  (register *substances* name (make-substance name (double parameter)))
  name)

(addition defsubstance)
(define-user-macro defsubstance (&whole form name &optional parameter documentation
                                 &environment environment)
  "Define the substance NAME, a symbol: cameras see things of :substance NAME as PARAMETER, a
number. DOCUMENTATION is a string. An addition to manual 2.1 and 3.3. Return NAME."
  (expand-definition form environment
                     (lambda ()
                       (check-name "defsubstance" name "substance")
                       (check-parameter-form name parameter)
                       (unless (typep documentation '(or null string))
                         (reject-clause (definition-title "defsubstance" name) documentation
                                        "a string as the documentation"))
                       `((define-substance ',name ,parameter)))))

(addition substance-parameter)
(defun substance-parameter (substance)
  "Return the parameter of SUBSTANCE, a SUBSTANCE or its name; 0 if the substance is unknown."
  (let ((substance (find-substance substance nil)))
    (if substance (substance-%parameter substance) 0d0)))

(defun substance-value-p (value)
  "True if VALUE can be the value of a thing's :substance (reading 64)."
  (or (bounded-number-p value)
      (and value (symbolp value))
      (and (proper-list-p value) (= 2 (length value))
           (first value) (symbolp (first value)) (bounded-number-p (second value)))))

(defun substance-value-type (value)
  "Return the substance that VALUE of a :substance attribute names, a symbol, or NIL."
  (cond ((realp value) nil)
        ((symbolp value) value)
        (t (first value))))

(defun substance-value-parameter (value)
  "Return the parameter of VALUE, a :substance attribute, as a double-float; 0 if VALUE is NIL."
  (cond ((realp value) (double value))
        ((null value) 0d0)
        ((symbolp value) (substance-parameter value))
        (t (double (second value)))))

(define-facts (substance substance)
  "Parameter" (substance-%parameter substance))

;;; Our choice; the manual's session views the inside of a wooden box as about 120.

(public wood metal bricks slate)
(defsubstance wood 120)
(defsubstance metal 80)
(defsubstance bricks 20)
(defsubstance slate 30)

(addition stone plaster glass cloth paper plastic)
(defsubstance stone 40)
(defsubstance plaster 60)
(defsubstance glass 5)
(defsubstance cloth 100)
(defsubstance paper 110)
(defsubstance plastic 90)
