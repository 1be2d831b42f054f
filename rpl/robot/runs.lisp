;;;; runs.lisp -- running plans on a robot, headless or live.

(in-package :ars-magna.rpl-robot)

(addition *plan-limit*)
(defparameter *plan-limit* 100000
  "How many ticks RUN-PLAN lets pass, headless, before it gives a plan up.")

(defun ensure-interface ()
  "Return the interface in use; make one if the current simulation has a single robot."
  (if (usable-p *interface*)
      *interface*
      (let ((robots (simulation-robots (current-simulation))))
        (unless (= 1 (length robots))
          (reject-use "There are ~D robots here. Say which is to be driven: (rpl-init-robot ROBOT)."
                      (length robots)))
        (rpl-init-robot (first robots))
        *interface*)))

(addition begin-plan)
(defun begin-plan (plan &rest arguments)
  "Start PLAN, a plan procedure or its name, with ARGUMENTS, and return its task at once. Headless
it goes on with the ticks; live in a thread of its own. Signals UNKNOWN-NAME."
  (let ((interface (ensure-interface)))
    (prog1 (with-plans (interface)
             (apply #'start-plan (interface-runner interface) plan arguments))
      (ensure-thread interface)
      (wake interface))))

(defun deadlocked-p (interface)
  (with-plans (interface) (plan-deadlocked-p (interface-runner interface))))

(defun ended-by-itself-p (task)
  "True if TASK is over, and nobody has made it evaporate."
  (and (task-over-p task) (not (eq :evaporated (task-state task)))))

(defun checked-plan-limit ()
  (check-argument run-plan *plan-limit* (within-reason-p *plan-limit*)
                  "a number of ticks, up to 1e9")
  *plan-limit*)

(defun run-headless (interface task)
  "Pass ticks until TASK is over. Return its state, or how it came that it is not over."
  (let* ((simulation (interface-simulation interface))
         (last (+ (simulation-tick simulation) (checked-plan-limit))))
    (with-plans (interface) (react-fully interface))
    (loop
      (cond ((ended-by-itself-p task) (return (task-state task)))
            ((not (interface-valid-p interface)) (return :stopped))
            ((task-over-p task) (return (task-state task)))
            ((deadlocked-p interface) (return :deadlock))
            ((>= (simulation-tick simulation) last) (return :limit)))
      (run-ticks 1 simulation))))

(defun await-over (interface task)
  "Wait until TASK is over, live. Return its state, or how it came that it is not over."
  (let ((over (make-semaphore "plan over"))
        (simulation (interface-simulation interface)))
    (flet ((look (simulation)
             (declare (ignore simulation))
             (when (task-over-p task) (signal-semaphore over))))
      (asking (simulation) (add-observer #'look simulation))
      (unwind-protect
           (loop (cond ((ended-by-itself-p task) (return (task-state task)))
                       ((not (and (live-p simulation) (interface-valid-p interface)))
                        (return :stopped))
                       ((task-over-p task) (return (task-state task)))
                       ((deadlocked-p interface) (return :deadlock)))
                 (wait-on-semaphore over 0.2))
        (asking (simulation) (remove-observer #'look simulation))))))

(defun check-outside (interface)
  "Signal MISUSE where waiting for a plan would keep that plan from going on."
  (when (holding-p interface)
    (reject-use "run-plan: a plan is at work here. Let it call the other plan instead."))
  (when (eq (current-thread) (simulation-thread (interface-simulation interface)))
    (reject-use "run-plan: the simulator would wait for itself. Use begin-plan here.")))

(addition run-plan)
(defun run-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or its name, with ARGUMENTS on the robot of RPL-INIT-ROBOT, or on
the only one of the current simulation. Return what it returns, or the failure with which it failed,
and how it ended: :succeeded, :failed, :evaporated, :deadlock (it waits for what can never
come, which is reported), :limit (*PLAN-LIMIT* ticks have passed, headless) or :stopped (the
simulator was stopped or started anew, or the robot defined anew). Signals UNKNOWN-NAME and MISUSE."
  (let ((interface (ensure-interface)))
    (check-outside interface)
    (let* ((task (apply #'begin-plan plan arguments))
           (state (if (live-p (interface-simulation interface))
                      (await-over interface task)
                      (run-headless interface task))))
      (when (eq state :deadlock)
        (with-plans (interface) (report-deadlock (interface-runner interface))))
      (unless (task-over-p task) (end-in interface task))
      (values (task-result task) state))))

(addition plans)
(defun plans ()
  "Return a list of the tasks of the plans under way, in order of their start."
  (if (usable-p *interface*)
      (plan-runner-tasks (interface-runner *interface*))
      '()))

(defun end-in (interface task)
  "Let TASK of INTERFACE, or all if it is NIL, evaporate: now, or when their thread gets to it."
  (stop-plan (interface-runner interface) task)
  (unless (or (holding-p interface) (interface-thread interface))
    (with-plans (interface) (react-fully interface))))

(addition end-plan)
(defun end-plan (task)
  "Let the plan TASK, or all plans if it is :ALL, evaporate. Returns nothing. Signals
WRONG-ARGUMENT."
  (check-argument end-plan task (or (eq task :all) (task-p task))
                  "a task, as begin-plan returns, or :ALL")
  (end-in (the-interface) (if (eq task :all) nil task))
  (values))
