;;;; outcome.lisp -- results of trials, from the values and records of their forms.

(in-package :ars-magna.experiment)

(export '(call-until-error))

;;; An outcome is "success", "failure", "limit" (no ticks left), "error" (the trial's code signalled
;;; one) or "timeout" (too much real time). A failure has a short reason, which trials can share.

(define-record (result (:constructor make-result (condition trial seed)))
  "The result of a trial."
  (condition nil trial-condition)
  (trial 0 integer "the number of the trial" :export)
  (seed 0 integer "the seed of the trial" :export)
  (outcome "error" string
           "\"success\", \"failure\", \"limit\", \"error\" or \"timeout\"" :writable :export)
  (reason "" string "why the trial failed, a string" :writable :export)
  (ticks 0 (or null integer)
         "how many ticks passed, or NIL for a timeout" :writable :export)
  (measures '() list :writable)
  (series '() list "what was recorded from tick to tick, lists (tick text...)" :writable)
  (digest nil (or null integer) "the digest of the state at the end, or NIL" :writable :export)
  (error "" string "the text of the first error; \"\" if there was none" :writable :export))

(defparameter *plan-states* '(:succeeded :failed :evaporated :deadlock :limit :stopped)
  "The possible second values of RUN-PLAN.")

(defun success-p (outcome) (string= outcome "success"))

(defun plan-outcome (result state)
  (case state
    (:succeeded (values "success" ""))
    (:failed (values "failure"
                     (value-text (or (and (typep result 'plan-failure) (failure-class result))
                                     (type-of result)))))
    (:limit (values "limit" ""))
    (t (values "failure" (value-text state)))))

(defun outcome-of-values (&optional result reason &rest others)
  (declare (ignore others))
  (cond ((member reason *plan-states*) (plan-outcome result reason))
        ((and (task-p result) (task-over-p result))
         (plan-outcome (task-result result) (task-state result)))
        ((task-p result) (values "failure" "unfinished"))
        (result (values "success" ""))
        (t (values "failure"
                   (if (and reason (typep reason '(or symbol string))) (value-text reason) "")))))

(defun check-ticks-passed (values)
  "Signal MISUSE if VALUES, the values of :run, are a plan or its name, and no tick has passed."
  (let* ((value (first values))
         (plan (and value
                    (null (rest values))
                    (zerop (simulation-tick))
                    (typep value '(or symbol procedure))
                    (find-procedure value nil))))
    (when (and plan (or (eq plan value) (eq value (procedure-name plan))))
      (reject-use "The value of :run is the plan ~(~A~), which has not been run. Write ~A."
                  (procedure-name plan) (run-plan-advice (procedure-name plan))))))

(defun plan-error-text (values)
  "If VALUES are those of RUN-PLAN after a Lisp error, return the text of the error; else \"\"."
  (if (and (eq :failed (second values)) (typep (first values) 'lisp-failure))
      (plain-text (failure-text (lisp-failure-condition (first values))))
      ""))

(defun set-first-error (result text)
  "Set the error of RESULT to TEXT, unless RESULT has an error already."
  (when (string= "" (result-error result))
    (setf (result-error result) (plain-text text))))

;;;; Calling the forms of an experiment

(defun call-trial-form (function condition)
  (apply (the function function) (condition-arguments condition)))

(defun checked-form-value (clause function condition)
  "Return the value of FUNCTION, which evaluates the form of CLAUSE. Signals MISUSE if the value is
a fluent or the failure of a plan."
  (let ((value (call-trial-form function condition)))
    (when (fluent-p value)
      (reject-use "The value of ~(~S~) is the fluent ~A itself, which is true whatever its value ~
                   is. Write (fluent-value ...)." clause (fluent-text value)))
    (when (typep value 'plan-failure)
      (reject-use "The value of ~(~S~) is the failure of a plan, which is true. RUN-PLAN returns ~
                   how a plan ended as its second value: (eq (second (trial-values)) :succeeded)."
                  clause))
    value))

(defun text-of-measure (clause name function condition)
  "Return the text of the value of FUNCTION, the measure NAME in CLAUSE. Signals WRONG-ARGUMENT if a
table cannot have that value."
  (let ((value (call-trial-form function condition)))
    (unless (measured-value-p value)
      (reject-argument clause name (abridged value) (values-expected-text value)))
    (value-text value)))

(defvar *inspecting-p* nil
  "True while a stopped trial is inspected: errors are then not errors of the trial.")

(defun call-until-error (function)
  "Call FUNCTION, which may not exit this Lisp. Return the error that ended the call, or NIL."
  (flet ((leave (condition)
           (unless *inspecting-p*
             (when (and *break-on-user-error* (not (typep condition 'storage-condition)))
               (invoke-debugger condition))
             (return-from call-until-error condition))))
    (let ((*inspecting-p* nil))
      (handler-bind (((or error storage-condition) #'leave))
        (call-refusing-exits function)))
    nil))

(defun error-text-of-call (function)
  (let ((trouble (catch 'broken-off
                   (restart-case (call-until-error function)
                     (abort () :report "End this trial." "aborted")))))
    (when (typep trouble 'condition) (recover-memory trouble))
    (if (typep trouble 'condition)
        (call-with-trial-syntax (lambda () (text-of-condition trouble)))
        trouble)))

;;;; What :each-tick records

;;; A sample is taken before the first tick and right after each tick, before :run or a plan's
;;; caller continues. The gate, which lets one tick pass at a time, posts a question that is
;;; answered at the end of the tick, after plans. An observer would not do: it is called before
;;; plans run, and a run with one has no deadlocks, because the observer might set a fluent.

(defstruct (sampler (:constructor make-sampler (experiment result)) (:copier nil))
  "The state of recording the :each-tick values of a trial."
  (experiment nil :type experiment :read-only t)
  (result nil :type result :read-only t)
  ;; Lists (tick texts numbers), the newest first: the texts of the :each-tick values, and the
  ;; numbers of those measures that are summarized. A number that an error prevented is NIL.
  (samples '() :type list)
  ;; The dice of CL:RANDOM while samples are taken.
  (dice (seeded-random-state 0) :read-only t)
  ;; The text of the first error, or NIL.
  (trouble nil :type (or null string)))

(defvar *sampler* nil "The sampler of the trial under way in this thread, or NIL.")

;;; One sample.

(defun call-with-sampling-dice (function sampler tick world)
  "Call FUNCTION without changing the dice of WORLD or of the trial's programs."
  ;; Not the seed alone: the trial's programs have that.
  (reseed-random-state (+ (result-seed (sampler-result sampler)) (ash (1+ tick) 32))
                       (sampler-dice sampler))
  (with-random-state ((sampler-dice sampler))
    (call-with-temporary-dice function tick world)))

(defun note-sampling-error (sampler what tick text)
  (unless (sampler-trouble sampler)
    (setf (sampler-trouble sampler) (format nil "Error in ~A at tick ~D: ~A" what tick text))))

(defun sampled-text (sampler name function tick)
  "Return the text of the value of FUNCTION, named NAME, at TICK; \"\" if FUNCTION signals an error.
SAMPLER keeps the first error."
  (let* ((text "")
         (condition (result-condition (sampler-result sampler)))
         (trouble (error-text-of-call
                   (lambda ()
                     (setf text (text-of-measure "each-tick" name function condition))))))
    (when trouble
      (note-sampling-error sampler (format nil ":each-tick ~(~A~)" name) tick trouble))
    text))

(defun sampled-number (sampler name function tick)
  "Return the number that FUNCTION, of the measure NAME, returns at TICK; NIL after an error.
SAMPLER keeps the first error."
  (let* ((number nil)
         (condition (result-condition (sampler-result sampler)))
         (trouble (error-text-of-call
                   (lambda () (setf number (call-trial-form function condition))))))
    (when trouble (note-sampling-error sampler (format nil "the measure ~(~A~)" name) tick trouble))
    number))

(defun summarized-measures (experiment)
  "Return those measures of EXPERIMENT that are summaries: lists (name function summary)."
  (remove-if-not #'third (experiment-measures experiment)))

;; If a form is left by a THROW, the rest of the sample is empty.
(defun take-sample (sampler simulation)
  (let* ((experiment (sampler-experiment sampler))
         (functions (experiment-series experiment))
         (measures (summarized-measures experiment))
         (tick (simulation-tick simulation))
         (texts (make-list (length functions) :initial-element ""))
         (numbers (make-list (length measures))))
    (push (list tick texts numbers) (sampler-samples sampler))
    (call-with-sampling-dice (lambda ()
                               (loop for (name function) in functions
                                     for place on texts
                                     do (setf (first place)
                                              (sampled-text sampler name function tick)))
                               (loop for (name function) in measures
                                     for place on numbers
                                     do (setf (first place)
                                              (sampled-number sampler name function tick))))
                             sampler tick (simulation-world simulation))))

(defun drop-later-samples (sampler tick)
  "Drop SAMPLER's samples of ticks after TICK, to which the trial has been rewound."
  (loop while (and (sampler-samples sampler)
                   (> (first (first (sampler-samples sampler))) tick))
        do (pop (sampler-samples sampler))))

(defun sample-once (sampler simulation)
  "Add a sample of SIMULATION to SAMPLER, unless this tick has a sample or is not over."
  (let ((tick (simulation-tick simulation)))
    (when (zerop (timeline-phase (simulation-timeline simulation)))
      (drop-later-samples sampler tick)
      (unless (eql tick (first (first (sampler-samples sampler))))
        (take-sample sampler simulation)))))

;;; Sampling a trial.

(defun sampling-gate (sampler gate)
  "Return a gate that lets one tick pass at a time, if GATE allows it, and takes samples."
  (lambda (simulation)
    (sample-once sampler simulation)
    (let ((count (funcall gate simulation))
          (custody (timeline-custody (simulation-timeline simulation))))
      (leave-question custody (lambda () (sample-once sampler simulation)))
      (min 1 count))))

(defun call-recording-series (function experiment result)
  "Call FUNCTION, which runs the trial of RESULT in the current simulation, and record the
:each-tick values and summarized measures of EXPERIMENT, for NOTE-SERIES and SUMMARIZED-VALUE."
  (let ((*sampler* (and (or (experiment-series experiment) (summarized-measures experiment))
                        (make-sampler experiment result)))
        (simulation (current-simulation)))
    (when *sampler*
      (setf (simulation-gate simulation) (sampling-gate *sampler* (simulation-gate simulation))))
    (funcall function)))

(defun note-series (result)
  "Store the recorded series in RESULT. Store the first error of recording if RESULT has none."
  (when *sampler*
    (sample-once *sampler* (current-simulation))
    (when (experiment-series (sampler-experiment *sampler*))
      (setf (result-series result)
            (reverse (loop for (tick texts) in (sampler-samples *sampler*)
                           collect (cons tick texts)))))
    (when (sampler-trouble *sampler*) (set-first-error result (sampler-trouble *sampler*)))))

(defun summarized-value (name summary)
  "Return the SUMMARY of the samples of the measure NAME in the trial under way; :NONE if an error
prevented one of the samples."
  (let* ((place (position name (summarized-measures (sampler-experiment *sampler*)) :key #'first))
         (numbers (loop for (nil nil numbers) in (reverse (sampler-samples *sampler*))
                        collect (nth place numbers))))
    (if (member nil numbers) :none (summary-of-numbers summary numbers))))
