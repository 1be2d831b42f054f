;;;; designators.lisp -- designators of conditions, and which conditions are compared.

(in-package :ars-magna.experiment)

;;; A value of a factor is a level. Factors are given by their places in SAMPLE-TEXTS. Named
;;; conditions are the levels of the first factor, CASE, which determines those of their factors.

(defun sample-level-text (place sample) (nth place (sample-texts sample)))

(defun levels (results place)
  "Return the texts of the levels that the factor with index PLACE has in RESULTS, in table order."
  (remove-duplicates (mapcar (lambda (sample) (sample-level-text place sample))
                             (results-samples results))
                     :test #'string= :from-end t))

(defun case-determines-factor-p (place samples)
  "True if the named case, the first factor of SAMPLES, determines the factor with index PLACE."
  (loop for sample in samples
        always (loop for other in samples
                     always (or (string/= (sample-level-text 0 sample) (sample-level-text 0 other))
                                (string= (sample-level-text place sample)
                                         (sample-level-text place other))))))

(defun naming-factors (results)
  "Factors of RESULTS that no case determines make the names of conditions. Return their indices."
  (loop with case-p = (equal "case" (first (results-factors results)))
        for place from 0 below (length (results-factors results))
        unless (and case-p (plusp place) (case-determines-factor-p place (results-samples results)))
          collect place))

(defun varying-factors (results)
  (remove-if-not (lambda (place) (rest (levels results place))) (naming-factors results)))

(defun factor-place (results factor)
  "Return the index of the factor of RESULTS that is named FACTOR. Signals UNKNOWN-NAME."
  (or (and (typep factor '(or symbol string))
           (position (string factor) (results-factors results) :test #'string-equal))
      (reject-name "factor" (princ-to-string factor) (results-factors results))))

(defun find-level (levels value)
  "Return the one of LEVELS that VALUE names; NIL names the first. Signals UNKNOWN-NAME."
  (if (null value)
      (first levels)
      (let ((text (if (stringp value) value (setting-text value))))
        (or (find text levels :test #'string-equal)
            (reject-name "value" text levels)))))

;;; Names of levels.

(defun full-level-name (factor text) (format nil "~A=~A" factor text))

(defun level-name (factor text)
  "Return the name of the level TEXT of FACTOR: TEXT itself if it is a word, else FACTOR=TEXT."
  (if (or (number-from-text text) (member text '("TRUE" "FALSE" "") :test #'string=))
      (full-level-name factor text)
      text))

(defun level-names (factors texts)
  (format nil "~{~A~^ ~}" (mapcar #'level-name factors texts)))

;;; Pairs.

(defun other-factors (results place)
  "Return the indices of factors in which conditions that are compared by PLACE must be equal."
  (let ((naming (naming-factors results)))
    (remove place (if (member place naming)
                      naming
                      (loop for other from 1 below (length (results-factors results))
                            collect other)))))

(defun pairs-differing-in-factor (results place level base)
  "Return pairs of samples of RESULTS that differ only in the factor with index PLACE. The second
sample of a pair has the level BASE; the first has LEVEL, or any other level if LEVEL is NIL."
  (let ((else (other-factors results place)))
    (flet ((counterpart (sample)
             (find-if (lambda (other)
                        (and (string= base (sample-level-text place other))
                             (loop for place in else
                                   always (string= (sample-level-text place sample)
                                                   (sample-level-text place other)))))
                      (results-samples results))))
      (loop for sample in (results-samples results)
            for text = (sample-level-text place sample)
            for other = (and (string/= base text)
                             (or (null level) (string= level text))
                             (counterpart sample))
            when other collect (list sample other)))))

;;;; Designators

;;; A designator is the name of a condition, or a level, as its value or as FACTOR=VALUE, or a part
;;; of these. A level that only one condition has designates that condition.

(defun designator-text (designator)
  (if (typep designator '(or symbol string)) (string designator) (value-text designator)))

(defun exact-or-partial-matches (things exactly partly)
  (or (remove-if-not exactly things) (remove-if-not partly things)))

(defun level-title (results level)
  (full-level-name (nth (first level) (results-factors results)) (second level)))

(defun numbered-sample (results designator)
  "If DESIGNATOR is a sample of RESULTS, return DESIGNATOR. If DESIGNATOR is an integer, return the
sample with that number, from 1. Else return NIL."
  (let ((samples (results-samples results)))
    (cond ((integerp designator)
           (and (<= 1 designator (length samples)) (nth (1- designator) samples)))
          (t (find designator samples)))))

(defun level-word-p (word factor level)
  (or (string-equal word level) (string-equal word (full-level-name factor level))))

(defun designated-levels (results designator)
  "Return lists (place level) that DESIGNATOR can mean; NIL if it is a number or sample of RESULTS."
  (unless (numbered-sample results designator)
    (let ((word (designator-text designator)))
      (exact-or-partial-matches
       (loop for place in (varying-factors results)
             append (loop for level in (levels results place) collect (list place level)))
       (lambda (level)
         (level-word-p word (nth (first level) (results-factors results)) (second level)))
       (lambda (level) (search word (level-title results level) :test #'char-equal))))))

(defun samples-named (results word)
  "Return the samples of RESULTS whose condition is named WORD. If there are none, return the
samples that have the level WORD, or else the samples whose name contains WORD."
  (let ((samples (results-samples results)))
    (or (remove word samples :key #'sample-condition :test-not #'string-equal)
        (exact-or-partial-matches samples
                                  (lambda (sample)
                                    (some (lambda (factor text) (level-word-p word factor text))
                                          (results-factors results) (sample-texts sample)))
                                  (lambda (sample)
                                    (search word (sample-condition sample) :test #'char-equal))))))

(defun designated-samples (results designator)
  "Return the samples of RESULTS that DESIGNATOR can mean. DESIGNATOR is a sample, or the number
(from 1), the name or a part of the name of a condition. Signals UNKNOWN-NAME if no sample fits."
  (let ((samples (results-samples results)) (one (numbered-sample results designator))
        (word (designator-text designator)))
    (cond (one (list one))
          ((and (string/= "" word) (samples-named results word)))
          (t (reject-name "condition" (if (symbolp designator) designator word)
                          (mapcar #'sample-condition samples))))))

(defun reject-ambiguous (word meanings)
  (reject-use "~A is ambiguous: it could be ~{~A~#[~; or ~:;, ~]~}. Give a value as FACTOR=VALUE, ~
               or the number or the whole name of a condition."
              word
              (if (nthcdr 6 meanings)
                  (append (subseq meanings 0 6)
                          (list (format nil "one of ~D others" (- (length meanings) 6))))
                  meanings)))

(defun designated-sample (results designator)
  "Return the sample that DESIGNATOR means. Signals MISUSE if DESIGNATOR could mean several."
  (let ((samples (designated-samples results designator)))
    (when (rest samples)
      (reject-ambiguous (designator-text designator) (mapcar #'sample-condition samples)))
    (first samples)))

;;; Pairs.

(defun candidate-level-pairs (results first second)
  "Return lists (place level base), one for each factor of which FIRST and SECOND can be levels.
BASE is NIL if SECOND is :ALL."
  (loop for (place level) in (designated-levels results first)
        append (if (eq :all second)
                   (list (list place level nil))
                   (loop for (other base) in (designated-levels results second)
                         when (and (= place other) (string/= level base))
                           collect (list place level base)))))

(defun level-pair-title (results level-pair)
  (destructuring-bind (place level base) level-pair
    (format nil "~A~@[ against ~A~]" (level-title results (list place level))
            (and base (level-title results (list place base))))))

(defun level-pair-samples (results level-pair)
  "Return pairs of samples that have the levels of LEVEL-PAIR and are otherwise equal."
  (destructuring-bind (place level base) level-pair
    (loop for other in (if base (list base) (remove level (levels results place) :test #'string=))
          append (pairs-differing-in-factor results place level other))))

(defun pairs-of-levels (results first second)
  "Return pairs of samples that differ only in one factor, where they have the levels FIRST and
SECOND, and the index of the factor. Return NIL if FIRST and SECOND are not levels. Signals MISUSE
if several factors have these levels."
  (let ((level-pairs (candidate-level-pairs results first second)))
    (when (rest level-pairs)
      (reject-ambiguous (if (eq :all second)
                            (designator-text first)
                            (format nil "~A against ~A" (designator-text first)
                                    (designator-text second)))
                        (loop for pair in level-pairs collect (level-pair-title results pair))))
    (and level-pairs
         (values (level-pair-samples results (first level-pairs)) (first (first level-pairs))))))

(defun pairs-of-conditions (results first second)
  (let* ((sample (designated-sample results first))
         (others (if (eq :all second)
                     (remove sample (results-samples results))
                     (list (designated-sample results second)))))
    (when (member sample others)
      (reject-use "~A cannot be compared with itself; give two conditions."
                  (sample-condition sample)))
    (unless others (reject-use "There is only one condition, ~A." (sample-condition sample)))
    (loop for other in others collect (list sample other))))

;; 4 and 8 may mean values of a factor, or the fourth and the eighth condition.
(defun level-pair-of-integers (results first second)
  "If FIRST and SECOND are integers and both are levels of one factor, return the level pair (place
level base). Else return NIL."
  (when (and (integerp first) (integerp second) (/= first second))
    (let ((level (designator-text first)) (base (designator-text second)))
      (loop for place in (varying-factors results)
            for levels = (levels results place)
            when (and (member level levels :test #'string=) (member base levels :test #'string=))
              return (list place level base)))))

(defun same-pair-by-number-p (results first second level-pair)
  "True if LEVEL-PAIR compares exactly the conditions with the numbers FIRST and SECOND."
  (equal (list (list (numbered-sample results first) (numbered-sample results second)))
         (level-pair-samples results level-pair)))

(defun resolve-integer-designators (results first second)
  "Integers can mean levels or numbers of conditions. If FIRST and SECOND must mean levels of one
factor, return their texts, else return both unchanged. Signals MISUSE if both meanings fit."
  (let ((level-pair (level-pair-of-integers results first second)))
    (cond ((or (null level-pair) (same-pair-by-number-p results first second level-pair))
           (values first second))
          ((and (numbered-sample results first) (numbered-sample results second))
           (reject-ambiguous (format nil "~D against ~D" first second)
                             (list (format nil "the conditions with the numbers ~D and ~D" first
                             second)
                                   (level-pair-title results level-pair))))
          (t (values (designator-text first) (designator-text second))))))

(defun designated-pairs (results first second)
  "Return the pairs of samples of RESULTS that the designators FIRST and SECOND mean. If these are
levels that several conditions have, also return the factor's index. SECOND may be :ALL."
  (multiple-value-bind (first second) (resolve-integer-designators results first second)
    (multiple-value-bind (pairs place)
        (and (or (rest (designated-samples results first))
                 (and (not (eq :all second)) (rest (designated-samples results second))))
             (pairs-of-levels results first second))
      (if pairs
          (values pairs place)
          (pairs-of-conditions results first second)))))
