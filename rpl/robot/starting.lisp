;;;; starting.lisp -- which robot plans drive, and how they take part in its simulation.

(in-package :ars-magna.rpl-robot)

(export '(*commanded-robot-hook* drivable-robot))

(defun end-plans-in-this-thread (interface closed-p &optional (closing interface))
  "End the plans of CLOSING, which is INTERFACE or a driver in it, in this thread. An interrupt ends
one cleanup at most. The function CLOSED-P says whether CLOSING is closed."
  (flet ((end ()
           (with-plans (interface) (react-fully interface))))
    (in-any-case (end)
                 ;; It may have been left before it began.
                 (unless (funcall closed-p closing) (end)))))

(defun close-interface (interface)
  "Detach INTERFACE from its simulation, and end its plans now. If the plans react in another
thread, or a plan has called this function, the plans end as soon as they can."
  (unless (interface-closing-p interface)
    (deferring-interrupts
      (setf (interface-closing-p interface) t)
      (in-any-case
        (remove-participant interface (interface-simulation interface))
        (mapc #'close-driver (interface-drivers interface))
        (cond ((holding-plans-p interface) (stop-plan (interface-runner interface)))
              ((plans-thread interface) (wake-plans interface))
              (t (end-plans-in-this-thread interface #'interface-closed-p)))))))

(defun attach-interface (interface)
  "Let INTERFACE take part in its simulation, unless that has an interface, perhaps just made by
another thread. Return the interface of the simulation."
  (let ((simulation (interface-simulation interface)))
    (setf (interface-runner interface) (make-runner interface))
    (asking (simulation)
      (or (find-if (lambda (participant)
                     (and (interface-p participant) (not (interface-closing-p participant))))
                   (simulation-participants simulation))
          (progn (add-participant interface simulation)
                 interface)))))

;; The prompt sets it to a function that returns the robot that it commands.
(defvar *commanded-robot-hook* (constantly nil)
  "A function that returns a robot or NIL: which of several robots plans drive by default.")

(defun commanded-robot ()
  (and *simulation* (funcall *commanded-robot-hook*)))

(defun check-world-to-drive (robot)
  (let ((world (robot-world robot)))
    (unless (or (null *world*) (eq world *world*))
      (reject-use "No plan can drive ~A here: ~:*~A is not in the current world, ~:[which has ~
                   another map~;but in another world of the same map. Put it into the list of ~
                   robots of this run~]. Plans can drive it inside of (with-simulation (~A) ...), ~
                   or after (simulator ~A)."
                  robot (eq (world-map world) (world-map *world*)) robot robot))
    (when (robot-retired robot)
      (reject-use "No plan can drive ~A any more: ~A.~@[ Use a robot of the run, such as ~(~A~).~]"
                  robot (robot-retired robot)
                  (let ((others (remove robot (world-robots world))))
                    (and others (robot-name (first others))))))))

(defun plans-must-end-first-p (interface simulation)
  "True if the plans of INTERFACE, of another run, must end before plans can run in SIMULATION. The
plans of a live run go on while a headless simulation runs inside of the live run."
  (or (not (interface-valid-p interface))
      (and (live-p simulation) (live-p (interface-simulation interface)))))

(defun warn-of-plan-around (driver)
  "Warn once if a plan of DRIVER calls RPL-INIT-ROBOT for its own robot, which ends the plan."
  (let ((tasks (remove-if #'task-over-p (tasks-of-driver driver))))
    (when (and tasks (participant-around-p (driver-interface driver)))
      (warn-once-in-run
       (driver-interface driver) (list :ended-by (robot-name (driver-robot driver)))
       "rpl-init-robot ~A ends the plan~P ~{~A~^, ~} of ~A. Call it before the plan, not in the ~
        plan."
       (driver-robot driver) (length tasks) (mapcar #'task-label tasks) (driver-robot driver)))))

;; A binding of *TRACE-PLANS* around a call is gone when the call is repeated.
(defun call-with-trace (traced-p function &rest arguments)
  (let ((*trace-plans* (or traced-p *trace-plans*)))
    (apply function arguments)))

(defun add-interface (simulation eras)
  "Return the interface of SIMULATION, and use it from now on. A new one has the ERAS of tasks."
  ;; Other threads may set the variable meanwhile.
  (let ((before *default-interface*))
    (when (and before (plans-must-end-first-p before simulation)) (close-interface before))
    (let ((interface (attach-interface (make-interface simulation eras))))
      (setf *default-interface* interface)
      (when (eq simulation *simulation*) (store-environment simulation))
      interface)))

;; A repeated run gives the eras that it had, so that its tasks are recognized.
(defun drive-robot-with-eras (robot eras default-p)
  "Let plans drive ROBOT, as RPL-INIT-ROBOT does. ERAS are those of a new interface. If DEFAULT-P is
true, end the plans of ROBOT; from now on plans drive ROBOT by default. Return the driver."
  (let ((simulation (robot-simulation robot)))
    (record-outside-act simulation #'call-with-trace *trace-plans* #'drive-robot-with-eras robot
                        eras default-p)
    (let ((interface (or (usable-interface) (add-interface simulation eras))))
      (multiple-value-bind (driver before) (add-driver robot interface default-p)
        (when default-p (setf (interface-default interface) driver))
        ;; Now ON-ROBOT in plans of other robots finds the new driver.
        (when before (close-driver before))
        driver))))

(defun init-robot (robot &optional default-p)
  "Return a driver for ROBOT: a new one if DEFAULT-P is true or if there is none."
  (check-world-to-drive robot)
  (drive-robot-with-eras robot (list (cons (gensym "ERA") 0)) default-p))

(public rpl-init-robot)
(defun rpl-init-robot (robot)
  "Let plans drive ROBOT from now on: a robot, the name of a robot, or a fluent with such a value.
Create new fluents for the robot and each of its parts. Return the robot (manual C). Plans that
drive ROBOT end; their cleanups run only as far as they take no time. Plans of other robots go on.
Plans that begin later drive ROBOT, unless they are begun with :ROBOT. Call RPL-INIT-ROBOT before
the other functions with RPL- in their names. RUN-PLAN calls it for the only robot of a simulation
or, at the prompt, for the robot that the prompt commands. Signals UNKNOWN-NAME. Signals MISUSE if
the robot is in another world than the current one."
  (let* ((robot (robot-meant-in-plan robot))
         (interface (usable-interface))
         (before (and interface (find-driver robot interface))))
    (when before (warn-of-plan-around before))
    (init-robot robot t)
    robot))

(defun reject-robot-for-plan (name)
  "Signal UNKNOWN-NAME: NAME was given instead of a robot or its name."
  (cond ((or (consp name) (eq name :all))
         (error 'unknown-name
                :kind "robot" :name name
                :remedy (one-line "Give one robot. Each robot needs a plan of its own: (dolist
(robot (simulation-robots)) (begin-plan PLAN ... :robot robot)).")))
        ((and *simulation* (rest (simulation-robots *simulation*)))
         (reject-name "robot in this run" name
                      (mapcar #'robot-name (simulation-robots *simulation*))))
        (t (find-robot name))))

(defun robot-meant-in-plan (robot)
  "Return the robot that ROBOT, a robot, its name or a fluent with such a value, means."
  (let ((named (fluent-value robot)))
    (cond ((robot-p named) named)
          ((and (typep named '(or symbol string)) (find-robot named nil)))
          (t (reject-robot-for-plan named)))))

(defun drivable-robot (robot)
  "Return the robot that ROBOT means, as ROBOT-MEANT-IN-PLAN. Signals UNKNOWN-NAME; and MISUSE if
plans cannot drive that robot in the current run."
  (let ((robot (robot-meant-in-plan robot)))
    (check-world-to-drive robot)
    robot))

(defun ensure-driver (robot)
  "Return the driver of ROBOT, a robot of the current run. Make a driver if there is none."
  (check-world-to-drive robot)
  (let ((interface (usable-interface)))
    (or (and interface (find-driver robot interface))
        (init-robot robot))))

(defun call-for-robot (robot operator arguments)
  "Call OPERATOR, a plan function, with ARGUMENTS outside of plans, for ROBOT."
  (let ((*repeated-driver* (ensure-driver robot)))
    (apply operator arguments)))

(addition robot-fluent)
(defun robot-fluent (robot variable &optional index)
  "Return the fluent of ROBOT, a robot or its name, that VARIABLE stands for: a symbol such as
'ROBOT-STOPPED*. If VARIABLE stands for a vector of fluents, one for each part, return the fluent of
part number INDEX, or the vector if INDEX is NIL. In a plan that drives ROBOT, the variable itself
means the same. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if ROBOT is in another world."
  (let ((robot (robot-meant-in-plan robot)))
    (check-argument robot-fluent variable (assoc variable *fluent-variables*)
                    "the name of a robot's fluent, such as 'robot-stopped*")
    (let ((value (driver-fluent variable (ensure-driver robot))))
      (cond ((null index) value)
            ((and (simple-vector-p value) (whole-p index 0 (1- (length value))))
             (svref value index))
            (t (reject-argument 'robot-fluent 'index index
                                (if (simple-vector-p value)
                                    (format nil "the number of a part: there are ~D, counted from 0"
                                            (length value))
                                    "NIL, because the robot has one such fluent")))))))

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
  (let ((drivers (interface-drivers interface)))
    (and drivers (null (rest drivers)) (driver-robot (first drivers)))))

(defmethod participant-origin ((interface interface))
  (let ((owner (plans-owner interface)) (made (interface-origin interface)))
    (if (eq owner (second made))
        made
        (setf (interface-origin interface) (list "the plans of " owner)))))

;; If plans have a thread, only that runs them: it may be waiting for the owner to answer it.
(defmethod participant-after-tick ((interface interface) simulation)
  (mapc #'note-outside-command (interface-drivers interface))
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
        ((some #'driver-answers (interface-drivers interface))
         (with-plans (interface)
           (unless (tasks-of-interface interface) (react-fully interface))))))

;; What was left ready by a thread that has ended from outside waits for the next tick.
(defmethod participant-busy-p ((interface interface) simulation)
  (cond ((plans-thread interface) (wants-tick-p interface (simulation-tick simulation)))
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
  (dolist (driver (interface-drivers interface))
    (when (tasks-of-driver driver) (note-plans-dice-used driver))
    (reseed-agent (driver-agent driver) (+ seed (seed-of-robot driver)))))

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
