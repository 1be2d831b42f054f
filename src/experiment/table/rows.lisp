;;;; rows.lisp -- rows of a table: how they are made and checked.

(in-package :ars-magna.experiment)

(addition damaged-table)

(defun result-digest-text (result)
  (format nil "~@[~16,'0X~]" (result-digest result)))

(defun trial-key-texts (experiment result)
  "Return the texts, up to the trial's number, with which each line of EXPERIMENT's RESULT begins."
  (let ((condition (result-condition result)))
    (append (list (string-downcase (experiment-name experiment))
                  (condition-fingerprint condition)
                  (condition-name condition))
            (condition-texts condition)
            (list (integer-text (result-seed result))
                  (integer-text (result-trial result))))))

(defun result-texts (experiment result)
  (append (trial-key-texts experiment result)
          (list (result-outcome result)
                (result-reason result)
                (format nil "~@[~D~]" (result-ticks result)))
          (or (result-measures result)
              (make-list (length (experiment-measures experiment)) :initial-element ""))
          (list (result-digest-text result)
                (result-error result))))

;;; Lines of series.

(defun series-text (experiment result)
  "Return the lines for RESULT of EXPERIMENT in the table of series, or \"\" if there are none."
  (let* ((line (csv-line (trial-key-texts experiment result)))
         (beginning (substitute #\, #\Newline line :start (1- (length line)))))
    (with-output-to-string (out)
      (loop for (tick . texts) in (result-series result)
            do (write-string beginning out)
               (write-string (csv-line (cons (integer-text tick) texts)) out)))))

(defun texts-with-checksum (texts experiment series)
  "Return TEXTS, the cells of a row of EXPERIMENT. If EXPERIMENT records series, add the checksum of
SERIES, the trial's lines, at the end."
  (if (experiment-series experiment)
      (append texts (list (format nil "~8,'0X" (text-checksum series))))
      texts))

;;;; Checking headers and rows

(define-condition damaged-table (ars-magna-error)
  ((file :initarg :file :reader damaged-table-file)
   (line :initarg :line :initform nil :reader damaged-table-line)
   (trouble :initarg :trouble :reader damaged-table-trouble))
  (:report (lambda (condition stream)
             (format stream "~A~@[, line ~D~]: ~A"
                     (native-name (damaged-table-file condition))
                     (damaged-table-line condition)
                     (damaged-table-trouble condition))))
  (:documentation "A table of an experiment cannot be used as it is."))

(defun reject-table (file line control &rest arguments)
  (error 'damaged-table :file file :line line
                        :trouble (apply #'format nil control arguments)))

(defun reject-row (file number control &rest arguments)
  (reject-table file number "~? Delete the line; its trial will be run again." control arguments))

(defun call-reporting-file-errors
    (function file
     &optional (trouble "the file cannot be written (~A). Is it, or its directory, read-only?"))
  "Call FUNCTION, which opens or changes FILE. If the operating system refuses, signal DAMAGED-TABLE
with the text TROUBLE and the reason."
  (handler-case (funcall function)
    (ars-magna-error (condition) (error condition))
    (error (condition) (reject-table file nil trouble (write-failure-text condition)))))

;;; The header.

(defparameter *rows-layout* (list *columns-before-measures* *columns-after-measures*)
  "Two lists of the columns in a table of rows: from the seed to the measures, and after these.")
(defparameter *series-layout* (list *columns-before-values* '())
  "Two lists of the columns in a table of series: from the seed to the values, and after these.")

(defun table-columns-p (columns layout)
  "True if COLUMNS can be those of an experiment's table with LAYOUT."
  (destructuring-bind (between after) layout
    (let ((seed (position "seed" columns :test #'string=)))
      (and seed
           (>= seed (length *columns-before-factors*))
           (equal *columns-before-factors* (subseq columns 0 (length *columns-before-factors*)))
           (>= (- (length columns) seed) (+ (length between) (length after)))
           (equal between (subseq columns seed (+ seed (length between))))
           (equal after (last columns (length after)))))))

(defun check-header-line (line file)
  "Signal DAMAGED-TABLE if LINE, the first of FILE, has a carriage return or a byte order mark."
  (when (or (find #\Return line) (eql 0 (search (format nil "~C~C~C" (code-char #xEF)
                                                        (code-char #xBB) (code-char #xBF))
                                                line)))
    (reject-table file 1 "an editor or spreadsheet added carriage returns or a byte order mark. ~
                          Use the original table, or save it as UTF-8 with line feeds only.")))

(defun seed-column (columns)
  (position "seed" columns :test #'string=))

;;; Rows.

(defun timed-out-p (texts columns)
  "True if TEXTS, a row of a table with COLUMNS, is a timeout, which need not be repeatable."
  (string= "timeout" (nth (position "outcome" columns :test #'string=) texts)))

(defun hexadecimal-p (text)
  (declare (type simple-string text))
  (and (<= 1 (length text) 16)
       (loop for char across text always (digit-char-p char 16))))

(defun integer-from-text (text)
  "Return the integer that TEXT, a cell of a table, represents, or NIL."
  (and (plusp (length text))
       (every #'digit-char-p (string-left-trim "-" text))
       (ignore-errors (parse-integer text))))

(defun check-cells (cells columns file number)
  "Signal DAMAGED-TABLE if one of CELLS, line NUMBER of FILE from the seed on, is not valid."
  (flet ((check (test column)
           (unless test
             (reject-row file number "~A cannot be the ~A of a trial."
                         (nth (position column columns :test #'string=)
                              (append (make-list (seed-column columns)) cells))
                         column))))
    (unless (every (lambda (cell) (every #'writable-char-p (the simple-string cell))) cells)
      (reject-row file number "This is no row: it has bytes that are not text."))
    (destructuring-bind (seed trial outcome reason ticks &rest rest) cells
      (declare (ignore reason))
      (check (integer-from-text seed) "seed")
      (check (typep (integer-from-text trial) `(integer 1 ,+largest+)) "trial")
      (check (member outcome '("success" "failure" "limit" "error" "timeout") :test #'string=)
             "outcome")
      ;; Earlier versions wrote 0 for a timeout.
      (check (or (typep (integer-from-text ticks) `(integer 0 ,+largest+))
                 (and (string= "" ticks) (string= "timeout" outcome)))
             "ticks")
      (let ((digest (first (last rest 2))))
        (check (or (string= "" digest) (hexadecimal-p digest)) "digest")))))

(defun line-text (line)
  "Return the text of LINE, a string whose characters stand for octets."
  (declare #.*hot* (type (simple-array character (*)) line))
  (if (every (lambda (char) (< (char-code char) 128)) line)
      line
      (utf-8-decoded line)))

(defun cells-of-line (line columns file number)
  "Return the cells of LINE, the octets of line NUMBER of FILE. FILE is a table of rows or series
with COLUMNS. Signals DAMAGED-TABLE."
  (let ((texts (handler-case (csv-fields (line-text line))
                 (broken-line () '()))))
    (unless (= (length texts) (length columns))
      (reject-row file number "This is no row with ~D columns." (length columns)))
    (unless (hexadecimal-p (second texts))
      (reject-row file number "This is no row: ~A is no fingerprint." (plain-text (second texts))))
    texts))

;;;; Files

(defun file-in (directory name)
  (merge-pathnames (native-path name) directory))

(defun rows-file (directory) (file-in directory "rows.csv"))
(defun series-file (directory) (file-in directory "series.csv"))
(defun machine-file (directory) (file-in directory "machine.csv"))
(defun description-file (directory) (file-in directory "experiment.txt"))

(defun lock-file (directory) (file-in directory ".lock"))

(defun check-plain-file (file)
  "Signal DAMAGED-TABLE if FILE exists and is not a plain file."
  (let ((trouble (cond ((dangling-link-p file) "it is a link to a file that does not exist")
                       ((and (probe-file file) (not (regular-file-p file)))
                        "it is a directory, pipe, socket or device"))))
    (when trouble
      (reject-table file nil "~A. Remove it, or give another directory." trouble))))

(defun check-files-plain (directory)
  (mapc #'check-plain-file (list (rows-file directory) (series-file directory)
                                 (machine-file directory) (description-file directory))))

(defun directory-path (name)
  (uiop:ensure-directory-pathname
   (merge-pathnames (path-of-name name :directory t) (base-directory))))
