;;;; runner.lisp -- the state of a plan runner: its agents, the tick, calls from outside.

(in-package :ars-magna.rpl.tasks)

(export '(*runaway-limit* plan-runner runner-agent agent-of add-agent remove-agent task-client
          counted-steps runner-steps runner-blocks plan-runner-tasks plan-runner-tick agent-note
          agent-tasks client-in-copied-run-p calling-agent
          call-with-client-still owner-text robot-name-of-client about-plan note-plan-trouble
          note-plans-shown all-tasks
          task-numbered
          note-outside-call current-counterpart))

(defconstant +steps-before-changes+ 500
  "With a budget of steps, the number of steps that all tasks of an agent may take before posted
changes are applied. The changes are then applied even if some tasks do not wait yet.")

(defparameter *runaway-limit* 1000000
  "In a reaction without budget, time passes after this number of steps even if tasks are ready.")

(addition *plan-task-limit*)
(defparameter *plan-task-limit* 200000
  "The largest number of tasks that a plan runner may have at once. A robot's plans have one plan
runner. Starting one more task fails with class :TOO-MANY-TASKS.")

(define-record (plan-runner (:include home) (:constructor %make-plan-runner) (:conc-name runner-))
  "An object that runs plans, with tasks, tick, timers, and changes and calls posted from outside."
  (agents '() list "the agents of the plan runner, oldest first: a new list after each
change" :writable :export)
  (current nil (or null task) :writable)
  (roots '() list :writable)
  (tick 0 real "the current tick of the plan runner" :writable :export)
  (timers (make-timers) timers "the timers of the plan runner" :export)
  (serial 0 fixnum "the number of the newest task of the plan runner" :writable :export)
  (alive 0 fixnum "how many tasks of the plan runner are not over" :writable :export)
  (client nil t "the object for which the plan runner runs plans, as given to
MAKE-PLAN-RUNNER" :export)
  (notices '() list :writable)
  (ends-requested '() t :writable)
  (ticks-per-second 20 (real (0))
                    "the number of ticks in a second for the plan runner's tasks" :writable :export)
  (trace nil (or null chronicle)
         "the trace in its internal form, or NIL: see PLAN-TRACE" :writable :export)
  (clock nil (or null function) :writable)
  (stepper nil (or null function) "the function to call before each step with the task and the
frame, or NIL" :writable :export)
  (slow 0.1d0 real :writable)
  (looked-at nil boolean "true if a debugger was open in the current step" :writable)
  (warned '() list :writable)
  (busy-p (constantly nil) function :writable)
  (on-end #'identity function :writable))
(declaim-final plan-runner)

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

(defgeneric owner-text (client)
  (:documentation "Return a text that names the owner of the plans of CLIENT, an agent's client, in
traces and pictures. Return NIL if there is only one owner.")
  (:method (client)
    (declare (ignore client))
    nil))

(defgeneric robot-name-of-client (client)
  (:documentation "Return the name of the robot for which the plans of CLIENT, an agent's client,
run; NIL without a robot.")
  (:method (client)
    (declare (ignore client))
    nil))

(defmacro about-plan ((task) &body body)
  "Run BODY. Messages queued in BODY are about the robot for which the plan of TASK runs."
  `(let ((*reported-robot* (robot-name-of-client (task-client ,task))))
     ,@body))

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

;;; Agents.

(defun add-agent (runner agent)
  "Add AGENT to the agents of RUNNER, and return AGENT."
  (setf (agent-runner agent) runner
        (runner-agents runner) (append (runner-agents runner) (list agent)))
  agent)

(defun agent-tasks (agent)
  "Return a list of the top-level tasks of AGENT that are not over, in order of their start."
  (remove agent (plan-runner-tasks (agent-runner agent)) :key #'task-agent :test-not #'eq))

(defun remove-agent (agent)
  "Remove AGENT from its plan runner. Signals MISUSE if a task of AGENT is not over."
  (let ((tasks (agent-tasks agent)) (runner (agent-runner agent)))
    (when tasks
      (reject-use "~A still ~[~;has a task~:;has tasks~]. End ~:*~[~;it~:;them~] first, by ~
                   END-TASKS-AT-ONCE." agent (min 2 (length tasks))))
    (setf (runner-agents runner) (remove agent (runner-agents runner)))))

(defun runner-agent (runner)
  "Return the first agent of RUNNER. If there is none, add one for the client of RUNNER."
  (or (first (runner-agents runner))
      (add-agent runner (make-agent :client (runner-client runner)))))

(defun agent-of (which)
  "Return WHICH if it is an agent, or else the RUNNER-AGENT of the plan runner WHICH."
  (if (agent-p which) which (runner-agent which)))

(defun agent-note (which key)
  "Return the data that constructs keep under KEY for all tasks of WHICH, an agent or, for its first
agent, a plan runner. Return NIL if there is no such data. Can be set."
  (getf (agent-notes (agent-of which)) key))

(defun (setf agent-note) (value which key)
  (setf (getf (agent-notes (agent-of which)) key) value))

(defun runner-steps (runner)
  "Return the number of steps that the tasks of RUNNER have taken."
  (reduce #'+ (runner-agents runner) :key #'agent-steps))

(defun runner-blocks (runner)
  "Return the number of blocks of the tasks of RUNNER."
  (reduce #'+ (runner-agents runner) :key #'agent-blocks))

(defun task-client (task)
  "Return the client of the agent of TASK. Return NIL if TASK has not started."
  (and (task-agent task) (agent-client (task-agent task))))

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

(defun counted-steps (which)
  "Return how many steps of WHICH, an agent or all agents of a plan runner, count: charged steps,
and steps of tasks that are not exempt."
  (if (agent-p which)
      (+ (agent-steps which) (agent-uncovered which))
      (reduce #'+ (runner-agents which) :key #'counted-steps)))

(defun count-slow-step (steps agent &optional task)
  "Count one slow step of AGENT, perhaps of TASK, as STEPS steps of a reaction. With a budget, and
in COUNTED-STEPS, the slow step counts as one step, or as none if TASK is exempt."
  (cond ((and task (task-uncounted-p task)) (incf (agent-steps agent) steps))
        ((agent-budget agent) (incf (agent-steps agent)))
        (t (incf (agent-steps agent) steps)
           (decf (agent-uncovered agent) (1- steps)))))

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

(defun calling-agent ()
  "Return the agent of the calling task. Return the RUNNER-AGENT if no task runs, as when a post is
applied, and NIL outside of plans."
  (let ((task (calling-task)))
    (cond (task (task-agent task))
          (*runner* (runner-agent *runner*)))))

(defun first-warning-p (form runner)
  "Return true at the first call for FORM, a form in plans of RUNNER, and false afterwards."
  (unless (member form (runner-warned runner) :test #'eq)
    (push form (runner-warned runner))))

;;; When a run is repeated, plans do the same again, given the same calls from outside. So each
;;; function that can be called from outside records its call, with its task or plan runner.

(defgeneric note-outside-call (client word arguments subject)
  (:documentation "Record a call of the function WORD by code outside of the plans of CLIENT. The
arguments of the call are the list ARGUMENTS and then SUBJECT, a task of these plans or their agent.
CLIENT is the client of the agent.")
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
  (if (inside-plans-p (task-runner task))
      task
      (current-counterpart (task-client task) task)))

(defun note-from-outside (word subject &rest arguments)
  "Record that the function WORD is called with ARGUMENTS and then SUBJECT, if the caller is outside
of the plans of SUBJECT. SUBJECT is a task, an agent or a plan runner; or NIL: record nothing."
  ;; For a plan runner, its first agent is meant.
  (let ((subject (if (plan-runner-p subject) (first (runner-agents subject)) subject)))
    (multiple-value-bind (runner client)
        (typecase subject
          (task (values (task-runner subject) (task-client subject)))
          (agent (values (agent-runner subject) (agent-client subject))))
      (unless (inside-plans-p runner)
        (note-outside-call client word arguments subject)))))
