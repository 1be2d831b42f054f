;;;; planned-way.lisp -- the way that a robot's program is about to take, for people to see.

(in-package :ars-magna.robot)

(export '(robot-way-left))

;;; A robot is given one command after the other; where these are to lead only the program knows
;;; that gives them. What it says of that decides nothing: it is no part of a run's digest, and a
;;; journal does not have it. But it belongs to the run, so that forks have it, too.

(defstruct (planned-way (:constructor make-planned-way (points interruption)) (:copier nil))
  "POINTS, a list of lists (x y), and what had last been INTERRUPTED on the robot when they were
published: if that is something else now, the robot has been taken off its way."
  (points '() :type list :read-only t)
  (interruption nil :read-only t))

(define-shared planned-way)

(defun way-point-p (point)
  (or (pt-p point) (number-pair-p point)))

(defun way-point (point)
  "Return the coordinates of POINT, a PT or a list (x y), as a list."
  (if (pt-p point)
      (list (pt-x point) (pt-y point))
      (list (double (first point)) (double (second point)))))

(addition publish-way)
(defun publish-way (robot points)
  "Let pictures show, in the layer :PLANNED-WAY, that ROBOT is about to go from one of POINTS to the
next: a list of PTs or lists (x y), as FIND-WAY returns it; () says that it is on no way any more.
It holds until something else is published, or a command of the robot is interrupted. ROBOT-GO-TO
and TRAVEL-TO do this; programs of one's own may. Nothing else comes of it: ROBOT goes nowhere, and
digests and journals stay what they are. Return ROBOT. Signals WRONG-ARGUMENT."
  (check-argument publish-way robot (robot-p robot) (argument-type-text 'robot robot))
  (check-argument publish-way points (and (proper-list-p points) (every #'way-point-p points))
                  "a list of PTs, or of lists (x y)")
  (setf (robot-published-way robot)
        (and points (make-planned-way (mapcar #'way-point points) (resource-interruption robot))))
  robot)

(addition robot-planned-way)
(defun robot-planned-way (robot)
  "Return the points, lists (x y), of the way that ROBOT is about to take as its program has told by
PUBLISH-WAY; () if it is on none, or was taken off it."
  (let ((way (robot-published-way robot)))
    (and way
         (eq (planned-way-interruption way) (resource-interruption robot))
         (planned-way-points way))))

;;; What is left of it.

(defun foot-on (from to x y)
  "Return the point, a list, of the line between the points FROM and TO that is nearest to X, Y, and
how far that is."
  (destructuring-bind (x1 y1 x2 y2) (append from to)
    (let* ((dx (- x2 x1)) (dy (- y2 y1))
           (square (+ (* dx dx) (* dy dy)))
           (part (if (zerop square)
                     0
                     (clamp (/ (+ (* (- x x1) dx) (* (- y y1) dy)) square) 0 1)))
           (foot (list (+ x1 (* part dx)) (+ y1 (* part dy)))))
      (values foot (abs (complex (- x (first foot)) (- y (second foot))))))))

(defun left-of-way (points x y)
  "Return what is left of the way through POINTS for somebody at X, Y: from where it is nearest."
  (let ((least nil) (left points))
    (loop for (from . after) on points
          while after
          do (multiple-value-bind (foot distance) (foot-on from (first after) x y)
               (when (or (null least) (<= distance least))
                 (setf least distance
                       left (cons foot after)))))
    left))

(defun robot-way-left (robot)
  "Return the points, lists (x y), of what is left of the planned way of ROBOT from where it is."
  (left-of-way (robot-planned-way robot) (robot-x robot) (robot-y robot)))
