;;;; report.lisp -- PRINT-RESULTS: the results of an experiment as text.

(in-package :ars-magna.experiment)

;;; Reasons and errors.

(defstruct (occurrence (:constructor make-occurrence (text sample trial)) (:copier nil))
  "A reason or error that COUNT trials have; TRIAL of SAMPLE is the first of them. WHERE is an alist
from the names of conditions to counts."
  (text "" :type string :read-only t)
  (sample nil :type sample :read-only t)
  (trial 0 :type integer :read-only t)
  (count 0 :type integer)
  (where '() :type list))

(defun note-occurrence (text sample trial occurrences)
  (let* ((one (or (gethash text occurrences)
                  (setf (gethash text occurrences) (make-occurrence text sample trial))))
         (name (sample-condition sample)))
    (incf (occurrence-count one))
    (if (equal name (car (first (occurrence-where one))))
        (incf (cdr (first (occurrence-where one))))
        (push (cons name 1) (occurrence-where one)))))

(defun occurrences (results text-of)
  "Return a list of occurrences in trials of RESULTS, commonest first. The function TEXT-OF returns
the text for a sample and the index of a trial, or NIL."
  (let ((occurrences (make-hash-table :test 'equal)))
    (dolist (sample (results-samples results))
      (loop for trial across (sample-trials sample)
            for index from 0
            for text = (funcall text-of sample index)
            when text do (note-occurrence text sample trial occurrences)))
    (sort (hash-table-values occurrences)
          (lambda (a b)
            (or (> (occurrence-count a) (occurrence-count b))
                (and (= (occurrence-count a) (occurrence-count b))
                     (string< (occurrence-text a) (occurrence-text b))))))))

(defconstant +most-occurrences+ 5 "The most reasons or errors that are listed.")

(defun conditions-text (occurrence)
  (tally-text (stable-sort (reverse (occurrence-where occurrence)) #'> :key #'cdr) 3))

(defun write-occurrences (title results text-of stream)
  "Write the OCCURRENCES in RESULTS below TITLE, each with its conditions, if there are several, and
a form that replays an example."
  (let ((all (occurrences results text-of)) (several-p (rest (results-samples results))))
    (when all
      (format stream "~%~A~%" title)
      (loop with width = (length (integer-text (occurrence-count (first all))))
            for one in all
            for sample = (occurrence-sample one)
            repeat +most-occurrences+
            do (write-wrapped (format nil "~A~@[: ~A~]" (occurrence-text one)
                                      (and several-p (conditions-text one)))
                              stream :first (format nil "  ~V@A  " width (occurrence-count one)))
               (write-wrapped (format nil "(replay-trial '~A ~A ~D)" (sample-experiment sample)
                                      (no-break-text (prin1-to-string (sample-condition sample)))
                                      (occurrence-trial one))
                              stream :first (format nil "  ~VA  " width "")))
      (when (nthcdr +most-occurrences+ all)
        (format stream "  and ~D of other kinds~%"
                (reduce #'+ (nthcdr +most-occurrences+ all) :key #'occurrence-count))))))

(defun write-reasons (results stream)
  (write-occurrences
   "Why trials failed, and how to see one:" results
   (lambda (sample index)
     (let ((outcome (aref (sample-outcomes sample) index))
           (reason (aref (sample-reasons sample) index)))
       (cond ((string= "limit" outcome) "limit of ticks")
             ((string= "timeout" outcome) "limit of time")
             ((not (failed-p outcome)) nil)
             ((string= "" reason) "no reason given")
             ((string= "only-believed" reason)
              "only-believed (a success by the values of :run, but not by :success)")
             (t reason))))
   stream))

(defun write-errors (results stream)
  (loop for (broken-off-p title)
          in '((t "Errors that ended trials, and how to see one:")
               (nil "Errors that did not end their trials, and how to see one:"))
        do (write-occurrences title results
                              (lambda (sample index)
                                (let ((text (aref (sample-errors sample) index))
                                      (outcome (aref (sample-outcomes sample) index)))
                                  (and (string/= "" text)
                                       (eq broken-off-p (string= "error" outcome))
                                       text)))
                              stream)))

;;; Notes on intervals.

(defun left-out-text (estimates)
  "ESTIMATES are of one measure. Return a sentence on the values that they leave out; NIL if none."
  (let ((count (reduce #'+ estimates :key #'estimate-left-out)))
    (and (plusp count)
         (format nil "~A: left out ~D value~:P that ~:*~[~;is not a number~:;are not numbers~]."
                 (estimate-name (first estimates)) count))))

(defun interval-kinds-text (summaries)
  (flet ((kind-p (kind)
           (some (lambda (summary)
                   (find kind (summary-measures summary) :key #'estimate-kind))
                 summaries)))
    (format nil "In parentheses: ~:[95 % intervals~;intervals~], Wilson's for rates, by ranks ~
                 for medians~:[~;, Student's for means~]."
            (some (lambda (summary) (/= .95d0 (summary-confidence summary))) summaries)
            (kind-p :mean))))

(defun interim-looks-text (width summaries)
  "Return sentences on the confidence of SUMMARIES if trials ran until intervals were WIDTH wide."
  (let ((counts (sort (remove-duplicates (mapcar #'summary-trials summaries)) #'<)))
    (format nil "Trials were added until the interval of success was at most ~A wide. Intervals ~
                 were computed after 50, 100, 200 ... trials. The K-th look at a condition has a ~
                 wrong interval with a probability of at most .05 / (K (K + 1)), and any look in ~
                 at most 5 % of such runs~:[~*~;. This holds for each of these ~D conditions by ~
                 itself; one wrong interval among all conditions is more likely~]. ~
                 ~@(~{~A~^, ~}~)."
            (value-text width) (rest summaries) (length summaries)
            (loop for count in counts
                  for look = (interim-look-number count)
                  collect (format nil "after ~D trials intervals have a confidence of ~A %" count
                                  (if look
                                      (decimal-text (* 100 (confidence-at-look look)) 2)
                                      "95"))))))

(defun write-interval-notes (results summaries stream)
  (terpri stream)
  (write-wrapped (interval-kinds-text summaries) stream)
  (when (plusp (reduce #'+ summaries :key #'summary-errors))
    (write-wrapped "A trial that ended with an error counts as one that did not succeed." stream))
  (when (results-until results)
    (write-wrapped (interim-looks-text (results-until results) summaries) stream))
  (dolist (text (apply #'mapcar (lambda (&rest estimates) (left-out-text estimates))
                       (mapcar #'summary-measures summaries)))
    (when text (write-wrapped text stream))))

;;;; The report

;;; Numbers. Those of a column have the same number of decimals, and are aligned.

(defun decimals-for (numbers)
  "Return the number of decimals for NUMBERS, so that the largest has four digits; NIL if NUMBERS
are too large or too small for four digits."
  (let ((largest (reduce #'max numbers :key #'abs :initial-value 0)))
    (cond ((every (lambda (number) (= number (round number))) numbers) (if (< largest 1e9) 0 nil))
          ((not (< 1/1000 largest 1e9)) nil)
          (t (max 0 (- 3 (decimal-exponent (rational largest))))))))

(defun number-formatter-for (numbers)
  (let ((decimals (decimals-for numbers)))
    (lambda (number)
      (if decimals (decimal-text number decimals) (rounded-number-text number)))))

;;; Columns of estimates.

(defun estimate-formatter (estimates)
  (if (eq :rate (estimate-kind (first estimates)))
      (let ((trials (reduce #'max estimates :key #'estimate-count)))
        (lambda (share) (percent-text share trials)))
      (number-formatter-for
       (loop for reader in (list #'estimate-value #'estimate-low #'estimate-high)
             append (remove nil (mapcar reader estimates))))))

(defun aligned-texts (numbers writer)
  "Return NUMBERS, any of which may be NIL, as texts of equal length."
  (let* ((texts (loop for number in numbers collect (if number (funcall writer number) "-")))
         (width (reduce #'max texts :key #'length)))
    (loop for text in texts collect (format nil "~V@A" width text))))

(defun interval-texts (estimates)
  (let ((writer (estimate-formatter estimates)))
    (flet ((texts (reader) (aligned-texts (mapcar reader estimates) writer)))
      (loop for estimate in estimates
            for value in (texts #'estimate-value)
            for low in (texts #'estimate-low)
            for high in (texts #'estimate-high)
            collect (format nil "~A~:[~; (~A to ~A)~]" value (estimate-low estimate) low high)))))

(defun texts-with-counts (texts estimates)
  (let ((width (reduce #'max texts :key #'length)))
    (loop for text in texts
          for estimate in estimates
          collect (format nil "~VA  n=~D" width text (estimate-count estimate)))))

(defun estimates-column (estimates trials name)
  (let ((heading (format nil "~A~@[~A~]" (cut name 60)
                         (statistic-option (estimate-kind (first estimates)) :heading))))
    (case (estimate-kind (first estimates))
      (:nothing (make-text-column heading (mapcar (constantly "-") estimates)))
      (:texts (make-text-column heading (loop for estimate in estimates
                                              collect (tally-text (estimate-texts estimate) 3))))
      (t (let ((texts (interval-texts estimates)))
           (make-text-column heading
                             (if (or (eq :median (estimate-kind (first estimates)))
                                     (equal trials (mapcar #'estimate-count estimates)))
                                 texts
                                 (texts-with-counts texts estimates))
                             :whole-p t))))))

(defun estimates-columns (estimates trials &optional (name (estimate-name (first estimates))))
  "Return the column of ESTIMATES, named NAME, and the columns of the estimates beside ESTIMATES."
  (cons (estimates-column estimates trials name)
        ;; The first column has the counts.
        (apply #'mapcan (lambda (&rest beside)
                          (estimates-columns beside (mapcar #'estimate-count beside) name))
               (mapcar #'estimate-beside estimates))))

(defun count-column (heading counts)
  "Return a column of COUNTS in a list, or an empty list if all are 0."
  (unless (every #'zerop counts)
    (list (make-text-column heading (mapcar #'integer-text counts) :anchor :end))))

;;; The table.

(defun key-columns (factors summaries)
  "Return columns that identify the condition of a row: the values of FACTORS if these fit on the
page, else the condition's name."
  (let ((columns (loop for name in factors
                       for place from 0
                       for texts = (loop for summary in summaries
                                         collect (nth place (summary-texts summary)))
                       collect (make-text-column name texts
                                                 :widest 40
                                                 :anchor (if (every #'number-from-text texts)
                                                             :end
                                                             :start)))))
    (if (and columns (<= (reduce #'+ columns :key (lambda (column)
                                                    (+ 2 (text-column-width column))))
                         44))
        columns
        (list (make-text-column "condition" (mapcar #'summary-condition summaries) :widest 40)))))

(defun outcome-columns (summaries trials testbed-p)
  "Return the columns of success and ticks. Success of a game of a testbed means that it has ended:
if all have, there are no columns."
  (flet ((all (reader) (mapcar reader summaries)))
    (let ((ended-p (and testbed-p
                        (every (lambda (estimate) (= 1 (estimate-value estimate)))
                               (all #'summary-success)))))
      (append (unless ended-p
                (if testbed-p
                    (estimates-columns (all #'summary-success) trials "games ended")
                    (estimates-columns (all #'summary-success) trials)))
              (count-column "limit" (all #'summary-limits))
              (count-column "timeout" (all #'summary-timeouts))
              (count-column "errors" (all #'summary-errors))
              (unless ended-p
                (estimates-columns (all #'summary-ticks) trials
                                   (if testbed-p "ticks of ended games" "ticks of successes")))))))

(defun value-columns (summaries testbed-p)
  (flet ((all (reader) (mapcar reader summaries)))
    (let ((trials (all #'summary-trials)))
      (append (unless (= 1 (length (remove-duplicates trials))) (count-column "trials" trials))
              (outcome-columns summaries trials testbed-p)
              (apply #'mapcan (lambda (&rest estimates) (estimates-columns estimates trials))
                     (all #'summary-measures))))))

(defun trials-text (summaries)
  (let ((counts (mapcar #'summary-trials summaries)))
    (if (apply #'= counts)
        (format nil "~D trial~:P~:[~; each~]" (first counts) (rest counts))
        (format nil "~D to ~D trials each" (reduce #'min counts) (reduce #'max counts)))))

(defun testbed-results-p (results)
  "True if RESULTS are those of a testbed that is defined here."
  (and (find-testbed (sample-experiment (first (results-samples results))) nil) t))

(defun write-heading (results summaries former stream)
  (let* ((name (sample-experiment (first (results-samples results))))
         (question (question-of name)))
    (write-wrapped (format nil "~A: ~D condition~:P, ~A~@[; the table also has ~D ~
                                  condition~:P of earlier runs, see below~]" name
                           (length summaries) (trials-text summaries)
                           (and former (length former)))
                   stream)
    (when question (write-wrapped question stream))))

(defun dropped-condition-summaries (results summaries)
  "Return those SUMMARIES of RESULTS whose conditions the experiment no longer has; NIL if the
experiment has none of the conditions of SUMMARIES."
  (let ((former (remove-if (lambda (summary)
                             (member (summary-condition summary) (results-conditions results)
                                     :test #'string=))
                           summaries)))
    (and (set-difference summaries former) former)))

(defun write-summaries (results summaries stream)
  (terpri stream)
  (write-text-table (key-columns (results-factors results) summaries)
                    (value-columns summaries (testbed-results-p results)) stream))

(defun write-tables (results summaries stream)
  (let* ((former (dropped-condition-summaries results summaries))
         (present (remove-if (lambda (summary) (member summary former)) summaries)))
    (write-heading results present former stream)
    (write-summaries results present stream)
    (when former
      (format stream "~%Conditions of earlier runs, which the last run did not have:~%")
      (write-summaries results former stream))))

(addition print-results)
(defun print-results (results &optional (stream *standard-output*))
  "Write RESULTS to STREAM, in lines of at most 100 characters, and return RESULTS. For each
condition, a table shows how often trials succeeded, reached the limit of ticks or had an error, the
ticks of successes, and all measures; see SUMMARIZE-RESULTS. Below the table are the reasons of
failures and the errors, with an example of each, and the kinds of intervals. Of a testbed, success
is not shown, unless some games have not ended. Conditions that were removed from the experiment are
in a separate table, if it is known which."
  (check-argument print-results results (results-p results)
                  "results, as RUN-EXPERIMENT and READ-RESULTS return them")
  (check-argument print-results stream (and (streamp stream) (output-stream-p stream))
                  "an output stream")
  (let ((summaries (summarize-results results)))
    (cond (summaries
           (write-tables results summaries stream)
           (write-reasons results stream)
           (write-errors results stream)
           (write-interval-notes results summaries stream))
          (t (format stream "There are no trials yet.~%"))))
  results)
