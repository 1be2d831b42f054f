;;;; row.lisp -- what came of a trial, as a row of the table.

(in-package :ars-magna.experiment)

(defun digest-text (digest)
  (let ((text (make-string 16)))
    (dotimes (place 16 text)
      (setf (char text place)
            (char "0123456789ABCDEF" (ldb (byte 4 (* 4 (- 15 place))) digest))))))

(defun result-digest-text (result)
  (let ((digest (result-digest result)))
    (if digest (digest-text digest) "")))

(defun trial-texts (experiment result)
  "Return the texts that say of which trial of EXPERIMENT RESULT is: each line begins with them."
  (let ((condition (result-condition result)))
    (append (list (column-name (experiment-name experiment))
                  (condition-fingerprint condition)
                  (condition-name condition))
            (condition-texts condition)
            (list (integer-text (result-seed result))
                  (integer-text (result-trial result))))))

(defun result-texts (experiment result)
  "Return the texts of the row for RESULT, of a trial of EXPERIMENT, in the order of its columns."
  (append (trial-texts experiment result)
          (list (result-outcome result)
                (result-reason result)
                (format nil "~@[~D~]" (result-ticks result)))
          (or (result-measures result)
              (make-list (length (experiment-measures experiment)) :initial-element ""))
          (list (result-digest-text result)
                (result-error result))))

;;; What was recorded from tick to tick.

(defun series-text (experiment result)
  "Return the lines of the table of series for RESULT, of a trial of EXPERIMENT; empty if it has
none."
  (let* ((line (csv-line (trial-texts experiment result)))
         (beginning (substitute #\, #\Newline line :start (1- (length line)))))
    (with-output-to-string (out)
      (loop for (tick . texts) in (result-series result)
            do (write-string beginning out)
               (write-string (csv-line (cons (integer-text tick) texts)) out)))))

(defun texts-with-mark (texts experiment series)
  "Return TEXTS, of a row of EXPERIMENT, and if that records anything the check sum of SERIES, the
trial's lines."
  (if (experiment-series experiment)
      (append texts (list (format nil "~8,'0X" (text-checksum series))))
      texts))
