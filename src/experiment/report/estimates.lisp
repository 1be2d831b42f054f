;;;; estimates.lisp -- what a column of a table comes to: a rate, a mean, a median, or texts.

(in-package :ars-magna.experiment)

;;; What was measured is a rate if it was always true or false. If there are numbers in it, it is
;;; their mean: what else there is besides is left out, and counted. Else it is texts. This goes by
;;; all conditions together, so that the same is said of each. :NONE was not measured.

(addition estimate-p)
(define-record (estimate (:constructor make-estimate
                             (name kind count &key value low high (left-out 0) texts)))
  "What a column of the table comes to under one condition."
  (name "" string "what was measured, a string: success, ticks, or the name of a measure" :addition)
  (kind :nothing (member :rate :mean :median :texts :nothing) ":RATE of what was always true or
false, :MEAN of numbers, :MEDIAN of ticks, :TEXTS of all else, and :NOTHING of what was never
measured, under any condition" :addition)
  (count 0 integer "how many trials it was measured in; of ticks, how many succeeded" :addition)
  (value nil (or null real)
         "the rate, from 0 to 1, the mean or the median; NIL of none, and of texts" :addition)
  (low nil (or null real)
       "the low bound of the interval; NIL if there are too few values" :addition)
  (high nil (or null real)
        "the high bound of the interval; NIL if there are too few values" :addition)
  (left-out 0 integer "how many values beside numbers are no numbers, and left out" :addition)
  (texts '() list "an alist from texts to how often there are such, commonest first" :addition))

(defmethod print-object ((estimate estimate) stream)
  (print-unreadable-object (estimate stream)
    (format stream "~A: ~(~A~) of ~D~@[, ~F~]" (estimate-name estimate) (estimate-kind estimate)
            (estimate-count estimate) (estimate-value estimate))))

;;; Kinds.

(defun kind-of-values (columns)
  "Return which kind of estimate is made of COLUMNS, of one measure under all conditions."
  (flet ((some-value (test)
           (some (lambda (column) (some test column)) columns)))
    (cond ((some-value #'finite-value-p) :mean)
          ((some-value (lambda (value) (not (typep value '(or boolean (eql :none)))))) :texts)
          ((some-value (lambda (value) (typep value 'boolean))) :rate)
          (t :nothing))))

(defun tally (texts)
  "Return an alist from the strings TEXTS to how many there are, commonest first."
  (let ((counts (make-hash-table :test 'equal)))
    (cl:map nil (lambda (text) (incf (gethash text counts 0))) texts)
    (sort (loop for text being the hash-keys of counts using (hash-value count)
                collect (cons text count))
          (lambda (a b)
            (or (> (cdr a) (cdr b))
                (and (= (cdr a) (cdr b)) (string< (car a) (car b))))))))

;;; Estimates.

(defun rate-estimate (name successes trials confidence)
  (multiple-value-bind (low high) (wilson-interval successes trials :confidence confidence)
    (make-estimate name :rate trials :value (if (zerop trials) nil (/ successes trials))
                                     :low (if (zerop trials) nil low)
                                     :high (if (zerop trials) nil high))))

(defun mean-estimate (name numbers left-out confidence)
  (let* ((scale (scale-for numbers))
         (sample (cl:map 'vector (lambda (number) (scaled number scale)) numbers)))
    (multiple-value-bind (low high) (student-interval sample :confidence confidence)
      (make-estimate name :mean (length numbers) :value (unscaled (mean sample) scale)
                                                 :low (unscaled low scale)
                                                 :high (unscaled high scale)
                                                 :left-out left-out))))

(defun median-estimate (name numbers confidence)
  (multiple-value-bind (low high) (median-interval numbers :confidence confidence)
    (make-estimate name :median (length numbers) :value (median numbers) :low low :high high)))

(defun estimate-of-values (name kind column confidence)
  (let ((values (remove :none column)))
    (ecase kind
      (:nothing (make-estimate name kind 0))
      (:rate (rate-estimate name (count t values) (length values) confidence))
      (:mean (let ((numbers (remove-if-not #'finite-value-p values)))
               (mean-estimate name numbers (- (length values) (length numbers)) confidence)))
      (:texts (make-estimate name kind (length values)
                             :texts (tally (cl:map 'list #'value-text values)))))))
