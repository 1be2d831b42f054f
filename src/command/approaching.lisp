;;;; approaching.lisp -- going to what a camera tracks (manual 3.5).

(in-package :ars-magna.command)

;;; The robot turns in place until it faces what the camera tracks, and then drives. In each tick it
;;; corrects its heading if the goal has moved sideways. It uses the track, as the camera does, not
;;; the estimated angle that programs read. ARRIVED-AT-POINT-P says when it has arrived. Losing the
;;; track ends the approach; arriving ends the track. A false designator cannot be reached: the
;;; track is lost there. Each step either brings the robot nearer to its goal, or ends the approach.

(define-constant +aim+ 1d-6
  :documentation "A robot that faces its goal to within this angle, in radians, starts to drive.")
(defconstant +aiming-turns+ 3
  "The number of turns towards its goal after which a robot drives, whatever its heading.")

(defun angle-to-goal (robot designator)
  "Return the angle by which ROBOT has to turn to face the point where DESIGNATOR was last seen."
  (let ((x (designator-x designator)) (y (designator-y designator)))
    (if (zerop (distance-to robot x y))
        0d0
        (angle-difference (bearing-to robot x y) (robot-angle robot)))))

(defun ready-to-drive-p (operation robot designator)
  "Count a turn of ROBOT towards DESIGNATOR. True if ROBOT faces DESIGNATOR exactly enough to drive,
or has turned often enough."
  (when (or (>= (incf (operation-count operation)) +aiming-turns+)
            (<= (abs (angle-to-goal robot designator)) +aim+))
    (setf (operation-count operation) +aiming-turns+)))

(defun drive-to-goal (robot designator)
  "Drive ROBOT for a tick, at most to where DESIGNATOR was last seen. Return whether the robot has
arrived, and the obstacle that blocked it: :WALL, :THING or NIL."
  (let* ((distance (distance-to robot (designator-x designator) (designator-y designator)))
         (block (drive-tick robot distance)))
    (values (at-designator-p robot designator (<= distance (longest-step robot)) block)
            block)))

(defun at-designator-p (robot designator &optional last-step block)
  "True if ROBOT has arrived at the position of DESIGNATOR; see ARRIVED-AT-POINT-P."
  (multiple-value-bind (x y) (designator-position designator)
    (arrived-at-point-p robot x y last-step block)))

(defun arrive (operation camera designator)
  "The robot is at DESIGNATOR: end OPERATION and the track of CAMERA (readings 108, 110)."
  (cond ((designator-denotation designator)
         (succeed operation camera designator)
         (end-track-on-arrival camera))
        (t (end-track-on-arrival camera)
           (fail-with operation :not-tracking camera designator))))

(defun approach-step (operation robot camera designator)
  "Move ROBOT towards DESIGNATOR for a tick, or end OPERATION after the approach (reading 111)."
  (cond ((not (tracking-p camera designator))
         (fail-with operation :not-tracking camera designator))
        ((at-designator-p robot designator) (arrive operation camera designator))
        ((speed-zero-p robot) (fail-with operation :not-moving camera designator))
        ((and (turn-towards robot (angle-to-goal robot designator) +facing+)
              (ready-to-drive-p operation robot designator))
         (multiple-value-bind (arrived block) (drive-to-goal robot designator)
           (cond (arrived (arrive operation camera designator))
                 (block (fail-with operation :robot-blocked camera designator)))))))

(define-step approach-on (operation (and (robot-p (operation-resource operation))
                                         (designator-p (operation-subject operation))
                                         (camera-p (first (operation-arguments operation)))))
  "Approach the designator that is the subject of OPERATION for a tick."
  (approach-step operation (operation-resource operation)
                 (first (operation-arguments operation)) (operation-subject operation))
  (unless (operation-finished-p operation) (repeat-step operation)))

;; See reading 112.
(defmethod approaching-p ((operation operation) camera)
  (and (eq 'robot-goto-designator (command-name (operation-command operation)))
       (eq camera (first (operation-arguments operation)))))

;; See reading 109.
(define-command robot-goto-designator (operation (robot robot)
                                       (camera camera "the camera that tracks the designator"))
    ((camera "the camera")
     (designator "the designator that it tracked"))
    ((:family :moving) (:section "3.5") (:delay robot-move-delay*) (:echo camera designator)
     (:errors (:not-tracking (operation-formatter "~*~A is not tracking anything"))
              (:goto-local "The designator is local: the robot is there already")
              (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report (camera designator) (format nil "Robot is at ~A" designator)))
    "Drive ROBOT next to what CAMERA tracks. On arrival the track ends. The designator becomes
invalid unless another camera tracks it."
  (let ((designator (and (eq (camera-robot camera) robot) (camera-tracks camera))))
    (cond ((null designator) (fail-with operation :not-tracking camera))
          ((eq (designator-type designator) :local)
           (fail-with operation :goto-local camera designator))
          (t (record-movement-start robot)
             (setf (operation-subject operation) designator)
             (go-on-now operation 'approach-on)))))
