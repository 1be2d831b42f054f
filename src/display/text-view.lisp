;;;; text-view.lisp -- which part of a world a text map shows, and how coarsely.

(in-package :ars-magna.display)

;;; Each character stands for a block of cells. Characters are about twice as high as they are wide;
;;; so where a map has to be scaled down to a number of lines, blocks may be twice as high, too.

(defstruct (view (:copier nil))
  "Which cells of SNAPSHOT a text map shows: COLUMNS x ROWS blocks of WIDE x HIGH cells from LEFT
and TOP."
  (snapshot nil :type snapshot :read-only t)
  (left 0 :type fixnum :read-only t)
  (top 0 :type fixnum :read-only t)
  (columns 1 :type (integer 1) :read-only t)
  (rows 1 :type (integer 1) :read-only t)
  (wide 1 :type (integer 1) :read-only t)
  (high 1 :type (integer 1) :read-only t))

(defun view-map (view) (snapshot-map (view-snapshot view)))

;;; Regions.

(defun clipped (least low high most)
  "Return LOW and HIGH as whole numbers between LEAST and MOST, at least one apart."
  (let ((low (max least (min (floor low) (1- most)))))
    (values low (max (1+ low) (min (ceiling high) most)))))

(defun region-near (robot radius)
  "Return the list (left top right bottom) of what is no more than RADIUS cells from ROBOT."
  (let ((x (floor (robot-x robot))) (y (floor (robot-y robot))))
    (list (- x radius) (- y radius) (+ x radius 1) (+ y radius 1))))

(defun least-block (width height columns rows)
  "Return how many cells wide and high blocks are of which WIDTH x HEIGHT cells make no more than
COLUMNS x ROWS; ROWS may be NIL, if lines do not count."
  (flet ((fits-p (wide high)
           (and (<= (ceiling width wide) columns)
                (or (null rows) (<= (ceiling height high) rows)))))
    (loop for wide from 1
          do (cond ((fits-p wide wide) (return (values wide wide)))
                   ((fits-p wide (* 2 wide)) (return (values wide (* 2 wide))))))))

(defun view-of (snapshot region columns rows)
  "Return a view of REGION, a list (left top right bottom) in metres, or NIL for all of SNAPSHOT, in
COLUMNS characters of a line and ROWS lines at most; ROWS may be NIL."
  (let ((map (snapshot-map snapshot)))
    (destructuring-bind (x1 y1 x2 y2) (or region (list 0 0 (map-width map) (map-height map)))
      (multiple-value-bind (left right) (clipped 0 x1 x2 (map-width map))
        (multiple-value-bind (top bottom) (clipped 0 y1 y2 (map-height map))
          (multiple-value-bind (wide high)
              (least-block (- right left) (- bottom top) columns rows)
            (make-view :snapshot snapshot :left left :top top :wide wide :high high
                       :columns (ceiling (- right left) wide)
                       :rows (ceiling (- bottom top) high))))))))

;;; Blocks.

(defun block-indices (view column row)
  (let ((map (view-map view)))
    (loop for y from (+ (view-top view) (* row (view-high view))) repeat (view-high view)
          append (loop for x from (+ (view-left view) (* column (view-wide view)))
                         repeat (view-wide view)
                       when (map-index map x y) collect it))))

(defun block-at (view x y)
  "Return the number of the block of VIEW that the point X, Y is in, counted row by row, or NIL."
  (let ((column (floor (- x (view-left view)) (view-wide view)))
        (row (floor (- y (view-top view)) (view-high view))))
    (when (and (< -1 column (view-columns view)) (< -1 row (view-rows view)))
      (+ column (* row (view-columns view))))))

(defun block-of-index (view index)
  "Return the number of the block of VIEW that the cell INDEX is in, or NIL."
  (multiple-value-bind (y x) (floor index (map-width (view-map view)))
    (block-at view x y)))
