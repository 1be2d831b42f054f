;;;; gate.lisp -- tasks that must not start before something else has happened.

(in-package :ars-magna.rpl.tasks)

(export '(gate hold-back release-hold spawn-gated))

;;; A task with a gate is at a frame of its own before its first expression, and goes on when
;;; nothing holds the gate any more. Its status is :created until then.

(define-record (gate (:constructor make-gate (task)))
  "What keeps TASK from starting."
  (task nil task)
  (holds '() list "what keeps the gate closed" :writable :export))

(defstruct (gate-node (:include node (step #'step-gate)) (:copier nil))
  "The place of a task before its first expression.")

(defun step-gate (node task frame value)
  (declare (ignore node value))
  (let ((gate (task-gate task)))
    (cond ((and gate (gate-holds gate))
           (park task gate)
           (report-circle task)
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

(defun at-start-p (task)
  "True if TASK has been made ready but has not taken its first step."
  (let ((frame (task-frame task)))
    (and (eq (task-state task) :ready)
         (null (frame-up frame))
         (eq (frame-node frame) (task-node task))
         (zerop (frame-counter frame)))))

(defun put-gate (task)
  (let ((frame (task-frame task)))
    (setf (task-frame task) (make-frame +gate+ (frame-environment frame) frame))))

(defun hold-back (task hold)
  "Keep TASK from starting until RELEASE-HOLD. Signals MISUSE if it has started."
  (when (null (task-gate task))
    (unless (eq (task-state task) :created)
      (unless (at-start-p task)
        (reject-use "~A has started already: nothing can come before it." (task-label task)))
      (put-gate task))
    (setf (task-gate task) (make-gate task)))
  (push hold (gate-holds (task-gate task))))

(defun release-hold (task hold)
  "Let HOLD no longer keep TASK from starting."
  (let ((gate (task-gate task)))
    (when gate
      (setf (gate-holds gate) (remove hold (gate-holds gate)))
      (when (and (null (gate-holds gate)) (eq gate (task-awaiting task)))
        (wake task nil)))))

(defun spawn-gated (parent node environment index level task)
  "Do as SPAWN; but TASK does not start before its gate, if it has one, is open."
  (spawn parent node environment index level task)
  (when (task-gate task) (put-gate task))
  task)
