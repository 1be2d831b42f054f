;;;; budgets.lisp -- how many seconds each suite may take.

(in-package :ars-magna.tests)

;;; A budget is about twice what the suite takes on two cores of a shared machine. A suite that
;;; takes longer has not failed; ./tests/run lists it at its end.

(defparameter *usual-budget* 2 "How many seconds a suite may take that *BUDGETS* does not name.")

(defparameter *budgets*
  '((newcomer 30) (abuse 20) (our-manual 12) (examples 10) (cli-hostile 10) (cli-scripts 10)
    (rpl 9) (plots 8) (forking 8) (saving 8) (searching 7) (architecture 7) (rpl-robot 7)
    (random-driver 6) (projecting 6) (outliving 6) (listings 6) (rewinding 6) (readme 5)
    (libraries 7) (agreement 6) (experiment-shell 4) (tutorial 4) (digests 4) (manual-4 4)
    (inference-coverage 4) (experiments-tables 4) (manual-3-4-3 4) (display 4) (cli-door 4)
    (cli-files 6) (cli-sessions 4) (cli-building 6) (definitions 3) (journals 3) (floors 4)
    (experiments-series 12) (several-plans 9) (robot-traffic 10) (robot-crowds 8) (rpl-agents 4))
  "How many seconds suites may take: a list of lists (suite seconds).")

(defvar *seconds* (make-hash-table) "How many seconds each suite has taken, in these runs.")

(defun budget-of (suite)
  (or (second (assoc suite *budgets* :test #'string=)) *usual-budget*))

(defun seconds-taken (suite)
  (gethash suite *seconds* 0))

(defun within-budget-p (suite)
  (<= (seconds-taken suite) (budget-of suite)))

(defun call-timed (function suite)
  "Call FUNCTION and return its value; what it takes counts for SUITE."
  (let ((start (get-internal-real-time)))
    (multiple-value-prog1 (funcall function)
      (incf (gethash suite *seconds* 0)
            (/ (- (get-internal-real-time) start) internal-time-units-per-second)))))
