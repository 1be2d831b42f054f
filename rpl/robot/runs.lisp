;;;; runs.lisp -- running plans on a robot, headless or live.

(in-package :ars-magna.rpl-robot)

(export '(*plan-failed* ensure-interface begin-plan-in-interface
          note-robot-commanded pass-until final-state-of-task
          plan-ending-p))

(addition *plan-limit*)
(defparameter *plan-limit* 100000
  "How many ticks RUN-PLAN lets pass, headless, before it gives a plan up.")

(defun robot-to-drive ()
  "Return the robot of the current simulation that plans drive by default: the only one, or the
prompt's. Signals MISUSE if several robots are possible, or the run is over."
  (check-not-over (current-simulation))
  (let ((robots (simulation-robots (current-simulation))))
    (cond ((= 1 (length robots)) (first robots))
          ((find (commanded-robot) robots))
          (t (reject-use "There are ~D robots here. Say which is to be driven, before the plan, ~
                          not in it: (rpl-init-robot ~:[ROBOT~;~:*~(~A~)~])."
                         (length robots)
                         (and robots (robot-name (first robots))))))))

(defun note-robot-commanded ()
  "Note that the prompt of this thread commands another robot from now on: plans that begin later
drive that one, even after an RPL-INIT-ROBOT."
  (let ((interface (usable-interface)))
    (when interface (setf (interface-commanded interface) :none))))

(defun robot-commanded-since (interface)
  "Return the robot that the prompt commands if it did not yet when INTERFACE was made, or has been
told since to command it, and plans drive another; or NIL."
  (let ((robot (and (interface-commanded interface) (commanded-robot))))
    (and robot
         (not (eq robot (interface-commanded interface)))
         (not (eq robot (interface-robot interface)))
         robot)))

(defun ensure-interface ()
  "Return the interface in use; make one for ROBOT-TO-DRIVE if there is none, and for the robot that
the prompt has begun to command since."
  (let* ((interface (usable-interface))
         (robot (and interface (robot-commanded-since interface))))
    (when (and robot (tasks-of interface))
      (reject-use "Plans drive one robot of a run at a time, now ~A. (end-plan :all) ends what ~
                   drives that."
                  (interface-robot interface)))
    (cond (robot (init-robot robot))
          (interface)
          (t (init-robot (robot-to-drive))))))

