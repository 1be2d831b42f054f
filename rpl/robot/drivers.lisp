;;;; drivers.lisp -- the robots that plans drive, each with its fluents; which of them is meant.

(in-package :ars-magna.rpl-robot)

(export '(driver-interface driver-of-task ensure-driver fluent-of-robot robot-name-of-plan
          agent-driven))

;;; A robot gets a driver when plans first drive it, and a new one at each RPL-INIT-ROBOT. The
;;; functions and variables for plans mean one driver: in a plan that of the innermost ON-ROBOT or
;;; else of the plan; elsewhere that of the last RPL-INIT-ROBOT or, without such a call, of the only
;;; robot or of the robot that the prompt commands.

(define-kind (driver :constructor (make-driver (interface robot)))
    "What the plans of a run know of one robot and do with it."
  (:fixed
   (interface nil (or null interface) "the interface of the run")
   (robot nil (or null robot) "the robot that plans drive" :export)
   (valve (make-valve "robot") valve "the valve of the robot, to be owned by a task at a time")
   (agent nil t "the agent of the plan runner for the plans of the robot"))
  (:state
   (fluents '() list "an alist from variables to the robot's fluents, or vectors of fluents")
   (actions '() list "the commands of plans that are under way, the oldest first")
   (answers '() list "the answers to commands that are not applied yet, the oldest first")
   (takeovers '() list "lists of a resource and how often plans have taken it in a tick")
   (takeover-tick nil t "the tick that the counts in TAKEOVERS are for"))
  (:memory
   (warned '() list "an alist from warnings of takeovers to ticks")
   (outside nil symbol "the command in progress that no plan has issued, or NIL")
   (last-command '() list "the plan, the function and the part of the last command")
   (pulses '() list "lists (fluent's-name plan tick): the last pulses by commands")
   (unread '() list "errors of commands that plans have not read; see RECORD-UNREAD-END"))
  (:link
   (ender nil (or null function) "the function that the robot calls when its run ends")
   (closing-p nil boolean "the plans of the driver are to end")
   (closed-p nil boolean "the plans of the driver have ended")
   (actions-lock (make-lock "commands of plans") t "the lock for access to actions and answers")))

(defmethod print-object ((driver driver) stream)
  (print-unreadable-object (driver stream :type t)
    (princ (driver-robot driver) stream)))

(defun find-driver (robot interface)
  "Return the driver of ROBOT in INTERFACE, or NIL if no plan has driven ROBOT."
  (find robot (interface-drivers interface) :key #'driver-robot))

(defun driver-valid-p (driver)
  "True if the robot of DRIVER is still in its run, and its plans have not ended for good."
  (let ((robot (driver-robot driver)) (interface (driver-interface driver)))
    (and (not (driver-closed-p driver))
         (interface-valid-p interface)
         (null (robot-retired robot))
         (member robot (simulation-robots (interface-simulation interface)))
         t)))

(defun driver-simulation (driver)
  (interface-simulation (driver-interface driver)))

(defun driver-runner (driver)
  (interface-runner (driver-interface driver)))

(defun plans-owner (interface)
  "Return the robot that the plans of INTERFACE drive. Return the name of the run if it has several
robots, or if its plans drive no robot."
  (let ((drivers (interface-drivers interface)) (simulation (interface-simulation interface)))
    (if (and drivers (null (rest drivers)) (null (rest (simulation-robots simulation))))
        (driver-robot (first drivers))
        (simulation-name simulation))))

;;; Which driver.

(defun newest-driver (driver)
  "Return the driver that has replaced DRIVER, if RPL-INIT-ROBOT was called since, or else DRIVER."
  (if (driver-closing-p driver)
      (or (find-driver (driver-robot driver) (driver-interface driver)) driver)
      driver))

(defun driver-of-task (task)
  "Return the driver of the robot that TASK, a task of a run, drives."
  (let* ((*calling-task* task) (driver (task-variable 'driver)))
    ;; The robot of an ON-ROBOT may have got new fluents since.
    (if driver (newest-driver driver) (driver-of-plan task))))

(defun driver-with-last-command (driver task)
  "Return the driver to whose robot TASK, of a plan of DRIVER, has given its last command."
  (or (find (task-serial (task-top task)) (interface-drivers (driver-interface driver))
            :key (lambda (driver) (first (driver-last-command driver))))
      driver))

(defun driver-of-plan (task)
  "Return the driver of the robot for which the plan of TASK was begun."
  (task-client task))

(defun agent-driven (task)
  "Return the agent of the robot that TASK drives, or of the plan of TASK if it drives no robot."
  (let ((driver (driver-of-task task)))
    (if (driver-p driver) (driver-agent driver) (task-agent task))))

(defmethod robot-name-of-client ((driver driver))
  (robot-name (driver-robot driver)))

(defun robot-name-of-plan (task)
  "Return the name of the robot for which the plan of TASK was begun."
  (robot-name-of-client (driver-of-plan task)))

(defun default-robot (simulation)
  "Return the robot of SIMULATION that plans drive by default: the only robot, or the robot that the
prompt commands; NIL if several robots are possible."
  (let ((robots (simulation-robots simulation)))
    (if (rest robots)
        (find (commanded-robot) robots)
        (first robots))))

(defvar *repeated-driver* nil
  "The driver that code outside of plans means while it is repeated in this thread, or NIL.")

(defvar *begun-driver* nil
  "While a plan gets default values of its arguments: the driver of the plan. Otherwise NIL.")

(defun default-driver (interface)
  "Return the driver that code outside of plans means, or NIL if there is none yet."
  (let ((driver (or *repeated-driver* (interface-default interface))))
    (cond ((and driver (driver-valid-p driver)) driver)
          (t (let ((robot (default-robot (interface-simulation interface))))
               (and robot (find-driver robot interface)))))))

(defun driver-here ()
  "Return the driver that the calling code means, or NIL. A plan may have a driver even if its run
is over."
  (let* ((interface (interface-in-use-here))
         (task (and interface (in-current-world-p interface) (calling-task))))
    (cond ((and *begun-driver* (usable-interface-p interface)) *begun-driver*)
          ((and task (eq (task-runner task) (interface-runner interface))) (driver-of-task task))
          ((usable-interface-p interface) (default-driver interface)))))

(defun reject-without-robot ()
  (let ((robots (and *simulation* (simulation-robots *simulation*)))
        (alone-p (and *runner* (null (runner-client *runner*)))))
    (reject-use "No robot to drive. ~:[Call (rpl-init-robot ROBOT) first; after a simulator has ~
                 been started anew, or the robot defined anew, call it again. Outside of plans use ~
                 commands without RPL-, such as (robot-turn ~(~A~) 1).~;RUN-PLAN-ALONE runs plans ~
                 without a robot. RUN-PLAN runs them on the robot of the run.~]"
                alone-p (if robots (robot-name (first robots)) 'robot))))

(defun required-driver ()
  "Return the driver that the calling code means. If the robot of a plan that runs in this thread is
gone, end that plan. Signals MISUSE without a driver."
  (let ((driver (driver-here)))
    (cond ((and driver (driver-valid-p driver)) driver)
          (t (when driver (fail-on-lost-robot driver))
             (when (or driver *reacting-interface*) (leave-plan))
             (reject-without-robot)))))

(defun fail-on-lost-robot (driver)
  "If the calling plan drives the robot of DRIVER, which is gone, in an ON-ROBOT, let it fail."
  (let ((task (calling-task)))
    (when (and task
               (driver-valid-p (driver-of-plan task))
               (not (eq driver (driver-of-plan task))))
      (fail :class :robot-gone :robot (robot-name (driver-robot driver))))))

(defun required-interface ()
  "Return the interface of the current run. Signals MISUSE if there is none."
  (or (usable-interface) (driver-interface (required-driver))))

(addition rpl-robot)
(defun rpl-robot ()
  "Return the robot that the calling plan drives; outside of plans, the robot that plans drive by
default. Signals MISUSE without a robot."
  (driver-robot (required-driver)))

(addition rpl-robot-valve)
(defun rpl-robot-valve ()
  "Return the valve of the robot that the calling plan drives. If plans or branches of a plan may
run side by side on one robot, each should own the valve while it drives: (with-valve
((rpl-robot-valve)) ...). The shipped plans do so. Nothing enforces the use of the valve. Signals
MISUSE without a robot."
  (driver-valve (required-driver)))

(addition rpl-runner)
(defun rpl-runner ()
  "Return the plan runner of the current run; see PLAN-TRACE, PRINT-TASKS. Signals MISUSE if no plan
has driven a robot of the run."
  (interface-runner (required-interface)))

;;; Thoughts.

(defmethod ticks-to-think ((driver driver) agent span)
  (declare (ignore agent))
  (charge-thought (driver-robot driver) span))

;;; Fluents.

(defun driver-fluent (variable driver)
  "Return the fluent of DRIVER, or the vector of fluents, that VARIABLE stands for."
  (loop for fluents = (driver-fluents driver)
        for entry = (assoc variable fluents :test #'eq)
        when entry return (cdr entry)
        ;; The variable was defined later, and other threads may be here too.
        do (let ((fluent (make-fluent-for-variable variable (driver-robot driver))))
             (swap-if-eq (driver-fluents driver) fluents
                         (append fluents (list (cons variable fluent)))))))

(defun fluent-of-robot (variable robot)
  "Return the fluent of ROBOT, or the vector of fluents, that VARIABLE stands for; NIL if no plan
has driven ROBOT in its run."
  (let* ((interface (interface-of-simulation (robot-simulation robot)))
         (driver (and interface (find-driver robot interface))))
    (and driver (driver-fluent variable driver))))

(defun plan-fluent (variable)
  "Return the fluent, or the vector of fluents, that VARIABLE stands for in the calling code. Return
NIL if there is no robot to drive."
  (let ((driver (driver-here)))
    (and driver (driver-fluent variable driver))))

(defun (setf plan-fluent) (value variable)
  (declare (ignore value))
  (reject-use "~A stands for a fluent of the robot and cannot be set. To change the value of the ~
               fluent, write (set-value ~(~:*~A~) value)."
              variable))

;;; Making drivers.

(defun remove-driver (driver)
  "Remove DRIVER, which has no plans any more, from its interface."
  (let ((interface (driver-interface driver)))
    (setf (driver-closed-p driver) t)
    (swap-if-eq (interface-default interface) driver nil)
    (removef (interface-drivers interface) driver)
    (remove-agent (driver-agent driver))))

(defun tasks-of-driver (driver)
  "Return the top-level tasks of plans that were begun for the robot of DRIVER."
  (remove driver (tasks-of-interface (driver-interface driver)) :key #'driver-of-plan
                                                               :test-not #'eq))

(defun end-plans-of-driver (driver)
  "End the plans of the closing DRIVER, which this thread holds, and remove DRIVER."
  (in-any-case
    (end-tasks-at-once (interface-runner (driver-interface driver)) (tasks-of-driver driver))
    (interrupt-actions-of-others driver)
    (remove-driver driver)))

(defun close-driver (driver)
  "End the plans of DRIVER now. If plans react in another thread, or a plan has called this
function, the plans end as soon as they can."
  (let ((interface (driver-interface driver)))
    (unless (driver-closing-p driver)
      (deferring-interrupts
        (setf (driver-closing-p driver) t)
        (atomic-remove (driver-ender driver) (robot-enders (driver-robot driver)))
        (cond ((or (interface-closing-p interface) (interface-closed-p interface)))
              ((holding-plans-p interface)
               (mapc (lambda (task) (stop-plan (interface-runner interface) task))
                     (tasks-of-driver driver)))
              ((plans-thread interface) (wake-plans interface))
              (t (end-plans-in-this-thread interface #'driver-closed-p driver)))))))

(defun finish-closing-drivers (interface)
  "The plans of INTERFACE have reacted. End those of drivers that were closed meanwhile. Return true
if there are any: that may let plans of other robots go on."
  (mapc #'end-plans-of-driver (remove-if-not #'driver-closing-p (interface-drivers interface))))

(defun set-ender (driver)
  "Let the robot of DRIVER close DRIVER when its run ends. This thread owns the run."
  (setf (driver-ender driver) (lambda () (close-driver driver)))
  (if (robot-retired (driver-robot driver))
      (close-driver driver)
      (atomic-push (driver-ender driver) (robot-enders (driver-robot driver)))))

;;; A saved run has no plans, and no dice of plans. So a robot's plans get new dice whenever one of
;;; them begins while the robot has no other. The dice depend on how often that has happened. The
;;; holder of the plans counts; the owner of the run sets the count to 0 in SET-SEED.

(defun seed-of-plans (driver)
  "Return the seed of the run of DRIVER, changed if the plans of its robot have had dice before."
  (let ((seed (simulation-seed (driver-simulation driver)))
        (times (mind-plan-times (robot-mind (driver-robot driver)))))
    (if (< times 2) seed (mixed-word (ldb (byte 64 0) seed) times))))

(defun name-of-plans-dice (driver)
  "Return a name for the dice of the plans of DRIVER. It has the robot's name if there are several
robots."
  (if (rest (simulation-robots (driver-simulation driver)))
      (format nil "plans of ~A" (robot-full-name (driver-robot driver)))
      :plans))

(defun note-plans-dice-used (driver)
  (let ((mind (robot-mind (driver-robot driver))))
    (loop for times = (mind-plan-times mind)
          until (swap-if-eq (mind-plan-times mind) times (1+ times)))))

(defun renew-plans-dice (driver)
  "A plan of DRIVER begins. If there is no other, give the plans of DRIVER new dice."
  (unless (tasks-of-driver driver)
    (note-plans-dice-used driver)
    (reseed-agent (driver-agent driver) (seed-of-plans driver) (name-of-plans-dice driver))
    (give-random-state driver)))

;; The owner of the run must never wait for plans, which may be asking it: so these are two steps.
(defun add-driver (robot interface replace-p)
  "Return the driver of ROBOT in INTERFACE, which is new, with new fluents, if there was none or if
REPLACE-P is true. Return as second value an older driver that is to be closed, or NIL."
  (let ((driver (make-driver interface robot)) (before nil)
        (simulation (interface-simulation interface)))
    (with-plans (interface)
      (setf before (find-driver robot interface))
      ;; Another thread may have been first.
      (when (and before (not replace-p)) (return-from add-driver before))
      (setf (driver-agent driver)
            (add-agent (interface-runner interface)
                       (make-agent :client driver
                                   :dice (make-dice (seed-of-plans driver)
                                                    (name-of-plans-dice driver))))
            (driver-fluents driver) (make-fluents robot))
      (push driver (interface-drivers interface))
      ;; Plans may be reacting.
      (prepare-agent driver))
    (asking (simulation) (set-ender driver))
    (values driver before)))
