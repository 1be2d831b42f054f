;;;; charts.lisp -- the charts of an experiment's results, as SVG documents.

(in-package :ars-magna.experiment)

;;; The first factor whose values are numbers is the x axis. The others make series, and if these
;;; are too many, several pictures. Factors are given by their places in SAMPLE-TEXTS.

(defconstant +most-series+ 6 "The most series in a picture.")

(defstruct (panel (:constructor make-panel (where title series)) (:copier nil))
  "The conditions that one picture shows. WHERE is a text on what the conditions have in common, or
NIL. SERIES are lists (name sample...); a single series has the name NIL. TITLE is the factor whose
values are the names of series, if there is only one such factor."
  (where nil :type (or null string) :read-only t)
  (title nil :type (or null string) :read-only t)
  (series '() :type list :read-only t))

;;; Factors.

(defun x-axis-factor (results)
  "Return the index of the factor on the x axis of pictures of RESULTS, or NIL if nothing varies."
  (let ((free (varying-factors results)))
    (or (find-if (lambda (place) (every #'number-from-text (levels results place))) free)
        (first free))))

(defun series-factors (results)
  (remove (x-axis-factor results) (varying-factors results)))

;;; Series and panels.

(defun sample-name-by-factors (sample places factors)
  "Name SAMPLE by its levels of the factors with indices PLACES. Return NIL if PLACES is empty."
  (and places
       (level-names (loop for place in places collect (nth place factors))
                    (loop for place in places collect (sample-level-text place sample)))))

(defun series-title (places factors)
  (and places (null (rest places)) (nth (first places) factors)))

(defun series-name (sample places factors)
  (let ((text (and (series-title places factors) (sample-level-text (first places) sample))))
    (if (and text (string/= "" text))
        text
        (sample-name-by-factors sample places factors))))

(defun group-series (samples places factors)
  (loop for group in (group-by samples (lambda (sample) (series-name sample places factors)))
        collect (cons (series-name (first group) places factors) group)))

(defun split-evenly (list most)
  "Split LIST into lists of about equal length, each of at most MOST elements."
  (let* ((count (length list)) (size (ceiling count (max 1 (ceiling count most)))))
    (loop while list
          collect (loop repeat size while list collect (pop list)))))

(defun split-into-panels (series where title)
  (loop with chunks = (split-evenly series +most-series+)
        for chunk in chunks
        for number from 1
        collect (make-panel (format nil "~@[~A, ~]~D of ~D" where number (length chunks))
                            title chunk)))

(defun panels (samples places factors &optional where)
  "Return as few panels as SAMPLES need. The FACTORS with the indices PLACES make the series."
  (let ((series (group-series samples places factors)) (title (series-title places factors)))
    (cond ((<= (length series) +most-series+) (list (make-panel where title series)))
          ((null (rest places)) (split-into-panels series where title))
          (t (let ((last (last places)))
               (loop for group in (group-by samples
                                           (lambda (sample)
                                             (sample-name-by-factors sample last factors)))
                     append (panels group (butlast places) factors
                                    (format nil "~@[~A ~]~A" where
                                            (sample-name-by-factors (first group) last
                                                                    factors)))))))))

;;;; Charts

;;; A picture is a list (name where chart): what is shown, the part of the conditions or NIL, and
;;; the chart, an SVG document.

;;; Titles.

(defun picture-title (results)
  (let ((name (sample-experiment (first (results-samples results)))))
    (or (question-of name) name)))

(defun subtitle (panel &rest sentences)
  "Return a text: what the conditions of PANEL have in common, then SENTENCES, strings or NIL."
  (format nil "~@[~A. ~]~{~A~^ ~}" (panel-where panel) (remove nil sentences)))

(defun errors-text (summaries)
  "Return a sentence on the trials of SUMMARIES that ended with an error; \"\" if none did."
  (let ((count (reduce #'+ summaries :key #'summary-errors)))
    (if (zerop count)
        ""
        (format nil " ~D trial~:P broke off with an error, and did not succeed." count))))

(defun intervals-text (kind summaries)
  "Return a sentence on the intervals of estimates of KIND in SUMMARIES, followed by ERRORS-TEXT."
  (format nil "~A intervals~:[ of 95 %~;, with the confidence of the last look~]; ~
               ~A.~A"
          (statistic-option kind :interval)
          (some (lambda (summary) (/= .95d0 (summary-confidence summary))) summaries)
          (trials-text summaries)
          (errors-text summaries)))

;;; Estimates against the factor on the x axis.

(defun x-value (text)
  (or (number-from-text text) (if (string= "" text) "none" text)))

(defun logarithmic-x-p (numbers)
  (and (cddr numbers) (every #'realp numbers) (every #'plusp numbers)
       (<= 50 (/ (reduce #'max numbers) (reduce #'min numbers)))))

(defun chart-series (panel place estimate-of)
  (loop for (name . samples) in (panel-series panel)
        collect (cons name (loop for sample in samples
                                 for estimate = (funcall estimate-of sample)
                                 collect (list (if place (x-value (sample-level-text place sample))
                                                   "all")
                                               (estimate-value estimate) (estimate-low estimate)
                                               (estimate-high estimate))))))

(defun estimates-charts (results summaries name y-label words reader)
  (let* ((place (x-axis-factor results)) (factors (results-factors results))
         (table (pairlis (results-samples results) summaries))
         (kind (estimate-kind (funcall reader (first summaries)))))
    (flet ((estimate-of (sample) (funcall reader (cdr (assoc sample table)))))
      (loop for panel in (panels (results-samples results) (series-factors results) factors)
            for series = (chart-series panel place #'estimate-of)
            collect (list name (panel-where panel)
                          (line-chart series
                                      :percent (eq :rate kind)
                                      :log-x (and place
                                                  (logarithmic-x-p
                                                   (mapcar #'x-value (levels results place))))
                                      :title (picture-title results)
                                      :subtitle (subtitle panel words
                                                          (intervals-text kind summaries))
                                      :x-label (and place (nth place factors))
                                      :legend-title (panel-title panel)
                                      :y-label y-label))))))

(defun success-pictures (results summaries)
  (estimates-charts results summaries "success" "trials that succeed" nil #'summary-success))

(defun any-value-p (estimates) (some #'estimate-value estimates))

(defun ticks-pictures (results summaries)
  (when (any-value-p (mapcar #'summary-ticks summaries))
    (estimates-charts results summaries "ticks" "ticks"
                      "Ticks of the trials that succeed: median." #'summary-ticks)))

;;; Measures.

(defconstant +most-rows+ 30 "The most rows of a picture.")

(defun row-pictures (name rows chart)
  (loop with chunks = (split-evenly rows +most-rows+)
        for chunk in chunks
        for number from 1
        collect (list name (and (rest chunks) (integer-text number)) (funcall chart chunk))))

(defun spread-pictures (results summaries place)
  (let ((name (nth place (results-measures results))))
    (row-pictures (format nil "spread-of-~A" name)
                  (loop for sample in (results-samples results)
                        for summary in summaries
                        for estimate = (nth place (summary-measures summary))
                        for values = (sample-measure results sample name)
                        collect (list (sample-condition sample)
                                      (remove-if-not #'finite-value-p values)
                                      (estimate-value estimate) (estimate-low estimate)
                                      (estimate-high estimate)))
                  (lambda (rows)
                    (measure-chart rows :middle-label "mean" :title (picture-title results)
                                        :x-label name
                                        :subtitle (intervals-text :mean summaries))))))

(defun measure-pictures (results summaries)
  (loop for name in (results-measures results)
        for place from 0
        for estimates = (loop for summary in summaries
                              collect (nth place (summary-measures summary)))
        for kind = (estimate-kind (first estimates))
        when (and (member kind '(:rate :mean)) (any-value-p estimates))
          append (let ((place place))
                   (estimates-charts results summaries (format nil "measure-~A" name) name
                                     (format nil "~@(~A~): ~:[mean~;share of trials~]." name
                                             (eq :rate kind))
                                     (lambda (summary) (nth place (summary-measures summary)))))
        when (and (eq :mean kind) (any-value-p estimates))
          append (spread-pictures results summaries place)))

;;; Survival. A trial without success is never done: it counts until the end, not censored earlier.

(defun tick-limit (results)
  "Return the tick limit of RESULTS' experiment, or the most ticks of a trial if it is not loaded."
  (let ((experiment (find-experiment (sample-experiment (first (results-samples results))) nil)))
    (if experiment
        (experiment-limit experiment)
        (loop for sample in (results-samples results)
              maximize (reduce #'max (remove :none (sample-ticks sample)) :initial-value 0)))))

(defun horizon (samples limit)
  "Return the tick until which curves are drawn: a little after the last success of SAMPLES."
  (let ((last (loop for sample in samples
                    maximize (reduce #'max (values-with-outcome #'success-p sample
                                                                (sample-ticks sample))
                                     :initial-value 0))))
    (max last (min limit (ceiling (* 21/20 last))))))

(defun sample-curve (name sample horizon confidence band-p)
  "Return the curve of SAMPLE for SURVIVAL-CHART, until the tick HORIZON, with bands if BAND-P."
  (let* ((events (cl:map 'vector #'success-p (sample-outcomes sample)))
         (times (cl:map 'vector (lambda (ticks done-p) (if done-p ticks horizon))
                        (sample-ticks sample) events)))
    (list name :times times
               :steps (loop for (time nil nil survival low high)
                              in (survival-curve times events :confidence confidence)
                            collect (list time survival (and band-p low) (and band-p high))))))

(defconstant +most-bands+ 4 "The most curves that have bands; more would hide each other.")

(defun survival-text (band-p results)
  (format nil "Kaplan and Meier's estimate~@[, with bands of ~A~]. Trials that fail, break off or ~
               reach the limit of ~D ticks are never done."
          (and band-p (if (results-until results) "the last look's confidence" "95 %"))
          (tick-limit results)))

(defun survival-picture (results panel horizon errors)
  (let ((band-p (<= (length (panel-series panel)) +most-bands+)))
    (list
     "survival" (panel-where panel)
     (survival-chart (loop for (name sample) in (panel-series panel)
                           collect (sample-curve name sample horizon (confidence-for results sample)
                                                 band-p))
                     :title (picture-title results)
                     :subtitle (subtitle panel (concatenate 'string
                                                            (survival-text band-p results)
                                                            errors))
                     :x-label "ticks" :y-label "trials not yet done"
                     :legend-title (panel-title panel)
                     :risk-label "trials not yet done"))))

(defun survival-pictures (results summaries)
  (let ((samples (results-samples results)))
    (when (any-value-p (mapcar #'summary-ticks summaries))
      (loop with horizon = (horizon samples (tick-limit results))
            for panel in (panels samples (varying-factors results) (results-factors results))
            collect (survival-picture results panel horizon (errors-text summaries))))))

;;; Differences.

(defun pairs-by-factor (results place)
  "Return two values: pairs of samples of RESULTS that differ only in the factor with index PLACE,
and T. The second sample of a pair has the factor's first level. If there is no such pair, pair each
other sample with the first sample, and return NIL as the second value."
  (let ((pairs (pairs-differing-in-factor results place nil (first (levels results place)))))
    (if pairs
        (values pairs t)
        (loop with first = (first (results-samples results))
              for other in (rest (results-samples results))
              collect (list other first)))))

(defun comparison-by-factor (results place measure)
  "Compare RESULTS in MEASURE by the factor with index PLACE, as COMPARE-LEVELS does. Return the
comparison, or NIL if there is nothing to compare."
  (multiple-value-bind (pairs equal-p) (pairs-by-factor results place)
    (let ((pairs (remove-if-not (lambda (pair) (apply #'common-trials pair)) pairs)))
      (and pairs
           (comparison-of-conditions results pairs (and equal-p place) (list measure) nil)))))

(defun contrasts-with-measure (measure comparison)
  (remove-if-not (lambda (contrast)
                   (let ((difference (find-difference measure contrast)))
                     (or (same-runs-p contrast)
                         (and difference (paired-estimate difference)))))
                 (all-contrasts comparison)))

(defun difference-pictures (results summaries)
  (declare (ignore summaries))
  (loop for place in (varying-factors results)
        append (loop for measure in '("success" "ticks")
                     for comparison = (comparison-by-factor results place measure)
                     when comparison
                       append (row-pictures
                               (format nil "difference-in-~A-by-~A" measure
                                       (nth place (results-factors results)))
                               (contrasts-with-measure measure comparison)
                               (lambda (contrasts)
                                 (comparison-chart comparison measure :contrasts contrasts))))))
