;;;; traffic.lisp -- what a robot does when another robot is in its way: wait, go round, give way.

;;; For TRAVEL-TO and ROBOT-GO-TO in worlds with several robots. A robot does not know who is in its
;;; way, or where others want to go. It waits for a random time. Then it tries again or, by chance,
;;; gives way: it drives to a passing place, where others can get past, and waits there. So two
;;; robots that meet in a doorway or a corridor soon do different things.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun meets-robots-p (me)
  "True if the robot of the reckoning ME may meet other robots: there are others in its world."
  (and (ars-magna.robot:robot-body (robot-of-reckoning me)) t))

;; With dice of its own for each robot, no robot changes the choices of another.
(defun traffic-dice (me)
  "Return the dice for the choices of the robot of the reckoning ME in meetings. They depend on the
seed, the robot's full name, and the tick of its first meeting."
  (or (reckoning-dice me)
      (let ((robot (robot-of-reckoning me)))
        (setf (reckoning-dice me)
              (ars-magna.base:make-dice (world-seed (robot-world robot))
                                        (format nil "traffic of ~A at ~D" (robot-full-name robot)
                                                (simulation-tick)))))))

;;; Passing places.

(defun narrow-cell-p (map x y)
  "True if the cell (X,Y) of MAP has walls on two opposite sides: two robots cannot pass there."
  (flet ((walls-p (dx dy)
           (and (wall-at-p map (+ x dx) (+ y dy)) (wall-at-p map (- x dx) (- y dy)))))
    (or (walls-p 1 0) (walls-p 0 1))))

(defun passing-place-p (map cell)
  "True if a robot in CELL leaves room for others: neither CELL nor a cell around it is narrow."
  (loop for x from (1- (first cell)) to (1+ (first cell))
        always (loop for y from (1- (second cell)) to (1+ (second cell))
                     always (or (wall-at-p map x y) (not (narrow-cell-p map x y))))))

(defun cells-beside (map cell)
  "Return a list of the up to four cells beside CELL that have no wall."
  (loop for (dx dy) in '((1 0) (0 1) (-1 0) (0 -1))
        for next = (list (+ (first cell) dx) (+ (second cell) dy))
        when (apply #'no-wall-at-p map next) collect next))

(defun nearest-passing-places (map start obstacle count)
  "Return a list of the COUNT passing places of MAP nearest to the cell START, fewer if there are no
more, on ways that do not lead through the cell OBSTACLE."
  (let ((reached (make-hash-table :test #'equal)) (found '()))
    (setf (gethash obstacle reached) t
          (gethash start reached) t)
    (loop for front = (list start) then (loop for cell in front
                                              append (unreached-cells-beside map cell reached))
          while (and front (< (length found) count))
          do (dolist (cell front)
               (when (and (not (equal cell start)) (passing-place-p map cell)) (push cell found))))
    found))

(defun unreached-cells-beside (map cell reached)
  "Return the cells beside CELL that are not in the table REACHED, and enter them there."
  (loop for next in (cells-beside map cell)
        unless (gethash next reached)
          do (setf (gethash next reached) t)
          and collect next))

(defun choose-passing-place (me)
  "Return a random one of the passing places near the robot of the reckoning ME, a point (x y), or
NIL. The way there does not lead through the cell ahead."
  (let* ((chart (reckoning-chart me))
         (start (nearest-free-point chart (reckon me)))
         (places (and start
                      (nearest-passing-places (chart-map chart)
                                              (cell-of-point (point-as-list start))
                                              (cell-of-point (point-ahead me .6))
                                              12))))
    (and places (middle-of (roll-element places (traffic-dice me))))))

;;; Giving way. While a robot gives way, its reckoning has a passing place, and its next step leads
;;; there instead of to its goal.

(defun present-goal (me goal)
  "Return the point to which the robot of the reckoning ME drives now: a passing place, or GOAL."
  (or (reckoning-passing-place me) goal))

(defun forget-passing-place (me)
  (setf (reckoning-passing-place me) '()))

(defun ticks-to-wait (me)
  "Return a random number of ticks to wait. It grows with the number of obstacles that the robot of
the reckoning ME has met since it last drove ten metres."
  (+ 2 (roll-index (min 60 (* 6 (reckoning-meetings me))) (traffic-dice me))))

(defun give-way (me)
  "The robot of the reckoning ME is blocked by a robot or a thing that the reckoning has noted.
Three times in four, make it give way. Return how many ticks to wait before the next step."
  (when (> (- (reckoning-driven me) (reckoning-met-at me)) 10)
    (setf (reckoning-meetings me) 0))
  (incf (reckoning-meetings me))
  (setf (reckoning-met-at me) (reckoning-driven me)
        (reckoning-passing-place me) (and (chance 3/4 (traffic-dice me)) (choose-passing-place me)))
  (if (reckoning-passing-place me) 0 (ticks-to-wait me)))

(defun ticks-at-passing-place (me)
  "If the robot of the reckoning ME has reached its passing place, end giving way, and return how
many ticks to wait there; else return NIL."
  (when (and (reckoning-passing-place me)
             (< (distance-left me (reckoning-passing-place me)) .7))
    (forget-passing-place me)
    (+ 5 (ticks-to-wait me))))
