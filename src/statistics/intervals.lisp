;;;; intervals.lisp -- bounds for a probability, a mean, a median or any statistic.

(in-package :ars-magna.statistics)

(declaim (inline wilson-lower-bound))
(defun wilson-lower-bound (successes failures z)
  "Return the lower bound of the Wilson interval, computed as a square divided by a sum, so that no
digits are lost near 0. The formula follows from the product of both bounds."
  (declare (type double-float successes failures z))
  (let ((n (+ successes failures)) (square (* z z)))
    (/ (/ (* successes successes) n)
       (+ successes (/ square 2)
          (* z (sqrt (the (double-float 0d0)
                          (+ (/ (* successes failures) n) (/ square 4)))))))))

(defun wilson-bounds (successes trials z)
  (declare (type (unsigned-byte 60) successes trials) (type double-float z))
  (if (zerop trials)
      (values 0d0 1d0)
      (let ((failures (double (- trials successes))) (successes (double successes)))
        (values (wilson-lower-bound successes failures z)
                (- 1 (wilson-lower-bound failures successes z))))))

(addition wilson-interval)
(defun wilson-interval (successes trials &key (confidence .95d0))
  "Return the bounds, low and high, of the score interval for the probability of success (Wilson
1927; Newcombe 1998, \"Two-sided confidence intervals for the single proportion\", method 3). On
average over all probabilities, the interval contains the true probability as often as CONFIDENCE
says. Near 0 and 1 it may do so less often, unlike EXACT-INTERVAL. Without trials the bounds are 0
and 1; without successes low is 0; without failures high is 1. Signals WRONG-ARGUMENT unless TRIALS
is an integer from 0 to 1e9, SUCCESSES from 0 to TRIALS, and CONFIDENCE between 0 and 1."
  (check-trials wilson-interval successes trials)
  (wilson-bounds successes trials
                 (normal-critical-value (checked-unit-share wilson-interval confidence))))

(defun exact-lower-bound (successes trials tail)
  "Return two values: the rate of success at which SUCCESSES or more successes in TRIALS trials have
the probability TAIL; and 1 minus this rate."
  (if (zerop successes)
      (values 0d0 1d0)
      (beta-quantile tail (double successes) (double (- trials successes -1)))))

(addition exact-interval)
(defun exact-interval (successes trials &key (confidence .95d0))
  "Return the bounds, low and high, of the exact interval for the probability of success (Clopper
and Pearson 1934; Newcombe 1998, method 5). The interval contains the true probability at least as
often as CONFIDENCE says, whatever that probability is, so it is wider than WILSON-INTERVAL. For the
bounds without trials, successes or failures, and for errors, see WILSON-INTERVAL."
  (check-trials exact-interval successes trials)
  (let ((tail (/ (- 1 (checked-unit-share exact-interval confidence)) 2)))
    (values (nth-value 0 (exact-lower-bound successes trials tail))
            (nth-value 1 (exact-lower-bound (- trials successes) trials tail)))))

(defun corrected-correlation (both first second neither)
  "Return the correlation of paired outcomes, continuity-corrected (Newcombe 1998, method 10)."
  (let* ((trials (+ both first second neither))
         (excess (- (* both neither) (* first second)))
         (margins (* (+ both first) (+ second neither) (+ both second) (+ first neither))))
    (if (zerop margins)
        0d0
        (/ (double (if (plusp excess) (max 0 (- excess (/ trials 2))) excess))
           (sqrt (double margins))))))

(defun third-side (a b correlation)
  "Return the third side of a triangle with sides A and B at an angle with the cosine CORRELATION."
  (declare (type double-float a b correlation))
  (sqrt (max 0d0 (+ (* a a) (* b b) (* -2 correlation a b)))))

(defun paired-bounds (p q bounds-of-p bounds-of-q correlation)
  "Return the bounds for P - Q, from the bounds for P and for Q, and their CORRELATION."
  (destructuring-bind (low-p high-p low-q high-q) (append bounds-of-p bounds-of-q)
    (values (- (- p q) (third-side (- p low-p) (- high-q q) correlation))
            (+ (- p q) (third-side (- high-p p) (- q low-q) correlation)))))

