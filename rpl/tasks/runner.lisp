;;;; runner.lisp -- the state of a plan runner: ready tasks, the tick, calls from outside.

(in-package :ars-magna.rpl.tasks)

(export '(*runaway-limit* alone-p blocked-p make-ready plan-runner
          counted-steps plan-runner-tasks plan-runner-tick runner-note client-forked-p
          call-with-client-still note-plan-trouble note-seen all-tasks task-numbered
          note-outside-call task-now))

;;; Ready tasks queue first-in first-out by level; the highest level runs first. Bit n of MASK is
;;; set while tasks of level n may be queued. The bit +INTERRUPT+, above all of these, is set when
;;; the running task must check its own signal.

(defconstant +levels+ 8 "How many levels there are: the plan's, and policies above policies.")
(defconstant +interrupt+ (ash 1 +levels+))

(defconstant +slice+ 10000
  "How many steps a task may take before others, and what was posted meanwhile, get their turn; a
tenth of the steps of a reaction if that is less.")

(defconstant +thoughts+ 500
  "Where steps have a budget of ticks, how many the tasks may take, all together, before what was
posted meanwhile is applied although some of them have not waited yet.")

(defparameter *runaway-limit* 1000000
  "How many steps a reaction without a budget takes before time passes all the same.")

(addition *plan-task-limit*)
(defparameter *plan-task-limit* 200000
  "How many tasks a plan runner, such as that of a robot's plans, may have at once. Starting one
more fails with class :TOO-MANY-TASKS.")

(define-record (plan-runner (:include home) (:constructor %make-plan-runner) (:conc-name runner-))
  "What runs plans: knows the tasks, the tick, the timers, and what was posted from outside."
  (rings (coerce (loop repeat +levels+ collect (make-ring)) 'simple-vector) (simple-vector 8))
  (mask 0 fixnum :writable)
  (current nil (or null task) :writable)
  (roots '() list :writable)
  (held '() list :writable)
  (blocks 0 fixnum "how many blocks of tasks of the plan runner there are" :writable :export)
  (tick 0 real "the tick that it is for the plan runner" :writable :export)
  (timers (make-timers) timers "the timers of the plan runner" :export)
  (serial 0 fixnum "the number of the task of the plan runner that began last" :writable :export)
  (alive 0 fixnum "how many tasks of the plan runner are not over" :writable :export)
  (client nil t "on whose behalf the plan runner runs plans, as MAKE-PLAN-RUNNER was told" :export)
  (steps 0 (unsigned-byte 62)
         "how many steps the plan runner has taken: expressions begun or ended" :writable :export)
  (pause 0 (unsigned-byte 62) "the number of steps at which the running task is to pause" :writable)
  (limit 0 (unsigned-byte 62) "the number of steps at which the reaction is to end" :writable)
  (slice +slice+ fixnum :writable)
  (round 0 fixnum :writable)
  (spent '() list
         "the ready tasks that have used their slice in this round, the last one first" :writable)
  (exhausted nil boolean :writable)
  (notices '() list :writable)
  (ends-requested '() t :writable)
  (budget nil (or null (integer 1))
          "how many steps a reaction may take, NIL for as many as it needs" :writable)
  ;; What thinking costs; see charging.lisp.
  (charged-p nil boolean "thoughts of the plan runner's tasks that say what they cost take
ticks" :writable :export)
  (allotted nil (or null real) :writable)
  (debt 0 (integer 0) :writable)
  (still-until nil (or null real) :writable)
  (uncounted 0 (integer 0) :writable)
  (uncovered 0 integer "how many steps count that are not among STEPS; less than 0 if some of those
do not" :writable)
  (broken-off-p nil boolean :writable)
  (batch-applied-at 0 (unsigned-byte 62) :writable)
  (ticks-per-second 20 (real (0))
                    "how many ticks are a second for the plan runner's tasks" :writable :export)
  (dice nil (or null dice)
        "the dice by which the plan runner's tasks choose, or NIL" :writable :export)
  (lisps-dice nil (or null random-state) "what plans of the runner roll by CL:RANDOM; NIL: what all
programs do" :writable :export)
  (trace nil (or null chronicle)
         "the trace of the plan runner as it is kept, or NIL: see PLAN-TRACE" :writable :export)
  (clock nil (or null function) :writable)
  (stepper nil (or null function) "the function, of task and frame, that is called before each step,
or NIL" :writable :export)
  (slow 0.1d0 real :writable)
  (looked-at nil boolean "true if a debugger was open in the step under way" :writable)
  (warned '() list :writable)
  (notes '() list "what constructs keep for all tasks, a plist" :writable)
  (busy-p (constantly nil) function :writable)
  (on-end #'identity function :writable))

(define-shared-slots plan-runner warned)

;;; A fork of a run copies the runner of that run. A runner of another run is not copied.

(defgeneric client-forked-p (client copier)
  (:documentation "True if CLIENT, of a plan runner, is of the run that COPIER copies.")
  (:method (client copier) (declare (ignore client copier)) nil))

;; Events of tasks that the client may want to know.
(defgeneric note-seen (client)
  (:documentation "Note that the plans of CLIENT, of a plan runner, are looked at.")
  (:method (client)
    (declare (ignore client))
    nil))

(defgeneric call-with-client-still (client function)
  (:documentation "Call FUNCTION, while no plan of CLIENT goes on, and return its value.")
  (:method (client function)
    (declare (ignore client))
    (funcall function)))

(defgeneric note-plan-trouble (client task failure)
  (:documentation "Note that FAILURE, which may be handled, has just happened in TASK, of plans of
CLIENT; or, if FAILURE is NIL, that TASK, a part of a plan, was just ended.")
  (:method (client task failure) (declare (ignore client task failure))))

(defmethod home-forked-p ((runner plan-runner) copier)
  (client-forked-p (runner-client runner) copier))

(defmethod copy-plan-value ((runner plan-runner) fork)
  (if (home-forked-p runner fork)
      (let ((copy (copy-slots runner fork)))
        (setf (home-born copy) (next-token))
        copy)
      runner))

(defun runner-note (runner key)
  "Return what is kept for all tasks of RUNNER by KEY, or NIL. Can be set."
  (getf (runner-notes runner) key))

(defun (setf runner-note) (value runner key)
  (setf (getf (runner-notes runner) key) value))

(defun plan-runner-tick (&optional (runner *runner*))
  "Return the tick that it is for RUNNER."
  (runner-tick runner))

(defun plan-runner-tasks (&optional (runner *runner*))
  "Return the top-level tasks of RUNNER that are not over, in order of their start."
  (reverse (runner-roots runner)))

(defun all-tasks (which)
  "Return the tasks of WHICH, a task or a runner, each before its parts."
  (if (task-p which)
      (cons which (mapcan #'all-tasks (task-children which)))
      (mapcan #'all-tasks (plan-runner-tasks which))))

(defun task-numbered (number which)
  "Return the task with NUMBER of those of WHICH that are not over, or NIL."
  (find number (all-tasks which) :key #'task-serial))

(defun counted-steps (runner)
  "Return how many steps of RUNNER have counted: those taken, without exempt ones, and charges."
  (+ (runner-steps runner) (runner-uncovered runner)))

(defun count-slow-step (steps runner &optional task)
  "Count one slow step of RUNNER, perhaps of TASK, as STEPS steps of a reaction. In COUNTED-STEPS,
and with a budget, it counts as one, unless TASK is exempt."
  (cond ((and task (task-uncounted-p task)) (incf (runner-steps runner) steps))
        ((runner-budget runner) (incf (runner-steps runner)))
        (t (incf (runner-steps runner) steps)
           (decf (runner-uncovered runner) (1- steps)))))

(addition plan-trace)
(defun plan-trace (&optional (runner *runner*))
  "Return the trace of RUNNER, a vector of trace entries in order; NIL if it keeps none."
  (and (runner-trace runner)
       (values (funcall (trace-so-far (runner-trace runner))))))

(addition plan-time)
(defun plan-time ()
  "Return the tick that it is for the plan that asks. Signals MISUSE outside of plans."
  (if *runner*
      (runner-tick *runner*)
      (reject-use "PLAN-TIME is for plans to ask. Elsewhere (simulation-tick) returns the tick.")))

(addition current-task)
(defun current-task ()
  "Return the task that asks, or NIL outside of plans."
  (and *runner* (runner-current *runner*)))

(defun running-task (runner)
  "Return the task of RUNNER whose step is under way, or NIL."
  (let ((task (runner-current runner)))
    (and task (eq (task-state task) :running) task)))

(defun first-warning-p (form runner)
  "True the first time that this is called for FORM, of plans of RUNNER."
  (unless (member form (runner-warned runner) :test #'eq)
    (push form (runner-warned runner))))

;;; The ready queues.

(declaim (inline mark-level))
(defun mark-level (runner level)
  (setf (runner-mask runner) (logior (runner-mask runner) (the fixnum (ash 1 level)))))

(defun make-ready (task)
  "Let TASK run when it is its turn."
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
  "True if TASK or a task that it is part of is blocked. A task that evaporates is not, and what it
does to clean up only by what blocks that."
  (loop for each = task then (task-parent each)
        until (or (null each) (task-ending-p each))
        thereis (plusp (task-blocked each))))

(defun spent-p (task runner)
  (and (= (task-round task) (runner-round runner))
       (<= (task-slice task) 0)))

(defun take-ready (runner)
  "Return the next task of RUNNER to run, or NIL. Put aside blocked ones and those out of slice."
  (declare #.*hot* (type plan-runner runner))
  (loop
    (let ((level (1- (integer-length (logandc2 (runner-mask runner) +interrupt+)))))
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
                    ((spent-p task runner) (push task (runner-spent runner)))
                    (t (return task)))))))))

(defun release-spent (runner)
  "Queue again the tasks that were put aside because they had used their slice."
  (dolist (task (nreverse (shiftf (runner-spent runner) '())))
    (when (eq (task-state task) :ready) (make-ready task))))

(defun any-ready-p (runner)
  (or (and (plusp (logandc2 (runner-mask runner) +interrupt+))
           (some (lambda (ring) (plusp (ring-count ring))) (runner-rings runner)))
      (some (lambda (task) (eq (task-state task) :ready)) (runner-spent runner))))

(defun alone-p (task)
  "True if no other task of TASK's level or above is ready."
  (let ((runner (task-runner task)))
    (and (< (runner-mask runner) (ash 2 (task-level task)))
         (zerop (ring-count (svref (runner-rings runner) (task-level task)))))))

;;; When a run is repeated, plans do the same again, given the same calls from outside. So each
;;; function that can be called from outside records its call, with its task or plan runner.

(defgeneric note-outside-call (client word arguments subject)
  (:documentation "Record a call from outside of the plans of CLIENT, see RUNNER-CLIENT: of the
function WORD with the list ARGUMENTS and then SUBJECT, a task of theirs or their plan runner.")
  (:method (client word arguments subject)
    (declare (ignore client word arguments subject))
    (values)))

(defgeneric task-now (client task)
  (:documentation "Return the counterpart of TASK, one of the plans of CLIENT, in the run that
this thread works in, or in the run that replaced a rewound one. Return TASK if there is none.")
  (:method (client task)
    (declare (ignore client))
    task))

(defun inside-plans-p (runner)
  "True if there is no RUNNER, or this thread is at work in its plans."
  (or (null runner) (eq runner *runner*)))

(defun task-meant (task)
  "Return TASK; for a caller outside of its plan, its counterpart there: see TASK-NOW."
  (let ((runner (task-runner task)))
    (if (inside-plans-p runner)
        task
        (task-now (runner-client runner) task))))

(defun note-from-outside (word subject &rest arguments)
  "Note that the function WORD is called with ARGUMENTS and then SUBJECT, a task or a plan runner,
if that comes from outside of the plans of SUBJECT."
  (let ((runner (if (task-p subject) (task-runner subject) subject)))
    (unless (inside-plans-p runner)
      (note-outside-call (runner-client runner) word arguments subject))))
