;;;; starting.lisp -- which robot plans drive, and how they take part in its simulation.

(in-package :ars-magna.rpl-robot)

(export '(*commanded-robot-hook*))

(defun end-plans-in-this-thread (interface)
  "End the plans of the closing INTERFACE in this thread. An interrupt ends one cleanup at most."
  (flet ((end ()
           (with-plans (interface) (react-fully interface))))
    (in-any-case (end)
                 ;; It may have been left before it began.
                 (unless (interface-closed-p interface) (end)))))

(defun close-interface (interface)
  "Detach INTERFACE from its simulation, and end its plans now. If the plans react in another
thread, or a plan has called this function, the plans end as soon as they can."
  (unless (interface-closing-p interface)
    (deferring-interrupts
      (setf (interface-closing-p interface) t)
      (in-any-case
        (remove-participant interface (interface-simulation interface))
        (removef (robot-enders (interface-robot interface)) (interface-ender interface))
        (cond ((holding-plans-p interface) (stop-plan (interface-runner interface)))
              ((plans-thread interface) (wake-plans interface))
              (t (end-plans-in-this-thread interface)))))))

(defun attach-interface (interface)
  (let ((simulation (interface-simulation interface)))
    (setf (interface-runner interface) (make-runner interface)
          (interface-ender interface) (lambda () (close-interface interface)))
    (asking (simulation)
      (add-participant interface simulation)
      (push (interface-ender interface) (robot-enders (interface-robot interface))))))

;; The prompt sets it to a function that returns the robot that it commands.
(defvar *commanded-robot-hook* (constantly nil)
  "A function that returns a robot or NIL: which of several robots plans drive by default.")

(defun commanded-robot ()
  (and *simulation* (funcall *commanded-robot-hook*)))

(defun check-world-to-drive (robot)
  (let ((world (robot-world robot)))
    (unless (or (null *world*) (eq world *world*))
      (reject-use "rpl-init-robot: ~A is not in the current world, ~:[which has another map~;but ~
                   in another world of the same map~]. Call it where that robot is: inside of ~
                   (with-simulation (~A) ...), or after (simulator ~A)."
                  robot (eq (world-map world) (world-map *world*)) robot robot))))

(defun plans-must-end-first-p (interface simulation)
  "True if the plans of INTERFACE must end before other plans can run in SIMULATION. The plans of a
live run go on while a headless simulation runs inside of the live run."
  (or (eq simulation (interface-simulation interface))
      (not (interface-valid-p interface))
      (and (live-p simulation) (live-p (interface-simulation interface)))))

