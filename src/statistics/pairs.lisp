;;;; pairs.lisp -- which of two ways of doing the same trials succeeds more often.

(in-package :ars-magna.statistics)

(addition mcnemar-test)
(defun mcnemar-test (first second)
  "Return how likely it is that two equally good ways differ as much as these: of the same trials,
FIRST succeeded one way only, SECOND the other way only; those with the same outcome both ways say
nothing. The test is exact, and its size never above what it says (McNemar 1947; Fagerland,
Lydersen and Laake 2013, \"The McNemar test for binary matched-pairs data\"). The second value is
the mid-p of the same paper, less careful and as a rule nearer to the truth. Both are 1 of no
trials. Signals WRONG-ARGUMENT unless FIRST and SECOND are integers from 0 to 1e9."
  (check-count mcnemar-test first)
  (check-count mcnemar-test second)
  (let* ((trials (+ first second)) (fewer (min first second))
         (tail (half-or-fewer fewer trials))
         (point (- tail (half-or-fewer (1- fewer) trials))))
    (cond ((zerop trials) (values 1d0 1d0))
          ((= first second) (values 1d0 (- 1 (/ point 2))))
          (t (values (min 1d0 (* 2 tail)) (- (* 2 tail) point))))))

(defun corrected-correlation (both first second neither)
  "Return how much the outcomes of two ways go together, less what small numbers feign (Newcombe
1998, method 10)."
  (let* ((trials (+ both first second neither))
         (excess (- (* both neither) (* first second)))
         (margins (* (+ both first) (+ second neither) (+ both second) (+ first neither))))
    (if (zerop margins)
        0d0
        (/ (double (if (plusp excess) (max 0 (- excess (/ trials 2))) excess))
           (sqrt (double margins))))))

(defun side (a b correlation)
  "Return the length of the third side of a triangle of which A and B meet at an angle with the
cosine CORRELATION."
  (declare (type double-float a b correlation))
  (sqrt (max 0d0 (+ (* a a) (* b b) (* -2 correlation a b)))))

(defun paired-bounds (p q bounds-of-p bounds-of-q correlation)
  "Return the bounds for P less Q, of the bounds for each and their CORRELATION."
  (destructuring-bind (low-p high-p low-q high-q) (append bounds-of-p bounds-of-q)
    (values (- (- p q) (side (- p low-p) (- high-q q) correlation))
            (+ (- p q) (side (- high-p p) (- q low-q) correlation)))))

(addition paired-proportion-interval)
(defun paired-proportion-interval (both first second neither &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for how much more probable success is one way
than another, if in the same trials BOTH ways succeeded so often, only the FIRST, only the SECOND,
and NEITHER (Newcombe 1998, \"Improved confidence intervals for the difference between binomial
proportions based on paired data\", method 10). Below 0 the second way is better. Of no trials the
bounds are -1 and 1. Signals WRONG-ARGUMENT unless the counts are integers from 0 to 1e9, which
together are no more, and CONFIDENCE is between 0 and 1."
  (check-count paired-proportion-interval both)
  (check-count paired-proportion-interval first (- +largest+ both))
  (check-count paired-proportion-interval second (- +largest+ both first))
  (check-count paired-proportion-interval neither (- +largest+ both first second))
  (let ((z (normal-reach (check-share paired-proportion-interval confidence)))
        (trials (+ both first second neither)))
    (if (zerop trials)
        (values -1d0 1d0)
        (paired-bounds (double (/ (+ both first) trials)) (double (/ (+ both second) trials))
                       (multiple-value-list (wilson-bounds (+ both first) trials z))
                       (multiple-value-list (wilson-bounds (+ both second) trials z))
                       (corrected-correlation both first second neither)))))
