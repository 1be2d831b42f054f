;;;; row.lisp -- what came of a trial, as a row of the table.

(in-package :ars-magna.experiment)

(defun digest-text (digest)
  "Return DIGEST as 16 hexadecimal digits."
  (let ((text (make-string 16)))
    (dotimes (place 16 text)
      (setf (char text place)
            (char "0123456789ABCDEF" (ldb (byte 4 (* 4 (- 15 place))) digest))))))

(defun result-digest-text (result)
  "Return how the digest of RESULT stands in its row."
  (let ((digest (result-digest result)))
    (if digest (digest-text digest) "")))

(defun result-texts (experiment result)
  "Return the texts of the row for RESULT, of a trial of EXPERIMENT, in the order of its columns."
  (let ((condition (result-condition result)))
    (append (list (column-name (experiment-name experiment))
                  (condition-fingerprint condition)
                  (condition-name condition))
            (condition-texts condition)
            (list (princ-to-string (result-seed result))
                  (princ-to-string (result-trial result))
                  (result-outcome result)
                  (result-reason result)
                  (princ-to-string (result-ticks result)))
            (or (result-measures result)
                (make-list (length (experiment-measures experiment)) :initial-element ""))
            (list (result-digest-text result)
                  (result-error result)))))
