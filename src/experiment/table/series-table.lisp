;;;; series-table.lisp -- the table of series: what of it is there, and putting it in order.

(in-package :ars-magna.experiment)

;;; A trial is sampled at tick 0 and after each tick, so its row says how many lines it has. A row
;;; whose lines are not all there counts as missing: its trial is run again. Lines of trials without
;;; a row are dropped when the table is put in order.

(defun count-expected (texts seed)
  "Return how many lines the trial has whose row is TEXTS, with SEED the column of the seed. None if
the row says nothing of how it ended, as its time was up or it ended its thread."
  (if (string= "" (first (last texts 2)))
      0
      (1+ (parse-integer (nth (+ 4 seed) texts)))))

(defun whole-block (blocks count)
  "Return one of BLOCKS that has the COUNT lines of a trial, or NIL."
  (find-if (lambda (block) (and (zerop (block-first block)) (= count (block-count block)))) blocks))

(defun block-of-row (index texts)
  "Return the block in INDEX with all lines of the trial whose row is TEXTS, or NIL."
  (whole-block (blocks-of index texts)
               (count-expected texts (seed-column (series-index-columns index)))))

(defun series-there (experiment directory)
  "Return the index of the series of EXPERIMENT in DIRECTORY; NIL if it records none. Signals
DAMAGED-TABLE."
  (and (experiment-series experiment)
       (index-series (remove-if-not #'existing-path (list (series-file directory)))
                     (series-columns experiment))))

(defun series-complete-p (index texts)
  "True if INDEX, or NIL if there are no series, has all lines of the trial whose row is TEXTS."
  (or (null index)
      (zerop (count-expected texts (seed-column (series-index-columns index))))
      (block-of-row index texts)))

;;; Lines.

(defun block-lines (block line-of)
  "Return the lines of BLOCK, of octets. LINE-OF returns the line of a file that begins at a place."
  (loop with start = (block-start block)
        repeat (block-count block)
        for line = (funcall line-of (block-file block) start)
        do (incf start (1+ (length line)))
        collect line))

(defun write-lines (lines out)
  (dolist (line lines) (write-line (line-text line) out)))

(defun series-text-there (index texts)
  "Return the lines that INDEX has of the trial whose row is TEXTS, one text."
  (let ((block (and index (block-of-row index texts))))
    (with-output-to-string (out)
      (when block
        (call-with-line-reader (lambda (line-of) (write-lines (block-lines block line-of) out))
                               (list (block-file block)))))))

;;; Order.

(defun reject-other-block (block whole)
  (reject-table (block-file block) (block-number block)
                "the lines of a trial that begin here differ from those that begin at line ~D of ~
                 ~A. Something outside of the experiment decides its trials; no table can have ~
                 both."
                (block-number whole) (native-name (block-file whole))))

(defun check-same-lines (block whole line-of)
  "Signal DAMAGED-TABLE unless the lines of BLOCK are among those of WHOLE, of the same trial."
  (let ((lines (nthcdr (block-first block) (block-lines whole line-of)))
        (others (block-lines block line-of)))
    (unless (and (<= (length others) (length lines)) (every #'string= others lines))
      (reject-other-block block whole))))

(defun reject-missing-series (rows texts seed)
  (reject-use "Trial ~A of the condition ~A has a row, but not all of its lines are in series.csv. ~
               Run the experiment again in the directory of that row, with at least so many ~
               trials: it runs such trials again. ~A is as it was."
              (nth (1+ seed) texts) (third texts)
              (native-name (uiop:pathname-directory-pathname rows))))

(defun chosen-block (index texts line-of)
  "Return the block in INDEX with the lines of the trial whose row is TEXTS, or NIL. Signals
DAMAGED-TABLE if there are others that differ."
  (let ((whole (block-of-row index texts)))
    (when whole
      (dolist (block (blocks-of index texts) whole)
        (unless (eq block whole) (check-same-lines block whole line-of))))))

;; There may be rows of conditions for which nothing was recorded, from before there was the clause.
(defun chosen-blocks (rows index line-of)
  "Return a vector of the blocks in INDEX of the trials in the table ROWS, in its order. Signals
MISUSE if one has none, but others of its condition have."
  (let ((blocks (make-array 1000 :adjustable t :fill-pointer 0))
        (seed (seed-column (series-index-columns index))))
    (do-rows (texts rows)
      (let ((block (chosen-block index texts line-of)))
        (cond (block (vector-push-extend block blocks))
              ((series-complete-p index texts))
              ((gethash (subseq texts 0 seed) (series-index-groups index))
               (reject-missing-series rows texts seed)))))
    blocks))

(defun blocks-in-place-p (blocks file)
  "True if FILE has BLOCKS, in order, and nothing else."
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

(defun write-series-in-order (files rows file)
  "Write what FILES, tables of series, have of the trials in the table ROWS to FILE, in the order of
ROWS and each line once; FILE may be one of them. Signals DAMAGED-TABLE and MISUSE; then FILE is as
it was."
  (let* ((columns (header-of (first files) *series-layout*))
         (index (index-series files columns)))
    (call-with-line-reader
     (lambda (line-of)
       (let ((blocks (chosen-blocks rows index line-of)))
         (unless (and (equal files (list file)) (blocks-in-place-p blocks (first files)))
           (write-blocks blocks columns line-of file))))
     files)))
