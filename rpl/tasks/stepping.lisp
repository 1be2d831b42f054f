;;;; stepping.lisp -- how a task starts and runs step by step, and waits until another is at rest.

(in-package :ars-magna.rpl.tasks)

(export '(notify-at-rest spawn))

;;; A task must not notify another by a pulse before the other waits for it. So the sender waits
;;; until the receiver is at rest: until it waits, is over, is blocked, or has used its slice;
;;; or, if it belongs to another agent, until that agent is out of the reaction.

(defstruct (pending-notice (:constructor make-pending-notice (receiver sender function))
                           (:copier nil))
  "A call of FUNCTION for which the task SENDER waits until the task RECEIVER is at rest."
  (receiver nil :type task :read-only t)
  (sender nil :type task :read-only t)
  (function nil :type function :read-only t))

(defmethod awaited-text ((notice pending-notice))
  (format nil "task ~D to be at rest" (task-serial (pending-notice-receiver notice))))

(defun at-rest-p (task sender)
  "True if the task SENDER may notify TASK now."
  (let ((agent (task-agent task)))
    (case (task-state task)
      (:running nil)
      (:ready (or (slice-spent-p task) (blocked-p task)
                  (and (not (eq agent (task-agent sender))) (agent-out-p agent))))
      (t (not (pending-notice-p (task-awaiting task)))))))

(defun notify-at-rest (receiver function)
  "Call FUNCTION, which notifies the task RECEIVER, when RECEIVER is at rest. If RECEIVER is at rest
now, or is NIL, call FUNCTION now. Otherwise call FUNCTION as soon as RECEIVER is at rest, and let
the running task wait until then."
  (let* ((runner *runner*)
         (sender (running-task runner)))
    (cond ((or (null receiver) (null sender) (eq receiver sender)
               (not (eq runner (task-runner receiver)))
               ;; Live, answers come in meanwhile, and a sender that waits could miss its own.
               (funcall (runner-attended-p runner))
               (at-rest-p receiver sender))
           (funcall function))
          (t (deliver-notices (remove sender (runner-notices runner)
                                      :key #'pending-notice-receiver :test-not #'eq)
                              runner)
             (setf (runner-notices runner)
                   (append (runner-notices runner)
                           (list (make-pending-notice receiver sender function))))
             (interrupt-running-task (task-agent sender))))))

(defun wait-for-delivery (task frame value)
  "If TASK must deliver a notice before it goes on with FRAME and VALUE, let it wait. True if so."
  (let ((notice (find task (runner-notices (task-runner task)) :key #'pending-notice-sender)))
    (when notice
      (park task notice)
      (setf (task-frame task) frame
            (task-value task) value)
      t)))

(defun deliver-notice (notice)
  (let ((sender (pending-notice-sender notice)))
    (call-user-code (pending-notice-function notice) "what a plan is told")
    (when (eq notice (task-awaiting sender))
      (wake sender (task-value sender)))))

(defun deliver-notices (notices runner)
  (when notices
    (setf (runner-notices runner)
          (remove-if (lambda (notice) (member notice notices)) (runner-notices runner)))
    (mapc #'deliver-notice notices)
    t))

(defun due-notices (runner)
  "Return the notices of RUNNER whose receivers are at rest."
  (remove-if-not (lambda (notice)
                   (at-rest-p (pending-notice-receiver notice) (pending-notice-sender notice)))
                 (runner-notices runner)))

(defun deliver-due-notices (runner)
  (deliver-notices (due-notices runner) runner))

;;; Before each step a task yields to a ready task of a higher level, so that a policy reacts to the
;;; last step before the next one is taken.

(defun warn-of-slow-step (task frame seconds)
  (let ((form (current-form (frame-node frame) frame)))
    (when (first-warning-p form (task-runner task))
      (about-plan (task)
        (warning-set "A plan's Lisp code ran for " (/ (round seconds 0.001) 1000.0)
                     " s without a pause: " (form-text form) " in " (task-label task))))))

(defun clock-seconds (runner)
  "Return the time on RUNNER's clock, in seconds, or NIL without a clock."
  (let ((clock (runner-clock runner)))
    (and clock (funcall clock))))

(defun timed-step (start node task frame value)
  (let ((runner (task-runner task)))
    (setf (runner-looked-at runner) nil)
    (multiple-value-prog1 (funcall (node-step node) node task frame value)
      (let ((seconds (- (or (clock-seconds runner) start) start)))
        (when (and (> seconds (runner-slow runner)) (not (runner-looked-at runner)))
          (warn-of-slow-step task frame seconds))))))

(defun call-with-step-retry (frame function)
  "Call FUNCTION, which takes a step at FRAME, with the restart RETRY, which takes the step again."
  (let ((counter (frame-counter frame))
        (data (frame-data frame)))
    (loop
      (restart-case (return (funcall function))
        (retry ()
          :test (lambda (condition)
                  (declare (ignore condition))
                  (not *inside-leaf-restarts-p*))
          :report (lambda (stream)
                    (format stream "Do ~A again."
                            (form-text (current-form (frame-node frame) frame))))
          (setf (frame-counter frame) counter
                (frame-data frame) data))))))

(defun instrumented-step (node task frame value)
  "Take the step of NODE as RUN-STEPS does, but with timing, the stepper or restarts."
  (let* ((runner (task-runner task))
         (stepper (runner-stepper runner)))
    (flet ((take ()
             (let ((start (clock-seconds runner)))
               (if start
                   (timed-step start node task frame value)
                   (funcall (node-step node) node task frame value)))))
      (declare (dynamic-extent #'take))
      (when stepper (funcall stepper task frame))
      ;; A leaf offers the same, and a value in its place.
      (if (and *leaves-offer-restarts* (not (leaf-p node)))
          (call-with-step-retry frame #'take)
          (take)))))

(defun evaporate-self (task frame)
  "Evaporate TASK, which requested its own end in the step that returned FRAME."
  (cond ((not (eq frame +parked+))
         (setf (task-signal task) nil)
         (unwind task frame :evaporate))
        (t (stop-waiting task)
           (if (task-newest-child task)
               (evaporate-children task)
               (evaporate-now task))
           +parked+)))

(defun check-interruptions (task frame value)
  "Evaporate TASK if requested, or let it yield if its steps are used up or a higher level is ready.
FRAME and VALUE come from the last step. Return the frame and value for RUN-STEPS to continue."
  (when (runner-ends-requested (task-runner task)) (end-requested-tasks (task-runner task)))
  (let* ((agent (task-agent task))
         (mask (logandc2 (agent-mask agent) +interrupt-bit+))
         (preempted (>= mask (ash 2 (task-level task))))
         (spent (>= (agent-steps agent) (agent-pause agent)))
         (kept (and (plusp (agent-blocks agent)) (blocked-p task))))
    (setf (agent-mask agent) mask)
    (cond ((task-signal task) (evaporate-self task frame))
          ((or (null frame) (eq frame +parked+)) (values frame value))
          ((and (runner-notices (task-runner task)) (wait-for-delivery task frame value)) +parked+)
          ((not (or preempted spent kept)) (values frame value))
          (t (setf (task-frame task) frame
                   (task-value task) value)
             (if (and preempted (not kept)) (make-ready-first task) (make-ready task))
             +parked+))))

(defun run-steps (task frame value)
  "Run TASK from FRAME with VALUE until it waits, yields or ends."
  (declare #.*hot* (type task task))    ; 15 ns a step beyond what the step does
  (let* ((agent (task-agent task))
         (runner (%task-runner task))
         (watched (or (clock-seconds runner) (runner-stepper runner) *leaves-offer-restarts*))
         (higher (ash 2 (task-level task))))
    (declare (type agent agent) (type plan-runner runner))
    (loop
      (when (or (>= (agent-mask agent) higher)
                (>= (agent-steps agent) (agent-pause agent))
                (runner-ends-requested runner))
        (multiple-value-setq (frame value) (check-interruptions task frame value)))
      (cond ((null frame) (return (finish-task task :succeeded (single-value value))))
            ((eq frame +parked+) (return)))
      (setf (task-frame task) frame)
      (incf (agent-steps agent))
      (let ((node (frame-node frame)))
        (multiple-value-setq (frame value)
          (if watched
              (instrumented-step node task frame value)
              (funcall (node-step node) node task frame value)))))))

(defun begin-turn (task agent)
  "Give TASK the rest of its slice in this round of AGENT, or a new slice if it has had none."
  (declare #.*hot* (type task task) (type agent agent))
  (unless (= (task-round task) (agent-round agent))
    (setf (task-round task) (agent-round agent)
          (task-slice task) (agent-slice agent)))
  (let ((slice (+ (agent-steps agent) (max 0 (task-slice task)))))
    (setf (agent-pause agent)
          (if (task-uncounted-p task) slice (min (agent-limit agent) slice)))))

(defun run-task (task)
  "Run TASK, which was just taken from a ready queue, or deliver its signal."
  (let* ((frame (task-frame task))
         (value (shiftf (task-value task) nil))
         (signal (task-signal task))
         (agent (task-agent task))
         (start (agent-steps agent)))
    (setf (task-state task) :running
          (runner-current (%task-runner task)) task)
    (begin-turn task agent)
    (let ((*asker* task))
      (when signal
        (setf (task-signal task) nil)
        (multiple-value-setq (frame value) (receive-signal task frame signal)))
      (run-steps task frame value))
    (let ((taken (- (agent-steps agent) start)))
      (decf (task-slice task) taken)
      (when (task-uncounted-p task) (uncount-steps agent taken)))))

(defun check-task-limit (runner)
  (unless (< (runner-alive runner) *plan-task-limit*)
    (if (running-task runner)
        (fail :class :too-many-tasks :limit *plan-task-limit*)
        (reject-use "There are ~D tasks, the *PLAN-TASK-LIMIT*. (end-plan TASK) ends a plan."
                    (runner-alive runner)))))

(defun spawn (parent node environment index level &optional (task (make-task nil node)))
  "Start TASK to run NODE in ENVIRONMENT, and return TASK. TASK is part number INDEX of PARENT, or,
if PARENT is NIL, a top-level task of its agent."
  (let* ((agent (task-agent (or parent task))) (runner (agent-runner agent)))
    (check-task-limit runner)
    (incf (runner-alive runner))
    (setf (task-agent task) agent
          (task-serial task) (incf (runner-serial runner))
          (task-level task) (min level (1- +levels+))
          (task-node task) node
          (task-index task) index
          (task-frame task) (make-frame node environment nil))
    (when parent
      (link-child task parent)
      (when (task-uncounted-p parent) (setf (task-uncounted-p task) t)))
    (incf (agent-blocks agent) (task-blocked task))
    (note-event task :start (task-name task)
                (if parent (task-serial parent) (owner-text (agent-client agent))))
    (note-status task :running)
    (make-ready task)
    task))
