;;;; merging.lisp -- one table of several: of shards, of machines, of earlier runs.

(in-package :ars-magna.experiment)

(defun copy-description (directories target)
  "Let TARGET have the text of what decides a table that one of DIRECTORIES has, the first one."
  (let ((file (find-if #'existing-path (mapcar #'description-file directories)))
        (own (description-file target)))
    (when (and file (not (equal file own)))
      (call-writing (lambda () (check-unprotected own) (uiop:copy-file file own)) own))))

(defun join-series (directories target rows)
  "Put the series in DIRECTORIES, if any has some, into one table in TARGET, for the trials in the
table ROWS."
  (let ((files (remove-if-not #'existing-path (mapcar #'series-file directories))))
    (when files (write-series-in-order files rows (series-file target)))))

(defun join-machine-tables (directories target)
  "Put the tables of what differs from run to run into one, in any order."
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
  "Put the tables in DIRECTORIES, of one experiment, together in the directory TO, in order and each
trial once. Return the results. Signals DAMAGED-TABLE if two rows of one trial differ, or its series
do or are missing, and MISUSE if their fingerprints differ; TO is then as it was. If none of the
directories has series of a condition, TO has none of it."
  (check-argument merge-results directories
                  (and (consp directories) (proper-list-p directories)
                       (every (lambda (name) (typep name '(or string pathname))) directories))
                  "a list of directories")
  (check-argument merge-results to (typep to '(or string pathname)) "the name of a directory")
  (let* ((sources (mapcar #'existing-table directories))
         (target (ensure-store-directory to))
         (there (and (existing-path (rows-file target)) (list target)))
         (sources (remove-duplicates (append there sources) :test #'equal :from-end t)))
    (mapc #'check-not-refused sources)
    (call-with-directory
     (lambda ()
       (call-plainly
        (lambda ()
          (write-in-order (mapcar #'rows-file sources) (rows-file target)
                          (remove-duplicates (mapcan #'conditions-described sources)
                                             :test #'string= :from-end t)
                          (lambda (rows) (join-series sources target rows)))))
       (join-machine-tables sources target)
       (copy-description sources target))
     target)
    (read-results target)))
