;;;; runs.lisp -- running plans on a robot, headless or live.

(in-package :ars-magna.rpl-robot)

(export '(*on-plan-failure* begin-plan-with-driver pass-until final-state-of-task plan-ending-p))

(addition *plan-limit*)
(defparameter *plan-limit* 100000
  "The number of ticks after which RUN-PLAN gives up a plan in a headless run.")

(defun begin-plan-for (robot plan arguments)
  (begin-plan-with-driver (ensure-driver robot) plan arguments #'identity))

(defun begin-plan-with-driver (driver plan arguments note)
  "Start PLAN with the list ARGUMENTS for DRIVER, and return its task. Call the function NOTE with
the task before anything else can happen."
  (let* ((interface (driver-interface driver)) (simulation (interface-simulation interface)))
    (check-not-secluded simulation)
    (record-plan-action interface #'call-with-trace *trace-plans* #'begin-plan-for
                        (driver-robot driver) plan arguments)
    (prog1 (with-plans (interface)
             ;; Live, plans may not have reacted for long.
             (note-tick (interface-runner interface) (simulation-tick simulation))
             (renew-plans-dice driver)
             (let ((task (let ((*begun-driver* driver))
                           (apply #'start-plan (driver-agent driver) plan arguments))))
               (funcall note task)
               task))
      (ensure-thread interface)
      (wake-plans-or-owner interface))))

(defun warn-if-no-ticks-pass (plan driver)
  "Warn once for the robot of DRIVER if no ticks pass now, so that PLAN waits."
  (let ((robot (driver-robot driver)))
    (when (and (between-runs-p (robot-world robot)) (null *asker*) (not *caller-passes-ticks-p*))
      (warn-once-in-run
       (driver-interface driver) (list :kept (robot-name robot) :plan)
       "The plan ~A waits until ticks pass: no ticks of ~A pass by themselves now. (run-ticks N) ~
        lets N ticks pass, (simulator '~(~A~)) lets time go on."
       (if (symbolp plan) (string-downcase plan) "that was begun")
       robot (robot-name robot)))))

(addition begin-plan)
(defun begin-plan (plan &rest arguments)
  "Start PLAN, a plan procedure or its name, with ARGUMENTS, and return its task at once. PLAN runs
as ticks pass in a headless run, and in the plans' thread in a live run. ARGUMENTS may end with
:ROBOT and the robot, or its name, that PLAN drives, unless PLAN itself takes the keyword :ROBOT.
Without it, PLAN drives the robot of the calling plan or, outside of plans, the robot that RUN-PLAN
would choose. Signals UNKNOWN-NAME."
  (multiple-value-bind (arguments robot) (split-arguments plan arguments)
    (let ((driver (driver-for-plan robot plan)))
      (prog1 (begin-plan-with-driver driver plan arguments #'identity)
        (warn-if-no-ticks-pass plan driver)))))

(defconstant +longest-report+ 4000
  "The largest number of characters in a report of plans.")

(defun ended-by-itself-p (task)
  (and (task-over-p task) (not (eq :evaporated (task-state task)))))

(defun pass-until (interface over last)
  "Pass ticks in a headless run, in which the plans of INTERFACE react, until the function OVER
returns true. Return the value of OVER; :STOPPED if INTERFACE has become invalid, :DEADLOCK if no
plan will ever go on, or :LIMIT at tick LAST."
  (let ((simulation (interface-simulation interface)))
    (record-plan-action interface #'repeat-reaction)
    (with-plans (interface) (react-fully interface))
    (loop
      (let ((how (funcall over))) (when how (return how)))
      (cond ((not (interface-valid-p interface)) (return :stopped))
            ((deadlocked-p interface) (return :deadlock))
            ((>= (simulation-tick simulation) last) (return :limit)))
      (run-ticks 1 simulation))))

(defun final-state-of-task (interface task)
  "Return TASK's state if over, :STOPPED if it evaporated with all plans of its robot, else NIL."
  (cond ((not (task-over-p task)) nil)
        ((or (ended-by-itself-p task)
             (and (interface-valid-p interface) (driver-valid-p (driver-of-plan task))))
         (task-state task))
        (t :stopped)))

(defun run-headless (interface task)
  "Pass ticks until TASK is over. Return the state of TASK, or :STOPPED, :DEADLOCK or :LIMIT."
  (check-argument run-plan *plan-limit* (sane-number-p *plan-limit*)
                  "a number of ticks, up to 1e9")
  (pass-until interface
              (lambda () (final-state-of-task interface task))
              (+ (simulation-tick (interface-simulation interface)) *plan-limit*)))

(defun await-over (interface task)
  "Wait in a live run until TASK ends. Return the state of TASK, or :STOPPED. Warn once if only
calls from outside can wake the plans."
  (let ((over (make-semaphore "plan over"))
        (simulation (interface-simulation interface))
        (told nil))
    (flet ((look (simulation)
             (declare (ignore simulation))
             (when (task-over-p task) (signal-semaphore over))))
      (asking (simulation) (add-observer #'look simulation))
      (in-any-case
        (loop (cond ((ended-by-itself-p task) (return (task-state task)))
                    ((not (and (live-p simulation) (interface-valid-p interface)))
                     (return :stopped))
                    ((task-over-p task) (return (final-state-of-task interface task)))
                    ;; A plan at a break holds the plans until that is answered, perhaps here.
                    ((and (not told)
                          (null (interface-holder interface))
                          (deadlocked-p interface))
                     (setf told t)
                     (with-plans (interface) (warn-of-outside-waits (interface-runner interface)))))
              (check-wait-while-paused 'run-plan simulation)
              (serve-and-wait-once over 0.2))
        (ask-later simulation (lambda () (remove-observer #'look simulation)))))))

(defun check-may-wait (interface)
  "Signal MISUSE if waiting for a plan in this thread would keep the plan itself from going on."
  (when (holding-plans-p interface)
    (reject-use "run-plan: a plan is at work here. Call the other plan as a step of that plan."))
  (when (eq (current-thread) (simulation-thread (interface-simulation interface)))
    (reject-use "run-plan: the simulator would wait for itself. Use begin-plan here."))
  (check-wait-while-paused 'run-plan (interface-simulation interface)))

;;; Plans that did not end.

(defun report-limit (interface task)
  (error-set "The plan " (task-label task) " was given up at tick "
             (simulation-tick (interface-simulation interface)) ", after " *plan-limit*
             " ticks; see *PLAN-LIMIT*."
             (format nil "~@[ ~A~]" (endless-advice (remove-if #'task-children (all-tasks task))))
             " It was at:" t
             (cut (with-output-to-string (stream) (print-tasks task stream)) +longest-report+)))

(defun await-plan (interface task)
  (let ((state (if (live-p (interface-simulation interface))
                   (await-over interface task)
                   (run-headless interface task))))
    (case state
      (:deadlock (with-plans (interface) (report-deadlock (interface-runner interface))))
      (:limit (with-plans (interface) (report-limit interface task))))
    state))

(defvar *on-plan-failure* (constantly nil)
  "A function that RUN-PLAN calls with the task of a failed plan. Trials bind this variable.")

;; A failure is true, so a program that only asks whether there is a value takes it for success.
(defun warn-of-failure (interface task)
  "TASK, which RUN-PLAN ran for a program, has failed. Warn of this once for each plan of a run."
  (let ((simulation (interface-simulation interface)))
    (funcall *on-plan-failure* task)
    (unless (or *asker*
                (typep (task-result task) 'lisp-failure) ; an error is reported anyway
                (message-queue-listener (simulation-messages simulation))
                (not (eq :report (message-queue-error-policy (simulation-messages simulation)))))
      (warn-once-in-run
       interface (list :failed (task-label task))
       "The plan ~A failed: ~A~@[; ~A~]. The second value of RUN-PLAN is :FAILED; the first is the ~
        failure, which counts as true."
       (task-label task)
       (failure-text (task-result task))
       (misspelt-handler-text (task-result task))))))

(addition run-plan)
(defun run-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or its name, with ARGUMENTS. Return two values: the plan's value, or
its failure; and how the plan ended. Test the second value: a failure counts as true, and the value
of a successful plan may be NIL.
  :succeeded, :failed, :evaporated: the state of the plan's task.
  :deadlock: only in a headless run; the plan waits for what can never happen. In a live run there
is only a warning, since you may still make it happen.
  :limit: only in a headless run; *PLAN-LIMIT* ticks have passed.
  :stopped: the simulator was stopped or restarted, the robot was redefined, or another thread
rewound the run. ARGUMENTS may end with :ROBOT and the robot that PLAN drives, as for BEGIN-PLAN.
Otherwise PLAN drives the robot of the last RPL-INIT-ROBOT or, without such a call, the only robot
of the current simulation. At the prompt, PLAN drives the robot that the prompt commands, even if
the prompt has changed to that robot since RPL-INIT-ROBOT. Failures, deadlocks and limits are
reported.
RUN-PLAN ends a plan that is not over when RUN-PLAN returns or is aborted. But a plan of a rewound
run continues in the run that replaces the rewound run. Signals UNKNOWN-NAME; and MISUSE, for
example if the run is over before the plan begins."
  (multiple-value-bind (arguments robot) (split-arguments plan arguments)
    (run-plan-with-driver (driver-for-plan robot plan) plan arguments)))

(defun run-plan-with-driver (driver plan arguments)
  "Run PLAN with the list ARGUMENTS for DRIVER, and return what RUN-PLAN returns."
  (let ((interface (driver-interface driver)))
    (check-may-wait interface)
    (let ((task nil) (state nil))
      (in-any-case
        (progn (begin-plan-with-driver driver plan arguments
                                       (lambda (begun)
                                         (setf task begun)
                                         (atomic-push begun (interface-awaited interface))))
               (setf state (await-plan interface task))
               (when (eq :failed state) (warn-of-failure interface task)))
        (when (and task (not (task-over-p task))) (end-plans-of-interface interface task))
        (when task (atomic-remove task (interface-awaited interface))))
      (values (task-result task) state))))

(addition plans)
(defun plans (&optional robot)
  "Return a list of the tasks of the plans under way, in order of their start: of all plans of the
current run or, if ROBOT is given, of those that were begun for this robot, which may be given by
its name. Signals UNKNOWN-NAME."
  (let* ((robot (and robot (robot-meant-in-plan robot))) (interface (usable-interface)))
    (when interface
      (note-plans-shown interface)
      (if robot
          (let ((driver (find-driver robot interface))) (and driver (tasks-of-driver driver)))
          (tasks-of-interface interface)))))

(defun request-plan-end (interface subject)
  "Request that the plan runner later evaporates SUBJECT of INTERFACE: a task, the tasks of a driver
or, if SUBJECT is NIL, all tasks."
  (check-not-secluded (interface-simulation interface))
  (record-plan-action interface #'repeat-call #'repeat-plan-end '()
                      (and (task-p subject) (task-serial subject))
                      (and (driver-p subject) (driver-robot subject)))
  (let ((tasks (cond ((task-p subject) (list subject))
                     (subject (tasks-of-driver subject))
                     (t (tasks-of-interface interface)))))
    (dolist (task tasks)
      (unless (task-over-p task) (atomic-push task (interface-ends-requested interface))))
    (dolist (task tasks) (stop-plan (interface-runner interface) task))))

(defun end-plans-of-interface (interface subject)
  "Evaporate SUBJECT, as for REQUEST-PLAN-END: now, or later in the plans' thread."
  (request-plan-end interface subject)
  (unless (or (holding-plans-p interface) (plans-thread interface))
    (asking ((interface-simulation interface))
      (with-plans (interface) (react-fully interface)))))

(defun repeat-plan-end (subject)
  "End SUBJECT, a task or all plans of an agent or plan runner, in a repeated run as in the original
run."
  (end-plans-of-interface (usable-interface) (cond ((task-p subject) subject)
                                                   ((agent-p subject) (agent-client subject)))))

(defun plan-ending-p (task)
  "True if TASK, a plan, is over or is to end. TASK may still be running."
  (let ((interface (usable-interface)))
    (or (task-over-p task)
        (task-ending-p task)
        (and interface (member task (interface-ends-requested interface)) t))))

(defun end-task (task)
  (let ((interface (and (task-runner task) (runner-client (task-runner task)))))
    (cond ((or (null (task-runner task)) (task-over-p task)))
          ((null interface) (stop-plan (task-runner task) task))
          ((eq interface (interface-in-use-here)) (end-plans-of-interface interface task))
          (t (request-plan-end interface task)))))

(defun in-later-run-p (interface)
  "True if this thread works in a fork of the run of INTERFACE, or in the run that has replaced the
run of INTERFACE in a rewind."
  (and *simulation*
       (not (eq *simulation* (interface-simulation interface)))
       (or (fork-p *simulation*)
           (eq *simulation* (latest-successor (interface-simulation interface))))))

(defmethod current-counterpart ((driver driver) task)
  (let* ((interface (driver-interface driver))
         (latest (latest-successor (interface-simulation interface))))
    (cond ((in-later-run-p interface) (counterpart-of-task task *simulation*))
          ((not (eq latest (interface-simulation interface))) (counterpart-of-task task latest))
          (t task))))

(defun task-in-current-run (task)
  (let ((client (and (task-agent task) (task-client task))))
    (if client (current-counterpart client task) task)))

(defun end-all-plans (robot)
  "End the plans of ROBOT or, if ROBOT is NIL, all plans of the run. There may be none."
  (let* ((interface (usable-interface))
         (driver (and robot interface (find-driver robot interface))))
    (cond (driver (end-plans-of-interface interface driver))
          (robot nil)
          (interface (end-plans-of-interface interface nil))
          (*simulation* (check-not-over *simulation*))
          (t (reject-without-robot)))))

(addition end-plan)
(defun end-plan (task &key robot)
  "End the plan TASK. If TASK is :ALL, end all plans of the run or, if ROBOT is given, all that were
begun for this robot, which may be given by its name. Their commands in progress are interrupted,
except those of cleanups. Lisp code of a live plan that keeps the plans' thread is aborted. Any
thread may end a TASK; a task of another simulation ends when that simulation goes on. A TASK that
is over stays as it is. Returns nothing. Signals WRONG-ARGUMENT; UNKNOWN-NAME; and MISUSE without a
run, if ROBOT is not in the run, or if the run was rewound to a tick before TASK began."
  (check-argument end-plan task (or (eq task :all) (task-p task))
                  "a task, as begin-plan returns, or :ALL")
  (check-argument end-plan robot (or (null robot) (eq task :all)) "NIL unless TASK is :ALL")
  (cond ((not (eq task :all)) (end-task (task-in-current-run task)))
        (t (end-all-plans (and robot (drivable-robot robot)))))
  (values))

;;; The name of a plan that is not quoted is a variable to Lisp.

(defun warn-of-unquoted-plan (operator form environment)
  "Warn if FORM, the plan argument in a call of OPERATOR, is the name of a plan, not a variable."
  (when (and form (symbolp form) (not (known-variable-p form environment)))
    (when (find-procedure form nil)
      (warn-of-style "~A: ~A is a plan, not a variable. Quote its name: '~:*~A"
                     operator form))))

(define-compiler-macro run-plan (&whole form &rest arguments &environment environment)
  (warn-of-unquoted-plan 'run-plan (first arguments) environment)
  form)

(define-compiler-macro begin-plan (&whole form &rest arguments &environment environment)
  (warn-of-unquoted-plan 'begin-plan (first arguments) environment)
  form)
