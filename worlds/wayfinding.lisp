;;;; wayfinding.lisp -- which way a robot takes on its map.

;;; Good for plans that drive through doorways. What is used is what a robot may know: the walls
;;; and places of its map, and which cells it found barred. Costs are whole numbers, so that ways
;;; are the same everywhere. Points and cells are lists (x y).

(in-package :ars-worlds)
(in-readtable :nisp)

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

(defun as-doubles (point)
  "Return POINT with double-floats for its coordinates."
  (mapcar (lambda (number) (float number 1d0)) point))

(defun doorway-at (map x y)
  "Return the place of MAP at (X,Y) if that is a doorway, or NIL."
  (let ((place (and (free-p map x y)
                    (ars-magna.world:cell-type (map-cell map x y)))))
    (and place
         (eq (ars-magna.world:place-type place) (find-place-type 'doorway))
         place)))

;;; Charts.

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

(defvar *last-chart* nil
  "The chart that was made last. Whoever needs one of that map shares it.")

(defun chart-of (map)
  "Return a chart of MAP as it is now."
  (let ((chart *last-chart*))
    (if (and chart
             (eq map (chart-map chart))
             (eq (ars-magna.world:map-places map) (chart-places chart)))
        chart
        (setf *last-chart* (make-chart map)))))

(defun with-barred (chart barred)
  "Return the costs of CHART and of BARRED, a list of (cell cost), together."
  (let ((sums (chart-costs chart)))
    (when barred
      (setf sums (copy-seq sums))
      (loop for ((x y) cost) in barred
            when (plusp (cost-at chart x y))
              do (incf (aref sums (cell-number chart x y)) cost)))
    sums))

(defun nearest-free (map x y)
  "Return the free cell of MAP nearest to (X,Y); NIL if there is none near."
  (loop for radius from 0 to 5
        do (loop for dx from (- radius) to radius
                 do (loop for dy from (- radius) to radius
                          when (free-p map (+ x dx) (+ y dy))
                            do (return-from nearest-free
                                 (cell-of (list (+ x dx) (+ y dy))))))))

;;; Ways.

(defconstant +most-cost+ 2000
  "More than any step from cell to cell may cost.")

(defconstant +not-reached+ most-positive-fixnum
  "The cost of ways that nobody has found.")

(declaim (inline call-with-neighbours))
(defun call-with-neighbours (function costs rows cell)
  "Call FUNCTION with each cell next to CELL, a number, and the length of the step there: diagonally
only where no wall juts in."
  (declare (type costs costs) (type (unsigned-byte 31) cell) (type (integer 0 40000) rows))
  (labels ((free-p (offset) (plusp (aref costs (+ cell offset))))
           (straight (offset)
             (when (free-p offset) (funcall function (+ cell offset) 10)))
           (diagonal (dx dy)
             (when (and (free-p (+ dx dy)) (free-p dx) (free-p dy))
               (funcall function (+ cell dx dy) 14))))
    (declare (inline free-p))
    (straight rows)
    (straight 1)
    (straight (- rows))
    (straight -1)
    (diagonal rows 1)
    (diagonal (- rows) 1)
    (diagonal (- rows) -1)
    (diagonal rows -1)))

(defun spread-costs (costs rows goal)
  "Return a table of what it costs to get to the cell GOAL from each. Cells are taken in order of
cost, from as many lists as a step may cost, used in turn."
  (declare (type costs costs) (type fixnum goal))
  (let ((totals (make-array (length costs) :element-type 'fixnum :initial-element +not-reached+))
        (waiting (make-array +most-cost+ :initial-element '()))
        (count 0))
    (declare (type fixnum count))
    (flet ((reach (cell total)
             (declare (type fixnum cell total))
             (when (< total (aref totals cell))
               (setf (aref totals cell) total)
               (incf count)
               (push cell (svref waiting (mod total +most-cost+))))))
      (reach goal 0)
      (loop for total of-type (unsigned-byte 60) from 0
            do (dolist (cell (shiftf (svref waiting (mod total +most-cost+)) '()))
                 (declare (type (unsigned-byte 31) cell))
                 (decf count)
                 ;; If not, it has been reached at a lower cost meanwhile.
                 (when (= total (aref totals cell))
                   (call-with-neighbours
                    (lambda (next length)
                      (reach next (+ total (* length (aref costs next)))))
                    costs rows cell)))
            until (zerop count)))
    totals))

(defconstant +goals-known+ 4
  "For how many goals a chart knows what it costs to get there.")

(defun costs-to (chart goal)
  "Return what SPREAD-COSTS does for the costs of CHART."
  (let ((known (chart-known chart)))
    (cdr (or (assoc goal known)
             (first (setf (chart-known chart)
                          (cons (cons goal (spread-costs (chart-costs chart) (chart-rows chart) goal))
                                (subseq known 0 (min (length known) (1- +goals-known+))))))))))

(defun cheapest-next (costs totals rows cell)
  "Return the cell next to CELL by way of which the goal of TOTALS is nearest."
  (declare (type costs costs totals))
  (let ((best cell) (least +not-reached+))
    (call-with-neighbours
     (lambda (next length)
       ;; Totals count what it costs to leave a cell.
       (let ((way (+ (aref totals next) (* length (aref costs cell)))))
         (when (< way least)
           (setf best next least way))))
     costs rows cell)
    best))

(defun find-way (chart start goal &optional (barred '()))
  "Return the way on CHART from the point START to the point GOAL: the cells from the first to the
last; () if there is none. BARRED is a list of (cell cost) for cells that cost up to 100 more."
  (let ((start (nearest-free (chart-map chart) (first start) (second start)))
        (goal (nearest-free (chart-map chart) (first goal) (second goal))))
    (when (and start goal)
      (let* ((costs (with-barred chart barred))
             (rows (chart-rows chart))
             (start (cell-number chart (first start) (second start)))
             (goal (cell-number chart (first goal) (second goal)))
             (totals (if barred (spread-costs costs rows goal) (costs-to chart goal))))
        (when (< (aref totals start) +not-reached+)
          (loop for cell = start then (cheapest-next costs totals rows cell)
                collect (numbered-cell chart cell)
                until (= cell goal)))))))

;;; Steps of a way.

(defun clear-way-p (chart barred start goal)
  "True if a robot can drive from START straight to GOAL well away from all walls."
  (destructuring-bind ((x y) (goal-x goal-y)) (list (as-doubles start) (as-doubles goal))
    (declare (type coordinate x y goal-x goal-y))
    (loop with dx = (- goal-x x) and dy = (- goal-y y)
          with count of-type (unsigned-byte 40) = (ceiling (* 4 (length-of dx dy)))
          for i of-type (unsigned-byte 40) from 1 to count
          for part = (/ (float i 1d0) count)
          for way-x = (+ x (* dx part)) and way-y = (+ y (* dy part))
          always (and (wide-p chart way-x way-y)
                      (or (null barred)
                          (not (assoc (cell-of (list way-x way-y)) barred :test #'equal)))))))

(defun straight-run (cells)
  "Return the last of the first four CELLS, at most, that lie in a straight line."
  (loop for (cell next beyond) on cells
        repeat 3
        while (and beyond
                   (equal (mapcar #'- next cell) (mapcar #'- beyond next)))
        finally (return (or next cell))))

(defun farthest-clear (chart barred start cells end)
  "Return the last of the middles of CELLS and the point END to which a robot can drive straight
from START, or as far as CELLS go straight on."
  (or (find-if (lambda (point) (clear-way-p chart barred start point))
               (cons end (reverse (mapcar #'middle-of (rest cells)))))
      (if (rest cells) (middle-of (straight-run cells)) end)))

(defun before-doorway (map door last)
  "Return the point from which a robot best drives into the cell DOOR, coming by way of LAST."
  (destructuring-bind ((x y) (dx dy)) (list (middle-of door) (mapcar #'- last door))
    (let ((room (loop for length from 1 to 3
                      while (free-p map (+ x (* length dx)) (+ y (* length dy)))
                      finally (return length))))
      ;; In the last cell but one that is free, and not against what follows.
      (list (+ x (* (max 1 (- room 1.5)) dx)) (+ y (* (max 1 (- room 1.5)) dy))))))

(defun well-placed-p (start door before)
  "True if a robot at START can drive into the cell DOOR much as one at BEFORE can."
  (destructuring-bind (dx dy) (mapcar #'- before (middle-of door))
    (destructuring-bind (x y) (mapcar #'- start (middle-of door))
      (let* ((length (length-of dx dy))
             (along (/ (+ (* dx x) (* dy y)) length))
             (across (abs (/ (- (* dx y) (* dy x)) length))))
        (and (< .6 along (+ length 1)) (< across (max .4 (* .5 along))))))))

(defun next-step (chart barred start goal)
  "Return the first step of a robot on its way from the point START to GOAL: (:drive point) straight
ahead, (:door cell point) through the doorway CELL to the other side, or NIL if there is no way."
  (let* ((way (find-way chart start goal barred))
         (map (chart-map chart))
         (rank (position-if (lambda (cell) (doorway-at map (first cell) (second cell)))
                            way :start (min 1 (length way))))
         (door (and rank (nth rank way)))
         (before (and door (before-doorway map door (nth (1- rank) way)))))
    (cond ((null way) nil)
          ((and door (well-placed-p start door before))
           (list :door door (middle-of (or (nth (1+ rank) way) door))))
          (t (list :drive (farthest-clear chart barred start (subseq way 0 rank)
                                          (or before goal)))))))
