;;;; sequential.lisp -- looking at results while they come in, without fooling oneself.

(in-package :ars-magna.statistics)

(addition sequential-level)
(defun sequential-level (look &key (level .05d0))
  "Return the share of LEVEL that may be spent at LOOK, 1, 2, 3 ...: LEVEL / (LOOK (LOOK + 1)). As
these add up to LEVEL, whoever looks at growing results again and again, and takes an interval with
a confidence of 1 less that share each time, errs in any of them with a probability of at most
LEVEL (Bonferroni's inequality, spent as in Lan and DeMets 1983). Signals WRONG-ARGUMENT unless
LOOK is an integer from 1 to 100,000, and LEVEL between 0 and 1."
  (check-argument sequential-level look (whole-p look 1 100000) "an integer from 1 to 100000")
  (/ (check-share sequential-level level) (* look (1+ look))))

(defun log-evidence (successes trials rate)
  (declare (type double-float rate))
  (- 0d0 (logarithm (double (1+ trials)))
     (log-binomial-density (double successes) (double (- trials successes)) rate (- 1 rate))))

(addition rate-evidence)
(defun rate-evidence (successes trials rate)
  "Return how much SUCCESSES of TRIALS speak against success having the probability RATE: the
logarithm of how much more likely they are on average over all probabilities, each as likely as
another. If the probability is RATE, it ever exceeds log(1/LEVEL), at whatever number of trials,
with a probability of at most LEVEL (Ville 1939; Robbins 1970, the mixture of binomials; Howard,
Ramdas, McAuliffe and Sekhon 2021). 0 of no trials; below 0 it speaks for RATE. Signals
WRONG-ARGUMENT unless TRIALS is an integer from 0 to 1e9, SUCCESSES from 0 to TRIALS, and RATE
between 0 and 1."
  (check-trials rate-evidence successes trials)
  (log-evidence successes trials (check-share rate-evidence rate)))

(addition rate-verdict)
(defun rate-verdict (successes trials rate &key (level .05d0))
  "Return :ABOVE or :BELOW if SUCCESSES of TRIALS show that success is more, or less, probable than
RATE, and NIL if they do not say yet. It may be asked after each trial, and the trials stopped when
it answers: whoever does so is told of a difference where there is none with a probability of at
most LEVEL. See RATE-EVIDENCE, also for errors; LEVEL is between 0 and 1."
  (check-trials rate-verdict successes trials)
  (let ((rate (check-share rate-verdict rate)))
    (when (>= (log-evidence successes trials rate) (- (logarithm (check-share rate-verdict level))))
      (if (> successes (* rate trials)) :above :below))))
