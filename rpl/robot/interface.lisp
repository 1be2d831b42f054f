;;;; interface.lisp -- one robot, the runner of its plans, and who lets them react.

(in-package :ars-magna.rpl-robot)

;;; Headless, plans react at the end of each tick until all wait, so that they see every tick. Live,
;;; they run in a thread of their own, which exists while there are plans; the simulator only
;;; posts to it and never waits for it. Whoever lets plans react holds the interface's lock.

(addition *trace-plans*)
(defparameter *trace-plans* nil
  "When true, the plans' runner keeps a trace from RPL-INIT-ROBOT on, or from the start of the next
plan: of all that happens to tasks and fluents, some 50 octets for each. See PLAN-TRACE, WHY and
SAVE-PLAN-TIMELINE.")

(defstruct (interface (:constructor make-interface (robot simulation)) (:copier nil))
  "The robot that plans drive, and what runs them."
  (robot nil :type robot :read-only t)
  (simulation nil :read-only t)
  (runner nil :type (or null plan-runner))
  (ender nil :type (or null function))
  (lock (make-lock "plans") :read-only t)
  ;; The thread that holds the lock, so that plans may start and end others.
  (holder nil)
  (wake-up (make-semaphore "plans") :read-only t)
  (thread nil :type t)
  (closed-p nil)
  ;; How many commands of plans are under way.
  (under-way 0 :type atomic-count))

(defvar *interface* nil
  "The interface in use; see RPL-INIT-ROBOT.")

(pushnew '*interface* *simulation-variables*)

;;; Reacting.

(defun holding-p (interface)
  "True if this thread is letting the plans of INTERFACE react, or looks at them."
  (eq (interface-holder interface) (current-thread)))

(defun call-with-plans (function interface)
  "Call FUNCTION while nobody else touches the plans of INTERFACE."
  (if (holding-p interface)
      (funcall function)
      (with-lock ((interface-lock interface))
        (setf (interface-holder interface) (current-thread))
        (unwind-protect (funcall function)
          (setf (interface-holder interface) nil)))))

(defmacro with-plans ((interface) &body body)
  "Run BODY while nobody else touches the plans of INTERFACE."
  `(call-with-plans (lambda () ,@body) ,interface))

(defun react-fully (interface)
  "Let the plans react to time and to all that was posted, until all of them wait. The caller holds
the plans; a plan that is reacting changes nothing."
  (let ((runner (interface-runner interface))
        (simulation (interface-simulation interface)))
    (advance-timers runner (simulation-tick simulation))
    (loop while (and (eq :idle (react runner)) (apply-next-batch runner)))))

(defun wake (interface)
  (when (interface-thread interface)
    (signal-semaphore (interface-wake-up interface))))

(defun time-to-wake-p (interface)
  (let ((tick (next-wake-time (interface-runner interface))))
    (and tick (>= (simulation-tick (interface-simulation interface)) tick))))

;; In a live simulation only the plans' thread reacts: a plan may be waiting for the owner to answer
;; it.
(defmethod participant-after-tick ((interface interface) simulation)
  (cond ((interface-thread interface)
         (when (time-to-wake-p interface) (wake interface)))
        ((live-p simulation)
         (when (plan-runner-tasks (interface-runner interface)) (ensure-thread interface)))
        (t (with-plans (interface) (react-fully interface)))))

(defun run-thread (interface)
  "Let the plans react to what is posted for as long as there are any."
  (loop
    (with-plans (interface)
      ;; Looked at first: what is to end the plans has been posted by then, and is heard now.
      (let ((closed-p (interface-closed-p interface)))
        (call-user-code #'react-fully "running plans" interface)
        (unless (and (plan-runner-tasks (interface-runner interface))
                     (not closed-p))
          (setf (interface-thread interface) nil)
          (return))))
    (call-for-ticks interface)
    (wait-on-semaphore (interface-wake-up interface))))

(defun call-for-ticks (interface)
  "Have the live simulation, if it rests for want of events, go on while a plan waits for time."
  (let ((simulation (interface-simulation interface)))
    (when (and (next-wake-time (interface-runner interface))
               (zerop (agenda-pending (simulation-agenda simulation))))
      (wake-owner (simulation-timeline simulation)))))

(defun ensure-thread (interface)
  "Have a thread for the plans of a live simulation."
  (let ((simulation (interface-simulation interface)))
    (when (and (live-p simulation)
               (swap-if (interface-thread interface) nil :starting))
      (start-thread (lambda ()
                      (setf (interface-thread interface) (current-thread))
                      (let ((*interface* interface))
                        (call-as-owner simulation (lambda () (run-thread interface)))))
                    (format nil "plans of ~A" (interface-robot interface))))))

;;; Setting up.

(defun busy-p (interface)
  "True if a command of a plan is under way, or something else that is sure to happen. Kickers do
not count: they tell plans nothing."
  (let ((simulation (interface-simulation interface)))
    (or (plusp (interface-under-way interface))
        (plusp (agenda-pending (simulation-agenda simulation)))
        (timeline-inbox (simulation-timeline simulation)))))

(defun seconds-when-live (simulation)
  "Return the time in seconds, by which plans that hog their thread are noticed; headless 0."
  (if (live-p simulation) (seconds-now) 0d0))

(defun make-runner (interface)
  (let ((simulation (interface-simulation interface)))
    (make-plan-runner :trace *trace-plans*
                      :dice (make-dice (simulation-seed simulation) :plans)
                      :tick (simulation-tick simulation)
                      :busy-p (lambda () (busy-p interface))
                      :clock (lambda () (seconds-when-live simulation))
                      :slow *hog-seconds*
                      :on-post (lambda () (wake interface)))))

(defun close-interface (interface)
  "Let INTERFACE hear no more of its simulation, and its plans end."
  (let ((simulation (interface-simulation interface)))
    (stop-plan (interface-runner interface))
    (asking (simulation)
      (remove-participant interface simulation))
    (removef (robot-enders (interface-robot interface)) (interface-ender interface))
    (unless (or (interface-thread interface) (holding-p interface))
      (with-plans (interface) (react-fully interface)))
    (setf (interface-closed-p interface) t)
    (wake interface)))

(defmethod participant-busy-p ((interface interface) simulation)
  (declare (ignore simulation))
  (next-wake-time (interface-runner interface)))

(defmethod participant-reseed ((interface interface) seed)
  (reseed-runner (interface-runner interface) seed))

(defmethod participant-digest ((interface interface) digest)
  (with-plans (interface) (digest-runner (interface-runner interface) digest)))

(defmethod participant-end ((interface interface) simulation)
  (declare (ignore simulation))
  (close-interface interface))

(defun attach (interface)
  (let ((simulation (interface-simulation interface)))
    (setf (interface-runner interface) (make-runner interface)
          (interface-ender interface) (lambda () (close-interface interface)))
    (asking (simulation)
      (add-participant interface simulation)
      (push (interface-ender interface) (robot-enders (interface-robot interface))))))

(public rpl-init-robot)
(defun rpl-init-robot (robot)
  "Let plans drive ROBOT, a robot or its name, or a fluent whose value is one, from now on: make the
fluents anew, for the parts that it has. Plans under way end. Return the robot. To be called before
anything else of the interface (manual C); RUN-PLAN does it for the robot of a simulation that has
only one."
  (let* ((named (fluent-value robot))
         (robot (if (robot-p named) named (find-robot named)))
         (simulation (robot-simulation robot)))
    (when (and *interface* (ended-by-p *interface* simulation))
      (close-interface *interface*))
    (make-fluents robot)
    (setf *interface* (make-interface robot simulation))
    (attach *interface*)
    robot))

(defun ended-by-p (interface simulation)
  "True if plans of INTERFACE must end when others are to run in SIMULATION. One that a headless
simulation inside of a live one has only inherited is left alone."
  (or (eq simulation (interface-simulation interface))
      (not (interface-valid-p interface))
      (and (live-p simulation) (live-p (interface-simulation interface)))))

(defun interface-valid-p (interface)
  "True if the robot of INTERFACE still is in its world, and that in the same simulation."
  (let ((robot (interface-robot interface))
        (simulation (interface-simulation interface)))
    (and (not (interface-closed-p interface))
         (null (simulation-over simulation))
         (null (robot-retired robot))
         (eq simulation (robot-simulation robot))
         (member robot (simulation-robots simulation))
         t)))

(defun usable-p (interface)
  "True if there is an INTERFACE, valid and for the world that we are in, if any."
  (and interface
       (interface-valid-p interface)
       (or (null *world*)
           (eq *world* (robot-world (interface-robot interface))))))

(defun the-interface ()
  (if (usable-p *interface*)
      *interface*
      (reject-use "No robot to drive. Call (rpl-init-robot ROBOT) first; after a simulator has ~
                   been started anew, or the robot defined anew, call it again.")))

(addition rpl-robot)
(defun rpl-robot ()
  "Return the robot that plans drive. Signals MISUSE without one."
  (interface-robot (the-interface)))

(addition rpl-runner)
(defun rpl-runner ()
  "Return the plan runner of the robot that plans drive; see PLAN-TRACE, PRINT-TASKS."
  (interface-runner (the-interface)))

;;; When a simulator starts.

(defun forget-interface (robot options)
  "End the plans of a simulation that is gone, now that the simulator of ROBOT has started."
  (declare (ignore options))
  (when (and *interface*
             (not (eq (interface-simulation *interface*) (robot-simulation robot))))
    (unless (interface-valid-p *interface*) (close-interface *interface*))
    (setf *interface* nil)))

(pushnew 'forget-interface *simulator-hooks*)
