;;;; permutation.lisp -- whether what differs between two ways, trial by trial, is chance.

(in-package :ars-magna.statistics)

;;; If both ways are alike, each difference might as well have had the other sign. The test counts
;;; for how many choices of all signs the sum is as far from 0 as it was. The sums are kept sorted,
;;; with their probabilities; each difference doubles them, but for those that fall together, which
;;; whole numbers mostly do. If they get too many, signs are drawn instead.

(defparameter *most-sums* (expt 2 18)
  "How many sums times differences that are left there may be.")

(deftype sums ()
  "Sums, sorted, and their probabilities."
  '(cons doubles doubles))

(defun merge-sums (sums difference grain)
  "Return what becomes of SUMS when DIFFERENCE, not below 0, is added or taken away; those are one
that are closer than GRAIN."
  (declare (type sums sums) (type double-float difference grain) #.*hot*)
  (destructuring-bind (old . odds) sums
    (declare (type doubles old odds))
    (let* ((size (length old)) (count 0) (i 0) (j 0)
           (new (make-array (* 2 size) :element-type 'double-float))
           (new-odds (make-array (* 2 size) :element-type 'double-float)))
      (declare (type fixnum size count i j))
      (flet ((note (sum odds)
               (declare (type double-float sum odds))
               (if (and (plusp count) (<= (- sum (aref new (1- count))) grain))
                   (incf (aref new-odds (1- count)) (* odds 1/2))
                   (setf (aref new count) sum
                         (aref new-odds count) (* odds 1/2)
                         count (1+ count)))))
        (declare (inline note))
        (loop while (< j size)
              do (let ((up (+ (aref old j) difference)))
                   (cond ((and (< i size) (<= (- (aref old i) difference) up))
                          (note (- (aref old i) difference) (aref odds i))
                          (incf i))
                         (t (note up (aref odds j))
                            (incf j))))))
      (cons (subseq new 0 count) (subseq new-odds 0 count)))))

(defun exact-share (sizes sum grain)
  "Return the probability that numbers of SIZES, with signs thrown by a coin, sum up to SUM or more
either way; NIL if that is too much work. What is within GRAIN is equal."
  (loop with sums = (cons (coerce '(0d0) 'doubles) (coerce '(1d0) 'doubles))
        for size across sizes
        for left downfrom (length sizes)
        when (> (* left (length (the doubles (car sums)))) *most-sums*)
          do (return nil)
        do (setf sums (merge-sums sums size grain))
        finally (return (loop for found across (the doubles (car sums))
                              for odds across (the doubles (cdr sums))
                              when (>= (abs found) (- sum grain)) sum odds))))

(defun drawn-share (sizes sum grain resamples dice)
  "Return the share of RESAMPLES draws whose sum is SUM or more either way; what was seen counts as
one of them, so that it is never 0 (Phipson and Smyth 2010)."
  (let ((shares (map 'doubles (constantly .5d0) sizes)))
    (/ (double (1+ (loop repeat resamples
                         count (>= (abs (tilted-sum sizes shares dice)) (- sum grain)))))
       (1+ resamples))))

(defconstant +seldom+ .05d0
  "What is no more likely than this is drawn anew with tilted signs, if that is wanted.")

(defun share-by-draws (sizes sum grain resamples seed rare-too)
  "Return what DRAWN-SHARE says; or RARE-SHARE if that is little and RARE-TOO is true."
  (let ((share (drawn-share sizes sum grain resamples (make-dice seed "permutation"))))
    (if (and rare-too (<= share +seldom+))
        (rare-share sizes sum grain resamples (make-dice seed "rare signs"))
        share)))

(addition permutation-test)
(defun permutation-test (differences &key (resamples 10000) (seed 0) rare-too)
  "Return how likely it is that DIFFERENCES, a list or vector of numbers, have a mean as far from 0
as this if each might as well have had the other sign: the paired permutation test (Fisher 1935,
The Design of Experiments, 21). The second value is true if it is exact, by going through all signs
(Pagano and Tritchler 1983), which is so for up to 19 numbers, and for more if many are equal or
whole; else it is by RESAMPLES draws with the dice for SEED, an integer, the same each time. Draws
never say less than 1/(RESAMPLES + 1). With RARE-TOO, what they find in 1 of 20 at most is drawn
again so that rare sums come often, and counts by its weight (importance sampling, Harrison 2012):
give this if the test is one of many. Sums that differ by rounding only are equal. It is 1 of none,
and if all are 0; of N numbers it is at least 2^(1-N). Signals WRONG-ARGUMENT unless DIFFERENCES are
from -1e15 to 1e15, and RESAMPLES from 100 to 1e7."
  (check-argument permutation-test resamples (whole-p resamples 100 #.(expt 10 7))
                  "an integer from 100 to 1e7")
  (check-argument permutation-test seed (integerp seed) "an integer")
  (let* ((sample (sample 'permutation-test 'differences differences))
         (sum (abs (sum sample)))
         (sizes (sorted (map 'doubles #'abs (remove-if #'zerop sample))))
         (grain (* 1d-13 (sum sizes)))
         (exact (exact-share sizes sum grain)))
    (if exact
        (values (min 1d0 exact) t)
        (values (share-by-draws sizes sum grain resamples seed rare-too) nil))))
