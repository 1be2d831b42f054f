;;;; distributions.lisp -- the gamma, normal, beta and Student distributions.

(in-package :ars-magna.statistics)

(declaim (inline continued-fraction))
(defun continued-fraction (terms)
  "Return the continued fraction 1 + a1/(b1 + a2/(b2 + ...)). The function TERMS returns ak and bk
for k (Lentz's method as in Thompson and Barnett 1986)."
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

(defun artanh-remainder (w)
  "Return artanh(W)/W - 1 = W^2/3 + W^4/5 + ..., to full precision; fast for W up to 1/2."
  (declare (type double-float w) #.*hot*)
  (loop with square of-type double-float = (* w w)
        for power of-type double-float = square then (* power square)
        for divisor of-type double-float = 3d0 then (+ divisor 2)
        for old of-type double-float = 0d0 then sum
        for sum of-type double-float = (/ power divisor) then (+ sum (/ power divisor))
        until (= sum old)
        finally (return sum)))

;;; Factorials occur only in probabilities of counts, where most cancels against powers. Log-gamma
;;; is not computed: for counts of a million, its relative error would be 1e-9. Only its difference
;;; from Stirling's formula is computed, and a count's deviance from its expectation. Both are small
;;; and exact (Loader 2000, "Fast and accurate computation of binomial probabilities").

(defun stirling-error (x)
  "Return the error of Stirling's formula, log gamma(X+1) - ((X+1/2) log X - X + log sqrt(2 pi)),
for X from 1/2. From 16 on this is DLMF 5.11.1; below 16, the recurrence of Gudermann (1845)."
  (declare (type double-float x) #.*hot*)
  (let ((rest 0d0))
    (declare (type double-float rest))
    (loop while (< x 16)
          do (incf rest (the double-float (artanh-remainder (/ (+ (* 2 x) 1)))))
             (incf x))
    (let ((y (/ (* x x))))
      (+ rest (/ (- 1/12 (* y (- 1/360 (* y (- 1/1260 (* y (- 1/1680 (* y 1/1188)))))))) x)))))

(defun deviance (x mean)
  "Return X log(X/MEAN) + MEAN - X, never negative, without loss of digits near MEAN (Loader 2000)."
  (declare (type double-float x mean))
  (let ((v (/ (- x mean) (+ x mean))))
    (cond ((< (abs v) .3d0) (+ (* v (- x mean)) (* 2 x v (artanh-remainder v))))
          ((zerop x) mean)
          (t (+ (* x (logarithm (/ x mean))) (- mean x))))))

;;;; Gamma and chi-square

(defun poisson-density (a x)
  "Return X^A e^-X / gamma(A+1), for A from 1/2 and X above 0."
  (declare (type double-float a x))
  (/ (exponential (- (+ (stirling-error a) (deviance a x)))) (sqrt (* 2 pi a))))

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
  "Return the upper incomplete gamma function of A and X, divided by X^A e^-X, by a continued
fraction (the even part of DLMF 8.9.2)."
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
  "Return the probability that a chi-square variable with FREEDOM degrees of freedom is above X.
FREEDOM is at least 1, and X at least 0 (Abramowitz and Stegun 26.4.19)."
  (upper-gamma (/ (double freedom) 2) (/ (double x) 2)))

;;;; The normal distribution

(defun normal-cdf (z)
  "Return the probability that a standard normal variable is below Z (DLMF 7.11.2)."
  (declare (type double-float z))
  (let ((half (/ (* z z) 2)))
    (if (minusp z)
        (/ (upper-gamma .5d0 half) 2)
        (- 1 (/ (upper-gamma .5d0 half) 2)))))

(defmacro ratio-of-polynomials (x above below)
  "Return the ratio of two polynomials of X. ABOVE and BELOW are their coefficients, from X^0 on."
  (flet ((horner (coefficients)
           (reduce (lambda (coefficient form) `(+ ,coefficient (* ,x ,form)))
                   coefficients :from-end t)))
    `(/ ,(horner above) ,(horner below))))

(declaim (inline normal-middle-quantile normal-near-tail-quantile normal-far-tail-quantile))
(defun normal-middle-quantile (q)
  (declare (type double-float q))
  (let ((r (- .180625d0 (* q q))))
    (* q (ratio-of-polynomials r
           (3.3871328727963666080d0 1.3314166789178437745d2 1.9715909503065514427d3
            1.3731693765509461125d4 4.5921953931549871457d4 6.7265770927008700853d4
            3.3430575583588128105d4 2.5090809287301226727d3)
           (1d0 4.2313330701600911252d1 6.8718700749205790830d2 5.3941960214247511077d3
            2.1213794301586595867d4 3.9307895800092710610d4 2.8729085735721942674d4
            5.2264952788528545610d3)))))

(defun normal-near-tail-quantile (r)
  (declare (type double-float r))
  (ratio-of-polynomials r
    (1.42343711074968357734d0 4.63033784615654529590d0 5.76949722146069140550d0
     3.64784832476320460504d0 1.27045825245236838258d0 2.41780725177450611770d-1
     2.27238449892691845833d-2 7.74545014278341407640d-4)
    (1d0 2.05319162663775882187d0 1.67638483018380384940d0 6.89767334985100004550d-1
     1.48103976427480074590d-1 1.51986665636164571966d-2 5.47593808499534494600d-4
     1.05075007164441684324d-9)))

(defun normal-far-tail-quantile (r)
  (declare (type double-float r))
  (ratio-of-polynomials r
    (6.65790464350110377720d0 5.46378491116411436990d0 1.78482653991729133580d0
     2.96560571828504891230d-1 2.65321895265761230930d-2 1.24266094738807843860d-3
     2.71155556874348757815d-5 2.01033439929228813265d-7)
    (1d0 5.99832206555887937690d-1 1.36929880922735805310d-1 1.48753612908506148525d-2
     7.86869131145613259100d-4 1.84631831751005468180d-5 1.42151175831644588870d-7
     2.04426310338993978564d-15)))

(defun normal-quantile (p)
  "Return the quantile for the probability P, between 0 and 1, of the standard normal distribution
(the rational functions of Wichura 1988, algorithm AS 241, exact to 1e-16)."
  (declare (type double-float p) #.*hot*)
  (let ((q (- p .5d0)))
    (if (<= (abs q) .425d0)
        (normal-middle-quantile q)
        (let* ((tail (if (minusp q) p (- 1 p)))
               (r (sqrt (- (logarithm (the (double-float (0d0)) tail)))))
               (size (if (<= r 5) (normal-near-tail-quantile (- r 1.6d0))
                             (normal-far-tail-quantile (- r 5)))))
          (declare (type (double-float 0d0) r))
          (if (minusp q) (- size) size)))))

(defun normal-critical-value (confidence)
  "Return the z for which a standard normal variable is in [-z, z] with the probability CONFIDENCE."
  (declare (type double-float confidence))
  (- (normal-quantile (/ (- 1 confidence) 2))))

;;;; Beta: probabilities of counts, and Student's t

;;; Some functions take both X and Y = 1 - X, so that neither loses digits near 1.

(defun log-complement-power (y x exponent)
  "Return EXPONENT times the logarithm of Y, where X = 1 - Y."
  (declare (type double-float y x exponent))
  (if (< x .1d0)
      (- (+ (deviance exponent (* exponent y)) (* exponent x)))
      (* exponent (logarithm y))))

(defun log-binomial-density (a b x y)
  "Return the logarithm of gamma(A+B+1) / (gamma(A+1) gamma(B+1)) X^A Y^B (Loader 2000). For
integers, this is the log probability of A successes and B failures. A and B are 0 or at least 1/2."
  (declare (type double-float a b x y))
  (let ((n (+ a b)))
    (cond ((zerop n) 0d0)
          ((zerop a) (log-complement-power y x b))
          ((zerop b) (log-complement-power x y a))
          (t (+ (- (stirling-error n) (stirling-error a) (stirling-error b)
                   (deviance a (* n x)) (deviance b (* n y)))
                (/ (logarithm (/ n (* 2 pi a b))) 2))))))

(defun log-beta-prefactor (a b x y)
  (declare (type double-float a b x y))
  (+ (log-binomial-density a b x y) (logarithm (/ (* a b) (+ a b)))))

(defun beta-fraction (a b x y)
  "Return I_X(A, B), the regularised incomplete beta function, divided by X^A Y^B / beta(A, B), for
X up to about A/(A+B) (Didonato and Morris 1992: a continued fraction with positive terms)."
  (declare (type double-float a b x y) #.*hot*)
  (flet ((lower-part (m)
           (declare (type double-float m))
           (let ((c (+ a m m)))
             (+ m
                (/ (* m (- b m) x) (- c 1))
                (/ (* (+ a m) (+ (- (* a y) (* b x)) 1 (* m (+ 1 y)))) (+ c 1))))))
    (declare (inline lower-part))
    (let ((first (/ (* a (+ (- (* a y) (* b x)) 1)) (+ a 1))))
      (/ (* first
            (continued-fraction
             (lambda (k)
               (let* ((m (double k)) (c (+ a m m -1))
                      (upper-part (/ (* (+ a m -1) (+ a b m -1) m (- b m) x x) (* c c))))
                 (values (if (= m 1) (/ upper-part first) upper-part)
                         (lower-part m))))))))))

(defun incomplete-beta (a b x y)
  "Return I_X(A, B), the regularised incomplete beta function, for A and B from 1/2 and Y = 1 - X."
  (declare (type double-float a b x y))
  (cond ((zerop x) 0d0)
        ((zerop y) 1d0)
        ((<= (* b x) (* a y))
         (* (exponential (log-beta-prefactor a b x y)) (beta-fraction a b x y)))
        (t (- 1 (* (exponential (log-beta-prefactor b a y x)) (beta-fraction b a y x))))))

(defun beta-quantile (p a b)
  "Return two values: the X for which INCOMPLETE-BETA I_X(A, B) is P, between 0 and 1; and 1 - X."
  (declare (type double-float p a b))
  (if (> p .5d0)
      (multiple-value-bind (y x) (beta-quantile-up-to-half (- 1 p) b a) (values x y))
      (beta-quantile-up-to-half p a b)))

;;; As a function of the log odds of X, the logarithm of I_X is concave, and near log(1/2) where the
;;; odds are A : B. So Newton's method converges from there, for P up to 1/2.

(defun beta-quantile-up-to-half (p a b)
  (declare (type double-float p a b))
  (flet ((share (odds)
           (declare (type double-float odds))
           (/ (+ 1 (exponential (- odds))))))
    (loop with goal of-type double-float = (logarithm p)
          with odds of-type double-float = (logarithm (/ a b))
          repeat 100
          do (let* ((x (share odds)) (y (share (- odds)))
                    (fraction (beta-fraction a b x y))
                    (step (* fraction (- goal (log-beta-prefactor a b x y) (logarithm fraction)))))
               (declare (type (double-float (0d0)) fraction))
               (incf odds step)
               (when (< (abs step) 1d-10) (loop-finish)))
          finally (return (values (share odds) (share (- odds)))))))

(defun fair-coin-cdf (count trials)
  "Return the probability of at most COUNT (-1 to TRIALS) heads in TRIALS throws of a fair coin."
  (let ((count (double count)) (trials (double trials)))
    (cond ((minusp count) 0d0)
          ((= count trials) 1d0)
          (t (incomplete-beta (- trials count) (+ count 1) .5d0 .5d0)))))

;;; Student's t.

(defun student-critical-value (confidence freedom)
  "Return the t for which a variable with Student's distribution of FREEDOM degrees of freedom is
between -t and t with the probability CONFIDENCE."
  (declare (type double-float confidence freedom))
  (multiple-value-bind (y x) (beta-quantile confidence .5d0 (/ freedom 2))
    (declare (type (double-float 0d0) x y))
    (sqrt (* freedom (/ y x)))))
