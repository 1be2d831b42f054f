;;;; designs.lisp -- points in a unit cube, for experiments with many factors.

(in-package :ars-magna.statistics)

(export '(+most-dimensions+ design-points))

;;; Each dimension has direction numbers V1, V2 ... of 32 bits, binary fractions. They follow from a
;;; primitive polynomial over GF(2) and initial odd numbers, by Bratley and Fox (Algorithm 659,
;;; 1988). The numbers are those of Joe and Kuo (SIAM J. Sci. Comput. 30, 2008). Of the first 2^K
;;; points each slice of width 1/2^K has one, in each dimension.

(define-constant +polynomials+
    '((0) (1 0 1) (2 1 1 3) (3 1 1 3 1) (3 2 1 1 1) (4 1 1 1 3 3) (4 4 1 3 5 13) (5 2 1 1 5 5 17)
      (5 4 1 1 5 5 5) (5 7 1 1 7 11 19) (5 11 1 1 5 1 1) (5 13 1 1 1 3 11) (5 14 1 3 5 5 31)
      (6 1 1 3 3 9 7 49) (6 13 1 1 1 15 21 21) (6 16 1 3 1 13 27 49) (6 19 1 1 1 15 7 5)
      (6 22 1 3 1 15 13 25) (6 25 1 1 5 5 19 61) (7 1 1 3 7 11 23 15 103))
  :test #'equal
  :documentation "A list (degree coefficients number...) for each dimension of Sobol's sequence: the
degree of its primitive polynomial, the inner coefficients as a binary number, and the initial odd
numbers. The first dimension has no polynomial.")

(define-constant +most-dimensions+ 20
  :documentation "The largest number of dimensions of Sobol's sequence.")

(define-constant +sobol-bits+ 32)

(defun next-direction-number (directions degree coefficients)
  "Return the direction number that follows DIRECTIONS, a list with the last one first, for a
polynomial with DEGREE and COEFFICIENTS."
  (let* ((oldest (nth (1- degree) directions))
         (number (logxor oldest (ash oldest (- degree)))))
    (loop for direction in directions
          for place from (- degree 2) downto 0
          when (logbitp place coefficients) do (setf number (logxor number direction)))
    number))

(defun direction-numbers (dimension)
  "Return the vector of the direction numbers of DIMENSION, which counts from 0."
  (destructuring-bind (degree &optional coefficients &rest odds) (nth dimension +polynomials+)
    (let ((directions '()))
      (loop for place from 1 to +sobol-bits+
            do (push (cond ((zerop degree) (ash 1 (- +sobol-bits+ place)))
                           ((<= place degree) (ash (pop odds) (- +sobol-bits+ place)))
                           (t (next-direction-number directions degree coefficients)))
                     directions))
      (coerce (reverse directions) 'simple-vector))))

(defun sobol-numbers (count dimension)
  "Return the first COUNT Sobol numbers in DIMENSION, in Gray code order, as integers below 2^32."
  (loop with directions = (direction-numbers dimension) and number = 0
        for index from 1 to count
        collect number
        do (setf number (logxor number (svref directions (1- (integer-length
                                                              (logand index (- index)))))))))

;;;; Designs

;;; Each dimension has its own dice, so another dimension does not change the others. A larger
;;; :RANDOM or :SOBOL design begins with the points of a smaller one; a Latin hypercube does not.

(defun latin-hypercube-numbers (count dice)
  "Return COUNT numbers from DICE, one in each of COUNT equal parts of [0, 1), in random order."
  (let ((places (make-array count)))
    (dotimes (place count) (setf (aref places place) place))
    (loop for last from (1- count) above 0
          do (rotatef (aref places last) (aref places (roll-index (1+ last) dice))))
    (loop for place across places collect (/ (+ place (roll dice)) count))))

;; A random digital shift keeps the points as even. Without it the first would always be a corner.
(defun shifted-sobol-numbers (count dimension dice)
  (let ((shift (roll-index (ash 1 +sobol-bits+) dice)))
    (loop for number in (sobol-numbers count dimension)
          collect (float (/ (+ (logxor number shift) 1/2) (ash 1 +sobol-bits+)) 1d0))))

(defun design-points (kind count dimensions seed)
  "Return COUNT points in DIMENSIONS dimensions, lists of numbers from 0 to below 1. The points are
the same for the same SEED, an integer. KIND is :RANDOM for independent numbers; :LATIN-HYPERCUBE
for one number in each of COUNT equal parts of each dimension (McKay, Beckman and Conover 1979); or
:SOBOL for Sobol's sequence, shifted by SEED, which fills the cube most evenly if COUNT is a power
of two. :SOBOL has at most +MOST-DIMENSIONS+ dimensions."
  (apply #'mapcar #'list
         (loop for dimension below dimensions
               for dice = (make-dice seed (format nil "~(~A~) ~D" kind dimension))
               collect (ecase kind
                         (:random (loop repeat count collect (roll dice)))
                         (:latin-hypercube (latin-hypercube-numbers count dice))
                         (:sobol (shifted-sobol-numbers count dimension dice))))))
