;;;; doorways.lisp -- the next step of a robot on its way: straight ahead, or through a doorway.

;;; For plans and programs that find their way on a map. FIND-WAY of ARS finds the ways; NEXT-STEP
;;; divides them into steps. Points and cells are lists (x y) here.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun vector-length (dx dy)
  (sqrt (+ (* dx dx) (* dy dy))))

(defun cell-of-point (point)
  (mapcar #'floor point))

(defun middle-of (cell)
  (list (+ (first cell) .5) (+ (second cell) .5)))

(defun point-as-list (pt)
  (list (pt-x pt) (pt-y pt)))

(defun no-wall-at-p (map x y)
  "True if (X,Y) is inside MAP and its cell has no wall."
  (not (wall-at-p map x y)))

(defun doorway-at (map x y)
  (let ((place (and (no-wall-at-p map x y)
                    (ars-magna.world:cell-type (map-cell map x y)))))
    (and place
         (eq (ars-magna.world:place-type place) (find-place-type 'doorway))
         place)))

;;; A robot passes a doorway best if it comes to it straight, from one to three metres away.

(defun direction-from (start end)
  "Return the direction from the point START to END as a step (dx dy), each -1, 0 or 1."
  (destructuring-bind (dx dy) (mapcar #'- end start)
    (let ((length (vector-length dx dy)))
      (list (round dx length) (round dy length)))))

(defun point-before-doorway (map door direction)
  "Return the point from which a robot should drive into the cell DOOR. DIRECTION, a step (dx dy),
leads from DOOR to the side where the robot is."
  (destructuring-bind ((x y) (dx dy)) (list (middle-of door) direction)
    (let ((room (loop for length from 1 to 3
                      while (no-wall-at-p map (+ x (* length dx)) (+ y (* length dy)))
                      finally (return length))))
      ;; The point keeps clear of the first wall.
      (list (+ x (* (max 1 (- room 1.5)) dx)) (+ y (* (max 1 (- room 1.5)) dy))))))

(defun point-beyond-doorway (chart door goal)
  "Return a point a metre beyond the cell DOOR, on the way to GOAL."
  (let* ((middle (middle-of door)) (next (point-as-list (next-point chart middle goal)))
         (length (apply #'vector-length (mapcar #'- next middle))))
    (if (< length 1)
        next
        (mapcar (lambda (from to) (+ from (/ (- to from) length))) middle next))))

(defun in-line-with-doorway-p (start door before)
  "True if a robot at START can drive straight into the cell DOOR, nearly as well as from BEFORE."
  (destructuring-bind (dx dy) (mapcar #'- before (middle-of door))
    (destructuring-bind (x y) (mapcar #'- start (middle-of door))
      (let* ((length (vector-length dx dy))
             (along (/ (+ (* dx x) (* dy y)) length))
             (across (abs (/ (- (* dx y) (* dy x)) length))))
        (and (< .6 along (+ length 1)) (< across (max .4 (* .5 along))))))))

(defun straight-way-as-good-p (chart start point door goal)
  "True if the straight way from START to POINT costs no more than the way to the cell DOOR. On
CHART the way from START to GOAL leads through DOOR."
  (let ((cost (straight-cost chart start point)))
    (and cost
         (<= cost (- (way-cost chart start goal) (way-cost chart (middle-of door) goal))))))

(defun first-step-to-doorway (chart way door goal)
  "Return a robot's first step on WAY, which ends in the doorway DOOR. DOOR leads to GOAL."
  (let* ((start (first way))
         (before (point-before-doorway (chart-map chart) door
                                       (direction-from (middle-of door) (first (last way 2))))))
    (cond ((in-line-with-doorway-p start door before)
           (list :door door (point-beyond-doorway chart door goal)))
          ((straight-way-as-good-p chart start before door goal) (list :drive before))
          (t (list :drive (second way))))))

(defun next-step (chart start goal)
  "Return the first step on the way from the point START to GOAL on CHART:
- (:drive point): drive straight to the point.
- (:door cell point): drive through the doorway CELL to the point beyond it.
- NIL: there is no way."
  (let* ((map (chart-map chart))
         (start (nearest-free-point chart start))
         (goal (nearest-free-point chart goal))
         (way (and start goal
                   (mapcar #'point-as-list
                           (find-way chart start goal :until 'doorway))))
         (end (and way (cell-of-point (first (last way))))))
    (cond ((null way) nil)
          ((and (apply #'doorway-at map end) (not (equal end (cell-of-point (first way)))))
           (first-step-to-doorway chart way end goal))
          (t (list :drive (second way))))))
