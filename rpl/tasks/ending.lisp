;;;; ending.lisp -- how a task ends: by success, by an unhandled signal, by evaporation.

(in-package :ars-magna.rpl.tasks)

(export '(end-with-value complete-when-alone end-with-signal fail-or-escape receive-signal
          status-word stop-waiting unwind remove-waiting-task))

;;; A task that ends notifies the construct that it is part of, which may then end too, and so on
;;; up. A task evaporates at once, unless something in it has to be cleaned up first.

(defun status-word (task state)
  "Return the value of the status fluent of TASK in STATE."
  (cond ((member state '(:created :succeeded :failed :evaporated)) state)
        ((task-gate task) :created)
        ((plusp (task-suspensions task)) :suspended)
        ((plusp (task-blocked task)) :blocked)
        (t :running)))

(defun note-status (task state)
  (when (task-status-fluent task)
    (set-value (task-status-fluent task) (status-word task state))))

(defun finish-task (task state result &optional (how state))
  "End TASK in STATE with RESULT. The construct around TASK receives the word HOW."
  (note-event task (ecase state (:succeeded :succeed) (:failed :fail) (:evaporated :evaporate))
              (and (eq state :failed) result)
              (and (eq how :succeeded) result))
  (setf (task-state task) state
        (task-frame task) nil
        (task-value task) result
        (task-signal task) nil)
  (decf (runner-alive (the plan-runner (%task-runner task))))
  (when (plusp (task-blocked task))
    (decf (agent-blocks (task-agent task)) (task-blocked task))
    (requeue-held-tasks (task-agent task)))
  (note-status task state)
  (let ((parent (task-parent task)))
    (cond (parent
           (unlink-child task)
           (notify-parent-of-end parent task how result)
           (warn-of-remaining-cycle parent))
          (t (let ((runner (task-runner task)))
               (setf (runner-roots runner) (remove task (runner-roots runner)))
               (funcall (runner-on-end runner) task))))))

(defun notify-parent-of-end (parent child how result)
  "Notify PARENT that CHILD has ended. If PARENT has a signal, only its last child's end matters."
  (cond ((null (task-signal parent))
         (let* ((frame (task-frame parent))
                (node (frame-node frame)))
           (funcall (the function (node-child-ended node)) node parent frame child how result)))
        ((task-newest-child parent))
        ((eq (task-signal parent) :evaporate) (evaporate-now parent))
        (t (make-ready parent))))

(defun end-with-signal (parent signal)
  "Evaporate the children of PARENT, which waits for them. Send SIGNAL to PARENT when all are gone."
  (setf (task-signal parent) signal
        (task-awaiting parent) nil)
  (if (task-newest-child parent)
      (evaporate-children parent)
      (make-ready parent)))

(defun end-with-value (parent value)
  "End the construct in which PARENT waits for its children, with VALUE."
  (if (task-newest-child parent)
      (end-with-signal parent (make-completion value))
      (wake parent value)))

(defun fail-or-escape (task how result)
  "If HOW says that a child of TASK failed or escaped, let TASK end so with RESULT; return true."
  (when (member how '(:failed :escaped))
    (end-with-signal task result)
    t))

(defun complete-when-alone (task value)
  "End the construct in which TASK waits for its children, with VALUE, if no child is left."
  (unless (task-newest-child task) (end-with-value task value)))

;;; Unwinding.

(defun unwind (task frame signal)
  "Send SIGNAL outwards from FRAME. Return what a step returns. The result is the frame that handles
SIGNAL, or +PARKED+ if no frame handles SIGNAL and TASK has ended."
  (loop while frame
        do (let* ((node (frame-node frame))
                  (handler (node-unwind node)))
             (when handler
               (multiple-value-bind (handled next value) (funcall handler node task frame signal)
                 (cond (handled (return-from unwind (values next value)))
                       (next (setf signal next)))))
             (setf frame (frame-up frame))))
  (cond ((eq signal :evaporate) (finish-task task :evaporated nil))
        ((escape-p signal) (finish-task task :succeeded signal :escaped))
        (t (finish-task task :failed signal)))
  +parked+)

(defun receive-signal (task frame signal)
  "Handle SIGNAL in TASK at FRAME. Return what a step returns."
  (if (completion-p signal)
      (values (frame-up frame) (completion-value signal))
      (unwind task frame signal)))

;;; Evaporating.

(defgeneric remove-waiting-task (task awaited)
  (:documentation "Remove TASK from the tasks that wait for AWAITED.")
  (:method (task awaited) (declare (ignore task awaited))))

(defun stop-waiting (task)
  "Remove TASK from the object that it waits for: a fluent, a timer or another object."
  (let ((awaited (shiftf (task-awaiting task) nil))
        (timer (shiftf (task-timer task) nil)))
    (cond ((null awaited))
          ((watcher-p awaited) (unwatch awaited))
          ((timer-p awaited) (cancel-timer awaited (runner-timers (%task-runner task))))
          (t (remove-waiting-task task awaited)))
    (when timer (cancel-timer timer (runner-timers (%task-runner task))))))

(defun evaporate-now (task)
  "Let TASK evaporate at once, or start its cleanup. TASK must not be running or have children."
  (let ((queued (eq (task-state task) :ready)))
    (setf (task-signal task) nil)
    (multiple-value-bind (frame value) (unwind task (task-frame task) :evaporate)
      (unless (eq frame +parked+)
        (setf (task-frame task) frame
              (task-value task) value)
        (cond (queued                   ; but perhaps put aside
               (setf (task-round task) 0)
               (requeue-spent-tasks (task-agent task))
               (requeue-held-tasks (task-agent task)))
              (t (make-ready task)))))))

(defun evaporate-children (task)
  (loop for child = (task-newest-child task) then older
        while child
        for older = (task-older child)
        do (unless (cannot-evaporate-p child) (begin-evaporation child))))

(defun cannot-evaporate-p (task)
  (or (task-over-p task) (task-ending-p task) (eq (task-state task) :created)))

(addition evaporate)
(defun evaporate (task)
  "End TASK and its parts, the newest first. Cleanups of EVAP-PROTECT run first and may take time.
Does nothing if TASK has not started, is over or evaporates already. If code outside of the plan
calls EVAPORATE, it takes effect before the plan goes on. Signals WRONG-ARGUMENT."
  (check-argument evaporate task (task-p task) "a task, as begin-plan returns")
  (let ((task (task-for-caller task)))
    (cond ((cannot-evaporate-p task))
          ((not (inside-plans-p (task-runner task)))
           (note-from-outside #'evaporate task)
           (request-end task))
          (t (when (task-parent task)
               (note-plan-trouble (task-client task) task nil))
             (begin-evaporation task)))))

(defun begin-evaporation (task)
  (setf (task-ending-p task) t)
  (cond ((task-cleaning task)
         (setf (frame-data (first (last (task-cleaning task)))) :evaporate))
        ((eq (task-state task) :running)
         (setf (task-signal task) :evaporate)
         (interrupt-running-task (task-agent task)))
        (t (stop-waiting task)
           (evaporate-with-parts task)))
  ;; A blocked task may run again to clean up.
  (when (agent-held (task-agent task)) (requeue-held-tasks (task-agent task))))

(defun evaporate-with-parts (task)
  "Evaporate the children of TASK, and then TASK. TASK must not be running."
  (cond ((task-newest-child task)
         (setf (task-signal task) :evaporate)
         (evaporate-children task))
        (t (evaporate-now task))))

;;; Kills from outside, and cleanups that are given up.

(defun request-end (task)
  (let ((runner (task-runner task)))
    (atomic-push (cons task *asker*) (runner-ends-requested runner))
    (funcall (runner-on-post runner))))

(defun end-requested-tasks (runner)
  (loop for requests = (runner-ends-requested runner)
        until (swap-if-eq (runner-ends-requested runner) requests '())
        finally (loop for (task . asker) in (reverse requests)
                      do (let ((*asker* asker)) (evaporate task)))))

(defun cleaning-part (task)
  "Return an innermost part of TASK, or TASK itself, that is cleaning up; or NIL."
  (or (some #'cleaning-part (task-children task))
      (and (task-cleaning task) task)))

(defun give-up-cleanup (task)
  (queue-notable-warning "The cleanup " (form-text (task-form task)) " in " (task-label task)
               " was given up at tick " (runner-tick (task-runner task)) ".")
  (setf (task-ending-p task) t)
  (let ((*asker* "the limit of its cleanup"))
    (stop-waiting task)
    (evaporate-with-parts task)))
