;;;; sight.lisp -- whether one point can be seen from another (manual 3.4.3).

(in-package :ars-magna.robot)

;;; Sight passes from cell to cell until a wall, or a cell where something on the floor obstructs
;;; it. Neither the cell of the eye nor that of the target does.

(defun line-clear-p (world x y to-x to-y)
  "True if nothing in WORLD obstructs the line from (X,Y) to (TO-X,TO-Y), points of the map."
  (declare #.*hot* (type world world) (type double-float x y to-x to-y))
  (let* ((flags (world-flags world))
         (width (map-width (world-map world)))
         (cell-x (whole-part x)) (cell-y (whole-part y))
         (left-x (abs (- (whole-part to-x) cell-x)))
         (left-y (abs (- (whole-part to-y) cell-y)))
         (dx (- to-x x)) (dy (- to-y y))
         (step-x (if (minusp dx) -1 1)) (step-y (if (minusp dy) -1 1))
         (per-x (if (zerop dx) 1d18 (abs (/ dx)))) (per-y (if (zerop dy) 1d18 (abs (/ dy))))
         (at-x (* per-x (if (minusp dx) (- x cell-x) (- (1+ cell-x) x))))
         (at-y (* per-y (if (minusp dy) (- y cell-y) (- (1+ cell-y) y)))))
    (declare (type fixnum cell-x cell-y left-x left-y)
             (type double-float dx dy per-x per-y at-x at-y))
    (loop repeat (1- (+ left-x left-y))
          do (if (or (zerop left-y) (and (plusp left-x) (< at-x at-y)))
                 (progn (incf at-x per-x) (incf cell-x step-x) (decf left-x))
                 (progn (incf at-y per-y) (incf cell-y step-y) (decf left-y)))
          never (logtest (logior +wall+ +obsview+)
                         (aref flags (the cell-index (+ cell-x (the fixnum (* cell-y width)))))))))

(defun in-sight-p (world x y to-x to-y)
  "True if in WORLD the cell of (TO-X,TO-Y), or a good part of it, can be seen from (X,Y)."
  (let ((left (+ (floor to-x) 1d-3)) (top (+ (floor to-y) 1d-3)) (side (- 1d0 2d-3)))
    (flet ((clear-p (to-x to-y) (line-clear-p world x y to-x to-y)))
      (or (clear-p to-x to-y)
          (clear-p left top)
          (clear-p (+ left side) top)
          (clear-p left (+ top side))
          (clear-p (+ left side) (+ top side))))))
