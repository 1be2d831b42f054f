;;;; trial.lisp -- running one trial of an experiment.

(in-package :ars-magna.experiment)

(export '(run-trial call-in-silence))

;;; A trial is a function of the code, its condition and its seed. So it begins with the manual's
;;; parameters but where the experiment says otherwise, with Lisp's own dice made from the seed for
;;; code that rolls them, and with settings of the reader and printer that do not depend on where it
;;; is run.

;;; Ticks. Who asks for more than there are is left.

(defun limit-gate (limit next)
  "Return a gate for a simulation that lets LIMIT ticks pass in all, and then leaves the trial. NEXT
is a gate to ask besides, or NIL."
  (lambda (simulation)
    (let ((left (- limit (simulation-tick simulation))))
      (unless (plusp left) (throw 'out-of-ticks nil))
      (if next (min left (funcall next simulation)) left))))

;;; Surroundings.

(defvar *nowhere* (make-broadcast-stream) "Where what trials write goes.")

(defun call-in-silence (function)
  "Call FUNCTION; what it writes is lost, and what enters a debugger is an error."
  (let* ((nobody (make-two-way-stream (make-concatenated-stream) *nowhere*))
         (*standard-output* *nowhere*) (*error-output* *nowhere*) (*trace-output* *nowhere*)
         (*query-io* nobody) (*debug-io* nobody) (*terminal-io* nobody)
         (*break-on-user-error* nil))
    (answering-debugger ((lambda (condition there-p)
                           (declare (ignore there-p))
                           (throw 'broken-off condition)))
      (funcall function))))

;; Fluents and valves have states of their own in each trial, as in forks, whatever leads to them.
;; Variables that trials can reach are bound, so no trial sees what another sets.
(defun call-in-trial (function experiment condition trial &key gate journal)
  "Call FUNCTION in the fresh simulation of TRIAL of CONDITION of EXPERIMENT. GATE, if given, is a
gate to be asked besides that of the limit. With JOURNAL the simulation keeps one."
  (let ((seed (trial-seed experiment trial))
        (limit (experiment-limit experiment)))
    (call-plainly
     (lambda ()
       (call-with-parameter-values
        (copy-seq (condition-parameters condition))
        (lambda ()
          (let ((*plan-limit* limit) (*realm* (fork-realm *realm*)))
            (call-with-simulation
             (lambda ()
               (setf (simulation-gate (current-simulation)) (limit-gate limit gate))
               (progv (mapcar #'first (condition-variables condition))
                   (mapcar #'second (condition-variables condition))
                 (funcall function)))
             (condition-robots condition)
             :seed seed :journal journal :thinking (condition-thinking condition)
             :errors :signal
             :variables (remove-if-not #'variable-name-p (condition-robots condition)))))))
     (experiment-package experiment))))

;;; What happens in it.

(defvar *trial-values* '() "What the form :run of the trial under way has returned, a list.")

(addition trial-values)
(defun trial-values ()
  "Return a list of the values of the form :run of the trial at whose end we are: for :success and
:measure. NIL if it did not return, and before it has."
  *trial-values*)

(defun run-forms (experiment condition)
  "Do what EXPERIMENT says under CONDITION. Return the values of :run, or T if it has :until; NIL
and :LIMIT if too few ticks were left."
  (catch 'out-of-ticks
    (return-from run-forms
      (let ((values (multiple-value-list (call-form (experiment-run experiment) condition))))
        (setf *trial-values* values)
        (signal-trouble *message-queue*)
        (check-run-something values)
        (when (experiment-until experiment)
          (loop until (truth-of :until (experiment-until experiment) condition)
                do (run-ticks 1))
          (setf values '(t)))
        values)))
  (list nil :limit))

(defun run-noting-failures (experiment condition result)
  "Return what RUN-FORMS returns; if a plan that was begun fails, and :run does not handle that,
what RUN-PLAN would have returned of it. Enter it into RESULT as well."
  (block run
    (handler-bind ((user-code-error
                     (lambda (error)
                       (let ((cause (user-code-error-cause error)))
                         (when (typep cause '(and plan-failure (not lisp-failure)))
                           (add-error result (text-of-condition error))
                           (return-from run (list cause :failed)))))))
      (run-forms experiment condition))))

(defun decide-trial (experiment condition outcome reason)
  "Return outcome and reason of a trial of CONDITION that so far are OUTCOME and REASON. What :run
took for a success and :success does not is one that was only believed."
  (let ((success (experiment-success experiment)))
    (cond ((null success) (values outcome reason))
          ((truth-of :success success condition) (values "success" ""))
          ((string= outcome "success") (values "failure" "only-believed"))
          (t (values outcome reason)))))

(defun note-end (result)
  (note-series result)
  (setf (result-ticks result) (simulation-tick)
        (result-digest result) (state-digest)))

(defun note-error (result text)
  (setf (result-outcome result) "error"
        (result-reason result) ""
        (result-measures result) '()
        (result-error result) (plain-text text)))

(defun outcome-so-far (experiment values)
  "Return outcome and reason of a trial of EXPERIMENT whose form :run returned VALUES. What does not
say how a plan went is no success if a plan that was begun waits for what can never come."
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
  "Return in a sentence that the plan whose task is the first of VALUES was not over, or NIL."
  (let ((task (first values)))
    (when (and (task-p task) (not (task-over-p task)))
      (format nil "The plan ~A was not over when :run returned. RUN-PLAN waits for its end; :until ~
                   and RUN-UNTIL let ticks pass." (task-label task)))))

(defun no-ticks-text ()
  "Return in a sentence that no tick has passed in this trial, and what was asked for, or NIL."
  (let ((undone (and (zerop (simulation-tick)) (undone-text (current-simulation)))))
    (and undone (format nil "No ticks have passed in the trial, so ~A" undone))))

(defun note-unfinished (result values)
  "Enter into RESULT, unless it is a success, which plan that was begun waits in vain, or did not
end; or, in any case, that no tick has passed for what was asked for. VALUES are those of :run."
  (let ((text (or (and (not (success-p (result-outcome result)))
                       (or (stranded-plan-text) (unfinished-text values)))
                  (no-ticks-text))))
    (when text (add-error result text))))

(defun note-plans-passed-over (result values failed)
  "Enter into RESULT, if it is a success, which of the tasks FAILED failed though VALUES, those of
:run, do not say so: its failure is true, and may have been taken for a success."
  (let ((task (find (first values) failed :key #'task-result :test-not #'eq)))
    (when (and task (success-p (result-outcome result)))
      (add-error result
                 (format nil "The plan ~A failed (~A), and :run went on. The second value of ~
                              RUN-PLAN says how a plan ended; the first is the failure, which is ~
                              true."
                         (task-label task) (failure-text (task-result task)))))))

(defun conduct (experiment result)
  (let* ((condition (result-condition result))
         (*trial-values* '())
         (failed '())
         (values (let ((*plan-failed* (lambda (task) (push task failed))))
                   (run-noting-failures experiment condition result))))
    (multiple-value-bind (outcome reason) (outcome-so-far experiment values)
      (setf (values (result-outcome result) (result-reason result))
            (decide-trial experiment condition outcome reason))
      (add-error result (error-in-plan values))
      (note-plans-passed-over result values (reverse failed))
      (note-unfinished result values)
      (note-series result)
      (measure experiment result))))

(defun measure (experiment result)
  (setf (result-measures result)
        (loop with condition = (result-condition result)
              for (name function) in (experiment-measures experiment)
              for text = ""
              for trouble = (trouble-text
                             (lambda ()
                               (setf text (text-of-measure "measure" name function condition))))
              when trouble
                do (add-error result (format nil "Error in the measure ~(~A~): ~A" name trouble))
              collect text)))

(defun call-noting-errors (function result)
  (let ((trouble (trouble-text function)))
    (when trouble (note-error result trouble))))

(defun conduct-to-end (experiment result)
  (call-sampling (lambda ()
                   (call-noting-errors (lambda () (conduct experiment result)) result)
                   (note-end result))
                 experiment result))

(defun run-trial (experiment condition trial &key gate)
  "Run TRIAL, a number, of CONDITION of EXPERIMENT. Return its result. GATE is as for
CALL-IN-TRIAL."
  (let ((result (make-result condition trial (trial-seed experiment trial))))
    (call-noting-errors
     (lambda ()
       (call-in-trial (lambda () (conduct-to-end experiment result))
                      experiment condition trial :gate gate))
     result)
    result))
