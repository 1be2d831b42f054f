;;;; normal.lisp -- the normal distribution and its quantiles.

(in-package :ars-magna.statistics)

(defun normal-probability (z)
  "Return the probability that a standard normal number is below Z (DLMF 7.11.2)."
  (declare (type double-float z))
  (let ((half (/ (* z z) 2)))
    (if (minusp z)
        (/ (upper-gamma .5d0 half) 2)
        (- 1 (/ (upper-gamma .5d0 half) 2)))))

(defmacro ratio-of-polynomials (x above below)
  "Return the ratio of the polynomials of X with the coefficients ABOVE and BELOW, of X^0 first."
  (flet ((horner (coefficients)
           (reduce (lambda (coefficient form) `(+ ,coefficient (* ,x ,form)))
                   coefficients :from-end t)))
    `(/ ,(horner above) ,(horner below))))

(declaim (inline middle-quantile near-tail-quantile far-tail-quantile))
(defun middle-quantile (q)
  (declare (type double-float q))
  (let ((r (- .180625d0 (* q q))))
    (* q (ratio-of-polynomials r
           (3.3871328727963666080d0 1.3314166789178437745d2 1.9715909503065514427d3
            1.3731693765509461125d4 4.5921953931549871457d4 6.7265770927008700853d4
            3.3430575583588128105d4 2.5090809287301226727d3)
           (1d0 4.2313330701600911252d1 6.8718700749205790830d2 5.3941960214247511077d3
            2.1213794301586595867d4 3.9307895800092710610d4 2.8729085735721942674d4
            5.2264952788528545610d3)))))

(defun near-tail-quantile (r)
  (declare (type double-float r))
  (ratio-of-polynomials r
    (1.42343711074968357734d0 4.63033784615654529590d0 5.76949722146069140550d0
     3.64784832476320460504d0 1.27045825245236838258d0 2.41780725177450611770d-1
     2.27238449892691845833d-2 7.74545014278341407640d-4)
    (1d0 2.05319162663775882187d0 1.67638483018380384940d0 6.89767334985100004550d-1
     1.48103976427480074590d-1 1.51986665636164571966d-2 5.47593808499534494600d-4
     1.05075007164441684324d-9)))

(defun far-tail-quantile (r)
  (declare (type double-float r))
  (ratio-of-polynomials r
    (6.65790464350110377720d0 5.46378491116411436990d0 1.78482653991729133580d0
     2.96560571828504891230d-1 2.65321895265761230930d-2 1.24266094738807843860d-3
     2.71155556874348757815d-5 2.01033439929228813265d-7)
    (1d0 5.99832206555887937690d-1 1.36929880922735805310d-1 1.48753612908506148525d-2
     7.86869131145613259100d-4 1.84631831751005468180d-5 1.42151175831644588870d-7
     2.04426310338993978564d-15)))

(defun normal-quantile (p)
  "Return the number that a standard normal one is below with the probability P, between 0 and 1
(the rational functions of Wichura 1988, algorithm AS 241, good to 1e-16)."
  (declare (type double-float p) #.*hot*)
  (let ((q (- p .5d0)))
    (if (<= (abs q) .425d0)
        (middle-quantile q)
        (let* ((tail (if (minusp q) p (- 1 p)))
               (r (sqrt (- (logarithm (the (double-float (0d0)) tail)))))
               (size (if (<= r 5) (near-tail-quantile (- r 1.6d0)) (far-tail-quantile (- r 5)))))
          (declare (type (double-float 0d0) r))
          (if (minusp q) (- size) size)))))

(defun normal-reach (confidence)
  "Return how many deviations either way hold a share CONFIDENCE of all normal numbers."
  (declare (type double-float confidence))
  (- (normal-quantile (/ (- 1 confidence) 2))))
