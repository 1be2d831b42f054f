;;;; verdicts.lisp -- comparisons as sentences and as tables.

(in-package :ars-magna.experiment)

;;; All numbers of a difference of means are rounded to the same decimal, whose number is negative
;;; left of the point: the second digit of the interval's width, or if that is 0 of the difference.

(defun decimals-of-second-digit (size)
  "Return how many decimals SIZE needs to show two significant digits."
  (- 1 (decimal-exponent (rational size))))

(defun useful-decimals (difference)
  "Return the number of decimals for the numbers of DIFFERENCE, a difference of means."
  (let* ((low (paired-low difference)) (high (paired-high difference))
         (width (if low (subtract-numbers high low) 0))
         (reach (find-if-not #'zerop (list (paired-estimate difference)
                                           (paired-first difference)))))
    (cond ((plusp width)
           (min (decimals-of-second-digit width)
                (max 6 (+ 5 (decimals-of-second-digit (max (abs low) (abs high)))))))
          (reach (max (decimals-of-second-digit reach)
                      (min 3 (+ 13 (decimals-of-second-digit reach)))))
          (t 3))))

(defun scientific-text (number decimals)
  (let* ((power (decimal-exponent number))
         (text (decimal-text (/ number (expt 10 power)) (max 0 (+ decimals power)))))
    (format nil "~Ae~D" (strip-trailing-zeros text) power)))

(defun mean-text (value decimals)
  "Return VALUE as text, rounded to DECIMALS decimals, with a power of 10 if VALUE is far from 1."
  (let* ((unit (expt 10 (- decimals)))
         (number (* unit (round (rational value) unit))))
    (cond ((and (zerop number) (< 9 decimals)) "0")
          ;; A small number beside very large ones is not written as 0.
          ((and (zerop number) (minusp decimals) (not (zerop value)))
           (rounded-number-text value :digits 2))
          ((or (zerop number) (<= -6 (decimal-exponent number) 14))
           (decimal-text number (max 0 decimals)))
          (t (scientific-text number decimals)))))

