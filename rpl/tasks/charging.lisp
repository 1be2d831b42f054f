;;;; charging.lisp -- the cost of thinking: steps of a tick's budget, or ticks.

(in-package :ars-magna.rpl.tasks)

(export '(count-steps set-charges resume-agent stop-agent agent-stopped-p ticks-to-think))

;;; An agent that is CHARGED-P charges what plans state: WITH-CHARGE and THINK wait, CHARGE-TICKS
;;; and CHARGE-STEPS count. BUDGET is how many steps its tasks may take in a tick, all together, in
;;; however many reactions; ALLOTTED is the tick at which it was given last. Charges beyond it are
;;; a DEBT, which is paid from the budgets of the following ticks. Before the tick STILL-UNTIL none
;;; of its tasks runs, and no post for it is applied. Steps of tasks that are UNCOUNTED-P are given
;;; back, except those of a task that runs away.

(defun set-charges (which charged-p budget)
  "Charge the tasks of WHICH, an agent or the first agent of a plan runner, for thinking from now on
if CHARGED-P is true. Give it BUDGET steps a tick, or any number of steps if BUDGET is NIL."
  (let ((agent (agent-of which)))
    (unless (and (eq charged-p (agent-charged-p agent))
                 (eql budget (agent-budget agent)))
      (setf (agent-charged-p agent) charged-p
            (agent-budget agent) budget
            (agent-allotted agent) nil
            (agent-debt agent) 0
            (agent-still-until agent) nil
            (agent-broken-off-p agent) nil))))

(declaim (inline agent-stopped-p))
(defun agent-stopped-p (agent)
  "True if STOP-AGENT has stopped all tasks of AGENT for this tick."
  (let ((tick (agent-still-until agent)))
    (and tick (< (runner-tick (agent-runner agent)) tick))))

(declaim (inline agent-out-p))
(defun agent-out-p (agent)
  "True if AGENT has used its steps of this reaction, or is stopped for this tick."
  (or (>= (agent-steps agent) (agent-limit agent))
      (agent-stopped-p agent)))

;;; Giving steps.

(defun allow-steps (agent steps)
  (setf (agent-exhausted agent) nil
        (agent-uncounted agent) 0
        (agent-limit agent) (+ (agent-steps agent) steps)))

(defun give-budget (agent)
  "A reaction of AGENT begins. Let it use the rest of this tick's budget of steps."
  (let ((budget (agent-budget agent)) (tick (runner-tick (agent-runner agent))))
    (setf (agent-slice agent)
          (max 1 (min +slice+ (floor (or budget *runaway-limit*) 10))))
    (cond ((null budget) (allow-steps agent *runaway-limit*))
          ((not (agent-charged-p agent)) (allow-steps agent budget))
          ((not (eql tick (agent-allotted agent)))
           (let ((paid (min budget (agent-debt agent))))
             (decf (agent-debt agent) paid)
             (setf (agent-allotted agent) tick)
             (allow-steps agent (- budget paid)))))))

(defun uncount-steps (agent steps)
  "Do not count STEPS that a task of AGENT took, unless this tick has too many uncounted steps."
  (decf (agent-uncovered agent) steps)
  (when (agent-budget agent)
    (incf (agent-uncounted agent) steps)
    (when (<= (agent-uncounted agent) *runaway-limit*)
      (incf (agent-limit agent) steps))))

;;; Taking steps and ticks.

(defgeneric ticks-to-think (client agent span)
  (:documentation "A task of AGENT, which runs plans for CLIENT, thinks for SPAN ticks. Return the
whole ticks that the thought takes. The rest, less than a tick, is kept for the next thought.")
  (:method (client agent span)
    (declare (ignore client))
    (multiple-value-bind (ticks rest) (floor (+ (agent-unpaid agent) (rationalize span)))
      (setf (agent-unpaid agent) rest)
      ticks)))

(addition exhaust-reaction)
(defun exhaust-reaction (&optional (which (calling-agent)))
  "End the current reaction of the plans of the robot after this step. Ready tasks then wait for the
next tick. WHICH is the agent of these plans, or a plan runner for its first agent."
  (note-from-outside #'exhaust-reaction which)
  (when which
    (let ((agent (agent-of which)))
      (setf (agent-exhausted agent) t
            (agent-limit agent) 0
            (agent-pause agent) 0))))

(defun stop-agent (agent ticks)
  "Stop all tasks of AGENT for TICKS more ticks, once the current step has ended."
  (setf (agent-still-until agent)
        (+ ticks (max (runner-tick (agent-runner agent)) (or (agent-still-until agent) 0)))
        (agent-pause agent) 0))

(defun resume-agent (agent)
  "Let the tasks of AGENT run again after STOP-AGENT."
  (setf (agent-still-until agent) nil))

(addition charge-ticks)
(defun charge-ticks (ticks &optional (which (calling-agent)))
  "Stop all plans of the robot for TICKS, 0 or more, once the current step has ended. For Lisp code
of plans whose cost is known only while the code runs. Fractions of a tick add up as for THINK.
Commands go on; afterwards the plans react to what has happened. If thinking is not charged, do
nothing. WHICH is as for EXHAUST-REACTION. Returns nothing. Signals WRONG-ARGUMENT."
  (check-argument charge-ticks ticks (amount-p ticks) "a number of ticks, from 0 to 1e15")
  (note-from-outside #'charge-ticks which ticks)
  (let ((agent (and which (agent-of which))))
    (when (and agent (agent-charged-p agent))
      (let ((whole (ticks-to-think (agent-client agent) agent ticks)))
        (when (plusp whole) (stop-agent agent whole)))))
  (values))

(defun count-steps (steps agent task)
  "If steps are counted, count STEPS more steps of AGENT for TASK; for no task if TASK is NIL."
  (when (and (agent-charged-p agent)
             (agent-budget agent)
             (not (and task (task-uncounted-p task))))
    (let* ((left (max 0 (- (agent-limit agent) (agent-steps agent))))
           (now (min steps left)))
      (decf (agent-limit agent) now)
      (incf (agent-debt agent) (- steps now))
      (incf (agent-uncovered agent) steps)
      (setf (agent-pause agent) (min (agent-pause agent) (agent-limit agent))))))

(addition charge-steps)
(defun charge-steps (steps &optional (which (calling-agent)))
  "Count STEPS, a whole number, as if the plans of the robot had taken these steps. For Lisp code of
plans whose cost is known only while the code runs. Steps beyond the budget of this tick use the
budget of the next ticks. Does nothing if the steps of plans have no budget, and inside a
WITH-CHARGE, which has a fixed price. WHICH is as for EXHAUST-REACTION. Returns nothing. Signals
WRONG-ARGUMENT."
  (check-argument charge-steps steps (whole-p steps) "a whole number of steps, from 0 to 1e9")
  (note-from-outside #'charge-steps which steps)
  (when which
    (let* ((agent (agent-of which)) (task (running-task (agent-runner agent))))
      (count-steps steps agent (and task (eq agent (task-agent task)) task))))
  (values))
