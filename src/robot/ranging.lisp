;;;; ranging.lisp -- rangefinders, which measure distances (manual 1.2, which has none).

(in-package :ars-magna.robot)

(export '(measure-ranges rangefinder-last-pose))

;;; The beams are spread as the pixels of a camera are: each is in the middle of its share of the
;;; arc. A beam without an echo reads the maximum. What CAST-RAY returns is the truth; the errors
;;; come from the robot's dice and the parameters of the group "Rangefinders".

(addition rangefinder rangefinder-p)
(define-kind (rangefinder :include part)
    "A rangefinder: it measures the distances to the next obstacles, with BEAMS evenly spaced over
ARC radians around ANGLE, which is relative to the robot."
  (:fixed
   (beams 1 (integer 1 10000) "how many beams the rangefinder has" :addition)
   (arc 0d0 (double-float 0d0 6.283185308d0)
        "the width of what the beams cover, in radians, at most 2 pi" :addition)
   (angle 0d0 (double-float -1d9 1d9)
          "the direction of the middle of the arc relative to the robot, in radians" :addition)
   (maximum 10d0 (double-float 0.001d0 1d9) "the greatest distance that is measured, in metres"
            :addition))
  (:memory
   (last-ranges '() list "the last distances measured, in metres; () before the first"
                :shared :addition)
   (last-pose '() list "the position and heading of the robot then, a list (x y angle)" :shared)))

(define-argument-type 'rangefinder #'rangefinder-p
  "a rangefinder, as (robot-part ROBOT 'rangefinder 0) returns")

(addition rangefinder-beam-angles)
(defun rangefinder-beam-angles (rangefinder)
  "Return a list of the directions of the beams of RANGEFINDER, relative to the robot, in radians,
from left to right. Signals WRONG-ARGUMENT."
  (check-argument rangefinder-beam-angles rangefinder (rangefinder-p rangefinder)
                  (argument-type-text 'rangefinder))
  (let* ((beams (rangefinder-beams rangefinder))
         (spacing (/ (rangefinder-arc rangefinder) beams)))
    (loop for beam below beams
          collect (+ (rangefinder-angle rangefinder)
                     (* spacing (- beam (* 0.5d0 (1- beams))))))))

(defun noisy-range (distance maximum dice)
  "Return a reading of DISTANCE, in metres, or NIL for no obstacle up to MAXIMUM."
  (cond (no-sensor-error* (or distance maximum))
        ((chance range-outlier-prob* dice) (roll-between 0d0 maximum dice))
        ((or (null distance) (chance range-miss-prob* dice)) maximum)
        (t (clamp (* distance (+ 1d0 (roll-within (double range-noise*) dice))) 0d0 maximum))))

(defun measure-ranges (rangefinder)
  "Return a list of one distance for each beam of RANGEFINDER, from left to right, and store it as
RANGEFINDER-LAST-RANGES."
  (let* ((robot (part-robot rangefinder)) (dice (robot-dice robot :looking))
         (x (robot-x robot)) (y (robot-y robot)) (heading (robot-angle robot))
         (maximum (rangefinder-maximum rangefinder)))
    (setf (rangefinder-last-pose rangefinder) (list x y heading)
          (rangefinder-last-ranges rangefinder)
          (loop for angle in (rangefinder-beam-angles rangefinder)
                collect (noisy-range (cast-ray (robot-world robot) x y (+ heading angle) maximum)
                                     maximum dice)))))
