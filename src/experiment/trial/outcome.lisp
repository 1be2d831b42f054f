;;;; outcome.lisp -- what came of a trial, by what its forms return and record.

(in-package :ars-magna.experiment)

(export '(call-until-error))

;;; An outcome is "success", "failure", "limit" (no more ticks were left), "error" (the trial's
;;; own code broke off) or "timeout" (it took too long by the clock). A failure has a reason, a word
;;; or two that others may share.

(define-record (result (:constructor make-result (condition trial seed)))
  "What came of a trial."
  (condition nil trial-condition)
  (trial 0 integer "the number of the trial" :export)
  (seed 0 integer "the seed of the trial" :export)
  (outcome "error" string
           "\"success\", \"failure\", \"limit\", \"error\" or \"timeout\"" :writable :export)
  (reason "" string "why the trial failed, a string" :writable :export)
  (ticks 0 (or null integer)
         "how many ticks passed, or NIL if the trial's time was up" :writable :export)
  (measures '() list :writable)
  (series '() list "what was recorded from tick to tick, lists (tick text...)" :writable)
  (digest nil (or null integer) "the digest of the state at the end, or NIL" :writable :export)
  (error "" string "what error there was, a string; \"\" if none" :writable :export))

(defparameter *plan-states* '(:succeeded :failed :evaporated :deadlock :limit :stopped)
  "What RUN-PLAN returns as its second value.")

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

(defun check-run-something (values)
  "Signal MISUSE if VALUES, of :run, are a plan or the symbol that it is called by, and no tick has
passed."
  (let* ((value (first values))
         (plan (and value
                    (null (rest values))
                    (zerop (simulation-tick))
                    (typep value '(or symbol procedure))
                    (find-procedure value nil))))
    (when (and plan (or (eq plan value) (eq value (procedure-name plan))))
      (reject-use "The value of :run is the plan ~(~A~), which has not been run. Write ~A."
                  (procedure-name plan) (run-plan-text (procedure-name plan))))))

(defun error-in-plan (values)
  "Return the text of the error in Lisp code that let a plan fail, if VALUES are RUN-PLAN's and it
did; else an empty one."
  (if (and (eq :failed (second values)) (typep (first values) 'lisp-failure))
      (plain-text (failure-text (lisp-failure-condition (first values))))
      ""))

(defun add-error (result text)
  "Enter into RESULT that there was an error of which TEXT tells, unless there was one before."
  (when (string= "" (result-error result))
    (setf (result-error result) (plain-text text))))

;;;; Calling the forms of an experiment

(defun call-form (function condition)
  (apply (the function function) (condition-arguments condition)))

(defun truth-of (clause function condition)
  "Return what FUNCTION, of the form of CLAUSE, returns. Signals MISUSE if that is a fluent, or how
a plan has failed."
  (let ((value (call-form function condition)))
    (when (fluent-p value)
      (reject-use "The value of ~(~S~) is the fluent ~A itself, which is true whatever its value ~
                   is. Write (fluent-value ...)." clause (fluent-text value)))
    (when (typep value 'plan-failure)
      (reject-use "The value of ~(~S~) is the failure of a plan, which is true. RUN-PLAN returns ~
                   how a plan ended as its second value: (eq (second (trial-values)) :succeeded)."
                  clause))
    value))

(defun text-of-measure (clause name function condition)
  "Return the text of what FUNCTION, called NAME in CLAUSE, returns. Signals WRONG-ARGUMENT if a
table cannot have it."
  (let ((value (call-form function condition)))
    (unless (value-p value)
      (reject-argument clause name value "a number, symbol, string or list of them"))
    (value-text value)))

(defvar *aside-p* nil
  "True while a stopped trial is inspected: errors are then not the trial's.")

(defun call-until-error (function)
  "Call FUNCTION, which is not to end this Lisp. Return the condition with which it broke off, or
NIL."
  (flet ((leave (condition)
           (unless *aside-p*
             (when (and *break-on-user-error* (not (typep condition 'storage-condition)))
               (invoke-debugger condition))
             (return-from call-until-error condition))))
    (let ((*aside-p* nil))
      (handler-bind (((or error storage-condition) #'leave))
        (call-refusing-exits function)))
    nil))

(defun trouble-text (function)
  "Call FUNCTION. Return what is to be said if it breaks off, or NIL."
  (let ((trouble (catch 'broken-off
                   (restart-case (call-until-error function)
                     (abort () :report "End this trial." "aborted")))))
    (when (typep trouble 'condition) (regain-room trouble))
    (if (typep trouble 'condition)
        (call-plainly (lambda () (text-of-condition trouble)))
        trouble)))

;;;; What :each-tick records

;;; A sample is taken before the first tick and right after each tick, before :run or a plan's
;;; caller goes on. The gate, which lets one tick pass at a time, leaves a question that is answered
;;; once the tick is over, plans included. An observer would not do: it is called before plans act,
;;; and where there is one, a plan that waits in vain might still be helped, so it is no deadlock.

(defstruct (sampler (:constructor make-sampler (experiment result)) (:copier nil))
  "What takes the samples of a trial."
  (experiment nil :type experiment :read-only t)
  (result nil :type result :read-only t)
  ;; Lists (tick text...), the newest first.
  (samples '() :type list)
  ;; What CL:RANDOM rolls meanwhile.
  (dice (seeded-lisps-dice 0) :read-only t)
  ;; What is to be said of the first error, or NIL.
  (trouble nil :type (or null string)))

(defvar *sampler* nil "The sampler of the trial under way in this thread, or NIL.")

;;; One sample.

(defun call-with-other-dice (function tick world)
  "Call FUNCTION. What the dice of WORLD roll in it depends on what they were and on TICK. They are
then as before."
  (let* ((all (world-dice-set world))
         (states (loop for dice across all collect (dice-state dice))))
    (loop for dice across all
          for state in states
          do (setf (dice-state dice) (dice-state (make-dice (logxor state tick) "each tick"))))
    (unwind-protect (funcall function)
      (loop for dice across all
            for state in states
            do (setf (dice-state dice) state)))))

(defun call-rolling-apart (function sampler tick world)
  "Call FUNCTION, which is to roll neither the dice of WORLD nor those of the trial's programs."
  ;; The seed alone is that of the trial's programs.
  (reseed-lisps-dice (+ (result-seed (sampler-result sampler)) (ash (1+ tick) 32))
                     (sampler-dice sampler))
  (rolling ((sampler-dice sampler))
    (call-with-other-dice function tick world)))

(defun sampled-text (sampler name function tick)
  "Return the text of what FUNCTION, called NAME, returns at TICK. If it breaks off, return an empty
one; of the first time SAMPLER keeps the error."
  (let* ((text "")
         (condition (result-condition (sampler-result sampler)))
         (trouble (trouble-text
                   (lambda ()
                     (setf text (text-of-measure "each-tick" name function condition))))))
    (when (and trouble (null (sampler-trouble sampler)))
      (setf (sampler-trouble sampler)
            (format nil "Error in :each-tick ~(~A~) at tick ~D: ~A" name tick trouble)))
    text))

;; A form may be left, as by THROW. Then the rest of its sample is empty.
(defun take-sample (sampler simulation)
  (let* ((functions (experiment-series (sampler-experiment sampler)))
         (tick (simulation-tick simulation))
         (texts (make-list (length functions) :initial-element "")))
    (push (cons tick texts) (sampler-samples sampler))
    (call-rolling-apart (lambda ()
                          (loop for (name function) in functions
                                for place on texts
                                do (setf (first place)
                                         (sampled-text sampler name function tick))))
                        sampler tick (simulation-world simulation))))

(defun drop-later-samples (sampler tick)
  "Drop SAMPLER's samples of ticks after TICK, over which the trial has been rewound."
  (loop while (and (sampler-samples sampler)
                   (> (first (first (sampler-samples sampler))) tick))
        do (pop (sampler-samples sampler))))

(defun sample-once (sampler simulation)
  "Add a sample of SIMULATION to SAMPLER, unless it has one of this tick or the tick is not over."
  (let ((tick (simulation-tick simulation)))
    (when (zerop (timeline-phase (simulation-timeline simulation)))
      (drop-later-samples sampler tick)
      (unless (eql tick (first (first (sampler-samples sampler))))
        (take-sample sampler simulation)))))

;;; All of them.

(defun sampling-gate (sampler gate)
  "Return a gate that lets one tick pass at a time, as far as GATE does, between samples."
  (lambda (simulation)
    (sample-once sampler simulation)
    (let ((count (funcall gate simulation))
          (custody (timeline-custody (simulation-timeline simulation))))
      (atomic-push (lambda () (sample-once sampler simulation)) (custody-questions custody))
      (min 1 count))))

(defun call-sampling (function experiment result)
  "Call FUNCTION, which runs the trial of RESULT in the current simulation. What EXPERIMENT wants is
recorded at each tick, for NOTE-SERIES."
  (let ((*sampler* (and (experiment-series experiment) (make-sampler experiment result)))
        (simulation (current-simulation)))
    (when *sampler*
      (setf (simulation-gate simulation) (sampling-gate *sampler* (simulation-gate simulation))))
    (funcall function)))

(defun note-series (result)
  "Enter into RESULT what has been recorded of its trial, and the first error, if none came before."
  (when *sampler*
    (sample-once *sampler* (current-simulation))
    (setf (result-series result) (reverse (sampler-samples *sampler*)))
    (when (sampler-trouble *sampler*) (add-error result (sampler-trouble *sampler*)))))
