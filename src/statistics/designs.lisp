;;;; designs.lisp -- points in a cube, at which something that depends on several numbers is tried.

(in-package :ars-magna.statistics)

(export '(design-points))

;;; Each dimension has dice of its own: one more leaves the others as they are. More points of
;;; :RANDOM and :SOBOL begin with those that there were; those of a Latin hypercube are all others.

(defun latin-numbers (count dice)
  "Return COUNT numbers, one in each of as many equal parts of [0, 1), in an order by DICE."
  (let ((places (make-array count)))
    (dotimes (place count) (setf (aref places place) place))
    (loop for last from (1- count) above 0
          do (rotatef (aref places last) (aref places (roll-index (1+ last) dice))))
    (loop for place across places collect (/ (+ place (roll dice)) count))))

;; Shifted in all its bits by a word of the dice's, which leaves it as even as it was: without that
;; the first point would be a corner, whatever the seed.
(defun shifted-sobol-numbers (count dimension dice)
  (let ((shift (roll-index (ash 1 +sobol-bits+) dice)))
    (loop for number in (sobol-numbers count dimension)
          collect (float (/ (+ (logxor number shift) 1/2) (ash 1 +sobol-bits+)) 1d0))))

(defun design-points (kind count dimensions seed)
  "Return COUNT points in as many DIMENSIONS, at most +MOST-DIMENSIONS+ of :SOBOL: lists of numbers
from 0 to below 1, the same for the same SEED, an integer. KIND says how they are drawn. :RANDOM:
each number by itself. :LATIN-HYPERCUBE: in each dimension one in each of COUNT equal parts (McKay,
Beckman and Conover 1979). :SOBOL: by Sobol's sequence, shifted by SEED, which fills the cube most
evenly if COUNT is a power of two."
  (apply #'mapcar #'list
         (loop for dimension below dimensions
               for dice = (make-dice seed (format nil "~(~A~) ~D" kind dimension))
               collect (ecase kind
                         (:random (loop repeat count collect (roll dice)))
                         (:latin-hypercube (latin-numbers count dice))
                         (:sobol (shifted-sobol-numbers count dimension dice))))))
