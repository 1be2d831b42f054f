;;;; survival.lisp -- survival curves and the log-rank test, for times some of which are censored.

(in-package :ars-magna.statistics)

;;; If one time is an event and an equal time is censored, the censoring counts as later.

(defun check-survival-arguments (operator times-name times events-name events)
  "Signal WRONG-ARGUMENT unless TIMES and EVENTS are valid and have the same length. TIMES-NAME and
EVENTS-NAME are their names as arguments of OPERATOR."
  (unless (every-element-p times #'amount-p)
    (reject-argument operator times-name times "a list or vector of numbers from 0 to 1e15"))
  (unless (every-element-p events (lambda (event) (member event '(t nil 1 0))))
    (reject-argument operator events-name events
                     "a list or vector of T or 1 (done at that time) and NIL or 0 (censored)"))
  (check-same-length operator events-name events times))

(defun sorted-events (times events &optional mark)
  "Return a vector of lists (time done-p mark) for TIMES and EVENTS, sorted by time."
  (sort (map 'vector (lambda (time event) (list time (and (member event '(t 1)) t) mark))
             times events)
        #'< :key #'first))

(defun next-time-start (dated start)
  "Return the index of the first element of DATED that is later than the element at START."
  (or (position (first (aref dated start)) dated :key #'first :test #'/= :start start)
      (length dated)))

(defun map-event-times (function dated)
  "DATED is a value of SORTED-EVENTS. For each time at which a trial was done, call FUNCTION with
the start and end index of the elements of DATED that have this time."
  (loop with start = 0
        while (< start (length dated))
        do (let ((end (next-time-start dated start)))
             (when (find t dated :key #'second :start start :end end)
               (funcall function start end))
             (setf start end))))

(defun count-done-trials (dated start end)
  (count t dated :key #'second :start start :end end))

;;; The curve.

(defun survival-bounds (survival variance z highest)
  "Return the bounds, low and high, for SURVIVAL, for which Greenwood's sum is VARIANCE. If SURVIVAL
is 0, the high bound is HIGHEST, the high bound of the previous step."
  (if (zerop survival)
      (values 0d0 highest)
      (let ((factor (exponential (/ (* z (sqrt variance)) (- (logarithm survival))))))
        (values (power survival factor) (power survival (/ factor))))))

(addition survival-curve)
(defun survival-curve (times events &key (confidence .95d0))
  "Return the survival curve, the share of trials that take longer than each time, by the
product-limit estimate (Kaplan and Meier 1958). The curve is a list of steps (time at-risk done
survival low high), one for each time at which a trial was done; it is empty if no trial was done.
TIMES and EVENTS are lists or vectors with an element for each trial. The event is T (or 1) if the
trial was done at its time, NIL (or 0) if it was censored (cut short) at its time, for example by a
limit of ticks.

LOW and HIGH are the bounds of the survival at the time of the step, by Greenwood's formula on the
scale of log(-log) (Kalbfleisch and Prentice 2002, chapter 1). The formula gives no bounds for a
survival of 0: then LOW is 0, and HIGH is the previous HIGH, or 1. Signals WRONG-ARGUMENT unless
TIMES are from 0 to 1e15, EVENTS has the same length, and CONFIDENCE is between 0 and 1."
  (check-survival-arguments 'survival-curve 'times times 'events events)
  (let* ((z (normal-critical-value (checked-unit-share survival-curve confidence)))
         (dated (sorted-events times events)) (size (length dated))
         (survival 1d0) (variance 0d0) (highest 1d0) (steps '()))
    (flet ((note (start end)
             (let* ((at-risk (- size start)) (done (count-done-trials dated start end))
                    (left (- at-risk done)))
               (setf survival (* survival (/ (double left) at-risk)))
               (when (plusp left) (incf variance (/ (double done) at-risk left)))
               (multiple-value-bind (low high) (survival-bounds survival variance z highest)
                 (push (list (first (aref dated start)) at-risk done survival low high) steps)
                 (setf highest high)))))
      (map-event-times #'note dated))
    (nreverse steps)))

(addition median-survival)
(defun median-survival (curve)
  "Return the median survival time of CURVE, a result of SURVIVAL-CURVE, and its bounds, low and
high. The median is the first time at which the survival is a half or less. Low and high are the
first times at which the low and the high bound of the survival are a half or less (Brookmeyer and
Crowley 1982). A value is NIL if there is no such time. Signals WRONG-ARGUMENT."
  (check-argument median-survival curve
                  (and (proper-list-p curve)
                       (every (lambda (step)
                                (and (proper-list-p step) (= 6 (length step)) (every #'realp step)))
                              curve))
                  "a survival curve, as SURVIVAL-CURVE returns")
  (flet ((halved (reader)
           (first (find-if (lambda (step) (<= (funcall reader step) (+ .5d0 1d-12))) curve))))
    (values (halved #'fourth) (halved #'fifth) (halved #'sixth))))

;;; Two groups.

(defun log-rank-expectation-and-variance (at-risk first-at-risk done)
  "At some time, AT-RISK trials are at risk, FIRST-AT-RISK of them in the first group, and DONE
events occur. Return the expected number of events in the first group, and the number's variance."
  (let ((share (/ first-at-risk at-risk)))
    (values (* done share)
            (if (= at-risk 1)
                0
                (/ (* done share (- 1 share) (- at-risk done)) (1- at-risk))))))

(defun log-rank-sums (dated)
  "Return the observed number of events of the first group in DATED, the expected number, and its
variance. Elements of the first group are marked."
  (let ((observed 0) (expected 0d0) (variance 0d0) (gone 0)
        (marked (count t dated :key #'third)) (seen 0))
    (flet ((note (start end)
             (incf gone (count t dated :key #'third :start seen :end start))
             (setf seen start)
             (incf observed (count-if (lambda (one) (and (second one) (third one))) dated
                                      :start start :end end))
             (multiple-value-bind (mean spread)
                 (log-rank-expectation-and-variance (- (length dated) start) (- marked gone)
                                                    (count-done-trials dated start end))
               (incf expected mean)
               (incf variance spread))))
      (map-event-times #'note dated))
    (values observed expected variance)))

(addition log-rank-test)
(defun log-rank-test (first-times first-events second-times second-events)
  "Return the p value of the log-rank test of the hypothesis that two groups take equally long
(Mantel 1966; Peto and Peto 1972). Times and events are as for SURVIVAL-CURVE. The other values are
chi-square, with one degree of freedom; the number of trials of the first group that were done; and
the expected number. If the groups cannot be compared, for example because one is empty, p is 1 and
chi-square is 0. Signals WRONG-ARGUMENT as SURVIVAL-CURVE does."
  (check-survival-arguments 'log-rank-test 'first-times first-times 'first-events first-events)
  (check-survival-arguments 'log-rank-test 'second-times second-times 'second-events second-events)
  (multiple-value-bind (observed expected variance)
      (log-rank-sums (merge 'vector (sorted-events first-times first-events t)
                            (sorted-events second-times second-events) #'< :key #'first))
    (let ((square (if (zerop variance) 0d0 (/ (expt (- observed expected) 2) variance))))
      (values (chi-square-tail square 1) square observed expected))))
