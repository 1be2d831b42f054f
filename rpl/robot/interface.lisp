;;;; interface.lisp -- one robot, the runner of its plans, and access to them.

(in-package :ars-magna.rpl-robot)

(export '(interface-p holding-p call-with-plans))

;;; The thread in which plans react holds the interface's lock. Headless that is the thread that
;;; passes ticks or starts plans; live it is their own thread, which exists while there are
;;; plans and a clock. The simulator only posts to that thread and never waits for it.
;;;
;;; Rule for shared data: timers, ready tasks and everything else of the runner are read and
;;; changed by the thread that holds the lock. On release it publishes, as one value, the tick at
;;; which plans next need to run; the clock reads that. Posts, the tasks to end and those that
;;; RUN-PLAN waits for are atomic lists. The list of top-level tasks is replaced as a whole, never
;;; altered. A flag that only the plans' thread sets says whether it waits in a debugger.

(addition *trace-plans*)
(defparameter *trace-plans* nil
  "When true, all that happens to tasks and fluents is kept in a trace, some 50 octets for each
event, from RPL-INIT-ROBOT or the start of the next plan on. See PLAN-TRACE, WHY and
SAVE-PLAN-TIMELINE.")

(define-kind (interface :constructor (make-interface (robot simulation eras commanded)))
    "The robot that plans drive, and what runs them."
  (:fixed
   (robot nil (or null robot) "the robot that plans drive" :export)
   (simulation nil t "the simulation that the robot is in" :export)
   (commanded nil (or null robot (eql :none))
              "the robot that a prompt commanded when this was made, or NIL; :NONE if the prompt has
been told since which robot it commands")
   (valve (make-valve "robot") valve "the valve of the robot, for plans that want to have it"))
  (:state
   (runner nil (or null plan-runner) "what runs the plans" :export)
   (tick-wanted-p nil boolean "the plans are to go on with the next tick")
   (ends-requested '() t "the plans that have been asked to end")
   (actions '() list "the commands of plans that are under way, the oldest first")
   (answers '() list "the answers to them that are not applied yet, the oldest first")
   (takeovers '() list "how often plans have taken which resource in a tick")
   (takeover-tick nil t "the tick in which that was")
   (wishes '() list "what tasks want done while all plans rest, the oldest first" :export)
   (wishes-served 0 fixnum "how many wishes have been served in a tick")
   (wish-tick nil t "the tick in which that was"))
  (:memory
   (eras '() list "which tasks are of which era, the newest first; see forking.lisp")
   (warned '() list "what was said of takeovers, and at which tick")
   (outside nil symbol "the command that the robot carries out and no plan has given, or NIL")
   (last-command '() list "the plan, the function and the part of the command given last")
   (pulses '() list "lists (fluent's-name plan tick): when a plan's command pulsed each one last")
   (unread '() list "how commands ended of which plans have not looked at how; see NOTE-UNREAD")
   (next-tick nil (or null real (eql :ready))
              "published: the tick at which plans next go on, :READY for at once, or NIL"))
  (:link
   (origin '() list "how messages name the plans, kept so that it is made once")
   (ender nil (or null function) "what the robot calls when its run is over")
   (awaited '() list "the plans that RUN-PLAN waits for; an atomic list")
   (told nil t "a pair of the last failure that the journal was told of, and that remark, or NIL")
   (closing-p nil boolean "the interface is to end")
   (closed-p nil boolean "the interface has ended")
   (resting-p nil boolean "the thread that holds the plans keeps them at rest for a fork")
   (lock (make-lock "plans") t "what is held to touch the plans")
   (actions-lock (make-lock "commands of plans") t "what is held to touch actions or answers")
   (holder nil t "the thread that holds the lock, so that plans may start and end others")
   (calls nil (or null user-calls) "what users' code that thread calls")
   (wanted 0 atomic-count "how many threads want the lock, or wait for all to rest")
   (thread nil t "the thread of plans that are live, or NIL")
   (wake-up (make-semaphore "plans") t "what wakes that thread")
   (rests 0 atomic-count "how often all plans have come to rest there")
   (hog nil (or null task)
        "the task that was seen to be at Lisp code that does not return, or NIL")))

(defmethod print-object ((interface interface) stream)
  (print-unreadable-object (interface stream :type t)
    (princ (interface-robot interface) stream)))

(defmacro atomic-remove (task place)
  "Remove TASK from the list in PLACE, which other threads may change meanwhile."
  (with-gensyms (tasks)
    `(loop for ,tasks = ,place
           until (or (not (member ,task ,tasks))
                     (swap-if ,place ,tasks (remove ,task ,tasks))))))

(pushnew '*interface* *simulation-variables*)
(pushnew '*realm* *simulation-variables*)

(defvar *reacting* nil
  "The interface whose plans react in this thread: they drive its robot and no other.")

;;; Access to the plans.

(defvar *held* '()
  "The interfaces whose plans this thread holds.")

(defun holding-p (interface)
  "True if this thread is letting the plans of INTERFACE react, or looks at them."
  (and (member interface *held* :test #'eq) t))

(defun publish-next-tick (interface)
  "Tell other threads when the plans of INTERFACE, which this thread holds, next go on."
  (let ((runner (interface-runner interface)))
    (setf (interface-next-tick interface)
          (and runner (if (runner-idle-p runner) (next-wake-time runner) :ready)))))

(defun call-holding (function interface)
  "Call FUNCTION, holding the plans of INTERFACE, locked by this thread. It can be interrupted."
  (let* ((held (cons interface *held*)) (*held* held))
    (declare (dynamic-extent held))
    (in-any-case
      (progn (setf (interface-holder interface) (current-thread))
             (allowing-interrupts (funcall function)))
      (publish-next-tick interface)
      (setf (interface-holder interface) nil))))

(defun call-with-plans-if-free (function interface)
  "Call FUNCTION as CALL-WITH-PLANS does, and return its value and true; NIL and false if another
thread holds the plans of INTERFACE."
  (if (holding-p interface)
      (values (funcall function) t)
      (call-if-free (interface-lock interface) (lambda () (call-holding function interface)))))

(defun wake-tick (interface)
  "Return the tick at which the next plan of INTERFACE that waits for time wakes; NIL if none waits
for that, or some plan is ready. For any thread."
  (let ((tick (interface-next-tick interface)))
    (and (realp tick) tick)))

(defun ready-p (interface)
  "True if plans of INTERFACE are ready, have posts to apply, or wait for time. For any thread."
  (and (or (interface-next-tick interface)
           (outside-request-p (interface-runner interface)))
       t))

(defun in-debugger-p (interface)
  "True if the thread of the plans of INTERFACE waits for an answer in a debugger. For any thread."
  (let ((calls (interface-calls interface)))
    (and calls (user-calls-origin calls) (user-calls-waiting-p calls))))

(defun hog-of (interface)
  ;; The watcher sees only at its next sample that it has gone on.
  (let ((task (interface-hog interface)))
    (and task (eq :running (task-state task)) (not (in-debugger-p interface)) task)))

;; At a plain REPL a thread that waits for the plans gives their debugger the terminal. An editor
;; shows it elsewhere.
(defun check-not-in-debugger (interface)
  "Signal MISUSE if the plans of INTERFACE, of another thread, have stopped in a debugger."
  (when (and (in-debugger-p interface)
             (foreign-hook)
             (not (eq (current-thread) (interface-thread interface))))
    (reject-use "The plans of ~A have stopped in a debugger, in the thread ~A. Choose there how ~
                 they go on; before that, (print-plans t t) shows them there, with their variables."
                (interface-robot interface) (thread-name (interface-thread interface)))))

(defun check-not-hogged (interface)
  (let ((task (hog-of interface)))
    (when (and task (not (eq (current-thread) (interface-thread interface))))
      (reject-use "The plan ~A keeps the plans' thread, at ~A. (end-plan :all) ends it."
                  (task-label (task-top task)) (form-text (task-form task))))))

;; A time limit may interrupt this at any moment: the count must come out even, or the plans' thread
;; would yield forever.
(defun call-wanting-plans (function interface)
  "Call FUNCTION, while this thread counts as one that wants the plans of INTERFACE, with a function
that is to be called when it has them. Interrupts wait, but for the extent of ALLOWING-INTERRUPTS."
  (let ((waiting-p t))
    (flet ((have ()
             (when (shiftf waiting-p nil) (atomic-decf (interface-wanted interface)))))
      (declare (dynamic-extent #'have))
      (deferring-interrupts
        (atomic-incf (interface-wanted interface))
        (unwind-protect (funcall function #'have)
          (have))))))

(defun call-with-plans (function interface)
  "Call FUNCTION while no other thread touches the plans of INTERFACE. Signals MISUSE if one of them
is known to be at Lisp code that does not return. One that waits in a debugger can be answered."
  (check-not-hogged interface)
  (check-not-in-debugger interface)
  (if (holding-p interface)
      (funcall function)
      (call-wanting-plans
       (lambda (have)
         (call-when-free (interface-lock interface)
                         (lambda ()
                           (funcall have)
                           (call-holding function interface))))
       interface)))

(defmacro with-plans ((interface) &body body)
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (call-with-plans #'body ,interface)))

;;; The thread of live plans; see thread.lisp.

(defun wake-plans (interface)
  (when (interface-thread interface)
    (signal-semaphore (interface-wake-up interface))))

(defun thread-of (interface)
  "Return the thread of the plans of INTERFACE, :STARTING if it is yet to start, or NIL."
  (let ((thread (interface-thread interface)))
    (unless (or (member thread '(nil :starting)) (thread-alive-p thread))
      (swap-if (interface-thread interface) thread nil))
    (interface-thread interface)))

(defun call-to-plans (interface)
  (let ((simulation (interface-simulation interface)))
    (if (thread-of interface)
        (wake-plans interface)
        (when (live-p simulation) (wake-owner (simulation-timeline simulation))))))

;;; Which interface.

(defun interface-valid-p (interface)
  "True if the robot of INTERFACE is still in its world, and the world in the same simulation."
  (let ((robot (interface-robot interface))
        (simulation (interface-simulation interface)))
    (and (not (interface-closed-p interface))
         (null (simulation-over simulation))
         (null (robot-retired robot))
         (eq simulation (robot-simulation robot))
         (member robot (simulation-robots simulation))
         t)))

(defun warn-once-in-run (interface key control &rest arguments)
  "Warn once by KEY in the run of INTERFACE, with the text formatted from CONTROL and ARGUMENTS."
  (warn-once key (simulation-world (interface-simulation interface))
             (apply #'format nil control arguments)))

(defun usable-p (interface)
  "True if there is an INTERFACE, valid and for the current world, if any."
  (and interface
       (interface-valid-p interface)
       (or (null *world*)
           (eq *world* (robot-world (interface-robot interface))))))

(defun interface-in-use-here ()
  "Return the interface whose plans react here, or else the one in use; or NIL."
  (or *reacting* *interface*))

(defun usable-interface ()
  (let ((interface (interface-in-use-here)))
    (and (usable-p interface) interface)))

(defun the-interface ()
  "Return the interface that can be used here. If plans react here whose robot is gone, the plan at
work ends. Signals MISUSE if there is none."
  (or (usable-interface)
      (and *reacting* (not (interface-valid-p *reacting*)) (leave-plan))
      (let ((robots (and *simulation* (simulation-robots *simulation*)))
            (alone-p (and *runner* (null (runner-client *runner*)))))
        (reject-use "No robot to drive. ~:[Call (rpl-init-robot ROBOT) first; after a simulator ~
                     has been started anew, or the robot defined anew, call it again. Outside of ~
                     plans use commands without RPL-, such as (robot-turn ~(~A~) ~
                     1).~;RUN-PLAN-ALONE runs plans without one, and RUN-PLAN on the robot of the ~
                     run.~]"
                    alone-p (if robots (robot-name (first robots)) 'robot)))))

(addition rpl-robot)
(defun rpl-robot ()
  "Return the robot that plans drive. Signals MISUSE without one."
  (interface-robot (the-interface)))

(addition rpl-robot-valve)
(defun rpl-robot-valve ()
  "Return the valve of the robot that plans drive. It is voluntary: plans that may run beside
others, and branches of a plan, own it while they drive, (with-valve ((rpl-robot-valve)) ...), as
the shipped plans do. Signals MISUSE without a robot."
  (interface-valve (the-interface)))

(addition rpl-runner)
(defun rpl-runner ()
  "Return the plan runner of the robot that plans drive; see PLAN-TRACE, PRINT-TASKS."
  (interface-runner (the-interface)))
