;;;; grid-walk.lisp -- the walk from cell to cell along a line, for all that moves or sees.

(in-package :ars-magna.world)

(export '(walk-grid cell-number grid-size +endless+ +no-limit+))

;;; Driving, sight, scans and the display all walk here (a digital differential analyser), so a
;;; line meets the same cells for each. Distances along it are in lengths of its direction. All is
;;; inline, with VISIT a known function, so that nothing is called or allocated for a cell.

(defconstant +endless+ 1d100
  "A distance that stands for infinity, also when a rounding error multiplies it.")
(defconstant +no-limit+ 32767
  "How many columns and rows a walk crosses at most when nothing else ends it.")

(deftype grid-size ()
  "How many columns or rows a grid has, or one has to cross."
  '(unsigned-byte 15))

(declaim (inline cell-number))
(defun cell-number (coordinate)
  "Return the column or row of a grid that COORDINATE, in metres, is in."
  (the grid-size (truncate (the (double-float 0d0 32767d0) coordinate))))

(declaim (inline border-spacing))
(defun border-spacing (component)
  "Return how far it is from border to border of cells along a line with COMPONENT on this axis."
  (declare (type double-float component))
  (if (zerop component) +endless+ (abs (/ component))))

(declaim (inline to-border))
(defun to-border (start cell back)
  "Return how far it is on one axis from START, which lies in CELL, to its border: the lower if
BACK."
  (declare (type double-float start) (type grid-size cell))
  (if back (- start cell) (- (1+ cell) start)))

(declaim (inline walk-grid))
(defun walk-grid (visit width height x y dx dy reach &optional column-first)
  "Call VISIT with each cell that the line from (X,Y) in direction (DX,DY) meets after the first, by
its index in a grid of WIDTH by HEIGHT that holds (X,Y), with the distance at which the line enters
it, and whether that is from another column; until VISIT returns true, the grid ends, or REACH
columns or rows have been crossed. Return the distance there. Through a corner the line goes by way
of the next row, or if COLUMN-FIRST, a constant, by way of the next column."
  (declare (type function visit) (type grid-size width height reach)
           (type double-float x y dx dy))
  (let* ((cell-x (cell-number x)) (cell-y (cell-number y))
         (back-x (minusp dx)) (back-y (minusp dy))
         (step-x (if back-x -1 1)) (step-y (if back-y (- width) width))
         (left-x (min reach (if back-x cell-x (- width cell-x 1))))
         (left-y (min reach (if back-y cell-y (- height cell-y 1))))
         (per-x (border-spacing dx)) (at-x (* per-x (to-border x cell-x back-x)))
         (per-y (border-spacing dy)) (at-y (* per-y (to-border y cell-y back-y)))
         (index (+ cell-x (* cell-y width))))
    (declare (type grid-size left-x left-y) (type fixnum step-x step-y)
             (type double-float per-x per-y at-x at-y) (type cell-index index))
    (loop
      (let ((at 0d0) (column nil))
        (declare (type double-float at))
        (cond ((if column-first (<= at-x at-y) (< at-x at-y))
               (setf at at-x)
               (when (zerop left-x) (return at))
               (setf left-x (1- left-x)
                     at-x (+ at-x per-x)
                     index (the cell-index (+ index step-x))
                     column t))
              (t
               (setf at at-y)
               (when (zerop left-y) (return at))
               (setf left-y (1- left-y)
                     at-y (+ at-y per-y)
                     index (the cell-index (+ index step-y)))))
        (when (funcall visit index at column) (return at))))))
