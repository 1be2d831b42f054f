;;;; senses.lisp -- what cameras can see and last saw, and what robots believe.

(in-package :ars-magna.display)

;;; Fields of view end at walls and at things that obstruct view. They are found when they are
;;; drawn, from the snapshot alone.

(define-constant +sight-spacing+ 0.015d0
  :documentation "How far apart the lines are that find where a field of view ends, in radians.")

(defun opaque-cells (snapshot)
  "Return a predicate of the index of a cell: whether a camera cannot look through it."
  (let* ((map (snapshot-map snapshot)) (flags (map-flags map))
         (hidden (loop for image across (snapshot-things snapshot)
                       when (thing-image-obsview-p image)
                         collect (map-index map (thing-image-x image) (thing-image-y image)))))
    (lambda (index)
      (or (logtest +wall+ (aref flags index)) (and hidden (member index hidden) t)))))

(defun sight-edge (map opaque-p x y first width)
  "Return points, x y ..., in metres, at which sight from X, Y ends, from the angle FIRST over
WIDTH."
  (let ((count (max 2 (ceiling width +sight-spacing+))))
    (loop for ray to count
          append (multiple-value-list
                  (ray-end map opaque-p x y (+ first (* ray (/ width count))))))))

(defun looking-out (camera)
  "Return CAMERA if it can see the map: if it is in nothing."
  (and (null (camera-image-location camera)) camera))

(defun draw-wedge (canvas camera robot snapshot)
  (let* ((map (snapshot-map snapshot)) (x (robot-image-x robot)) (y (robot-image-y robot))
         (width (camera-image-field-of-view camera))
         (first (- (+ (robot-image-angle robot) (camera-image-angle camera)) (/ width 2))))
    (when (map-index map x y)
      (let ((points (sight-edge map (opaque-cells snapshot) x y first width)))
        (inked ((layer-ink :wedges))
          (draw-lines canvas draw-gcontext*
                      (pixels-of (append (list x y) points (list x y)))))))))

;;; Rays, coloured by what was read.

(defun ray-class (map reading)
  "Return the number of the colour of READING, by where it is between the parameters of the walls."
  (let* ((least (map-least-parameter map)) (greatest (map-greatest-parameter map))
         (count (length +ray-inks+)))
    (if (< least greatest)
        (clamp (floor (* count (/ (- reading least) (- greatest least)))) 0 (1- count))
        0)))

(defun readings-of (look count)
  "Return COUNT of the numbers that were read, one for each ray of LOOK."
  (let ((view (coerce (look-view look) 'vector)))
    (loop for ray below count
          collect (if (zerop (length view)) 0 (aref view (floor (* ray (length view)) count))))))

(defun draw-rays (canvas look robot snapshot)
  (declare (ignore robot))
  (let* ((ends (look-ends look)) (map (snapshot-map snapshot))
         (classes (mapcar (lambda (reading) (ray-class map reading))
                          (readings-of look (/ (length ends) 2)))))
    (loop for ink in +ray-inks+ for number from 0
          for rays = (loop for (x y) on ends by #'cddr
                           for class in classes
                           when (= class number)
                             append (pixels-of (list (look-x look) (look-y look) x y)))
          when rays
            do (with-color ink
                 (with-dashes ((layer-dashes :rays))
                   (draw-segments canvas draw-gcontext* rays))))))

;;; Beliefs.

(defun believed-place (robot designator)
  "Return, in pixels, where ROBOT believes DESIGNATOR to be: it knows that from where it is."
  (around (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
          (+ (robot-image-angle robot) (designator-image-angle designator))
          (to-pixels (designator-image-distance designator))))

(defun track-radius () (max 4 (* 1/2 graphics-scale*)))

(defun draw-track (canvas designator robot snapshot)
  "Draw a line to where ROBOT believes DESIGNATOR, which a camera tracks, to be."
  (declare (ignore snapshot))
  (let ((target (believed-place robot designator)))
    (inked ((layer-ink :tracks) :dashes (layer-dashes :tracks))
      (draw-segments canvas draw-gcontext*
                     (list* (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                            target)))
    (inked ((layer-ink :tracks))
      (draw-circle canvas (first target) (second target) (track-radius) nil))))

(defun track-boxes (designator robot snapshot)
  "Return the box of the ring around where ROBOT believes DESIGNATOR to be, in pixels, as a list."
  (declare (ignore snapshot))
  (destructuring-bind (x y) (believed-place robot designator)
    (list (box-around x y (+ 2 (track-radius))))))

(defun draw-designator-on-map (canvas robot designator)
  "Draw a cross with the number of DESIGNATOR where ROBOT believes it to be, and a line from there
to what it denotes."
  (destructuring-bind (x y) (believed-place robot designator)
    (let ((true-x (designator-image-x designator)) (true-y (designator-image-y designator))
          (color (layer-ink :designators)))
      (with-subject (canvas designator)
        (when true-x
          (inked (color :dashes (layer-dashes :designators))
            (draw-segments canvas draw-gcontext*
                           (list x y (to-pixels true-x) (to-pixels true-y)))))
        (inked (color :width 2) (draw-cross canvas x y 4))
        (with-color color
          (draw-text-on-plate canvas (+ x 7) (- y 3)
                              (princ-to-string (designator-image-number designator))))))))

(defun designator-boxes (designators robot snapshot)
  "Return the boxes (left top right bottom) of the crosses and numbers of DESIGNATORS, in pixels."
  (declare (ignore snapshot))
  (loop for designator in designators
        for (x y) = (believed-place robot designator)
        for text = (princ-to-string (designator-image-number designator))
        collect (list (- x 5) (- y 13) (+ x 9 (words-width text)) (+ y 5))))

(defun draw-designators-on-map (canvas designators robot snapshot)
  (declare (ignore snapshot))
  (dolist (designator designators) (draw-designator-on-map canvas robot designator)))

(defun odometer-box (odometer)
  "Return the corners of the box that contains the position of ODOMETER, x y ..., in metres."
  (let ((cos (cosine (odometer-image-axis odometer))) (sin (sine (odometer-image-axis odometer))))
    (loop for (across down) in '((-1 -1) (1 -1) (1 1) (-1 1) (-1 -1))
          for dx = (* across 1/2 (odometer-image-width odometer))
          for dy = (* down 1/2 (odometer-image-height odometer))
          collect (+ (odometer-image-x odometer) (- (* cos dx) (* sin dy)))
          collect (+ (odometer-image-y odometer) (* sin dx) (* cos dy)))))

(defun draw-odometer (canvas odometer robot snapshot)
  "Draw where ODOMETER puts its robot: the box that contains its position, and from the middle of
that the bounds of its heading."
  (declare (ignore robot snapshot))
  (let* ((x (odometer-image-x odometer)) (y (odometer-image-y odometer))
         (heading (odometer-image-heading odometer))
         (half (* 1/2 (odometer-image-spread odometer))))
    (inked ((layer-ink :odometer) :dashes (layer-dashes :odometer))
      (draw-lines canvas draw-gcontext* (pixels-of (odometer-box odometer)))
      (dolist (angle (list (- heading half) (+ heading half)))
        (draw-segments canvas draw-gcontext* (pixels-of (list* x y (around x y angle 3))))))))
