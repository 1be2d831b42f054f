;;;; results.lisp -- results: a table in memory, with a sample for each condition.

(in-package :ars-magna.experiment)

;;; Cells become numbers, T, NIL, :NONE (not measured), or strings; equal strings are shared.

(addition sample-p)
(define-record (sample (:constructor make-sample (experiment fingerprint condition texts measures)))
  "The trials of one condition, in order of their numbers: vectors of equal length."
  (experiment "" string "the name of the experiment, a string" :addition)
  (fingerprint "" string)
  (condition "" string "the name of the condition, a string" :addition)
  (texts '() list "the values of the factors, strings as in the table" :addition)
  (seeds (column) t)
  (trials (column) t
          "a vector of the numbers of the trials; the other vectors are in the same order"
:addition)
  (outcomes (column) t
            "a vector of \"success\", \"failure\", \"limit\", \"error\" and \"timeout\"" :addition)
  (reasons (column) t "a vector of strings that say why trials failed" :addition)
  (ticks (column) t
         "a vector of the ticks that passed in each trial; :NONE for timeouts" :addition)
  (measures '() list "a list of a vector for each measure")
  (digests (column) t
           "a vector of integers, or NIL; trials with equal digests were the same run")
  (errors (column) t
          "a vector of the texts of errors, \"\" where there was none" :addition))

(addition results-p)
(define-record (results (:constructor %make-results (columns)))
  "The results of an experiment: a sample for each condition, in order."
  (columns '() list)
  (samples '() list "a list of samples, one for each condition" :writable :addition)
  (directory nil (or null pathname)
             "the path of the directory with the table, or NIL" :writable :addition)
  (until nil (or null real) "until which width of intervals trials were added, or NIL" :writable)
  (conditions '() list "the names of the experiment's present conditions, or NIL if not known"
   :writable))

(defun column ()
  (make-array 16 :adjustable t :fill-pointer 0))

(defmethod print-object ((sample sample) stream)
  (print-unreadable-object (sample stream)
    (format stream "~D trials, ~A" (length (sample-trials sample)) (sample-condition sample))))

(defmethod print-object ((results results) stream)
  (print-unreadable-object (results stream :type t)
    (format stream "~@[~A, ~]~D condition~:P"
            (and (results-samples results) (sample-experiment (first (results-samples results))))
            (length (results-samples results)))))

;;; Columns.

(defun columns-between (columns before after)
  (subseq columns (1+ (position before columns :test #'string=))
          (position after columns :test #'string=)))

(defun measure-columns-of (columns) (columns-between columns "ticks" "digest"))

(addition results-factors results-measures)
(defun results-factors (results)
  "Return a list of strings, the names of the factors of RESULTS, in the order of SAMPLE-TEXTS."
  (columns-between (results-columns results) "condition" "seed"))

(defun results-measures (results)
  "Return a list of strings, the names of the measures of RESULTS."
  (measure-columns-of (results-columns results)))

(addition sample-measure)
(defun sample-measure (results sample measure)
  "Return a vector of the values of MEASURE, a string or symbol, in the trials of SAMPLE, a sample
of RESULTS. Values are numbers, T, NIL, strings, and :NONE for no value. MEASURE may be ticks, too.
Signals UNKNOWN-NAME and WRONG-ARGUMENT."
  (check-argument sample-measure measure (typep measure '(or string symbol))
                  "the name of a measure, a string or symbol")
  (let ((place (position (string measure) (results-measures results) :test #'string-equal)))
    (cond (place (nth place (sample-measures sample)))
          ((string-equal measure "ticks") (sample-ticks sample))
          (t (reject-name "measure" (string measure)
                          (append (results-measures results) '("ticks")))))))

;;; Reading.

(defun value-from-text (text shared)
  "Return the value of TEXT, a cell of a table. The hash table SHARED makes equal strings EQ."
  (cond ((string= text "") :none)
        ((string= text "TRUE") t)
        ((string= text "FALSE") nil)
        ((number-from-text text))
        (t (shared-text text shared))))

(defun shared-text (text shared)
  (or (gethash text shared) (setf (gethash text shared) text)))

(defun digest-from-text (text)
  "Return the low 60 bits of the digest in TEXT, a cell of a table, or NIL if TEXT is empty."
  (and (string/= text "") (ldb (byte 60 0) (parse-integer text :radix 16))))

(defun add-row-to-sample (sample texts measures shared)
  (destructuring-bind (seed trial outcome reason ticks &rest rest) texts
    (vector-push-extend (parse-integer seed) (sample-seeds sample))
    (vector-push-extend (parse-integer trial) (sample-trials sample))
    (vector-push-extend (shared-text outcome shared) (sample-outcomes sample))
    (vector-push-extend (shared-text reason shared) (sample-reasons sample))
    (vector-push-extend (if (string= "timeout" outcome) :none (parse-integer ticks))
                        (sample-ticks sample))
    (loop for column in (sample-measures sample)
          for text in rest
          do (vector-push-extend (value-from-text text shared) column))
    (vector-push-extend (digest-from-text (nth measures rest)) (sample-digests sample))
    (vector-push-extend (shared-text (nth (1+ measures) rest) shared) (sample-errors sample))))

(defun row-key (sample)
  "Return the texts before the seed in rows of SAMPLE."
  (list* (sample-experiment sample) (sample-fingerprint sample) (sample-condition sample)
         (sample-texts sample)))

(defun row-of-sample-p (sample texts)
  (every #'string= (row-key sample) texts))

(defun last-trial (sample)
  (let ((count (length (sample-trials sample))))
    (if (zerop count) -1 (aref (sample-trials sample) (1- count)))))

;; A table is sorted unless the run that writes it continues, or was killed.
(defun results-if-sorted (file)
  (let* ((columns (columns-of-file file))
         (results (%make-results columns))
         (seed (seed-column columns))
         (measures (length (measure-columns-of columns)))
         (shared (make-hash-table :test 'equal))
         (samples '()))
    (do-rows (texts file)
      (unless (and samples (row-of-sample-p (first samples) texts))
        (when (some (lambda (sample) (row-of-sample-p sample texts)) samples)
          (return-from results-if-sorted nil))
        (push (make-sample (first texts) (second texts) (third texts) (subseq texts 3 seed)
                           (loop repeat measures collect (column)))
              samples))
      (unless (< (last-trial (first samples)) (parse-integer (nth (1+ seed) texts)))
        (return-from results-if-sorted nil))
      (add-row-to-sample (first samples) (nthcdr seed texts) measures shared))
    (setf (results-samples results) (reverse samples))
    results))

(defun results-from-table (file)
  (or (results-if-sorted file)
      (call-with-temporary-directory
       (lambda (directory)
         (let ((copy (rows-file directory)))
           (write-sorted-rows (list file) copy
                              (recorded-conditions (uiop:pathname-directory-pathname file)))
           (results-if-sorted copy))))))

(note-kind-of-file :table (format nil "~{~A,~}" *columns-before-factors*)
                   (format nil "it is the table of an experiment; (read-results DIRECTORY) reads ~
                                the directory that it is in"))

(defun existing-table-directory (directory)
  "Return the path of DIRECTORY. Signals MISUSE unless DIRECTORY has a table."
  (let ((path (directory-path directory)))
    (check-files-plain path)
    (unless (existing-path (rows-file path))
      (let ((advice (advice-on-file (path-of-name directory) nil)))
        (when advice (reject-use "~A is no directory of an experiment: ~A." directory advice)))
      (reject-use "There is no rows.csv in ~A. Give the directory of an experiment."
                  (native-name path)))
    (warn-if-damaged path)
    (when (recorded-refusal path)
      (warn "The rows in ~A were refused at the end of their run: ~A" (native-name path)
            (recorded-refusal path)))
    path))

(addition read-results)
(defun read-results (directory)
  "Return the results that RUN-EXPERIMENT or MERGE-RESULTS has kept in DIRECTORY. Signals MISUSE if
DIRECTORY has no results, and DAMAGED-TABLE."
  (check-argument read-results directory (typep directory '(or string pathname))
                  "the name of a directory")
  (let ((path (existing-table-directory directory)))
    (let ((results (call-with-trial-syntax (lambda () (results-from-table (rows-file path))))))
      (setf (results-directory results) path
            (results-until results) (recorded-until path)
            (results-conditions results) (recorded-conditions path))
      results)))
