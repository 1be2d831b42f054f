;;;; driving.lisp -- going forward, to walls and along them, and stopping (manual 3.5).

(in-package :ars-magna.command)

;;; Each movement begins after ROBOT-MOVE-DELAY*, takes at least a tick, and ends in the tick of its
;;; last step. It ends at once, without braking, when it is interrupted by anything but
;;; ROBOT-STOP, which finds the robot in motion and lets it coast.

(defun drive (operation robot step)
  "Let ROBOT drive, beginning in this tick: call STEP with what blocks it, or NIL, after each. The
operation goes on until STEP ends it. Fails with :NOT-MOVING when the speed is 0."
  (declare (type function step))
  (begin-movement robot)
  (flet ((step-once (operation)
           (declare #.*hot* (type operation operation))
           (if (zerop (the double-float (robot-speed-now robot)))
               (fail-with operation :not-moving)
               (progn
                 (funcall step (drive-tick robot))
                 (unless (operation-finished-p operation) (once-more operation))))))
    (setf (operation-step operation) #'step-once)
    (step-once operation)))

(define-command robot-go-forward (operation (robot robot)
                                  (time ticks "for how many ticks"))
    ()
    ((:family :moving) (:section "3.5") (:delay robot-move-delay*)
     (:errors (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot stopped"))
    "Drive ROBOT straight ahead for TIME ticks. With TIME 0 or less it succeeds at once."
  (let ((left (ceiling time)))
    (declare (type fixnum left))
    (if (plusp left)
        (drive operation robot
               (lambda (block)
                 (cond (block (fail-with operation :robot-blocked))
                       ((zerop (decf left)) (succeed operation)))))
        (succeed operation))))

(define-command robot-goto-wall (operation (robot robot))
    ()
    ((:family :moving) (:section "3.5") (:delay robot-move-delay*)
     (:errors (:robot-blocked "Robot is blocked by something that is no wall")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot is at a wall"))
    "Drive ROBOT straight ahead until it meets a wall or the edge of the map."
  (drive operation robot
         (lambda (block)
           (ecase block
             ((nil))
             (:wall (succeed operation))
             (:thing (fail-with operation :robot-blocked))))))

(define-command robot-stop (operation (robot robot))
    ()
    ((:family :moving) (:section "3.5") (:delay 1)
     (:report () "Robot stopped"))
    "Stop ROBOT: if it is driving, let it coast for BRAKING* ticks first."
  (let ((left braking*)
        (driving (>= (robot-drove-tick robot)
                     (1- (simulation-tick (operation-simulation operation))))))
    (if (and driving (plusp left))
        (drive operation robot
               (lambda (block)
                 (when (or block (zerop (decf left))) (succeed operation))))
        (succeed operation))))
