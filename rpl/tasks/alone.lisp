;;;; alone.lisp -- running a plan by itself, in virtual time.

(in-package :ars-magna.rpl.tasks)

(defun run-until-over (runner task limit)
  "Run the plans of RUNNER until TASK is over. Return its state, or :deadlock, or :limit when it is
past tick LIMIT."
  (loop
    (react-to-all runner)
    (let ((wake (next-wake-time runner)) (idle-p (idle-p runner)) (tick (runner-tick runner)))
      (cond ((task-over-p task) (return (task-state task)))
            ((and idle-p (null wake)) (return :deadlock))
            ((and limit (> (or wake tick) limit))
             (note-tick runner (max limit tick))
             (return :limit))
            (t (advance-timers runner (if idle-p wake (1+ tick))))))))

(defun end-alone (runner task limit)
  "Let TASK of RUNNER evaporate, if it is not over. It may clean up until tick LIMIT, if that is a
number, or until nothing goes on; the rest is given up, with a warning for each cleanup."
  (stop-plan runner task)
  (loop (run-until-over runner task limit)
        (let ((part (cleaning-part task)))
          (when (or (task-over-p task) (null part)) (return))
          (at-home (runner) (give-up-cleanup part)))))

(addition run-plan-alone)
(defun run-plan-alone (plan &key arguments (runner (make-plan-runner)) limit)
  "Run PLAN, a plan procedure or the name of one, with the list ARGUMENTS by RUNNER in virtual time:
when no task is ready the next tick at which one wakes comes at once. Return the plan's value, its
failure if it failed, and as a second value :succeeded, :failed, :evaporated, :deadlock (reported as
an error message) or :limit (tick LIMIT came first). A plan that is not over then, or when this is
left, as by an abort, ends: it cleans up, as far as that can be by tick LIMIT. Signals
WRONG-ARGUMENT."
  (check-argument run-plan-alone arguments (proper-list-p arguments) "a list of arguments")
  (check-argument run-plan-alone limit (or (null limit) (quantity-p limit))
                  "a tick, a number up to 1e15, or NIL")
  (let ((task (apply #'start-plan runner plan arguments)) (state nil))
    (in-any-case
      (progn (setf state (run-until-over runner task limit))
             (when (eq state :deadlock) (report-deadlock runner)))
      (unless (task-over-p task)
        (allowing-interrupts (end-alone runner task limit))))
    (values (task-result task) state)))
