;;;; levels.lisp -- what varies in a table, its values, and pairs that differ in nothing else.

(in-package :ars-magna.experiment)

;;; What varies is a factor, a value of it a level. Factors go by their places in SAMPLE-TEXTS.
;;; Named conditions are the levels of a first factor, CASE, which decides what the others are.

(defun text-at (place sample) (nth place (sample-texts sample)))

(defun levels (results place)
  "Return the texts of the values that vary at PLACE in RESULTS, in order."
  (remove-duplicates (mapcar (lambda (sample) (text-at place sample)) (results-samples results))
                     :test #'string= :from-end t))

(defun case-decides-p (place samples)
  "True if the first factor, named cases, decides what the factor PLACE is in SAMPLES."
  (loop for sample in samples
        always (loop for other in samples
                     always (or (string/= (text-at 0 sample) (text-at 0 other))
                                (string= (text-at place sample) (text-at place other))))))

(defun naming-factors (results)
  "Return the factors that tell conditions of RESULTS apart, by place: all but what a case decides."
  (loop with case-p = (equal "case" (first (results-factors results)))
        for place from 0 below (length (results-factors results))
        unless (and case-p (plusp place) (case-decides-p place (results-samples results)))
          collect place))

(defun free-factors (results)
  "Return the factors that make the conditions of RESULTS, by place."
  (remove-if-not (lambda (place) (rest (levels results place))) (naming-factors results)))

(defun factor-place (results factor)
  "Return which of what varies in RESULTS is called FACTOR, from 0. Signals UNKNOWN-NAME."
  (or (and (typep factor '(or symbol string))
           (position (string factor) (results-factors results) :test #'string-equal))
      (reject-name "column of what varies" (princ-to-string factor) (results-factors results))))

(defun level-called (levels value)
  "Return which of LEVELS is VALUE, the first of them if that is NIL. Signals UNKNOWN-NAME."
  (if (null value)
      (first levels)
      (let ((text (if (stringp value) value (value-text value))))
        (or (find text levels :test #'string-equal)
            (reject-name "value" text levels)))))

;;; What levels are called. What two conditions have in common need not be said of each.

(defun full-level-name (factor text) (format nil "~A=~A" factor text))

(defun level-name (factor text)
  "Return what the value TEXT of FACTOR is called: a word stands for itself."
  (if (or (number-in text) (member text '("TRUE" "FALSE" "") :test #'string=))
      (full-level-name factor text)
      text))

(defun level-names (factors texts)
  (format nil "~{~A~^ ~}" (mapcar #'level-name factors texts)))

;;; Pairs.

(defun factors-else (results place)
  "Return the factors that are to be equal where the factor PLACE differs."
  (let ((naming (naming-factors results)))
    (remove place (if (member place naming)
                      naming
                      (loop for other from 1 below (length (results-factors results))
                            collect other)))))

(defun level-pairs (results place level base)
  "Return lists of two samples of RESULTS that differ at PLACE only, the second being of BASE, and
the first of LEVEL; of any other if that is NIL."
  (let ((else (factors-else results place)))
    (flet ((counterpart (sample)
             (find-if (lambda (other)
                        (and (string= base (text-at place other))
                             (loop for place in else
                                   always (string= (text-at place sample)
                                                   (text-at place other)))))
                      (results-samples results))))
      (loop for sample in (results-samples results)
            for text = (text-at place sample)
            for other = (and (string/= base text)
                             (or (null level) (string= level text))
                             (counterpart sample))
            when other collect (list sample other)))))
