;;;; on-robot.lisp -- a part of a plan that drives another robot.

(in-package :ars-magna.rpl-robot)

(export '(bindings-for-robot))

(defun driver-in-plan (robot task)
  "Return the driver of ROBOT, a robot, its name or a fluent with such a value, for TASK."
  (let ((client (runner-client (task-runner task))))
    (unless (interface-p client)
      (reject-use "on-robot: RUN-PLAN-ALONE runs plans without a robot. RUN-PLAN runs them on a ~
                   robot of a run."))
    (ensure-driver (robot-meant-in-plan robot))))

(defun bindings-for-robot (robot task &optional cells)
  "Return the data of a frame of TASK in which plans drive ROBOT, and with CELLS, which bind other
task variables."
  (make-task-bindings (acons 'driver (driver-in-plan robot task) cells)))

(define-construct on-robot ((robot) &body body)
  "Run BODY in a plan, and return its value. In BODY, the functions with RPL- in their names and the
robot's fluents, such as ROBOT-STOPPED*, mean ROBOT: a robot of the run, its name, or a fluent with
such a value. This holds for the plans that BODY calls and the tasks that it starts, until BODY ends
in any way. It is still the plan of its first robot: its thinking is charged to that robot, and
END-PLAN with that :ROBOT ends it. A fluent or network that BODY returns remains that of ROBOT. If
RPL-INIT-ROBOT is called for ROBOT meanwhile, the commands of BODY are interrupted, and BODY goes on
with the new fluents. If ROBOT leaves the run, the next command of BODY fails with class
:ROBOT-GONE. Signals UNKNOWN-NAME."
  (:arguments robot)
  (:parts (robot function (value-lambda robot scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (let ((bindings (bindings-for-robot (funcall robot environment) task)))
      (next inside)
      (setf memory bindings)
      (enter body environment frame)))
   (inside (values (frame-up frame) value))))
