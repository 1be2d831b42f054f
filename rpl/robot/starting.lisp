;;;; starting.lisp -- which robot plans drive: beginning and end of that.

(in-package :ars-magna.rpl-robot)

(export '(*robot-to-drive*))

(defun end-plans-here (interface)
  "Let the plans of INTERFACE, which is to end, end in this thread. What interrupts that leaves one
thing that they do to clean up, at most."
  (flet ((end ()
           (with-plans (interface) (react-fully interface))))
    (in-any-case (end)
                 ;; It may have been left before it began.
                 (unless (interface-closed-p interface) (end)))))

(defun close-interface (interface)
  "Let INTERFACE hear no more of its simulation, and its plans end: now, or, if they react in
another thread or around this call, when they get to it."
  (unless (interface-closing-p interface)
    (deferring-interrupts
      (setf (interface-closing-p interface) t)
      (in-any-case
        (remove-participant interface (interface-simulation interface))
        (removef (robot-enders (interface-robot interface)) (interface-ender interface))
        (cond ((holding-p interface) (stop-plan (interface-runner interface)))
              ((thread-of interface) (wake interface))
              (t (end-plans-here interface)))))))

(defun attach (interface)
  (let ((simulation (interface-simulation interface)))
    (setf (interface-runner interface) (make-runner interface)
          (interface-ender interface) (lambda () (close-interface interface)))
    (asking (simulation)
      (add-participant interface simulation)
      (push (interface-ender interface) (robot-enders (interface-robot interface))))))

;; The prompt sets it to know the robot that it commands.
(defvar *robot-to-drive* (constantly nil)
  "A function that returns which of several robots plans are to drive if nobody has said so; or NIL
if there is none.")

(defun commanded-robot ()
  "Return the robot that the prompt commands in which this thread is, or NIL."
  (and *simulation* (funcall *robot-to-drive*)))

(defun check-world (robot)
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

(defun tell-of-ended (interface robot)
  "Say once if plans of INTERFACE end, as plans are to drive ROBOT, another one of the same run, or
as one of them says so itself."
  (let* ((tasks (remove-if #'task-over-p (tasks-of interface))) (before (interface-robot interface))
         (same-p (eq robot before)))
    (when (and tasks
               (interface-valid-p interface)
               (or (not same-p) (participant-around-p interface))
               (eq (interface-simulation interface) (robot-simulation robot)))
      (tell-once interface (list :ended-by (robot-name before) (robot-name robot))
                 "rpl-init-robot ~A ends the plan~P ~{~A~^, ~} of ~A~:[, as plans drive one robot ~
                  at a time. Let them end first, as (run-plan ...) does, or drive one of the ~
                  robots by commands and continuations~;. Call it before the plan, not in it~]."
                 robot (length tasks) (mapcar #'task-label tasks) before same-p))))

;; What is bound to *TRACE-PLANS* around a doing is gone when that is done again.
(defun do-traced (traced-p function &rest arguments)
  "Call FUNCTION with ARGUMENTS, as was done where plans were to be traced if TRACED-P."
  (let ((*trace-plans* (or traced-p *trace-plans*)))
    (apply function arguments)))

;; Who repeats a run says which eras these were, so that the tasks of then are known.
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
  (check-world robot)
  (drive-in-eras robot (list (cons (gensym "ERA") 0))))

(public rpl-init-robot)
(defun rpl-init-robot (robot)
  "Let plans drive ROBOT, a robot or its name, or a fluent whose value is one, from now on: make the
fluents anew, for the parts that it has. Plans under way end; what they do to clean up goes on only
as far as it takes no time. Return the robot. To be called before anything else of the interface
(manual C); RUN-PLAN does it for the robot of a simulation that has only one, and at the prompt for
the robot that this commands. Signals UNKNOWN-NAME, and MISUSE if the robot is in another world than
the current one."
  (let* ((named (fluent-value robot))
         (robot (if (robot-p named) named (find-robot named)))
         (before *interface*))
    (when before (tell-of-ended before robot))
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
