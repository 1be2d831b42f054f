;;;; reacting.lisp -- the plans of an interface react, and what runs them.

(in-package :ars-magna.rpl-robot)

;;; Headless, plans react at the end of each tick until all wait, so that they see every tick; live
;;; too, unless the thinking mode of the run gives them a thread of their own.

(defun thread-wanted-p (interface)
  (let ((simulation (interface-simulation interface)))
    (and (timeline-real-p (simulation-timeline simulation))
         (live-p simulation))))

(defun charge-as-told (interface)
  (let ((timeline (simulation-timeline (interface-simulation interface))))
    (set-charges (interface-runner interface)
                 (thinking-charged-p timeline)
                 (thinking-budget timeline))))

(defun plans-dice (interface)
  "Return what plans of INTERFACE roll by CL:RANDOM: of a run that is or was live dice of their own,
which its forks take along; or NIL for what all programs of the run roll."
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
        (charge-as-told interface)
        (advance-timers runner (simulation-tick (interface-simulation interface)))
        (let ((outcome (rolling ((plans-dice interface)) (react-and-serve interface))))
          ;; Whoever closed it while its plans reacted has left the rest to us.
          (cond ((interface-closing-p interface) (finish-closing interface) :idle)
                (t outcome))))))

(defun finish-closing (interface)
  "Let the plans of INTERFACE, which react no more, be over, and nobody drive its robot by it."
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
  "True if a command of a plan is under way, or something else may still happen that tells plans
something."
  (let ((simulation (interface-simulation interface)))
    (or (find nil (interface-deeds interface) :key #'deed-over-p)
        (wish-to-serve interface)
        (plusp (agenda-pending (simulation-agenda simulation)))
        (timeline-inbox (simulation-timeline simulation))
        (kickers-may-tell-p interface))))

;;; What the journal is told of plans, besides what they did: it is no part of the run.

(defun remark-trouble (interface kind words task failure)
  "Let the journal of the run of INTERFACE say of TASK, called WORDS, that it failed by FAILURE or,
if that is NIL, was ended. Return the remark."
  (remark (interface-simulation interface) kind
          (format nil "~A ~A ~:[was ended~;failed: ~:*~A~]" words (task-label task)
                  (and failure (one-line-text failure)))
          (interface-robot interface)))

(defmethod hear-of-trouble ((interface interface) task failure)
  (when (simulation-journal (interface-simulation interface))
    (let ((remark (remark-trouble interface :part (part-words task) task failure)))
      (when failure (setf (interface-told interface) (cons failure remark))))))

(defun part-words (task)
  "Return words for the label of TASK to follow: which plan it is part of, unless it is one."
  (format nil "~@[in ~A: ~]task" (and (task-parent task) (task-label (task-top task)))))

(defun remark-end (interface task)
  "Let the journal of the run of INTERFACE say that TASK, a plan, failed or was ended; and no more
that this failure happened, if that was just now."
  (let ((failure (and (eq :failed (task-state task)) (task-result task)))
        (simulation (interface-simulation interface)))
    (destructuring-bind (&optional told . remark) (shiftf (interface-told interface) nil)
      (when (and remark (eq told failure) (eql (first remark) (simulation-tick simulation)))
        (unremark simulation remark)))
    (remark-trouble interface :plan "plan" task failure)))

(defun no-longer-unwanted (interface task)
  (loop for tasks = (interface-unwanted interface)
        until (or (not (member task tasks))
                  (swap-if (interface-unwanted interface) tasks (remove task tasks)))))

(defun note-end (interface task)
  (no-longer-unwanted interface task)
  (cond ((eq :succeeded (task-state task))
         (tell-of-unawaited interface task)
         (tell-of-unread interface task))
        (t (interrupt-deeds interface task)
           (remark-end interface task)))
  (report-end task (and (member task (interface-awaited interface) :test #'eq) t)))

(defun make-runner (interface)
  (let ((simulation (interface-simulation interface)))
    (make-plan-runner :trace *trace-plans*
                      :dice (make-dice (simulation-seed simulation) :plans)
                      :tick (simulation-tick simulation)
                      :client interface
                      :busy-p (lambda () (busy-p interface))
                      ;; By which plans that hog their thread are noticed.
                      :clock (lambda () (and (live-p simulation) (seconds-now)))
                      :slow *hog-seconds*
                      :on-post (lambda () (call-to-plans interface))
                      :attended-p (lambda () (thread-of interface))
                      :on-end (lambda (task) (note-end interface task)))))
