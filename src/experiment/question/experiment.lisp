;;;; experiment.lisp -- what an experiment is: its conditions, what a trial does, what it asks.

(in-package :ars-magna.experiment)

(export '(trial-seed))

(addition experiment-p)

;;; What varies is a factor: a parameter, a variable of the experiment's forms, the thinking mode,
;;; or the robots, and with them the world. A condition gives each factor a value. Conditions are
;;; all combinations of the factors' values, or a list of named cases, or each case with each
;;; combination. What a design samples varies together: its factors are one axis. An axis is a list
;;; (names choices): the names of factors that vary together, and lists of settings (name value).

(define-record (trial-condition (:conc-name condition-) (:constructor %make-condition))
  "What the trials of one condition have in common."
  (name "" string "what the condition is called, a string" :writable :export)
  (texts '() list "how its values stand in a table" :writable)
  (settings '() list "lists (factor-name value)" :writable)
  (robots '() list :writable)
  (thinking :free t :writable)
  (parameters #() simple-vector "the values of all parameters" :writable)
  (arguments '() list "the values of the variables of the experiment's forms, in order" :writable)
  (fingerprint nil (or null string)
               "what decides its trials, as far as that has been looked up" :writable)
  (variables '() list "lists (symbol value): users' special variables that its trials can reach, and
their values" :writable)
  (weak-parts (make-hash-table :test 'equal) hash-table "parts, as of a fingerprint, for what these
hold weakly: the keys of a table" :writable))

(defmethod print-object ((condition trial-condition) stream)
  (print-unreadable-object (condition stream)
    (format stream "condition ~A" (condition-name condition))))

(defun combinations (axes)
  "Return all lists of settings of AXES, the last one varying fastest."
  (if (null axes)
      (list '())
      (loop with rest = (combinations (rest axes))
            for choice in (second (first axes))
            append (loop for others in rest collect (append choice others)))))

(defun name-for (case-name settings)
  "Return what the condition of CASE-NAME, or NIL, with the other SETTINGS is called."
  (let ((words (append (and case-name (list (string-downcase case-name)))
                       (loop for (name value) in settings
                             collect (format nil "~(~A~)=~A" name (value-text value))))))
    (if words (format nil "~{~A~^ ~}" words) "all")))

;;; What a setting does.

(defun parameter-called (name)
  "Return the parameter whose variable is the symbol NAME, or NIL."
  (let ((parameter (find-parameter name nil)))
    (and parameter (eq name (parameter-symbol parameter)) parameter)))

(defun parameters-with (settings clean)
  "Return the values of all parameters, in a vector: as SETTINGS, lists (name value), say, the last
one first, or as in a noiseless world if CLEAN is true, or else the manual's."
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
  "A question: what is done in a trial, under which conditions, and what is measured."
  (name nil symbol "the symbol that the experiment is called" :writable :addition)
  (documentation nil (or null string)
                 "what the experiment asks, a string, or NIL" :writable :export)
  (package *package* package "the package in which the experiment was written" :writable :export)
  (robots '() list :writable)
  (thinking :free t :writable)
  (axes '() list :writable)
  (cases '() list "lists (name settings), settings are lists (factor-name value)" :writable)
  (conditions '() list "a list of the experiment's conditions" :writable :addition)
  (trials 100 (integer 1)
          "how many trials of each condition there are unless somebody says" :writable :addition)
  (seed 0 integer :writable)
  (limit 100000 (integer 1) "for how many ticks a trial may go on" :writable :export)
  (time-limit nil (or null real) "how many seconds a trial may take, or NIL" :writable)
  (run nil (or null function) "a function of the variables' values, or NIL" :writable)
  (until nil (or null function) "a function of the variables' values, or NIL" :writable)
  (success nil (or null function) "a function of the variables' values, or NIL" :writable)
  (measures '() list "what is measured at the end of a trial, lists (name function)" :writable)
  (series '() list "what is measured from tick to tick, lists (name function)" :writable)
  (variables '() list :writable)
  (form '() list "all of its text" :writable)
  (deciding '() list "what of it decides a trial" :writable)
  (results nil t "what came of it when it was run last in this Lisp, or NIL" :writable))

(defmethod print-object ((experiment experiment) stream)
  (print-unreadable-object (experiment stream :type t)
    (princ (experiment-name experiment) stream)))

(define-registry experiment "experiment" :object-p experiment-p :by-symbol t)

;;; Conditions.

(defun condition-from (experiment settings case-name others clean parameters)
  "Return the condition of EXPERIMENT with SETTINGS, those of CASE-NAME and OTHERS together, beside
PARAMETERS, lists (name value), that all have."
  (let ((robots (second (assoc :robots settings))))
    (%make-condition
     :name (name-for case-name others)
     :texts (append (and (experiment-cases experiment) (list (string-downcase case-name)))
                    (loop for name in (factor-names experiment)
                          collect (value-text (second (assoc name settings)))))
     :settings settings
     :robots (if robots (ensure-list robots) (experiment-robots experiment))
     :thinking (second (or (assoc :thinking settings)
                           (list :thinking (experiment-thinking experiment))))
     :parameters (parameters-with (append parameters settings) clean)
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
                     collect (condition-from experiment (append settings others) case others
                                             clean parameters))))

(defun called (text things name)
  "Return those of THINGS whose name, by the function NAME, is TEXT; if there are none, those that
have it in their names."
  (or (remove text things :key name :test-not #'string-equal)
      (remove-if-not (lambda (thing) (search text (funcall name thing) :test #'char-equal))
                     things)))

(addition find-condition)
(defun find-condition (experiment designator)
  "Return the condition of EXPERIMENT, or of the one so named, that DESIGNATOR means: a condition,
its number, from 1, or what it is called, as far as that is unambiguous. Signals UNKNOWN-NAME."
  (let* ((conditions (experiment-conditions (find-experiment experiment)))
         (text (if (typep designator '(or symbol string)) (string designator) ""))
         (called (and (string/= text "") (called text conditions #'condition-name))))
    (cond ((member designator conditions) designator)
          ((and (integerp designator) (<= 1 designator (length conditions)))
           (nth (1- designator) conditions))
          ((= 1 (length called)) (first called))
          (t (reject-name "condition" (if (symbolp designator) designator
                                          (princ-to-string designator))
                          (mapcar #'condition-name (or called conditions)))))))

;;; Trials.

(defun trial-seed (experiment trial)
  "Return the seed of the trial numbered TRIAL, the same under all conditions."
  (+ (experiment-seed experiment) trial))

(defparameter *columns-before* '("experiment" "fingerprint" "condition")
  "What stands in the table before what varies.")
(defparameter *columns-between* '("seed" "trial" "outcome" "reason" "ticks")
  "What stands between what varies and what is measured.")
(defparameter *columns-after* '("digest" "error")
  "What stands after what is measured.")
(defparameter *series-columns* '("seed" "trial" "tick")
  "What stands in the table of series between what varies and what is recorded.")

(defun factor-columns (experiment)
  (append (and (experiment-cases experiment) (list "case"))
          (mapcar #'string-downcase (factor-names experiment))))

(defun part-columns (parts)
  (mapcar (lambda (part) (string-downcase (first part))) parts))

(defun columns (experiment)
  (append *columns-before* (factor-columns experiment) *columns-between*
          (part-columns (experiment-measures experiment)) *columns-after*))

(defun series-columns (experiment)
  (append *columns-before* (factor-columns experiment) *series-columns*
          (part-columns (experiment-series experiment))))

;;;; What an experiment asks

(defun first-sentence (text)
  (let* ((paragraph (search (format nil "~2%") text))
         (line (one-line (subseq text 0 paragraph)))
         (end (loop for mark in '(". " "? " "! ")
                    for place = (search mark line)
                    when place minimize (1+ place))))
    (if (and end (plusp end)) (subseq line 0 end) line)))

(defun question-of (name)
  "Return what the experiment that a table calls NAME asks, if that is known, or NIL."
  (let* ((experiment (find-experiment name nil))
         (text (and experiment (experiment-documentation experiment))))
    (and text (string/= "" (one-line text)) (first-sentence text))))

(define-facts (experiment experiment)
  "Robots" (listed (experiment-robots experiment))
  "Varies" (listed (factor-names experiment))
  "Conditions" (length (experiment-conditions experiment))
  "Trials of each" (experiment-trials experiment)
  "Ends at tick" (experiment-limit experiment)
  "Measures" (listed (mapcar #'first (experiment-measures experiment)))
  "Each tick" (listed (mapcar #'first (experiment-series experiment))))
