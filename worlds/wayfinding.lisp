;;;; wayfinding.lisp -- which way a robot takes on its map.

;;; Good for plans that drive through doorways. What is used is what a robot may know: the walls
;;; and places of its map, and which cells it found barred. Costs are whole numbers, so that ways
;;; are the same everywhere. Points and cells are lists (x y).

(in-package :ars-worlds)
(in-readtable :nisp)

(defstruct (chart (:constructor %make-chart (map costs)) (:copier nil))
  "A map and what it costs to cross each of its cells, 0 for a wall."
  (map nil :type map :read-only t)
  (costs nil :type (simple-array fixnum (* *)) :read-only t))

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

(defun wide-p (map x y)
  "True if no wall of MAP is within three quarters of a metre of (X,Y), as to the axes."
  (loop for dx in '(-.75 0 .75)
        always (loop for dy in '(-.75 0 .75)
                     always (free-p map (+ x dx) (+ y dy)))))

(defun cell-cost (map x y)
  (cond ((not (free-p map x y)) 0)
        ((doorway-at map x y) 2)
        ((wide-p map (+ x .5) (+ y .5)) 1)
        (t 4)))

(defun make-chart (map)
  "Return a chart of MAP: to hug walls costs more than to keep away from them."
  (let ((costs (make-array (list (map-width map) (map-height map)) :element-type 'fixnum)))
    (dotimes (x (map-width map) (%make-chart map costs))
      (dotimes (y (map-height map))
        (setf (aref costs x y) (cell-cost map x y))))))

(defun with-barred (chart barred)
  "Return the costs of CHART and of BARRED, a list of (cell cost), together."
  (let* ((costs (chart-costs chart))
         (sums (make-array (array-dimensions costs) :element-type 'fixnum)))
    (dotimes (index (array-total-size costs))
      (setf (row-major-aref sums index) (row-major-aref costs index)))
    (loop for ((x y) cost) in barred
          when (and (array-in-bounds-p sums x y) (plusp (aref sums x y)))
            do (incf (aref sums x y) cost))
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

(defun neighbours (costs x y)
  "Return a list of (x y cost) for the cells next to (X,Y): diagonally only where no wall juts in."
  (declare (type (simple-array fixnum (* *)) costs) (type fixnum x y))
  (flet ((cost (x y) (if (array-in-bounds-p costs x y) (aref costs x y) 0)))
    (loop for (dx dy) of-type (fixnum fixnum)
            in '((1 0) (0 1) (-1 0) (0 -1) (1 1) (-1 1) (-1 -1) (1 -1))
          for straight = (zerop (* dx dy))
          for cost of-type fixnum = (cost (+ x dx) (+ y dy))
          when (and (plusp cost)
                    (or straight
                        (and (plusp (cost (+ x dx) y)) (plusp (cost x (+ y dy))))))
            collect (list (+ x dx) (+ y dy) (* (if straight 10 14) cost)))))

(defun spread-costs (costs start goal)
  "Return a table of what it costs to get to the cell GOAL from each that is no farther from it than
START. Cells are taken in order of cost, from as many lists as a step may cost, used in turn."
  (let ((totals (make-array (array-dimensions costs) :element-type 'fixnum :initial-element -1))
        (waiting (make-array +most-cost+ :initial-element '())))
    (push goal (aref waiting 0))
    (loop with idle = 0
          for total from 0
          for here = (reverse (shiftf (aref waiting (mod total +most-cost+)) '()))
          until (or (> idle +most-cost+) (plusp (aref totals (first start) (second start))))
          do (setf idle (if here 0 (1+ idle)))
             (loop for (x y) in here
                   when (minusp (aref totals x y))
                     do (setf (aref totals x y) total)
                        (loop for (next-x next-y step) in (neighbours costs x y)
                              when (minusp (aref totals next-x next-y))
                                do (push (list next-x next-y)
                                         (aref waiting (mod (+ total step) +most-cost+))))))
    totals))

(defun cheapest-next (costs totals cell)
  "Return the cell next to CELL by way of which the goal of TOTALS is nearest."
  (let ((here (apply #'aref costs cell)))
    (loop with best = nil and least = nil
          for (x y step) in (neighbours costs (first cell) (second cell))
          for total = (aref totals x y)
          ;; Totals count what it costs to leave a cell.
          for way = (+ total (* here (/ step (aref costs x y))))
          when (and (>= total 0) (or (null least) (< way least)))
            do (setf least way
                     best (list x y))
          finally (return best))))

(defun find-way (chart start goal &optional (barred '()))
  "Return the way on CHART from the point START to the point GOAL: the cells from the first to the
last; () if there is none. BARRED is a list of (cell cost) for cells that cost up to 100 more."
  (let ((start (nearest-free (chart-map chart) (first start) (second start)))
        (goal (nearest-free (chart-map chart) (first goal) (second goal)))
        (costs (with-barred chart barred)))
    (when (and start goal)
      (let ((totals (spread-costs costs start goal)))
        (when (>= (aref totals (first start) (second start)) 0)
          (loop for cell = start then (cheapest-next costs totals cell)
                collect cell
                until (equal cell goal)))))))

;;; Steps of a way.

(defun clear-way-p (chart barred start goal)
  "True if a robot can drive from START straight to GOAL well away from all walls."
  (destructuring-bind ((x y) (goal-x goal-y)) (list start goal)
    (loop with count = (ceiling (* 4 (length-of (- goal-x x) (- goal-y y))))
          for i from 1 to count
          for point = (list (+ x (* (- goal-x x) (/ i count))) (+ y (* (- goal-y y) (/ i count))))
          always (and (wide-p (chart-map chart) (first point) (second point))
                      (not (assoc (cell-of point) barred :test #'equal))))))

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
               (append (mapcar #'middle-of (rest cells)) (list end))
               :from-end t)
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
