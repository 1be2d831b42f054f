;;;; frames.lisp -- where a map lies in metres of elsewhere.

(in-package :ars-magna.floors)

;;; A map's y grows downwards and its angles clockwise; elsewhere, as in ROS, y grows upwards and
;;; angles against the clock. The map's lower left corner is the frame's origin, see MAP-FRAME.

(defun map-from (operator map)
  (unless (typep map '(or map symbol string))
    (reject-argument operator 'map map "a map or the name of one"))
  (find-map map))

(defun check-place (operator x y angle)
  (loop for (name value) in `((x ,x) (y ,y) (angle ,angle))
        unless (within-reason-p value)
          do (reject-argument operator name value "a number from -1e9 to 1e9")))

(addition map-to-frame)
(defun map-to-frame (map x y &optional (direction 0))
  "Return what the point (X, Y) of MAP, a map or its name, is in that map's frame (see MAP-FRAME),
in metres, and how DIRECTION, radians clockwise, is called there, radians against the clock: three
double-floats. Signals WRONG-ARGUMENT and UNKNOWN-NAME."
  (check-place 'map-to-frame x y direction)
  (let ((map (map-from 'map-to-frame map)))
    (destructuring-bind (size left low yaw) (mapcar #'double (map-frame map))
      (let ((right (* size x)) (up (* size (- (map-height map) y))))
        (values (+ left (- (* right (cosine yaw)) (* up (sine yaw))))
                (+ low (* right (sine yaw)) (* up (cosine yaw)))
                (- yaw direction))))))

(addition frame-to-map)
(defun frame-to-map (map x y &optional (yaw 0))
  "Return the point of MAP, a map or its name, that is (X, Y) in that map's frame (see MAP-FRAME),
in metres, and the direction in MAP, radians clockwise, that is called YAW there, radians against
the clock: three double-floats. The point may be outside the map. Signals WRONG-ARGUMENT and
UNKNOWN-NAME."
  (check-place 'frame-to-map x y yaw)
  (let ((map (map-from 'frame-to-map map)))
    (destructuring-bind (size left low turn) (mapcar #'double (map-frame map))
      (let ((right (- x left)) (up (- y low)))
        (values (/ (+ (* right (cosine turn)) (* up (sine turn))) size)
                (- (map-height map)
                   (/ (- (* up (cosine turn)) (* right (sine turn))) size))
                (- turn yaw))))))
