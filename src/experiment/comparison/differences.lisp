;;;; differences.lisp -- how much two conditions differ in one measure, over trials of equal seeds.

(in-package :ars-magna.experiment)

;;; Trials of one seed share their random numbers, so conditions are compared seed by seed: what is
;;; easy or hard for both cancels. Rates are compared by Newcombe's interval and the exact McNemar
;;; test, means by Student's interval and a permutation test.

(addition paired-difference-p)
(define-record (paired-difference (:conc-name paired-)
                                  (:constructor make-difference
                                      (measure kind trials first second low high p
                                       &optional table rounding)))
  "The difference between two conditions in one measure."
  (measure "" string
           "what is compared, a string: success, ticks or the name of a measure" :addition)
  (kind :mean (member :rate :mean) "the kind of the numbers, :RATE or :MEAN")
  (trials 0 integer "how many pairs of trials are counted" :addition)
  (first nil t "the rate, from 0 to 1, or mean of the first side; NIL if there are no trials"
  :addition)
  (second nil t "the rate, from 0 to 1, or mean of the second side; NIL if there are no trials"
  :addition)
  (low nil t
       "the lower end of the 95 % interval of the difference; NIL if there are too few trials"
:addition)
  (high nil t
        "the upper end of the 95 % interval of the difference; NIL if there are too few trials"
:addition)
  (p nil t
     "the probability of a difference this large or larger if the sides do not differ; or NIL"
:addition)
  (table '() list "the numbers of pairs in which both, only the first, only the second, and neither
are true, a list of four; NIL of a mean, or over several conditions" :addition)
  (rounding nil (or null real) "the largest difference in any pair, if rounding explains all; 0 if
all pairs are equal; or NIL")
  (left-out 0 integer "how many pairs are not counted because a value is no number" :writable)
  (tests 1 integer "the number of tests for which p is corrected" :writable)
  (adjusted-p nil t :writable :addition))

(addition paired-estimate)
(defun paired-estimate (difference)
  "Return the first rate or mean of DIFFERENCE minus the second, or NIL if there are no trials."
  (and (paired-first difference)
       (subtract-numbers (paired-first difference) (paired-second difference))))

(setf (documentation 'paired-adjusted-p 'function)
      "Return PAIRED-P corrected for all tests of the comparison (Holm), or NIL. Tests over several
conditions are corrected separately from tests of single conditions.")

(defmethod print-object ((difference paired-difference) stream)
  (print-unreadable-object (difference stream)
    (format stream "difference in ~A, ~D pairs" (paired-measure difference)
            (paired-trials difference))))

;;; Rates.

(defun count-true-pairs (firsts seconds)
  "FIRSTS and SECONDS are lists of booleans. Return a list of four numbers: how many pairs are true
on both sides, only on the first, only on the second, and on neither."
  (let ((both 0) (first 0) (second 0) (neither 0))
    (loop for a in firsts
          for b in seconds
          do (cond ((and a b) (incf both)) (a (incf first)) (b (incf second)) (t (incf neither))))
    (list both first second neither)))

(defun rate-difference (measure firsts seconds)
  (destructuring-bind (both first second neither) (count-true-pairs firsts seconds)
    (let ((trials (+ both first second neither)))
      (if (zerop trials)
          (make-difference measure :rate 0 nil nil nil nil nil)
          (multiple-value-bind (low high) (paired-proportion-interval both first second neither)
            (make-difference measure :rate trials
                             (/ (+ both first) trials) (/ (+ both second) trials) low high
                             (values (mcnemar-test first second))
                             (list both first second neither)
                             (and (= 0 first second) 0)))))))

;;; Means.

;; The same floats added in another order differ in the last digits. Such a difference is reported
;; as rounding and not tested. Whole numbers have no rounding.
(defconstant +rounding-tolerance+ (* 4 double-float-epsilon)
  "The largest relative difference of two floats that rounding can explain.")

(defun equal-but-for-rounding-p (a b)
  (or (= a b)
      (and (or (floatp a) (floatp b))
           (<= (abs (- (rational a) (rational b)))
               (* (rational +rounding-tolerance+) (max (abs (rational a)) (abs (rational b))))))))

(defun largest-rounding (firsts seconds)
  "Return the largest difference of FIRSTS and SECONDS; NIL if rounding cannot explain them all."
  (cond ((every #'= firsts seconds) 0)
        ((every #'equal-but-for-rounding-p firsts seconds)
         (reduce #'max (mapcar (lambda (a b) (abs (subtract-numbers a b))) firsts seconds)))))

(defun exact-mean (numbers)
  "Return the mean of NUMBERS: a float if one of NUMBERS is a float, else a rational."
  (let ((mean (/ (reduce #'+ numbers :key #'rational) (length numbers))))
    (if (some #'floatp numbers) (nearest-float mean) mean)))

(defun mean-p-value (numbers)
  "Return the p value of the mean of NUMBERS, which are differences. The permutation test makes
fewer draws for many numbers; the smallest possible p does not depend on the draws."
  (let ((draws (clamp (floor 200000000 (length numbers)) 1000 10000)))
    (values (permutation-test numbers :resamples draws :rare-too t))))

(defun mean-difference (measure firsts seconds &optional (kind :mean))
  (if (null firsts)
      (make-difference measure kind 0 nil nil nil nil nil)
      (let* ((differences (mapcar (lambda (a b) (- (rational a) (rational b))) firsts seconds))
             (scale (scale-of-numbers differences))
             (numbers (mapcar (lambda (number) (scale-number number scale)) differences))
             (rounding (largest-rounding firsts seconds)))
        (multiple-value-bind (low high) (student-interval numbers)
          (make-difference measure kind (length firsts) (exact-mean firsts) (exact-mean seconds)
                           (unscale-number low scale) (unscale-number high scale)
                           (if rounding 1d0 (mean-p-value numbers))
                           '() rounding)))))

;;; Several differences.

;; A measure that is the same in all pairs cannot show a difference, so it does not count as a test.
(defun counts-as-test-p (difference)
  (and (paired-p difference) (not (paired-rounding difference))))

(defun adjust-p-values (differences)
  "Set the adjusted p of each of DIFFERENCES by Holm's correction."
  (let* ((with-p (remove nil differences :key #'paired-p))
         (tested (remove-if-not #'counts-as-test-p with-p)))
    (dolist (difference with-p)
      (setf (paired-adjusted-p difference) (paired-p difference)
            (paired-tests difference) (max 1 (length tested))))
    (loop for difference in tested
          for adjusted in (holm-adjusted (mapcar #'paired-p tested))
          do (setf (paired-adjusted-p difference) adjusted))))

(defun smallest-possible-p (seeds)
  "Return the smallest possible p over SEEDS seeds, for differences that all have the same sign."
  (expt 2 (- 1 (max 1 seeds))))

(defun significant-p (difference)
  (and (paired-adjusted-p difference) (<= (paired-adjusted-p difference) .05d0)))
