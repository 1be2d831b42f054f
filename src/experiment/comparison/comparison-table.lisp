;;;; comparison-table.lisp -- PRINT-COMPARISON: verdicts, and the figures that they are from.

(in-package :ars-magna.experiment)

(defparameter *headings* '("measure" "seeds" "first" "second" "difference" "p" "p alone"))

(defun table-row (difference)
  (let ((write (number-writer difference)) (rate-p (eq :rate (paired-kind difference))))
    (flet ((text (value) (if value (funcall write value) "-")))
      (list (paired-measure difference) (integer-text (paired-trials difference))
            (format nil "~A~:[~; %~]" (text (paired-first difference)) rate-p)
            (format nil "~A~:[~; %~]" (text (paired-second difference)) rate-p)
            (format nil "~A (~A to ~A)" (text (paired-estimate difference))
                    (text (paired-low difference)) (text (paired-high difference)))
            (bare-p (paired-adjusted-p difference)) (bare-p (paired-p difference))))))

(defun contrast-heading (contrast)
  (let ((table (let ((success (difference-called "success" contrast)))
                 (and success (paired-table success)))))
    (format nil "~@[~A: ~]~A (first) against ~A~:[~; (the same)~]~@[: ~{both ~D, only the first ~
                 ~D, only the second ~D, neither ~D~}~]"
            (contrast-where contrast) (contrast-first contrast) (contrast-second contrast)
            (same-runs-p contrast) table)))

(defun write-table (comparison stream)
  (let* ((groups (loop for contrast in (all-contrasts comparison)
                       collect (mapcar #'table-row (contrast-differences contrast))))
         (columns (apply #'mapcar (lambda (heading &rest texts)
                                    (make-text-column heading texts
                                                      :whole-p t
                                                      :anchor (if (string= "measure" heading)
                                                                  :start
                                                                  :end)))
                         *headings* (apply #'append groups))))
    (write-cells (mapcar #'list *headings*) columns stream)
    (loop for contrast in (all-contrasts comparison)
          for rows in groups
          do (format stream "~A~%" (contrast-heading contrast))
             (dolist (row rows) (write-cells (mapcar #'list row) columns stream)))))

(defun method-words (comparison)
  (format nil "Differences are first less second, seed by seed, each with its own 95 % interval: ~
               of rates Newcombe's and McNemar's exact test, of means Student's and a permutation ~
               test (of equal distributions: skewed numbers can differ in that while their ~
               averages are equal). p: as one of ~D test~:P~@[, over all of ~D~], by Holm's ~
               correction (alone: without it)."
          (length (tested-differences (comparison-contrasts comparison)))
          (and (comparison-overall comparison)
               (length (tested-differences (comparison-overall comparison))))))

(addition print-comparison)
(defun print-comparison (comparison &optional (stream *standard-output*))
  "Write COMPARISON to STREAM: a line that says what is compared, and what the experiment asks, if
that is known; of versions what has changed between them; the verdicts (see COMPARISON-VERDICTS), a
line each; what was left out, if anything; and a table, with a line for each pair of conditions, how
many trials succeeded in both, one and neither of them, and below it a row for each measure: over
how many seeds, both rates or means, the difference (of rates in points) with its 95 % interval, and
p after and before Holm's correction for all tests. Return COMPARISON."
  (check-argument print-comparison comparison (comparison-p comparison) "a comparison")
  (write-wrapped (format nil "The experiment ~A, seed by seed~@[: ~A~]."
                         (comparison-experiment comparison) (comparison-sides comparison))
                 stream)
  (let ((question (question-of (comparison-experiment comparison))))
    (when question (write-wrapped question stream)))
  (when (comparison-changes comparison) (terpri stream))
  (dolist (text (comparison-changes comparison)) (write-wrapped text stream))
  (terpri stream)
  (dolist (text (comparison-verdicts comparison)) (write-wrapped text stream))
  (format stream "~@[~%~{~A~%~}~]" (comparison-remarks comparison))
  (when (tested-differences (all-contrasts comparison))
    (terpri stream)
    (write-table comparison stream)
    (terpri stream)
    (write-wrapped (method-words comparison) stream))
  comparison)
