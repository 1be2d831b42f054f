;;;; ready.lisp -- the ready queues of agents.

(in-package :ars-magna.rpl.tasks)

(export '(only-ready-task-p blocked-p make-ready))

(declaim (inline mark-level))
(defun mark-level (agent level)
  (setf (agent-mask agent) (logior (agent-mask agent) (the fixnum (ash 1 level)))))

(defun make-ready (task)
  "Put TASK at the end of its ready queue, to run in its turn."
  (declare #.*hot*)
  (let ((agent (task-agent task))
        (level (task-level task)))
    (declare (type agent agent))
    (setf (task-state task) :ready)
    (ring-push task (the ring (svref (agent-rings agent) level)))
    (mark-level agent level)))

(defun make-ready-first (task)
  (let ((agent (task-agent task))
        (level (task-level task)))
    (setf (task-state task) :ready)
    (ring-push-front task (svref (agent-rings agent) level))
    (mark-level agent level)))

(defun interrupt-running-task (agent)
  "Let the running task of AGENT check its signal, blocks and notices before its next step."
  (setf (agent-mask agent) (logior +interrupt-bit+ (agent-mask agent))))

(defun blocked-p (task)
  "True if TASK or a task around it is blocked. If it evaporates, only its cleanup's blocks count."
  (loop for each = task then (task-parent each)
        until (or (null each) (task-ending-p each))
        thereis (plusp (task-blocked each))))

(declaim (inline slice-spent-p))
(defun slice-spent-p (task)
  (and (= (task-round task) (agent-round (task-agent task)))
       (<= (task-slice task) 0)))

(defun take-ready-task (agent)
  "Return AGENT's next task to run, or NIL. Put aside blocked tasks and tasks with no slice left."
  (declare #.*hot* (type agent agent))
  (loop
    (let ((level (1- (integer-length (logandc2 (agent-mask agent) +interrupt-bit+)))))
      (when (minusp level) (return nil))
      (let ((ring (svref (agent-rings agent) level)))
        (declare (type ring ring))
        (if (zerop (ring-count ring))
            (setf (agent-mask agent) (logandc2 (agent-mask agent) (ash 1 level)))
            (let ((task (ring-pop ring)))
              (declare (type task task))
              (cond ((not (eq (task-state task) :ready))) ; has evaporated meanwhile
                    ((and (plusp (agent-blocks agent)) (blocked-p task))
                     (push task (agent-held agent)))
                    ((slice-spent-p task) (push task (agent-spent agent)))
                    (t (return task)))))))))

(defun requeue (tasks)
  (dolist (task tasks)
    (when (eq (task-state task) :ready) (make-ready task))))

(defun requeue-spent-tasks (agent)
  (when (agent-spent agent)
    (requeue (nreverse (shiftf (agent-spent agent) '())))))

(defun requeue-held-tasks (agent)
  "Queue again those ready tasks of AGENT that were put aside because they were blocked."
  (when (agent-held agent)
    (requeue (nreverse (shiftf (agent-held agent) '())))))

(defun task-queued-p (agent)
  "True if the ready queues of AGENT have tasks, not counting those that were put aside."
  (and (plusp (logandc2 (agent-mask agent) +interrupt-bit+))
       (loop for ring across (agent-rings agent) thereis (plusp (ring-count ring)))))

(defun any-task-ready-p (runner)
  (loop for agent in (runner-agents runner)
        thereis (or (task-queued-p agent)
                    (loop for task in (agent-spent agent)
                          thereis (eq (task-state task) :ready)))))

(defun only-ready-task-p (task)
  "True if no other task of the agent of TASK, at its level or above, is ready."
  (let ((agent (task-agent task)))
    (and (< (agent-mask agent) (ash 2 (task-level task)))
         (zerop (ring-count (svref (agent-rings agent) (task-level task)))))))
