;;;; deciding.lisp -- whether a rate of success is high enough, after as few trials as possible.

(in-package :ars-magna.fiveam)

(export '(pass-probability))

;;; A suite with false alarms is soon ignored. So the test is whether the rate is below the required
;;; one, and LEVEL bounds the probability of a false alarm. Half of LEVEL is for RATE-VERDICT after
;;; each trial, which allows any number of looks. The other half is for the exact interval at the
;;; end. So trials can end early with either answer.

(defun early-verdict (successes trials rate level)
  "Return :PASSED, :FAILED or NIL for SUCCESSES successes in TRIALS trials, before the last trial."
  (if (= rate 1)
      (if (= successes trials) nil :failed)
      (ecase (rate-verdict successes trials rate :level (/ level 2))
        (:above :passed)
        (:below :failed)
        ((nil) nil))))

(defun final-verdict (successes trials rate level)
  (if (< (nth-value 1 (exact-interval successes trials :confidence (- 1 level))) rate)
      :failed
      :passed))

(defun verdict (successes trials most rate level)
  "Return :PASSED, :FAILED, or NIL if more trials are needed, for SUCCESSES successes in TRIALS
trials. MOST is the largest number of trials."
  (or (early-verdict successes trials rate level)
      (and (= trials most) (final-verdict successes trials rate level))))

;;; The probability that a check passes, over all possible courses.

(defun check-rate-arguments (operator at-least trials level)
  (unless (and (finite-p at-least) (<= 1d-9 at-least 1))
    (reject-argument operator 'at-least at-least "a rate above 0 and up to 1, such as .95"))
  (unless (and (integerp trials) (<= 1 trials +largest+))
    (reject-argument operator 'trials trials "the largest number of trials, from 1 to 1e9"))
  (unless (and (finite-p level) (<= 1d-9 level 1/2))
    (reject-argument operator 'level level "a probability from 1e-9 to .5, such as .05")))

(defun probabilities-after-trial (odds count rate)
  "Return a vector of the probabilities of 0 to COUNT successes. ODDS is the same vector for 0 to
COUNT - 1 successes before the last trial, which succeeds with the probability RATE."
  (let ((next (make-array (1+ count) :initial-element 0)))
    (loop for successes below count
          for share = (aref odds successes)
          do (incf (aref next successes) (* share (- 1 rate)))
             (incf (aref next (1+ successes)) (* share rate)))
    next))

(defun pass-probability (rate &key (at-least .95) (trials 200) (level .05))
  "Return the probability that a check by IS-SUCCESS-RATE with these arguments passes, and the mean
number of trials. RATE is the probability that a trial succeeds. Use this function to see which
rates a check accepts: with the defaults, a rate of 95 % passes with a probability of .97, 90 % with
.20, and 85 % with .003. Both values are exact except for rounding: PASS-PROBABILITY adds up all
sequences of successes and failures, which takes a second for 5,000 trials. Signals WRONG-ARGUMENT."
  (check-argument pass-probability rate (probability-p rate) "a number from 0 to 1")
  (check-rate-arguments 'pass-probability at-least trials level)
  (let ((rate (share-as-double rate)) (at-least (share-as-double at-least))
        (level (share-as-double level))
        (odds (vector 1)) (passed 0) (run 0))
    (loop for count from 1 to trials
          do (incf run (reduce #'+ odds))
             (setf odds (probabilities-after-trial odds count rate))
             (loop for successes to count
                   for verdict = (and (plusp (aref odds successes))
                                      (verdict successes count trials at-least level))
                   when verdict
                     do (when (eq :passed verdict) (incf passed (aref odds successes)))
                        (setf (aref odds successes) 0)))
    (values (min 1d0 (double passed)) (double run))))
