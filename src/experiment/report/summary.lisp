;;;; summary.lisp -- what came of an experiment, in a few numbers for each condition.

(in-package :ars-magna.experiment)

;;; An error in a trial's own code counts as no success. Where trials were added until intervals
;;; were narrow, all intervals of a condition have the confidence of the look that it stopped at.

(addition summary-p)
(define-record summary
  "What came of the trials of one condition, as SUMMARIZE-RESULTS says it."
  (condition "" string "what the condition is called, a string" :addition)
  (texts '() list "the values of what varies, strings as they stand in the table" :addition)
  (trials 0 integer "how many trials there are" :addition)
  (failures 0 integer "how many trials failed" :addition)
  (limits 0 integer "how many trials came to the limit of ticks" :addition)
  (errors 0 integer "how many trials broke off with an error" :addition)
  (timeouts 0 integer "how many trials took too long by the clock")
  (confidence .95d0 double-float "which confidence the intervals have, .95 as a rule" :addition)
  (success nil estimate "the estimate of how often trials succeed" :addition)
  (ticks nil estimate "the estimate of how many ticks those trials take that succeed" :addition)
  (measures '() list "a list of the estimates of what was measured, in the table's order" :addition)
  (reasons '() list
           "an alist from the reasons of failure to how often each was, commonest first" :addition))

(defmethod print-object ((summary summary) stream)
  (print-unreadable-object (summary stream)
    (format stream "~A, ~D trials" (summary-condition summary) (summary-trials summary))))

(defun count-outcomes (outcome sample)
  (count outcome (sample-outcomes sample) :test #'string=))

(defun values-where (test sample values)
  "Return a vector of those of VALUES, a vector, whose trials in SAMPLE have an outcome that passes
TEST."
  (let ((outcomes (sample-outcomes sample)))
    (coerce (loop for value across values
                  for outcome across outcomes
                  when (funcall test outcome) collect value)
            'vector)))

(defun failed-p (outcome) (string= "failure" outcome))

(defun look-after (trials)
  "Return which look is the one after TRIALS of each condition, or NIL."
  (loop for look from 1
        for count = (count-at-look look)
        while (<= count trials)
        when (= count trials) return look))

(defun confidence-for (results sample)
  (let ((look (and (results-until results) (look-after (length (sample-trials sample))))))
    (if look (confidence-at-look look) .95d0)))

(defun summarize-sample (sample names kinds confidence)
  (let ((trials (length (sample-trials sample))))
    (make-summary
     :condition (sample-condition sample) :texts (sample-texts sample)
     :trials trials
     :failures (count-outcomes "failure" sample) :limits (count-outcomes "limit" sample)
     :errors (count-outcomes "error" sample) :timeouts (count-outcomes "timeout" sample)
     :confidence confidence
     :success (estimate-by :rate "success" (cl:map 'vector #'success-p (sample-outcomes sample))
                           confidence)
     :ticks (estimate-by :median "ticks" (values-where #'success-p sample (sample-ticks sample))
                         confidence)
     :measures (loop for name in names
                     for kind in kinds
                     for column in (sample-measures sample)
                     collect (estimate-of-values name kind column confidence))
     :reasons (tally (values-where #'failed-p sample (sample-reasons sample))))))

(addition summarize-results)
(defun summarize-results (results)
  "Return what came of an experiment, of which RUN-EXPERIMENT, READ-RESULTS or MERGE-RESULTS has
returned RESULTS: a list of summaries, one for each condition, in the table's order. Success is a
rate of all trials, with Wilson's interval; what broke off with an error did not succeed. Ticks are
the median of the trials that succeeded, with its interval by ranks. What was measured is a rate if
it was always true or false; the mean, with Student's interval, if there are numbers in it, without
what else there is besides; else texts, with how often there are such. What was :NONE, or not
measured as an error came before, does not count. Intervals have a confidence of 95 %; if trials
were added until they were narrow, that of the look at which a condition stopped, so that the
intervals of a condition at all its looks together err in 5 of 100 runs at most. Each condition has
that confidence by itself; that none of a table's intervals errs has less."
  (check-argument summarize-results results (results-p results) "results")
  (let* ((samples (results-samples results))
         (names (results-measures results))
         (kinds (loop for place from 0 below (length names)
                      collect (kind-of-values (loop for sample in samples
                                                    collect (nth place
                                                                 (sample-measures sample)))))))
    (loop for sample in samples
          collect (summarize-sample sample names kinds (confidence-for results sample)))))