(addition paired-proportion-interval)
(defun paired-proportion-interval (both first second neither &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for the difference of two methods' probabilities
of success, the first minus the second. The methods have made the same trials. The required
arguments count the trials in which BOTH methods succeeded, only the FIRST, only the SECOND, or
NEITHER method (Newcombe 1998, \"Improved confidence intervals for the difference between binomial
proportions based on paired data\", method 10). If the difference is below 0, the second method is
better. Without trials the bounds are -1 and 1. Signals WRONG-ARGUMENT unless the counts and their
sum are integers from 0 to 1e9, and CONFIDENCE is between 0 and 1."
  (check-count paired-proportion-interval both)
  (check-count paired-proportion-interval first (- +largest+ both))
  (check-count paired-proportion-interval second (- +largest+ both first))
  (check-count paired-proportion-interval neither (- +largest+ both first second))
  (let ((z (normal-critical-value (checked-unit-share paired-proportion-interval confidence)))
        (trials (+ both first second neither)))
    (if (zerop trials)
        (values -1d0 1d0)
        (paired-bounds (double (/ (+ both first) trials)) (double (/ (+ both second) trials))
                       (multiple-value-list (wilson-bounds (+ both first) trials z))
                       (multiple-value-list (wilson-bounds (+ both second) trials z))
                       (corrected-correlation both first second neither)))))

;;;; Means and medians

(defun student-bounds (sample confidence)
  (let ((size (length (the doubles sample))))
    (if (< size 2)
        (values nil nil)
        (let ((mean (mean-of sample))
              (reach (* (student-critical-value confidence (double (1- size)))
                        (mean-standard-error sample size))))
          (values (- mean reach) (+ mean reach))))))

(addition student-interval)
(defun student-interval (numbers &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for the mean of a distribution (Student 1908).
NUMBERS, a list or vector, are a sample of the distribution. For a normal distribution, the interval
contains the mean as often as CONFIDENCE says. For a skewed distribution the interval contains the
mean less often: for an exponential distribution and .95, in 89 % of samples of 5 numbers, 93 % of
samples of 30, and 94 % of samples of 50. BOOTSTRAP-INTERVAL is no better for skewed distributions.
If all numbers are equal, both bounds are that number; for fewer than two numbers, both bounds are
NIL. Signals WRONG-ARGUMENT unless NUMBERS are from -1e15 to 1e15, and CONFIDENCE between 0 and 1."
  (let ((confidence (checked-unit-share student-interval confidence)))
    (student-bounds (checked-sample 'student-interval 'numbers numbers) confidence)))

(defun check-same-length (operator name seconds firsts)
  (unless (= (length firsts) (length seconds))
    (reject-argument operator name seconds
                     (format nil "a sequence of ~D numbers, as many as the first"
                             (length firsts)))))

(addition mean-difference-interval)
(defun mean-difference-interval (firsts seconds &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for the mean difference between paired numbers:
the STUDENT-INTERVAL of the differences FIRSTS - SECONDS (Student 1908). FIRSTS and SECONDS are
lists or vectors whose elements form pairs, such as the ticks of two plans with the same seeds. For
fewer than two pairs, both bounds are NIL. Signals WRONG-ARGUMENT as STUDENT-INTERVAL does, and if
FIRSTS and SECONDS have different lengths."
  (let ((confidence (checked-unit-share mean-difference-interval confidence))
        (firsts (checked-sample 'mean-difference-interval 'firsts firsts))
        (others (checked-sample 'mean-difference-interval 'seconds seconds)))
    (check-same-length 'mean-difference-interval 'seconds seconds firsts)
    (student-bounds (map 'doubles #'- firsts others) confidence)))

(defun median-bound-rank (size tail)
  "Return the largest R such that the R-th smallest of SIZE numbers from a distribution exceeds the
distribution's median with a probability of at most TAIL; 0 if there is no such R."
  (let ((low 0) (high size))
    (loop while (< (1+ low) high)
          do (let ((rank (floor (+ low high) 2)))
               (if (<= (fair-coin-cdf (1- rank) size) tail)
                   (setf low rank)
                   (setf high rank))))
    low))

(addition median-interval)
(defun median-interval (numbers &key (confidence .95d0))
  "Return three values: the bounds, low and high, of the interval for the median of a distribution,
and the interval's coverage, which is at least CONFIDENCE for any distribution. NUMBERS, a list or
vector, are a sample of the distribution. The bounds are two of NUMBERS, as far from the least and
the greatest as CONFIDENCE allows (David and Nagaraja 2003, Order Statistics, 7.1). All three values
are NIL if there are too few numbers: for .95, fewer than six. Signals WRONG-ARGUMENT unless NUMBERS
are from -1e15 to 1e15, and CONFIDENCE between 0 and 1."
  (let* ((confidence (checked-unit-share median-interval confidence))
         (sample (sort-sample (checked-sample 'median-interval 'numbers numbers)))
         (size (length sample))
         (rank (median-bound-rank size (/ (- 1 confidence) 2))))
    (if (zerop rank)
        (values nil nil nil)
        (values (aref sample (1- rank)) (aref sample (- size rank))
                (- 1 (* 2 (fair-coin-cdf (1- rank) size)))))))

;;;; Any statistic, by the bootstrap

(defparameter *most-jackknife-groups* 500
  "The largest number of groups of the jackknife, which estimates skewness.")

(defun checked-statistic (function)
  "Return a function that calls FUNCTION and signals WRONG-ARGUMENT if the value is not a number."
  (lambda (sample)
    (let ((value (funcall function sample)))
      (unless (bounded-number-p value)
        (reject-argument 'bootstrap-interval 'statistic function
                         "a function that returns a number from -1e15 to 1e15"))
      (double value))))

(defun draw-resample (sample drawn dice)
  (declare (type doubles sample drawn) (type dice dice) #.*hot*)
  (let ((size (length sample)))
    (dotimes (i (length drawn) drawn)
      (setf (aref drawn i)
            (aref sample (the fixnum (truncate (the (double-float 0d0 1d18)
                                                    (* (roll dice) size)))))))))

(defun resample-statistics (sample function resamples dice)
  (let ((drawn (make-array (length sample) :element-type 'double-float))
        (values (make-array resamples :element-type 'double-float)))
    (dotimes (i resamples (sort-sample values))
      (setf (aref values i) (funcall function (draw-resample sample drawn dice))))))

(defun sample-without-group (sample group groups)
  (declare (type doubles sample) (type fixnum group groups))
  (coerce (loop for x across sample for i of-type fixnum from 0
                unless (= group (mod i groups)) collect x)
          'doubles))

(defun bootstrap-acceleration (sample function)
  "Return the acceleration of the statistic FUNCTION for SAMPLE, by the jackknife, in groups if
SAMPLE is large (Efron and Tibshirani 1993, formula 14.15)."
  (let* ((groups (min (length sample) *most-jackknife-groups*))
         (left (coerce (loop for group below groups
                             collect (funcall function (sample-without-group sample group groups)))
                       'doubles))
         (mean (mean-of left)) (squares 0d0) (cubes 0d0)
         (influences (map 'doubles (lambda (value) (- mean value)) left)))
    (loop for influence across (magnified-sample influences (magnification influences))
          do (incf squares (expt influence 2))
             (incf cubes (* (expt influence 2) influence)))
    (if (zerop squares) 0d0 (/ cubes (* 6 (* squares (sqrt squares)))))))

(defun bootstrap-bias (values found)
  "Return the bias correction: the number of standard deviations from the middle of VALUES to FOUND.
Some of VALUES may be equal to FOUND (Efron and Tibshirani 1993, formula 14.14)."
  (declare (type doubles values) (type double-float found))
  (let* ((size (length values))
         (below (+ (count found values :test #'>) (/ (count found values :test #'=) 2))))
    (normal-quantile (double (/ (clamp below 1/2 (- size 1/2)) size)))))

(defun corrected-quantile-share (z bias acceleration)
  "Return the corrected probability of the quantile for the bound at Z standard deviations (Efron
and Tibshirani 1993, formula 14.10)."
  (declare (type double-float z bias acceleration))
  (let* ((off (+ bias z)) (rest (- 1 (* acceleration off))))
    (cond ((plusp rest) (normal-cdf (+ bias (/ off rest))))
          ((plusp off) 1d0)
          (t 0d0))))

(defun bootstrap-bounds (sample function z resamples dice)
  (let* ((found (funcall function (copy-seq sample)))
         (values (resample-statistics sample function resamples dice))
         (bias (bootstrap-bias values found))
         (acceleration (bootstrap-acceleration sample function)))
    (flet ((bound (z)
             (sorted-quantile values (corrected-quantile-share z bias acceleration))))
      (values (bound (- z)) (bound z)))))

(addition bootstrap-interval)
(defun bootstrap-interval (numbers &key (statistic :mean) (resamples 2000) (seed 0)
                                     (confidence .95d0))
  "Return the bounds, low and high, of the interval for a STATISTIC of a distribution, by the
bias-corrected and accelerated bootstrap (Efron 1987; Efron and Tibshirani 1993, chapter 14).
NUMBERS, a list or vector, are a sample of the distribution. STATISTIC is :MEAN, :MEDIAN or a
function that returns a number for a vector of double-floats; the function may sort the vector but
must not keep it. The function is called on RESAMPLES samples drawn from NUMBERS. SEED, an integer,
seeds the draws, so the bounds are the same each time.

- Few numbers: the interval is too narrow. With .95, the interval for the mean of a normal
  distribution contains the mean in 85 of 100 samples of 5 numbers, in 90 of 100 samples of 10, and
  in 94 of 100 samples of 30. For means of few numbers use STUDENT-INTERVAL.
- Few resamples: no bound lies beyond the values found in the resamples. With fewer resamples than
  20 / (1 - CONFIDENCE), the bounds vary with SEED or are too narrow.
- Equal numbers: both bounds are the value of STATISTIC. For fewer than two numbers both are NIL.

Signals WRONG-ARGUMENT unless NUMBERS and the values of STATISTIC are from -1e15 to 1e15, RESAMPLES
from 100 to 1e7, and CONFIDENCE between 0 and 1."
  (let ((z (normal-critical-value (checked-unit-share bootstrap-interval confidence)))
        (sample (checked-sample 'bootstrap-interval 'numbers numbers))
        (function (case statistic
                    (:mean #'mean-of)
                    (:median #'median-of)
                    (t (and (functionp statistic) statistic)))))
    (check-argument bootstrap-interval statistic function
                    ":mean, :median or a function of a vector of numbers")
    (check-resampling bootstrap-interval resamples seed)
    (if (< (length sample) 2)
        (values nil nil)
        (bootstrap-bounds sample (checked-statistic function) z resamples
                          (make-dice seed "bootstrap")))))
