;;;; choosing.lisp -- which robot a plan drives that begins.

(in-package :ars-magna.rpl-robot)

(export '(driver-for-plan split-arguments note-robot-commanded))

;;; A plan drives the robot that is given by :ROBOT after its arguments, unless the plan takes that
;;; keyword itself; else the robot of the calling plan; else the robot that plans drive by default.

(defun plan-procedure (plan &optional (errorp t))
  "Return the procedure of PLAN, a plan procedure or its name; NIL if there is none and ERRORP is
NIL. Signals UNKNOWN-NAME."
  (if (procedure-p plan) plan (find-procedure plan errorp)))

(defun plan-takes-robot-p (procedure)
  "True if the plan PROCEDURE has a keyword parameter :ROBOT of its own."
  (let ((keys (shape-keys (lambda-list-shape (procedure-lambda-list procedure)))))
    (and (listp keys) (member :robot keys))))

(defun advice-on-several-robots (robot plan)
  "Return a text: how to choose one of several robots, such as ROBOT, for PLAN, a plan or NIL."
  (let* ((procedure (plan-procedure plan nil)) (name (and procedure (procedure-name procedure))))
    (if (and procedure (plan-takes-robot-p procedure))
        (format nil "The plan~@[ ~(~A~)~] takes :robot itself, so :robot does not choose the robot ~
                     to drive. Write (rpl-init-robot ~(~A~)) before the plan, or call the plan in ~
                     another plan: (run-plan (interp-lambda () (~:[call-plan PLAN~;~:*~(~A~)~] ~
                     ...)) :robot '~(~A~))."
                name robot name robot)
        (format nil "Choose the robot to drive: (rpl-init-robot ~(~A~)) before the plan, or :robot ~
                     ROBOT after the arguments of the plan."
                robot))))

(defun robot-to-drive (plan)
  "Return the robot of the current simulation that plans drive by default: the only robot, or the
robot that the prompt commands. Signals MISUSE if the run is over, or if several robots are possible
for PLAN, a plan or NIL."
  (check-not-over (current-simulation))
  (let ((robots (simulation-robots (current-simulation))))
    (or (default-robot (current-simulation))
        (reject-use "There are ~D robots here. ~A" (length robots)
                    (advice-on-several-robots (if robots (robot-name (first robots)) 'robot)
                                              plan)))))

(defun note-robot-commanded ()
  "Record that the prompt of this thread commands another robot from now on. Plans that begin later
drive that robot, even after an RPL-INIT-ROBOT."
  (let ((interface (usable-interface)))
    (when interface (setf (interface-default interface) nil))))

(defun driver-for-plan (robot &optional plan)
  "Return the driver for PLAN, which begins: of ROBOT or, if ROBOT is NIL, of the robot that the
calling plan drives, or of the robot that plans drive by default."
  (cond (robot (ensure-driver (robot-meant-in-plan robot)))
        ((driver-here) (required-driver))
        (t (ensure-driver (robot-to-drive plan)))))

(defun split-arguments (plan arguments)
  "Return two values: ARGUMENTS, given for PLAN, without a final :ROBOT and its value; the value."
  (let ((end (last arguments 2)))
    (if (and (rest end) (eq :robot (first end)) (not (plan-takes-robot-p (plan-procedure plan))))
        (values (ldiff arguments end) (second end))
        (values arguments nil))))
