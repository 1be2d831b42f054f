;;;; comparing.lisp -- comparing conditions of an experiment, seed by seed.

(in-package :ars-magna.experiment)

;;; What is compared.

(defun names-in-all (results)
  "Return the names of what can be compared in all RESULTS, in order."
  (let ((measures (remove-if-not (lambda (name)
                                   (every (lambda (other)
                                            (member name (results-measures other)
                                                    :test #'string=))
                                          results))
                                 (results-measures (first results)))))
    (remove-duplicates (list* "success" "ticks" measures) :test #'string= :from-end t)))

(defun compared-names (operator results measure)
  "Return the names of what is to be compared in all RESULTS: what MEASURE, the argument of
OPERATOR, says, or all that they have."
  (let ((known (names-in-all results)))
    (flet ((known-name (name)
             (unless (typep name '(or symbol string))
               (reject-argument operator 'measure name "the name of a measure, or a list of them"))
             (or (find name known :test #'string-equal)
                 (reject-name "measure" (string name) known))))
      (if (null measure)
          known
          (mapcar #'known-name (ensure-list measure))))))

(defun samples-called (samples text)
  "Return those of SAMPLES whose condition is called TEXT; or else has that for a value; or else has
it in its name."
  (flet ((those (test) (remove-if-not test samples)))
    (or (those (lambda (sample) (string-equal text (sample-condition sample))))
        (those (lambda (sample) (member text (sample-texts sample) :test #'string-equal)))
        (those (lambda (sample) (search text (sample-condition sample) :test #'char-equal))))))

(defun sample-called (results designator)
  "Return the sample of RESULTS that DESIGNATOR means: a sample, the number of a condition, from 1,
or its name or a part of that as far as it is unambiguous. Signals UNKNOWN-NAME."
  (let* ((samples (results-samples results))
         (text (if (typep designator '(or symbol string)) (string designator) ""))
         (called (and (string/= "" text) (samples-called samples text))))
    (cond ((member designator samples) designator)
          ((and (integerp designator) (<= 1 designator (length samples)))
           (nth (1- designator) samples))
          ((= 1 (length called)) (first called))
          (t (reject-name "condition"
                          (if (symbolp designator) designator (princ-to-string designator))
                          (mapcar #'sample-condition samples))))))

;;; What two conditions have in common need not be said of each.

(defun level-name (factor text)
  "Return what the value TEXT of FACTOR is called: a word stands for itself."
  (if (or (number-in text) (member text '("TRUE" "FALSE" "") :test #'string=))
      (format nil "~A=~A" factor text)
      text))

(defun level-names (factors texts)
  (format nil "~{~A~^ ~}" (mapcar #'level-name factors texts)))

(defun contrast-of-conditions (results first second)
  "Return an empty contrast of the samples FIRST and SECOND of RESULTS: what they have in common is
where, and the rest their names."
  (loop for factor in (results-factors results)
        for a in (sample-texts first)
        for b in (sample-texts second)
        if (string= a b)
          collect (format nil "~A=~A" factor a) into where
        else
          collect factor into factors and collect a into firsts and collect b into seconds
        finally (return (make-contrast (and where (format nil "~{~A~^ ~}" where))
                                       (level-names factors firsts)
                                       (level-names factors seconds)))))

(defun contrast-conditions (results first second names)
  (contrast-samples (contrast-of-conditions results first second)
                    results first results second names))

(defun comparison-of-conditions (results pairs names stream)
  "Return the comparison of PAIRS, lists of two samples of RESULTS, and print it to STREAM, if any."
  (let ((comparison
          (make-comparison
           (format nil "The experiment ~A, seed by seed." (sample-experiment (first (first pairs))))
           :conditions
           (loop for (first second) in pairs
                 collect (contrast-conditions results first second names)))))
    (when (every (lambda (contrast) (zerop (contrast-trials contrast)))
                 (comparison-contrasts comparison))
      (reject-use "These conditions have no seeds in common. Run more trials of the experiment in ~
                   the same directory."))
    (finish-comparison comparison)
    (when stream (print-comparison comparison stream))
    comparison))

(defun check-stream (operator stream)
  (unless (or (null stream) (and (streamp stream) (output-stream-p stream)))
    (reject-argument operator 'stream stream "an output stream, or NIL")))

(addition compare-conditions)
(defun compare-conditions (results first second &key measure (stream *standard-output*))
  "Compare the conditions FIRST and SECOND of RESULTS, as RUN-EXPERIMENT and READ-RESULTS return
them, seed by seed: how often they succeed, the ticks of trials that succeed in both, and all that
is measured in numbers or as true or false; or, with MEASURE, a name or list of names, only that. A
condition is given by its number, from 1, or by its name or a part of that, such as one value of
what varies, as far as it is unambiguous; :ALL as SECOND compares FIRST with each of the others.

Only trials with seeds that both have are counted; a trial that broke off with an error, or came to
its limit, did not succeed. Return a comparison, and write it to STREAM, if there is one, as
PRINT-COMPARISON does. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE where there is nothing to be
compared."
  (check-argument compare-conditions results (results-p results) "results")
  (check-stream 'compare-conditions stream)
  (let* ((names (compared-names 'compare-conditions (list results) measure))
         (first (sample-called results first))
         (others (if (eq :all second)
                     (remove first (results-samples results))
                     (list (sample-called results second)))))
    (when (member first others)
      (reject-use "~A cannot be compared with itself; give two conditions."
                  (sample-condition first)))
    (unless others (reject-use "There is only one condition, ~A." (sample-condition first)))
    (comparison-of-conditions results (mapcar (lambda (other) (list first other)) others)
                              names stream)))

;;; By what varies.

(defun factor-place (results factor)
  "Return which of what varies in RESULTS is called FACTOR, from 0. Signals UNKNOWN-NAME."
  (or (and (typep factor '(or symbol string))
           (position (string factor) (results-factors results) :test #'string-equal))
      (reject-name "column of what varies" (princ-to-string factor) (results-factors results))))

(defun levels (results place)
  "Return the texts of the values that vary at PLACE in RESULTS, in order."
  (remove-duplicates (mapcar (lambda (sample) (nth place (sample-texts sample)))
                             (results-samples results))
                     :test #'string= :from-end t))

(defun level-called (levels value)
  (if (null value)
      (first levels)
      (or (find (value-text value) levels :test #'string-equal)
          (reject-name "value" (value-text value) levels))))

(defun sample-with (results texts)
  (find texts (results-samples results) :key #'sample-texts :test #'equal))

(defun level-pairs (results place base)
  "Return lists of two samples of RESULTS that differ at PLACE only, the second being of BASE."
  (loop for sample in (results-samples results)
        for texts = (copy-list (sample-texts sample))
        unless (string= base (nth place texts))
          append (let ((other (progn (setf (nth place texts) base)
                                     (sample-with results texts))))
                   (and other (list (list sample other))))))

(addition compare-levels)
(defun compare-levels (results factor &key against measure (stream *standard-output*))
  "Compare, all else equal, each value of FACTOR, the name of what varies in RESULTS, or CASE for
named conditions, with the value AGAINST, the first in the table unless given. MEASURE, STREAM, the
value and the errors are those of COMPARE-CONDITIONS; p is corrected for all tests together."
  (check-argument compare-levels results (results-p results) "results")
  (check-stream 'compare-levels stream)
  (let* ((names (compared-names 'compare-levels (list results) measure))
         (place (factor-place results factor))
         (base (level-called (levels results place) against))
         (pairs (level-pairs results place base)))
    (unless pairs
      (reject-use "There is nothing else than ~A=~A to be compared with it."
                  (nth place (results-factors results)) base))
    (comparison-of-conditions results pairs names stream)))
