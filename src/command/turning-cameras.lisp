;;;; turning-cameras.lisp -- pointing cameras somewhere (manual 3.4.3).

(in-package :ars-magna.command)

;;; A camera turns exactly as told, and at once after its delay; what it reports is an estimate. Its
;;; angle is relative to the robot and never normalised. Turning a camera interrupts its track.

(defun turn-camera (operation camera angle)
  "Turn CAMERA by ANGLE, in radians, for OPERATION; return an estimate of that (reading 144)."
  (let ((world (robot-world (camera-robot camera))))
    (interrupt-track operation camera)
    (incf (camera-angle camera) (double angle))
    (+ (double angle) (angle-error (world-dice world :looking)))))

(defun turn-camera-to (operation camera direction)
  "Turn CAMERA to DIRECTION, relative to the robot, the short way round, for OPERATION; return an
estimate of the angle."
  (turn-camera operation camera (angle-difference direction (camera-angle camera))))

(defun camera-turned-text (operation angle)
  (phrase "~A turned ~,2F" (operation-resource operation) angle))

(define-command camera-turn (operation (camera camera)
                             (angle angle "how far in radians, to the right if positive"))
    ((angle "an estimate of the angle turned"))
    ((:family :looking) (:section "3.4.3") (:delay camera-align-delay*)
     (:report (angle) (camera-turned-text operation angle)))
    "Turn CAMERA by ANGLE, relative to where it points."
  (succeed operation (turn-camera operation camera angle)))

(define-command camera-align-robot (operation (camera camera))
    ((angle "an estimate of the angle turned"))
    ((:family :looking) (:section "3.4.3") (:delay camera-align-delay*)
     (:report (angle) (camera-turned-text operation angle)))
    "Point CAMERA where the robot is heading."
  (succeed operation (turn-camera-to operation camera 0)))

(define-command camera-align-place (operation (camera camera))
    ((angle "an estimate of the angle turned")
     (place-type "the name of the place type that was sensed"))
    ((:family :looking) (:section "3.4.3") (:delay camera-align-delay*)
     (:errors (:no-place-type "No place type here to align with"))
     (:report (angle place-type)
              (format nil "~A, at a ~A" (camera-turned-text operation angle) place-type)))
    "Point CAMERA in the nearest canonical direction of the place that the robot senses."
  (let* ((robot (camera-robot camera)) (type (sense-place-type robot)))
    (if type
        (let ((direction (nearest-direction (canonical-directions robot type)
                                            (camera-heading camera))))
          (succeed operation
                   (turn-camera-to operation camera (- direction (robot-angle robot)))
                   (place-type-name type)))
        (fail-with operation :no-place-type))))
