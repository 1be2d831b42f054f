;;;; wayfinding.lisp -- which way a robot takes on its map.

;;; Good for plans that drive through doorways. What is used is what a robot may know: the walls
;;; and places of its map, and which cells it found barred. Costs are whole numbers, so that ways
;;; are the same everywhere.

(in-package :ars-worlds)
(in-readtable :nisp)

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
             (let ((new (cons goal (spread-costs (chart-costs chart) (chart-rows chart) goal))))
               (setf (chart-known chart)
                     (cons new (subseq known 0 (min (length known) (1- +goals-known+)))))
               new)))))

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

(defun as-doubles (point)
  "Return POINT with double-floats for its coordinates."
  (mapcar (lambda (number) (float number 1d0)) point))

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
