;;;; runner.lisp -- the plan runner's state: who is ready, what time it is, what was posted.

(in-package :ars-magna.rpl.tasks)

;;; Ready tasks queue first-in first-out by level; the highest level runs first. MASK has bit n set
;;; while somebody of level n may be queued, and the bit +INTERRUPT+, above all of these, when the
;;; running task is to look at its own signal.

(defconstant +levels+ 8 "How many levels there are: the plan's, and policies above policies.")
(defconstant +interrupt+ (ash 1 +levels+))

(defparameter *runaway-limit* 1000000
  "How many steps a reaction without a budget takes before time passes all the same.")

(defvar *runner* nil
  "The plan runner at work, while plans run.")

(defstruct (plan-runner (:constructor %make-plan-runner) (:copier nil) (:conc-name runner-))
  "What runs plans: knows the tasks, the tick, the timers, and what was posted from outside."
  (rings (coerce (loop repeat +levels+ collect (make-ring)) 'simple-vector)
   :type (simple-vector 8) :read-only t)
  (mask 0 :type fixnum)
  (current nil :type (or null task))
  (roots '() :type list)
  (held '() :type list)
  (blocks 0 :type fixnum)
  (tick 0 :type real)
  (timers (make-timers) :type timers :read-only t)
  (backlog (make-backlog) :type backlog :read-only t)
  (serial 0 :type fixnum)
  (steps 0 :type (unsigned-byte 62))
  (pause 0 :type (unsigned-byte 62))
  (budget nil :type (or null (integer 1)))
  (ticks-per-second 20 :type (real (0)))
  (dice nil :type (or null dice))
  (trace nil :type (or null chronicle))
  (clock nil :type (or null function))
  (stepper nil :type (or null function))
  (slow 0.1d0 :type real)
  (warned '() :type list)
  (lock (make-lock "plan inbox") :read-only t)
  (inbox '() :type list)
  (outbox '() :type list)
  (busy-p (constantly nil) :type function)
  (on-post #'list :type function)
  (on-tick '() :type list)
  (on-end #'identity :type function))

(defun plan-runner-tick (&optional (runner *runner*))
  "Return the tick that it is for RUNNER."
  (runner-tick runner))

(defun plan-runner-tasks (&optional (runner *runner*))
  "Return the top-level tasks of RUNNER that are not over, in order of their start."
  (reverse (runner-roots runner)))

(defun plan-runner-steps (&optional (runner *runner*))
  "Return how many steps RUNNER has taken: expressions begun or ended."
  (runner-steps runner))

(addition plan-trace)
(defun plan-trace (&optional (runner *runner*))
  "Return the trace of RUNNER, a vector of trace entries in order; NIL if it keeps none."
  (and (runner-trace runner) (trace-entries (runner-trace runner))))

(addition plan-time)
(defun plan-time ()
  "Return the tick that it is for the plan that asks."
  (runner-tick *runner*))

(addition current-task)
(defun current-task ()
  "Return the task that asks."
  (runner-current *runner*))

;;; The ready queues.

(declaim (inline mark-level))
(defun mark-level (runner level)
  (setf (runner-mask runner) (logior (runner-mask runner) (the fixnum (ash 1 level)))))

(defun make-ready (task)
  "Let TASK run when it is its turn."
  (declare #.*hot*)
  (let ((runner (task-runner task))
        (level (task-level task)))
    (declare (type plan-runner runner))
    (setf (task-state task) :ready)
    (ring-push task (the ring (svref (runner-rings runner) level)))
    (mark-level runner level)))

(defun make-ready-first (task)
  "Let TASK run before the others of its level."
  (let ((runner (task-runner task))
        (level (task-level task)))
    (setf (task-state task) :ready)
    (ring-push-front task (svref (runner-rings runner) level))
    (mark-level runner level)))

(defun blocked-p (task)
  "True if TASK or a task that it is part of is blocked. Tasks that clean up are not."
  (unless (task-doomed task)
    (loop for each = task then (task-parent each)
          while each
          thereis (plusp (task-blocked each)))))

(defun take-ready (runner)
  "Return the task of RUNNER that is next to run, or NIL. Blocked ones are put aside."
  (declare #.*hot* (type plan-runner runner))
  (loop
    (let ((level (1- (integer-length (logandc2 (runner-mask runner) +interrupt+)))))
      (when (minusp level) (return nil))
      (let ((ring (svref (runner-rings runner) level)))
        (declare (type ring ring))
        (if (zerop (ring-count ring))
            (setf (runner-mask runner) (logandc2 (runner-mask runner) (ash 1 level)))
            (let ((task (ring-pop ring)))
              (declare (type task task))
              (cond ((not (eq (task-state task) :ready))) ; has evaporated meanwhile
                    ((and (plusp (runner-blocks runner)) (blocked-p task))
                     (push task (runner-held runner)))
                    (t (return task)))))))))

(defun alone-p (task)
  "True if no other task of TASK's level or above is ready."
  (let ((runner (task-runner task)))
    (and (< (runner-mask runner) (ash 2 (task-level task)))
         (zerop (ring-count (svref (runner-rings runner) (task-level task)))))))
