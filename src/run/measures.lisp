;;;; measures.lisp -- what users measure in runs: defined once, read by name (manual 1.2).

(in-package :ars-magna.run)

(export '(call-with-temporary-dice text-of-measures measured-number parse-measure summary-text
          summary-of-numbers))

;;; The manual leaves it to users what makes a plan good. A measure is a form that computes this
;;; from the state of a run. Reading it never changes the dice of the run. Experiments, projections,
;;; the prompt and pictures read measures by name. Where a value is computed over a run, the measure
;;; is sampled at each tick and the samples are summarized.

(addition measure-p)
(define-record (measure (:constructor make-measure (name function)))
  "A measure: a value that is computed from the state of a run, such as the quality of a plan."
  (name nil symbol "the symbol that names the measure" :addition)
  (function nil function "the function without arguments that computes the value"))

(defmethod print-object ((measure measure) stream)
  (print-named measure stream (measure-name measure)
               (format nil "MEASURE ~A" (measure-name measure))))

(define-registry measure "measure" :object-p measure-p :by-symbol t)

;; PLOT and HELP look for names among both.
(defun warn-of-two-meanings (name)
  "Warn if NAME is the name of a run variable and of a measure."
  (when (and (lookup-entry name *run-variables*) (lookup-entry name *measures*))
    (warn-of-definition "~(~A~) is a run variable and a measure. PLOT shows the measure, whose ~
                         value may differ: rename one of them."
                        name)))

(defmethod redo-definition :after ((definition variable-definition))
  (warn-of-two-meanings (variable-definition-name definition)))

(addition defmeasure)
(define-user-macro defmeasure (&whole form name &body forms &environment environment)
  "Define the measure NAME. FORMS, which may begin with a docstring, compute its value from the
state of the run in which it is read, such as (thing-x (find-thing 'ball)); see MEASURE-VALUE. They
must only read. In experiments the value is what a run variable can have: plain data, or things and
robots of the run. Return NAME. Signals MALFORMED-DEFINITION."
  (let ((definition (definition-title "defmeasure" name)))
    (expand-definition
     form environment
     (lambda ()
       (check-name definition name "measure")
       (let ((body (if (stringp (first forms)) (rest forms) forms)))
         (unless body
           (reject-clause definition (if forms (first forms) name)
                          "a form that computes the value, after a docstring if there is one"))
         (when (typep (first (last body)) '(cons (eql quote) (cons cons null)))
           (warn-of-style "~A: the form is quoted: its value would be the form." definition))
         (list `(register *measures* ',name (make-measure ',name (lambda () ,@body)))
               `(warn-of-two-meanings ',name)))))))

;;; Reading.

(defun call-with-temporary-dice (function tick world)
  "Call FUNCTION with the dice of WORLD reseeded from their states and TICK; then restore them."
  (let* ((all (world-dice-set world))
         (states (loop for dice across all collect (dice-state dice))))
    (loop for dice across all
          for state in states
          do (setf (dice-state dice) (dice-state (make-dice (logxor state tick) "each tick"))))
    (unwind-protect (funcall function)
      (loop for dice across all
            for state in states
            do (setf (dice-state dice) state)))))

(addition measure-value)
(defun measure-value (measure)
  "Return the value that MEASURE, a measure or its name, has now in the current simulation. Its
forms are evaluated while the world stands still; they draw random numbers of their own, so reading
a measure does not affect the run. Errors of the forms are signalled here. Signals UNKNOWN-NAME, and
MISUSE without a simulation."
  (let ((measure (find-measure measure)) (simulation (current-simulation)))
    (asking (simulation)
      (let ((tick (simulation-tick simulation)))
        (with-random-state ((seeded-random-state (+ (simulation-seed simulation)
                                                    (ash (1+ tick) 32))))
          (call-with-temporary-dice (lambda () (values (funcall (measure-function measure))))
                                    tick (simulation-world simulation)))))))

(defun measured-number (measure)
  "Return the value of MEASURE, as MEASURE-VALUE does. Signals MISUSE unless it is a finite number."
  (let ((value (measure-value measure)))
    (unless (and (realp value) (finite-p value))
      (reject-use "The value of the measure ~(~A~) is ~A, which is no finite number.~:[~; For a ~
                   truth value, define the measure as (if form 1 0).~]"
                  (measure-name (find-measure measure)) (safe-text value)
                  (member value '(nil t))))
    value))

;;; Over a run.

(defparameter *summaries*
  `((:mean . ,(lambda (numbers)
                (double (/ (reduce #'+ (mapcar #'rational numbers)) (length numbers)))))
    (:sum . ,(lambda (numbers)
               (if (every #'rationalp numbers)
                   (reduce #'+ numbers)
                   (double (reduce #'+ (mapcar #'rational numbers))))))
    (:max . ,(lambda (numbers) (reduce #'max numbers)))
    (:min . ,(lambda (numbers) (reduce #'min numbers))))
  "How the samples of a measure are summarized over a run: keywords and functions of a list of
numbers.")

(defun summary-text ()
  "Return a text that lists the summaries."
  (format nil "~{~(~S~)~#[~; or ~:;, ~]~}" (mapcar #'first *summaries*)))

(defun summary-of-numbers (summary numbers)
  "Return the SUMMARY, a keyword in *SUMMARIES*, of NUMBERS; NIL if there are no NUMBERS."
  (and numbers (funcall (rest (assoc summary *summaries*)) numbers)))

(defun parse-measure (designator)
  "Return two values: the measure's name in DESIGNATOR, a name or a list (name :over summary), and
the summary or NIL. Return NIL if DESIGNATOR is neither."
  (typecase designator
    (null nil)
    (symbol (values designator nil))
    (measure (values (measure-name designator) nil))
    ((cons (and symbol (not null)) (cons (eql :over) (cons t null)))
     (and (assoc (third designator) *summaries*)
          (values (first designator) (third designator))))))

;;; In titles.

(defun plain-decimal-text (number)
  "Return NUMBER, a float, with at most three decimals and without zeros at the end."
  (let ((text (printing-plainly () (format nil "~,3F" number))))
    (string-right-trim "." (string-right-trim "0" text))))

(defun value-in-title (value)
  (cond ((and (floatp value) (finite-p value)) (plain-decimal-text value))
        ((realp value) (princ-to-string value))
        (t (safe-text value :escape nil :length 60))))

(defun measure-in-title (measure)
  "Return the name and value of MEASURE as text. Signals MISUSE if its forms signal an error."
  (format nil "~(~A~) ~A" (measure-name measure)
          (handler-case (value-in-title (measure-value measure))
            (error (condition)
              (reject-use "The measure ~(~A~) cannot be computed: ~A" (measure-name measure)
                          (text-of-condition condition))))))

(defun text-of-measures (operator names)
  "Return the values of the measures NAMES, a list, as a text; NIL without NAMES. Errors name
OPERATOR. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if a value cannot be computed."
  (unless (proper-list-p names)
    (reject-argument operator :measures names "a list of names of measures"))
  (and names
       (printing-plainly ()
         (format nil "~{~A~^, ~}" (mapcar #'measure-in-title (mapcar #'find-measure names))))))
