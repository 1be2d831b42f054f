;;;; lines.lisp -- reading the lines of a table, and sorting them.

(in-package :ars-magna.experiment)

;;; A file is read as octets, a character each, so that the position of a line is known; and line by
;;; line, so that a table may be larger than memory. A last line without an end, as a killed process
;;; leaves it, does not count.

(defun map-lines (function path)
  "Call FUNCTION with each complete line, as octets, of the file PATH, and with the line's position
and number, from 1. Return the position after the last complete line."
  (with-open-file (in path :external-format :latin-1)
    (loop with start = 0
          for number from 1
          do (multiple-value-bind (line cut-off-p) (read-line in nil nil)
               (when (or (null line) cut-off-p) (return start))
               (funcall function line start number)
               (incf start (1+ (length line)))))))

(defun first-line (file)
  "Return the first line of FILE, as octets, and true if its end is missing; NIL if FILE is empty."
  (with-open-file (in file :external-format :latin-1) (read-line in nil nil)))

(defun columns-of-file (file &optional (layout *rows-layout*))
  "Return the names of the columns of FILE, a table with LAYOUT. Signals DAMAGED-TABLE."
  (let ((line (first-line file)))
    (unless line (reject-table file nil "the file is empty. Delete this file."))
    (check-header-line line file)
    (let ((columns (ignore-errors (csv-fields (line-text line)))))
      (unless (table-columns-p columns layout)
        (reject-table file 1 "this is no table of an experiment. Give another directory."))
      columns)))

