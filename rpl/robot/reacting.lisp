;;;; reacting.lisp -- reactions of an interface's plans, and serving their wishes in between.

(in-package :ars-magna.rpl-robot)

(export '(wish serve-wish add-wish forget-wish grant-wish wishes-in-tick fork-at-rest
          obsolete-wish-p call-apart))

;;; A run cannot be forked inside a plan's step, since part of its state is on Lisp's stack. So a
;;; task that wants a fork leaves a wish, waits, and goes on in the same tick with the result.
;;; Wishes are served one at a time, the oldest first, when the reaction is at rest; after each the
;;; plans react again. A wish contains all that it is about, so that a fork has its twin.

(define-record wish
  "What TASK of INTERFACE waits for; without a task, what a caller outside wants of a fork."
  (task nil (or null task)
        "the task that waits for the wish to be served, or NIL if none does" :export)
  (interface nil (or null interface) "the interface that has the wish" :export))

(defgeneric serve-wish (wish)
  (:documentation "Do what WISH is about and let its task go on by GRANT-WISH. Called while all
plans of its interface rest. An error lets the task fail. Return :LATER if it was not served."))

(defconstant +most-wishes+ 100
  "How many wishes are served in a tick, so that endless wishes do not stop time.")

(defun add-wish (wish)
  "Let WISH be served when the plans, which the caller holds, rest."
  (let ((interface (wish-interface wish)))
    (setf (interface-wishes interface) (append (interface-wishes interface) (list wish)))))

(defun forget-wish (wish)
  "Remove WISH from its interface, as if it had never been there."
  (removef (interface-wishes (wish-interface wish)) wish))

(defmethod withdraw (task (wish wish))
  (declare (ignore task))
  (forget-wish wish))

(defun grant-wish (wish value)
  "Continue the task of WISH with VALUE. The caller holds the plans."
  (forget-wish wish)
  (at-home ((interface-runner (wish-interface wish)))
    (end-with-value (wish-task wish) value)))

(defun refuse-wish (wish condition)
  (let ((task (wish-task wish)))
    (forget-wish wish)
    (at-home ((interface-runner (wish-interface wish)))
      (end-with-signal task (failure-of condition task (task-frame task))))))

(defun wishes-in-tick (interface)
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

(defun serve-next (interface)
  "Serve a wish of INTERFACE if there is one whose time has come. True if its task goes on."
  (let ((wish (wish-to-serve interface)))
    (when (and wish
               (not (interface-closing-p interface))
               (< (wishes-in-tick interface) +most-wishes+))
      (let ((answer (handler-case (serve-wish wish)
                      (error (condition) (refuse-wish wish condition)))))
        (incf (interface-wishes-served interface))
        (not (eq answer :later))))))

(defun react-and-serve (interface)
  "Let the plans of INTERFACE react and serve their wishes until neither goes on. Return :IDLE, or
:BUDGET if what is left must wait for a tick."
  (loop
    (let ((outcome (react-to-all (interface-runner interface))))
      (unless (serve-next interface)
        (return (if (wish-to-serve interface) :budget outcome))))))

;;; For methods of SERVE-WISH.

(defun fork-at-rest (interface)
  "Return a fork of the simulation of INTERFACE, whose plans rest and are held by the caller."
  (in-any-case
    (progn (setf (interface-resting-p interface) t)
           (fork-simulation (interface-simulation interface)))
    (setf (interface-resting-p interface) nil)))

(defun obsolete-wish-p (wish)
  "True if no task waits for the result of WISH any more: its plan is to end, or all is over."
  (let* ((interface (wish-interface wish)) (task (wish-task wish))
         (simulation (interface-simulation interface)))
    (or (interface-closing-p interface)
        (and (simulation-over simulation) t)
        (and (thread-of interface) (not (live-p simulation)))
        (and task (member (task-top task) (interface-ends-requested interface)) t))))

(defun call-apart (function)
  "Call FUNCTION as if no plan were at work around it."
  (let ((*reacting* nil) (*held* '()) (*asker* nil))
    (funcall function)))

;;; Headless, plans react at the end of each tick until all wait, so that they see every tick; live
;;; too, unless the thinking mode of the run gives them their own thread.

(defun thread-wanted-p (interface)
  (let ((simulation (interface-simulation interface)))
    (and (timeline-real-p (simulation-timeline simulation))
         (live-p simulation))))

(defun charge-declared-time (interface)
  (let ((timeline (simulation-timeline (interface-simulation interface))))
    (set-charges (interface-runner interface)
                 (thinking-charged-p timeline)
                 (thinking-budget timeline))))

(defun plans-dice (interface)
  "Return the random state of plans of INTERFACE for CL:RANDOM: in a run that is or was live their
own, which forks copy; else NIL, for that of all programs of the run."
  (let ((simulation (interface-simulation interface)) (runner (interface-runner interface)))
    (when (simulation-plans-dice-p simulation)
      (or (runner-lisps-dice runner)
          (setf (runner-lisps-dice runner)
                (seeded-lisps-dice (+ (simulation-seed simulation)
                                      ;; How many robots of the run come before it.
                                      (or (position (interface-robot interface)
                                                    (simulation-robots simulation))
                                          0))))))))

(defun react-fully (interface)
  "Let the plans of INTERFACE react to time and to all that was posted, until all of them wait or
have used their steps. Return :IDLE or :BUDGET. The caller holds the plans; inside of a reaction
nothing happens."
  (if (eq interface *reacting*)
      :idle
      (let ((runner (interface-runner interface))
            (*reacting* interface)
            ;; By then another run may be the current one.
            (*realm* (entity-realm (interface-valve interface)))
            (*goes-on-in-forks-p* t))
        (charge-declared-time interface)
        (advance-timers runner (simulation-tick (interface-simulation interface)))
        (let ((outcome (rolling ((plans-dice interface)) (react-and-serve interface))))
          ;; If it was closed while its plans reacted, the rest is done here.
          (cond ((interface-closing-p interface) (finish-closing interface) :idle)
                (t outcome))))))

(defun finish-closing (interface)
  "Finish the plans of INTERFACE, which react no more, and detach it from its robot."
  (unless (interface-closed-p interface)
    (in-any-case
      (close-runner (interface-runner interface))
      (setf (interface-closed-p interface) t))))

(defun tasks-of (interface)
  (plan-runner-tasks (interface-runner interface)))

(defun woken-by-tick-p (interface)
  (let ((tick (wake-tick interface)))
    (and tick (>= (simulation-tick (interface-simulation interface)) tick))))

;;; The runner.

(defun busy-p (interface)
  "True if a command of a plan is in progress, or something else may still change fluents of plans."
  (let ((simulation (interface-simulation interface)))
    (or (find nil (interface-actions interface) :key #'action-over-p)
        (wish-to-serve interface)
        (plusp (agenda-pending (simulation-agenda simulation)))
        (timeline-inbox (simulation-timeline simulation))
        (kickers-may-set-fluents-p interface))))

;;; Remarks on plans in the journal. They are no part of the run.

(defun remark-trouble (interface kind task failure)
  "Add a remark to the journal of the run of INTERFACE: TASK, by KIND a :PLAN or a :PART of one, has
failed by FAILURE or, if that is NIL, was ended. Return the remark."
  (remark (interface-simulation interface) kind
          (format nil "~@[in ~A: ~]~:[task~;plan~] ~A ~:[was ended~;failed: ~:*~A~]"
                  (and (task-parent task) (task-label (task-top task)))
                  (eq :plan kind) (task-label task) (and failure (one-line-text failure)))
          (interface-robot interface)))

(defmethod note-plan-trouble ((interface interface) task failure)
  (when (simulation-journal (interface-simulation interface))
    (let ((remark (remark-trouble interface :part task failure)))
      (when failure (setf (interface-told interface) (cons failure remark))))))

(defun remark-end (interface task)
  "Add a remark to the journal of the run of INTERFACE: TASK, a plan, failed or was ended. Remove
the one on the same failure of a part in this tick."
  (let ((failure (and (eq :failed (task-state task)) (task-result task)))
        (simulation (interface-simulation interface)))
    (destructuring-bind (&optional told . remark) (shiftf (interface-told interface) nil)
      (when (and remark (eq told failure) (eql (first remark) (simulation-tick simulation)))
        (unremark simulation remark)))
    (remark-trouble interface :plan task failure)))

(defun note-end (interface task)
  (atomic-remove task (interface-ends-requested interface))
  (cond ((eq :succeeded (task-state task))
         (warn-of-unawaited interface task)
         (warn-of-unread interface task))
        (t (interrupt-actions interface task)
           (remark-end interface task)))
  (report-end task (and (member task (interface-awaited interface) :test #'eq) t)))

(defun make-runner (interface)
  (let ((simulation (interface-simulation interface)))
    (make-plan-runner :trace *trace-plans*
                      :dice (make-dice (simulation-seed simulation) :plans)
                      :tick (simulation-tick simulation)
                      :client interface
                      :busy-p (lambda () (busy-p interface))
                      ;; To notice plans that hog their thread.
                      :clock (lambda () (and (live-p simulation) (seconds-now)))
                      :slow *hog-seconds*
                      :on-post (lambda () (call-to-plans interface))
                      :attended-p (lambda () (thread-of interface))
                      :on-end (lambda (task) (note-end interface task)))))
