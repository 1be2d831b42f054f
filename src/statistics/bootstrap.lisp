;;;; bootstrap.lisp -- intervals for any statistic, by drawing from the sample again and again.

(in-package :ars-magna.statistics)

(defparameter *most-groups* 500
  "In how many groups at most a sample is left out bit by bit: enough to tell how skewed it is.")

(defun statistic-function (statistic)
  (case statistic
    (:mean #'mean-of)
    (:median #'median-of)
    (t (and (functionp statistic) statistic))))

(defun checked-statistic (function)
  "Return a function that calls FUNCTION and signals WRONG-ARGUMENT unless that returns a number."
  (lambda (sample)
    (let ((value (funcall function sample)))
      (unless (quantity-p value)
        (reject-argument 'bootstrap-interval 'statistic function
                         "a function that returns a number from -1e15 to 1e15"))
      (double value))))

(defun draw-again (sample drawn dice)
  "Fill DRAWN with numbers of SAMPLE, each as likely as another."
  (declare (type doubles sample drawn) (type dice dice) #.*hot*)
  (let ((size (length sample)))
    (dotimes (i (length drawn) drawn)
      (setf (aref drawn i)
            (aref sample (the fixnum (truncate (the (double-float 0d0 1d18)
                                                    (* (roll dice) size)))))))))

(defun resampled (sample function resamples dice)
  "Return what FUNCTION says of RESAMPLES samples drawn from SAMPLE, sorted."
  (let ((drawn (make-array (length sample) :element-type 'double-float))
        (values (make-array resamples :element-type 'double-float)))
    (dotimes (i resamples (sorted values))
      (setf (aref values i) (funcall function (draw-again sample drawn dice))))))

(defun sample-without (sample group groups)
  "Return SAMPLE without each GROUPS-th of its numbers, from index GROUP."
  (declare (type doubles sample) (type fixnum group groups))
  (coerce (loop for x across sample for i of-type fixnum from 0
                unless (= group (mod i groups)) collect x)
          'doubles))

(defun skewness-of-influence (sample function)
  "Return the acceleration: how the deviation of what FUNCTION says changes with what is so (Efron
and Tibshirani 1993, formula 14.15, of groups if SAMPLE is large)."
  (let* ((groups (min (length sample) *most-groups*))
         (left (coerce (loop for group below groups
                             collect (funcall function (sample-without sample group groups)))
                       'doubles))
         (mean (mean-of left)) (squares 0d0) (cubes 0d0)
         (influences (map 'doubles (lambda (value) (- mean value)) left)))
    (loop for influence across (magnified influences (magnification influences))
          do (incf squares (expt influence 2))
             (incf cubes (* (expt influence 2) influence)))
    (if (zerop squares) 0d0 (/ cubes (* 6 (* squares (sqrt squares)))))))

(defun bias (values found)
  "Return by how many deviations FOUND is off the middle of VALUES, some of which may equal it
(Efron and Tibshirani 1993, formula 14.14)."
  (declare (type doubles values) (type double-float found))
  (let* ((size (length values))
         (below (+ (count found values :test #'>) (/ (count found values :test #'=) 2))))
    (normal-quantile (double (/ (clamp below 1/2 (- size 1/2)) size)))))

(defun corrected-share (z bias acceleration)
  "Return which share of the values drawn is to be below a bound that lies Z deviations off (Efron
and Tibshirani 1993, formula 14.10)."
  (declare (type double-float z bias acceleration))
  (let* ((off (+ bias z)) (rest (- 1 (* acceleration off))))
    (cond ((plusp rest) (normal-probability (+ bias (/ off rest))))
          ((plusp off) 1d0)
          (t 0d0))))

(defun bootstrap-bounds (sample function z resamples dice)
  (let* ((found (funcall function (copy-seq sample)))
         (values (resampled sample function resamples dice))
         (bias (bias values found))
         (acceleration (skewness-of-influence sample function)))
    (flet ((bound (z)
             (sorted-quantile values (corrected-share z bias acceleration))))
      (values (bound (- z)) (bound z)))))

(addition bootstrap-interval)
(defun bootstrap-interval (numbers &key (statistic :mean) (resamples 2000) (seed 0)
                                     (confidence .95d0))
  "Return the bounds, low and high, of the interval for a STATISTIC of what NUMBERS, a list or
vector, are a sample of: the bias-corrected and accelerated bootstrap (Efron 1987; Efron and
Tibshirani 1993, chapter 14). STATISTIC is :MEAN, :MEDIAN or a function of a vector of
double-floats, which may sort but must not keep it, to a number. It is asked of RESAMPLES samples,
drawn from NUMBERS by the dice for SEED, an integer: the same bounds each time. Of few numbers it
is too narrow: the .95 interval for the mean of 5 normal ones holds it in 85 of 100 samples, of 10
in 90, of 30 in 94; there STUDENT-INTERVAL is better. No bound lies beyond what was found in the
samples drawn: with fewer of them than 20 / (1 - CONFIDENCE), bounds vary with SEED or are too
near. Of numbers that are all equal, both bounds are what is found in them; of fewer than two,
both are NIL. Signals WRONG-ARGUMENT unless NUMBERS and what STATISTIC returns are from -1e15 to
1e15, RESAMPLES from 100 to 1e7, and CONFIDENCE between 0 and 1."
  (let ((z (normal-reach (check-share bootstrap-interval confidence)))
        (sample (sample 'bootstrap-interval 'numbers numbers))
        (function (statistic-function statistic)))
    (check-argument bootstrap-interval statistic function
                    ":mean, :median or a function of a vector of numbers")
    (check-argument bootstrap-interval resamples (whole-p resamples 100 #.(expt 10 7))
                    "an integer from 100 to 1e7")
    (check-argument bootstrap-interval seed (integerp seed) "an integer")
    (if (< (length sample) 2)
        (values nil nil)
        (bootstrap-bounds sample (checked-statistic function) z resamples
                          (make-dice seed "bootstrap")))))
