;;;; failures.lisp -- TRIAL-FAILURES and TRIAL-SERIES: failed trials, and values over time.

(in-package :ars-magna.experiment)

;;; Trials of one condition with the same outcome, reason and text of an error are a group. An error
;;; in a continuation or kicker need not end its trial; so a group may also have succeeded.

(defun failure-groups (sample)
  "Group failures and errors of SAMPLE. Return lists (trials outcome reason error), longest first."
  (let ((known (make-hash-table :test 'equal)) (keys '()))
    (loop for trial across (sample-trials sample)
          for outcome across (sample-outcomes sample)
          for reason across (sample-reasons sample)
          for error across (sample-errors sample)
          for key = (list outcome reason error)
          do (unless (and (string= "success" outcome) (string= "" error))
               (unless (gethash key known) (push key keys))
               (push trial (gethash key known))))
    (stable-sort (loop for key in (reverse keys)
                       collect (cons (reverse (gethash key known)) key))
                 #'> :key #'failure-count)))

(defun failure-count (group)
  (length (first group)))

(defun failure-plist (group sample)
  (destructuring-bind (trials outcome reason error) group
    (let ((count (length trials)))
      (list :condition (sample-condition sample)
            :outcome outcome :reason reason :error error
            :count count
            :share (/ count (float (length (sample-trials sample)) 1d0))
            :trials trials))))

;;; Designators of results.

(defun designated-results (designator)
  "Return the results that DESIGNATOR means: results, the name of a directory with results, an
experiment that was run in this Lisp, or the experiment's name. Signals MISUSE and DAMAGED-TABLE."
  (let ((experiment (and (typep designator '(or symbol string experiment))
                         (find-experiment designator nil)))
        (directory-p (typep designator '(or string pathname))))
    (cond ((results-p designator) designator)
          ((and directory-p
                (or (null experiment) (existing-path (rows-file (directory-path designator)))))
           (read-results designator))
          (experiment
           (or (experiment-results experiment)
               (reject-use "~(~A~) was not run in this Lisp. Run it, or give its directory."
                           (experiment-name experiment))))
          (t (reject-argument "trial-failures" "results" designator
                              "results, an experiment, or the name of a directory")))))

(defun samples-matching (results condition)
  "Return the samples of RESULTS whose condition is named CONDITION, or else has CONDITION in its
name; all samples if CONDITION is NIL. Signals UNKNOWN-NAME."
  (let ((samples (results-samples results)))
    (cond ((null condition) samples)
          ((filter-by-name (string condition) samples #'sample-condition))
          (t (reject-name "condition" (string condition)
                          (mapcar #'sample-condition samples))))))

(addition trial-failures)
(defun trial-failures (results &optional condition)
  "Return a list of what went wrong in RESULTS. RESULTS are results, an experiment that was run in
this Lisp, or the name of a directory. CONDITION, a string or symbol, limits the list to conditions
with CONDITION in their names. The value is a list of plists :condition :outcome :reason :error
:count :share (of the condition's trials) :trials (their numbers), ordered by condition, then by
count. Errors that did not end their trials count, too. REPLAY-TRIAL runs a trial again. Signals
MISUSE, UNKNOWN-NAME, WRONG-ARGUMENT, DAMAGED-TABLE."
  (check-argument trial-failures condition (typep condition '(or string symbol))
                  "a string or symbol, or NIL")
  (loop for sample in (samples-matching (designated-results results) condition)
        append (loop for group in (failure-groups sample) collect (failure-plist group sample))))

;;; Printing.

(defun prompt-argument (text)
  (if (find #\Space text) (format nil "\"~A\"" text) text))

(defun example-prompt-line (group sample)
  (format nil "trial ~A ~A ~D" (prompt-argument (sample-experiment sample))
          (prompt-argument (sample-condition sample)) (first (first group))))

(defun failure-description (group)
  (destructuring-bind (outcome reason error) (rest group)
    (format nil "~A~@[: ~A~]~@[; ~A~]" outcome
            (and (string/= "" reason) reason) (and (string/= "" error) error))))

(defun print-failure-groups (sample stream)
  (let* ((groups (failure-groups sample)) (count (reduce #'+ groups :key #'failure-count)))
    (format stream "~A: ~D trials, ~:[~D with something wrong~;nothing wrong~]~%"
            (sample-condition sample) (length (sample-trials sample)) (zerop count) count)
    (dolist (group groups)
      (format stream "  ~5D  ~5,1F %  ~A~%                  ~A~%" (failure-count group)
              (* 100d0 (/ (failure-count group) (length (sample-trials sample))))
              (failure-description group) (example-prompt-line group sample)))))

(addition print-failures)
(defun print-failures (results &optional condition (stream *standard-output*))
  "Write to STREAM what TRIAL-FAILURES returns: for each condition, how many trials failed in which
way, and a line to type at the prompt that opens one of these trials. Return nothing."
  (dolist (sample (samples-matching (designated-results results) condition) (values))
    (print-failure-groups sample stream)))

;;;; Values over time

(defun directory-of-series (results)
  "Return the directory of RESULTS. Signals MISUSE unless it has a table of series."
  (let ((directory (results-directory results)))
    (unless directory
      (reject-use "trial-series: these results are not in a directory. Give RUN-EXPERIMENT a ~
                   :directory, or use (getf (replay-trial ...) :series)."))
    (check-files-plain directory)
    (unless (existing-path (series-file directory))
      (reject-use "trial-series: there is no series.csv in ~A. An experiment with the clause ~
                   :each-tick writes one when it is run with that directory."
                  (native-name directory)))
    directory))

(defun trial-index (sample trial)
  "Return the index of TRIAL in the vectors of SAMPLE. Signals MISUSE if there is no such trial."
  (or (position trial (sample-trials sample))
      (reject-use "trial-series: there is no trial ~D of ~A in these results." trial
                  (sample-condition sample))))

(defun block-of-trial (index sample place)
  "Return the block of INDEX for the trial at index PLACE of SAMPLE; NIL if the trial has no lines.
Signals MISUSE if lines are missing."
  (when (aref (sample-digests sample) place)
    (or (find-complete-block (trial-blocks index (row-key sample) (aref (sample-seeds sample) place)
                                           (aref (sample-trials sample) place))
                             (1+ (aref (sample-ticks sample) place)))
        (reject-use "trial-series: not all lines of trial ~D of ~A are in series.csv. Run the ~
                     experiment again with that directory: it runs such trials again."
                    (aref (sample-trials sample) place) (sample-condition sample)))))

(defun series-values (block seed)
  "Return lists (tick value...) of the lines of BLOCK. SEED is the column of the seed."
  (let ((shared (make-hash-table :test 'equal)))
    (call-with-line-reader
     (lambda (line-of)
       (loop for line in (block-lines block line-of)
             for (tick . texts) = (nthcdr (+ seed 2) (csv-fields (line-text line)))
             collect (cons (parse-integer tick)
                           (loop for text in texts collect (value-from-text text shared)))))
     (list (block-file block)))))

(addition trial-series)
(defun trial-series (results condition trial)
  "Return what :each-tick recorded in trial number TRIAL of CONDITION in RESULTS: a list of lists
(tick value...), with the values in the order of the clause. Values are numbers, T, NIL, strings,
and :NONE for no value. Return () if the trial timed out. RESULTS are results kept in a directory,
an experiment that was run with a directory, or the directory's name. CONDITION is the number of a
condition, from 1, its name, or a part of its name. Each call reads all of series.csv. Signals
MISUSE (no directory, no such file, trial or lines), UNKNOWN-NAME, WRONG-ARGUMENT, DAMAGED-TABLE."
  (check-argument trial-series trial (and (integerp trial) (<= 1 trial +largest+))
                  "the number of a trial, counted from 1")
  (let* ((results (designated-results results))
         (file (series-file (directory-of-series results)))
         (sample (designated-sample results condition))
         (place (trial-index sample trial))
         (index (index-series (list file) (columns-of-file file *series-layout*)))
         (block (block-of-trial index sample place)))
    (and block
         (call-with-trial-syntax
          (lambda () (series-values block (seed-column (series-index-columns index))))))))
