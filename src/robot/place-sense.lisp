;;;; place-sense.lisp -- the robot feels what place it is in (manual 2.2, 3.4.3, 3.5).

(in-package :ars-magna.robot)

(export '(robot-place-here sense-place-type canonical-directions nearest-direction))

(defun robot-cell (robot)
  (map-cell (world-map (robot-world robot)) (robot-x robot) (robot-y robot)))

(defun robot-place-here (robot)
  "Return the PLACE that ROBOT is really in, or NIL."
  (cell-type (robot-cell robot)))

(defun random-place-type (robot dice)
  (let ((types (remove nil (map-place-types (world-map (robot-world robot))))))
    (and (plusp (length types)) (roll-element types dice))))

(defun sense-place-type (robot)
  "Return the place type that ROBOT senses where it is, or NIL. Where there is one it is missed
with TYPE-FALSE-NEG*, where there is none a random one is sensed with
TYPE-FALSE-POS* (reading 221)."
  (let ((place (robot-place-here robot))
        (dice (world-dice (robot-world robot) :place)))
    (cond (no-sensor-error* (and place (place-type place)))
          (place (unless (chance type-false-neg* dice) (place-type place)))
          ((chance type-false-pos* dice) (random-place-type robot dice)))))

(defun canonical-directions (robot type)
  "Return a list of the two canonical directions, in radians, that TYPE gives the cell in which
ROBOT is. In a cell that is no place there are none, and the heading stands for both (reading 223)."
  (let ((place (robot-place-here robot)))
    (if place
        (multiple-value-list
         (place-directions (make-place type (place-canonical-dir place) (place-cell place))))
        (list (robot-angle robot) (robot-angle robot)))))

(defun nearest-direction (directions heading)
  "Return the one of DIRECTIONS, a list of angles, that differs least from HEADING (reading 73)."
  (let ((best (first directions)))
    (dolist (direction (rest directions) best)
      (when (< (abs (angle-difference direction heading)) (abs (angle-difference best heading)))
        (setf best direction)))))
