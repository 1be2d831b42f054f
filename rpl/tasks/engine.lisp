;;;; engine.lisp -- running plans: reactions, batches from outside, and time.

(in-package :ars-magna.rpl.tasks)

;;; A reaction runs ready tasks until none is ready. Only then is the next posted batch applied, and
;;; time passes only when there is none. So a task that gives a command and waits for its pulse has
;;; reached the wait before the pulse can come.
;;;
;;; The engine knows no simulator. Whoever drives it calls REACT, APPLY-NEXT-BATCH and
;;; ADVANCE-TIMERS in one thread; any thread may post.

(defun make-plan-runner (&key trace budget clock (slow 0.1d0) dice (ticks-per-second 20)
                           (tick 0) (busy-p (constantly nil)) (on-post #'list) on-tick
                           (on-end #'report-end))
  "Return what runs plans, at TICK. TRACE says whether to keep a trace. BUDGET is how many steps a
reaction may take before time passes (NIL: as many as it needs). CLOCK, a function that returns
seconds, serves to warn of Lisp code that runs for more than SLOW seconds. DICE choose for TRY-ONE.
BUSY-P says whether somebody else, such as a command under way, may still post. ON-POST is called
after each post, in the posting thread, ON-TICK, if given, with the tick when time has passed,
ON-END with each top-level task that ends; by default it reports failures."
  (check-argument make-plan-runner budget (or (null budget) (whole-p budget 1))
                  "NIL or an integer from 1 to 1e9")
  (let ((runner (%make-plan-runner :trace (and trace (make-trace)) :budget budget :clock clock
                                   :slow slow :dice dice :ticks-per-second ticks-per-second
                                   :tick tick :busy-p busy-p :on-post on-post
                                   :on-tick (ensure-list on-tick) :on-end on-end)))
    (when trace (trace-changes runner))
    runner))

(defmethod print-object ((runner plan-runner) stream)
  (print-unreadable-object (runner stream :type t)
    (format stream "tick ~A, ~D task~:P" (runner-tick runner) (length (runner-roots runner)))))

(defun start-plan (runner plan &rest arguments)
  "Start PLAN, a plan procedure or the name of one, with ARGUMENTS as a top-level task of RUNNER.
Return the task, which runs at the next reaction."
  (multiple-value-bind (body environment) (apply #'enter-plan plan arguments)
    (let* ((*runner* runner)
           (name (if (procedure-p plan) (procedure-name plan) plan))
           (task (spawn nil body environment 0 0 (make-task name body))))
      (push task (runner-roots runner))
      (dolist (hook *plan-start-hooks*) (funcall hook task))
      task)))

;;; Reacting.

(defun run-ready (runner)
  "Run the ready tasks of RUNNER. Return :idle when none is ready, :budget when that is spent."
  (loop
    (when (>= (runner-steps runner) (runner-pause runner)) (return :budget))
    (let ((task (take-ready runner)))
      (unless task (return :idle))
      (run-task task))))

(defun fail-current (runner failure)
  "Let FAILURE happen to the task of RUNNER that was running."
  (let ((task (runner-current runner)))
    (setf (task-signal task) failure)
    (make-ready-first task)))

(defun call-catching-trouble (runner function)
  "Call FUNCTION and return its value. An error in the Lisp code of the running task becomes its
failure, and NIL is returned."
  (block nil
    (handler-bind
        (((or error plan-failure storage-condition)
           (lambda (condition)
             (let ((task (runner-current runner)))
               (when (and *break-on-user-error* (typep condition 'error))
                 (invoke-debugger condition))
               (when (and task (eq (task-state task) :running))
                 (fail-current runner (failure-of condition task (task-frame task)))
                 (return nil))))))
      (funcall function runner))))

(defun warn-of-runaway (runner)
  (let* ((task (take-ready runner))
         (form (and task (task-form task))))
    (when task
      (make-ready-first task)
      (unless (member form (runner-warned runner))
        (push form (runner-warned runner))
        (warning-set "A plan took " *runaway-limit* " steps without waiting, at " (form-text form)
                     " in " (task-label task) "; time passes all the same.")))))

(defun react (runner)
  "Run the ready tasks of RUNNER until none is ready, and return :idle. Return :budget instead when
the budget of steps is spent before; without a budget that is after *RUNAWAY-LIMIT* steps, with a
warning."
  (let ((*runner* runner)
        (*backlog* (runner-backlog runner)))
    (setf (runner-pause runner)
          (+ (runner-steps runner) (or (runner-budget runner) *runaway-limit*)))
    (loop
      (let ((outcome (call-catching-trouble runner #'run-ready)))
        (when (and (eq outcome :budget) (null (runner-budget runner)))
          (warn-of-runaway runner))
        (when outcome (return outcome))))))

;;; Posting.

(defun post (runner entry)
  (with-lock ((runner-lock runner))
    (push (if (runner-trace runner) (on-behalf entry runner) entry) (runner-inbox runner)))
  (funcall (runner-on-post runner))
  (values))

(defun post-batch (runner settings)
  "Let SETTINGS be applied between two reactions of RUNNER, at one instant: (:set fluent value) and
(:pulse fluent [value]), the values before the pulses. Batches are applied in the order in which
they are posted, from any thread. See APPLY-SETTINGS."
  (post runner settings))

(defun post-call (runner function)
  "Let FUNCTION be called, with no arguments, between two reactions of RUNNER. For any thread."
  (post runner function))

(defun next-entry (runner)
  "Return the oldest posted entry of RUNNER, removed, and true; or NIL and false."
  (unless (runner-outbox runner)
    (setf (runner-outbox runner)
          (with-lock ((runner-lock runner))
            (nreverse (shiftf (runner-inbox runner) '())))))
  (if (runner-outbox runner)
      (values (pop (runner-outbox runner)) t)
      (values nil nil)))

(defun apply-next-batch (runner)
  "Apply the batch or call posted to RUNNER first. True unless there was none. Errors in it become
messages."
  (multiple-value-bind (entry there) (next-entry runner)
    (when there
      (let ((*runner* runner)
            (*backlog* (runner-backlog runner)))
        (if (functionp entry)
            (call-user-code entry "a call posted to a plan runner")
            (call-user-code #'apply-settings "a batch posted to a plan runner" entry)))
      t)))

(defun stop-plan (runner &optional task)
  "Let TASK, or else all top-level tasks of RUNNER, evaporate before its next reaction. For any
thread."
  (post-call runner (lambda ()
                      (mapc #'evaporate (if task (list task) (runner-roots runner))))))

;;; Time.

(defun advance-timers (runner tick)
  "Let it be TICK for RUNNER and wake those who waited for it."
  (setf (runner-tick runner) tick)
  (let ((*runner* runner))
    (run-timers (runner-timers runner) tick)
    (dolist (function (runner-on-tick runner))
      (call-user-code function "a plan runner's tick function" tick))))

(defun next-wake-time (runner)
  "Return the tick at which the next task of RUNNER that waits for time wakes, or NIL."
  (let ((timer (next-timer (runner-timers runner))))
    (and timer (timer-due timer))))

(defun any-ready-p (runner)
  (some (lambda (ring) (plusp (ring-count ring))) (runner-rings runner)))

(defun idle-p (runner)
  "True if no task of RUNNER is ready and nothing is posted: only time or a post can change that."
  (not (or (any-ready-p runner)
           (runner-outbox runner)
           (runner-inbox runner))))

(defun plan-deadlocked-p (runner)
  "True if tasks of RUNNER wait and nothing can ever wake them: no timer, and nobody who may post."
  (and (runner-roots runner)
       (idle-p runner)
       (null (next-wake-time runner))
       (not (funcall (runner-busy-p runner)))))

;;; Chance, and the state of it all.

(defun reseed-runner (runner seed)
  "Let the choices of plans in RUNNER come from the integer SEED from now on."
  (setf (runner-dice runner) (make-dice seed :plans)))

(defun digest-task (task digest)
  "Add to DIGEST what TASK and its children are about."
  (digest-add digest (list (task-serial task) (task-state task) (task-level task)
                           (form-text (task-form task))))
  (dolist (child (task-children task)) (digest-task child digest)))

(defun digest-runner (runner digest)
  "Add to DIGEST what the tasks of RUNNER are about, when they wake, and what chance will bring."
  (digest-add digest (list (runner-tick runner) (next-wake-time runner)
                           (and (runner-dice runner) (dice-state (runner-dice runner)))))
  (dolist (task (runner-roots runner)) (digest-task task digest)))
