;;;; visibility.lisp -- whether a camera that points at something sees it (manual 2.2, 3.4.3).

(in-package :ars-magna.robot)

;;; A search sends rays, and what none of them reaches is not found. A track is held to the same.

(defun ray-crosses-cell-p (dx dy angle)
  "True if a ray in the direction ANGLE crosses the cell whose centre is at (DX,DY) from its start."
  (let ((cos (cosine angle)) (sin (sine angle)))
    (and (plusp (+ (* dx cos) (* dy sin)))
         (<= (abs (- (* dx sin) (* dy cos)))
             (* 0.5d0 (+ (abs cos) (abs sin)))))))

(defun ray-reaches-p (world x y angle index)
  "True if a ray from (X,Y) in the direction ANGLE, in radians, meets the cell INDEX of WORLD."
  (let ((reached nil))
    (flet ((visit (at flag)
             (or (when (= at index) (setf reached t))
                 (logtest flag +opaque+))))
      (declare (dynamic-extent #'visit))
      (walk-ray #'visit world x y (cosine angle) (sine angle)))
    reached))

(defun sight-by-rays (world x y to-x to-y heading width count)
  "Return :CLEAR if one of COUNT rays from (X,Y), evenly spaced over WIDTH radians around HEADING,
reaches the cell of (TO-X,TO-Y) in WORLD; :OBSTRUCTED if all that cross it are stopped before; NIL
if none crosses it."
  (let* ((index (map-index (world-map world) to-x to-y))
         (dx (- (+ 0.5d0 (floor to-x)) x)) (dy (- (+ 0.5d0 (floor to-y)) y))
         (spacing (/ width count)) (first (- heading (* 0.5d0 (- width spacing))))
         (middle (- (+ heading (angle-difference (arctangent dy dx) heading)) first))
         ;; A circle around the cell, seen from there.
         (half (arctangent 0.75d0 (sqrt (+ (* dx dx) (* dy dy)))))
         (sight nil))
    (loop for number from (max 0 (ceiling (- middle half) spacing))
            to (min (1- count) (floor (+ middle half) spacing))
          for angle = (+ first (* number spacing))
          when (ray-crosses-cell-p dx dy angle)
            do (if (ray-reaches-p world x y angle index)
                   (return :clear)
                   (setf sight :obstructed))
          finally (return sight))))

;; Where a robot can drive straight ahead it can see, too, however few the rays are.
(defun seen-by-p (camera designator)
  "True if CAMERA, pointing at what DESIGNATOR denotes, sees it: a search would find it, or would
miss it though nothing obstructs it. During an approach a line to a corner of its cell will do."
  (let* ((robot (camera-robot camera)) (world (robot-world robot))
         (own-x (robot-x robot)) (own-y (robot-y robot))
         (x (designator-x designator)) (y (designator-y designator)))
    (or (in-same-cell-p robot x y)
        (line-clear-p world own-x own-y x y)
        (and (or (approached-p camera) (within-reach-p robot x y))
             (in-sight-p world own-x own-y x y))
        (ecase (sight-by-rays world own-x own-y x y
                              (+ (robot-angle robot) (designator-angle designator))
                              (camera-field-of-view camera) scan-density*)
          (:clear t)
          (:obstructed nil)
          ((nil) (in-sight-p world own-x own-y x y))))))

(defun visible-p (designator camera)
  "True if nothing hides the DESIGNATOR's denotation, in the open, from CAMERA, or if that is NIL
from its robot (reading 141)."
  (let ((robot (designator-robot designator)))
    (cond ((null (designator-denotation designator)) t)
          (camera (seen-by-p camera designator))
          (t (in-sight-p (robot-world robot) (robot-x robot) (robot-y robot)
                         (designator-x designator) (designator-y designator))))))
