;;;; reach.lisp -- what is local to a robot, and what it has arrived at (manual 2.1, 3.4.1, 3.5).

(in-package :ars-magna.robot)

(export '(within-reach-p in-same-cell-p reached-p))

;;; Searches, tracks, hands and approaches share one idea of what is next to a robot, that of
;;; WITHIN-REACH-P. A cell that blocks robots cannot be entered, so all that is in it counts as next
;;; to a robot that stands at the cell. What a robot has arrived at is always within its reach.

(define-constant +contact+ (* 1.001d0 +contact-gap+)
  :documentation "No farther than this from a cell, in metres, a robot stands at it: the gap, and
what rounding adds to it.")
(define-constant +farthest-reach+ 1.001d0
  :documentation "No robot reaches farther than this along an axis, in metres.")

(defun in-same-cell-p (robot x y)
  "True if (X,Y), in metres, is in the cell of ROBOT."
  (and (= (floor x) (floor (robot-x robot)))
       (= (floor y) (floor (robot-y robot)))))

(defun at-cell-p (robot x y)
  "True if ROBOT stands in the cell of (X,Y), or no farther from it than the contact gap."
  (flet ((gap (position start)
           (max (- start position) (- position (1+ start)))))
    (and (<= (gap (robot-x robot) (floor x)) +contact+)
         (<= (gap (robot-y robot) (floor y)) +contact+))))

(defun within-reach-p (robot x y)
  "True if (X,Y), in metres, is local to ROBOT: less than a metre away, or in the same cell, or in a
cell that blocks ROBOT and that it stands at (reading 108)."
  (let ((dx (- (double x) (robot-x robot))) (dy (- (double y) (robot-y robot))))
    (declare (type double-float dx dy))
    (and (<= (abs dx) +farthest-reach+)
         (<= (abs dy) +farthest-reach+)
         (or (< (+ (* dx dx) (* dy dy)) 1d0)
             (in-same-cell-p robot x y)
             (and (at-cell-p robot x y)
                  (closed-cell-p (robot-world robot) x y +blocking+))))))

(defun reached-p (robot x y last-step block)
  "True if ROBOT, which has just driven for a tick, has thereby arrived at (X,Y). LAST-STEP is true
if it could come that far in the tick; BLOCK, if something blocked it. Nothing may hide what is
there (reading 108)."
  (or (in-same-cell-p robot x y)
      (and (within-reach-p robot x y)
           (or last-step
               (and block (at-cell-p robot x y)))
           (in-sight-p (robot-world robot) (robot-x robot) (robot-y robot) (double x) (double y)))))
