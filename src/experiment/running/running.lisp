;;;; running.lisp -- RUN-EXPERIMENT.

(in-package :ars-magna.experiment)

;;; A second start runs the trials without a row, and so continues a stopped experiment. Rows are
;;; written as trials end and sorted at the end, so the table is the same whatever ran when.

;;; Rows that exist already.

(defun rows-to-check (conditions &rest tables)
  "Return the values that hash TABLES have for CONDITIONS, each once, the first table's first."
  (remove nil (remove-duplicates
               (loop for table in tables
                     append (loop for condition in conditions collect (gethash condition table)))
               :test #'eq :from-end t)))

(defun find-existing-rows (experiment parts directory)
  "Return two values: a table of the rows of EXPERIMENT present in DIRECTORY, and a list of rows to
check. The list has the texts of the last row of each condition, then those of the first rows. PARTS
are the fingerprint parts of all conditions. Signals MISUSE for rows with other fingerprints."
  (let ((firsts (make-hash-table :test 'eq)) (lasts (make-hash-table :test 'eq))
        (columns (columns experiment)))
    (multiple-value-bind (presence series)
        (present-rows experiment directory
                      (lambda (condition texts)
                        (declare (ignore texts))
                        (reject-foreign-rows experiment condition parts directory))
                      (lambda (condition texts)
                        (unless (timed-out-p texts columns)
                          (unless (gethash condition firsts)
                            (setf (gethash condition firsts) texts))
                          (setf (gethash condition lasts) texts))))
      (values presence
              (mapcar (lambda (texts)
                        (texts-with-checksum texts experiment (existing-series-text series texts)))
                      (rows-to-check (experiment-conditions experiment) lasts firsts))))))

;;; Looking at intervals.

;;; If you look at an interval again and again, and stop when you like it, it is too optimistic. So
;;; it is computed only after fixed numbers of trials: 50, 100, 200 and so on. The K-th look has the
;;; share 1 / (K (K + 1)) of the allowed error. The shares add up to 1, so all looks together have
;;; no more than the whole (Bonferroni's inequality). The interval at the last look can be reported.

(defconstant +first-look+ 50 "The number of trials at the first look at intervals.")

(defun count-at-look (look)
  "Return the number of trials of each condition at interim look number LOOK, from 1."
  (* +first-look+ (expt 2 (1- look))))

(defun confidence-at-look (look)
  "Return the confidence of intervals at the LOOK-th look, so that all looks together have .95."
  (- 1d0 (sequential-level look :level .05d0)))

(defun count-successes (experiment trials directory)
  (let* ((columns (columns experiment)) (seed (seed-column columns))
         (counts (make-hash-table :test 'eq)))
    (do-rows (texts (rows-file directory))
      (let ((condition (condition-of-texts experiment texts)))
        (when (and condition
                   (<= (parse-integer (nth (1+ seed) texts)) trials)
                   (string= "success" (nth (+ 2 seed) texts)))
          (incf (gethash condition counts 0)))))
    counts))

(defun wide-conditions (experiment conditions look width directory)
  (let* ((trials (count-at-look look))
         (counts (count-successes experiment trials directory)))
    (remove-if (lambda (condition)
                 (multiple-value-bind (low high)
                     (wilson-interval (gethash condition counts 0) trials
                                      :confidence (confidence-at-look look))
                   (<= (- high low) width)))
               conditions)))

;;; Rounds.

(defun run-trials-up-to (experiment conditions last presence shard store workers time-limit stream)
  (let* ((queue (make-queue conditions last presence (or shard '(0 . 1)) time-limit))
         (missing (count-missing queue))
         (workers (min workers missing))
         (progress (make-progress stream (and stream (interactive-stream-p stream))
                                  missing workers))
         (*progress* progress))
    (when (plusp missing)
      (run-queue experiment queue store progress workers)
      (report-progress progress t))))

(defun run-until-narrow (experiment width most directory store workers time-limit stream)
  "Run trials until each interval is at most WIDTH wide, or each condition has MOST trials."
  (loop with conditions = (experiment-conditions experiment)
        for look from 1
        for trials = (count-at-look look)
        while (and conditions (<= trials most))
        do (run-trials-up-to experiment conditions trials
                             (present-rows experiment directory (constantly nil))
                             nil store workers time-limit stream)
           (setf conditions (wide-conditions experiment conditions look width directory))))

;;; RUN-EXPERIMENT.

(defparameter *most-trials* 1000000
  "The default for :trials, the most trials of a condition, if :until is given.")

(defun sort-tables (experiment directory)
  (let ((file (series-file directory)))
    (write-sorted-rows (list (rows-file directory)) (rows-file directory)
                       (mapcar #'condition-name (experiment-conditions experiment))
                       (lambda (rows)
                         (when (experiment-series experiment)
                           (write-sorted-series (list file) rows file))))))

(defun run-in-directory (experiment directory trials until shard workers time-limit stream)
  (let ((parts (prepare-experiment experiment)))
    (when (existing-path (rows-file directory)) (check-not-refused directory))
    (when *renew-changed-rows-p* (renew-changed-rows experiment parts directory stream))
    (multiple-value-bind (presence samples) (find-existing-rows experiment parts directory)
      (check-rows-repeatable experiment samples *seconds-for-checks*)
      (warn-if-damaged directory)
      (save-description experiment parts trials until directory)
      (call-with-store
       (lambda (store)
         (let ((begun (real-microseconds)))
           (if until
               (run-until-narrow experiment until trials directory store workers time-limit
                                 stream)
               (run-trials-up-to experiment (experiment-conditions experiment) trials presence shard
                                 store workers time-limit stream))
           (check-finished-run store parts (seconds-since begun))))
       experiment directory)
      (sort-tables experiment directory))))

(defun shard-p (shard)
  (or (null shard)
      (and (consp shard) (integerp (car shard)) (integerp (cdr shard))
           (< -1 (car shard) (cdr shard) (1+ +largest+)))))

(defun check-run-arguments (trials workers directory until shard time-limit)
  (check-argument run-experiment trials (and (integerp trials) (<= 1 trials +largest+))
                  "how many trials of each condition, from 1 to 1e9")
  (check-argument run-experiment workers (and (integerp workers) (<= 1 workers 1000))
                  "how many threads, from 1 to 1000")
  (check-argument run-experiment directory (typep directory '(or null string pathname))
                  "the name of a directory, or NIL")
  (check-argument run-experiment until (or (null until) (and (realp until) (< 0 until 1)))
                  "the largest width of intervals, a number between 0 and 1")
  (check-argument run-experiment time-limit (or (null time-limit) (seconds-p time-limit))
                  "a number of seconds from .001 to 1e9, or NIL")
  (check-argument run-experiment shard (shard-p shard)
                  "(index . count), with an index from 0 to below count")
  (when (and until shard)
    (reject-use "A shard does not see all trials: give :until or :shard, not both.")))

(defun report-errors (results stream)
  "If trials of RESULTS had errors, print to STREAM how many, and the first error."
  (let ((errors (loop for sample in (results-samples results)
                      append (remove "" (coerce (sample-errors sample) 'list) :test #'string=))))
    (when errors
      (format stream "~&~D trial~:P had errors, the first: ~A.~%"
              (length errors) (string-right-trim "." (cut (first errors) 300))))))

(defun run-and-read-results (experiment directory trials until shard workers time-limit stream)
  (flet ((run ()
           (run-in-directory experiment directory trials until shard workers time-limit stream)
           (let ((results (results-from-table (rows-file directory))))
             (setf (results-until results) until
                   (results-conditions results)
                   (mapcar #'condition-name (experiment-conditions experiment)))
             (when stream (report-errors results stream))
             results)))
    (call-with-locked-directory (lambda () (call-with-trial-syntax #'run)) directory)))

(addition run-experiment)
(define-with-keywords run-experiment (name &key trials (workers (processors)) directory until shard
                                           (time-limit nil time-limit-p)
                                           (stream *standard-output*))
  "Run TRIALS trials of each condition of the experiment NAME, by default as many as the experiment
says, in WORKERS threads. Return the results, for PRINT-RESULTS, SAVE-RESULT-PICTURES,
COMPARE-CONDITIONS.

DIRECTORY, created if necessary, keeps the table: rows.csv, a row for each trial; machine.csv, what
differs from run to run; experiment.txt, how to repeat the experiment; series.csv, what :each-tick
records, a line for each tick of each trial, see TRIAL-SERIES. Trials that have a row in DIRECTORY
are not run again. So call RUN-EXPERIMENT again to continue a stopped run or to add trials. If
DIRECTORY has rows of other code or another configuration, MISUSE is signalled. Without DIRECTORY
nothing is kept except the returned results.

With UNTIL, a width, trials are added until the interval of each condition's success is at most
UNTIL wide. The intervals are computed after 50, 100, 200 ... trials, at most TRIALS or a million.
SHARD (index . count) runs only the trials whose numbers divided by COUNT leave the remainder INDEX;
MERGE-RESULTS merges shards. Unless STREAM is NIL, the progress is written to STREAM, with the name
of a trial that takes much longer than others, and at the end the number of trials with errors.

TIME-LIMIT is the most seconds of real time that a trial may take, by default what the experiment
says; NIL means no limit. A trial that takes longer is ended. Such a trial has the outcome timeout,
which is no success, and is not run again. Machines differ, so allow far more time than trials need.
A trial that ends its own thread is an error of that trial.

A trial with an error has a row, too. Signals UNKNOWN-NAME, WRONG-ARGUMENT, MISUSE, DAMAGED-TABLE."
  (let* ((experiment (find-experiment name))
         (trials (or trials (if until *most-trials* (experiment-trials experiment))))
         (time-limit (if time-limit-p time-limit (experiment-time-limit experiment))))
    (check-run-arguments trials workers directory until shard time-limit)
    (flet ((run (path)
             (let ((*directory-given-p* (and directory t)))
               (run-and-read-results experiment path trials until shard workers time-limit
                                     stream))))
      (setf (experiment-results experiment)
            (if directory
                (let* ((path (ensure-store-directory directory)) (results (run path)))
                  (setf (results-directory results) path)
                  results)
                (call-with-temporary-directory #'run))))))
