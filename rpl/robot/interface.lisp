;;;; interface.lisp -- a run, the runner of its plans, and access to them.

(in-package :ars-magna.rpl-robot)

(export '(interface-p holding-plans-p call-with-plans usable-interface))

;;; The thread in which plans react holds the interface's lock. Headless that is the thread that
;;; passes ticks or starts plans; live it is their own thread, which exists while there are
;;; plans and a clock. The simulator only posts to that thread and never waits for it.
;;;
;;; Rule for shared data: timers, ready tasks and everything else of the runner are read and
;;; changed by the thread that holds the lock. On release it publishes, as one value, the tick at
;;; which plans next need to run; the clock reads that. Posts, the tasks to end and those that
;;; RUN-PLAN waits for are atomic lists. The lists of top-level tasks and of drivers are replaced
;;; as a whole, never altered. A flag that only the plans' thread sets says whether it waits in a
;;; debugger.

(addition *trace-plans*)
(defparameter *trace-plans* nil
  "When true, all events of tasks and fluents are kept in a trace, from RPL-INIT-ROBOT or the start
of the next plan on. Each event takes some 50 octets. See PLAN-TRACE, WHY and SAVE-PLAN-TIMELINE.")

(define-kind (plans-access :constructor (make-plans-access ()))
    "What gives threads access to plans: a lock, and in a live run the thread of the plans."
  (:link
   (lock (make-lock "plans") t "the lock for access to the plans")
   (holder nil t "the thread that holds the lock, or NIL")
   (wanted 0 atomic-count "how many threads want the lock, or wait until all plans rest")
   (thread nil t "the thread of the plans in a live run, or NIL")
   (wake-up (make-semaphore "plans") t "the semaphore that wakes the plans' thread")
   (calls nil (or null user-calls) "a record of users' code that the plans' thread calls")
   (rests 0 atomic-count "how often all plans have come to rest in their thread")
   (hog nil (or null task)
        "the task found to run Lisp code that does not return, or NIL")))

(define-kind (interface :include plans-access :constructor (make-interface (simulation eras)))
    "The connection between a run and the runner of its plans."
  (:fixed
   (simulation nil t "the simulation whose robots the plans drive" :export)
   (realm *realm* t "the realm of the plans' fluents"))
  (:state
   (runner nil (or null plan-runner) "the plan runner that runs the plans" :export)
   (drivers '() list
            "the drivers of robots that plans drive, the newest first; replaced as a whole")
   (default nil t "the driver of the last RPL-INIT-ROBOT, or NIL")
   (tick-wanted-p nil boolean "the plans are to go on with the next tick")
   (computing-p nil boolean "in a live run, tasks have used their slices since all tasks waited")
   (ends-requested '() t "the plans whose end was requested")
   (wishes '() list "the wishes of tasks, served while all plans rest, the oldest first" :export)
   (wishes-served 0 fixnum "how many wishes have been served in a tick")
   (wish-tick nil t "the tick that the count in WISHES-SERVED is for"))
  (:memory
   (eras '() list "the eras of tasks, the newest first; see forking.lisp")
   (next-tick nil (or null real (cons (eql :ready) (or null real)))
              "published: the tick of the first timer of plans, or NIL; if plans go on before,
a pair of :READY and the tick that they want, or NIL"))
  (:link
   (origin '() list "the origin that messages name for the plans")
   (awaited '() list "the plans that RUN-PLAN waits for; an atomic list")
   (told nil t "a cons of the last failure noted in the journal and the remark, or NIL")
   (closing-p nil boolean "the interface is to end")
   (closed-p nil boolean "the interface has ended")
   (resting-p nil boolean "the thread that holds the plans keeps them at rest for a fork")))

(defmethod print-object ((interface interface) stream)
  (print-unreadable-object (interface stream :type t)
    (princ (simulation-name (interface-simulation interface)) stream)))

(defmacro atomic-remove (task place)
  "Remove TASK from the list in PLACE, which other threads may change meanwhile."
  (with-gensyms (tasks)
    `(loop for ,tasks = ,place
           until (or (not (member ,task ,tasks))
                     (swap-if-eq ,place ,tasks (remove ,task ,tasks))))))

(pushnew '*default-interface* *simulation-variables*)
(pushnew '*realm* *simulation-variables*)

(defvar *reacting-interface* nil
  "The interface whose plans react in this thread, or NIL.")

;;; Access to the plans.

(defvar *held-interfaces* '()
  "The interfaces whose plans this thread holds.")

(defun holding-plans-p (interface)
  "True if this thread holds the plans of INTERFACE, to let them react or to look at them."
  (and (member interface *held-interfaces* :test #'eq) t))

(defun next-tick-wanted (interface runner)
  "Return the tick that the run must reach for plans of INTERFACE to go on, or NIL. A plan that has
computed for long wants the next tick, as time passes while plans compute."
  (let ((tick (next-wake-time runner))
        (next (and (interface-computing-p interface)
                   (1+ (simulation-tick (interface-simulation interface))))))
    (if (and tick next) (min tick next) (or tick next))))

(defun publish-next-tick (interface)
  "Tell other threads when the plans of INTERFACE, which this thread holds, next go on."
  (let ((runner (interface-runner interface)))
    (setf (interface-next-tick interface)
          (cond ((null runner) nil)
                ((runner-idle-p runner)
                 (setf (interface-computing-p interface) nil)
                 (next-wake-time runner))
                (t (cons :ready (next-tick-wanted interface runner)))))))

(defun call-holding-plans (function interface)
  "This thread has locked INTERFACE. Call FUNCTION, interruptibly, as the holder of its plans."
  (let* ((held (cons interface *held-interfaces*)) (*held-interfaces* held) (*urgent-p* t))
    (declare (dynamic-extent held))
    (in-any-case
      (progn (setf (interface-holder interface) (current-thread))
             (allowing-interrupts (funcall function)))
      (publish-next-tick interface)
      (setf (interface-holder interface) nil))))

(defun call-with-plans-if-free (function interface)
  "Call FUNCTION as CALL-WITH-PLANS does, and return its value and true. If another thread holds the
plans of INTERFACE, do not wait; return NIL and false."
  (if (holding-plans-p interface)
      (values (funcall function) t)
      (call-if-free (interface-lock interface)
                    (lambda () (call-holding-plans function interface)))))

(defun wake-tick (interface)
  "Return the earliest tick at which a plan of INTERFACE that waits for time wakes, or NIL. Any
thread may call this function."
  (let ((published (interface-next-tick interface)))
    (if (consp published) (cdr published) published)))

(defun wants-tick-p (interface tick)
  "True if plans of INTERFACE want the run to go on from TICK. Any thread may call this function. At
the rate :FREE, ticks do not run ahead of plans that compute."
  (let ((published (interface-next-tick interface)))
    (if (consp published)
        (and (cdr published) (> (cdr published) tick))
        published)))

(defun plans-ready-p (interface)
  "True if plans of INTERFACE are ready, have posts to apply, or wait for time. For any thread."
  (and (or (interface-next-tick interface)
           (outside-request-p (interface-runner interface)))
       t))

(defun plans-in-debugger-p (interface)
  "True if the thread of INTERFACE's plans waits for an answer in a debugger. For any thread."
  (let ((calls (interface-calls interface)))
    (and calls (user-calls-origin calls) (user-calls-waiting-p calls))))

(defun blocking-task (interface)
  ;; The watcher sees only at its next sample that it has gone on.
  (let ((task (interface-hog interface)))
    (and task (eq :running (task-state task)) (not (plans-in-debugger-p interface)) task)))

;; At a REPL, threads waiting for plans give the debugger the terminal. Editors show it elsewhere.
(defun check-not-in-debugger (interface)
  "Signal MISUSE if the plans of INTERFACE, in another thread, have stopped in a debugger."
  (when (and (plans-in-debugger-p interface)
             (foreign-hook)
             (not (eq (current-thread) (interface-thread interface))))
    (reject-use "The plans of ~A have stopped in a debugger, in the thread ~A. Choose in the ~
                 debugger how the plans go on; typed there, (print-plans t t) shows the plans with ~
                 their variables."
                (simulation-name (interface-simulation interface))
                (thread-name (interface-thread interface)))))

(defun check-not-blocked (interface)
  (let ((task (blocking-task interface)))
    (when (and task (not (eq (current-thread) (interface-thread interface))))
      (reject-use "The plan ~A keeps the plans' thread busy, at ~A. (end-plan :all) ends it."
                  (task-label (task-top task)) (form-text (task-form task))))))

;; A time limit may interrupt this: the count must come out even, or plans would yield forever.
(defun call-wanting-plans (function interface)
  "Count this thread among the threads that want the plans of INTERFACE, and call FUNCTION. The
argument is a function without arguments, which FUNCTION must call when this thread has the plans.
Interrupts are deferred, except inside of ALLOWING-INTERRUPTS."
  (let ((waiting-p t))
    (flet ((have ()
             (when (shiftf waiting-p nil) (atomic-decf (interface-wanted interface)))))
      (declare (dynamic-extent #'have))
      (deferring-interrupts
        (atomic-incf (interface-wanted interface))
        (unwind-protect (funcall function #'have)
          (have))))))

(defun call-with-plans (function interface)
  "Call FUNCTION while no other thread touches the plans of INTERFACE. Signals MISUSE if a plan is
known to run Lisp code that does not return, or waits in the debugger of an editor. At a plain REPL,
you can meanwhile answer a plan that waits in a debugger."
  (check-not-blocked interface)
  (check-not-in-debugger interface)
  (if (holding-plans-p interface)
      (funcall function)
      (call-wanting-plans
       (lambda (have)
         (call-when-free-answering (interface-lock interface)
                                   (lambda ()
                                     (funcall have)
                                     (call-holding-plans function interface))))
       interface)))

(defmacro with-plans ((interface) &body body)
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (call-with-plans #'body ,interface)))

;;; The thread of live plans; see thread.lisp.

(defun wake-plans (interface)
  (when (interface-thread interface)
    (signal-semaphore (interface-wake-up interface))))

(defun plans-thread (interface)
  "Return the thread of the plans of INTERFACE, or :STARTING while the thread starts, or NIL."
  (let ((thread (interface-thread interface)))
    (unless (or (member thread '(nil :starting)) (thread-alive-p thread))
      (swap-if-eq (interface-thread interface) thread nil))
    (interface-thread interface)))

(defun wake-plans-or-owner (interface)
  (let ((simulation (interface-simulation interface)))
    (if (plans-thread interface)
        (wake-plans interface)
        (when (live-p simulation) (wake-owner (simulation-timeline simulation))))))

;;; Which interface.

(defun interface-valid-p (interface)
  "True if the run of INTERFACE is not over."
  (not (or (interface-closed-p interface)
           (simulation-over (interface-simulation interface)))))

(defun warn-once-in-run (interface key control &rest arguments)
  (warn-once key (simulation-world (interface-simulation interface))
             (apply #'format nil control arguments)))

(defun in-current-world-p (interface)
  (or (null *world*)
      (eq *world* (simulation-world (interface-simulation interface)))))

(defun usable-interface-p (interface)
  (and interface
       (interface-valid-p interface)
       (in-current-world-p interface)))

(defun interface-in-use-here ()
  "Return the interface whose plans react in this thread, or else the interface in use; or NIL."
  (or *reacting-interface* *default-interface*))

(defun usable-interface ()
  "Return the interface of the run of this thread, or NIL if there is none."
  (let ((interface (interface-in-use-here)))
    (and (usable-interface-p interface) interface)))
