;;;; robot-runs.lisp -- running plans on a robot, headless or live.

(in-package :ars-magna.rpl-robot)

(defparameter *plan-limit* 100000
  "How many ticks RUN-PLAN lets pass, headless, before it gives a plan up.")

(defun ensure-interface ()
  "Return an interface to the current simulation; make one if it has a single robot."
  (if (and (usable-p *interface*)
           (eq (interface-simulation *interface*) (or *simulation*
                                                      (interface-simulation *interface*))))
      *interface*
      (let ((robots (simulation-robots (current-simulation))))
        (unless (= 1 (length robots))
          (reject-use "There are ~D robots here. Say which is to be driven: (rpl-init-robot ROBOT)."
                      (length robots)))
        (rpl-init-robot (first robots))
        *interface*)))

(defun begin-in (interface plan arguments)
  (with-lock ((interface-lock interface))
    (prog1 (apply #'start-plan (interface-runner interface) plan arguments)
      (ensure-thread interface))))

(defun begin-plan (plan &rest arguments)
  "Start PLAN, a plan procedure or its name, with ARGUMENTS, and return its task at once. Headless
it goes on with the ticks; live in a thread of its own."
  (let ((interface (ensure-interface)))
    (prog1 (begin-in interface plan arguments)
      (wake interface))))

(defun run-headless (interface task)
  "Pass ticks until TASK is over. Return :deadlock or :limit if it does not come to that."
  (let* ((simulation (interface-simulation interface))
         (last (+ (simulation-tick simulation) *plan-limit*)))
    (with-lock ((interface-lock interface)) (react-fully interface))
    (loop
      (cond ((task-over-p task) (return (task-state task)))
            ((plan-deadlocked-p (interface-runner interface)) (return :deadlock))
            ((>= (simulation-tick simulation) last) (return :limit)))
      (run-ticks 1 simulation))))

(defun await-over (interface task)
  "Wait until TASK is over, live. Return its state, or :deadlock."
  (let ((over (make-semaphore "plan over"))
        (simulation (interface-simulation interface)))
    (flet ((look (simulation)
             (declare (ignore simulation))
             (when (task-over-p task) (signal-semaphore over))))
      (asking (simulation) (add-observer #'look simulation))
      (unwind-protect
           (loop until (or (wait-on-semaphore over 0.2) (task-over-p task))
                 do (when (with-lock ((interface-lock interface))
                            (plan-deadlocked-p (interface-runner interface)))
                      (return :deadlock))
                 finally (return (task-state task)))
        (asking (simulation) (remove-observer #'look simulation))))))

(defun run-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or its name, with ARGUMENTS on the robot of RPL-INIT-ROBOT, or on
the only one of the current simulation. Return what it returns, or the failure with which it failed,
and how it ended: :succeeded, :failed, :evaporated, :deadlock (it waits for what can never
come, which is reported) or :limit (*PLAN-LIMIT* ticks have passed, headless)."
  (let* ((interface (ensure-interface))
         (task (apply #'begin-plan plan arguments))
         (state (if (live-p (interface-simulation interface))
                    (await-over interface task)
                    (run-headless interface task))))
    (when (eq state :deadlock)
      (with-lock ((interface-lock interface)) (report-deadlock (interface-runner interface))))
    (unless (task-over-p task) (end-plan task))
    (values (task-result task) state)))

(defun plans ()
  "Return a list of the tasks of the plans under way, in order of their start."
  (if (usable-p *interface*)
      (plan-runner-tasks (interface-runner *interface*))
      '()))

(defun print-plans (&optional (stream *standard-output*))
  "Print the plans under way to STREAM, each as a tree of tasks: what each does and waits for."
  (if (usable-p *interface*)
      (with-lock ((interface-lock *interface*))
        (print-tasks (interface-runner *interface*) stream))
      (format stream "No plans.~%")))

(defun end-plan (task)
  "Let the plan TASK, or all plans if it is :ALL, evaporate. Returns nothing."
  (let ((interface (the-interface)))
    (stop-plan (interface-runner interface) (if (eq task :all) nil task))
    (unless (live-p (interface-simulation interface))
      (with-lock ((interface-lock interface)) (react-fully interface))))
  (values))
