;;;; trial.lisp -- running one trial of an experiment.

(in-package :ars-magna.experiment)

(export '(run-trial call-without-output))

;;; A trial is a function of the code, its condition and its seed. So it begins with the manual's
;;; parameters, except where the experiment sets them, with CL:RANDOM seeded by the trial's seed,
;;; and with reader and printer variables that do not depend on where it runs.

;;; Ticks. A trial that asks for more than the limit is left by a THROW.

(defun tick-limit-gate (limit next)
  "Return a gate, a function that lets LIMIT ticks of a simulation pass and then leaves the trial.
NEXT is another gate to call, or NIL."
  (lambda (simulation)
    (let ((left (- limit (simulation-tick simulation))))
      (unless (plusp left) (throw 'out-of-ticks nil))
      (if next (min left (funcall next simulation)) left))))

;;; Surroundings.

(defvar *null-output* (make-broadcast-stream) "A stream that discards the output of trials.")

(defun call-without-output (function)
  "Call FUNCTION and discard its output. Entering the debugger is an error."
  (let* ((nobody (make-two-way-stream (make-concatenated-stream) *null-output*))
         (*standard-output* *null-output*) (*error-output* *null-output*)
         (*trace-output* *null-output*)
         (*query-io* nobody) (*debug-io* nobody) (*terminal-io* nobody)
         (*break-on-user-error* nil))
    (answering-debugger ((lambda (condition there-p)
                           (declare (ignore there-p))
                           (throw 'broken-off condition)))
      (funcall function))))

;; Each trial has its own states of fluents and valves, as forks have. Variables that trials can
;; reach are bound, so no trial sees what another sets.
(defun call-in-trial (function experiment condition trial &key gate journal)
  "Call FUNCTION in the fresh simulation of TRIAL of CONDITION of EXPERIMENT. GATE is another gate
to call besides the gate of the limit. If JOURNAL is true the simulation keeps a journal."
  (let ((seed (trial-seed experiment trial))
        (limit (experiment-limit experiment)))
    (call-with-trial-syntax
     (lambda ()
       (call-with-parameter-values
        (copy-seq (condition-parameters condition))
        (lambda ()
          (let ((*plan-limit* limit) (*realm* (fork-realm *realm*)))
            (call-with-simulation
             (lambda ()
               (setf (simulation-gate (current-simulation)) (tick-limit-gate limit gate))
               (progv (mapcar #'first (condition-variables condition))
                   (mapcar #'second (condition-variables condition))
                 (funcall function)))
             (condition-robots condition)
             :seed seed :journal journal :thinking (condition-thinking condition)
             :ghosts (experiment-ghosts experiment) :errors :signal
             :variables (names-in-robots (condition-robots condition)))))))
     (experiment-package experiment))))

;;; Running the forms.

(defvar *trial-values* '() "A list of the values of :run in the current trial.")

(addition trial-values)
(defun trial-values ()
  "Return a list of the values of :run in the current trial, for use in :success and :measure; NIL
before :run has returned, or if :run did not return."
  *trial-values*)

(defun run-trial-forms (experiment condition)
  "Evaluate :run and :until of EXPERIMENT under CONDITION. Return a list of the values of :run; (T)
if there is an :until; (NIL :LIMIT) if the limit of ticks was reached."
  (catch 'out-of-ticks
    (return-from run-trial-forms
      (let ((values (multiple-value-list (call-trial-form (experiment-run experiment) condition))))
        (setf *trial-values* values)
        (signal-pending-error *message-queue*)
        (check-ticks-passed values)
        (when (experiment-until experiment)
          (loop until (checked-form-value :until (experiment-until experiment) condition)
                do (run-ticks 1))
          (setf values '(t)))
        values)))
  (list nil :limit))

(defun run-noting-failures (experiment condition result)
  "Return the value of RUN-TRIAL-FORMS. If a plan started by BEGIN-PLAN fails and :run does not
handle the failure, return the values that RUN-PLAN would have returned, and set the error of
RESULT."
  (block run
    (handler-bind ((user-code-error
                     (lambda (error)
                       (let ((cause (user-code-error-cause error)))
                         (when (typep cause '(and plan-failure (not lisp-failure)))
                           (set-first-error result (text-of-condition error))
                           (return-from run (list cause :failed)))))))
      (run-trial-forms experiment condition))))

(defun final-trial-outcome (experiment condition outcome reason)
  "Return the final outcome and reason of a trial of CONDITION. OUTCOME and REASON are those of
:run. If only :run reports success, the trial fails with the reason only-believed."
  (let ((success (experiment-success experiment)))
    (cond ((null success) (values outcome reason))
          ((checked-form-value :success success condition) (values "success" ""))
          ((string= outcome "success") (values "failure" "only-believed"))
          (t (values outcome reason)))))

(defun note-final-state (result)
  (note-series result)
  (setf (result-ticks result) (simulation-tick)
        (result-digest result) (state-digest)))

(defun set-error-outcome (result text)
  (setf (result-outcome result) "error"
        (result-reason result) ""
        (result-measures result) '()
        (result-error result) (plain-text text)))

(defun outcome-of-run (experiment values)
  "Return outcome and reason of a trial of EXPERIMENT from VALUES, the values of :run. If VALUES are
not from RUN-PLAN and a plan can never continue, the trial fails with the reason deadlock."
  (multiple-value-bind (outcome reason) (apply #'outcome-of-values values)
    (if (and (success-p outcome)
             (not (experiment-until experiment))
             (not (member (second values) *plan-states*))
             (stranded-plan-text))
        (values "failure" "deadlock")
        (values outcome (if (and (string= "failure" outcome) (string= "" reason) (no-ticks-text))
                            "no-ticks"
                            reason)))))

(defun unfinished-text (values)
  "Return a sentence if the first of VALUES is the task of a plan that has not ended; else NIL."
  (let ((task (first values)))
    (when (and (task-p task) (not (task-over-p task)))
      (format nil "The plan ~A was not over when :run returned. RUN-PLAN waits for its end; :until ~
                   and RUN-UNTIL let ticks pass." (task-label task)))))

(defun no-ticks-text ()
  "Return a sentence if no tick has passed in this trial although commands were given; else NIL."
  (let ((undone (and (zerop (simulation-tick)) (undone-requests-text (current-simulation)))))
    (and undone (format nil "No ticks have passed in the trial, so ~A" undone))))

(defun note-unfinished-run (result values)
  "VALUES are those of :run. Unless RESULT is a success, add to it an error for a plan that can
never continue or has not ended. Otherwise add an error if commands were given but no tick passed."
  (let ((text (or (and (not (success-p (result-outcome result)))
                       (or (stranded-plan-text) (unfinished-text values)))
                  (no-ticks-text))))
    (when text (set-first-error result text))))

(defun note-unnoticed-failures (result values failed)
  "If RESULT is a success, add an error for the first of FAILED, tasks, whose failure is not the
first value of :run. A failure counts as true, so :run may have taken the failure for success."
  (let ((task (find (first values) failed :key #'task-result :test-not #'eq)))
    (when (and task (success-p (result-outcome result)))
      (set-first-error result
                       (format nil "The plan ~A failed (~A), and :run went on. The second value of ~
                              RUN-PLAN says how a plan ended; the first is the failure, which is ~
                                    true."
                               (task-label task) (failure-text (task-result task)))))))

(defun evaluate-trial (experiment result)
  (let* ((condition (result-condition result))
         (*trial-values* '())
         (failed '())
         (values (let ((*on-plan-failure* (lambda (task) (push task failed))))
                   (run-noting-failures experiment condition result))))
    (multiple-value-bind (outcome reason) (outcome-of-run experiment values)
      (setf (values (result-outcome result) (result-reason result))
            (final-trial-outcome experiment condition outcome reason))
      (set-first-error result (plan-error-text values))
      (note-unnoticed-failures result values (reverse failed))
      (note-unfinished-run result values)
      (note-series result)
      (take-measures experiment result))))

(defun value-function (name function summary)
  "Return a function of a trial's variables that returns the value of the measure NAME: FUNCTION, or
the SUMMARY of its samples."
  (if summary
      (lambda (&rest variables)
        (declare (ignore variables))
        (summarized-value name summary))
      function))

(defun take-measures (experiment result)
  "Set the measures of RESULT. If some fail, the error of RESULT tells of all of them."
  (setf (result-measures result)
        (loop with condition = (result-condition result)
              with troubles = '()
              for (name function summary) in (experiment-measures experiment)
              for text = ""
              for trouble = (error-text-of-call
                             (lambda ()
                               (setf text (text-of-measure
                                           "measure" name
                                           (value-function name function summary) condition))))
              when trouble
                do (push (format nil "Error in the measure ~(~A~): ~A" name trouble) troubles)
              collect text
              finally (when troubles
                        (set-first-error result (format nil "~{~A~^; ~}" (reverse troubles)))))))

(defun call-noting-errors (function result)
  (let ((trouble (error-text-of-call function)))
    (when trouble (set-error-outcome result trouble))))

(defun complete-trial (experiment result)
  (call-recording-series (lambda ()
                           (call-noting-errors (lambda () (evaluate-trial experiment result))
                                               result)
                           (note-final-state result))
                         experiment result))

(defun run-trial (experiment condition trial &key gate)
  "Run TRIAL, a number, of CONDITION of EXPERIMENT; GATE is as for CALL-IN-TRIAL. Return a result."
  (let ((result (make-result condition trial (trial-seed experiment trial))))
    (call-noting-errors
     (lambda ()
       (call-in-trial (lambda () (complete-trial experiment result))
                      experiment condition trial :gate gate))
     result)
    result))
