;;;; sobol.lisp -- Sobol's sequence: points that fill a cube evenly, however many are taken.

(in-package :ars-magna.statistics)

(export '(+most-dimensions+))

;;; Each dimension has direction numbers V1, V2 ... of 32 bits, binary fractions. They follow from a
;;; primitive polynomial over two elements and from odd numbers to start with, by Bratley and Fox
;;; (Algorithm 659, 1988). The numbers are those of Joe and Kuo (SIAM J. Sci. Comput. 30, 2008). Of
;;; the first 2^K points each slice of width 1/2^K has one, in each dimension.

(define-constant +polynomials+
    '((0) (1 0 1) (2 1 1 3) (3 1 1 3 1) (3 2 1 1 1) (4 1 1 1 3 3) (4 4 1 3 5 13) (5 2 1 1 5 5 17)
      (5 4 1 1 5 5 5) (5 7 1 1 7 11 19) (5 11 1 1 5 1 1) (5 13 1 1 1 3 11) (5 14 1 3 5 5 31)
      (6 1 1 3 3 9 7 49) (6 13 1 1 1 15 21 21) (6 16 1 3 1 13 27 49) (6 19 1 1 1 15 7 5)
      (6 22 1 3 1 15 13 25) (6 25 1 1 5 5 19 61) (7 1 1 3 7 11 23 15 103))
  :test #'equal
  :documentation "For each dimension the degree of its polynomial, the inner coefficients of that
as a number, and the odd numbers to start with; the first dimension has none.")

(define-constant +most-dimensions+ 20
  :documentation "How many dimensions Sobol's sequence has here.")

(define-constant +sobol-bits+ 32)

(defun next-direction (directions degree coefficients)
  "Return the direction number that follows DIRECTIONS, the last first, of a polynomial of DEGREE."
  (let* ((oldest (nth (1- degree) directions))
         (number (logxor oldest (ash oldest (- degree)))))
    (loop for direction in directions
          for place from (- degree 2) downto 0
          when (logbitp place coefficients) do (setf number (logxor number direction)))
    number))

(defun direction-numbers (dimension)
  "Return the direction numbers of DIMENSION, from 0, a vector."
  (destructuring-bind (degree &optional coefficients &rest odds) (nth dimension +polynomials+)
    (let ((directions '()))
      (loop for place from 1 to +sobol-bits+
            do (push (cond ((zerop degree) (ash 1 (- +sobol-bits+ place)))
                           ((<= place degree) (ash (pop odds) (- +sobol-bits+ place)))
                           (t (next-direction directions degree coefficients)))
                     directions))
      (coerce (reverse directions) 'simple-vector))))

(defun sobol-numbers (count dimension)
  "Return the first COUNT numbers of Sobol's sequence in DIMENSION, in the order of Gray's code:
integers below 2^32."
  (loop with directions = (direction-numbers dimension) and number = 0
        for index from 1 to count
        collect number
        do (setf number (logxor number (svref directions (1- (integer-length
                                                              (logand index (- index)))))))))
