;;;; sight.lisp -- what can be seen from a point, and what is next to a robot.

(in-package :ars-magna.robot)

(export '(blocked-cell-p line-clear-p in-sight-p within-reach-p in-same-cell-p arrived-at-point-p
          +blocking+))

;;; Many things have whole coordinates, so lines often pass exactly where four cells meet. Rounding
;;; would then decide which of the two cells beside the corner a line meets. So it meets neither: it
;;; passes if one of the two lets it through. If both block, it stops, so oblique walls have no
;;; holes. Motion and sight follow the same rule (manual 2.1).

(declaim (inline floor-to-fixnum clip-to-cell))
(defun floor-to-fixnum (x)
  (declare (type double-float x))
  (the fixnum (floor (the (double-float -1d9 1d9) x))))

(defun clip-to-cell (coordinate cell &optional (last cell))
  "Return COORDINATE or, if rounding moved it out of CELL, the nearest coordinate inside CELL; with
LAST, inside the cells from CELL to LAST."
  (declare (type double-float coordinate) (type fixnum cell last))
  ;; The number before the far border is the greatest that is less.
  (max (float cell 1d0)
       (min coordinate (* (float (1+ last) 1d0) (- 1d0 double-float-negative-epsilon)))))

(define-constant +contact-gap+ 1d-6
  :documentation "The distance from an obstacle at which a robot stops, in metres. A line that is no
farther than this from a corner, along both axes, passes through the corner.")

(define-constant +blocking+ (logior +wall+ +obsmove+)
  :documentation "The flags of a cell that keeps robots out.")

(defun blocked-cell-p (world x y mask)
  "True if the cell of WORLD that holds (X,Y) has a flag of MASK, or is outside the map."
  (let ((index (map-index (world-map world) x y)))
    (or (null index)
        (logtest mask (aref (world-flags world) index)))))

(defun point-beyond-corner (world mask x y column row)
  "(X,Y) may be at a corner of the cell at COLUMN and ROW. If so, and if one of the two cells beside
the corner lets a line pass, return the point just beyond the corner, in the opposite cell, as two
values; else NIL. Cells with a flag of MASK stop the line."
  (let ((corner-x (round x)) (corner-y (round y)))
    (flet ((other (cell corner) (if (= cell corner) (1- corner) corner)))
      (let ((other-column (other column corner-x)) (other-row (other row corner-y)))
        (unless (or (> (abs (- x corner-x)) +contact-gap+)
                    (> (abs (- y corner-y)) +contact-gap+)
                    (and (blocked-cell-p world other-column row mask)
                         (blocked-cell-p world column other-row mask)))
          (values (clip-to-cell (double corner-x) other-column)
                  (clip-to-cell (double corner-y) other-row)))))))

(defun line-point-beyond-corner (world mask x y dx dy)
  "If a line in direction (DX,DY), stopped at (X,Y), only touches a corner there and may pass,
return the point just beyond, as two values; else NIL. Cells with a flag of MASK stop lines."
  (flet ((before (position direction)
           (if (plusp direction) (1- (round position)) (round position))))
    (unless (or (zerop dx) (zerop dy))
      (point-beyond-corner world mask x y (before x dx) (before y dy)))))

;;; Sight passes from cell to cell until a wall, or a cell where something on the floor obstructs
;;; it. The cells at both ends do not. The walk ends after as many borders as lie between them:
;;; counted by distance, rounding could end it one cell before or behind the target.

(defun same-cell-p (x y to-x to-y)
  (and (= (floor x) (floor to-x))
       (= (floor y) (floor to-y))))

(defun corner-clear-p (world x y dx dy to-x to-y)
  "True if the line in direction (DX,DY) to (TO-X,TO-Y), obstructed at (X,Y), only touches a corner
there and reaches its end."
  (multiple-value-bind (beyond-x beyond-y) (line-point-beyond-corner world +opaque+ x y dx dy)
    (and beyond-x
         (or (same-cell-p beyond-x beyond-y to-x to-y)
             (and (not (blocked-cell-p world beyond-x beyond-y +opaque+))
                  (line-clear-p world beyond-x beyond-y to-x to-y))))))

(defun line-clear-p (world x y to-x to-y)
  "True if nothing in WORLD obstructs the line from (X,Y) to (TO-X,TO-Y), points of the map."
  (declare #.*hot* (type world world) (type double-float x y to-x to-y))
  (let* ((flags (world-flags world)) (map (world-map world))
         (dx (- to-x x)) (dy (- to-y y))
         (left (+ (abs (- (floor-to-fixnum to-x) (floor-to-fixnum x)))
                  (abs (- (floor-to-fixnum to-y) (floor-to-fixnum y)))))
         (clear t)
         (at (walk-cells-on-line (lambda (index at column)
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
  "True if in WORLD the point (TO-X,TO-Y), or a corner of its cell, can be seen from (X,Y)."
  (let ((left (+ (floor to-x) 1d-3)) (top (+ (floor to-y) 1d-3)) (side (- 1d0 2d-3)))
    (flet ((clear-p (to-x to-y) (line-clear-p world x y to-x to-y)))
      (or (clear-p to-x to-y)
          (clear-p left top)
          (clear-p (+ left side) top)
          (clear-p left (+ top side))
          (clear-p (+ left side) (+ top side))))))

;;; What is local to a robot, and where it has arrived (manual 2.1, 3.4.1, 3.5).

;;; Searches, tracks, hands and approaches share one definition of "next to a robot",
;;; WITHIN-REACH-P. A robot cannot enter a cell that blocks it, so everything in that cell counts as
;;; next to a robot that stands at the cell. Where a robot has arrived is always within its reach.

(define-constant +contact+ (* 1.001d0 +contact-gap+)
  :documentation "The greatest distance from a cell, in metres, at which a robot counts as standing
at the cell: the contact gap, and an allowance for rounding.")
(define-constant +farthest-reach+ 1.001d0
  :documentation "No robot reaches farther than this along an axis, in metres.")

(defun in-same-cell-p (robot x y)
  "True if (X,Y), in metres, is in the cell of ROBOT."
  (same-cell-p x y (robot-x robot) (robot-y robot)))

(defun touching-cell-p (robot x y)
  "True if ROBOT is in the cell of (X,Y), or no farther from the cell than the contact gap."
  (flet ((gap (position start)
           (max (- start position) (- position (1+ start)))))
    (and (<= (gap (robot-x robot) (floor x)) +contact+)
         (<= (gap (robot-y robot) (floor y)) +contact+))))

(defun within-reach-p (robot x y)
  "True if (X,Y), in metres, is local to ROBOT: less than a metre away, in the same cell, or in a
cell that blocks ROBOT and that ROBOT touches (reading 108)."
  (let ((dx (- (double x) (robot-x robot))) (dy (- (double y) (robot-y robot))))
    (declare (type double-float dx dy))
    (and (<= (abs dx) +farthest-reach+)
         (<= (abs dy) +farthest-reach+)
         (or (< (+ (* dx dx) (* dy dy)) 1d0)
             (in-same-cell-p robot x y)
             (and (touching-cell-p robot x y)
                  (blocked-cell-p (robot-world robot) x y +blocking+))))))

(defun arrived-at-point-p (robot x y last-step block)
  "True if ROBOT has arrived at (X,Y) by its drive in this tick. LAST-STEP is true if ROBOT could
reach (X,Y), BLOCK if an obstacle blocked ROBOT. Nothing may hide (X,Y) from ROBOT (reading 108)."
  (or (in-same-cell-p robot x y)
      (and (within-reach-p robot x y)
           (or last-step
               (and block (touching-cell-p robot x y)))
           (in-sight-p (robot-world robot) (robot-x robot) (robot-y robot) (double x) (double y)))))
