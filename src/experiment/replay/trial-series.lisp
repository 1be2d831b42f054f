;;;; trial-series.lisp -- TRIAL-SERIES: what was recorded of a trial from tick to tick, read again.

(in-package :ars-magna.experiment)

(defun directory-of-series (results)
  "Return the directory of RESULTS, in which there is a table of series. Signals MISUSE."
  (let ((directory (results-directory results)))
    (unless directory
      (reject-use "trial-series: these results are in no directory. Give RUN-EXPERIMENT a ~
                   :directory, or use (getf (replay-trial ...) :series)."))
    (check-files-plain directory)
    (unless (existing-path (series-file directory))
      (reject-use "trial-series: there is no series.csv in ~A. An experiment with the clause ~
                   :each-tick writes one when it is run with that directory."
                  (native-name directory)))
    directory))

(defun place-of-trial (sample trial)
  "Return where TRIAL is in the vectors of SAMPLE. Signals MISUSE if there is no such trial."
  (or (position trial (sample-trials sample))
      (reject-use "trial-series: there is no trial ~D of ~A in these results." trial
                  (sample-condition sample))))

(defun row-beginning (sample place)
  "Return the texts with which the row at PLACE of SAMPLE begins, up to the number of the trial."
  (append (list (sample-experiment sample) (sample-fingerprint sample) (sample-condition sample))
          (sample-texts sample)
          (list (integer-text (aref (sample-seeds sample) place))
                (integer-text (aref (sample-trials sample) place)))))

(defun block-of-trial (index sample place)
  "Return the block in INDEX of the trial at PLACE of SAMPLE; NIL if it has no lines. Signals MISUSE
if not all of them are there."
  (when (aref (sample-digests sample) place)
    (or (whole-block (blocks-of index (row-beginning sample place))
                     (1+ (aref (sample-ticks sample) place)))
        (reject-use "trial-series: not all lines of trial ~D of ~A are in series.csv. Run the ~
                     experiment again with that directory: it runs such trials again."
                    (aref (sample-trials sample) place) (sample-condition sample)))))

(defun series-values (block seed)
  "Return lists (tick value...) of the lines of BLOCK. SEED is the column of the seed."
  (let ((shared (make-hash-table :test 'equal)))
    (call-with-line-reader
     (lambda (line-of)
       (loop for line in (block-lines block line-of)
             for (tick . texts) = (nthcdr (+ seed 2) (csv-texts (line-text line)))
             collect (cons (parse-integer tick)
                           (loop for text in texts collect (value-in text shared)))))
     (list (block-file block)))))

(addition trial-series)
(defun trial-series (results condition trial)
  "Return what the clause :each-tick has recorded of TRIAL, a number, of CONDITION in RESULTS: a
list of lists (tick value...), the values in the order of the clause: numbers, T, NIL, strings, and
:NONE where there was nothing; () if the trial's time was up. RESULTS are results that are in a
directory, an experiment that was run with one, or the directory's name. CONDITION is its number,
from 1, its name, or a part of that. The whole of series.csv is read each time. Signals MISUSE (no
directory, no such file, trial or lines), UNKNOWN-NAME, WRONG-ARGUMENT, DAMAGED-TABLE."
  (check-argument trial-series trial (and (integerp trial) (<= 0 trial +largest+))
                  "the number of a trial; they count from 1")
  (let* ((results (existing-results results))
         (file (series-file (directory-of-series results)))
         (sample (the-meaning results condition))
         (place (place-of-trial sample trial))
         (index (index-series (list file) (header-of file *series-layout*)))
         (block (block-of-trial index sample place)))
    (and block
         (call-plainly
          (lambda () (series-values block (seed-column (series-index-columns index))))))))
