;;;; experiment.lisp -- what an experiment is: its conditions, and what a trial does.

(in-package :ars-magna.experiment)

(export '(trial-seed))

(addition experiment-p)
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

(defun column-name (name)
  (string-downcase name))

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
          (mapcar #'column-name (factor-names experiment))))

(defun part-columns (parts)
  (mapcar (lambda (part) (column-name (first part))) parts))

(defun columns (experiment)
  (append *columns-before* (factor-columns experiment) *columns-between*
          (part-columns (experiment-measures experiment)) *columns-after*))

(defun series-columns (experiment)
  (append *columns-before* (factor-columns experiment) *series-columns*
          (part-columns (experiment-series experiment))))