(defun warn-of-ended-plans (interface robot)
  "Warn once that plans of INTERFACE end because plans are to drive ROBOT. Warn only if ROBOT is
another robot of the same run, or if one of these plans has called RPL-INIT-ROBOT itself."
  (let* ((tasks (remove-if #'task-over-p (tasks-of-interface interface)))
         (before (interface-robot interface))
         (same-p (eq robot before)))
    (when (and tasks
               (interface-valid-p interface)
               (or (not same-p) (participant-around-p interface))
               (eq (interface-simulation interface) (robot-simulation robot)))
      (warn-once-in-run
       interface (list :ended-by (robot-name before) (robot-name robot))
       "rpl-init-robot ~A ends the plan~P ~{~A~^, ~} of ~A~:[, because plans drive one robot at a ~
        time. Let the plans end first, as (run-plan ...) does, or drive one of the robots by ~
        commands and continuations~;. Call it before the plan, not in the plan~]."
       robot (length tasks) (mapcar #'task-label tasks) before same-p))))

;; A binding of *TRACE-PLANS* around a call is gone when the call is repeated.
(defun call-with-trace (traced-p function &rest arguments)
  (let ((*trace-plans* (or traced-p *trace-plans*)))
    (apply function arguments)))

;; A repeated run gives the eras that it had, so that its tasks are recognized.
(defun drive-robot-with-eras (robot eras)
  "Let plans drive ROBOT, as RPL-INIT-ROBOT does, with the ERAS of tasks. Return the new interface."
  ;; Other threads may set the variable meanwhile.
  (let ((simulation (robot-simulation robot)) (before *default-interface*))
    (record-outside-act simulation #'call-with-trace *trace-plans* #'drive-robot-with-eras robot
                        eras)
    (when (and before (plans-must-end-first-p before simulation)) (close-interface before))
    (make-fluents robot)
    (let ((interface (make-interface robot simulation eras (commanded-robot))))
      (attach-interface interface)
      (setf *default-interface* interface)
      (when (eq simulation *simulation*) (store-environment simulation))
      interface)))

(defun init-robot (robot)
  (check-world-to-drive robot)
  (drive-robot-with-eras robot (list (cons (gensym "ERA") 0))))

(public rpl-init-robot)
(defun rpl-init-robot (robot)
  "Let plans drive ROBOT from now on: a robot, the name of a robot, or a fluent with such a value.
Create new fluents for the robot and each of its parts. Return the robot (manual C). Running plans
end; their cleanups run only as far as they take no time. Call RPL-INIT-ROBOT before the other
functions with RPL- in their names. RUN-PLAN calls it for the only robot of a simulation or, at the
prompt, for the robot that the prompt commands. Signals UNKNOWN-NAME. Signals MISUSE if the robot is
in another world than the current one."
  (let* ((named (fluent-value robot))
         (robot (if (robot-p named) named (find-robot named)))
         (before *default-interface*))
    (when before (warn-of-ended-plans before robot))
    (init-robot robot)
    robot))

;;; When a simulator starts.

(defun close-old-interface (robot options)
  "End the plans of an earlier simulation, because the simulator of ROBOT has started."
  (declare (ignore options))
  (let ((interface *default-interface*))
    (when (and interface
               (not (eq (interface-simulation interface) (robot-simulation robot))))
      (unless (interface-valid-p interface) (close-interface interface))
      (when (eq interface *default-interface*) (setf *default-interface* nil)))))

(add-listener *simulator-hooks* close-old-interface)

;;;; Taking part in the simulation

(defun time-to-wake-p (interface)
  (or (interface-tick-wanted-p interface) (woken-by-tick-p interface)))

(defun advance-without-reaction (interface)
  "If no plan of INTERFACE has to run in this tick, as in most ticks, only set the plans' tick, and
return true. No other thread may touch the plans meanwhile."
  (let* ((simulation (interface-simulation interface))
         (timeline (simulation-timeline simulation)))
    (not (or (interface-closing-p interface)
             (interface-wishes interface)
             (thinking-charged-p timeline)
             (not (skip-idle-tick (interface-runner interface) (timeline-tick timeline)))))))

(defmethod participant-robot ((interface interface))
  (interface-robot interface))

(defmethod participant-origin ((interface interface))
  (or (interface-origin interface)
      (setf (interface-origin interface) (list "the plans of " (interface-robot interface)))))

;; If plans have a thread, only that runs them: it may be waiting for the owner to answer it.
(defmethod participant-after-tick ((interface interface) simulation)
  (note-outside-command interface)
  (cond ((plans-thread interface)
         (when (or (time-to-wake-p interface) (not (plans-thread-wanted-p interface)))
           (wake-plans interface)))
        ((not (plans-thread-wanted-p interface))
         (record-code-moment (simulation-timeline simulation))
         (if (live-p simulation)
             (with-plans (interface)
               (unless (advance-without-reaction interface) (react-fully interface)))
             ;; Headless there is no other thread, and most ticks need no lock.
             (unless (and (null (interface-holder interface)) (advance-without-reaction interface))
               (with-plans (interface) (react-fully interface)))))
        ((tasks-of-interface interface) (ensure-thread interface))
        ;; Without plans what was posted is only applied.
        ((interface-answers interface)
         (with-plans (interface)
           (unless (tasks-of-interface interface) (react-fully interface))))))

;; What was left ready by a thread that has ended from outside waits for the next tick.
(defmethod participant-busy-p ((interface interface) simulation)
  (cond ((plans-thread interface) (wake-tick interface))
        ((plans-ready-p interface))
        ((wish-to-serve interface) t)
        ((live-p simulation)
         (and (plans-thread-wanted-p interface) (tasks-of-interface interface) t))))

;; A thread that applies posts holds the plans, and publishes what is left before it releases them.
(defmethod participant-at-work-p ((interface interface))
  (or (plans-ready-p interface)
      (interface-holder interface)
      (plans-ready-p interface)))

(defmethod participant-reseed ((interface interface) seed)
  (reseed-agent (runner-agent (interface-runner interface)) seed))

;; The current step of a live plan cannot be waited for: then only whether it is at work counts.
(defmethod participant-digest ((interface interface) digest)
  (flet ((add () (digest-runner (interface-runner interface) digest)))
    (if (plans-thread interface)
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
  (loop for task in (tasks-of-interface interface)
        unless (or (task-parent task) (task-over-p task))
          collect (format nil "the plan ~A" (task-label task))))
