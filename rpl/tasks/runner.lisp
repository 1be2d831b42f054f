;;;; runner.lisp -- the state of a plan runner: ready tasks, the tick, calls from outside.

(in-package :ars-magna.rpl.tasks)

(export '(*runaway-limit* only-ready-task-p blocked-p make-ready plan-runner
          counted-steps plan-runner-tasks plan-runner-tick runner-note client-in-copied-run-p
          call-with-client-still note-plan-trouble note-plans-shown all-tasks task-numbered
          note-outside-call current-counterpart))

;;; Ready tasks queue first-in first-out by level; the highest level runs first. Bit n of MASK is
;;; set while tasks of level n may be queued. The bit +INTERRUPT-BIT+, above all of these, is set
;;; when the running task must check its own signal.

(defconstant +levels+ 8 "The number of levels of tasks: the level of the plan, and those of nested
policies.")
(defconstant +interrupt-bit+ (ash 1 +levels+))

(defconstant +slice+ 10000
  "The number of steps that a task may take before other tasks and posted changes get their turn.
The slice is a tenth of the steps of a reaction if that is less.")

(defconstant +steps-before-changes+ 500
  "With a budget of steps, the number of steps that all tasks together may take before posted
changes are applied. The changes are then applied even if some tasks do not wait yet.")

(defparameter *runaway-limit* 1000000
  "In a reaction without budget, time passes after this number of steps even if tasks are ready.")

(addition *plan-task-limit*)
(defparameter *plan-task-limit* 200000
  "The largest number of tasks that a plan runner may have at once. A robot's plans have one plan
runner. Starting one more task fails with class :TOO-MANY-TASKS.")

(define-record (plan-runner (:include home) (:constructor %make-plan-runner) (:conc-name runner-))
  "An object that runs plans, with tasks, tick, timers, and changes and calls posted from outside."
  (rings (coerce (loop repeat +levels+ collect (make-ring)) 'simple-vector) (simple-vector 8))
  (mask 0 fixnum :writable)
  (current nil (or null task) :writable)
  (roots '() list :writable)
  (held '() list :writable)
  (blocks 0 fixnum "the number of blocks of the plan runner's tasks" :writable :export)
  (tick 0 real "the current tick of the plan runner" :writable :export)
  (timers (make-timers) timers "the timers of the plan runner" :export)
  (serial 0 fixnum "the number of the newest task of the plan runner" :writable :export)
  (alive 0 fixnum "how many tasks of the plan runner are not over" :writable :export)
  (client nil t "the object for which the plan runner runs plans, as given to
MAKE-PLAN-RUNNER" :export)
  (steps 0 (unsigned-byte 62)
         "the number of steps taken. A step begins or ends an expression" :writable :export)
  (pause 0 (unsigned-byte 62) "the number of steps at which the running task must pause" :writable)
  (limit 0 (unsigned-byte 62) "the number of steps at which the reaction must end" :writable)
  (slice +slice+ fixnum :writable)
  (round 0 fixnum :writable)
  (spent '() list
         "the ready tasks that have used their slice in this round, the newest first" :writable)
  (exhausted nil boolean :writable)
  (notices '() list :writable)
  (ends-requested '() t :writable)
  (budget nil (or null (integer 1))
          "the number of steps that a reaction may take; NIL for no limit" :writable)
  ;; What thinking costs; see charging.lisp.
  (charged-p nil boolean "thinking with a stated cost takes ticks in the plan runner's
tasks" :writable :export)
  (allotted nil (or null real) :writable)
  (debt 0 (integer 0) :writable)
  (still-until nil (or null real) :writable)
  (uncounted 0 (integer 0) :writable)
  (uncovered 0 integer "the number of counted steps minus STEPS" :writable)
  (broken-off-p nil boolean :writable)
  (batch-applied-at 0 (unsigned-byte 62) :writable)
  (ticks-per-second 20 (real (0))
                    "the number of ticks in a second for the plan runner's tasks" :writable :export)
  (dice nil (or null dice)
        "the dice for random choices of the plan runner's tasks, or NIL" :writable :export)
  (lisps-dice nil (or null random-state) "the random state for CL:RANDOM in plans of the plan
runner; NIL for the state of all programs" :writable :export)
  (trace nil (or null chronicle)
         "the trace in its internal form, or NIL: see PLAN-TRACE" :writable :export)
  (clock nil (or null function) :writable)
  (stepper nil (or null function) "the function to call before each step with the task and the
frame, or NIL" :writable :export)
  (slow 0.1d0 real :writable)
  (looked-at nil boolean "true if a debugger was open in the current step" :writable)
  (warned '() list :writable)
  (notes '() list "a property list of the data that constructs keep for all tasks" :writable)
  (busy-p (constantly nil) function :writable)
  (on-end #'identity function :writable))

(define-shared-slots plan-runner warned)

;;; A fork of a run copies the runner of that run. A runner of another run is not copied.

(defgeneric client-in-copied-run-p (client copier)
  (:documentation "True if CLIENT, a plan runner's client, belongs to the run that COPIER copies.")
  (:method (client copier) (declare (ignore client copier)) nil))

;; Events of tasks that the client may want to know.
(defgeneric note-plans-shown (client)
  (:documentation "Note that the plans of CLIENT, the client of a plan runner, have been shown.")
  (:method (client)
    (declare (ignore client))
    nil))

(defgeneric call-with-client-still (client function)
  (:documentation "Call FUNCTION while no plan of CLIENT runs, and return the value of FUNCTION.")
  (:method (client function)
    (declare (ignore client))
    (funcall function)))

(defgeneric note-plan-trouble (client task failure)
  (:documentation "Note that FAILURE, which may be handled later, has just happened in TASK, a task
of CLIENT. If FAILURE is NIL, note that TASK, a part of a plan, was just ended.")
  (:method (client task failure) (declare (ignore client task failure))))

(defmethod home-forked-p ((runner plan-runner) copier)
  (client-in-copied-run-p (runner-client runner) copier))

(defmethod copy-plan-value ((runner plan-runner) fork)
  (if (home-forked-p runner fork)
      (let ((copy (copy-slots runner fork)))
        (setf (home-born copy) (next-token))
        copy)
      runner))

(defun runner-note (runner key)
  "Return the data that constructs keep for all tasks of RUNNER under KEY, or NIL. Can be set."
  (getf (runner-notes runner) key))

(defun (setf runner-note) (value runner key)
  (setf (getf (runner-notes runner) key) value))

(defun plan-runner-tick (&optional (runner *runner*))
  "Return the current tick of RUNNER."
  (runner-tick runner))

(defun plan-runner-tasks (&optional (runner *runner*))
  "Return a list of the top-level tasks of RUNNER that are not over, in order of their start."
  (reverse (runner-roots runner)))

(defun all-tasks (which)
  "Return a list of all tasks in WHICH, a task or a plan runner. Each task comes before its parts."
  (if (task-p which)
      (cons which (mapcan #'all-tasks (task-children which)))
      (mapcan #'all-tasks (plan-runner-tasks which))))

(defun task-numbered (number which)
  "Return the task with the number NUMBER in WHICH, a task or runner, if it is not over; or NIL."
  (find number (all-tasks which) :key #'task-serial))

(defun counted-steps (runner)
  "Return how many steps of RUNNER count: charged steps, and steps of tasks that are not exempt."
  (+ (runner-steps runner) (runner-uncovered runner)))

(defun count-slow-step (steps runner &optional task)
  "Count one slow step of RUNNER, perhaps of TASK, as STEPS steps of a reaction. With a budget, and
in COUNTED-STEPS, the slow step counts as one step, or as none if TASK is exempt."
  (cond ((and task (task-uncounted-p task)) (incf (runner-steps runner) steps))
        ((runner-budget runner) (incf (runner-steps runner)))
        (t (incf (runner-steps runner) steps)
           (decf (runner-uncovered runner) (1- steps)))))

(addition plan-trace)
(defun plan-trace (&optional (runner *runner*))
  "Return the trace of RUNNER, a vector of trace entries in order; NIL if RUNNER keeps no trace."
  (and (runner-trace runner)
       (values (funcall (trace-so-far (runner-trace runner))))))

(addition plan-time)
(defun plan-time ()
  "Return the current tick of the calling plan. Signals MISUSE outside of plans."
  (if *runner*
      (runner-tick *runner*)
      (reject-use "PLAN-TIME works only in plans. Elsewhere (simulation-tick) returns the tick.")))

(addition current-task)
(defun current-task ()
  "Return the calling task, or NIL outside of plans."
  (and *runner* (runner-current *runner*)))

(defun running-task (runner)
  "Return the task of RUNNER that is taking a step now, or NIL."
  (let ((task (runner-current runner)))
    (and task (eq (task-state task) :running) task)))

(defun first-warning-p (form runner)
  "Return true at the first call for FORM, a form in plans of RUNNER, and false afterwards."
  (unless (member form (runner-warned runner) :test #'eq)
    (push form (runner-warned runner))))

;;; The ready queues.

(declaim (inline mark-level))
(defun mark-level (runner level)
  (setf (runner-mask runner) (logior (runner-mask runner) (the fixnum (ash 1 level)))))

(defun make-ready (task)
  "Put TASK at the end of its ready queue, to run in its turn."
  (declare #.*hot*)
  (let ((runner (task-runner task))
        (level (task-level task)))
    (declare (type plan-runner runner))
    (setf (task-state task) :ready)
    (ring-push task (the ring (svref (runner-rings runner) level)))
    (mark-level runner level)))

(defun make-ready-first (task)
  (let ((runner (task-runner task))
        (level (task-level task)))
    (setf (task-state task) :ready)
    (ring-push-front task (svref (runner-rings runner) level))
    (mark-level runner level)))

(defun blocked-p (task)
  "True if TASK or a task around it is blocked. If it evaporates, only its cleanup's blocks count."
  (loop for each = task then (task-parent each)
        until (or (null each) (task-ending-p each))
        thereis (plusp (task-blocked each))))

(defun slice-spent-p (task runner)
  (and (= (task-round task) (runner-round runner))
       (<= (task-slice task) 0)))

(defun take-ready-task (runner)
  "Return RUNNER's next task to run, or NIL. Put aside blocked tasks and tasks with no slice left."
  (declare #.*hot* (type plan-runner runner))
  (loop
    (let ((level (1- (integer-length (logandc2 (runner-mask runner) +interrupt-bit+)))))
      (when (minusp level) (return nil))
      (let ((ring (svref (runner-rings runner) level)))
        (declare (type ring ring))
        (if (zerop (ring-count ring))
            (setf (runner-mask runner) (logandc2 (runner-mask runner) (ash 1 level)))
            (let ((task (ring-pop ring)))
              (declare (type task task))
              (cond ((not (eq (task-state task) :ready))) ; has evaporated meanwhile
                    ((and (plusp (runner-blocks runner)) (blocked-p task))
                     (push task (runner-held runner)))
                    ((slice-spent-p task runner) (push task (runner-spent runner)))
                    (t (return task)))))))))

(defun requeue-spent-tasks (runner)
  (dolist (task (nreverse (shiftf (runner-spent runner) '())))
    (when (eq (task-state task) :ready) (make-ready task))))

(defun any-task-ready-p (runner)
  (or (and (plusp (logandc2 (runner-mask runner) +interrupt-bit+))
           (some (lambda (ring) (plusp (ring-count ring))) (runner-rings runner)))
      (some (lambda (task) (eq (task-state task) :ready)) (runner-spent runner))))

(defun only-ready-task-p (task)
  "True if no other task of the level of TASK, or above, is ready."
  (let ((runner (task-runner task)))
    (and (< (runner-mask runner) (ash 2 (task-level task)))
         (zerop (ring-count (svref (runner-rings runner) (task-level task)))))))

;;; When a run is repeated, plans do the same again, given the same calls from outside. So each
;;; function that can be called from outside records its call, with its task or plan runner.

(defgeneric note-outside-call (client word arguments subject)
  (:documentation "Record a call of the function WORD by code outside of the plans of CLIENT, see
RUNNER-CLIENT. The arguments of the call are the list ARGUMENTS and then SUBJECT, a task of these
plans or their plan runner.")
  (:method (client word arguments subject)
    (declare (ignore client word arguments subject))
    (values)))

(defgeneric current-counterpart (client task)
  (:documentation "Return the counterpart of TASK, a task of CLIENT, in the current run of this
thread, or in the run that replaced a rewound run. Return TASK if TASK has no counterpart.")
  (:method (client task)
    (declare (ignore client))
    task))

(defun inside-plans-p (runner)
  "True if RUNNER is NIL, or this thread is running the plans of RUNNER."
  (or (null runner) (eq runner *runner*)))

(defun task-for-caller (task)
  "Return TASK or, if the caller is outside of the plans of TASK, its CURRENT-COUNTERPART."
  (let ((runner (task-runner task)))
    (if (inside-plans-p runner)
        task
        (current-counterpart (runner-client runner) task))))

(defun note-from-outside (word subject &rest arguments)
  "Record that the function WORD is called with ARGUMENTS and then SUBJECT, if the caller is outside
of the plans of SUBJECT. SUBJECT is a task or a plan runner."
  (let ((runner (if (task-p subject) (task-runner subject) subject)))
    (unless (inside-plans-p runner)
      (note-outside-call (runner-client runner) word arguments subject))))
