;;;; turning.lisp -- setting speeds and turning in place, also by places (2.2, 3.5).

(in-package :ars-magna.command)

;;; The robot reports what its odometry read of a turn, not the truth. Turning takes as many ticks
;;; as the turn angle goes into the angle.

(defun limit-value (value low high)
  "Return VALUE limited to the range from LOW to HIGH, and :LOW or :HIGH if VALUE was outside the
range, else NIL (reading 91)."
  (cond ((< value low) (values (double low) :low))
        ((> value high) (values (double high) :high))
        (t (values (double value) nil))))

(defun limit-error-formatter (control parameter)
  "Return a function that formats the text CONTROL with an operation's value of PARAMETER."
  (lambda (operation)
    (declare (ignore operation))
    (format nil control (symbol-value parameter))))

;; See reading 94.
(define-command robot-set-speed (operation (robot robot)
                                 (speed speed "the new speed, from 0 to max-speed*"))
    ((speed "the speed set"))
    ((:family :moving) (:section "3.5")
     (:errors (:negative-speed "Speed cannot be negative. Set to 0")
              (:too-high-speed
               (limit-error-formatter "Speed too high. Set to the maximum, ~,2F" 'max-speed*)))
     (:report (speed) (phrase "Speed set to ~,2F" speed)))
    "Set the speed at which ROBOT drives, limited to the range from 0 to MAX-SPEED*."
  (multiple-value-bind (speed outside) (limit-value speed 0 max-speed*)
    (setf (robot-speed robot) speed)
    (end-operation operation
                   (ecase outside ((nil) nil) (:low :negative-speed) (:high :too-high-speed))
                   speed)))

(define-command robot-set-turn-angle (operation (robot robot)
                                      (angle angle
                                       "the new turn angle, min-turn-angle* to max-turn-angle*"))
    ((turn-angle "the turn angle set"))
    ((:family :moving) (:section "3.5")
     (:errors (:too-low-turn-angle
               (limit-error-formatter "Turn angle too low. Set to the minimum, ~,2F"
                                      'min-turn-angle*))
              (:too-high-turn-angle
               (limit-error-formatter "Turn angle too high. Set to the maximum, ~,2F"
                                      'max-turn-angle*)))
     (:report (angle) (format nil "Turn angle set to ~,2F" angle)))
    "Set how far ROBOT turns in a tick, at least MIN-TURN-ANGLE* and at most MAX-TURN-ANGLE*."
  (multiple-value-bind (angle outside) (limit-value angle min-turn-angle* max-turn-angle*)
    (setf (robot-turn-angle robot) angle)
    (end-operation operation
                   (ecase outside
                     ((nil) nil) (:low :too-low-turn-angle) (:high :too-high-turn-angle))
                   angle)))

;;; Turning.

(define-constant +facing+ 1d-12
  :documentation "Remaining angles below this, in radians, are rounding errors and count as 0.")

(defun turn-step (robot left)
  "Turn ROBOT for a tick, at most by LEFT. Return the rest and the odometry's step (reading 99)."
  (let* ((most (* (robot-turn-angle-now robot) (double tick-quantum*)))
         (step (clamp left (- most) most)))
    (turn-tick robot step)
    (values (- left step)
            (* 0.5d0 (+ (robot-turned-low robot) (robot-turned-high robot))))))

(defun turn-towards (robot angle close)
  "Unless ANGLE < CLOSE, turn ROBOT by ANGLE, at most for a tick. True if no angle is left."
  (or (< (abs angle) close)
      (< (abs (turn-step robot angle)) +facing+)))

(define-step turn-on (operation (robot-p (operation-resource operation)))
  "Turn the robot of OPERATION for a tick, and end OPERATION when nothing is left to turn."
  (multiple-value-bind (left read)
      (turn-step (operation-resource operation) (operation-left operation))
    (setf (operation-left operation) left)
    (incf (operation-reading operation) read)
    (if (< (abs left) +facing+)
        (succeed operation (operation-reading operation))
        (repeat-step operation))))

(defun turn-by (operation robot angle)
  "Turn ROBOT by about ANGLE, beginning in this tick; end OPERATION with the odometry's reading."
  (record-movement-start robot)
  (setf (operation-left operation) (double angle))
  (if (zerop angle)
      (succeed operation 0d0)
      (go-on-now operation 'turn-on)))

(defun turn-message (angle)
  (phrase "Robot turned ~,2F" angle))

(define-command robot-turn (operation (robot robot)
                            (angle angle "how far in radians, to the right if positive"))
    ((angle "a reading of the angle turned"))
    ((:family :moving) (:section "3.5") (:delay robot-turn-delay*) (:traits :turns)
     (:report (angle) (turn-message angle)))
    "Turn ROBOT in place by about ANGLE."
  (turn-by operation robot angle))

(macrolet ((define-turn (name angle words)
             `(define-command ,name (operation (robot robot))
                  ((angle "a reading of the angle turned"))
                  ((:family :moving) (:section "3.5") (:delay robot-turn-delay*) (:traits :turns)
                   (:report (angle) (turn-message angle)))
                  ,(format nil "Turn ROBOT in place by about ~A." words)
                (turn-by operation robot ,angle))))
  (define-turn robot-about-face pi "half a circle")
  ;; See reading 49.
  (define-turn robot-turn-left (/ pi -2) "a quarter circle to the left")
  (define-turn robot-turn-right (/ pi 2) "a quarter circle to the right"))

;;; These commands act on the place type that the robot senses, which may not be the true one. The
;;; directions are those that the sensed type gives the cell.

;; See reading 106.
(define-command robot-place (operation (robot robot))
    ((place-type "the name of the place type sensed, or NIL"))
    ((:family :moving) (:section "2.2, C") (:traits :asks)
     (:report (type) (format nil "Place is ~A" type)))
    "Sense the type of the place where ROBOT is."
  (let ((type (sense-place-type robot)))
    ;; The symbol that the author of the map writes.
    (setf (robot-last-place robot)
          (and type (symbol-of-package (place-type-name type)
                                       (map-package (world-map (robot-world robot))))))
    (succeed operation (robot-last-place robot))))

(defun turn-to-face (operation robot direction)
  (turn-by operation robot (angle-difference direction (robot-angle robot))))

(defun place-type-accepted-p (robot type)
  "True if TYPE, the place type that ROBOT has sensed, is the true type, or if ROBOT by chance does
not notice the mistake (reading 103)."
  (let ((place (robot-place-here robot)))
    (or (and place (eq type (place-type place)))
        (chance robot-align-error-prob* (robot-dice robot :place)))))

;; See reading 104.
(define-command robot-align-place (operation (robot robot))
    ((angle "a reading of the angle turned"))
    ((:family :moving) (:section "3.5") (:delay (+ robot-turn-delay* robot-align-delay*))
     (:errors (:incorrect-place-type "Place type is not what it seemed to be")
              (:no-place-type "No place type here to align with"))
     (:report (angle) (turn-message angle)))
    "Turn ROBOT to the nearest canonical direction of the place where it is."
  (let ((type (sense-place-type robot)))
    (cond ((null type) (fail-with operation :no-place-type))
          ((place-type-accepted-p robot type)
           (turn-to-face operation robot
                         (nearest-direction (canonical-directions robot type)
                                            (robot-angle robot))))
          (t (fail-with operation :incorrect-place-type)))))

(defun corner-direction (robot type directions)
  "Return the heading for ROBOT to turn a corner: ROBOT comes along one wall and leaves along the
other. At a convex corner ROBOT comes in one of DIRECTIONS and leaves opposite to the other
direction; at a concave corner ROBOT comes opposite to one direction and leaves in the other. If
ROBOT already faces away from the corner, it turns to the other wall (reading 105)."
  (let* ((opposite (mapcar (lambda (d) (+ d pi)) directions))
         (convex (same-name-p (place-type-name type) 'convex))
         (ways (if convex directions opposite))
         (exits (if convex opposite directions))
         (headings (append ways exits))
         (now (position (nearest-direction headings (robot-angle robot)) headings)))
    (elt exits (- 1 (mod now 2)))))

;; See reading 236.
(define-command robot-turn-corner (operation (robot robot))
    ((angle "a reading of the angle turned"))
    ((:family :moving) (:section "3.5") (:delay robot-turn-delay*)
     (:errors (:no-corner "Robot is not at a corner"))
     (:report (angle) (turn-message angle)))
    "Turn ROBOT round the convex or concave corner where ROBOT is."
  (let ((type (sense-place-type robot)))
    (if (and type (member (place-type-name type) '(convex concave) :test #'same-name-p))
        (turn-to-face operation robot
                      (corner-direction robot type (canonical-directions robot type)))
        (fail-with operation :no-corner))))
