;;;; starting.lisp -- which robot plans drive, and how they take part in its simulation.

(in-package :ars-magna.rpl-robot)

(export '(*robot-to-drive*))

(defun end-plans-in-this-thread (interface)
  "End the plans of INTERFACE, which is to end, in this thread. An interrupt breaks off one of their
cleanups at most."
  (flet ((end ()
           (with-plans (interface) (react-fully interface))))
    (in-any-case (end)
                 ;; It may have been left before it began.
                 (unless (interface-closed-p interface) (end)))))

(defun close-interface (interface)
  "Detach INTERFACE from its simulation, and end its plans: now or, if they react in another thread
or around this call, as soon as they can."
  (unless (interface-closing-p interface)
    (deferring-interrupts
      (setf (interface-closing-p interface) t)
      (in-any-case
        (remove-participant interface (interface-simulation interface))
        (removef (robot-enders (interface-robot interface)) (interface-ender interface))
        (cond ((holding-p interface) (stop-plan (interface-runner interface)))
              ((thread-of interface) (wake-plans interface))
              (t (end-plans-in-this-thread interface)))))))

(defun attach (interface)
  (let ((simulation (interface-simulation interface)))
    (setf (interface-runner interface) (make-runner interface)
          (interface-ender interface) (lambda () (close-interface interface)))
    (asking (simulation)
      (add-participant interface simulation)
      (push (interface-ender interface) (robot-enders (interface-robot interface))))))

;; The prompt sets it to a function that returns the robot that it commands.
(defvar *robot-to-drive* (constantly nil)
  "A function that returns which of several robots plans drive by default, or NIL.")

(defun commanded-robot ()
  "Return the robot that the prompt commands in which this thread is, or NIL."
  (and *simulation* (funcall *robot-to-drive*)))

(defun check-world-to-drive (robot)
  (let ((world (robot-world robot)))
    (unless (or (null *world*) (eq world *world*))
      (reject-use "rpl-init-robot: ~A is not in the world that we are in, ~
                   ~:[which is of another map~;but in another of the same map~]. Call it where ~
                   that robot is: inside of (with-simulation (~A) ...), or after (simulator ~A)."
                  robot (eq (world-map world) (world-map *world*)) robot robot))))

(defun ended-by-p (interface simulation)
  "True if plans of INTERFACE must end when others are to run in SIMULATION. One that a headless
simulation inside of a live one has only inherited is left alone."
  (or (eq simulation (interface-simulation interface))
      (not (interface-valid-p interface))
      (and (live-p simulation) (live-p (interface-simulation interface)))))

(defun warn-of-ended (interface robot)
  "Say once if plans of INTERFACE end, as plans are to drive ROBOT, another one of the same run, or
as one of them says so itself."
  (let* ((tasks (remove-if #'task-over-p (tasks-of interface))) (before (interface-robot interface))
         (same-p (eq robot before)))
    (when (and tasks
               (interface-valid-p interface)
               (or (not same-p) (participant-around-p interface))
               (eq (interface-simulation interface) (robot-simulation robot)))
      (warn-once-in-run
       interface (list :ended-by (robot-name before) (robot-name robot))
       "rpl-init-robot ~A ends the plan~P ~{~A~^, ~} of ~A~:[, as plans drive one robot ~
        at a time. Let them end first, as (run-plan ...) does, or drive one of the ~
        robots by commands and continuations~;. Call it before the plan, not in it~]."
       robot (length tasks) (mapcar #'task-label tasks) before same-p))))

;; A binding of *TRACE-PLANS* around a call is gone when the call is repeated.
(defun do-traced (traced-p function &rest arguments)
  "Call FUNCTION with ARGUMENTS, and trace plans if TRACED-P."
  (let ((*trace-plans* (or traced-p *trace-plans*)))
    (apply function arguments)))

;; A repeated run gives the eras that it had, so that its tasks are recognized.
(defun drive-in-eras (robot eras)
  "Do what RPL-INIT-ROBOT does with ROBOT, whose tasks are to be of ERAS. Return the interface."
  ;; Other threads may set the variable meanwhile.
  (let ((simulation (robot-simulation robot)) (before *interface*))
    (note-doing simulation #'do-traced *trace-plans* #'drive-in-eras robot eras)
    (when (and before (ended-by-p before simulation)) (close-interface before))
    (make-fluents robot)
    (let ((interface (make-interface robot simulation eras (commanded-robot))))
      (attach interface)
      (setf *interface* interface)
      (when (eq simulation *simulation*) (note-environment simulation))
      interface)))

(defun init-robot (robot)
  (check-world-to-drive robot)
  (drive-in-eras robot (list (cons (gensym "ERA") 0))))

(public rpl-init-robot)
(defun rpl-init-robot (robot)
  "Let plans drive ROBOT, a robot or its name, or a fluent whose value is one, from now on. Create
its fluents anew, one for each of its parts. Return the robot (manual C). Running plans end; of
their cleanups only what takes no time is done. Call it before anything else of the interface;
RUN-PLAN does so for the only robot of a simulation, and at the prompt for the robot commanded
there. Signals UNKNOWN-NAME, and MISUSE if the robot is in another world than the current one."
  (let* ((named (fluent-value robot))
         (robot (if (robot-p named) named (find-robot named)))
         (before *interface*))
    (when before (warn-of-ended before robot))
    (init-robot robot)
    robot))

;;; When a simulator starts.

(defun forget-interface (robot options)
  "End the plans of a simulation that is gone, now that the simulator of ROBOT has started."
  (declare (ignore options))
  (let ((interface *interface*))
    (when (and interface
               (not (eq (interface-simulation interface) (robot-simulation robot))))
      (unless (interface-valid-p interface) (close-interface interface))
      (when (eq interface *interface*) (setf *interface* nil)))))

(attend *simulator-hooks* forget-interface)

;;;; Taking part in the simulation

(defun time-to-wake-p (interface)
  "True if plans of INTERFACE, which wait, wait for this tick."
  (or (interface-tick-wanted-p interface) (woken-by-tick-p interface)))

(defun rest-fully (interface)
  "Set the tick of the plans of INTERFACE, which no other thread touches, without a reaction, if
none has to run in it. True if so, as in most ticks."
  (let* ((simulation (interface-simulation interface))
         (timeline (simulation-timeline simulation)))
    (not (or (interface-closing-p interface)
             (interface-wishes interface)
             (thinking-charged-p timeline)
             (not (skip-idle-tick (interface-runner interface) (timeline-tick timeline)))))))

(defmethod participant-origin ((interface interface))
  (or (interface-origin interface)
      (setf (interface-origin interface) (list "the plans of " (interface-robot interface)))))

;; If plans have a thread, only that runs them: it may be waiting for the owner to answer it.
(defmethod participant-after-tick ((interface interface) simulation)
  (note-outside-command interface)
  (cond ((thread-of interface)
         (when (or (time-to-wake-p interface) (not (thread-wanted-p interface)))
           (wake-plans interface)))
        ((not (thread-wanted-p interface))
         (begin-moment (simulation-timeline simulation))
         (if (live-p simulation)
             (with-plans (interface)
               (unless (rest-fully interface) (react-fully interface)))
             ;; Headless there is no other thread, and most ticks need no lock.
             (unless (and (null (interface-holder interface)) (rest-fully interface))
               (with-plans (interface) (react-fully interface)))))
        ((tasks-of interface) (ensure-thread interface))
        ;; Without plans what was posted is only applied.
        ((interface-answers interface)
         (with-plans (interface)
           (unless (tasks-of interface) (react-fully interface))))))

;; What was left ready by a thread that has ended from outside waits for the next tick.
(defmethod participant-busy-p ((interface interface) simulation)
  (cond ((thread-of interface) (wake-tick interface))
        ((ready-p interface))
        ((wish-to-serve interface) t)
        ((live-p simulation) (and (thread-wanted-p interface) (tasks-of interface) t))))

;; A thread that applies posts holds the plans, and publishes what is left before it releases them.
(defmethod participant-at-work-p ((interface interface))
  (or (ready-p interface)
      (interface-holder interface)
      (ready-p interface)))

(defmethod participant-reseed ((interface interface) seed)
  (reseed-runner (interface-runner interface) seed))

;; The current step of a live plan cannot be waited for: then only whether it is at work counts.
(defmethod participant-digest ((interface interface) digest)
  (flet ((add () (digest-runner (interface-runner interface) digest)))
    (if (thread-of interface)
        (unless (nth-value 1 (call-with-plans-if-free #'add interface))
          (digest-add digest :at-work))
        (with-plans (interface) (add)))))

;; A thread of plans has nothing to do while no ticks pass, and does not exist forever.
(defmethod participant-clock-stopped ((interface interface))
  (wake-plans interface))

(defmethod participant-end ((interface interface) simulation)
  (declare (ignore simulation))
  (close-interface interface))

(defmethod participant-unfinished ((interface interface))
  (loop for task in (tasks-of interface)
        unless (or (task-parent task) (task-over-p task))
          collect (format nil "the plan ~A" (task-label task))))
