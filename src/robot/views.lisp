;;;; views.lisp -- the substances that a camera sees (manual 2.2, 3.3, 3.4.3).

(in-package :ars-magna.robot)

(export '(take-view))

;;; Each pixel is the parameter of the surface that its ray meets: of a wall, of the largest thing
;;; that obstructs vision in the first cell that has one, or 0 where the map ends. Things on the
;;; way that do not obstruct vision, but have a substance, corrupt it: the pixel is the mean of them
;;; all. What lies in the robot's own cell does not count. From inside, all there is to see is the
;;; container.

(defun obstructing-thing (index world)
  "Return the largest of the things in the cell INDEX of WORLD that obstructs vision, the first of
equals, or NIL (reading 240)."
  (let ((best nil))
    (do-cell (thing index world)
      (when (and (thing-obsview-p thing)
                 (or (null best) (> (thing-size thing) (thing-size best))))
        (setf best thing)))
    best))

(defun true-pixel (world x y dx dy)
  "Return what a ray from (X,Y) in direction DX, DY sees, without noise (reading 65)."
  (let ((sum 0d0) (count 1) (last 0d0))
    (flet ((visit (index flag)
             (cond ((zerop flag) nil)
                   ((logtest flag +wall+)
                    (setf last (aref (map-parameters (world-map world)) index)))
                   ((logtest flag +obsview+)
                    (setf last (thing-substance-parameter
                                (obstructing-thing index world))))
                   (t (do-cell (thing index world)
                        (when (thing-substance-p thing)
                          (incf sum (thing-substance-parameter thing))
                          (incf count)))
                      nil))))
      (walk-ray #'visit world x y dx dy))
    (/ (+ sum last) count)))

(defun noisy-pixel (value map dice)
  "Return a reading of VALUE: uniform within PIXEL-ERROR-RANGE* of it, or now and then anything
from the least to the greatest parameter of the walls of MAP (reading 147)."
  (cond (no-sensor-error* value)
        ((chance pixel-outlier-prob* dice)
         (roll-between (map-least-parameter map) (map-greatest-parameter map) dice))
        (t (+ value (roll-within (double pixel-error-range*) dice)))))

(defun open-view (camera)
  (let* ((robot (camera-robot camera)) (world (robot-world robot)) (pixels '()))
    (do-fan (dx dy) ((camera-heading camera)
                     (camera-field-of-view camera)
                     (camera-resolution camera))
      (push (true-pixel world (robot-x robot) (robot-y robot) dx dy) pixels))
    (nreverse pixels)))

;; As reading 148 says.
(defun inside-view (camera)
  (let ((location (camera-location camera)))
    (make-list (camera-resolution camera)
               :initial-element (if (thing-p location)
                                    (thing-substance-parameter location)
                                    0d0))))

(defun take-view (camera)
  "Let CAMERA take a view: return a list of as many numbers as it has pixels, from left to right,
and remember it as CAMERA-LAST-VIEW (manual 3.4.3)."
  (let* ((world (robot-world (camera-robot camera)))
         (map (world-map world)) (dice (world-dice world :looking)))
    (setf (camera-last-view-tick camera) (world-tick world)
          (camera-last-view camera)
          (loop for value in (if (camera-location camera) (inside-view camera) (open-view camera))
                collect (noisy-pixel value map dice)))))
