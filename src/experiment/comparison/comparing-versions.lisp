;;;; comparing-versions.lisp -- one experiment run by two versions of the code, row by row.

(in-package :ars-magna.experiment)

(defun results-given (operator name value)
  "Return the results that VALUE, the argument NAME of OPERATOR, means, and what they are called."
  (cond ((results-p value)
         (values value (if (results-directory value)
                           (native-name (results-directory value))
                           (string-downcase name))))
        ((typep value '(or string pathname))
         (values (read-results value) (if (stringp value) value (native-name value))))
        (t (reject-argument operator name value "the name of a directory, or results"))))

(defun short-names (first second)
  "Return the last parts of the names FIRST and SECOND if these tell them apart, else the names."
  (flet ((last-part (name)
           (let ((name (string-right-trim "/" name)))
             (subseq name (1+ (or (position #\/ name :from-end t) -1))))))
    (if (string= (last-part first) (last-part second))
        (values first second)
        (values (last-part first) (last-part second)))))

(defun condition-pairs (first second)
  "Return lists of samples of the results FIRST and SECOND that are of one condition; and the names
of conditions that one of them lacks."
  (flet ((called (sample results)
           (find (sample-condition sample) (results-samples results)
                 :key #'sample-condition :test #'string=)))
    (values (loop for sample in (results-samples first)
                  for other = (called sample second)
                  when other collect (list sample other))
            (mapcar #'sample-condition
                    (append (remove-if (lambda (sample) (called sample second))
                                       (results-samples first))
                            (remove-if (lambda (sample) (called sample first))
                                       (results-samples second)))))))

(defun check-one-experiment (before after)
  (let ((names (mapcar (lambda (results)
                         (if (results-samples results)
                             (sample-experiment (first (results-samples results)))
                             (reject-use "There are no rows in a table to be compared.")))
                       (list before after))))
    (unless (apply #'string= names)
      (reject-use "One table is of the experiment ~A and the other of ~A. Give two of one ~
                   experiment."
                  (first names) (second names)))
    (first names)))

(defun comparison-of-versions (before after before-name after-name names stream)
  "Return the comparison of the results BEFORE and AFTER, which are called so, in what NAMES say,
and print it to STREAM, if any."
  (multiple-value-bind (first second) (short-names after-name before-name)
    (multiple-value-bind (pairs lacking) (condition-pairs after before)
      (let* ((experiment (check-one-experiment before after))
             (contrasts (loop for (sample other) in pairs
                              for contrast = (make-contrast (sample-condition sample) first second)
                              collect (contrast-samples contrast after sample before other
                                                        names))))
        (end-comparison
         (make-comparison
          experiment (format nil "~A against ~A, before" after-name before-name)
          :versions contrasts
          :overall (and (worth-overall-p contrasts)
                        (list (overall-contrast first second pairs names after before)))
          :changes (changes-between pairs (results-directory after) (results-directory before))
          :notes (and lacking
                      (list (format nil "Only one of them has the condition~P ~{~A~^, ~}."
                                    (length lacking) lacking))))
         stream "~A and ~A have no trials of equal condition and seed." before-name after-name)))))

(addition compare-results)
(defun compare-results (before after &key measure (stream *standard-output*))
  "Compare two tables of one experiment that two versions of the code have made: BEFORE and AFTER
are directories, or results. Trials of equal condition and seed are compared, per condition and over
all conditions, where each seed counts once. Differences are AFTER less BEFORE. It is said which
conditions got better or worse, and how many trials are the same to the last bit: rows with equal
digest, outcome and measures; and, by the texts beside the tables, what has changed in between, with
a warning if that is the experiment itself. The other arguments, the value and the errors are those
of COMPARE-CONDITIONS; DAMAGED-TABLE and MISUSE, too, as READ-RESULTS, and if the tables are of
different experiments."
  (check-stream 'compare-results stream)
  (multiple-value-bind (old old-name) (results-given 'compare-results 'before before)
    (multiple-value-bind (new new-name) (results-given 'compare-results 'after after)
      (comparison-of-versions old new old-name new-name
                              (compared-names 'compare-results (list new old) measure)
                              stream))))