(defun number-formatter (difference)
  "Return a function that takes a number of DIFFERENCE and returns its text, without a unit."
  (cond ((eq :rate (paired-kind difference))
         (lambda (value) (percent-text value (paired-trials difference))))
        ((plusp (or (paired-rounding difference) 0)) #'exact-number-text)
        (t (let ((decimals (if (paired-first difference) (useful-decimals difference) 0)))
             (lambda (value) (mean-text value decimals))))))

;;;; Verdicts

;;; Parts of sentences.

(defun probability-text (p)
  "Return the text of the probability P without a leading 0: .032, .15."
  (string-left-trim "0" (format nil "~,VF" (if (< p .0995d0) 3 2) p)))

(defun p-text (p)
  "Return what follows the letter p in a sentence on the probability P, such as = .032 or < .001."
  (cond ((null p) "-")
        ((< p .001d0) "< .001")
        ((> p .995d0) "= 1")
        (t (format nil "= ~A" (probability-text p)))))

(defun p-number-text (p)
  (string-left-trim "= " (p-text p)))

(defun value-with-unit-text (difference value)
  "Return the text of VALUE, a number of DIFFERENCE. The unit of rates is points."
  (let ((text (funcall (number-formatter difference) value)))
    (format nil "~A~:[~; point~:[s~;~]~]" text (eq :rate (paired-kind difference))
            (member text '("1" "-1") :test #'string=))))

(defun difference-interval-text (difference)
  (let ((write (number-formatter difference)))
    (format nil "difference ~A (95 % interval ~A to ~A)"
            (value-with-unit-text difference (paired-estimate difference))
            (funcall write (paired-low difference)) (funcall write (paired-high difference)))))

(defun p-values-text (difference)
  "Return a text with both p values of DIFFERENCE: corrected for the number of tests, and alone."
  (let ((p (paired-p difference)) (adjusted (paired-adjusted-p difference))
        (tests (paired-tests difference)))
    (format nil "p ~A~:[~; as one of ~D tests~@[ (~A alone)~]~]" (p-text adjusted)
            (< 1 tests) tests
            (and (string/= (p-text p) (p-text adjusted)) (p-number-text p)))))

(defun both-values-text (difference)
  (let ((write (number-formatter difference)))
    (if (eq :rate (paired-kind difference))
        (format nil "~A % against ~A %" (funcall write (paired-first difference))
                (funcall write (paired-second difference)))
        (format nil "~A against ~A on average" (funcall write (paired-first difference))
                (funcall write (paired-second difference))))))

(defun left-out-pairs-text (difference)
  (let ((count (paired-left-out difference)))
    (when (plusp count)
      (format nil "~D left out, where a ~:[number~;value~] is missing" count
              (eq :rate (paired-kind difference))))))

(defun common-seeds-text (difference)
  (format nil "~:[over~;where both succeed,~] ~D common seed~:P~@[ (~A)~]"
          (string= "ticks" (paired-measure difference)) (paired-trials difference)
          (left-out-pairs-text difference)))

(defun difference-figures-text (difference)
  (format nil "~A, ~A ~A, ~A" (p-values-text difference) (both-values-text difference)
          (common-seeds-text difference) (difference-interval-text difference)))

;;; Verdicts.

(defun direction-text (difference first second)
  (let ((more (plusp (paired-estimate difference))) (measure (paired-measure difference)))
    (cond ((string= measure "success")
           (format nil "~A succeeds ~:[less~;more~] often than ~A" first more second))
          ((string= measure "ticks")
           (format nil "~A takes ~:[fewer~;more~] ticks than ~A" first more second))
          ((eq :rate (paired-kind difference))
           (format nil "~A is true ~:[less~;more~] often with ~A than with ~A"
                   measure more first second))
          (t (format nil "~A is ~:[lower~;higher~] with ~A than with ~A"
                     measure more first second)))))

(defun seeds-needed (tests)
  "Return the least number of seeds for which p, corrected for TESTS tests, can be at most .05."
  (loop for seeds from 1
        when (<= (* tests (smallest-possible-p seeds)) 1/20) return seeds))

(defun too-few-seeds-text (difference)
  "If DIFFERENCE has too few seeds for a significant p, return a text that asks for more; else NIL."
  (let ((seeds (paired-trials difference)) (tests (paired-tests difference)))
    (when (< seeds (seeds-needed tests))
      (format nil "; with ~D seed~:P p cannot be below ~A~[~;~:;, too much for ~:*~D tests~]: run ~
                   ~D or more seeds~@[, or compare fewer measures~]"
              seeds (probability-text (smallest-possible-p seeds)) tests (seeds-needed tests)
              (< 1 tests)))))

(defun why-not-significant-text (difference)
  "Return a text on why DIFFERENCE is not significant although its interval leaves out 0."
  (let ((tests (paired-tests difference)))
    (if (< 1 tests)
        (format nil "the interval is for this difference alone: if ~D differences are tested, an ~
                     interval that leaves out 0 proves nothing" tests)
        "the interval leaves out 0, but it is an approximation, and p is above .05: p decides")))

(defun no-difference-text (difference)
  "Return a text on how large DIFFERENCE can be, or why it is not significant despite its interval."
  (let ((low (paired-low difference)) (high (paired-high difference)))
    (if (<= low 0 high)
        (format nil "if there is one, it is at most ~A. This bound is right about 95 times in 100"
                (value-with-unit-text difference (max (abs low) (abs high))))
        (format nil "~A~@[~A~]" (why-not-significant-text difference)
                (too-few-seeds-text difference)))))

(defun verdict (difference contrast)
  (let ((first (contrast-first contrast)) (second (contrast-second contrast)))
    (format nil "~@[~A: ~]~A." (contrast-where contrast)
            (cond ((or (null (paired-p difference)) (null (paired-low difference)))
                   (format nil "~A of ~A and ~A cannot be compared: ~A, but at least 2 are needed"
                           (paired-measure difference) first second (common-seeds-text difference)))
                  ((plusp (or (paired-rounding difference) 0))
                   (format nil "~A of ~A and ~A differ only by rounding, by at most ~A for any ~
                                seed: ~A ~A"
                           (paired-measure difference) first second
                           (rounded-number-text (paired-rounding difference) :digits 2)
                           (both-values-text difference) (common-seeds-text difference)))
                  ((and (eql 0 (paired-rounding difference))
                        (= 0 (paired-low difference) (paired-high difference)))
                   (format nil "~A of ~A and ~A are equal, seed by seed: ~A ~A"
                           (paired-measure difference) first second (both-values-text difference)
                           (common-seeds-text difference)))
                  ((significant-p difference)
                   (format nil "~A: ~A" (direction-text difference first second)
                           (difference-figures-text difference)))
                  (t (format nil "No significant difference in ~A between ~A and ~A: ~A; ~A"
                             (paired-measure difference) first second
                             (difference-figures-text difference)
                             (no-difference-text difference)))))))

(defun success-change (contrast)
  "Return :BETTER or :WORSE if the first side of CONTRAST succeeds significantly more or less often,
:SAME if both sides are the same runs, else NIL."
  (let ((difference (find-difference "success" contrast)))
    (cond ((same-runs-p contrast) :same)
          ((null difference) nil)
          ((significant-p difference)
           (if (plusp (paired-estimate difference)) :better :worse)))))

(defun contrast-verdicts (contrast)
  (if (same-runs-p contrast)
      (list (format nil "~@[~A: ~]~A and ~A are the same in all ~D trials, to the last bit."
                    (contrast-where contrast) (contrast-first contrast) (contrast-second contrast)
                    (contrast-trials contrast)))
      (loop for difference in (contrast-differences contrast)
            collect (verdict difference contrast))))

(defun versions-verdict (comparison)
  (let* ((contrasts (comparison-contrasts comparison))
         (found (mapcar #'success-change contrasts))
         (trials (reduce #'+ contrasts :key #'contrast-trials))
         (same (reduce #'+ contrasts :key #'contrast-same)))
    (if (= same trials)
        (format nil "All ~D trials that both have are the same to the last bit." trials)
        (format nil "Of ~D condition~:P ~[none succeeds~;1 succeeds~:;~:*~D succeed~] more often ~
                     than before, ~[none~:;~:*~D~] less often~[~:;, ~:*~D ~:*~[~;is~:;are~] the ~
                     same~]~[~:;, and ~:*~D not significantly different~]. Of ~D trials that ~
                     both have, ~D are the same to the last bit."
                (length found) (count :better found) (count :worse found)
                (count :same found) (count nil found) trials same))))

(addition comparison-verdicts)
(defun comparison-verdicts (comparison)
  "Return the result of COMPARISON as a list of sentences. For two versions, the first sentence says
how many conditions got better or worse, and how many trials are identical. The next sentences say
which side succeeds more often, takes more ticks and so on: first over all conditions, if there are
several, then for each pair. They give p, both rates or means, and the difference with its 95 %
interval. A difference is reported if p, corrected for all tests (Holm), is at most .05. Otherwise
the sentence says how large the difference can be, with the interval's confidence. If the interval
leaves out 0, the sentence says why p decides, and how many seeds are needed for so many tests.
Tests over all conditions are corrected separately. Each interval is for one difference alone."
  (check-argument comparison-verdicts comparison (comparison-p comparison) "a comparison")
  (let ((all (loop for contrast in (append (comparison-overall comparison)
                                           (comparison-contrasts comparison))
                   append (contrast-verdicts contrast))))
    (cond ((not (eq :versions (comparison-kind comparison))) all)
          ((every #'same-runs-p (comparison-contrasts comparison))
           (list (versions-verdict comparison)))
          (t (cons (versions-verdict comparison) all)))))

;;; What was left out.

(defun side-counts-text (contrast first second)
  "FIRST and SECOND count trials of CONTRAST's sides. Return them as text, or NIL if both are 0."
  (let ((words (loop for count in (list first second)
                     for name in (list (contrast-first contrast) (contrast-second contrast))
                     when (plusp count) collect (format nil "~D of ~A" count name))))
    (and words (format nil "~@[~A: ~]~{~A~^ and ~}" (contrast-where contrast) words))))

(defun left-out-notes (contrast)
  (let ((alone (side-counts-text contrast (contrast-unpaired-first contrast)
                                 (contrast-unpaired-second contrast)))
        (errors (side-counts-text contrast (contrast-errors-first contrast)
                                  (contrast-errors-second contrast))))
    (append (and alone (list (format nil "Left out, as one side lacks these seeds: ~A." alone)))
            (and errors (not (same-runs-p contrast))
                 (list (format nil "Ended with an error, and counted as not succeeded: ~A."
                               errors))))))

(defun comparison-remarks (comparison)
  (append (and (comparison-overall comparison)
               (list "Over all, each seed counts once, with its mean over the conditions."
                     "Tests over all conditions are corrected separately from other tests."))
          (comparison-notes comparison)
          ;; One side can be the same in all contrasts.
          (remove-duplicates (loop for contrast in (comparison-contrasts comparison)
                                   append (left-out-notes contrast))
                             :test #'string= :from-end t)))

;;;; PRINT-COMPARISON

(defparameter *comparison-headings*
  '("measure" "seeds" "first" "second" "difference" "p" "p alone"))

(defun difference-row (difference)
  (let ((write (number-formatter difference)) (rate-p (eq :rate (paired-kind difference))))
    (flet ((text (value) (if value (funcall write value) "-")))
      (list (paired-measure difference) (integer-text (paired-trials difference))
            (format nil "~A~:[~; %~]" (text (paired-first difference)) rate-p)
            (format nil "~A~:[~; %~]" (text (paired-second difference)) rate-p)
            (format nil "~A (~A to ~A)" (text (paired-estimate difference))
                    (text (paired-low difference)) (text (paired-high difference)))
            (p-number-text (paired-adjusted-p difference)) (p-number-text (paired-p difference))))))

(defun contrast-heading (contrast)
  (let ((table (let ((success (find-difference "success" contrast)))
                 (and success (paired-table success)))))
    (format nil "~@[~A: ~]~A (first) against ~A~:[~; (the same)~]~@[: ~{both ~D, only the first ~
                 ~D, only the second ~D, neither ~D~}~]"
            (contrast-where contrast) (contrast-first contrast) (contrast-second contrast)
            (same-runs-p contrast) table)))

(defun write-comparison-table (comparison stream)
  (let* ((groups (loop for contrast in (all-contrasts comparison)
                       collect (mapcar #'difference-row (contrast-differences contrast))))
         (columns (apply #'mapcar (lambda (heading &rest texts)
                                    (make-text-column heading texts
                                                      :whole-p t
                                                      :anchor (if (string= "measure" heading)
                                                                  :start
                                                                  :end)))
                         *comparison-headings* (apply #'append groups))))
    (write-cells (mapcar #'list *comparison-headings*) columns stream)
    (loop for contrast in (all-contrasts comparison)
          for rows in groups
          do (format stream "~A~%" (contrast-heading contrast))
             (dolist (row rows) (write-cells (mapcar #'list row) columns stream)))))

(defun methods-text (comparison)
  (format nil "Differences are first minus second, seed by seed, each with its own 95 % interval. ~
               Rates: Newcombe's interval and McNemar's exact test. Means: Student's interval and ~
               a permutation test of equal distributions, which may differ although the means are ~
               equal. p is corrected by Holm's method for ~D test~:P~@[, over all for ~D~]; p ~
               alone is not corrected."
          (length (tested-differences (comparison-contrasts comparison)))
          (and (comparison-overall comparison)
               (length (tested-differences (comparison-overall comparison))))))

(addition print-comparison)
(defun print-comparison (comparison &optional (stream *standard-output*))
  "Write COMPARISON to STREAM and return COMPARISON. The text contains:
  what is compared, and the question of the experiment, if it is known;
  for versions, what has changed between the two;
  the verdicts (see COMPARISON-VERDICTS), a line each;
  what was left out, if anything;
  a table. A line for each pair of conditions says for how many seeds both sides, one side, and
    neither side succeeded. Below the line is a row for each measure: the number of seeds,
    both rates or means, the difference (of rates in points) with its 95 % interval, and p before
    and after Holm's correction for all tests."
  (check-argument print-comparison comparison (comparison-p comparison) "a comparison")
  (write-wrapped (format nil "The experiment ~A, seed by seed~@[: ~A~]."
                         (comparison-experiment comparison) (comparison-sides comparison))
                 stream)
  (let ((question (question-of (comparison-experiment comparison))))
    (when question (write-wrapped question stream)))
  (when (comparison-changes comparison) (terpri stream))
  (dolist (text (comparison-changes comparison)) (write-wrapped text stream))
  (terpri stream)
  (dolist (text (comparison-verdicts comparison)) (write-wrapped text stream))
  (format stream "~@[~%~{~A~%~}~]" (comparison-remarks comparison))
  (when (tested-differences (all-contrasts comparison))
    (terpri stream)
    (write-comparison-table comparison stream)
    (terpri stream)
    (write-wrapped (methods-text comparison) stream))
  comparison)
