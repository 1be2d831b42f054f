;;;; series-blocks.lisp -- where in a table of series the lines of each trial are.

(in-package :ars-magna.experiment)

;;; A trial's lines are written at one stroke, so they stand together: a block. What was killed may
;;; have left the beginning of another one. The index has one object for each block, not for each
;;; line. Most lines begin as the one before does, up to the tick, and are not taken apart.

(defstruct (series-block (:conc-name block-)
                         (:constructor make-series-block (file start number seed first))
                         (:copier nil))
  "COUNT consecutive lines of a trial, with the ticks from FIRST on: in which of several files they
begin and end, and on which line."
  (file nil :read-only t)
  (start 0 :type integer :read-only t)
  (end 0 :type integer)
  (number 0 :type fixnum :read-only t)
  (seed 0 :type integer :read-only t)
  (first 0 :type integer :read-only t)
  (count 0 :type fixnum))

(defstruct (series-index (:constructor make-series-index (columns)) (:copier nil))
  "The blocks in tables of series with COLUMNS: by what they have before the seed, and by trial."
  (columns '() :type list :read-only t)
  (groups (make-hash-table :test 'equal) :read-only t))

(defun series-group (key index)
  "Return the table of blocks by trial of KEY, which is made if there is none."
  (or (gethash key (series-index-groups index))
      (setf (gethash key (series-index-groups index)) (make-hash-table))))

(defun blocks-of (index texts)
  "Return the blocks in INDEX of the trial that a row is of which begins with TEXTS."
  (let* ((seed (seed-column (series-index-columns index)))
         (group (gethash (subseq texts 0 seed) (series-index-groups index))))
    (destructuring-bind (its-seed trial) (mapcar #'parse-integer (subseq texts seed (+ seed 2)))
      (and group
           (remove its-seed (gethash trial group) :key #'block-seed :test-not #'=)))))

;;; Lines.

(defun map-commas (function line start)
  "Call FUNCTION with the place of each comma in LINE from START on that is not in quotes."
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
  "Return where the cell NUMBER, from 0 but not 0, begins in LINE."
  (map-commas (lambda (place) (when (zerop (decf number)) (return-from cell-start (1+ place))))
              line 0))

(defun begins-with-p (beginning line)
  (declare #.*hot* (type (simple-array character (*)) beginning line))
  (and (<= (length beginning) (length line))
       (loop for char across beginning
             for other across line
             always (char= char other))))

(defun tick-at (line start)
  "Return the number of the tick in the cell of LINE that begins at START, or NIL."
  (let ((end (position #\, line :start start)))
    (and end (integer-in (subseq line start end)))))

;;; Reading.

(defstruct (series-scan (:conc-name scan-) (:constructor make-series-scan (index file))
                        (:copier nil))
  "How far the table FILE has been read into INDEX: the BLOCK at hand, and the BEGINNING of its
lines."
  (index nil :type series-index :read-only t)
  (file nil :read-only t)
  (beginning "" :type (simple-array character (*)))
  (block nil :type (or null series-block)))

(defun continues-block-p (scan line)
  "True if LINE is the next one of the block of SCAN."
  (let ((block (scan-block scan)) (beginning (scan-beginning scan)))
    (and block
         (begins-with-p beginning line)
         (eql (+ (block-first block) (block-count block)) (tick-at line (length beginning))))))

(defun check-series-cells (texts seed file number)
  "Signal DAMAGED-TABLE unless TEXTS, from SEED on, of the line NUMBER of FILE, can be so."
  (loop for text in (nthcdr seed texts)
        for column in *series-columns*
        for least in (list most-negative-fixnum 1 0)
        unless (typep (integer-in text) `(integer ,least))
          do (reject-row file number "~A cannot be the ~A of a trial." (plain-text text) column)))

(defun begin-block (scan line start number)
  "Let SCAN have a block that begins with LINE, at START, the line NUMBER."
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
      (check-beginning file columns)
      (let ((scan (make-series-scan index file)))
        (map-lines (lambda (line start number)
                     (when (> number 1) (note-series-line scan line start number)))
                   file)))))
