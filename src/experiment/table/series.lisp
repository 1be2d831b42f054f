;;;; series.lisp -- reading and sorting tables of series.

(in-package :ars-magna.experiment)

;;; All lines of a trial are written at once, so they are adjacent: a block. A killed process may
;;; leave an incomplete block. The index has one object for each block, not for each line. Most
;;; lines begin like the previous one, up to the tick, and need not be parsed.

(defstruct (series-block (:conc-name block-)
                         (:constructor make-series-block (file start number seed first))
                         (:copier nil))
  "COUNT consecutive lines of a trial, with the ticks from FIRST on: their file, the positions of
start and end, and the number of the first line."
  (file nil :read-only t)
  (start 0 :type integer :read-only t)
  (end 0 :type integer)
  (number 0 :type fixnum :read-only t)
  (seed 0 :type integer :read-only t)
  (first 0 :type integer :read-only t)
  (count 0 :type fixnum))

(defstruct (series-index (:constructor make-series-index (columns)) (:copier nil))
  "The blocks in tables of series with COLUMNS, by the list of texts before the seed, and by trial."
  (columns '() :type list :read-only t)
  (groups (make-hash-table :test 'equal) :read-only t))

(defun series-group (key index)
  (or (gethash key (series-index-groups index))
      (setf (gethash key (series-index-groups index)) (make-hash-table))))

(defun trial-blocks (index key seed trial)
  "Return the blocks that INDEX has for TRIAL with SEED and the texts KEY before the seed."
  (let ((group (gethash key (series-index-groups index))))
    (and group
         (remove seed (gethash trial group) :key #'block-seed :test-not #'=))))

(defun blocks-of-row (index texts)
  (let ((seed (seed-column (series-index-columns index))))
    (trial-blocks index (subseq texts 0 seed) (parse-integer (nth seed texts))
                  (parse-integer (nth (1+ seed) texts)))))

;;; Lines.

(defun map-commas (function line start)
  "Call FUNCTION with the position of each comma outside of quotes in LINE, from START on."
  (declare #.*hot* (type (simple-array character (*)) line) (type fixnum start)
           (type function function))
  (loop with quoted-p = nil
        for place of-type fixnum from start below (length line)
        for char = (char line place)
        do (cond ((char= #\" char) (setf quoted-p (not quoted-p)))
                 ((and (char= #\, char) (not quoted-p)) (funcall function place)))))

(defun count-commas (line start)
  (let ((count 0))
    (map-commas (lambda (place) (declare (ignore place)) (incf count)) line start)
    count))

(defun cell-start (line number)
  (map-commas (lambda (place) (when (zerop (decf number)) (return-from cell-start (1+ place))))
              line 0))

(defun begins-with-p (beginning line)
  (declare #.*hot* (type (simple-array character (*)) beginning line))
  (and (<= (length beginning) (length line))
       (loop for char across beginning
             for other across line
             always (char= char other))))

(defun tick-in-line (line start)
  "Return the tick in the cell of LINE that begins at START, or NIL."
  (let ((end (position #\, line :start start)))
    (and end (integer-from-text (subseq line start end)))))

;;; Reading.

(defstruct (series-scan (:conc-name scan-) (:constructor make-series-scan (index file))
                        (:copier nil))
  "The state of reading FILE into INDEX: the current BLOCK and the BEGINNING of its lines."
  (index nil :type series-index :read-only t)
  (file nil :read-only t)
  (beginning "" :type (simple-array character (*)))
  (block nil :type (or null series-block)))

(defun continues-block-p (scan line)
  (let ((block (scan-block scan)) (beginning (scan-beginning scan)))
    (and block
         (begins-with-p beginning line)
         (eql (+ (block-first block) (block-count block)) (tick-in-line line (length beginning))))))

(defun check-series-cells (texts seed file number)
  "TEXTS are line NUMBER of FILE. Signal DAMAGED-TABLE unless those from SEED on are valid."
  (loop for text in (nthcdr seed texts)
        for column in *columns-before-values*
        for least in (list most-negative-fixnum 1 0)
        unless (typep (integer-from-text text) `(integer ,least))
          do (reject-row file number "~A cannot be the ~A of a trial." (plain-text text) column)))

(defun begin-block (scan line start number)
  (let* ((index (scan-index scan)) (columns (series-index-columns index))
         (texts (cells-of-line line columns (scan-file scan) number))
         (seed (seed-column columns)))
    (check-series-cells texts seed (scan-file scan) number)
    (destructuring-bind (its-seed trial tick)
        (mapcar #'parse-integer (subseq texts seed (+ seed 3)))
      (let ((block (make-series-block (scan-file scan) start number its-seed tick)))
        (push block (gethash trial (series-group (subseq texts 0 seed) index)))
        (setf (scan-block scan) block
              (scan-beginning scan) (subseq line 0 (cell-start line (+ seed 2))))))))

(defun check-series-width (scan line number)
  "Signal DAMAGED-TABLE unless LINE, the line NUMBER, has a cell for each column."
  (let ((columns (series-index-columns (scan-index scan))))
    (unless (= (count-commas line (length (scan-beginning scan)))
               (- (length columns) (seed-column columns) 3))
      (reject-row (scan-file scan) number "This is no row with ~D columns." (length columns)))))

(defun note-series-line (scan line start number)
  (unless (continues-block-p scan line) (begin-block scan line start number))
  (check-series-width scan line number)
  (let ((block (scan-block scan)))
    (incf (block-count block))
    (setf (block-end block) (+ start (length line) 1))))

(defun index-series (files columns)
  "Return an index of FILES, tables of series with COLUMNS. Signals DAMAGED-TABLE."
  (let ((index (make-series-index columns)))
    (dolist (file files index)
      (check-file-header file columns)
      (let ((scan (make-series-scan index file)))
        (map-lines (lambda (line start number)
                     (when (> number 1) (note-series-line scan line start number)))
                   file)))))

;;;; Finding and sorting the lines of trials

;;; A trial is sampled at tick 0 and after each tick, so its row determines its number of lines. A
;;; row with missing lines counts as missing: its trial is run again. Lines of trials without a row
;;; are dropped when the table is sorted.

(defun expected-line-count (texts seed)
  "Return the number of lines that the trial with the row TEXTS must have. SEED is the seed's
column. The number is 0 if the row has no digest: after a timeout or the end of the trial's thread."
  (if (string= "" (first (last texts 2)))
      0
      (1+ (parse-integer (nth (+ 4 seed) texts)))))

(defun find-complete-block (blocks count)
  "Return one of BLOCKS that has all COUNT lines of a trial, or NIL."
  (find-if (lambda (block) (and (zerop (block-first block)) (= count (block-count block)))) blocks))

(defun block-of-row (index texts)
  (find-complete-block (blocks-of-row index texts)
                       (expected-line-count texts (seed-column (series-index-columns index)))))

(defun index-existing-series (experiment directory)
  "Return the index of EXPERIMENT's series in DIRECTORY; NIL if it has none. Signals DAMAGED-TABLE."
  (and (experiment-series experiment)
       (index-series (remove-if-not #'existing-path (list (series-file directory)))
                     (series-columns experiment))))

(defun series-complete-p (index texts)
  "True if INDEX has all lines of the trial with the row TEXTS, or if INDEX is NIL: no series."
  (or (null index)
      (zerop (expected-line-count texts (seed-column (series-index-columns index))))
      (block-of-row index texts)))

;;; Lines.

(defun block-lines (block line-of)
  "Return a list of the lines of BLOCK, as octets. LINE-OF is as in CALL-WITH-LINE-READER."
  (loop with start = (block-start block)
        repeat (block-count block)
        for line = (funcall line-of (block-file block) start)
        do (incf start (1+ (length line)))
        collect line))

(defun write-lines (lines out)
  (dolist (line lines) (write-line (line-text line) out)))

(defun existing-series-text (index texts)
  "Return the lines in INDEX of the trial with the row TEXTS, as one string."
  (let ((block (and index (block-of-row index texts))))
    (with-output-to-string (out)
      (when block
        (call-with-line-reader (lambda (line-of) (write-lines (block-lines block line-of) out))
                               (list (block-file block)))))))

;;; Order.

(defun reject-conflicting-block (block whole)
  (reject-table (block-file block) (block-number block)
                "the lines of a trial begin here. They differ from the lines of the same trial ~
                 that begin at line ~D of ~A. Something outside of the experiment affects its ~
                 trials; no table can have both."
                (block-number whole) (native-name (block-file whole))))

(defun check-same-lines (block whole line-of)
  "Signal DAMAGED-TABLE unless WHOLE, a block of the same trial, has the lines of BLOCK."
  (let ((lines (nthcdr (block-first block) (block-lines whole line-of)))
        (others (block-lines block line-of)))
    (unless (and (<= (length others) (length lines)) (every #'string= others lines))
      (reject-conflicting-block block whole))))

(defun reject-missing-series (rows texts seed)
  (reject-use "Trial ~A of the condition ~A has a row, but not all of its lines are in series.csv. ~
               Run the experiment again in the directory of that row, with at least as many ~
               trials: it runs such trials again. ~A is unchanged."
              (nth (1+ seed) texts) (third texts)
              (native-name (uiop:pathname-directory-pathname rows))))

(defun select-block (index texts line-of)
  (let ((whole (block-of-row index texts)))
    (when whole
      (dolist (block (blocks-of-row index texts) whole)
        (unless (eq block whole) (check-same-lines block whole line-of))))))

;; Conditions may have rows without series, from before the clause :each-tick was added.
(defun select-blocks (rows index line-of)
  "Return a vector of the blocks that INDEX has for trials in the table ROWS, in the order of ROWS.
Signals MISUSE if a trial has no block but other trials of its condition have blocks."
  (let ((blocks (make-array 1000 :adjustable t :fill-pointer 0))
        (seed (seed-column (series-index-columns index))))
    (do-rows (texts rows)
      (let ((block (select-block index texts line-of)))
        (cond (block (vector-push-extend block blocks))
              ((series-complete-p index texts))
              ((gethash (subseq texts 0 seed) (series-index-groups index))
               (reject-missing-series rows texts seed)))))
    blocks))

(defun file-has-just-blocks-p (blocks file)
  "True if FILE has exactly BLOCKS, in this order."
  (let ((place (1+ (length (first-line file)))))
    (and (loop for block across blocks
               always (and (eq file (block-file block)) (= place (block-start block)))
               do (setf place (block-end block)))
         (= place (file-size file)))))

(defun write-blocks (blocks columns line-of file)
  (call-replacing-table (lambda (out)
                          (write-string (csv-line columns) out)
                          (loop for block across blocks
                                do (write-lines (block-lines block line-of) out)))
                        file))

(defun write-sorted-series (files rows file)
  "Copy the lines for the trials in the table ROWS to FILE, each line once, in the order of ROWS.
The lines come from FILES, tables of series. FILE may be one of FILES. Signals DAMAGED-TABLE and
MISUSE; after an error FILE is unchanged."
  (let* ((columns (columns-of-file (first files) *series-layout*))
         (index (index-series files columns)))
    (call-with-line-reader
     (lambda (line-of)
       (let ((blocks (select-blocks rows index line-of)))
         (unless (and (equal files (list file)) (file-has-just-blocks-p blocks (first files)))
           (write-blocks blocks columns line-of file))))
     files)))
