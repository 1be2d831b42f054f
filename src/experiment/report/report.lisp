;;;; report.lisp -- PRINT-RESULTS: what came of an experiment, for people, at a glance.

(in-package :ars-magna.experiment)

;;; Numbers. Those of a column have equally many decimals, and stand below each other.

(defun decimals-for (numbers)
  "Return how many decimals NUMBERS are written with, so that the largest has four digits; NIL if
they are too large or small for that."
  (let ((largest (reduce #'max numbers :key #'abs :initial-value 0)))
    (cond ((every (lambda (number) (= number (round number))) numbers) (if (< largest 1e9) 0 nil))
          ((not (< 1/1000 largest 1e9)) nil)
          (t (max 0 (- 3 (power-of-ten (rational largest))))))))

(defun number-writer-for (numbers)
  (let ((decimals (decimals-for numbers)))
    (lambda (number)
      (if decimals (decimal-text number decimals) (figure-text number)))))

;;; Columns of estimates.

(defun estimate-numbers (estimate)
  (remove nil (list (estimate-value estimate) (estimate-low estimate) (estimate-high estimate))))

(defun writer-for (estimates)
  (if (eq :rate (estimate-kind (first estimates)))
      (let ((trials (reduce #'max estimates :key #'estimate-count)))
        (lambda (share) (hundredths-text share trials)))
      (number-writer-for (mapcan #'estimate-numbers estimates))))

(defun aligned-texts (numbers writer)
  "Return NUMBERS, any of which may be NIL, as texts of equal length."
  (let* ((texts (loop for number in numbers collect (if number (funcall writer number) "-")))
         (width (reduce #'max texts :key #'length)))
    (loop for text in texts collect (format nil "~V@A" width text))))

(defun interval-texts (estimates)
  (let ((writer (writer-for estimates)))
    (flet ((texts (reader) (aligned-texts (mapcar reader estimates) writer)))
      (loop for estimate in estimates
            for value in (texts #'estimate-value)
            for low in (texts #'estimate-low)
            for high in (texts #'estimate-high)
            collect (format nil "~A~:[~; (~A to ~A)~]" value (estimate-low estimate) low high)))))

(defun with-counts (texts estimates)
  "Return TEXTS of equal length, with of how many trials each of ESTIMATES is."
  (let ((width (reduce #'max texts :key #'length)))
    (loop for text in texts
          for estimate in estimates
          collect (format nil "~VA  n=~D" width text (estimate-count estimate)))))

(defun estimates-column (estimates trials name)
  (let ((heading (format nil "~A~@[~A~]" (cut name 60)
                         (kind-heading (estimate-kind (first estimates))))))
    (case (estimate-kind (first estimates))
      (:nothing (make-text-column heading (mapcar (constantly "-") estimates)))
      (:texts (make-text-column heading (loop for estimate in estimates
                                              collect (tally-text (estimate-texts estimate) 3))))
      (t (let ((texts (interval-texts estimates)))
           (make-text-column heading
                             (if (or (eq :median (estimate-kind (first estimates)))
                                     (equal trials (mapcar #'estimate-count estimates)))
                                 texts
                                 (with-counts texts estimates))
                             :whole-p t))))))

(defun estimates-columns (estimates trials &optional (name (estimate-name (first estimates))))
  "Return the column of ESTIMATES, called NAME, and those of the estimates beside them."
  (cons (estimates-column estimates trials name)
        (apply #'mapcan (lambda (&rest beside) (estimates-columns beside trials name))
               (mapcar #'estimate-beside estimates))))

(defun count-column (heading counts)
  "Return a column of COUNTS in a list, or an empty list if all are 0."
  (unless (every #'zerop counts)
    (list (make-text-column heading (mapcar #'integer-text counts) :anchor :end))))

;;; The table.

(defun key-columns (factors summaries)
  "Return columns that say of which condition a row is: the values of FACTORS if these fit, else its
name."
  (let ((columns (loop for name in factors
                       for place from 0
                       for texts = (loop for summary in summaries
                                         collect (nth place (summary-texts summary)))
                       collect (make-text-column name texts
                                                 :widest 40
                                                 :anchor (if (every #'number-in texts)
                                                             :end
                                                             :start)))))
    (if (and columns (<= (reduce #'+ columns :key (lambda (column)
                                                    (+ 2 (text-column-width column))))
                         44))
        columns
        (list (make-text-column "condition" (mapcar #'summary-condition summaries) :widest 40)))))

(defun value-columns (summaries)
  (flet ((all (reader) (mapcar reader summaries)))
    (let ((trials (all #'summary-trials)))
      (append (unless (= 1 (length (remove-duplicates trials))) (count-column "trials" trials))
              (estimates-columns (all #'summary-success) trials)
              (count-column "limit" (all #'summary-limits))
              (count-column "timeout" (all #'summary-timeouts))
              (count-column "errors" (all #'summary-errors))
              (estimates-columns (all #'summary-ticks) trials "ticks of successes")
              (apply #'mapcan (lambda (&rest estimates) (estimates-columns estimates trials))
                     (all #'summary-measures))))))

(defun trials-text (summaries)
  (let ((counts (mapcar #'summary-trials summaries)))
    (if (apply #'= counts)
        (format nil "~D trial~:P~:[~; each~]" (first counts) (rest counts))
        (format nil "~D to ~D trials each" (reduce #'min counts) (reduce #'max counts)))))

(defun write-heading (results summaries former stream)
  (let* ((name (sample-experiment (first (results-samples results))))
         (question (question-of name)))
    (write-wrapped (format nil "~A: ~D condition~:P, ~A~@[; and ~D that it no longer has~]" name
                           (length summaries) (trials-text summaries)
                           (and former (length former)))
                   stream)
    (when question (write-wrapped question stream))))

(defun former-summaries (results summaries)
  "Return those of SUMMARIES, of RESULTS, whose conditions the experiment no longer has, unless that
is none of them."
  (let ((former (remove-if (lambda (summary)
                             (member (summary-condition summary) (results-conditions results)
                                     :test #'string=))
                           summaries)))
    (and (set-difference summaries former) former)))

(defun write-summaries (results summaries stream)
  (terpri stream)
  (write-text-table (key-columns (results-factors results) summaries)
                    (value-columns summaries) stream))

(defun write-tables (results summaries stream)
  "Write the tables of SUMMARIES, of RESULTS: first of what the experiment has, and then the rest."
  (let* ((former (former-summaries results summaries))
         (present (remove-if (lambda (summary) (member summary former)) summaries)))
    (write-heading results present former stream)
    (write-summaries results present stream)
    (when former
      (format stream "~%Conditions that the experiment no longer has:~%")
      (write-summaries results former stream))))

(addition print-results)
(defun print-results (results &optional (stream *standard-output*))
  "Write to STREAM, in lines of 100 characters at most, what came of an experiment, of which RESULTS
are: for each condition how often it succeeded, how often it came to the limit of ticks or broke off
with an error if it did, how many ticks success took, and all that was measured, as
SUMMARIZE-RESULTS says; below that why trials failed and what errors there were, with an example
each, and which intervals these are. Rows of conditions that the experiment no longer has, as far as
that is known, make a table of their own. Return RESULTS."
  (check-argument print-results results (results-p results) "results")
  (check-argument print-results stream (and (streamp stream) (output-stream-p stream))
                  "an output stream")
  (let ((summaries (summarize-results results)))
    (cond (summaries
           (write-tables results summaries stream)
           (write-reasons results stream)
           (write-errors results stream)
           (write-notes results summaries stream))
          (t (format stream "There are no trials yet.~%"))))
  results)
