;;;; report.lisp -- what is said of results at a shell.

(in-package :ars-magna.cli)

(defun report-results (results plot)
  "Print RESULTS. If they are kept, keep that text beside them, and with PLOT their pictures."
  (print-results results *standard-output*)
  (when (results-directory results)
    (write-file-anew (lambda (out) (call-on-page (lambda () (print-results results out))))
                     (merge-pathnames "summary.txt" (results-directory results))
                     "the summary" :remedy "remove it, or give another directory"))
  (when plot (save-result-pictures results (results-directory results))))
