;;;; doorways.lisp -- the next step of a robot on its way: straight ahead, or through a doorway.

;;; Good for plans that find their way on a map; the ways themselves are ARS's, see FIND-WAY. Points
;;; and cells are lists (x y) here.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun length-of (dx dy)
  "Return the length of the vector (DX,DY)."
  (sqrt (+ (* dx dx) (* dy dy))))

(defun cell-of (point)
  "Return the cell in which POINT is."
  (mapcar #'floor point))

(defun middle-of (cell)
  "Return the point in the middle of CELL."
  (list (+ (first cell) .5) (+ (second cell) .5)))

(defun as-list (pt)
  "Return the PT as a list (x y)."
  (list (pt-x pt) (pt-y pt)))

(defun free-p (map x y)
  "True if the cell of MAP at (X,Y) is inside it and no wall."
  (not (wall-at-p map x y)))

(defun doorway-at (map x y)
  "Return the place of MAP at (X,Y) if that is a doorway, or NIL."
  (let ((place (and (free-p map x y)
                    (ars-magna.world:cell-type (map-cell map x y)))))
    (and place
         (eq (ars-magna.world:place-type place) (find-place-type 'doorway))
         place)))

;;; A robot had better come to a doorway straight, from some way off.

(defun direction-from (start end)
  "Return the step (dx dy), each -1, 0 or 1, that leads best from the point START towards END."
  (destructuring-bind (dx dy) (mapcar #'- end start)
    (let ((length (length-of dx dy)))
      (list (round dx length) (round dy length)))))

(defun before-doorway (map door direction)
  "Return the point from which a robot best drives into the cell DOOR, coming from where DIRECTION,
a step, leads."
  (destructuring-bind ((x y) (dx dy)) (list (middle-of door) direction)
    (let ((room (loop for length from 1 to 3
                      while (free-p map (+ x (* length dx)) (+ y (* length dy)))
                      finally (return length))))
      ;; In the last cell but one that is free, and not against what follows.
      (list (+ x (* (max 1 (- room 1.5)) dx)) (+ y (* (max 1 (- room 1.5)) dy))))))

(defun beyond-doorway (chart door goal)
  "Return a point a metre beyond the cell DOOR, on the way to GOAL."
  (let* ((middle (middle-of door)) (next (as-list (next-point chart middle goal)))
         (length (apply #'length-of (mapcar #'- next middle))))
    (if (< length 1)
        next
        (mapcar (lambda (from to) (+ from (/ (- to from) length))) middle next))))

(defun well-placed-p (start door before)
  "True if a robot at START can drive into the cell DOOR much as one at BEFORE can."
  (destructuring-bind (dx dy) (mapcar #'- before (middle-of door))
    (destructuring-bind (x y) (mapcar #'- start (middle-of door))
      (let* ((length (length-of dx dy))
             (along (/ (+ (* dx x) (* dy y)) length))
             (across (abs (/ (- (* dx y) (* dy x)) length))))
        (and (< .6 along (+ length 1)) (< across (max .4 (* .5 along))))))))

(defun as-good-p (chart start point door goal)
  "True if the straight line from START to POINT on CHART costs no more than the way from START, by
which one comes to the cell DOOR, on to GOAL."
  (let ((cost (straight-cost chart start point)))
    (and cost
         (<= cost (- (way-cost chart start goal) (way-cost chart (middle-of door) goal))))))

(defun step-to-doorway (chart way door goal)
  "Return the first step of a robot on WAY, which ends in the doorway DOOR and leads on to GOAL."
  (let* ((start (first way))
         (before (before-doorway (chart-map chart) door
                                 (direction-from (middle-of door) (first (last way 2))))))
    (cond ((well-placed-p start door before)
           (list :door door (beyond-doorway chart door goal)))
          ((as-good-p chart start before door goal) (list :drive before))
          (t (list :drive (second way))))))

(defun next-step (chart start goal)
  "Return the first step of a robot on its way from the point START to GOAL: (:drive point) straight
ahead, (:door cell point) through the doorway CELL to the other side, or NIL if there is no way."
  (let* ((map (chart-map chart))
         (start (nearest-free-point chart start))
         (goal (nearest-free-point chart goal))
         (way (and start goal
                   (mapcar #'as-list
                           (find-way chart start goal :until 'doorway))))
         (end (and way (cell-of (first (last way))))))
    (cond ((null way) nil)
          ((and (apply #'doorway-at map end) (not (equal end (cell-of (first way)))))
           (step-to-doorway chart way end goal))
          (t (list :drive (second way))))))
