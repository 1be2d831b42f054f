;;;; places.lisp -- sensing places, and turning by them (manual 2.2, 3.5).

(in-package :ars-magna.command)

;;; All of these act on the place type that the robot senses, which may not be the one that is
;;; there. Its directions are then those that the sensed type gives the cell.

(defun place-name (type robot)
  "Return the name of the place type TYPE, as the author of the map that ROBOT is in writes it."
  (own-symbol (place-type-name type) (map-package (world-map (robot-world robot)))))

;; As reading 106 says.
(define-command robot-place (operation (robot robot))
    ((place-type "the name of the place type sensed, or NIL"))
    ((:family :moving) (:section "2.2, C") (:traits :asks)
     (:report (type) (format nil "Place is ~A" type)))
    "Sense the type of the place where ROBOT is."
  (let ((type (sense-place-type robot)))
    (setf (robot-last-place robot) (and type (place-name type robot)))
    (succeed operation (robot-last-place robot))))

(defun turn-to-face (operation robot direction)
  "Turn ROBOT to DIRECTION, the short way round, and end OPERATION."
  (turn-by operation robot (angle-difference direction (robot-angle robot))))

(defun judged-right-p (robot type)
  "True if ROBOT takes TYPE, which it has sensed, for right: if it is, or by mistake (reading 103)."
  (let ((place (robot-place-here robot)))
    (or (and place (eq type (place-type place)))
        (chance robot-align-error-prob* (world-dice (robot-world robot) :place)))))

;; As reading 104 says.
(define-command robot-align-place (operation (robot robot))
    ((angle "a reading of the angle turned"))
    ((:family :moving) (:section "3.5") (:delay (+ robot-turn-delay* robot-align-delay*))
     (:errors (:incorrect-place-type "Place type is not what it seemed to be")
              (:no-place-type "No place type here to align with"))
     (:report (angle) (turned-text angle)))
    "Turn ROBOT to the nearest canonical direction of the place where it is."
  (let ((type (sense-place-type robot)))
    (cond ((null type) (fail-with operation :no-place-type))
          ((judged-right-p robot type)
           (turn-to-face operation robot
                         (nearest-direction (canonical-directions robot type)
                                            (robot-angle robot))))
          (t (fail-with operation :incorrect-place-type)))))

(defun corner-direction (robot type directions)
  "Return the heading in which ROBOT, coming along one wall of a corner, follows the other. At
a convex corner it came along one of DIRECTIONS and turns against the other; at a concave one it
came against one of them and turns along the other. If it looks along a wall already, away from the
corner, it turns to the other wall (reading 105)."
  (let* ((opposite (mapcar (lambda (d) (+ d pi)) directions))
         (convex (same-name-p (place-type-name type) 'convex))
         (ways (if convex directions opposite))
         (exits (if convex opposite directions))
         (headings (append ways exits))
         (now (position (nearest-direction headings (robot-angle robot)) headings)))
    (elt exits (- 1 (mod now 2)))))

;; As reading 236 says.
(define-command robot-turn-corner (operation (robot robot))
    ((angle "a reading of the angle turned"))
    ((:family :moving) (:section "3.5") (:delay robot-turn-delay*)
     (:errors (:no-corner "Robot is not at a corner"))
     (:report (angle) (turned-text angle)))
    "Turn ROBOT about the corner, convex or concave, where it is."
  (let ((type (sense-place-type robot)))
    (if (and type (member (place-type-name type) '(convex concave) :test #'same-name-p))
        (turn-to-face operation robot
                      (corner-direction robot type (canonical-directions robot type)))
        (fail-with operation :no-corner))))
