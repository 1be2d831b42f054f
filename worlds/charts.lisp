;;;; charts.lisp -- what a robot may know of its map, and what it costs to cross its cells.

;;; Points and cells are lists (x y).

(in-package :ars-worlds)
(in-readtable :nisp)

;;; The map.

(defun length-of (dx dy)
  "Return the length of the vector (DX,DY)."
  (sqrt (+ (* dx dx) (* dy dy))))

(defun cell-of (point)
  "Return the cell in which POINT is."
  (mapcar #'floor point))

(defun middle-of (cell)
  "Return the point in the middle of CELL."
  (list (+ (first cell) .5) (+ (second cell) .5)))

(defun free-p (map x y)
  "True if the cell of MAP at (X,Y) is inside it and no wall."
  (and (< -1 (floor x) (map-width map))
       (< -1 (floor y) (map-height map))
       (not (wall-at-p map x y))))

(defun doorway-at (map x y)
  "Return the place of MAP at (X,Y) if that is a doorway, or NIL."
  (let ((place (and (free-p map x y)
                    (ars-magna.world:cell-type (map-cell map x y)))))
    (and place
         (eq (ars-magna.world:place-type place) (find-place-type 'doorway))
         place)))

(defun nearest-free (map x y)
  "Return the free cell of MAP nearest to (X,Y); NIL if there is none near."
  (loop for radius from 0 to 5
        do (loop for dx from (- radius) to radius
                 do (loop for dy from (- radius) to radius
                          when (free-p map (+ x dx) (+ y dy))
                            do (return-from nearest-free
                                 (cell-of (list (+ x dx) (+ y dy))))))))

;;; Charts.

(deftype costs () '(simple-array fixnum (*)))

(defstruct (chart (:constructor %make-chart (map places rows costs)) (:copier nil))
  "A map and what it costs to cross each of its cells, by the cell's number: 0 for a wall. A margin
of walls, one cell wide, is around them all, so that each cell has neighbours on all sides."
  (map nil :type map :read-only t)
  ;; What the map's places were when the chart was made.
  (places nil :read-only t)
  ;; How many cells a column has, with its margin.
  (rows 0 :type (integer 0 40000) :read-only t)
  (costs nil :type costs :read-only t)
  ;; Ways to one goal are asked for again and again: pairs of goals and what SPREAD-COSTS returned.
  ;; The list is replaced, never altered, so that all threads may share the chart.
  (known '() :type list))

(deftype coordinate () '(double-float -1d9 1d9))

(declaim (inline cell-number cost-at))
(defun cell-number (chart x y)
  "Return the number of the cell (X Y) of CHART, which is inside of it."
  (declare (type (integer 0 40000) x y))
  (+ 1 y (* (chart-rows chart) (1+ x))))

(defun numbered-cell (chart number)
  "Return the cell of CHART that has NUMBER."
  (multiple-value-bind (column row) (floor number (chart-rows chart))
    (list (1- column) (1- row))))

(defun cost-at (chart x y)
  "Return what it costs to cross the cell (X Y) of CHART: 0 for a wall, or outside of it."
  (declare (type fixnum x y))
  (if (and (< -1 x (map-width (chart-map chart)))
           (< -1 y (map-height (chart-map chart))))
      (aref (chart-costs chart) (cell-number chart x y))
      0))

(defun wide-p (chart x y)
  "True if no wall on CHART is within three quarters of a metre of (X,Y), as to the axes."
  (declare (type chart chart) (type coordinate x y))
  (loop for column fixnum from (floor (- x .75d0)) to (floor (+ x .75d0))
        always (loop for row fixnum from (floor (- y .75d0)) to (floor (+ y .75d0))
                     always (plusp (cost-at chart column row)))))

(defun cell-cost (chart x y)
  "Return what it is to cost to cross the cell (X Y) of CHART, which is no wall."
  (cond ((doorway-at (chart-map chart) x y) 2)
        ((wide-p chart (+ x .5d0) (+ y .5d0)) 1)
        (t 4)))

(defun empty-chart (map)
  "Return a chart of MAP on which nothing but walls costs 0, and all else 1."
  (let* ((rows (+ 2 (map-height map)))
         (chart (%make-chart map (ars-magna.world:map-places map) rows
                             (make-array (* rows (+ 2 (map-width map)))
                                         :element-type 'fixnum :initial-element 0))))
    (dotimes (x (map-width map) chart)
      (dotimes (y (map-height map))
        (when (free-p map x y) (setf (aref (chart-costs chart) (cell-number chart x y)) 1))))))

(defun make-chart (map)
  "Return a chart of MAP: to hug walls costs more than to keep away from them."
  (let ((chart (empty-chart map)))
    (dotimes (x (map-width map) chart)
      (dotimes (y (map-height map))
        (when (plusp (cost-at chart x y))
          (setf (aref (chart-costs chart) (cell-number chart x y)) (cell-cost chart x y)))))))

(defvar *charts* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "Charts by their maps. Whoever needs one of a map shares it.")

(defun chart-of (map)
  "Return a chart of MAP as it is now."
  (let ((chart (gethash map *charts*)))
    (if (and chart (eq (ars-magna.world:map-places map) (chart-places chart)))
        chart
        (setf (gethash map *charts*) (make-chart map)))))

(defun with-barred (chart barred)
  "Return the costs of CHART and of BARRED, a list of (cell cost), together."
  (let ((sums (chart-costs chart)))
    (when barred
      (setf sums (copy-seq sums))
      (loop for ((x y) cost) in barred
            when (plusp (cost-at chart x y))
              do (incf (aref sums (cell-number chart x y)) cost)))
    sums))
