;;;; reacting.lisp -- reactions of an interface's plans, and serving their wishes in between.

(in-package :ars-magna.rpl-robot)

(export '(wish serve-wish add-wish forget-wish grant-wish served-wish-count fork-resting-simulation
          obsolete-wish-p call-outside-reactions))

;;; A run cannot be forked inside a plan's step, since part of its state is on Lisp's stack. So a
;;; task that wants a fork leaves a wish, waits, and goes on in the same tick with the result.
;;; Wishes are served one at a time, the oldest first, when the reaction is at rest; after each the
;;; plans react again. A wish contains all that it is about, so that a fork has its twin.

(define-record wish
  "A request that is served while all plans of INTERFACE rest. TASK waits for the result; without a
TASK, a caller outside of plans wants a fork."
  (task nil (or null task)
        "the task that waits for the wish to be served, or NIL if no task waits" :export)
  (interface nil (or null interface) "the interface that has the wish" :export))

(defgeneric serve-wish (wish)
  (:documentation "Serve WISH, and continue its task by GRANT-WISH. Called while all plans of the
interface rest. If a method signals an error, the task fails. Return :LATER if WISH was not
served."))

(defconstant +most-wishes+ 100
  "The largest number of wishes served in a tick, so that endless wishes do not stop time.")

(defun add-wish (wish)
  "Add WISH to its interface, to be served when the plans rest. The caller holds the plans."
  (let ((interface (wish-interface wish)))
    (setf (interface-wishes interface) (append (interface-wishes interface) (list wish)))))

(defun forget-wish (wish)
  "Remove WISH from its interface without serving WISH."
  (removef (interface-wishes (wish-interface wish)) wish))

(defmethod remove-waiting-task (task (wish wish))
  (declare (ignore task))
  (forget-wish wish))

(defun grant-wish (wish value)
  "Continue the task of WISH with VALUE. The caller holds the plans."
  (forget-wish wish)
  (with-owned-home ((interface-runner (wish-interface wish)))
    (end-with-value (wish-task wish) value)))

(defun refuse-wish (wish condition)
  (let ((task (wish-task wish)))
    (forget-wish wish)
    (with-owned-home ((interface-runner (wish-interface wish)))
      (end-with-signal task (failure-of condition task (task-frame task))))))

(defun served-wish-count (interface)
  "Return how many wishes of INTERFACE have been served in this tick."
  (let ((tick (simulation-tick (interface-simulation interface))))
    (unless (eql tick (interface-wish-tick interface))
      (setf (interface-wish-tick interface) tick
            (interface-wishes-served interface) 0))
    (interface-wishes-served interface)))

(defun wish-to-serve (interface)
  "Return the oldest wish of INTERFACE whose task could go on, or NIL."
  (find-if (lambda (wish)
             (let ((task (wish-task wish)))
               (and task (not (blocked-p task)))))
           (interface-wishes interface)))

(defun serve-next-wish (interface)
  "Serve the oldest wish of INTERFACE whose task could go on. Return true if a task does go on."
  (let ((wish (wish-to-serve interface)))
    (when (and wish
               (not (interface-closing-p interface))
               (< (served-wish-count interface) +most-wishes+))
      (let ((answer (handler-case (serve-wish wish)
                      (error (condition) (refuse-wish wish condition)))))
        (incf (interface-wishes-served interface))
        (not (eq answer :later))))))

(defun react-and-serve (interface)
  "Let the plans of INTERFACE react, then serve a wish, and so on until nothing is left to do in
this tick. Return :IDLE, or :BUDGET if work is left for the next tick."
  (loop
    (let ((outcome (react-to-all (interface-runner interface))))
      (unless (serve-next-wish interface)
        (return (if (wish-to-serve interface) :budget outcome))))))

;;; For methods of SERVE-WISH.

(defun fork-resting-simulation (interface)
  "Return a fork of the simulation of INTERFACE. The plans rest, and the caller holds them."
  (in-any-case
    (progn (setf (interface-resting-p interface) t)
           (fork-simulation (interface-simulation interface)))
    (setf (interface-resting-p interface) nil)))

(defun obsolete-wish-p (wish)
  "True if no task needs the result of WISH, because its plan, the interface or the run ends."
  (let* ((interface (wish-interface wish)) (task (wish-task wish))
         (simulation (interface-simulation interface)))
    (or (interface-closing-p interface)
        (and (simulation-over simulation) t)
        (and (plans-thread interface) (not (live-p simulation)))
        (and task (member (task-top task) (interface-ends-requested interface)) t))))

(defun call-outside-reactions (function)
  "Call FUNCTION as if this thread were outside of all reactions of plans."
  (let ((*reacting-interface* nil) (*held-interfaces* '()) (*asker* nil))
    (funcall function)))

;;; Headless, plans react at the end of each tick until all wait, so that they see every tick; live
;;; too, unless the thinking mode of the run gives them their own thread.

(defun plans-thread-wanted-p (interface)
  (let ((simulation (interface-simulation interface)))
    (and (timeline-real-p (simulation-timeline simulation))
         (live-p simulation))))

(defun prepare-agent (driver)
  "Give the agent of DRIVER a random state and a budget as its run says."
  (let ((timeline (simulation-timeline (driver-simulation driver))))
    (give-random-state driver)
    (set-charges (driver-agent driver)
                 (thinking-charged-p timeline)
                 (thinking-budget timeline))))

(defun seed-of-robot (driver)
  "Return a number by which seeds of the plans of DRIVER differ from those of other robots."
  (if (rest (simulation-robots (driver-simulation driver)))
      (text-hash (robot-full-name (driver-robot driver)))
      0))

(defun give-random-state (driver)
  "Give the agent of DRIVER a random state for CL:RANDOM in plans, if it needs one. If the run is or
was live, or has several robots, the plans of each robot have a separate random state, which forks
copy. Otherwise plans and other programs of the run share a random state."
  (let ((simulation (driver-simulation driver)) (agent (driver-agent driver)))
    (when (and (null (agent-lisps-dice agent))
               (or (simulation-plans-dice-p simulation)
                   (rest (simulation-robots simulation))))
      (setf (agent-lisps-dice agent)
            (seeded-random-state (+ (seed-of-plans driver) (seed-of-robot driver)))))))

(defmethod agents-in-order ((interface interface) agents)
  (let ((salt (agenda-salt (simulation-agenda (interface-simulation interface)))))
    (if salt
        (sorted-by-turn agents (lambda (agent) (driver-robot (agent-client agent))) salt)
        agents)))

(defun react-fully (interface)
  "Let the plans of INTERFACE react to time and to all that was posted, until all wait or have used
their steps. Return :IDLE or :BUDGET. The caller holds the plans. Inside of a reaction, do nothing."
  (if (eq interface *reacting-interface*)
      :idle
      (let ((runner (interface-runner interface))
            (*reacting-interface* interface)
            ;; By then another run may be the current one.
            (*realm* (interface-realm interface))
            (*continues-in-forks-p* t))
        ;; The parameters of thinking may have changed.
        (mapc #'prepare-agent (interface-drivers interface))
        (advance-timers runner (simulation-tick (interface-simulation interface)))
        (loop
          (let ((outcome (react-and-serve interface)))
            ;; If it was closed while its plans reacted, the rest is done here.
            (cond ((interface-closing-p interface)
                   (finish-closing interface)
                   (return :idle))
                  ((not (finish-closing-drivers interface))
                   (return outcome))))))))

(defun finish-closing (interface)
  "Finish the plans of INTERFACE, which no longer react, and mark INTERFACE as closed."
  (unless (interface-closed-p interface)
    (in-any-case
      (close-runner (interface-runner interface))
      (setf (interface-closed-p interface) t))))

(defun tasks-of-interface (interface)
  (plan-runner-tasks (interface-runner interface)))

(defun actions-of-interface (interface)
  "Return a list of the commands of plans that are under way on all robots."
  (loop for driver in (interface-drivers interface)
        append (driver-actions driver)))

(defun woken-by-tick-p (interface)
  (let ((tick (wake-tick interface)))
    (and tick (>= (simulation-tick (interface-simulation interface)) tick))))

;;; The runner.

(defun fluents-may-change-p (interface)
  "True if a command of a plan is in progress, or something else may still change fluents of plans."
  (let ((simulation (interface-simulation interface)))
    (or (find nil (actions-of-interface interface) :key #'action-over-p)
        (wish-to-serve interface)
        (plusp (agenda-pending (simulation-agenda simulation)))
        (timeline-inbox (simulation-timeline simulation))
        (kickers-may-set-fluents-p interface))))

;;; Remarks on plans in the journal. They are no part of the run.

(defun add-failure-remark (interface kind task failure)
  "Add a remark to the journal of the run of INTERFACE: TASK has failed with FAILURE or, if FAILURE
is NIL, was ended. KIND says whether TASK is a :PLAN or a :PART of a plan. Return the remark."
  (add-remark (interface-simulation interface) kind
          (format nil "~@[in ~A: ~]~:[task~;plan~] ~A ~:[was ended~;failed: ~:*~A~]"
                  (and (task-parent task) (task-label (task-top task)))
                  (eq :plan kind) (task-label task) (and failure (one-line-text failure)))
          (driver-robot (driver-of-plan task))))

(defmethod note-plan-trouble ((driver driver) task failure)
  (when (simulation-journal (driver-simulation driver))
    (let* ((interface (driver-interface driver))
           (remark (add-failure-remark interface :part task failure)))
      (when failure (setf (interface-told interface) (cons failure remark))))))

(defun add-end-remark (interface task)
  "Add a remark to the journal of the run of INTERFACE: TASK, a plan, failed or was ended. Remove
the remark on the same failure of a part in this tick."
  (let ((failure (and (eq :failed (task-state task)) (task-result task)))
        (simulation (interface-simulation interface)))
    (destructuring-bind (&optional told . remark) (shiftf (interface-told interface) nil)
      (when (and remark (eq told failure) (eql (first remark) (simulation-tick simulation)))
        (remove-remark simulation remark)))
    (add-failure-remark interface :plan task failure)))

(defun handle-task-end (interface task)
  (atomic-remove task (interface-ends-requested interface))
  (let ((*reported-robot* (robot-name-of-plan task)))
    (cond ((eq :succeeded (task-state task))
           (warn-of-unawaited-action interface task)
           (dolist (driver (interface-drivers interface)) (warn-of-unread-error driver task)))
          (t (interrupt-actions interface task)
             (add-end-remark interface task)))
    (report-end task (and (member task (interface-awaited interface) :test #'eq) t))))

(defun make-runner (interface)
  (let ((simulation (interface-simulation interface)))
    (make-plan-runner :trace *trace-plans*
                      :tick (simulation-tick simulation)
                      :client interface
                      :busy-p (lambda () (fluents-may-change-p interface))
                      ;; To notice plans that hog their thread.
                      :clock (lambda () (and (live-p simulation) (seconds-now)))
                      :slow *hog-seconds*
                      :on-post (lambda () (wake-plans-or-owner interface))
                      :attended-p (lambda () (plans-thread interface))
                      :on-end (lambda (task) (handle-task-end interface task)))))
