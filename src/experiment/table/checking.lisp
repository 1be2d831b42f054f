;;;; checking.lisp -- what a row of a table and its header must be, whoever has written them.

(in-package :ars-magna.experiment)

(addition damaged-table)
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

(defun call-writing (function file
                     &optional (trouble "it cannot be written (~A). Is it, or its directory, ~
                                         read-only?"))
  "Call FUNCTION, which opens or changes FILE. If the system refuses, signal DAMAGED-TABLE, which
says TROUBLE, with the reason."
  (handler-case (funcall function)
    (ars-magna-error (condition) (error condition))
    (error (condition) (reject-table file nil trouble (unwritten-reason condition)))))

;;; The header.

(defparameter *rows-layout* (list *columns-between* *columns-after*)
  "What stands in a table of rows from the seed on, before and after what is measured.")
(defparameter *series-layout* (list *series-columns* '())
  "The same of a table of series.")

(defun table-columns-p (columns layout)
  "True if COLUMNS are those of a table of an experiment with LAYOUT."
  (destructuring-bind (between after) layout
    (let ((seed (position "seed" columns :test #'string=)))
      (and seed
           (>= seed (length *columns-before*))
           (equal *columns-before* (subseq columns 0 (length *columns-before*)))
           (>= (- (length columns) seed) (+ (length between) (length after)))
           (equal between (subseq columns seed (+ seed (length between))))
           (equal after (last columns (length after)))))))

(defun check-header-line (line file)
  "Signal DAMAGED-TABLE if LINE, the first of FILE, shows that a program has saved it in a way of
its own."
  (when (or (find #\Return line) (eql 0 (search (format nil "~C~C~C" (code-char #xEF)
                                                        (code-char #xBB) (code-char #xBF))
                                                line)))
    (reject-table file 1 "an editor or spreadsheet has saved this with line ends or marks of its ~
                          own. Take the table as it was; or save it as plain UTF-8 with line feeds ~
                          only.")))

(defun columns-in (line file layout)
  "Return the names of the columns in LINE, of octets, the first of FILE, a table with LAYOUT.
Signals DAMAGED-TABLE."
  (check-header-line line file)
  (let ((columns (ignore-errors (csv-texts (line-text line)))))
    (unless (table-columns-p columns layout)
      (reject-table file 1 "this is no table of an experiment. Give another directory."))
    columns))

(defun seed-column (columns)
  (position "seed" columns :test #'string=))

;;; Rows.

(defparameter *outcomes* '("success" "failure" "limit" "error" "timeout")
  "What a trial can have come to.")

(defun timed-out-p (texts columns)
  "True if the row TEXTS, of a table with COLUMNS, is of a trial whose time was up: it cannot be had
again."
  (string= "timeout" (nth (position "outcome" columns :test #'string=) texts)))

(defun hexadecimal-p (text)
  (declare (type simple-string text))
  (and (<= 1 (length text) 16)
       (loop for char across text always (digit-char-p char 16))))

(defun integer-in (text)
  "Return the integer that TEXT is, as a table has it, or NIL."
  (and (plusp (length text))
       (every #'digit-char-p (string-left-trim "-" text))
       (ignore-errors (parse-integer text))))

(defun check-cells (cells columns file number)
  "Signal DAMAGED-TABLE unless CELLS, from the seed's on, of the line NUMBER of FILE, can be so."
  (flet ((check (test column)
           (unless test
             (reject-row file number "~A cannot be the ~A of a trial."
                         (nth (position column columns :test #'string=)
                              (append (make-list (seed-column columns)) cells))
                         column))))
    (unless (every (lambda (cell) (every #'writable-char-p (the simple-string cell))) cells)
      (reject-row file number "This is no row: it has bytes that are no text."))
    (destructuring-bind (seed trial outcome reason ticks &rest rest) cells
      (declare (ignore reason))
      (check (integer-in seed) "seed")
      (check (typep (integer-in trial) `(integer 1 ,+largest+)) "trial")
      (check (member outcome *outcomes* :test #'string=) "outcome")
      ;; Earlier versions wrote 0 for a trial whose time was up.
      (check (or (typep (integer-in ticks) `(integer 0 ,+largest+))
                 (and (string= "" ticks) (string= "timeout" outcome)))
             "ticks")
      (let ((digest (first (last rest 2))))
        (check (or (string= "" digest) (hexadecimal-p digest)) "digest")))))

(defun line-text (line)
  "Return the text that LINE, whose characters are octets, stands for."
  (declare #.*hot* (type (simple-array character (*)) line))
  (if (every (lambda (char) (< (char-code char) 128)) line)
      line
      (decoded line)))

(defun cells-of-line (line columns file number)
  "Return the texts of LINE, of octets, which is the line NUMBER of FILE, a table of rows or series
with COLUMNS. Signals DAMAGED-TABLE."
  (let ((texts (handler-case (csv-texts (line-text line))
                 (broken-line () '()))))
    (unless (= (length texts) (length columns))
      (reject-row file number "This is no row with ~D columns." (length columns)))
    (unless (hexadecimal-p (second texts))
      (reject-row file number "This is no row: ~A is no fingerprint." (plain-text (second texts))))
    texts))
