;;;; comparing.lisp -- comparing conditions, or two versions of the code, seed by seed.

(in-package :ars-magna.experiment)

;;; Measures.

(defun common-measures (results)
  (let ((measures (remove-if-not (lambda (name)
                                   (every (lambda (other)
                                            (member name (results-measures other)
                                                    :test #'string=))
                                          results))
                                 (results-measures (first results)))))
    (remove-duplicates (list* "success" "ticks" measures) :test #'string= :from-end t)))

(defun measures-to-compare (operator results measure)
  "RESULTS is a list of results. Return the names of the measures to compare: those in MEASURE, or
all that RESULTS have in common if MEASURE is NIL. Errors name OPERATOR."
  (let ((known (common-measures results)))
    (flet ((known-name (name)
             (unless (typep name '(or symbol string))
               (reject-argument operator 'measure name "the name of a measure, or a list of them"))
             (or (find name known :test #'string-equal)
                 (reject-name "measure" (string name) known))))
      (if (null measure)
          known
          (mapcar #'known-name (ensure-list measure))))))

;;; PAIRS are lists of two samples of one table that differ only in the factor PLACE, if not NIL.

(defun contrast-of-conditions (results first second place)
  "Return a contrast of the samples FIRST and SECOND of RESULTS; its differences are not set yet.
Factors with equal values make the contrast's WHERE; the other factors name its two sides."
  (loop for other in (if place (cons place (other-factors results place)) (naming-factors results))
        for factor = (nth other (results-factors results))
        for a = (sample-level-text other first)
        for b = (sample-level-text other second)
        if (string= a b)
          collect (full-level-name factor a) into where
        else
          collect factor into factors and collect a into firsts and collect b into seconds
        finally (return (make-contrast (and where (format nil "~{~A~^ ~}" where))
                                       (level-names factors firsts)
                                       (level-names factors seconds)))))

(defun pairs-by-levels (results pairs place)
  "Group PAIRS by their two levels of the factor PLACE. Return lists (level base pair...)."
  (loop with factor = (nth place (results-factors results))
        for group in (group-by pairs (lambda (pair)
                                      (mapcar (lambda (sample) (sample-level-text place sample))
                                              pair)))
        collect (append (mapcar (lambda (sample)
                                  (level-name factor (sample-level-text place sample)))
                                (first group))
                        group)))

(defun overall-contrasts (results pairs place names)
  "Return overall contrasts: one for any two levels that several PAIRS with common seeds have."
  (loop for (level base . group) in (pairs-by-levels
                                     results
                                     (remove-if-not (lambda (pair) (apply #'common-trials pair))
                                                    pairs)
                                     place)
        when (rest group)
          collect (overall-contrast level base group names results)))

(defun sides-text (contrasts kind)
  "Return a text that names both sides, if all CONTRASTS have the same first or the same second
side; else NIL. KIND is the noun for the side that differs."
  (flet ((names (reader) (remove-duplicates (mapcar reader contrasts) :test #'string= :from-end t)))
    (let ((firsts (names #'contrast-first)) (seconds (names #'contrast-second)))
      (cond ((and (null (rest firsts)) (null (rest seconds)))
             (format nil "~A against ~A" (first firsts) (first seconds)))
            ((null (rest seconds)) (format nil "each ~A against ~A" kind (first seconds)))
            ((null (rest firsts)) (format nil "~A against each other ~A" (first firsts) kind))))))

(defun finish-comparison (comparison stream control &rest arguments)
  "Correct the p values of COMPARISON, print COMPARISON to STREAM unless STREAM is NIL, and return
COMPARISON. Signals MISUSE with the text of CONTROL and ARGUMENTS if no contrast has trials."
  (when (every (lambda (contrast) (zerop (contrast-trials contrast)))
               (comparison-contrasts comparison))
    (reject-use "~?" control arguments))
  ;; The comparison over all and those of single conditions are separate questions. So comparing
  ;; twelve conditions as well does not weaken the result over all.
  (dolist (contrasts (list (comparison-contrasts comparison) (comparison-overall comparison)))
    (adjust-p-values (loop for contrast in contrasts append (contrast-differences contrast))))
  (when stream (print-comparison comparison stream))
  comparison)

(defun comparison-of-conditions (results pairs place names stream)
  "Compare PAIRS of samples of RESULTS in the measures NAMES. Return the comparison. Also print it
to STREAM unless STREAM is NIL."
  (let ((contrasts (loop for (first second) in pairs
                         for contrast = (contrast-of-conditions results first second place)
                         collect (compare-samples contrast results first results second names))))
    (finish-comparison
     (make-comparison
      (sample-experiment (first (first pairs)))
      (sides-text contrasts (if place (nth place (results-factors results)) "condition"))
      :conditions contrasts
      :overall (and place (overall-contrast-needed-p contrasts)
                    (overall-contrasts results pairs place names)))
     stream "These conditions have no common seeds. Run more trials in the same directory.")))

(defun check-stream (operator stream)
  (unless (or (null stream) (and (streamp stream) (output-stream-p stream)))
    (reject-argument operator 'stream stream "an output stream, or NIL")))

(addition compare-conditions)
(defun compare-conditions (results first second &key measure (stream *standard-output*))
  "Compare the conditions FIRST and SECOND of RESULTS (see RUN-EXPERIMENT, READ-RESULTS) seed by
seed. Return a comparison. Unless STREAM is NIL, print the comparison as PRINT-COMPARISON does.

The comparison covers success, the ticks of trials that succeed under both conditions, and all
measures that are numbers or booleans. If you give MEASURE, a name or list of names, only those are
compared. Only seeds that both conditions have count. A trial that ended in an error or at its limit
did not succeed.

Give a condition by its number, from 1, by its name, or by an unambiguous part of its name, such as
one value of a factor. :ALL as SECOND compares FIRST with each other condition. FIRST and SECOND may
be values of one factor. If several conditions have these values, each condition with the value
FIRST is compared with the condition that differs from it only in having SECOND. All pairs are also
compared together, as in COMPARE-LEVELS. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if a word
is ambiguous or nothing can be compared."
  (check-argument compare-conditions results (results-p results)
                  "results, as RUN-EXPERIMENT and READ-RESULTS return them")
  (check-stream 'compare-conditions stream)
  (let ((names (measures-to-compare 'compare-conditions (list results) measure)))
    (multiple-value-bind (pairs place) (designated-pairs results first second)
      (comparison-of-conditions results pairs place names stream))))

(addition compare-levels)
(defun compare-levels (results factor &key against measure (stream *standard-output*))
  "Compare each value of FACTOR with the value AGAINST, with all other factors equal. FACTOR is the
name of a factor of RESULTS, or CASE for named conditions. AGAINST is by default the first value in
the table. If several pairs of conditions have the same two values, compare these values also over
all pairs; each seed then counts once, by its mean over the conditions. MEASURE, STREAM, the
returned value and the errors are as for COMPARE-CONDITIONS. p is corrected for all tests of single
pairs together, and separately for all tests over several pairs."
  (check-argument compare-levels results (results-p results)
                  "results, as RUN-EXPERIMENT and READ-RESULTS return them")
  (check-stream 'compare-levels stream)
  (let* ((names (measures-to-compare 'compare-levels (list results) measure))
         (place (factor-place results factor))
         (base (find-level (levels results place) against))
         (pairs (pairs-differing-in-factor results place nil base)))
    (unless pairs
      (reject-use "No condition differs only in ~A from a condition with ~:*~A=~A. (In ~
                   designs, such as :sobol, all factors vary together.)"
                  (nth place (results-factors results)) base))
    (comparison-of-conditions results pairs place names stream)))

;;;; What has changed between two versions

;;; The files experiment.txt of two tables list the parts of their conditions' fingerprints. If the
;;; experiment itself has changed, success may mean something else in each table. PAIRS are lists of
;;; a sample of the newer table and one of the older.

(defun changed-parts-of-pair (pair after before)
  "Return the names of the fingerprint parts that differ between the samples in PAIR, as listed by
experiment.txt in the directories AFTER and BEFORE. Return :UNKNOWN if one lacks the parts."
  (let ((now (recorded-parts (sample-condition (first pair)) after))
        (then (recorded-parts (sample-condition (second pair)) before)))
    (if (and now then) (changed-parts then now) :unknown)))

(defun part-of-kind-p (kind part) (starts-with-subseq (format nil "~A " kind) part))

(defun lines-only-in (lines others title)
  (let ((only (remove-if (lambda (line) (member line others :test #'string=)) lines)))
    (append (loop for line in only
                  repeat 5
                  collect (format nil "~A: ~A" title (no-break-text (cut line 88))))
            (and (nthcdr 5 only) (list (format nil "~A: ..." title))))))

(defun experiment-change-lines (after before)
  (let ((now (recorded-form after)) (then (recorded-form before)))
    (cons (format nil "WARNING: the experiment itself is not the same in both tables. Differences ~
                       below may be due to what it does, measures or counts as success.")
          (append (lines-only-in then now "before") (lines-only-in now then "now")))))

(defun changed-parts-text (parts conditions)
  (let ((others (remove-if (lambda (part) (part-of-kind-p "condition" part)) parts)))
    (format nil "What differs between the tables, under ~D condition~:P: ~{~A~^, ~}."
            conditions
            (append others
                    (and (/= (length others) (length parts))
                         (list "the parameters, robots or values of conditions"))))))

(defun unexplained-difference-lines (pairs)
  "Return a list with a warning if trials of PAIRS have equal fingerprints but different rows."
  (let ((count (loop for (sample other) in pairs
                     sum (loop for (i . j) in (common-trials sample other)
                               count (not (same-row-p sample i other j))))))
    (unless (zerop count)
      (list (format nil "WARNING: nevertheless the rows of ~D trial~:P differ. Rows were edited, ~
                         or the trials depend on something that fingerprints do not cover, such as ~
                         shared data, a clock or a file. Do not rely on either table." count)))))

(defun code-change-lines (pairs after before)
  "Return sentences that say which code and data of PAIRS differ between two tables, as listed by
experiment.txt in the directories AFTER and BEFORE. Either directory may be NIL."
  (let* ((changed (remove-if (lambda (pair)
                               (apply #'string= (mapcar #'sample-fingerprint pair)))
                             pairs))
         (changes (loop for pair in changed
                        collect (if (and after before)
                                    (changed-parts-of-pair pair after before)
                                    :unknown)))
         (parts (remove-duplicates (apply #'append (remove :unknown changes))
                                   :test #'string= :from-end t)))
    (cond ((null changed)
           (cons "Both tables are of the same code and configuration: the fingerprints are equal."
                 (unexplained-difference-lines pairs)))
          ((null parts)
           (list (format nil "What differs between the tables is not known: the fingerprints ~
                              differ, but there is no experiment.txt with their parts.")))
          (t (append (and (some (lambda (part) (part-of-kind-p "experiment" part)) parts)
                          (experiment-change-lines after before))
                     (list (changed-parts-text parts (length changed))))))))

;;;; Comparing versions

(defun results-and-name (operator name value)
  "Return the results that VALUE designates, and their name. VALUE is OPERATOR's argument NAME."
  (cond ((results-p value)
         (values value (if (results-directory value)
                           (native-name (results-directory value))
                           (string-downcase name))))
        ((typep value '(or string pathname))
         (values (read-results value) (if (stringp value) value (native-name value))))
        (t (reject-argument operator name value "the name of a directory, or results"))))

(defun distinguishing-names (first second)
  "Return the last components of the paths FIRST and SECOND if these differ, else the whole paths."
  (flet ((last-part (name)
           (let ((name (string-right-trim "/" name)))
             (subseq name (1+ (or (position #\/ name :from-end t) -1))))))
    (if (string= (last-part first) (last-part second))
        (values first second)
        (values (last-part first) (last-part second)))))

(defun condition-pairs (first second)
  "Return two values: pairs of samples with equal conditions, from the results FIRST and SECOND; and
the names of conditions that only FIRST or only SECOND has."
  (flet ((counterpart (sample results)
           (find (sample-condition sample) (results-samples results)
                 :key #'sample-condition :test #'string=)))
    (values (loop for sample in (results-samples first)
                  for other = (counterpart sample second)
                  when other collect (list sample other))
            (mapcar #'sample-condition
                    (append (remove-if (lambda (sample) (counterpart sample second))
                                       (results-samples first))
                            (remove-if (lambda (sample) (counterpart sample first))
                                       (results-samples second)))))))

(defun check-same-experiment (before after)
  (let ((names (mapcar (lambda (results)
                         (if (results-samples results)
                             (sample-experiment (first (results-samples results)))
                             (reject-use "One of the tables has no rows. Run the experiment.")))
                       (list before after))))
    (unless (apply #'string= names)
      (reject-use "The tables are of two experiments, ~A and ~A. Give two tables of one."
                  (first names) (second names)))
    (first names)))

(defun comparison-of-versions (before after before-name after-name names stream)
  (multiple-value-bind (first second) (distinguishing-names after-name before-name)
    (multiple-value-bind (pairs lacking) (condition-pairs after before)
      (let* ((experiment (check-same-experiment before after))
             (contrasts (loop for (sample other) in pairs
                              for contrast = (make-contrast (sample-condition sample) first second)
                              collect (compare-samples contrast after sample before other
                                                       names))))
        (finish-comparison
         (make-comparison
          experiment (format nil "~A against ~A, before" after-name before-name)
          :versions contrasts
          :overall (and (overall-contrast-needed-p contrasts)
                        (list (overall-contrast first second pairs names after before)))
          :changes (code-change-lines pairs (results-directory after) (results-directory before))
          :notes (and lacking
                      (list (format nil "Only one of the tables has the condition~P ~{~A~^, ~}."
                                    (length lacking) lacking))))
         stream "~A and ~A have no trials of equal condition and seed." before-name after-name)))))

(addition compare-results)
(defun compare-results (before after &key measure (stream *standard-output*))
  "Compare two tables of one experiment, made by two versions of the code. BEFORE and AFTER are
directories or results. Trials with equal condition and seed are compared, for each condition and
over all conditions. Over all, each seed counts once. Differences are AFTER minus BEFORE.

The comparison tells which conditions got better or worse, and how many trials are identical, that
is, have rows with equal digest, outcome and measures. It also tells what has changed, according to
experiment.txt beside the tables, and warns if the experiment itself has changed. MEASURE, STREAM,
the returned value and the errors are as for COMPARE-CONDITIONS. Also signals the errors of
READ-RESULTS, and MISUSE if the tables are of different experiments."
  (check-stream 'compare-results stream)
  (multiple-value-bind (old old-name) (results-and-name 'compare-results 'before before)
    (multiple-value-bind (new new-name) (results-and-name 'compare-results 'after after)
      (comparison-of-versions old new old-name new-name
                              (measures-to-compare 'compare-results (list new old) measure)
                              stream))))
