;;;; tests.lisp -- tests of significance, one, many or sequential.

(in-package :ars-magna.statistics)

(addition mcnemar-test)
(defun mcnemar-test (first second)
  "Return the p value of McNemar's exact test of the hypothesis that two methods, tried in the same
trials, are equally good. FIRST is the number of trials in which only the first succeeded, SECOND
the number in which only the second did. Trials with equal outcomes do not count. The test never
rejects a true hypothesis more often than its level says (McNemar 1947; Fagerland, Lydersen and
Laake 2013, \"The McNemar test for binary matched-pairs data\"). The second value is the mid-p value
of that paper, which is less conservative and usually more exact. The p value and the mid-p value
are 1 without trials. Signals WRONG-ARGUMENT unless FIRST and SECOND are integers from 0 to 1e9."
  (check-count mcnemar-test first)
  (check-count mcnemar-test second)
  (let* ((trials (+ first second)) (fewer (min first second))
         (tail (fair-coin-cdf fewer trials))
         (point (- tail (fair-coin-cdf (1- fewer) trials))))
    (cond ((zerop trials) (values 1d0 1d0))
          ((= first second) (values 1d0 (- 1 (/ point 2))))
          (t (values (min 1d0 (* 2 tail)) (- (* 2 tail) point))))))

;;;; Rare sums of signs

;;; With draws of fair signs p is never below 1 / (draws + 1), which is too large for one of
;;; hundreds of tests. So this draws signs tilted towards the observed sum: a number A is positive
;;; with the odds e^(2 A tilt), such that this sum is the mean. The weight of a draw is how much
;;; less likely it is with fair signs: e^(log cosh (A tilt) summed - tilt * sum). In the tail that
;;; is never more than Chernoff's bound, so the share is known to a few per cent, however small. The
;;; observed sum counts as one of the draws (Harrison 2012, "Conservative hypothesis tests and
;;; confidence intervals using importance sampling").

(defun negative-sign-probability (x)
  "Return the probability of a negative sign if the odds of a positive sign are e^(2X), X >= 0."
  (declare (type double-float x))
  (let ((odds (exponential (* -2 (min x 300d0)))))
    (/ odds (+ 1 odds))))

(defun mean-tilted-sum (sizes tilt)
  (declare (type doubles sizes) (type double-float tilt))
  (loop for size across sizes
        sum (* size (- 1 (* 2 (negative-sign-probability (* size tilt))))) of-type double-float))

(defun find-tilt (sizes sum)
  "Return the tilt of random signs for which the mean sum of SIZES is SUM. The largest size is 1."
  (declare (type doubles sizes) (type double-float sum))
  (let ((low 0d0) (high (/ 20 (max 1d-4 (reduce #'min sizes)))))
    (loop repeat 40
          for middle of-type double-float = (/ (+ low high) 2)
          do (if (< (mean-tilted-sum sizes middle) sum) (setf low middle) (setf high middle)))
    low))

(defun log-of-cosh (x)
  (declare (type double-float x))
  (- x (logarithm (* 2 (- 1 (negative-sign-probability x))))))

(defun draw-tilted-sum (sizes shares dice)
  (declare (type doubles sizes shares) (type dice dice) #.*hot*)
  (loop with sum of-type double-float = 0d0
        for size across sizes
        for share across shares
        do (incf sum (if (< (roll dice) share) (- size) size))
        finally (return sum)))

(defun tilted-tail-probability (sizes sum grain resamples dice)
  "Return the probability that the sum of SIZES, which are at most 1, with random signs is at least
SUM or at most -SUM. The probability is estimated by RESAMPLES draws of tilted signs."
  (let* ((tilt (find-tilt sizes sum))
         (shares (map 'doubles (lambda (size) (negative-sign-probability (* size tilt))) sizes))
         (logs (loop for size across sizes sum (log-of-cosh (* size tilt)))))
    (flet ((weight (sum) (exponential (max -700d0 (- logs (* tilt sum))))))
      (/ (loop with weights = (weight sum)
               repeat resamples
               for drawn = (draw-tilted-sum sizes shares dice)
               when (>= drawn (- sum grain)) do (incf weights (weight drawn))
               finally (return (* 2 weights)))
         (1+ resamples)))))

(defun rare-tail-probability (sizes sum grain resamples dice)
  "Return the probability that the sum of SIZES with random signs is at least SUM or at most -SUM,
estimated by importance sampling, for small probabilities."
  (let ((largest (reduce #'max sizes)))
    (min 1d0 (tilted-tail-probability (map 'doubles (lambda (size) (/ size largest)) sizes)
                                      (/ sum largest) (/ grain largest) resamples dice))))

;;;; The permutation test

;;; If both methods are equal, each difference might as well have the other sign. The test counts
;;; for how many choices of signs the sum is at least as far from 0 as the observed one. The sums
;;; are kept sorted, with their probabilities; each difference doubles them, except for equal sums,
;;; which are common with whole numbers. If there are too many, signs are drawn instead.

(defparameter *most-exact-sums* (expt 2 18)
  "The exact test is given up if the number of sums, times the differences left, is above this.")

(deftype sums ()
  "A cons of a sorted vector of sums and a vector of their probabilities."
  '(cons doubles doubles))

(defun add-signed-difference (sums difference grain)
  "Return the sums that result from SUMS if DIFFERENCE, 0 or more, is added or subtracted with equal
probability. Sums closer than GRAIN are joined."
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

(defun exact-tail-probability (sizes sum grain)
  "Return the exact probability that the sum of SIZES with random signs is at least SUM or at most
-SUM; or NIL if this takes too long. Sums that differ by at most GRAIN are equal."
  (loop with sums = (cons (coerce '(0d0) 'doubles) (coerce '(1d0) 'doubles))
        for size across sizes
        for left downfrom (length sizes)
        when (> (* left (length (the doubles (car sums)))) *most-exact-sums*)
          do (return nil)
        do (setf sums (add-signed-difference sums size grain))
        finally (return (loop for found across (the doubles (car sums))
                              for odds across (the doubles (cdr sums))
                              when (>= (abs found) (- sum grain)) sum odds))))

(defun drawn-tail-probability (sizes sum grain resamples dice)
  "Return the share of RESAMPLES draws of random signs in which the sum of SIZES is at least SUM or
at most -SUM. The observed sum counts as a draw, so the share is never 0 (Phipson and Smyth 2010)."
  (let ((shares (map 'doubles (constantly .5d0) sizes)))
    (/ (double (1+ (loop repeat resamples
                         count (>= (abs (draw-tilted-sum sizes shares dice)) (- sum grain)))))
       (1+ resamples))))

(defconstant +rare-probability-limit+ .05d0
  "The largest p value that is estimated again with tilted signs if RARE-TOO is true.")

(defun estimated-tail-probability (sizes sum grain resamples seed rare-too)
  "Return the DRAWN-TAIL-PROBABILITY. If it is small and RARE-TOO is true, return the
RARE-TAIL-PROBABILITY instead."
  (let ((share (drawn-tail-probability sizes sum grain resamples (make-dice seed "permutation"))))
    (if (and rare-too (<= share +rare-probability-limit+))
        (rare-tail-probability sizes sum grain resamples (make-dice seed "rare signs"))
        share)))

(addition permutation-test)
(defun permutation-test (differences &key (resamples 10000) (seed 0) rare-too)
  "Return the p value of the paired permutation test (Fisher 1935, The Design of Experiments, 21):
the probability that the mean of DIFFERENCES, a list or vector of numbers, is at least as far from 0
as observed, if the sign of each difference is random.

The second value is true if p is exact, computed from all combinations of signs (Pagano and
Tritchler 1983). The value is exact for up to 19 numbers, and for more numbers if many are equal or
whole. Otherwise p is estimated from RESAMPLES draws of signs and is never below 1/(RESAMPLES + 1).
SEED, an integer, seeds the draws, so p is the same each time. If RARE-TOO is true, a p of at most
1/20 is estimated again by importance sampling (Harrison 2012), which can return smaller values; use
RARE-TOO if the test is one of many.

Sums that differ only by rounding count as equal. Without numbers, or if all numbers are 0, p is 1;
for N numbers p is at least 2^(1-N). Signals WRONG-ARGUMENT unless DIFFERENCES are from -1e15 to
1e15, and RESAMPLES from 100 to 1e7."
  (check-resampling permutation-test resamples seed)
  (let* ((sample (checked-sample 'permutation-test 'differences differences))
         (sum (abs (sum sample)))
         (sizes (sort-sample (map 'doubles #'abs (remove-if #'zerop sample))))
         (grain (* 1d-13 (sum sizes)))
         (exact (exact-tail-probability sizes sum grain)))
    (if exact
        (values (min 1d0 exact) t)
        (values (estimated-tail-probability sizes sum grain resamples seed rare-too) nil))))

;;;; Several tests

(addition holm-adjusted)
(defun holm-adjusted (p-values)
  "Return a list of the P-VALUES, a list or vector, adjusted for the number of tests (Holm 1979;
Wright 1992 for the adjustment). If you call all adjusted values of at most .05 significant, the
probability that any of these results is wrong is at most .05. The order is kept, and equal p values
have equal results. Signals WRONG-ARGUMENT unless P-VALUES are numbers from 0 to 1."
  (check-argument holm-adjusted p-values (every-element-p p-values #'probability-p)
                  "a list or vector of numbers from 0 to 1")
  (let ((shares (map 'doubles #'share-as-double p-values)))
    (loop with worth = 0d0
          for index in (stable-sort (loop for i below (length shares) collect i) #'<
                                    :key (lambda (i) (aref shares i)))
          for left downfrom (length shares)
          do (setf worth (max worth (min 1d0 (* left (aref shares index))))
                   (aref shares index) worth))
    (coerce shares 'list)))

;;;; Looking at results while they come in

(addition sequential-level)
(defun sequential-level (look &key (level .05d0))
  "Return the level for the LOOK-th look at growing results: LEVEL / (LOOK (LOOK + 1)). The levels
of all looks add up to LEVEL. So you may look again and again: if each time you take an interval
with a confidence of 1 minus the returned level, the probability that any of these intervals is
wrong is at most LEVEL (Bonferroni's inequality, spent as in Lan and DeMets 1983). Signals
WRONG-ARGUMENT unless LOOK is an integer from 1 to 100,000, and LEVEL between 0 and 1."
  (check-argument sequential-level look (whole-p look 1 100000) "an integer from 1 to 100000")
  (/ (checked-unit-share sequential-level level) (* look (1+ look))))

(defun log-evidence (successes trials rate)
  (declare (type double-float rate))
  (- 0d0 (logarithm (double (1+ trials)))
     (log-binomial-density (double successes) (double (- trials successes)) rate (- 1 rate))))

(addition rate-evidence)
(defun rate-evidence (successes trials rate)
  "Return the evidence that SUCCESSES successes in TRIALS trials give against a probability of
success of RATE. The evidence is the logarithm of a likelihood ratio: the average likelihood over
all probabilities, weighted equally, divided by the likelihood of RATE. If the true probability is
RATE, the probability that the evidence ever exceeds log(1/LEVEL) is at most LEVEL (Ville 1939;
Robbins 1970, the mixture of binomials; Howard, Ramdas, McAuliffe and Sekhon 2021). Without trials
the evidence is 0; a value below 0 supports RATE. Signals WRONG-ARGUMENT unless TRIALS is an integer
from 0 to 1e9, SUCCESSES from 0 to TRIALS, and RATE between 0 and 1."
  (check-trials rate-evidence successes trials)
  (log-evidence successes trials (checked-unit-share rate-evidence rate)))

(addition rate-verdict)
(defun rate-verdict (successes trials rate &key (level .05d0))
  "Return :ABOVE or :BELOW if SUCCESSES successes in TRIALS trials show that the probability of
success is above or below RATE; or NIL if they do not show either yet. You may call this function
after each trial and stop when the value is not NIL: if the true probability is RATE, the
probability that you ever stop is at most LEVEL, between 0 and 1. For errors see RATE-EVIDENCE."
  (check-trials rate-verdict successes trials)
  (let ((rate (checked-unit-share rate-verdict rate)))
    (when (>= (log-evidence successes trials rate)
              (- (logarithm (checked-unit-share rate-verdict level))))
      (if (> successes (* rate trials)) :above :below))))
