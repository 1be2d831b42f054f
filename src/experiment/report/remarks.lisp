;;;; remarks.lisp -- what stands below a table: why trials failed, errors, which intervals.

(in-package :ars-magna.experiment)

;;; Why.

(defstruct (occurrence (:constructor make-occurrence (text sample trial)) (:copier nil))
  "What happened in COUNT trials, first in TRIAL of SAMPLE. WHERE is an alist from the names of
conditions to how often there."
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
  "Return what happened in trials of RESULTS, commonest first. TEXT-OF is called with a sample and
the index of a trial, and returns a text, or NIL if nothing did."
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

(defun replay-text (occurrence)
  (format nil "(replay-trial '~A ~A ~D)" (sample-experiment (occurrence-sample occurrence))
          (unbroken (prin1-to-string (sample-condition (occurrence-sample occurrence))))
          (occurrence-trial occurrence)))

(defconstant +most-told+ 5 "How many reasons and errors are told.")

(defun where-text (occurrence)
  "Return under which conditions OCCURRENCE was, most often first."
  (tally-text (stable-sort (reverse (occurrence-where occurrence)) #'> :key #'cdr) 3))

(defun write-occurrences (title occurrences several-p stream)
  "Write OCCURRENCES below TITLE, under which conditions each was if there are SEVERAL-P, and how to
see one of each."
  (when occurrences
    (let ((width (length (integer-text (occurrence-count (first occurrences))))))
      (format stream "~%~A~%" title)
      (dolist (one (subseq occurrences 0 (min +most-told+ (length occurrences))))
        (write-wrapped (format nil "~A~@[: ~A~]" (occurrence-text one)
                               (and several-p (where-text one)))
                       stream :first (format nil "  ~V@A  " width (occurrence-count one)))
        (write-wrapped (replay-text one) stream
                       :first (format nil "  ~VA  " width "")))
      (when (nthcdr +most-told+ occurrences)
        (format stream "  and ~D of other kinds~%"
                (reduce #'+ (nthcdr +most-told+ occurrences) :key #'occurrence-count))))))

(defun write-reasons (results stream)
  (write-occurrences
   "Why trials failed, and how to see one:"
   (occurrences results
                (lambda (sample index)
                  (let ((outcome (aref (sample-outcomes sample) index))
                        (reason (aref (sample-reasons sample) index)))
                    (cond ((string= "limit" outcome) "limit of ticks")
                          ((string= "timeout" outcome) "limit of time")
                          ((not (failed-p outcome)) nil)
                          ((string= "" reason) "no reason given")
                          ((string= "only-believed" reason)
                           "only-believed (a success by the values of :run, but not by :success)")
                          (t reason)))))
   (rest (results-samples results)) stream))

(defun write-errors (results stream)
  (flet ((errors (broken-off-p)
           (occurrences results
                        (lambda (sample index)
                          (let ((text (aref (sample-errors sample) index))
                                (outcome (aref (sample-outcomes sample) index)))
                            (and (string/= "" text)
                                 (eq broken-off-p (string= "error" outcome))
                                 text))))))
    (write-occurrences "Errors by which trials broke off, and how to see one:" (errors t)
                       (rest (results-samples results)) stream)
    (write-occurrences "Errors that trials outlived, and how to see one:" (errors nil)
                       (rest (results-samples results)) stream)))

;;; Which intervals.

(defun left-out-text (estimates)
  "Return what is left out of ESTIMATES, of one measure, in words, or NIL."
  (let ((count (reduce #'+ estimates :key #'estimate-left-out)))
    (and (plusp count)
         (format nil "~A: ~D value~:P that ~:*~[~;is no number is~:;are no numbers are~] left out."
                 (estimate-name (first estimates)) count))))

(defun kinds-text (summaries)
  (flet ((kind-p (kind)
           (some (lambda (summary)
                   (find kind (summary-measures summary) :key #'estimate-kind))
                 summaries)))
    (format nil "In parentheses ~:[95 % intervals~;intervals~]: Wilson's of rates, by ranks of ~
                 medians~:[~;, Student's of means~]."
            (some (lambda (summary) (/= .95d0 (summary-confidence summary))) summaries)
            (kind-p :mean))))

(defun looks-text (width summaries)
  "Return which confidence the intervals of SUMMARIES have, which were to be WIDTH wide."
  (let ((counts (sort (remove-duplicates (mapcar #'summary-trials summaries)) #'<)))
    (format nil "Trials were added until the interval of success was at most ~A wide, looked at ~
                 after 50, 100, 200 and so on. Look K spends .05 / (K (K + 1)) of the error that ~
                 is allowed, so that the intervals of one condition, at all its looks together, ~
                 err in at most 5 % of such runs~:[~*~;, each of these ~D conditions by itself: ~
                 that one of them all errs is more likely~]. ~@(~{~A~^, ~}~)."
            (value-text width) (rest summaries) (length summaries)
            (loop for count in counts
                  for look = (look-after count)
                  collect (format nil "after ~D trials intervals have a confidence of ~A %" count
                                  (if look
                                      (decimal-text (* 100 (confidence-at-look look)) 2)
                                      "95"))))))

(defun write-notes (results summaries stream)
  (terpri stream)
  (write-wrapped (kinds-text summaries) stream)
  (when (plusp (reduce #'+ summaries :key #'summary-errors))
    (write-wrapped "A trial that broke off with an error counts as one that did not succeed."
                   stream))
  (when (results-until results)
    (write-wrapped (looks-text (results-until results) summaries) stream))
  (dolist (text (apply #'mapcar (lambda (&rest estimates) (left-out-text estimates))
                       (mapcar #'summary-measures summaries)))
    (when text (write-wrapped text stream))))
