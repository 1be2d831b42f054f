;;;; blocking.lisp -- stopping tasks, and letting them go on.

(in-package :ars-magna.rpl.tasks)

(export '(gate add-hold release-hold spawn-gated block-task check-same-runner make-block-hook
          unblock-task))

;;; A task with a gate is at its own frame before its first expression, and goes on when
;;; nothing holds the gate any more. Its status is :created until then.

(define-record (gate (:constructor make-gate ()))
  "A gate, which keeps a task from starting while it is closed."
  (holds '() list "the constraints that keep the gate closed" :writable :export))

(defstruct (gate-node (:include node (step #'step-gate)) (:copier nil))
  "The node at which a task waits before its first expression.")

(defun step-gate (node task frame value)
  (declare (ignore node value))
  (let ((gate (task-gate task)))
    (cond ((and gate (gate-holds gate))
           (park task gate)
           (report-wait-cycle task)
           +parked+)
          (t (setf (task-gate task) nil)
             (note-status task :running)
             (values (frame-up frame) nil)))))

(define-global +gate+ (make-gate-node :form nil)
  "The node of all gates.")

(defmethod current-form ((node gate-node) frame)
  (node-form (frame-node (frame-up frame))))

;; What holds it is lifted one by one.
(defmethod traced-subject ((gate gate))
  (awaited-text gate))

(defmethod awaited-text ((gate gate))
  (format nil "~{~A~^ and ~}" (mapcar #'awaited-text (reverse (gate-holds gate)))))

(defun task-at-start-p (task)
  "True if TASK is ready but has not taken its first step."
  (let ((frame (task-frame task)))
    (and (eq (task-state task) :ready)
         (null (frame-up frame))
         (eq (frame-node frame) (task-node task))
         (zerop (frame-counter frame)))))

(defun put-gate (task)
  (let ((frame (task-frame task)))
    (setf (task-frame task) (make-frame +gate+ (frame-environment frame) frame))))

(defun add-hold (task hold)
  "Keep TASK from starting until HOLD is released. Signals MISUSE if TASK has started."
  (when (null (task-gate task))
    (unless (eq (task-state task) :created)
      (unless (task-at-start-p task)
        (reject-use "~A has started already, so nothing can be ordered ~
                     before it." (task-label task)))
      (put-gate task))
    (setf (task-gate task) (make-gate)))
  (push hold (gate-holds (task-gate task))))

(defun release-hold (task hold)
  "Remove HOLD, which keeps TASK from starting. TASK starts when it has no more holds."
  (let ((gate (task-gate task)))
    (when gate
      (setf (gate-holds gate) (remove hold (gate-holds gate)))
      (when (and (null (gate-holds gate)) (eq gate (task-awaiting task)))
        (wake task nil)))))

(defun spawn-gated (parent node environment index level task)
  "Start TASK as SPAWN does. But if TASK has a gate, TASK waits until this gate is open."
  (spawn parent node environment index level task)
  (when (task-gate task) (put-gate task))
  task)

;;; A blocked task keeps its place, with its parts: fluents that it waits for still count, and it
;;; runs again when nothing blocks it any longer. Expressions in progress that need to react to
;;; blocking have a frame whose DATA is a BLOCK-HOOK.

(define-record (block-hook (:constructor make-block-hook (function)))
  "The reaction of an expression when its task is blocked: FUNCTION is called with task and frame."
  (function #'list function))
(declaim-final block-hook)

(defun notify-blocked-parts (task)
  "Notify the parts of TASK that TASK is stopped, newest first, and then the expressions of TASK
itself, innermost first. Leave out parts that were stopped before."
  (unless (task-ending-p task)
    (dolist (child (reverse (task-children task)))
      (unless (plusp (task-blocked child)) (notify-blocked-parts child)))
    (dolist (frame (frame-chain (task-frame task)))
      (when (block-hook-p (frame-data frame))
        (funcall (block-hook-function (frame-data frame)) task frame)))))

(defun request-yield-of-part (task)
  "If the running task is a part of TASK, let it yield after this step."
  (let ((current (runner-current (task-runner task))))
    (when (and current (eq (task-state current) :running) (part-of-p current task))
      (interrupt-running-task (task-agent current)))))

(defun block-task (task &optional suspension)
  "Keep TASK from running. Blocks are counted. If SUSPENSION is true, TASK is shown as suspended."
  (let ((blocked (blocked-p task)))
    (incf (task-blocked task))
    (when suspension (incf (task-suspensions task)))
    (note-status task (if (under-way-p task) :running (task-state task)))
    (when (under-way-p task)
      (incf (agent-blocks (task-agent task)))
      (note-event task :block)
      (request-yield-of-part task)
      (unless blocked (notify-blocked-parts task)))))

(defun unblock-task (task &optional suspension)
  "Undo one BLOCK-TASK with the same SUSPENSION."
  (decf (task-blocked task))
  (when suspension (decf (task-suspensions task)))
  (when (under-way-p task)
    (decf (agent-blocks (task-agent task)))
    (unless (plusp (task-blocked task)) (note-event task :unblock))
    (note-status task :running)
    (requeue-held-tasks (task-agent task))))

(defun check-same-runner (task other)
  "Signal MISUSE if TASK, the running task, and OTHER belong to different plan runners."
  (when (and (task-runner other) (not (eq (task-runner task) (task-runner other))))
    (reject-use "~A belongs to the plans of another run. The plans of this run can apply only ~
                 SUSPEND and WAKE-UP to it."
                (task-label other))))

;;; SUSPEND and WAKE-UP.

(defun call-or-post (word task function)
  "Call FUNCTION now if TASK has no runner, or if the caller is a plan of the runner of TASK.
Otherwise post FUNCTION for the next reaction. WORD names what FUNCTION does to TASK. Return TASK."
  (let ((runner (task-runner task)))
    (cond ((inside-plans-p runner) (funcall function))
          (t (note-from-outside word task)
             (post-entry runner function (task-agent task)))))
  task)

(addition suspend)
(defun suspend (task)
  "Stop TASK and its parts until WAKE-UP, and return TASK. Meanwhile fluents can still end the waits
of TASK. A second SUSPEND changes nothing (from CRAM).
  A task that suspends itself, or a task around it, stops after its current step. A task that has
not started will stop when it starts. An evaporating task is not stopped. A suspended part does not
keep the task around it from ending.
  If a REPL or another thread calls SUSPEND, it takes effect before the plans react again."
  (check-argument suspend task (task-p task) "a task, such as the name of a :tag")
  (let ((task (task-for-caller task)))
    (call-or-post #'suspend task
                  (lambda ()
                    (unless (or (task-suspended task) (task-over-p task))
                      (setf (task-suspended task) t)
                      (block-task task t))))))

(addition wake-up)
(defun wake-up (task)
  "Undo SUSPEND of TASK, and return TASK. WAKE-UP does not undo WITH-TASK-BLOCKED and similar
constructs. Like SUSPEND, it can be called from anywhere (from CRAM)."
  (check-argument wake-up task (task-p task) "a task, such as the name of a :tag")
  (let ((task (task-for-caller task)))
    (call-or-post #'wake-up task
                  (lambda ()
                    (when (shiftf (task-suspended task) nil)
                      (unblock-task task t))))))