(defun check-file-header (file columns)
  "Signal DAMAGED-TABLE unless FILE is empty or begins with COLUMNS. This line may be cut off."
  (multiple-value-bind (line cut-off-p) (first-line file)
    (let* ((header (string-right-trim '(#\Newline) (csv-line columns)))
           (text (and line (line-text line))))
      (when text
        (check-header-line line file)
        (unless (if cut-off-p (starts-with-subseq text header) (string= text header))
          (reject-table file 1 "its columns are ~A, not ~A as in the new table. Give another ~
                                directory."
                        (cut text 200) header))))))

(defun map-rows (function file)
  "Call FUNCTION with each row's texts, position and line number in FILE. Signals DAMAGED-TABLE."
  (let ((columns (columns-of-file file)))
    (map-lines (lambda (line start number)
                 (when (> number 1)
                   (let ((texts (cells-of-line line columns file number)))
                     (check-cells (nthcdr (seed-column columns) texts) columns file number)
                     (funcall function texts start number))))
               file)))

(defmacro do-rows ((texts file &optional (start (gensym)) (number (gensym))) &body body)
  "Run BODY for each row of the table FILE, with its TEXTS, line NUMBER and position START."
  `(map-rows (lambda (,texts ,start ,number)
               (declare (ignorable ,start ,number))
               ,@body)
             ,file))

;;; Order: by condition, and within that by trial.

(defstruct (row-group (:conc-name group-) (:constructor make-group (key)) (:copier nil))
  "The rows of one condition in a table. KEY is the list of the texts of these rows before the seed.
RANK is the position of this group among all groups."
  (key '() :type list :read-only t)
  (rank 0 :type fixnum))

(defstruct (indexed-row (:conc-name indexed-)
                        (:constructor make-indexed-row (group trial file start number))
                        (:copier nil))
  "The place of the row of a trial: the file, the position and the number of the line."
  (group nil :type row-group :read-only t)
  (trial 0 :type integer :read-only t)
  (file nil :read-only t)
  (start 0 :type integer :read-only t)
  (number 0 :type fixnum :read-only t))

(defun index-rows (files)
  "FILES are tables with equal columns. Return an unsorted vector of their rows, and their groups."
  (let ((groups (make-hash-table :test 'equal))
        (rows (make-array 1000 :adjustable t :fill-pointer 0))
        (columns (columns-of-file (first files))))
    (dolist (file files)
      (unless (equal columns (columns-of-file file))
        (reject-table file nil "its columns are not those of ~A" (native-name (first files))))
      (do-rows (texts file start number)
        (let* ((seed (seed-column columns))
               (key (subseq texts 0 seed))
               (group (or (gethash key groups)
                          (setf (gethash key groups) (make-group key)))))
          (vector-push-extend
           (make-indexed-row group (parse-integer (nth (1+ seed) texts)) file start number)
           rows))))
    (values rows (hash-table-values groups))))

(defun group-before-p (a b)
  "True if the rows of the group A come before those of B: by experiment, then by factors."
  (flet ((texts (group)
           (destructuring-bind (experiment fingerprint condition &rest texts) (group-key group)
             (append (list experiment) texts (list condition fingerprint)))))
    (texts-before-p (texts a) (texts b))))

(defun rank-groups (groups order)
  "Set the ranks of GROUPS: first conditions in ORDER, a list of names, then the others."
  (flet ((place (group) (or (position (third (group-key group)) order :test #'string=)
                            (length order))))
    (loop for group in (stable-sort (sort (copy-list groups) #'group-before-p) #'< :key #'place)
          for rank from 0
          do (setf (group-rank group) rank))))

(defun row-before-p (a b)
  (let ((rank (group-rank (indexed-group a))) (other (group-rank (indexed-group b))))
    (or (< rank other)
        (and (= rank other) (< (indexed-trial a) (indexed-trial b))))))

;;; Whether rows belong together.

(defun check-groups (groups)
  "Signal MISUSE unless GROUPS have one experiment, and each condition one fingerprint and one level
of each factor."
  (let ((conditions (make-hash-table :test 'equal)) (fingerprints (make-hash-table :test 'equal))
        (experiment (and groups (first (group-key (first groups))))))
    (dolist (group groups)
      (destructuring-bind (its-experiment fingerprint condition &rest texts) (group-key group)
        (unless (string= experiment its-experiment)
          (reject-use "There are rows of the experiments ~A and ~A, which do not belong together."
                      experiment its-experiment))
        (let ((other (shiftf (gethash condition conditions) (cons fingerprint texts))))
          (when other (reject-inconsistent-groups condition fingerprint other texts)))
        (let ((other (shiftf (gethash fingerprint fingerprints) condition)))
          (when other
            (reject-use "The conditions ~A and ~A have the same fingerprint, ~A: a row was edited."
                        other condition fingerprint)))))))

(defun reject-inconsistent-groups (condition fingerprint other texts)
  (if (string= fingerprint (first other))
      (reject-use "Rows of the condition ~A differ in their factors: ~{~A~^, ~} and ~{~A~^, ~}. ~
                   Some rows have been changed."
                  condition texts (rest other))
      (reject-use "There are rows of the condition ~A with the fingerprints ~A and ~A: they are of ~
                   different code or configurations, and do not belong together."
                  condition (first other) fingerprint)))

;;; Writing them in order.

(defun call-replacing-table (function file &optional (check #'identity))
  "Call FUNCTION with a stream to a new file, then CHECK with its path; then replace the table FILE
by the new file. If the new file cannot be written, signal DAMAGED-TABLE and leave FILE unchanged."
  (call-reporting-file-errors (lambda () (call-replacing-file function file :check check))
                              file "the file cannot be replaced (~A). It is unchanged."))

(defun call-with-line-reader (function files)
  "Call FUNCTION with a reader, a function that returns the line at a position in one of FILES."
  (let ((streams (make-hash-table :test 'eq)))
    (unwind-protect
         (progn
           (dolist (file files)
             (setf (gethash file streams) (list (open file :external-format :latin-1) 0)))
           (funcall function
                    (lambda (file start)
                      (destructuring-bind (stream place) (gethash file streams)
                        (unless (= place start) (file-position stream start))
                        (let ((line (read-line stream)))
                          (setf (second (gethash file streams)) (+ start (length line) 1))
                          line)))))
      (loop for (stream) being the hash-values of streams do (close stream)))))

(defun reject-conflicting-rows (row other)
  (reject-table (indexed-file row) (indexed-number row)
                "this row and line ~D of ~A are of the same trial and differ. Something outside of ~
                 the experiment affects its trials; no table can have both."
                (indexed-number other) (native-name (indexed-file other))))

(defun sorted-rows-p (rows)
  "True if ROWS, a vector, are sorted, and no two rows are of the same trial."
  (loop for index from 1 below (length rows)
        always (row-before-p (aref rows (1- index)) (aref rows index))))

(defun write-rows (rows line-of out)
  "Write the lines of ROWS, which are sorted, to OUT, one for each trial. Return the number of
lines. LINE-OF is as in CALL-WITH-LINE-READER. Signals DAMAGED-TABLE if two rows of a trial differ."
  (loop with last = nil and last-line = nil and count = 0
        for row across rows
        for line = (funcall line-of (indexed-file row) (indexed-start row))
        do (cond ((and last (not (row-before-p last row)))
                  (unless (string= line last-line) (reject-conflicting-rows row last)))
                 (t (write-line (line-text line) out)
                    (incf count)))
           (setf last row last-line line)
        finally (return count)))

(defun write-sorted-rows (files file order &optional (check #'identity))
  "Write the rows of the tables FILES to FILE, sorted, each row once. FILE may be one of FILES.
Return the number of rows. ORDER is a list of condition names. CHECK is called with the new table's
path before FILE is replaced. Signals DAMAGED-TABLE and MISUSE; errors leave FILE unchanged."
  (multiple-value-bind (rows groups) (index-rows files)
    (check-groups groups)
    (rank-groups groups order)
    (let ((columns (columns-of-file (first files))) (count (length rows)))
      (cond ((and (equal files (list file)) (sorted-rows-p rows))
             (funcall check file))
            (t (setf rows (stable-sort rows #'row-before-p))
               (call-with-line-reader
                (lambda (line-of)
                  (call-replacing-table (lambda (out)
                                          (write-string (csv-line columns) out)
                                          (setf count (write-rows rows line-of out)))
                                        file check))
                files)))
      count)))
