;;;; sight-layers.lisp -- layers of what cameras can see, and of what they last saw.

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
  "Draw the field of view of CAMERA, as far as it can see."
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

(defun reading-entries (snapshot)
  (declare (ignore snapshot))
  (when in-color*
    (list (sample-of (canvas x y) "read: low to high"
            (loop for ink in +ray-inks+ for at from -8 by 3
                  do (with-color ink
                       (draw-rectangle canvas draw-gcontext* (+ x at) (- y 4) 3 8 t)))))))
