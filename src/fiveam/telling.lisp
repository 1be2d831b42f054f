;;;; telling.lisp -- why a check failed: numbers, examples, and how to see one.

(in-package :ars-magna.fiveam)

(defparameter *examples* 5 "How many trials that did not succeed are listed.")

(defun subject-text (check)
  (if (check-subject check)
      (text-of (subject-form (check-subject check)) check)
      (format nil "~(~A~), ~A" (experiment-name (check-experiment check))
              (condition-name (check-condition check)))))

(defun per-cent (share)
  (let ((text (format nil "~,2F" (* 100 share))))
    (format nil "~A %" (string-right-trim "." (string-right-trim "0" text)))))

(defun outcome-text (result check)
  (if (string= "limit" (result-outcome result))
      (format nil "not done in ~D ticks" (experiment-limit (check-experiment check)))
      (format nil "~A~:[: ~A~;~*~]~:[: ~A~;~*~]" (result-outcome result)
              (string= "" (result-reason result)) (result-reason result)
              (string= "" (result-error result)) (result-error result))))

(defun example-lines (bad check)
  "Return lines for the first of BAD, results of trials of CHECK that did not succeed."
  (append (loop for result in bad
                repeat *examples*
                collect (format nil "  trial ~D, seed ~D: ~A" (result-trial result)
                                (result-seed result) (outcome-text result check)))
          (when (> (length bad) *examples*)
            (list (format nil "  and ~D more" (- (length bad) *examples*))))))

(defun numbers-text (check)
  (let ((trials (length (check-results check))) (successes (check-successes check)))
    (format nil "~D of ~D trial~:P succeeded, ~A" successes trials
            (per-cent (/ successes trials)))))

(defun meaning-text (check)
  (if (= 1 (check-at-least check))
      "All should."
      (format nil "If ~A or more succeeded in the long run, this would be said with a probability ~
                   of at most ~A."
              (per-cent (check-at-least check)) (per-cent (check-level check)))))

(defun failure-text (check)
  (let ((bad (remove-if #'success-p (reverse (check-results check)))))
    (format nil "~A~%succeeds less often than ~A: ~A.~%~A~%Of those that did not:~%~{~A~%~}To see ~
                 one, in the package ~A:~%  ~A"
            (subject-text check) (per-cent (check-at-least check)) (numbers-text check)
            (meaning-text check) (example-lines bad check)
            (package-name (experiment-package (check-experiment check)))
            (repetition-text check (first bad)))))
