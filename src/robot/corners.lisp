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

(define-constant +corner-width+ 1d-9
  :documentation "No farther than this from a corner, along either axis, a line passes through it, in
metres.")

(defun closed-cell-p (world column row mask)
  "True if the cell of WORLD at COLUMN and ROW has a flag of MASK, or is outside the map."
  (let ((index (map-index (world-map world) column row)))
    (or (null index)
        (logtest mask (aref (world-flags world) index)))))

(defun beyond-corner (world mask x y dx dy)
  "If (X,Y) is at the corner of four cells and a line in direction (DX,DY) is not stopped by the two
beside it, return the point just beyond the corner, in the cell opposite, as two values; else NIL.
Cells with a flag of MASK stop it."
  (let ((corner-x (round x)) (corner-y (round y)))
    (flet ((ahead (corner direction) (if (plusp direction) corner (1- corner)))
           (behind (corner direction) (if (plusp direction) (1- corner) corner)))
      (let ((column (ahead corner-x dx)) (row (ahead corner-y dy)))
        (unless (or (zerop dx)
                    (zerop dy)
                    (> (abs (- x corner-x)) +corner-width+)
                    (> (abs (- y corner-y)) +corner-width+)
                    (and (closed-cell-p world column (behind corner-y dy) mask)
                         (closed-cell-p world (behind corner-x dx) row mask)))
          (values (within-cell (double corner-x) column)
                  (within-cell (double corner-y) row)))))))
