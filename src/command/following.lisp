;;;; following.lisp -- driving along a wall.

(in-package :ars-magna.command)

;;; The manual only mentions that robots can do this (appendix C); what it means is ours. The wall
;;; is the one in the nearest of the four cells around the robot's that are walls; those to the
;;; side win over the one ahead. The robot keeps it on the side where it was.

(defun axis (angle)
  "Return the heading along the grid's axes that is nearest to ANGLE, as a number of quarter turns
from 0 to 3."
  (mod (round (/ angle (/ pi 2))) 4))

(defun neighbour-wall-p (robot quarter)
  "True if the cell next to ROBOT's, QUARTER turns from the x axis, is a wall."
  (destructuring-bind (dx . dy) (svref #((1 . 0) (0 . 1) (-1 . 0) (0 . -1)) (mod quarter 4))
    (wall-at-p (world-map (robot-world robot)) (+ (robot-x robot) dx) (+ (robot-y robot) dy))))

(defun distance-to-side (robot quarter)
  "Return how far ROBOT is from the side of its cell that is QUARTER turns from the x axis."
  (let ((x (mod (robot-x robot) 1d0)) (y (mod (robot-y robot) 1d0)))
    (ecase (mod quarter 4) (0 (- 1 x)) (1 (- 1 y)) (2 x) (3 y))))

(defun wall-to-follow (robot)
  "Return the side of ROBOT, in quarter turns, where a wall is to be followed, and the heading
along it; NIL if no wall is near."
  (let* ((heading (axis (robot-angle robot)))
         (sides (remove-if-not (lambda (quarter) (neighbour-wall-p robot quarter))
                               (list (1+ heading) (1- heading))))
         (side (first (sort sides #'< :key (lambda (quarter) (distance-to-side robot quarter))))))
    (cond (side (values side heading))
          ;; Ahead of the robot: turn right, so that it comes to lie at the left.
          ((neighbour-wall-p robot heading) (values heading (1+ heading))))))

(defun steer (robot heading)
  "Turn ROBOT, by no more than a tick's turn, towards the HEADING in quarter turns. True if it
then looks there, but for the error of turning."
  (let* ((left (angle-difference (* heading (/ pi 2)) (robot-angle robot)))
         (close (< (abs left) 1d-3)))
    (or close
        (< (abs (turn-step robot left)) +facing+))))

(defun drive-along (operation robot side)
  "Drive ROBOT for a tick along the wall at SIDE, and end OPERATION where that ends."
  (ecase (drive-tick robot)
    (:wall (succeed operation))
    (:thing (fail-with operation :robot-blocked))
    ((nil) (if (neighbour-wall-p robot side)
               (once-more operation)
               (succeed operation)))))

(define-step follow-on (operation (and (robot-p (operation-resource operation))
                                       (typep (operation-subject operation)
                                              '(cons integer (cons integer null)))))
  "Follow the wall of OPERATION, whose subject is its side and the heading along it, for a tick."
  (let ((robot (operation-resource operation)))
    (destructuring-bind (side heading) (operation-subject operation)
      (cond ((not (steer robot heading)) (once-more operation))
            ((standing-p robot) (fail-with operation :not-moving))
            (t (drive-along operation robot side))))))

;; As reading 107 says.
(define-command robot-follow-wall (operation (robot robot))
    ()
    ((:family :moving) (:section "C") (:delay robot-move-delay*)
     (:traits :drives) (:expected :robot-blocked)
     (:errors (:robot-blocked "Robot is blocked by something that is no wall")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot is at the end of the wall"))
    "Drive ROBOT along the nearest wall next to it until the wall ends or a corner is reached.
Without a wall next to it, it succeeds at once."
  (begin-movement robot)
  (let ((way (multiple-value-list (wall-to-follow robot))))
    (setf (operation-subject operation) way)
    (if (first way)
        (go-on-now operation 'follow-on)
        (succeed operation))))
