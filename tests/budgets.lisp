;;;; budgets.lisp -- how many seconds of processor time each suite may take.

(in-package :ars-magna.tests)

;;; A budget is about twice what the suite takes on a core at 2.4 GHz, its child processes
;;; included, however busy the machine. A suite that takes more has not failed; ./tests/run lists
;;; it at its end. Suites with large budgets are started first.

(defparameter *usual-budget* 3 "How many seconds a suite may take that *BUDGETS* does not name.")

(defparameter *budgets*
  '((clim 40) (testbeds 26) (testbeds-tiles 14) (random-driver 26) (abuse 26) (rpl 24)
    (newcomer 22)
    (cli-scripts 22) (saving 18)
    (experiments-tables 14) (forking 14) (display 13) (our-manual 12) (experiments-series 12)
    (run-variables 11) (searching 11) (experiment-shell 11) (several-plans 10) (examples 10)
    (testbeds-trucks 10)
    (cli-door 9) (digests 9) (listings 9) (projecting 9) (tutorial 8) (agreement 8)
    (manual-3-4-3 8) (experiments 8) (rewinding 8) (experiments-fingerprints 7) (user-package 7)
    (cli-building 7) (manual-4 7) (architecture 7) (beginners 6) (robot-crowds 6) (definitions 6)
    (rpl-robot 6) (ways 6) (libraries 6) (cli-hostile 6) (inference-coverage 5)
    (floors 5) (manual-3-4-2 5) (readme 5) (plots 5) (journals 4) (cli-files 4) (cli-sessions 4)
    (experiment-replay 4) (plans 4) (experiment-compare 4) (world 4) (looking 4) (determinism 4)
    (rpl-agents 4) (robot-traffic 4) (rap 8))
  "How many seconds suites may take: a list of lists (suite seconds).")

(defvar *seconds* (make-hash-table) "How many seconds each suite has taken, in these runs.")

(defun budget-of (suite)
  (or (second (assoc suite *budgets* :test #'string=)) *usual-budget*))

(defun seconds-taken (suite)
  (gethash suite *seconds* 0))

(defun within-budget-p (suite)
  (<= (seconds-taken suite) (budget-of suite)))

(defun processor-seconds ()
  "Return the seconds of processor time that this process and its children that ended have taken.
Linux counts them in hundredths, the 14th to 17th words; the second word may have blanks."
  (let* ((line (uiop:read-file-line "/proc/self/stat"))
         (words (uiop:split-string (subseq line (+ 2 (position #\) line :from-end t))))))
    (/ (reduce #'+ (subseq words 11 15) :key #'parse-integer) 100)))

(defun call-timed (function suite)
  "Call FUNCTION and return its value; what it takes counts for SUITE."
  (let ((start (processor-seconds)))
    (multiple-value-prog1 (funcall function)
      (incf (gethash suite *seconds* 0) (- (processor-seconds) start)))))
