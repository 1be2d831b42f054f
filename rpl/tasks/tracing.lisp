;;;; tracing.lisp -- recording events in a plan runner's trace.

(in-package :ars-magna.rpl.tasks)

(export '(note-command note-event start-trace stop-trace with-answer note-event))

;;; *ASKER* is the cause of an event: the task at work, or the caller whose post is applied.

(defmacro note-event (task event &optional subject value)
  "If there is a trace, record in the trace that EVENT happened to TASK. SUBJECT and VALUE are as in
TRACE-ENTRY; without a trace, they are not evaluated."
  (once-only (task)
    `(when (runner-trace (the plan-runner (%task-runner ,task)))
       (trace-task ,task ,event ,subject ,value))))

;; Most frames that are noted have not begun: then one need not ask the node.
(declaim (inline task-current-form))
(defun task-current-form (task)
  (let ((frame (task-frame task)))
    (if (and frame (zerop (frame-counter frame)))
        (node-form (frame-node frame))
        (task-form task))))

(defun trace-task (task event subject value)
  (declare #.*hot* (type task task))    ; 40 ns
  (let ((runner (%task-runner task)))
    (declare (type plan-runner runner))
    (add-trace-entry (runner-trace runner) (runner-tick runner) event (task-serial task)
                     (task-current-form task) subject value)))

(defun trace-running-task (runner event subject value)
  (let* ((asker *asker*)
         (task (and (task-p asker) (eq runner (task-runner asker)) asker)))
    (add-trace-entry (runner-trace runner) (runner-tick runner) event
                     (if task (task-serial task) 0)
                     (and task (task-form task))
                     subject value)))

(defun trace-changes (runner)
  (setf (runner-wrapper runner) #'entry-with-current-asker
        (runner-on-change runner)
        (lambda (kind fluent value) (trace-running-task runner kind fluent value))))

(defun start-trace (runner)
  "Start a trace of RUNNER, unless RUNNER has a trace. Tasks that already run appear to start now."
  (unless (runner-trace runner)
    (setf (runner-trace runner) (make-trace))
    (trace-changes runner)
    (dolist (task (all-tasks runner))
      (note-event task :start
                  (task-name task)
                  (and (task-parent task) (task-serial (task-parent task)))))))

(defun stop-trace (runner)
  "Stop the trace of RUNNER, and discard it."
  (setf (runner-trace runner) nil
        (runner-wrapper runner) nil
        (runner-on-change runner) nil))

;;; What is posted.

(defun entry-with-current-asker (entry)
  "Return a function that applies the posted ENTRY on behalf of the current asker."
  (let ((asker *asker*))
    (lambda ()
      (let ((*asker* asker))
        (if (functionp entry)
            (funcall entry)
            (apply-settings entry))))))

;;; Commands: what tasks ask of others than plans.

(defun note-command (name arguments robot)
  "Record in the trace that the running task calls the plan function NAME with ARGUMENTS for a robot
with the name ROBOT. Return a record of the call for WITH-ANSWER; NIL if no task is running or no
trace is kept."
  (let ((task *asker*))
    (when (and (task-p task) *runner* (runner-trace *runner*))
      (let ((issue (make-issue name (mapcar #'fluent-value arguments) (task-serial task)
                               robot)))
        (note-event task :command issue
                    (loop for each in (lineage task) collect (forms-under-way (task-frame each))))
        issue))))

(defun call-with-answer (issue error function)
  "Call FUNCTION, which applies the answer to ISSUE with the error code ERROR, and record the answer
in the trace. ISSUE is a value of NOTE-COMMAND."
  (let ((*asker* (if issue (make-answer issue error) *asker*)))
    (when (and issue *runner* (runner-trace *runner*))
      (trace-running-task *runner* :answer issue error))
    (funcall function)))

(defmacro with-answer ((issue error) &body body)
  "Run BODY, which applies the answer to ISSUE with the error code ERROR: see CALL-WITH-ANSWER."
  `(call-with-answer ,issue ,error (lambda () ,@body)))