(defun begin-plan-in-interface (interface plan arguments note)
  "Start PLAN with the list ARGUMENTS by INTERFACE, and return its task. NOTE, a function, has been
called with that before anything else can happen."
  (check-not-secluded (interface-simulation interface))
  (apply #'note-of-plans interface #'do-traced *trace-plans* #'begin-plan plan arguments)
  (prog1 (with-plans (interface)
           ;; Live, plans may not have reacted for long.
           (note-tick (interface-runner interface)
                      (simulation-tick (interface-simulation interface)))
           (let ((task (apply #'start-plan (interface-runner interface) plan arguments)))
             (funcall note task)
             task))
    (ensure-thread interface)
    (call-to-plans interface)))

(defun warn-if-no-ticks-pass (plan interface)
  "Say once for the robot of INTERFACE if PLAN, begun on it, waits for a run to go on."
  (let ((robot (interface-robot interface)))
    (when (and (between-runs-p (robot-world robot)) (null *asker*) (not *caller-passes-ticks-p*))
      (warn-once-in-run
       interface (list :kept (robot-name robot) :plan)
       "The plan ~A waits until ticks pass: none of ~A do by themselves now. (run-ticks ~
        N) lets some pass, (simulator '~(~A~)) all that come."
       (if (symbolp plan) (string-downcase plan) "that was begun")
       robot (robot-name robot)))))

(addition begin-plan)
(defun begin-plan (plan &rest arguments)
  "Start PLAN, a plan procedure or its name, with ARGUMENTS, and return its task at once. Headless
it runs as ticks pass; live in its own thread. Signals UNKNOWN-NAME."
  (let ((interface (ensure-interface)))
    (prog1 (begin-plan-in-interface interface plan arguments #'identity)
      (warn-if-no-ticks-pass plan interface))))

(defconstant +longest-report+ 4000
  "How many characters a report of plans has at most.")

(defun ended-by-itself-p (task)
  (and (task-over-p task) (not (eq :evaporated (task-state task)))))

(defun pass-until (interface over last)
  "Pass ticks, headless, in which the plans of INTERFACE react, until OVER, a function, returns
true. Return that; :STOPPED if no plan can go on, :DEADLOCK if none ever will, :LIMIT at tick LAST."
  (let ((simulation (interface-simulation interface)))
    (note-of-plans interface #'repeat-reaction)
    (with-plans (interface) (react-fully interface))
    (loop
      (let ((how (funcall over))) (when how (return how)))
      (cond ((not (interface-valid-p interface)) (return :stopped))
            ((deadlocked-p interface) (return :deadlock))
            ((>= (simulation-tick simulation) last) (return :limit)))
      (run-ticks 1 simulation))))

(defun final-state-of-task (interface task)
  "Return the state of TASK if it is over; :STOPPED if it evaporated with all plans of INTERFACE."
  (cond ((not (task-over-p task)) nil)
        ((or (ended-by-itself-p task) (interface-valid-p interface)) (task-state task))
        (t :stopped)))

(defun run-headless (interface task)
  "Pass ticks until TASK is over. Return its state, or why it is not over."
  (check-argument run-plan *plan-limit* (within-reason-p *plan-limit*)
                  "a number of ticks, up to 1e9")
  (pass-until interface
              (lambda () (final-state-of-task interface task))
              (+ (simulation-tick (interface-simulation interface)) *plan-limit*)))

(defun await-over (interface task)
  "Wait live until TASK ends. Return its state, or why not. Warn once if only calls can wake plans."
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
                    ((task-over-p task) (return (task-state task)))
                    ;; A plan at a break holds the plans until that is answered, perhaps here.
                    ((and (not told)
                          (null (interface-holder interface))
                          (deadlocked-p interface))
                     (setf told t)
                     (with-plans (interface) (report-stillness (interface-runner interface)))))
              (doubt-wait 'run-plan simulation)
              (wait-a-while over 0.2))
        (asking (simulation) (remove-observer #'look simulation))))))

(defun check-outside (interface)
  "Signal MISUSE where waiting for a plan would keep that plan from going on."
  (when (holding-p interface)
    (reject-use "run-plan: a plan is at work here. Let it call the other plan instead."))
  (when (eq (current-thread) (simulation-thread (interface-simulation interface)))
    (reject-use "run-plan: the simulator would wait for itself. Use begin-plan here."))
  (doubt-wait 'run-plan (interface-simulation interface)))

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

(defvar *plan-failed* (constantly nil)
  "A function of the task of a plan that RUN-PLAN ran and that failed; a trial binds it.")

;; A failure is true, so a program that only asks whether there is a value takes it for success.
(defun warn-of-failure (interface task)
  "Say once for each plan of a run that TASK, which RUN-PLAN ran for a program, failed."
  (let ((simulation (interface-simulation interface)))
    (funcall *plan-failed* task)
    (unless (or *asker*
                (typep (task-result task) 'lisp-failure) ; an error is reported anyway
                (message-queue-listener (simulation-messages simulation))
                (not (eq :report (message-queue-error-policy (simulation-messages simulation)))))
      (warn-once-in-run
       interface (list :failed (task-label task))
       "The plan ~A failed: ~A~@[; ~A~]. The second value of RUN-PLAN says so, :FAILED; ~
        the first is the failure, which is true."
       (task-label task)
       (failure-text (task-result task))
       (similar-clause-text (task-result task))))))

(addition run-plan)
(defun run-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or its name, with ARGUMENTS. Return its value, or its failure, and
how it ended. Test the second value: a failure is true, and the value of a successful plan may be
NIL.
  :succeeded, :failed, :evaporated: as the task.
  :deadlock: headless; the plan waits for what can never happen. Live there is only a warning, since
somebody may still make it happen.
  :limit: headless; *PLAN-LIMIT* ticks have passed.
  :stopped: the simulator was stopped or restarted, the robot was redefined, or another thread
rewound the run.
The robot is that of RPL-INIT-ROBOT; without that the only one of the current simulation, or at the
prompt the one commanded there, even if that has changed since RPL-INIT-ROBOT. Failures, deadlocks
and limits are reported. A plan that is not over when RUN-PLAN returns or is left, as by an abort,
is ended; but a plan of a rewound run continues in the run that replaces it. Signals UNKNOWN-NAME,
and MISUSE, also if the run is over before it begins."
  (let ((interface (ensure-interface)))
    (check-outside interface)
    (let ((task nil) (state nil))
      (in-any-case
        (progn (begin-plan-in-interface interface plan arguments
                                        (lambda (begun)
                                          (setf task begun)
                                          (atomic-push begun (interface-awaited interface))))
               (setf state (await-plan interface task))
               (when (eq :failed state) (warn-of-failure interface task)))
        (when (and task (not (task-over-p task))) (end-plans-of-interface interface task))
        (when task (atomic-remove task (interface-awaited interface))))
      (values (task-result task) state))))

(addition plans)
(defun plans ()
  "Return a list of the tasks of the plans under way, in order of their start."
  (let ((interface (usable-interface)))
    (when interface
      (note-plans-shown interface)
      (tasks-of interface))))

(defun want-end (interface task)
  "Ask TASK of INTERFACE, or all if it is NIL, to evaporate; its runner does it later."
  (check-not-secluded (interface-simulation interface))
  (note-of-plans interface #'repeat-call #'repeat-end '() (and task (task-serial task)))
  (dolist (task (if task (list task) (tasks-of interface)))
    (unless (task-over-p task) (atomic-push task (interface-ends-requested interface))))
  (stop-plan (interface-runner interface) task))

(defun end-plans-of-interface (interface task)
  "Evaporate TASK of INTERFACE, or all if it is NIL: now, or later in the thread of the plans."
  (want-end interface task)
  (unless (or (holding-p interface) (thread-of interface))
    (asking ((interface-simulation interface))
      (with-plans (interface) (react-fully interface)))))

(defun repeat-end (subject)
  "Repeat the end of SUBJECT, a task or, for all of its plans, a runner."
  (end-plans-of-interface (usable-interface) (and (task-p subject) subject)))

(defun plan-ending-p (task)
  "True if TASK, a plan, was ended from outside; it may still be running."
  (let ((interface (usable-interface)))
    (or (task-over-p task)
        (task-ending-p task)
        (and interface (member task (interface-ends-requested interface)) t))))

(defun end-task (task)
  "Evaporate TASK, of any runner: at once if it belongs to the current plans."
  (let ((interface (and (task-runner task) (runner-client (task-runner task)))))
    (cond ((or (null (task-runner task)) (task-over-p task)))
          ((null interface) (stop-plan (task-runner task) task))
          ((eq interface (interface-in-use-here)) (end-plans-of-interface interface task))
          (t (want-end interface task)))))

(defun elsewhere-p (interface)
  "True if this thread works in a run that continues that of INTERFACE: a fork of it, or the one
that has replaced it since a rewind."
  (and *simulation*
       (not (eq *simulation* (interface-simulation interface)))
       (or (fork-p *simulation*)
           (eq *simulation* (latest (interface-simulation interface))))))

(defmethod current-counterpart ((interface interface) task)
  (let ((latest (latest (interface-simulation interface))))
    (cond ((elsewhere-p interface) (counterpart-of-task task *simulation*))
          ((not (eq latest (interface-simulation interface))) (counterpart-of-task task latest))
          (t task))))

(defun task-in-current-run (task)
  (let ((client (and (task-runner task) (runner-client (task-runner task)))))
    (if client (current-counterpart client task) task)))

(addition end-plan)
(defun end-plan (task)
  "End the plan TASK, or all plans if it is :ALL. Their commands in progress are interrupted, except
those of cleanups. Lisp code of a live plan that keeps the plans' thread is aborted. Any thread may
end a TASK; one of another simulation ends when that goes on. A TASK that is over stays as it is.
Returns nothing. Signals WRONG-ARGUMENT; and MISUSE if there is no robot for :ALL, or if the run of
TASK was rewound to before its start."
  (check-argument end-plan task (or (eq task :all) (task-p task))
                  "a task, as begin-plan returns, or :ALL")
  (if (eq task :all)
      (end-plans-of-interface (the-interface) nil)
      (end-task (task-in-current-run task)))
  (values))

;;; The name of a plan that is not quoted is a variable to Lisp.

(defun doubt-plan-form (operator form environment)
  "Warn if FORM, for the plan that OPERATOR is to run, is the name of a plan and no variable."
  (when (and form (symbolp form) (not (known-variable-p form environment)))
    (when (find-procedure form nil)
      (doubt-definition "~A: ~A is a plan and no variable. Quote its name: '~:*~A"
                        operator form))))

(define-compiler-macro run-plan (&whole form &rest arguments &environment environment)
  (doubt-plan-form 'run-plan (first arguments) environment)
  form)

(define-compiler-macro begin-plan (&whole form &rest arguments &environment environment)
  (doubt-plan-form 'begin-plan (first arguments) environment)
  form)
