;;;; sight.lisp -- whether one point can be seen from another (manual 3.4.3).

(in-package :ars-magna.robot)

(export '(line-clear-p in-sight-p))

;;; Sight passes from cell to cell until a wall, or a cell where something on the floor obstructs
;;; it. Neither the cell of the eye nor that of the target does. The walk ends after as many borders
;;; as lie between them, as by distance rounding could end it one cell before or behind the target.

(defun same-cell-p (x y to-x to-y)
  (and (= (floor x) (floor to-x))
       (= (floor y) (floor to-y))))

(defun corner-clear-p (world x y dx dy to-x to-y)
  "True if the line in direction (DX,DY) to (TO-X,TO-Y), obstructed at (X,Y), only meets a corner
there and goes on beyond it."
  (multiple-value-bind (beyond-x beyond-y) (past-corner world +opaque+ x y dx dy)
    (and beyond-x
         (or (same-cell-p beyond-x beyond-y to-x to-y)
             (and (not (closed-cell-p world beyond-x beyond-y +opaque+))
                  (line-clear-p world beyond-x beyond-y to-x to-y))))))

(defun line-clear-p (world x y to-x to-y)
  "True if nothing in WORLD obstructs the line from (X,Y) to (TO-X,TO-Y), points of the map."
  (declare #.*hot* (type world world) (type double-float x y to-x to-y))
  (let* ((flags (world-flags world)) (map (world-map world))
         (dx (- to-x x)) (dy (- to-y y))
         (left (+ (abs (- (whole-part to-x) (whole-part x)))
                  (abs (- (whole-part to-y) (whole-part y)))))
         (clear t)
         (at (walk-grid (lambda (index at column)
                          (declare (ignore at column))
                          (or (<= (decf left) 0)
                              (when (logtest +opaque+ (aref flags index))
                                (setf clear nil)
                                t)))
                        (map-width map) (map-height map) x y dx dy +no-limit+)))
    (declare (type fixnum left) (type double-float at))
    (or clear
        (corner-clear-p world (+ x (* dx at)) (+ y (* dy at)) dx dy to-x to-y))))

(defun in-sight-p (world x y to-x to-y)
  "True if in WORLD the cell of (TO-X,TO-Y), or a good part of it, can be seen from (X,Y)."
  (let ((left (+ (floor to-x) 1d-3)) (top (+ (floor to-y) 1d-3)) (side (- 1d0 2d-3)))
    (flet ((clear-p (to-x to-y) (line-clear-p world x y to-x to-y)))
      (or (clear-p to-x to-y)
          (clear-p left top)
          (clear-p (+ left side) top)
          (clear-p left (+ top side))
          (clear-p (+ left side) (+ top side))))))
