;;;; engine.lisp -- running plans: their start and end, time, and plans without a robot.

(in-package :ars-magna.rpl.tasks)

(export '(advance-timers note-tick close-runner digest-runner runner-idle-p end-tasks-at-once
          make-plan-runner next-wake-time outside-request-p plan-deadlocked-p skip-idle-tick
          reseed-agent start-plan stop-plan))

;;; The engine is independent of the simulator. Its client calls REACT-TO-ALL and ADVANCE-TIMERS,
;;; in one thread at a time; any thread may post.

(defun make-plan-runner (&key trace budget charged clock (slow 0.1d0) dice (ticks-per-second 20)
                           (tick 0) client (busy-p (constantly nil)) (on-post #'list)
                           (attended-p (constantly nil))
                           (on-end #'report-end))
  "Return a new plan runner whose time is TICK. It has no agents, but if BUDGET, CHARGED or DICE is
true, it has one with these.
  TRACE: true to keep a trace.
  BUDGET: how many steps a reaction may take before time passes; NIL for no limit.
  CHARGED: if true, thinking with a stated cost takes ticks, and all reactions of a tick share
BUDGET.
  CLOCK: a function that returns seconds, or NIL for no timing. With a clock, Lisp code that runs
for more than SLOW seconds causes a warning.
  DICE: the dice from which TRY-ONE draws.
  BUSY-P: a function that says whether something outside of the plans, such as a command in
progress, may still post.
  ON-POST: a function called after each post, in the posting thread.
  ATTENDED-P: a function that says whether a thread applies posts anyway.
  ON-END: a function called with each top-level task that ends; by default it reports failures.
  CLIENT: any object, for which the runner works."
  (check-argument make-plan-runner budget (or (null budget) (whole-p budget 1))
                  "NIL or an integer from 1 to 1e9")
  (let ((runner (%make-plan-runner :trace (and trace (make-trace)) :clock clock
                                   :slow slow :ticks-per-second ticks-per-second
                                   :tick tick :client client :busy-p busy-p :on-post on-post
                                   :attended-p attended-p :repairer #'repair-after-exit
                                   :on-end on-end)))
    (when (or budget charged dice)
      (add-agent runner (make-agent :client client :dice dice :budget budget
                                    :charged-p (and charged t))))
    (when trace (trace-changes runner))
    runner))

(defmethod print-object ((runner plan-runner) stream)
  (print-unreadable-object (runner stream :type t)
    (format stream "tick ~D, ~D task~:P" (runner-tick runner) (length (runner-roots runner)))))

(defconstant +steps-of-start+ 100
  "The start of a plan counts as this number of steps of a reaction. So endless starts of plans use
up the reaction before the heap. With a budget of steps, the start of a plan counts as one step.")

(defun start-plan (which plan &rest arguments)
  "Start PLAN, a plan procedure or its name, with ARGUMENTS as a top-level task of WHICH, an agent
or, for its first agent, a plan runner. Return the task, which runs at the next reaction."
  (multiple-value-bind (body environment) (apply #'enter-plan plan arguments)
    (let* ((agent (agent-of which)) (runner (agent-runner agent))
           (name (if (procedure-p plan) (procedure-name plan) plan)))
      (with-owned-home (runner)
        (let ((task (make-task name body)))
          (setf (task-agent task) agent)
          (spawn nil body environment 0 0 task)
          (count-slow-step +steps-of-start+ agent)
          (push task (runner-roots runner))
          (call-listeners *plan-start-hooks* task)
          task)))))

;;; Ending.

(defun stop-plan (runner &optional task)
  "From any thread, evaporate TASK, or all tasks of RUNNER if TASK is NIL, before the next step."
  (mapc #'request-end (if task (list task) (plan-runner-tasks runner))))

(defun end-at-once (runner tasks &optional only)
  "End the top-level TASKS of RUNNER. Give up cleanups that take time. ONLY is as for REACT."
  (dolist (agent (or only (runner-agents runner))) (set-charges agent nil nil))
  (mapc #'request-end tasks)
  (react runner only)
  (loop for part = (some #'cleaning-part (remove-if #'task-over-p tasks))
        while part
        do (with-owned-home (runner) (give-up-cleanup part))
           (react runner only)))

(defun end-tasks-at-once (runner tasks)
  "Evaporate the top-level TASKS of RUNNER, which must not be reacting. Cleanups run as far as they
take no time; the other cleanups are abandoned, with a warning for each. Charges of the agents of
TASKS end: see SET-CHARGES. Plans of other agents do not go on meanwhile."
  (let ((agents (remove-duplicates (mapcar #'task-agent tasks))))
    (when tasks
      (end-at-once runner tasks (and (set-difference (runner-agents runner) agents) agents)))))

(defun close-runner (runner)
  "Evaporate all tasks of RUNNER, as END-TASKS-AT-ONCE does. No task is left. Charges end, and posts
are ignored."
  (end-at-once runner (plan-runner-tasks runner))
  (setf (home-closed-p runner) t))

;;; Time.

(defun note-tick (runner tick)
  "Set the time of RUNNER to TICK, outside of reactions. The next reaction wakes tasks due at TICK."
  (setf (runner-tick runner) tick))

(defun advance-timers (runner tick)
  "Set the time of RUNNER to TICK, and wake the tasks that wait for this time."
  (setf (runner-tick runner) tick)
  (with-owned-home (runner) (run-timers (runner-timers runner) tick)))

(defun next-wake-time (runner)
  "Return the tick of the earliest timer of RUNNER, or NIL."
  (let ((timer (next-timer (runner-timers runner))))
    (and timer (timer-due timer))))

(defun outside-request-p (runner)
  "True if something is posted to RUNNER, or the end of a task is requested. Any thread may ask."
  (and (or (runner-ends-requested runner) (posted-p runner)) t))

(defun runner-idle-p (runner)
  "True if no task of RUNNER is ready and nothing is posted: only time or a post can change RUNNER."
  (not (or (any-task-ready-p runner) (outside-request-p runner))))

(defun skip-idle-tick (runner tick)
  "Set the time of RUNNER to TICK without a reaction, if no task would run then. Return true if so."
  (let ((wake (next-wake-time runner)))
    (unless (or (and wake (<= wake tick))
                (not (runner-idle-p runner))
                (runner-notices runner)
                (loop for agent in (runner-agents runner)
                      thereis (or (agent-charged-p agent) (agent-budget agent)))
                (home-busy-p runner))
      (setf (runner-tick runner) tick)
      t)))

(defun plan-deadlocked-p (runner)
  "True if tasks of RUNNER wait and nothing can wake them: there is no timer and no possible post."
  (and (runner-roots runner)
       (runner-idle-p runner)
       (null (next-wake-time runner))
       (not (funcall (runner-busy-p runner)))))

;;; Chance, and the state of it all.

(defun reseed-agent (agent seed &optional (purpose :plans))
  "From now on, draw the random choices of plans of AGENT from the integer SEED and from PURPOSE, a
string designator."
  (setf (agent-dice agent) (make-dice seed purpose)
        (agent-lisps-dice agent) nil))

(defun state-of-agent (agent)
  "Return a list of the state of the dice of AGENT, its debt, and until when it is stopped. Without
AGENT, return that of a new agent. A fraction of a tick that it has yet to be charged comes last."
  (if agent
      (list* (and (agent-dice agent) (dice-state (agent-dice agent)))
             (agent-debt agent) (agent-still-until agent)
             (unless (zerop (agent-unpaid agent)) (list (agent-unpaid agent))))
      (list nil 0 nil)))

(defun digest-runner (runner digest)
  "Add the state of RUNNER to DIGEST: its tasks, the tick of its next timer, and the dice and
charges of its agents."
  (destructuring-bind (&optional first &rest others) (runner-agents runner)
    (digest-add digest (list* (runner-tick runner) (next-wake-time runner) (state-of-agent first)))
    (dolist (agent others) (digest-add digest (state-of-agent agent))))
  (dolist (task (mapcan #'all-tasks (runner-roots runner)))
    (digest-add digest (list (task-serial task) (task-state task) (task-level task)
                             (form-text (task-form task))))))

;;;; Plans without a robot, in virtual time

(defun run-until-over (runner task limit)
  "Run RUNNER's plans until TASK is over. Return its state, :deadlock or :limit past tick LIMIT."
  (loop
    (react-to-all runner)
    (let ((wake (next-wake-time runner))
          (idle-p (runner-idle-p runner))
          (tick (runner-tick runner)))
      (cond ((task-over-p task) (return (task-state task)))
            ((and idle-p (null wake)) (return :deadlock))
            ((and limit (> (or wake tick) limit))
             (note-tick runner (max limit tick))
             (return :limit))
            (t (advance-timers runner (if idle-p wake (1+ tick))))))))

(defun end-plan-alone (runner task limit)
  "Evaporate TASK of RUNNER, if TASK is not over. Cleanups of TASK may run until tick LIMIT, or, if
LIMIT is NIL, until nothing can run. The other cleanups are abandoned, with a warning for each."
  (stop-plan runner task)
  (loop (run-until-over runner task limit)
        (let ((part (cleaning-part task)))
          (when (or (task-over-p task) (null part)) (return))
          (with-owned-home (runner) (give-up-cleanup part)))))

(addition run-plan-alone)
(defun run-plan-alone (plan &key arguments (runner (make-plan-runner)) limit)
  "In virtual time, let RUNNER run PLAN, a plan procedure or its name, with the list ARGUMENTS. Time
jumps to the next tick at which a task wakes. Return the plan's value, or its failure. The second
value is :succeeded, :failed, :evaporated, :deadlock (reported as an error message) or :limit (if
the tick LIMIT came first). If the plan is not over then, or at a non-local exit from
RUN-PLAN-ALONE, the plan is ended; cleanups run until tick LIMIT at most. Signals WRONG-ARGUMENT."
  (check-argument run-plan-alone arguments (proper-list-p arguments) "a list of arguments")
  (check-argument run-plan-alone limit (or (null limit) (bounded-number-p limit))
                  "a tick, a number up to 1e15, or NIL")
  (let ((task (apply #'start-plan runner plan arguments)) (state nil))
    (in-any-case
      (progn (setf state (run-until-over runner task limit))
             (when (eq state :deadlock) (report-deadlock runner)))
      (unless (task-over-p task)
        (allowing-interrupts (end-plan-alone runner task limit))))
    (values (task-result task) state)))
