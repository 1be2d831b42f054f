;;;; experiment.lisp -- experiments: their conditions, their trials, the columns of their tables.

(in-package :ars-magna.experiment)

(export '(trial-seed parameter-of-variable))

(addition experiment-p)

;;; A factor is something that varies: a parameter, a variable of the experiment's forms, the
;;; thinking mode, or the robots, and with them the world. A condition gives each factor a value.
;;; Conditions are all combinations of the factors' values, or a list of named cases, or each case
;;; with each combination. All factors of a design vary together: they are one axis. An axis is a
;;; list (names choices): names of factors that vary together, and lists of settings (name value).

(define-record (trial-condition (:conc-name condition-) (:constructor %make-condition))
  "The data that all trials of one condition have in common."
  (name "" string "the name of the condition, a string" :writable :export)
  (texts '() list "the texts of its values in a table" :writable)
  (settings '() list "lists (factor-name value)" :writable)
  (robots '() list :writable)
  (thinking :free t :writable)
  (parameters #() simple-vector "the values of all parameters" :writable)
  (arguments '() list "the values of the variables of the experiment's forms, in order" :writable)
  (fingerprint nil (or null string)
               "the number that identifies code and configuration, NIL at first" :writable)
  (variables '() list "lists (symbol value) of users' variables that trials can reach" :writable)
  (weak-parts (make-hash-table :test 'equal) hash-table "fingerprint parts for objects that these
variables hold weakly: the keys of a table" :writable))

(defmethod print-object ((condition trial-condition) stream)
  (print-unreadable-object (condition stream)
    (format stream "condition ~A" (condition-name condition))))

(defun combinations (axes)
  "Return a list of all combinations of the settings of AXES. The last axis varies fastest."
  (if (null axes)
      (list '())
      (loop with rest = (combinations (rest axes))
            for choice in (second (first axes))
            append (loop for others in rest collect (append choice others)))))

(defvar *robots-compared* '()
  "The names of robots that the values of the factor :ROBOTS of the current experiment contain.")

(defun factor-text (name value)
  "Return the text in tables of VALUE, a value of the factor NAME."
  (setting-text (if (eq :robots name) (with-full-names value *robots-compared*) value)))

(defun make-condition-name (case-name settings)
  (let ((words (append (and case-name (list (string-downcase case-name)))
                       (loop for (name value) in settings
                             collect (format nil "~(~A~)=~A" name (factor-text name value))))))
    (if words (format nil "~{~A~^ ~}" words) "all")))

;;; Parameters.

(defun parameter-of-variable (name)
  "Return the parameter that is the variable NAME, a symbol, or NIL."
  (let ((parameter (find-parameter name nil)))
    (and parameter (eq name (parameter-symbol parameter)) parameter)))

(defun all-parameter-values (settings clean)
  "Return a vector of the values of all parameters. SETTINGS are lists (name value); the last for a
name counts. Other parameters have the value without noise if CLEAN is true, else the manual's."
  (cl:map 'simple-vector
          (lambda (parameter)
            (let ((setting (find (parameter-symbol parameter) settings
                                 :key #'first :from-end t)))
              (cond (setting (second setting))
                    ((and clean (eq :noise (parameter-kind parameter)))
                     (parameter-clean parameter))
                    (t (parameter-default parameter)))))
          (all-parameters)))

;;;; Experiments

(define-record (experiment (:constructor %make-experiment))
  "An experiment: what a trial does, under which conditions, and what is measured."
  (name nil symbol "the name of the experiment, a symbol" :writable :addition)
  (documentation nil (or null string)
                 "the question of the experiment, a string, or NIL" :writable :export)
  (package *package* package "the package in which the experiment was written" :writable :export)
  (robots '() list :writable)
  (thinking :free t :writable)
  (ghosts nil boolean "true if robots have no bodies in trials" :writable)
  (axes '() list :writable)
  (cases '() list "lists (name settings), settings are lists (factor-name value)" :writable)
  (conditions '() list "a list of the experiment's conditions" :writable :addition)
  (trials 100 (integer 1)
          "the default number of trials of each condition" :writable :addition)
  (seed 0 integer :writable)
  (limit 100000 (integer 1) "the most ticks of a trial" :writable :export)
  (time-limit nil (or null real) "the most seconds of a trial, or NIL" :writable)
  (run nil (or null function) "a function of the variables' values, or NIL" :writable)
  (until nil (or null function) "a function of the variables' values, or NIL" :writable)
  (success nil (or null function) "a function of the variables' values, or NIL" :writable)
  (measures '() list "what is measured at the end of a trial, lists (name function); or (name
function summary) for the summary of what is measured from tick to tick" :writable :export)
  (series '() list "what is measured from tick to tick, lists (name function)" :writable)
  (variables '() list :writable)
  (form '() list "the whole form" :writable)
  (deciding '() list "the clauses that affect a trial" :writable)
  (results nil t "the results of its last run in this Lisp, or NIL" :writable))

(defmethod print-object ((experiment experiment) stream)
  (print-unreadable-object (experiment stream :type t)
    (princ (experiment-name experiment) stream)))

(define-registry experiment "experiment" :object-p experiment-p :by-symbol t)

;;; Conditions.

(defun condition-from-settings (experiment settings case-name others clean parameters)
  "Return the condition of EXPERIMENT with SETTINGS: the settings of the case CASE-NAME, and OTHERS.
PARAMETERS are lists (name value) for all conditions."
  (let ((robots (second (assoc :robots settings))))
    (%make-condition
     :name (make-condition-name case-name others)
     :texts (append (and (experiment-cases experiment) (list (string-downcase case-name)))
                    (loop for name in (factor-names experiment)
                          collect (factor-text name (second (assoc name settings)))))
     :settings settings
     :robots (if robots (robots-in-value robots) (experiment-robots experiment))
     :thinking (second (or (assoc :thinking settings)
                           (list :thinking (experiment-thinking experiment))))
     :parameters (all-parameter-values (append parameters settings) clean)
     :arguments (loop for name in (experiment-variables experiment)
                      collect (second (assoc name settings))))))

(defun factor-names (experiment)
  (remove-duplicates
   (append (loop for case in (experiment-cases experiment)
                 append (mapcar #'first (second case)))
           (loop for axis in (experiment-axes experiment) append (first axis)))
   :from-end t))

(defun all-conditions (experiment clean parameters)
  (loop for (case settings) in (or (experiment-cases experiment) '((nil ())))
        append (loop for others in (combinations (experiment-axes experiment))
                     collect (condition-from-settings experiment (append settings others) case
                                                      others clean parameters))))

(defun filter-by-name (text things name)
  "Return THINGS named TEXT, or else THINGS with TEXT in the name. NAME returns the name of a
thing."
  (or (remove text things :key name :test-not #'string-equal)
      (remove-if-not (lambda (thing) (search text (funcall name thing) :test #'char-equal))
                     things)))

(addition find-condition)
(defun find-condition (experiment designator)
  "Return the condition in EXPERIMENT (an experiment or its name) that DESIGNATOR means: a
condition, its number, from 1, its name, or an unambiguous part of its name. Signals UNKNOWN-NAME."
  (let* ((conditions (experiment-conditions (find-experiment experiment)))
         (text (if (typep designator '(or symbol string)) (string designator) ""))
         (named (and (string/= text "") (filter-by-name text conditions #'condition-name))))
    (cond ((member designator conditions) designator)
          ((and (integerp designator) (<= 1 designator (length conditions)))
           (nth (1- designator) conditions))
          ((= 1 (length named)) (first named))
          (t (reject-name "condition" (if (symbolp designator) designator
                                          (princ-to-string designator))
                          (loop for condition in conditions
                                for number from 1
                                when (or (null named) (member condition named))
                                  collect (format nil "~D: ~A" number (condition-name condition)))
                          (mapcar #'condition-name conditions))))))

;;; Trials.

(defun trial-seed (experiment trial)
  "Return the seed of the trial numbered TRIAL, the same under all conditions."
  (+ (experiment-seed experiment) trial))

(defparameter *columns-before-factors* '("experiment" "fingerprint" "condition"))
(defparameter *columns-before-measures* '("seed" "trial" "outcome" "reason" "ticks")
  "The columns of a table of rows between the factors and the measures.")
(defparameter *columns-after-measures* '("digest" "error")
  "The columns of a table of rows after the measures.")
(defparameter *columns-before-values* '("seed" "trial" "tick")
  "The columns of a table of series between the factors and the recorded values.")

(defun factor-columns (experiment)
  (append (and (experiment-cases experiment) (list "case"))
          (mapcar #'string-downcase (factor-names experiment))))

(defun names-as-columns (parts)
  (mapcar (lambda (part) (string-downcase (first part))) parts))

(defun columns (experiment)
  (append *columns-before-factors* (factor-columns experiment) *columns-before-measures*
          (names-as-columns (experiment-measures experiment)) *columns-after-measures*))

(defun series-columns (experiment)
  (append *columns-before-factors* (factor-columns experiment) *columns-before-values*
          (names-as-columns (experiment-series experiment))))

;;;; The question of an experiment

(defun first-sentence (text)
  (let* ((paragraph (search (format nil "~2%") text))
         (line (one-line (subseq text 0 paragraph)))
         (end (loop for mark in '(". " "? " "! ")
                    for place = (search mark line)
                    when place minimize (1+ place))))
    (if (and end (plusp end)) (subseq line 0 end) line)))

(defun question-of (name)
  "Return the question of the experiment that a table calls NAME; NIL if it is unknown."
  (let* ((experiment (find-experiment name nil))
         (text (and experiment (experiment-documentation experiment))))
    (and text (string/= "" (one-line text)) (first-sentence text))))

(define-facts (experiment experiment)
  "Robots" (comma-separated (experiment-robots experiment))
  "Varies" (comma-separated (factor-names experiment))
  "Conditions" (length (experiment-conditions experiment))
  "Trials of each" (experiment-trials experiment)
  "Ends at tick" (experiment-limit experiment)
  "Measures" (comma-separated (mapcar #'first (experiment-measures experiment)))
  "Each tick" (comma-separated (mapcar #'first (experiment-series experiment))))
