;;;; robot-interface.lisp -- one robot, the runner of its plans, and who lets them react.

(in-package :ars-magna.rpl-robot)

;;; Headless, plans react at the end of each tick until all wait, so that they see every tick. Live,
;;; they run in a thread of their own, which exists while there are plans; the simulator only
;;; posts to it. Whoever lets plans react holds the interface's lock.

(defparameter *trace-plans* nil
  "When true, RPL-INIT-ROBOT makes the plans' runner keep a trace; see PLAN-TRACE.")

(defstruct (interface (:constructor make-interface (robot simulation)) (:copier nil))
  "The robot that plans drive, and what runs them."
  (robot nil :type robot :read-only t)
  (simulation nil :read-only t)
  (runner nil :type (or null plan-runner))
  (observer nil :type (or null function))
  (lock (make-lock "plans") :read-only t)
  (wake-up (make-semaphore "plans") :read-only t)
  (thread nil))

(defvar *interface* nil
  "The interface in use; see RPL-INIT-ROBOT.")

(pushnew '*interface* *simulation-variables*)

;;; Reacting.

(defun react-fully (interface)
  "Let the plans react to time and to all that was posted, until all of them wait."
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

(defun after-tick (interface)
  "Called by the simulation's owner after each tick."
  (cond ((interface-thread interface)
         (when (time-to-wake-p interface) (wake interface)))
        (t (with-lock ((interface-lock interface))
             (unless (interface-thread interface) (react-fully interface))))))

(defun run-thread (interface)
  "Let the plans react to what is posted for as long as there are any."
  (loop
    (with-lock ((interface-lock interface))
      (react-fully interface)
      (unless (plan-runner-tasks (interface-runner interface))
        (setf (interface-thread interface) nil)
        (return)))
    (wait-on-semaphore (interface-wake-up interface))))

(defun ensure-thread (interface)
  "Have a thread for the plans of a live simulation. The caller holds the lock."
  (let ((simulation (interface-simulation interface)))
    (when (and (live-p simulation) (null (interface-thread interface)))
      (setf (interface-thread interface)
            (start-thread (lambda ()
                            (call-as-owner simulation (lambda () (run-thread interface))))
                          (format nil "plans of ~A" (interface-robot interface)))))))

;;; Setting up.

(defun make-runner (interface)
  (let ((simulation (interface-simulation interface)))
    (make-plan-runner :trace *trace-plans*
                      :dice (make-dice (ars-magna.time:simulation-seed simulation) :plans)
                      :tick (simulation-tick simulation)
                      :busy-p (lambda () (not (ars-magna.time:idle-p simulation)))
                      :on-post (lambda () (wake interface)))))

(defun detach (interface)
  "Let INTERFACE hear no more of its simulation, and its plans end."
  (let ((simulation (interface-simulation interface)))
    (stop-plan (interface-runner interface))
    (asking (simulation) (remove-observer (interface-observer interface) simulation))
    (wake interface)))

(defun attach (interface)
  (let ((simulation (interface-simulation interface)))
    (setf (interface-runner interface) (make-runner interface)
          (interface-observer interface) (lambda (simulation)
                                           (declare (ignore simulation))
                                           (after-tick interface)))
    (asking (simulation) (add-observer (interface-observer interface) simulation))))

(defun rpl-init-robot (robot)
  "Let plans drive ROBOT, a robot or its name, from now on: make the fluents anew, for the parts
that ROBOT has. Plans under way end. Return ROBOT. To be called before anything else of the
interface (manual C); RUN-PLAN does it for the robot of a simulation that has only one."
  (let* ((robot (if (robot-p robot) robot (find-robot robot)))
         (simulation (robot-simulation* robot)))
    (when (and *interface* (eq simulation (interface-simulation *interface*)))
      (detach *interface*))
    (make-fluents robot)
    (setf *interface* (make-interface robot simulation))
    (attach *interface*)
    robot))

(defun robot-simulation* (robot)
  (or (robot-simulation robot)
      (resident-simulation (ars-magna.world:world-map (robot-world robot)))))

(defun usable-p (interface)
  "True if the simulation of INTERFACE is still the one of its robot's world."
  (and interface
       (eq (interface-simulation interface) (robot-simulation (interface-robot interface)))))

(defun the-interface ()
  (if (usable-p *interface*)
      *interface*
      (reject-use "No robot to drive. Call (rpl-init-robot ROBOT) first; after a simulator has been ~
                   started anew, call it again.")))

(defun rpl-robot ()
  "Return the robot that plans drive. Signals MISUSE without one."
  (interface-robot (the-interface)))

(defun rpl-runner ()
  "Return the plan runner of the robot that plans drive; see PLAN-TRACE, PRINT-TASKS."
  (interface-runner (the-interface)))
