;;;; beta.lisp -- the incomplete beta function: probabilities of counts, and Student's t.

(in-package :ars-magna.statistics)

;;; Where both a number X and 1 - X are arguments, X and Y, they are given apart, so that neither
;;; loses digits by being near 1.

(defun log-power (y x exponent)
  "Return EXPONENT log Y, where X = 1 - Y."
  (declare (type double-float y x exponent))
  (if (< x .1d0)
      (- (+ (deviance exponent (* exponent y)) (* exponent x)))
      (* exponent (logarithm y))))

(defun log-binomial-density (a b x y)
  "Return the logarithm of gamma(A+B+1) / (gamma(A+1) gamma(B+1)) X^A Y^B: of whole numbers, that
of the probability of A successes and B failures (Loader 2000). A and B are 0 or from 1/2 on."
  (declare (type double-float a b x y))
  (let ((n (+ a b)))
    (cond ((zerop n) 0d0)
          ((zerop a) (log-power y x b))
          ((zerop b) (log-power x y a))
          (t (+ (- (stirling-rest n) (stirling-rest a) (stirling-rest b)
                   (deviance a (* n x)) (deviance b (* n y)))
                (/ (logarithm (/ n (* 2 pi a b))) 2))))))

(defun log-rise (a b x y)
  "Return the logarithm of X^A Y^B / beta(A, B)."
  (declare (type double-float a b x y))
  (+ (log-binomial-density a b x y) (logarithm (/ (* a b) (+ a b)))))

(defun beta-fraction (a b x y)
  "Return I_X(A, B) divided by X^A Y^B / beta(A, B), for X up to about A/(A+B) (the continued
fraction of Didonato and Morris 1992, all of whose terms are above 0 there)."
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
        ((<= (* b x) (* a y)) (* (exponential (log-rise a b x y)) (beta-fraction a b x y)))
        (t (- 1 (* (exponential (log-rise b a y x)) (beta-fraction b a y x))))))

(defun beta-quantile (p a b)
  "Return the X with I_X(A, B) = P, which is between 0 and 1, and 1 - X."
  (declare (type double-float p a b))
  (if (> p .5d0)
      (multiple-value-bind (y x) (lower-beta-quantile (- 1 p) b a) (values x y))
      (lower-beta-quantile p a b)))

;;; As a function of the log odds of X, the logarithm of I_X is concave, and near that of a half
;;; where the odds are A : B. So Newton's method cannot go astray from there, for P up to a half.

(defun lower-beta-quantile (p a b)
  (declare (type double-float p a b))
  (flet ((share (odds)
           (declare (type double-float odds))
           (/ (+ 1 (exponential (- odds))))))
    (loop with goal of-type double-float = (logarithm p)
          with odds of-type double-float = (logarithm (/ a b))
          repeat 100
          do (let* ((x (share odds)) (y (share (- odds)))
                    (fraction (beta-fraction a b x y))
                    (step (* fraction (- goal (log-rise a b x y) (logarithm fraction)))))
               (declare (type (double-float (0d0)) fraction))
               (incf odds step)
               (when (< (abs step) 1d-10) (loop-finish)))
          finally (return (values (share odds) (share (- odds)))))))

(defun half-or-fewer (count trials)
  "Return the probability that a fair coin falls heads COUNT times or less often in TRIALS,
integers; COUNT may be -1."
  (let ((count (double count)) (trials (double trials)))
    (cond ((minusp count) 0d0)
          ((= count trials) 1d0)
          (t (incomplete-beta (- trials count) (+ count 1) .5d0 .5d0)))))

;;; Student's t.

(defun student-reach (confidence freedom)
  "Return the t for which Student's t of FREEDOM degrees lies from -t to t with a probability of
CONFIDENCE."
  (declare (type double-float confidence freedom))
  (multiple-value-bind (y x) (beta-quantile confidence .5d0 (/ freedom 2))
    (declare (type (double-float 0d0) x y))
    (sqrt (* freedom (/ y x)))))
