;;;; senses.lisp -- what cameras can see, and what robots believe, on the map.

(in-package :ars-magna.display)

;;; Fields of view, ended by walls and opaque things, are computed from the snapshot when drawn.

(defconstant +drawn-ray-angle-step+ 0.015d0
  "The angle between rays that find the edge of a field of view, in radians.")

(defun opaque-cell-test (snapshot robot)
  "Return a function of a cell's index that returns true if the cell blocks the view of ROBOT, an
image, in SNAPSHOT."
  (let* ((map (snapshot-map snapshot)) (flags (map-flags map))
         (bodies (remove nil (mapcar #'robot-image-body (remove robot (snapshot-robots snapshot)))))
         (hidden (loop for image in (append bodies (coerce (snapshot-things snapshot) 'list))
                       when (thing-image-obsview-p image)
                         collect (map-index map (thing-image-x image) (thing-image-y image)))))
    (lambda (index)
      (or (logtest +wall+ (aref flags index)) (and hidden (member index hidden) t)))))

(defun camera-outside-container (camera)
  "Return CAMERA, or NIL if it is inside a container and so does not see the map."
  (and (null (camera-image-location camera)) camera))

(defun draw-field-of-view (canvas camera robot snapshot)
  (let* ((map (snapshot-map snapshot)) (x (robot-image-x robot)) (y (robot-image-y robot))
         (width (camera-image-field-of-view camera))
         (first (- (+ (robot-image-angle robot) (camera-image-angle camera)) (/ width 2)))
         (count (max 2 (ceiling width +drawn-ray-angle-step+))))
    (when (map-index map x y)
      (let ((ends (ray-ends map (opaque-cell-test snapshot robot)
                            x y first (/ width count) (1+ count))))
        (with-halo ((layer-ink :wedges))
          (draw-lines canvas draw-gcontext*
                      (points-to-pixels (append (list x y) ends (list x y)))))))))

;;; Rays, coloured by their readings.

(defun reading-color-index (map reading)
  "Return the index in +RAY-INKS+ of the colour for READING. The first colour is for the least
parameter of a substance in MAP, the last colour for the greatest."
  (let* ((least (map-least-parameter map)) (greatest (map-greatest-parameter map))
         (count (length +ray-inks+)))
    (if (< least greatest)
        (clamp (floor (* count (/ (- reading least) (- greatest least)))) 0 (1- count))
        0)))

(defun readings-for-rays (look count)
  (let ((view (coerce (look-view look) 'vector)))
    (loop for ray below count
          collect (if (zerop (length view)) 0 (aref view (floor (* ray (length view)) count))))))

(defun draw-rays (canvas look robot snapshot)
  (declare (ignore robot))
  (let* ((ends (look-ends look)) (map (snapshot-map snapshot))
         (classes (mapcar (lambda (reading) (reading-color-index map reading))
                          (readings-for-rays look (/ (length ends) 2)))))
    (loop for ink in +ray-inks+ for number from 0
          for rays = (loop for (x y) on ends by #'cddr
                           for class in classes
                           when (= class number)
                             append (points-to-pixels (list (look-x look) (look-y look) x y)))
          when rays
            do (with-color ink
                 (with-dashes ((layer-dashes :rays))
                   (draw-segments canvas draw-gcontext* rays))))))

;;; Ranges.

(defun range-scans-of-robot (robot)
  "Return what the rangefinders of ROBOT have measured last, a list of lists of coordinates: the
point where ROBOT was, and the end of each beam."
  (loop for part across (robot-sensors robot)
        when (and (rangefinder-p part) (rangefinder-last-pose part))
          collect (destructuring-bind (x y heading) (rangefinder-last-pose part)
                    (list* x y (loop for angle in (rangefinder-beam-angles part)
                                     for range in (rangefinder-last-ranges part)
                                     append (point-at-distance x y (+ heading angle) range))))))

(defun draw-ranges (canvas scans robot snapshot)
  "Draw a line for each beam of SCANS, with a dot at its end."
  (declare (ignore robot snapshot))
  (loop for (x y . ends) in scans
        do (loop for (end-x end-y) on ends by #'cddr
                 do (with-halo ((layer-ink :ranges) :dashes (layer-dashes :ranges))
                      (draw-segments canvas draw-gcontext*
                                     (points-to-pixels (list x y end-x end-y))))
                    (with-halo ((layer-ink :ranges))
                      (draw-circle canvas (to-pixels end-x) (to-pixels end-y) 2 t)))))

;;; Beliefs.

(defun believed-place (robot designator)
  "Return the point (x y) on the map, in metres, where ROBOT believes the object of DESIGNATOR to
be. The point lies in the believed direction and distance from the real position of ROBOT."
  (point-at-distance (robot-image-x robot) (robot-image-y robot)
                     (+ (robot-image-angle robot) (designator-image-angle designator))
                     (designator-image-distance designator)))

(defun track-radius () (max 4 (* 1/2 graphics-scale*)))

(defun draw-track (canvas designator robot snapshot)
  "Draw a line from ROBOT to the believed position of the object of the tracked DESIGNATOR."
  (declare (ignore snapshot))
  (let ((target (points-to-pixels (believed-place robot designator))))
    (with-halo ((layer-ink :tracks) :dashes (layer-dashes :tracks))
      (draw-segments canvas draw-gcontext*
                     (list* (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                            target)))
    (with-halo ((layer-ink :tracks))
      (draw-circle canvas (first target) (second target) (track-radius) nil))))

(defun track-boxes (designator robot snapshot)
  "Return a list with the box, in pixels, of the ring at the believed position of DESIGNATOR."
  (declare (ignore snapshot))
  (destructuring-bind (x y) (points-to-pixels (believed-place robot designator))
    (list (box-around x y (+ 2 (track-radius))))))

(defun draw-designator-on-map (canvas robot designator)
  "Draw a cross with the number of DESIGNATOR at the believed position of its object, and a line
from the cross to the real position of the object."
  (destructuring-bind (x y) (points-to-pixels (believed-place robot designator))
    (let ((true-x (designator-image-x designator)) (true-y (designator-image-y designator))
          (color (layer-ink :designators))
          (number (princ-to-string (designator-image-number designator))))
      (with-subject (canvas designator)
        (when true-x
          (with-halo (color :dashes (layer-dashes :designators))
            (draw-segments canvas draw-gcontext*
                           (list x y (to-pixels true-x) (to-pixels true-y)))))
        (with-halo (color :width 2) (draw-cross canvas x y 4))
        (fill-with-white canvas (+ x 6) (- y 13) (+ 2 (monospaced-width number)) 13)
        (with-color color (draw-text canvas (+ x 7) (- y 3) number))))))

(defun designator-boxes (designators robot snapshot)
  "Return the boxes (left top right bottom) of the crosses and numbers of DESIGNATORS, in pixels."
  (declare (ignore snapshot))
  (loop for designator in designators
        for (x y) = (points-to-pixels (believed-place robot designator))
        for text = (princ-to-string (designator-image-number designator))
        collect (list (- x 5) (- y 13) (+ x 9 (monospaced-width text)) (+ y 5))))

(defun draw-designators-on-map (canvas designators robot snapshot)
  (declare (ignore snapshot))
  (dolist (designator designators) (draw-designator-on-map canvas robot designator)))

(defun odometer-box (odometer)
  "Return the corners, x y ... in metres, of the box of positions that ODOMETER estimates."
  (let ((cos (cosine (odometer-image-axis odometer))) (sin (sine (odometer-image-axis odometer))))
    (loop for (across down) in '((-1 -1) (1 -1) (1 1) (-1 1) (-1 -1))
          for dx = (* across 1/2 (odometer-image-width odometer))
          for dy = (* down 1/2 (odometer-image-height odometer))
          collect (+ (odometer-image-x odometer) (- (* cos dx) (* sin dy)))
          collect (+ (odometer-image-y odometer) (* sin dx) (* cos dy)))))

(defun draw-odometer (canvas odometer robot snapshot)
  "Draw the estimate of ODOMETER: a box of positions, with two lines for the bounds of the heading."
  (declare (ignore robot snapshot))
  (let* ((x (odometer-image-x odometer)) (y (odometer-image-y odometer))
         (heading (odometer-image-heading odometer))
         (half (* 1/2 (odometer-image-spread odometer))))
    (with-halo ((layer-ink :odometer) :dashes (layer-dashes :odometer))
      (draw-lines canvas draw-gcontext* (points-to-pixels (odometer-box odometer)))
      (dolist (angle (list (- heading half) (+ heading half)))
        (draw-segments canvas draw-gcontext*
                       (points-to-pixels (list* x y (point-at-distance x y angle 3))))))))
