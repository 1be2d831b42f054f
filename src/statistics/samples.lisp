;;;; samples.lisp -- checking arguments; mean, variance, median and quantiles.

(in-package :ars-magna.statistics)

(export '(mean median share-as-double))

(deftype doubles ()
  "A sample, as functions of this package use it internally."
  '(simple-array double-float (*)))

(defun every-element-p (value test)
  "True if VALUE is a list or vector whose elements all pass TEST."
  (and (or (vectorp value) (proper-list-p value)) (every test value)))

(defun checked-sample (operator name numbers)
  "Return NUMBERS, the argument NAME of OPERATOR, as a fresh vector of double-floats. Signals
WRONG-ARGUMENT unless NUMBERS is a list or vector of numbers from -1e15 to 1e15."
  (unless (every-element-p numbers #'bounded-number-p)
    (reject-argument operator name numbers "a list or vector of numbers from -1e15 to 1e15"))
  (map 'doubles #'double numbers))

(defun share-as-double (share)
  "Return SHARE as a double-float: the single-float .95 is .95, not 0.949999988."
  (double (if (typep share 'single-float) (rationalize share) share)))

(defun inside-unit-interval-p (value)
  "True if VALUE is a number between 0 and 1, at least 1e-12 from 0 and from 1."
  (and (probability-p value) (<= 1d-12 (share-as-double value) (- 1 1d-12))))

(defmacro checked-unit-share (operator place)
  "Return the value of PLACE as a double-float. Signal WRONG-ARGUMENT unless it is between 0 and 1."
  `(progn
     (check-argument ,operator ,place (inside-unit-interval-p ,place)
                     "a number between 0 and 1, such as .95, at least 1e-12 from both")
     (share-as-double ,place)))

(defmacro check-count (operator place &optional (most '+largest+))
  "Signal WRONG-ARGUMENT unless PLACE is an integer from 0 to MOST."
  `(check-argument ,operator ,place (whole-p ,place 0 ,most)
                   (format nil "an integer from 0 to ~D" ,most)))

(defmacro check-resampling (operator resamples seed)
  `(progn (check-argument ,operator ,resamples (whole-p ,resamples 100 #.(expt 10 7))
                          "an integer from 100 to 1e7")
          (check-argument ,operator ,seed (integerp ,seed) "an integer")))

(defmacro check-trials (operator successes trials)
  `(progn (check-count ,operator ,trials)
          (check-count ,operator ,successes ,trials)))

;;;; Mean, variance, median, quantiles

;;; Statistics are NIL if the sample is too small: the mean of nothing, the variance of one number.

(declaim (ftype (function (doubles) double-float) sum))
(defun sum (sample)
  (declare (type doubles sample) #.*hot*)
  (loop with sum of-type double-float = 0d0
        for x across sample do (incf sum x)
        finally (return sum)))

(defun mean-of (sample)
  "Return the mean of SAMPLE, which is not empty, corrected by the mean of the residuals. The mean
is exact to the last digits; the mean of equal numbers is exactly that number."
  (declare (type doubles sample) #.*hot*)
  (let* ((size (double (length sample))) (rough (/ (sum sample) size)))
    (+ rough (/ (loop with rest of-type double-float = 0d0
                      for x across sample do (incf rest (- x rough))
                      finally (return rest))
                size))))

(defun variance-of (sample)
  "Return the variance of SAMPLE, which has at least two numbers, by the corrected two-pass formula
(Chan, Golub and LeVeque 1983, formula 1.7)."
  (declare (type doubles sample) #.*hot*)
  (let ((mean (mean-of sample)) (squares 0d0) (rest 0d0) (size (length sample)))
    (declare (type double-float mean squares rest))
    (loop for x across sample
          for deviation of-type double-float = (- x mean)
          do (incf squares (* deviation deviation))
             (incf rest deviation))
    (/ (max 0d0 (- squares (/ (* rest rest) size))) (- size 1))))

;;; Very small numbers, whose cubes would be 0, are first multiplied exactly by a power of two.

(defun magnification (sample)
  "Return the power of two by which the numbers of SAMPLE are multiplied before they are squared or
cubed. The power is 1 unless all numbers of SAMPLE are very small."
  (let ((largest (reduce #'max sample :key #'abs :initial-value 0d0)))
    (if (< 0d0 largest 1d-75)
        (scale-float 1d0 (min 1000 (- (nth-value 1 (decode-float largest)))))
        1d0)))

(defun magnified-sample (sample factor)
  (declare (type doubles sample) (type double-float factor))
  (if (= 1 factor) sample (map 'doubles (lambda (x) (* factor x)) sample)))

(defun mean-standard-error (sample &optional (size 1))
  "SAMPLE, at least two numbers, is from a distribution. Return the estimated standard deviation of
the mean of SIZE numbers from this distribution."
  (let ((factor (magnification sample)))
    (/ (sqrt (/ (variance-of (magnified-sample sample factor)) size)) factor)))

;;; SBCL's SORT takes ten times as long, which would slow a bootstrap of the median.

(defun merge-runs (from to start middle end)
  (declare (type doubles from to) (type fixnum start middle end) #.*hot*)
  (let ((i start) (j middle))
    (declare (type fixnum i j))
    (loop for k of-type fixnum from start below end
          do (setf (aref to k)
                   (if (and (< i middle) (or (= j end) (<= (aref from i) (aref from j))))
                       (prog1 (aref from i) (incf i))
                       (prog1 (aref from j) (incf j)))))))

(defun sort-sample (sample)
  "Sort SAMPLE in place, by merging runs of 1, 2, 4 and more numbers. Return SAMPLE."
  (declare (type doubles sample))
  (let* ((size (length sample)) (from sample)
         (to (make-array size :element-type 'double-float)))
    (loop for run = 1 then (* 2 run)
          while (< run size)
          do (loop for start from 0 below size by (* 2 run)
                   do (merge-runs from to start (min size (+ start run))
                                  (min size (+ start run run))))
             (rotatef from to))
    (replace sample from)))

(defun sorted-quantile (sample share)
  "Return the quantile of the sorted SAMPLE for SHARE, from 0 to 1 (Hyndman and Fan 1996, type 7)."
  (declare (type doubles sample) (type double-float share))
  (multiple-value-bind (index part) (floor (* share (1- (length sample))))
    (let ((below (aref sample index)))
      (if (zerop part)
          below
          (+ below (* part (- (aref sample (1+ index)) below)))))))

(defun median-of (sample)
  (sorted-quantile (sort-sample (copy-seq (the doubles sample))) .5d0))

;;; For other layers.

(defun mean (numbers)
  "Return the mean of NUMBERS, a list or vector, as a double-float; or NIL if NUMBERS is empty.
Signals WRONG-ARGUMENT unless NUMBERS are from -1e15 to 1e15."
  (let ((sample (checked-sample 'mean 'numbers numbers)))
    (when (plusp (length sample)) (mean-of sample))))

(defun median (numbers)
  "Return the median of NUMBERS, a list or vector; or NIL if NUMBERS is empty. Signals
WRONG-ARGUMENT unless NUMBERS are from -1e15 to 1e15."
  (let ((sample (checked-sample 'median 'numbers numbers)))
    (when (plusp (length sample)) (sorted-quantile (sort-sample sample) .5d0))))
