;;;; merging.lisp -- merging tables of shards, machines or earlier runs.

(in-package :ars-magna.experiment)

(export '(shard-directory directories-with-rows count-rows shard-has-trials-p missing-shards
          check-same-code))

(defun copy-description (directories target)
  (let ((file (find-if #'existing-path (mapcar #'description-file directories)))
        (own (description-file target)))
    (when (and file (not (equal file own)))
      (call-reporting-file-errors (lambda () (check-writable own) (uiop:copy-file file own))
                                  own))))

(defun merge-series (directories target rows)
  (let ((files (remove-if-not #'existing-path (mapcar #'series-file directories))))
    (when files (write-sorted-series files rows (series-file target)))))

(defun concatenate-machine-tables (directories target)
  (let ((files (remove-if-not #'existing-path (mapcar #'machine-file directories))))
    (when files
      (call-replacing-table
       (lambda (out)
         (write-string (csv-line *machine-columns*) out)
         (dolist (file files)
           (map-lines (lambda (line start number)
                        (declare (ignore start))
                        (when (> number 1) (write-line (line-text line) out)))
                      file)))
       (machine-file target)))))

(addition merge-results)
(defun merge-results (directories &key (to (first directories)))
  "Merge tables of one experiment in DIRECTORIES into a sorted table in the directory TO. It has
each trial once. Return the results. Signals DAMAGED-TABLE if two rows or series of the same trial
differ, or if the series of a trial is missing, and MISUSE if fingerprints differ; after an error,
TO is unchanged. If no directory has series of a condition, TO has no series of that condition."
  (check-argument merge-results directories
                  (and (consp directories) (proper-list-p directories)
                       (every (lambda (name) (typep name '(or string pathname))) directories))
                  "a list of directories")
  (check-argument merge-results to (typep to '(or string pathname)) "the name of a directory")
  (let* ((sources (mapcar #'existing-table-directory directories))
         (target (ensure-store-directory to))
         (there (and (existing-path (rows-file target)) (list target)))
         (sources (remove-duplicates (append there sources) :test #'equal :from-end t)))
    (mapc #'check-not-refused sources)
    (call-with-locked-directory
     (lambda ()
       (call-with-trial-syntax
        (lambda ()
          (write-sorted-rows (mapcar #'rows-file sources) (rows-file target)
                             (remove-duplicates (mapcan #'recorded-conditions sources)
                                                :test #'string= :from-end t)
                             (lambda (rows) (merge-series sources target rows)))))
       (concatenate-machine-tables sources target)
       (copy-description sources target))
     target)
    (read-results target)))

;;;; Shards

;;; Shard I of N keeps its table in a directory shard-I-of-N below that of the experiment, where all
;;; are merged. Rows in any of these directories count as existing.

(defun shard-directory (directory index count)
  "Return the name of the directory of the shard INDEX of COUNT below DIRECTORY."
  (native-name (file-in (directory-path directory)
                        (format nil "shard-~D-of-~D/" index count))))

(defun directories-with-rows (directory)
  "Return the names of directories with rows, among DIRECTORY and its directories of shards."
  (let* ((path (directory-path directory))
         (shards (remove-if-not (lambda (path)
                                  (starts-with-subseq "shard-"
                                                      (car (last (pathname-directory path)))))
                                (uiop:subdirectories path))))
    (loop for directory in (cons path (sort (mapcar #'native-name shards) #'string<))
          for file = (existing-path (rows-file (directory-path directory)))
          when (and file (plusp (count-whole-lines file)))
            collect (native-name directory))))

(defun count-whole-lines (file)
  (let ((count 0))
    (map-lines (lambda (line start number)
                 (declare (ignore line start))
                 (setf count number))
               file)
    count))

(defun count-rows (directory)
  "Return the number of rows in DIRECTORY and its shards. A trial counts once for each of its rows."
  (loop for directory in (directories-with-rows directory)
        sum (1- (count-whole-lines (rows-file (directory-path directory))))))

;;; Existing and missing rows.

(defun shard-has-trials-p (shard trials)
  "True if SHARD, a cons (index . count), has any of the trials from 1 to TRIALS."
  (<= 1 (if (zerop (car shard)) (cdr shard) (car shard)) trials))

(defun map-existing-rows (function experiment directory)
  "Call FUNCTION for each row of EXPERIMENT in DIRECTORY and the shards below it. Its arguments are
the condition, the trial's number, the fingerprint, the name of the directory, and whether the
series is complete. Tables with other columns are skipped."
  (let* ((columns (columns experiment)) (seed (seed-column columns)))
    (dolist (name (directories-with-rows directory))
      (let* ((file (rows-file (directory-path name)))
             (own-p (equal columns (columns-of-file file)))
             (series (and own-p (index-existing-series experiment (directory-path name)))))
        (when own-p
          (do-rows (texts file)
            (let ((condition (condition-of-texts experiment texts)))
              (when condition
                (funcall function condition (parse-integer (nth (1+ seed) texts))
                         (second texts) name (series-complete-p series texts))))))))))

(defun missing-shards (experiment trials count directory)
  "COUNT shards run the first TRIALS trials of each condition of EXPERIMENT. Return the sorted
indices, from 0, of shards that lack rows. Rows in DIRECTORY and in the shards below it count."
  (prepare-experiment experiment)
  (let ((presence (make-hash-table :test 'eq)) (missing (make-array count :element-type 'bit)))
    (map-existing-rows (lambda (condition trial fingerprint directory complete-p)
                         (declare (ignore directory))
                         (when (and complete-p
                                    (string= fingerprint (condition-fingerprint condition)))
                           (note-trial-present condition trial presence)))
                       experiment directory)
    (loop for trial from 1 to trials
          do (unless (every (lambda (condition) (trial-present-p condition trial presence))
                            (experiment-conditions experiment))
               (setf (aref missing (mod trial count)) 1)))
    (loop for shard below count
          when (plusp (aref missing shard)) collect shard)))

(defun check-same-code (experiment directory)
  "Signal MISUSE if rows in DIRECTORY or the shards below it have other fingerprints than EXPERIMENT
has now, and DAMAGED-TABLE if they have other columns."
  (let ((parts (prepare-experiment experiment)))
    (dolist (name (directories-with-rows directory))
      (check-file-header (rows-file (directory-path name)) (columns experiment)))
    (map-existing-rows (lambda (condition trial fingerprint name complete-p)
                         (declare (ignore trial complete-p))
                         (unless (string= fingerprint (condition-fingerprint condition))
                           (reject-foreign-rows experiment condition parts
                                                (directory-path name))))
                       experiment directory)))
