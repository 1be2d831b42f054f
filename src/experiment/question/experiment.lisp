;;;; experiment.lisp -- what an experiment is: its conditions, and what a trial does.

(in-package :ars-magna.experiment)

(export '(experiment-package experiment-limit experiment-documentation trial-seed))

(defstruct (experiment (:constructor %make-experiment) (:copier nil))
  "A question: what is done in a trial, under which conditions, and what is measured."
  (name nil :type symbol)
  (documentation nil :type (or null string))
  (package *package* :type package)
  (robots '() :type list)
  (thinking :free)
  (axes '() :type list)
  ;; Lists (name settings), where settings are lists (factor-name value).
  (cases '() :type list)
  (conditions '() :type list)
  (trials 100 :type (integer 1))
  (seed 0 :type integer)
  (limit 100000 :type (integer 1))
  ;; How many seconds a trial may take, or NIL.
  (time-limit nil :type (or null real))
  ;; Functions of the variables' values, or NIL.
  (run nil :type (or null function))
  (until nil :type (or null function))
  (success nil :type (or null function))
  ;; Lists (name function): what is measured at the end of a trial, and from tick to tick.
  (measures '() :type list)
  (series '() :type list)
  (variables '() :type list)
  ;; All of its text, and what of it decides a trial.
  (form '() :type list)
  (deciding '() :type list)
  ;; What came of it when it was run last in this Lisp, or NIL.
  (results nil))

(addition experiment-p experiment-name experiment-conditions experiment-trials)
(document-functions
  experiment-p "True of an experiment."
  experiment-name "Return the symbol that the experiment is called."
  experiment-conditions "Return a list of the experiment's conditions."
  experiment-trials "Return how many trials of each condition there are unless somebody says."
  experiment-documentation "Return what the experiment asks, a string, or NIL."
  experiment-limit "Return for how many ticks a trial may go on."
  experiment-package "Return the package in which the experiment was written.")

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
