;;;; sightings.lisp -- what a search finds, real or not, and the designators made of it.

(in-package :ars-magna.robot)

(export '(sighting sighting-p designate distance-to bearing-to))

;;; A sighting is what a camera takes for a thing or place. Those found together become designators
;;; one after another, so each must still be where it was seen when its turn comes.

(define-kind (sighting :constructor (make-sighting (type denotation x y data)))
    "A thing or place that a camera has seen at (X,Y). A sighting without a DENOTATION is false."
  (:state
   (type :non-local (member :local :non-local) ":LOCAL if the sighting is next to the robot, else
:NON-LOCAL")
   (denotation nil (or null thing place) "what was really seen, or NIL")
   (x 0d0 double-float "the x coordinate where the sighting seems to be, in metres")
   (y 0d0 double-float "the y coordinate where the sighting seems to be, in metres")
   (data '() list "what it looks like")))

(defmethod reference ((sighting sighting))
  (list :sighting (sighting-type sighting) (sighting-x sighting) (sighting-y sighting)
        (sighting-data sighting)
        (and (sighting-denotation sighting) (reference (sighting-denotation sighting)))))

;;; Things have a direction from the robot unless they are exactly where it is.

(defconstant +least-bearing-distance+ 1d-9
  "Things no farther than this from the robot, in metres, have no direction.")

(defun distance-to (robot x y)
  "Return the distance from ROBOT to (X,Y), in metres."
  (let* ((dx (- (double x) (robot-x robot))) (dy (- (double y) (robot-y robot)))
         (square (+ (* dx dx) (* dy dy))))
    (declare (type double-float dx dy) (type (double-float 0d0) square))
    (sqrt square)))

(defun bearing-to (robot x y)
  "Return the true direction from ROBOT to (X,Y), in radians."
  (arctangent (- y (robot-y robot)) (- x (robot-x robot))))

;;; False sightings (manual 3.4.1, chapter 4).

(defun clip-to-map (map x y)
  (values (clamp x 0d0 (- (map-width map) 1d-6))
          (clamp y 0d0 (- (map-height map) 1d-6))))

(defun random-false-position (robot angle dice)
  "Return the end of a random walk from ROBOT in the direction ANGLE. After each metre outside the
robot's cell the walk ends with probability PROB-STOP*, and always at the map's edge (reading 136)."
  (let ((map (world-map (robot-world robot)))
        (dx (cosine angle)) (dy (sine angle)))
    (loop for metres from 1d0 by 1d0
          for x = (+ (robot-x robot) (* metres dx))
          for y = (+ (robot-y robot) (* metres dy))
          while (map-index map x y)
          when (and (not (in-same-cell-p robot x y)) (chance prob-stop* dice))
            return (values x y)
          finally (return (edge-point robot map (1- metres) dx dy)))))

(defun edge-point (robot map metres dx dy)
  "Return where the ray from ROBOT in direction DX, DY leaves MAP, METRES to METRES + 1 away."
  (flet ((exit (position direction size)
           (cond ((plusp direction) (/ (- size position) direction))
                 ((minusp direction) (/ (- position) direction))
                 (t +infinite-distance+))))
    (let ((exit (max metres (min (exit (robot-x robot) dx (map-width map))
                                 (exit (robot-y robot) dy (map-height map))))))
      (clip-to-map map
                   (+ (robot-x robot) (* exit dx))
                   (+ (robot-y robot) (* exit dy))))))

(defun false-sighting (camera type data dice)
  "Return a false sighting of TYPE with DATA (reading 137)."
  (let ((robot (camera-robot camera)))
    (multiple-value-bind (x y)
        (if (eq type :local)
            (robot-position robot)
            (random-false-position robot
                                   (+ (camera-heading camera)
                                      (roll-within (* 0.5d0 (camera-field-of-view camera)) dice))
                                   dice))
      (make-sighting type nil x y data))))

(defun false-description (world demands dice)
  "Return a random description that meets DEMANDS. Other attributes may be added, each with the
value of a random thing in WORLD."
  (let ((readings (loop for demand in demands
                        for (low high) = (list (demand-low demand) (demand-high demand))
                        collect (list (demand-key demand)
                                      (if low
                                          (roll-between low high dice)
                                          (roll-element (demand-choices demand) dice))))))
    (append (notice-attributes (world-map world) (mapcar #'first readings)
                               (lambda (attribute)
                                 ;; NIL if there are none, or none has this rank.
                                 (let ((thing (random-thing world dice)))
                                   (values (and thing
                                                (thing-attribute-value
                                                 thing (attribute-name attribute)))
                                           thing)))
                               0d0 dice)
            readings)))

;;; Designators.

(defun sighting-unchanged-p (sighting camera)
  "True if neither CAMERA nor the thing that SIGHTING denotes has moved since the sighting."
  (let ((thing (sighting-denotation sighting))
        (robot (camera-robot camera)) (x (sighting-x sighting)) (y (sighting-y sighting)))
    (and (or (not (thing-p thing))
             (and (thing-alive-p thing)
                  (eq (thing-enclosure thing) (camera-location camera))
                  (multiple-value-bind (now-x now-y) (thing-position thing)
                    (and (= x now-x) (= y now-y)))))
         (or (eq (sighting-type sighting) :non-local)
             (within-reach-p robot x y)))))

(defun set-bearing (designator bearing dice)
  "Record that the denotation of DESIGNATOR was seen in the true direction BEARING. Set the angle of
DESIGNATOR to an estimate of this direction, without jumps of a full turn."
  (let* ((heading (robot-angle (designator-robot designator)))
         (angle (designator-angle designator))
         (change (angle-difference bearing (+ heading angle))))
    (setf (designator-bearing designator) bearing
          (designator-bearing-p designator) t
          (designator-relative-bearing designator) (- bearing heading)
          (designator-angle designator) (+ angle change (angle-error dice)))))

(defun designate (sighting camera)
  "Return a new designator for SIGHTING, seen by CAMERA, or NIL if its thing is no longer there."
  (when (sighting-unchanged-p sighting camera)
    (let* ((robot (camera-robot camera))
           (dice (robot-dice robot :looking))
           (x (sighting-x sighting)) (y (sighting-y sighting))
           (distance (if (camera-location camera) 0d0 (distance-to robot x y)))
           (designator (add-designator robot :type (sighting-type sighting)
                                             :distance distance :x x :y y
                                             :data (sighting-data sighting)
                                             :denotation (sighting-denotation sighting)
                                             :location (camera-location camera))))
      (setf (designator-angle designator) (camera-angle camera))
      (if (> distance +least-bearing-distance+)
          (set-bearing designator (bearing-to robot x y) dice)
          (incf (designator-angle designator) (angle-error dice)))
      designator)))
