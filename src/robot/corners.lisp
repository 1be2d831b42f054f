;;;; corners.lisp -- lines that pass exactly where four cells meet (manual 2.1).

(in-package :ars-magna.robot)

;;; Much stands at whole coordinates, so lines through corners are common, and rounding would decide
;;; which of the two cells beside the corner they meet. They meet neither: a line goes on if one of
;;; the two lets it through. Two that touch at the corner close it, so that oblique walls have no
;;; holes. What moves and what sees agree on this.

(declaim (inline whole-part))
(defun whole-part (x)
  (declare (type double-float x))
  (the fixnum (floor (the (double-float -1d9 1d9) x))))

(declaim (inline within-cell))
(defun within-cell (coordinate cell)
  "Return COORDINATE, or the nearest inside CELL if rounding took it out."
  (declare (type double-float coordinate) (type fixnum cell))
  ;; The number before the far border is the greatest that is less.
  (max (float cell 1d0)
       (min coordinate (* (float (1+ cell) 1d0) (- 1d0 double-float-negative-epsilon)))))

(define-constant +contact-gap+ 1d-6
  :documentation "How far from what blocks it a robot stops, in metres. No farther than this from a
corner, along either axis, a line passes through it.")

(define-constant +blocking+ (logior +wall+ +obsmove+)
  :documentation "The flags of a cell that keeps robots out.")

(defun closed-cell-p (world x y mask)
  "True if the cell of WORLD that holds (X,Y) has a flag of MASK, or is outside the map."
  (let ((index (map-index (world-map world) x y)))
    (or (null index)
        (logtest mask (aref (world-flags world) index)))))

(defun beyond-corner (world mask x y column row)
  "If (X,Y) is at a corner of the cell at COLUMN and ROW, and a line from there is not stopped by
the two cells beside the corner, return the point just beyond it, in the cell opposite, as two
values; else NIL. Cells with a flag of MASK stop the line."
  (let ((corner-x (round x)) (corner-y (round y)))
    (flet ((other (cell corner) (if (= cell corner) (1- corner) corner)))
      (let ((other-column (other column corner-x)) (other-row (other row corner-y)))
        (unless (or (> (abs (- x corner-x)) +contact-gap+)
                    (> (abs (- y corner-y)) +contact-gap+)
                    (and (closed-cell-p world other-column row mask)
                         (closed-cell-p world column other-row mask)))
          (values (within-cell (double corner-x) other-column)
                  (within-cell (double corner-y) other-row)))))))

(defun past-corner (world mask x y dx dy)
  "If a line in direction (DX,DY) that is stopped at (X,Y) only meets a corner there and goes on,
return the point just beyond it, as two values; else NIL. Cells with a flag of MASK stop the line."
  (flet ((before (position direction)
           (if (plusp direction) (1- (round position)) (round position))))
    (unless (or (zerop dx) (zerop dy))
      (beyond-corner world mask x y (before x dx) (before y dy)))))
