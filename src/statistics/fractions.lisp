;;;; fractions.lisp -- the two expansions that the special functions rest on.

(in-package :ars-magna.statistics)

(declaim (inline continued-fraction))
(defun continued-fraction (terms)
  "Return 1 + a1/(b1 + a2/(b2 + ...)), where the function TERMS returns a and b of a number k
(Lentz's method as in Thompson and Barnett 1986)."
  (loop with value of-type double-float = 1d0
        with up of-type double-float = 1d0
        with down of-type double-float = 0d0
        for k of-type (unsigned-byte 40) from 1
        do (multiple-value-bind (a b) (funcall terms k)
             (declare (type double-float a b))
             (setf down (/ (+ b (* a down)))
                   up (+ b (/ a up))))
           (let ((change (* up down)))
             (setf value (* value change))
             (when (< (abs (- change 1)) 1d-15)
               (return value)))))

(defun arctangent-rest (w)
  "Return artanh(W)/W - 1 = W^2/3 + W^4/5 + ..., to the last digits; quick for W up to 1/2."
  (declare (type double-float w) #.*hot*)
  (loop with square of-type double-float = (* w w)
        for power of-type double-float = square then (* power square)
        for divisor of-type double-float = 3d0 then (+ divisor 2)
        for old of-type double-float = 0d0 then sum
        for sum of-type double-float = (/ power divisor) then (+ sum (/ power divisor))
        until (= sum old)
        finally (return sum)))

;;; Factorials never stand alone here but in the probabilities of counts, where most of one cancels
;;; against powers. So log-gamma is not formed, which would leave a 1e-9 of such a probability
;;; uncertain when counts are a million; only its distance from Stirling's formula is, and how far a
;;; count is from its expectation. Both are small and exact (Loader 2000, "Fast and accurate
;;; computation of binomial probabilities").

(defun stirling-rest (x)
  "Return log gamma(X+1) less Stirling's formula, (X+1/2) log X - X + log sqrt(2 pi), for X from
1/2: by DLMF 5.11.1, or Gudermann's steps of 1845 up to where that holds."
  (declare (type double-float x) #.*hot*)
  (let ((rest 0d0))
    (declare (type double-float rest))
    (loop while (< x 16)
          do (incf rest (the double-float (arctangent-rest (/ (+ (* 2 x) 1)))))
             (incf x))
    (let ((y (/ (* x x))))
      (+ rest (/ (- 1/12 (* y (- 1/360 (* y (- 1/1260 (* y (- 1/1680 (* y 1/1188)))))))) x)))))

(defun deviance (x mean)
  "Return X log(X/MEAN) + MEAN - X, which is not below 0, without loss where X is near MEAN (Loader
2000)."
  (declare (type double-float x mean))
  (let ((v (/ (- x mean) (+ x mean))))
    (cond ((< (abs v) .3d0) (+ (* v (- x mean)) (* 2 x v (arctangent-rest v))))
          ((zerop x) mean)
          (t (+ (* x (logarithm (/ x mean))) (- mean x))))))
