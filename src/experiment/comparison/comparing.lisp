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

;;; The whole. PAIRS are lists of two samples of one table; if PLACE is not NIL, the two differ in
;;; the factor there, all else equal.

(defun contrast-of-conditions (results first second place)
  "Return an empty contrast of the samples FIRST and SECOND of RESULTS: what they have in common is
where, and the rest their names."
  (loop for other in (if place (cons place (factors-else results place)) (naming-factors results))
        for factor = (nth other (results-factors results))
        for a = (text-at other first)
        for b = (text-at other second)
        if (string= a b)
          collect (full-level-name factor a) into where
        else
          collect factor into factors and collect a into firsts and collect b into seconds
        finally (return (make-contrast (and where (format nil "~{~A~^ ~}" where))
                                       (level-names factors firsts)
                                       (level-names factors seconds)))))

(defun pairs-by-levels (results pairs place)
  "Return lists (level base pair...) of PAIRS that compare the same two levels at PLACE."
  (loop with factor = (nth place (results-factors results))
        for group in (grouped pairs (lambda (pair)
                                      (mapcar (lambda (sample) (text-at place sample)) pair)))
        collect (append (mapcar (lambda (sample) (level-name factor (text-at place sample)))
                                (first group))
                        group)))

(defun overall-contrasts (results pairs place names)
  "Return a contrast for each two levels that several PAIRS, with seeds in common, compare."
  (loop for (level base . group) in (pairs-by-levels
                                     results
                                     (remove-if-not (lambda (pair) (apply #'common-trials pair))
                                                    pairs)
                                     place)
        when (rest group)
          collect (overall-contrast level base group names results)))

(defun sides-words (contrasts kind)
  "Return what CONTRASTS compare with what, in words, as far as that is the same in all; else NIL.
KIND says what those are that are several."
  (flet ((names (reader) (remove-duplicates (mapcar reader contrasts) :test #'string= :from-end t)))
    (let ((firsts (names #'contrast-first)) (seconds (names #'contrast-second)))
      (cond ((and (null (rest firsts)) (null (rest seconds)))
             (format nil "~A against ~A" (first firsts) (first seconds)))
            ((null (rest seconds)) (format nil "each ~A against ~A" kind (first seconds)))
            ((null (rest firsts)) (format nil "~A against each other ~A" (first firsts) kind))))))

(defun end-comparison (comparison stream control &rest arguments)
  "Let COMPARISON know what its tests are worth, print it to STREAM, if any, and return it. Signals
MISUSE, as CONTROL and ARGUMENTS say, if nothing in it could be compared."
  (when (every (lambda (contrast) (zerop (contrast-trials contrast)))
               (comparison-contrasts comparison))
    (reject-use "~?" control arguments))
  ;; What is so over all is one question, and where it is so another: who asks in twelve conditions
  ;; as well need not be less sure of the whole.
  (dolist (contrasts (list (comparison-contrasts comparison) (comparison-overall comparison)))
    (adjust-for-all (loop for contrast in contrasts append (contrast-differences contrast))))
  (when stream (print-comparison comparison stream))
  comparison)

(defun comparison-of-conditions (results pairs place names stream)
  "Return the comparison of PAIRS, of RESULTS, in what NAMES say, and print it to STREAM, if any."
  (let ((contrasts (loop for (first second) in pairs
                         for contrast = (contrast-of-conditions results first second place)
                         collect (contrast-samples contrast results first results second names))))
    (end-comparison
     (make-comparison
      (sample-experiment (first (first pairs)))
      (sides-words contrasts (if place (nth place (results-factors results)) "condition"))
      :conditions contrasts
      :overall (and place (worth-overall-p contrasts)
                    (overall-contrasts results pairs place names)))
     stream "These conditions have no seeds in common. Run more trials of the experiment in the ~
             same directory.")))

(defun check-stream (operator stream)
  (unless (or (null stream) (and (streamp stream) (output-stream-p stream)))
    (reject-argument operator 'stream stream "an output stream, or NIL")))

(addition compare-conditions)
(defun compare-conditions (results first second &key measure (stream *standard-output*))
  "Compare the conditions FIRST and SECOND of RESULTS, as RUN-EXPERIMENT and READ-RESULTS return
them, seed by seed: how often they succeed, the ticks of trials that succeed in both, and all that
is measured in numbers or as true or false; or, with MEASURE, a name or list of names, only that. A
condition is given by its number, from 1, or by its name or a part of that, such as one value of
what varies, as far as it is unambiguous; :ALL as SECOND compares FIRST with each of the others. If
FIRST and SECOND are values of one thing that varies, and several conditions have them, then each of
these is compared with the one that differs in nothing else, and all together, as COMPARE-LEVELS
does.

Only trials with seeds that both have are counted; a trial that broke off with an error, or came to
its limit, did not succeed. Return a comparison, and write it to STREAM, if there is one, as
PRINT-COMPARISON does. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if a word is ambiguous, and
where there is nothing to be compared."
  (check-argument compare-conditions results (results-p results) "results")
  (check-stream 'compare-conditions stream)
  (let ((names (compared-names 'compare-conditions (list results) measure)))
    (multiple-value-bind (pairs place) (pairs-meant results first second)
      (comparison-of-conditions results pairs place names stream))))

(addition compare-levels)
(defun compare-levels (results factor &key against measure (stream *standard-output*))
  "Compare, all else equal, each value of FACTOR, the name of what varies in RESULTS, or CASE for
named conditions, with the value AGAINST, the first in the table unless given; and, where that makes
several comparisons of the same two values, these over all, each seed counting once, with its mean
over the conditions. MEASURE, STREAM, the value and the errors are those of COMPARE-CONDITIONS; p is
corrected for all tests together, those over all apart."
  (check-argument compare-levels results (results-p results) "results")
  (check-stream 'compare-levels stream)
  (let* ((names (compared-names 'compare-levels (list results) measure))
         (place (factor-place results factor))
         (base (level-called (levels results place) against))
         (pairs (level-pairs results place nil base)))
    (unless pairs
      (reject-use "No condition differs from one with ~A=~A in that alone. (Designs, such as ~
                   :sobol, let all that they sample vary together.)"
                  (nth place (results-factors results)) base))
    (comparison-of-conditions results pairs place names stream)))
