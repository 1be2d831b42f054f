;;;; engine.lisp -- running plans: reactions, batches from outside, time, and plans without a robot.

(in-package :ars-magna.rpl.tasks)

(export '(advance-timers note-tick apply-next-batch close-runner digest-runner runner-idle-p
          make-plan-runner next-wake-time outside-request-p plan-deadlocked-p skip-idle-tick
          react-to-all reseed-runner start-plan stop-plan))

;;; A reaction runs ready tasks until none is ready. Only then is the next posted batch applied, and
;;; time passes only when there is none. So a task that issues a command and waits for its pulse has
;;; reached the wait before the pulse can come.
;;;
;;; The engine is independent of the simulator. Its client calls REACT-TO-ALL and ADVANCE-TIMERS,
;;; in one thread at a time; any thread may post.

(defun make-plan-runner (&key trace budget charged clock (slow 0.1d0) dice (ticks-per-second 20)
                           (tick 0) client (busy-p (constantly nil)) (on-post #'list)
                           (attended-p (constantly nil))
                           (on-end #'report-end))
  "Return a new plan runner whose time is TICK.
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
  (let ((runner (%make-plan-runner :trace (and trace (make-trace)) :budget budget
                                   :charged-p (and charged t) :clock clock
                                   :slow slow :dice dice :ticks-per-second ticks-per-second
                                   :tick tick :client client :busy-p busy-p :on-post on-post
                                   :attended-p attended-p :repairer #'repair-after-exit
                                   :on-end on-end)))
    (when trace (trace-changes runner))
    runner))

(defmethod print-object ((runner plan-runner) stream)
  (print-unreadable-object (runner stream :type t)
    (format stream "tick ~D, ~D task~:P" (runner-tick runner) (length (runner-roots runner)))))

(defconstant +steps-of-start+ 100
  "The start of a plan counts as this number of steps of a reaction. So endless starts of plans use
up the reaction before the heap. With a budget of steps, the start of a plan counts as one step.")

(defun start-plan (runner plan &rest arguments)
  "Start PLAN, a plan procedure or its name, with ARGUMENTS as a top-level task of RUNNER. Return
the task, which runs at the next reaction."
  (multiple-value-bind (body environment) (apply #'enter-plan plan arguments)
    (let ((name (if (procedure-p plan) (procedure-name plan) plan)))
      (with-owned-home (runner)
        (let ((task (spawn nil body environment 0 0 (make-task name body))))
          (count-slow-step +steps-of-start+ runner)
          (push task (runner-roots runner))
          (call-listeners *plan-start-hooks* task)
          task)))))

;;; Reacting. In a round every ready task runs until it waits, ends or has used its slice. Then the
;;; next post is applied. Tasks that have used their slices get new ones only when there are no
;;; more posts. So a plan that never waits does not keep others from reacting. Where a tick has a
;;; budget, slices are shares of it. A plan may then need several from a command to its wait, so
;;; there another limit than slices decides when posts are applied.

(defun run-ready-tasks (runner)
  "Run the ready tasks of RUNNER. Return :idle when no ready task has steps left in its slice.
Return :budget when the steps of the reaction are used up, or when all tasks stop while one thinks."
  (loop
    (when (runner-ends-requested runner) (end-requested-tasks runner))
    (when (or (>= (runner-steps runner) (runner-limit runner))
              (runner-tasks-stopped-p runner))
      (return :budget))
    (when (runner-notices runner) (deliver-due-notices runner))
    (let ((task (take-ready-task runner)))
      (cond (task (run-task task))
            ((and (runner-notices runner) (deliver-due-notices runner)))
            (t (return :idle))))))

(defun run-round (runner)
  "Run the ready tasks of RUNNER for one round, even if some meet trouble. Return RUN-READY-TASKS's
value. If a tick's budget ends during a round, the next tick continues it, so no task loses its
turn."
  (unless (shiftf (runner-broken-off-p runner) nil)
    (incf (runner-round runner)))
  (let ((outcome (loop thereis (call-handling-trouble runner #'run-ready-tasks))))
    (when (and (eq outcome :budget) (runner-charged-p runner))
      (setf (runner-broken-off-p runner) t))
    outcome))

(defun apply-due-batch (runner)
  "Apply the next posted batch if it is due at the end of a round of RUNNER. Return true if so."
  (when (or (null (runner-spent runner))
            (null (runner-budget runner))
            (not (runner-charged-p runner))
            (>= (- (runner-steps runner) (runner-batch-applied-at runner)) +steps-before-changes+))
    (setf (runner-batch-applied-at runner) (runner-steps runner))
    (apply-next-batch runner)))

(defun run-rounds (runner)
  "Run the ready tasks and apply the posts of RUNNER, until none are left. Return :idle or :budget."
  (loop
    (let ((outcome (run-round runner)))
      (cond ((eq outcome :budget) (return :budget))
            ((apply-due-batch runner))
            ((runner-spent runner) (requeue-spent-tasks runner))
            (t (return :idle))))))

(defun form-using-operator (name form)
  (cond ((operator-called-p form name) form)
        ((consp form)
         (or (form-using-operator name (car form)) (form-using-operator name (cdr form))))))

(defun runaway-remedy (task)
  (let* ((form (find-if (lambda (form)
                          (operator-called-p form "LOOP" "HANDLE-FAILURE" "WITH-FAILURE-HANDLING"))
                        (plan-backtrace task (task-frame task))))
         (loop-p (operator-called-p form "LOOP"))
         (wait (and loop-p (form-using-operator "WAIT-FOR" form))))
    (cond (wait
           (format nil "~A does not wait if its condition is true already. Also wait until it ~
                        is false, or write (wait-time 1)." (form-text wait)))
          ((and form (not loop-p) (form-using-operator "RETRY" form))
           (one-line "If it fails again at once, write (wait-time 1) before (retry), or count how
often: (do-retry tries (retry)) in (with-retry-counters ((tries 3)) ...)."))
          (t (format nil "If the plan is to wait, write (wait-time 1) there~:[~;; if the loop is ~
                          to end, write (return)~]. Ctrl-C interrupts RUN-PLAN." loop-p)))))

(defun warn-of-runaway (runner)
  (let* ((task (find :ready (append (runner-spent runner)
                                    (remove nil (coerce (ring-items (svref (runner-rings runner) 0))
                                                        'list)))
                     :key #'task-state))
         (form (and task (task-form task))))
    (when (and task (first-warning-p form runner))
      (warn-at-once "A plan took " *runaway-limit* " steps without waiting, at " (form-text form)
                    " in " (task-label task) "; time passes all the same. "
                    (runaway-remedy task)))))

(defun react-to-all (runner)
  "Let RUNNER run its ready tasks and apply all posts, one after the other, and return :idle. If the
budget of steps is used up first, return :budget; the rest waits for the next reaction. Without a
budget, stop after *RUNAWAY-LIMIT* steps, with a warning."
  (with-owned-home (runner)
    (give-budget runner)
    (let ((outcome (let ((*leaves-offer-restarts* *break-on-user-error*))
                     (run-rounds runner))))
      (when (and (eq outcome :budget)
                 (null (runner-budget runner))
                 (not (runner-exhausted runner))
                 (not (runner-tasks-stopped-p runner)))
        (warn-of-runaway runner))
      outcome)))

;;; Posting: any thread may POST a function of no arguments, or a batch of settings that are applied
;;; at one instant, see APPLY-SETTINGS. Each is done between two reactions, in the order of posting.

(defun apply-next-batch (runner)
  "Apply the oldest post of RUNNER, a batch or call. Return true if so. Errors become messages."
  (multiple-value-bind (entry there) (take-posted-entry runner)
    (when there
      (with-owned-home (runner)
        (if (functionp entry)
            (call-user-code entry "a call posted to a plan runner")
            (call-user-code #'apply-settings "a batch posted to a plan runner" entry)))
      t)))

;;; Ending.

(defun stop-plan (runner &optional task)
  "From any thread, evaporate TASK, or all tasks of RUNNER if TASK is NIL, before the next step."
  (mapc #'request-end (if task (list task) (plan-runner-tasks runner))))

(defun close-runner (runner)
  "Evaporate all tasks of RUNNER. Cleanups run as far as they take no time; the other cleanups are
abandoned, with a warning for each. No task is left. Charges end, and posts are ignored."
  (set-charges runner nil nil)
  (stop-plan runner)
  (react-to-all runner)
  (loop for part = (some #'cleaning-part (plan-runner-tasks runner))
        while part
        do (with-owned-home (runner) (give-up-cleanup part))
           (react-to-all runner))
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
                (runner-charged-p runner)
                (runner-budget runner)
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

(defun reseed-runner (runner seed)
  "From now on, draw the random choices of plans in RUNNER from the integer SEED."
  (setf (runner-dice runner) (make-dice seed :plans)
        (runner-lisps-dice runner) nil))

(defun digest-runner (runner digest)
  "Add the state of RUNNER to DIGEST: its tasks, the tick of its next timer, its dice and charges."
  (digest-add digest (list (runner-tick runner) (next-wake-time runner)
                           (and (runner-dice runner) (dice-state (runner-dice runner)))
                           (runner-debt runner) (runner-still-until runner)))
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
