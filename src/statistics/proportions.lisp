;;;; proportions.lisp -- how large a probability is, of which so many trials were seen to succeed.

(in-package :ars-magna.statistics)

(declaim (inline wilson-low))
(defun wilson-low (successes failures z)
  "Return the lower bound: it is square over sum, as the product of both bounds is known, so that
no digit is lost near 0."
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
        (values (wilson-low successes failures z)
                (- 1 (wilson-low failures successes z))))))

(addition wilson-interval)
(defun wilson-interval (successes trials &key (confidence .95d0))
  "Return the bounds, low and high, of the score interval for the probability of success (Wilson
1927; Newcombe 1998, \"Two-sided confidence intervals for the single proportion\", method 3). On
average over probabilities it holds the true one as often as CONFIDENCE says; near 0 and 1 it may
not, where EXACT-INTERVAL does. Of no trials the bounds are 0 and 1; of no success, low is 0; of no
failure, high is 1. Signals WRONG-ARGUMENT unless TRIALS is an integer from 0 to 1e9, SUCCESSES
from 0 to TRIALS, and CONFIDENCE between 0 and 1."
  (check-trials wilson-interval successes trials)
  (wilson-bounds successes trials (normal-reach (check-share wilson-interval confidence))))

(defun exact-low (successes trials tail)
  "Return the probability of success that makes SUCCESSES or more of TRIALS as likely as TAIL, and
that of failure."
  (if (zerop successes)
      (values 0d0 1d0)
      (beta-quantile tail (double successes) (double (- trials successes -1)))))

(addition exact-interval)
(defun exact-interval (successes trials &key (confidence .95d0))
  "Return the bounds, low and high, of the exact interval for the probability of success (Clopper
and Pearson 1934; Newcombe 1998, method 5). It holds the true one at least as often as CONFIDENCE
says, whatever that is, and so is wider than WILSON-INTERVAL, which see for the edges and errors."
  (check-trials exact-interval successes trials)
  (let ((tail (/ (- 1 (check-share exact-interval confidence)) 2)))
    (values (nth-value 0 (exact-low successes trials tail))
            (nth-value 1 (exact-low (- trials successes) trials tail)))))
