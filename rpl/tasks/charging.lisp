;;;; charging.lisp -- the cost of thinking: steps of a tick's budget, or ticks.

(in-package :ars-magna.rpl.tasks)

(export '(count-steps set-charges resume-runner-tasks stop-runner-tasks runner-tasks-stopped-p))

;;; A runner that is CHARGED-P charges what plans state: WITH-CHARGE and THINK wait, CHARGE-TICKS
;;; and CHARGE-STEPS count. BUDGET is how many steps its tasks may take in a tick, all together, in
;;; however many reactions; ALLOTTED is the tick at which it was given last. Charges beyond it are
;;; a DEBT, which is paid from the budgets of the following ticks. Before the tick STILL-UNTIL no
;;; task runs, and no post is applied. Steps of tasks that are UNCOUNTED-P are given back, except
;;; those of a task that runs away.

(defun set-charges (runner charged-p budget)
  "Charge the tasks of RUNNER for thinking from now on if CHARGED-P is true. Give RUNNER BUDGET
steps a tick, or any number of steps if BUDGET is NIL."
  (unless (and (eq charged-p (runner-charged-p runner))
               (eql budget (runner-budget runner)))
    (setf (runner-charged-p runner) charged-p
          (runner-budget runner) budget
          (runner-allotted runner) nil
          (runner-debt runner) 0
          (runner-still-until runner) nil
          (runner-broken-off-p runner) nil)))

(declaim (inline runner-tasks-stopped-p))
(defun runner-tasks-stopped-p (runner)
  "True if STOP-RUNNER-TASKS has stopped all tasks of RUNNER for this tick."
  (let ((tick (runner-still-until runner)))
    (and tick (< (runner-tick runner) tick))))

;;; Giving steps.

(defun allow-steps (runner steps)
  (setf (runner-exhausted runner) nil
        (runner-uncounted runner) 0
        (runner-limit runner) (+ (runner-steps runner) steps)))

(defun give-budget (runner)
  "A reaction of RUNNER begins. Let it use the rest of this tick's budget of steps."
  (let ((budget (runner-budget runner)) (tick (runner-tick runner)))
    (setf (runner-slice runner)
          (max 1 (min +slice+ (floor (or budget *runaway-limit*) 10))))
    (cond ((null budget) (allow-steps runner *runaway-limit*))
          ((not (runner-charged-p runner)) (allow-steps runner budget))
          ((not (eql tick (runner-allotted runner)))
           (let ((paid (min budget (runner-debt runner))))
             (decf (runner-debt runner) paid)
             (setf (runner-allotted runner) tick)
             (allow-steps runner (- budget paid)))))))

(defun uncount-steps (runner steps)
  "Do not count STEPS that a task of RUNNER took, unless this tick has too many uncounted steps."
  (decf (runner-uncovered runner) steps)
  (when (runner-budget runner)
    (incf (runner-uncounted runner) steps)
    (when (<= (runner-uncounted runner) *runaway-limit*)
      (incf (runner-limit runner) steps))))

;;; Taking steps and ticks.

(addition exhaust-reaction)
(defun exhaust-reaction (&optional (runner *runner*))
  "End the current reaction of RUNNER after this step. Ready tasks then wait for the next tick."
  (note-from-outside #'exhaust-reaction runner)
  (setf (runner-exhausted runner) t
        (runner-limit runner) 0
        (runner-pause runner) 0))

(defun stop-runner-tasks (runner ticks)
  "Stop all tasks of RUNNER for TICKS more ticks, once the current step has ended."
  (setf (runner-still-until runner)
        (+ ticks (max (runner-tick runner) (or (runner-still-until runner) 0)))
        (runner-pause runner) 0))

(defun resume-runner-tasks (runner)
  "Let the tasks of RUNNER run again after STOP-RUNNER-TASKS."
  (setf (runner-still-until runner) nil))

(addition charge-ticks)
(defun charge-ticks (ticks &optional (runner *runner*))
  "Stop all plans of the robot for TICKS, 0 or more, once the current step has ended. For Lisp code
of plans whose cost is known only while the code runs. Commands go on; afterwards the plans react to
what has happened. If thinking is not charged, do nothing. Returns nothing. Signals WRONG-ARGUMENT."
  (check-argument charge-ticks ticks (amount-p ticks) "a number of ticks, from 0 to 1e15")
  (note-from-outside #'charge-ticks runner ticks)
  (when (and runner (runner-charged-p runner) (plusp ticks))
    (stop-runner-tasks runner ticks))
  (values))

(defun count-steps (steps runner task)
  "If steps are counted, count STEPS more steps of RUNNER for TASK; for no task if TASK is NIL."
  (when (and (runner-charged-p runner)
             (runner-budget runner)
             (not (and task (task-uncounted-p task))))
    (let* ((left (max 0 (- (runner-limit runner) (runner-steps runner))))
           (now (min steps left)))
      (decf (runner-limit runner) now)
      (incf (runner-debt runner) (- steps now))
      (incf (runner-uncovered runner) steps)
      (setf (runner-pause runner) (min (runner-pause runner) (runner-limit runner))))))

(addition charge-steps)
(defun charge-steps (steps &optional (runner *runner*))
  "Count STEPS, a whole number, as if the plans of the robot had taken these steps. For Lisp code of
plans whose cost is known only while the code runs. Steps beyond the budget of this tick use the
budget of the next ticks. Does nothing if the steps of plans have no budget, and inside a
WITH-CHARGE, which has a fixed price. Returns nothing. Signals WRONG-ARGUMENT."
  (check-argument charge-steps steps (whole-p steps) "a whole number of steps, from 0 to 1e9")
  (note-from-outside #'charge-steps runner steps)
  (when runner (count-steps steps runner (running-task runner)))
  (values))
