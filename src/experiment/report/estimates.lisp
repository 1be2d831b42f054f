;;;; estimates.lisp -- summaries of columns of a table: rates, means, medians, or texts.

(in-package :ars-magna.experiment)

;;; Large numbers are multiplied by a power of two, which changes no digit, and results are divided
;;; by it. Numbers some 1e250 times smaller than the largest count as 0.

(defun nearest-float (number)
  "Return the double-float nearest to NUMBER, or NUMBER itself if NUMBER is too large."
  (if (finite-p number) (double number) number))

(defun subtract-numbers (a b)
  "Return A minus B: a float if A or B is a float, unless the difference is too large for a float."
  (if (and (rationalp a) (rationalp b))
      (- a b)
      (nearest-float (- (rational a) (rational b)))))

(defun scale-of-numbers (numbers)
  "Return the power of two by which to multiply NUMBERS so that they are from -5e14 to 5e14."
  (let ((largest (reduce #'max numbers :key #'abs :initial-value 0)))
    (if (<= largest (/ +largest-quantity+ 2))
        1
        (expt 2 (- 48 (integer-length (ceiling (rational largest))))))))

(defun scale-number (number scale)
  "Return NUMBER times SCALE; 0 if the product is too small for a float."
  (if (= 1 scale)
      number
      (let ((product (* (rational number) scale)))
        (if (< (abs product) #.(expt 2 -900)) 0 (double product)))))

(defun unscale-number (number scale)
  (if (or (null number) (= 1 scale))
      number
      (nearest-float (/ (rational number) scale))))

;;;; Estimates

;;; The estimate of a measure is a rate if the values are always true or false. If there are
;;; numbers, it is their mean; other values are left out, and counted. Else it is texts. All
;;; conditions together decide, so that each has the same kind. :NONE does not count.

(addition estimate-p)
(define-record (estimate (:constructor make-estimate
                             (name kind count &key value low high (left-out 0) texts beside)))
  "The summary of a column of the table under one condition."
  (name "" string "what was measured, a string: success, ticks, or the name of a measure" :addition)
  (kind :nothing keyword ":RATE for values that are always true or false, :MEAN for numbers, :MEDIAN
for ticks, :TEXTS for others, :NOTHING if no condition has values" :addition)
  (count 0 integer "the number of trials with a value; for ticks, of successes" :addition)
  (value nil (or null real)
         "the rate, from 0 to 1, the mean or the median; NIL for texts, or if there are no values"
:addition)
  (low nil (or null real)
       "the low bound of the interval; NIL if there are too few values" :addition)
  (high nil (or null real)
        "the high bound of the interval; NIL if there are too few values" :addition)
  (left-out 0 integer "how many values are left out because they are not numbers" :addition)
  (texts '() list "an alist from texts to counts, commonest first" :addition)
  (beside '() list "estimates of the same values by other statistics"))

(defmethod print-object ((estimate estimate) stream)
  (print-unreadable-object (estimate stream)
    (format stream "~A: ~(~A~) of ~D~@[, ~F~]" (estimate-name estimate) (estimate-kind estimate)
            (estimate-count estimate) (estimate-value estimate))))

;;; Kinds.

(defun kind-of-values (columns)
  "Return the kind of estimates for COLUMNS, the values of one measure under all conditions."
  (flet ((some-value (test)
           (some (lambda (column) (some test column)) columns)))
    (cond ((some-value #'finite-value-p) :mean)
          ((some-value (lambda (value) (not (typep value '(or boolean (eql :none)))))) :texts)
          ((some-value (lambda (value) (typep value 'boolean))) :rate)
          (t :nothing))))

(defun count-texts (texts)
  "Return an alist from the strings TEXTS to their counts, commonest first."
  (let ((counts (make-hash-table :test 'equal)))
    (cl:map nil (lambda (text) (incf (gethash text counts 0))) texts)
    (sort (loop for text being the hash-keys of counts using (hash-value count)
                collect (cons text count))
          (lambda (a b)
            (or (> (cdr a) (cdr b))
                (and (= (cdr a) (cdr b)) (string< (car a) (car b))))))))

;;; Statistics: how values and intervals are computed.

(defvar *statistics* '() "Lists (kind function . options), in order of definition.")

(defmacro define-statistic (kind (values confidence) (&rest options) &body body)
  "Define estimates of KIND. For VALUES, a vector that is not empty, BODY returns three values: the
estimate and the two bounds of its interval at CONFIDENCE. Any of these may be NIL. OPTIONS are
  :heading text   what headings of tables add to the name of the measure;
  :interval text  the name of the intervals of KIND in pictures;
  :beside other   tables have a column of KIND beside each column of the kind OTHER.
Return KIND."
  `(progn
     (setf *statistics*
           (append (remove ,kind *statistics* :key #'first)
                   (list (list* ,kind (lambda (,values ,confidence) ,@body) ',options))))
     ,kind))

(defun statistic-option (kind option)
  (getf (cddr (assoc kind *statistics*)) option))

(define-statistic :rate (truths confidence) (:heading " %" :interval "Wilson's")
  (let ((true (count t truths)) (trials (length truths)))
    (multiple-value-bind (low high) (wilson-interval true trials :confidence confidence)
      (values (/ true trials) low high))))

(define-statistic :mean (numbers confidence) (:heading ", mean" :interval "Student's")
  (let* ((scale (scale-of-numbers numbers))
         (sample (cl:map 'vector (lambda (number) (scale-number number scale)) numbers)))
    (multiple-value-bind (low high) (student-interval sample :confidence confidence)
      (values (unscale-number (mean sample) scale) (unscale-number low scale)
              (unscale-number high scale)))))

(define-statistic :median (numbers confidence) (:heading ", median" :interval "Rank")
  (multiple-value-bind (low high) (median-interval numbers :confidence confidence)
    (values (median numbers) low high)))

(defun apply-statistic (kind name values confidence &optional (left-out 0))
  (multiple-value-bind (value low high)
      (if (zerop (length values))
          (values nil nil nil)
          (funcall (second (assoc kind *statistics*)) values confidence))
    (make-estimate name kind (length values)
                   :value value :low low :high high :left-out left-out
                   :beside (loop for (other) in *statistics*
                                 when (eq kind (statistic-option other :beside))
                                   collect (apply-statistic other name values confidence)))))

(defun estimate-of-values (name kind column confidence)
  (let ((values (remove :none column)))
    (ecase kind
      (:nothing (make-estimate name kind 0))
      (:rate (apply-statistic :rate name values confidence))
      (:mean (let ((numbers (remove-if-not #'finite-value-p values)))
               (apply-statistic :mean name numbers confidence
                                 (- (length values) (length numbers)))))
      (:texts (make-estimate name kind (length values)
                             :texts (count-texts (cl:map 'list #'value-text values)))))))

;;;; Summaries of conditions

;;; A trial that ended with an error did not succeed. Where trials were added until intervals were
;;; narrow, all intervals of a condition have the confidence of the look at which it stopped.

(addition summary-p)
(define-record summary
  "The summary of the trials of one condition; see SUMMARIZE-RESULTS."
  (condition "" string "the name of the condition, a string" :addition)
  (texts '() list "the values of the factors, strings as in the table" :addition)
  (trials 0 integer "how many trials there are" :addition)
  (failures 0 integer "how many trials failed" :addition)
  (limits 0 integer "how many trials reached the limit of ticks" :addition)
  (errors 0 integer "how many trials ended with an error" :addition)
  (timeouts 0 integer "how many trials took too much real time")
  (confidence .95d0 double-float "the confidence of the intervals, usually .95" :addition)
  (success nil estimate "the estimate of the rate of success" :addition)
  (ticks nil estimate "the estimate of the ticks of trials that succeed" :addition)
  (measures '() list "a list of the estimates of measures, in the table's order" :addition)
  (reasons '() list
           "an alist from the reasons of failure to their counts, commonest first" :addition))

(defmethod print-object ((summary summary) stream)
  (print-unreadable-object (summary stream)
    (format stream "~A, ~D trials" (summary-condition summary) (summary-trials summary))))

(defun count-outcomes (outcome sample)
  (count outcome (sample-outcomes sample) :test #'string=))

(defun values-with-outcome (test sample values)
  "Return a vector of the elements of VALUES for trials of SAMPLE whose outcome passes TEST."
  (let ((outcomes (sample-outcomes sample)))
    (coerce (loop for value across values
                  for outcome across outcomes
                  when (funcall test outcome) collect value)
            'vector)))

(defun failed-p (outcome) (string= "failure" outcome))

(defun interim-look-number (trials)
  "If there is an interim look after TRIALS trials of each condition, return its number; else NIL."
  (loop for look from 1
        for count = (count-at-look look)
        while (<= count trials)
        when (= count trials) return look))

(defun confidence-for (results sample)
  (let ((look (and (results-until results) (interim-look-number (length (sample-trials sample))))))
    (if look (confidence-at-look look) .95d0)))

(defun summarize-sample (sample names kinds confidence)
  (let ((trials (length (sample-trials sample))))
    (make-summary
     :condition (sample-condition sample) :texts (sample-texts sample)
     :trials trials
     :failures (count-outcomes "failure" sample) :limits (count-outcomes "limit" sample)
     :errors (count-outcomes "error" sample) :timeouts (count-outcomes "timeout" sample)
     :confidence confidence
     :success (apply-statistic :rate "success" (cl:map 'vector #'success-p (sample-outcomes sample))
                               confidence)
     :ticks (apply-statistic :median "ticks"
                             (values-with-outcome #'success-p sample (sample-ticks sample))
                             confidence)
     :measures (loop for name in names
                     for kind in kinds
                     for column in (sample-measures sample)
                     collect (estimate-of-values name kind column confidence))
     :reasons (count-texts (values-with-outcome #'failed-p sample (sample-reasons sample))))))

(addition summarize-results)
(defun summarize-results (results)
  "Return a list of summaries of RESULTS (see RUN-EXPERIMENT, READ-RESULTS, MERGE-RESULTS), one for
each condition, in the table's order.

  success   the rate of all trials, with Wilson's interval; a trial with an error did not succeed
  ticks     the median of the trials that succeeded, with its interval by ranks
  measures  a rate, if all values are true or false; else the mean of those values that are
            numbers, with Student's interval; without numbers, each text with its count. :NONE, and
            measures that an error prevented, do not count

Intervals have a confidence of 95 %. If trials were added until the intervals were narrow, each
interval has the confidence of its condition's last look. Then, for each condition, at most 5 of 100
runs have a wrong interval at any look. This bound holds for each condition by itself, not for all
intervals of a table together."
  (check-argument summarize-results results (results-p results)
                  "results, as RUN-EXPERIMENT and READ-RESULTS return them")
  (let* ((samples (results-samples results))
         (names (results-measures results))
         (kinds (loop for place from 0 below (length names)
                      collect (kind-of-values (loop for sample in samples
                                                    collect (nth place
                                                                 (sample-measures sample)))))))
    (loop for sample in samples
          collect (summarize-sample sample names kinds (confidence-for results sample)))))
