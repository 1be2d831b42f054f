;;;; report.lisp -- what is said of results at a shell.

(in-package :ars-magna.cli)

(defun write-report (results stream)
  "Write to STREAM how often the trials of each condition of RESULTS succeeded."
  (dolist (sample (results-samples results))
    (let ((trials (length (sample-trials sample)))
          (errors (count "" (sample-errors sample) :test-not #'string=)))
      (format stream "~40A ~D of ~D~@[, ~D errors~]~%" (sample-condition sample)
              (count "success" (sample-outcomes sample) :test #'string=) trials
              (and (plusp errors) errors)))))

(defun report-results (results plot)
  "Print RESULTS. If they are kept, keep that text beside them, and with PLOT their pictures."
  (write-report results *standard-output*)
  (when (results-directory results)
    (call-replacing-file (lambda (out) (write-report results out))
                         (merge-pathnames "summary.txt" (results-directory results))))
  (when plot (reject-line "There are no pictures of results yet.")))
