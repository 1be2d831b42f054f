;;;; gamma.lisp -- the incomplete gamma function, and chi-square by it.

(in-package :ars-magna.statistics)

(defun poisson-density (a x)
  "Return X^A e^-X / gamma(A+1), for A from 1/2 and X above 0."
  (declare (type double-float a x))
  (/ (exponential (- (+ (stirling-rest a) (deviance a x)))) (sqrt (* 2 pi a))))

(defun gamma-series (a x)
  "Return 1 + X/(A+1) + X^2/((A+1)(A+2)) + ... (DLMF 8.11.4)."
  (declare (type double-float a x) #.*hot*)
  (loop for k of-type double-float = (+ a 1) then (+ k 1)
        for part of-type double-float = (/ x k) then (* part (/ x k))
        for old of-type double-float = 1d0 then sum
        for sum of-type double-float = (+ 1 part) then (+ sum part)
        until (= sum old)
        finally (return sum)))

(defun gamma-fraction (a x)
  "Return the upper incomplete gamma function of A and X, divided by X^A e^-X (DLMF 8.9.2, its even
part)."
  (declare (type double-float a x) #.*hot*)
  (let ((first (+ x (- 1 a))))
    (/ (* first
          (continued-fraction
           (lambda (k)
             (let* ((k (double k)) (numerator (* k (- a k))))
               (values (if (= k 1) (/ numerator first) numerator)
                       (+ first (* 2 k))))))))))

(defun upper-gamma (a x)
  "Return Q(A, X), the regularised upper incomplete gamma function, for A from 1/2 and X from 0."
  (declare (type double-float a x))
  (cond ((zerop x) 1d0)
        ((< x (+ a 1)) (- 1 (* (poisson-density a x) (gamma-series a x))))
        (t (* a (poisson-density a x) (gamma-fraction a x)))))

(defun chi-square-tail (x freedom)
  "Return the probability that chi-square of FREEDOM degrees, 1 or more, is above X, 0 or more
(Abramowitz and Stegun 26.4.19)."
  (upper-gamma (/ (double freedom) 2) (/ (double x) 2)))
