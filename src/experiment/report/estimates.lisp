;;;; estimates.lisp -- what a column of a table comes to: a rate, a mean, a median, or texts.

(in-package :ars-magna.experiment)

;;; What was measured is a rate if it was always true or false. If there are numbers in it, it is
;;; their mean: what else there is besides is left out, and counted. Else it is texts. This goes by
;;; all conditions together, so that the same is said of each. :NONE was not measured.

(addition estimate-p)
(define-record (estimate (:constructor make-estimate
                             (name kind count &key value low high (left-out 0) texts beside)))
  "What a column of the table comes to under one condition."
  (name "" string "what was measured, a string: success, ticks, or the name of a measure" :addition)
  (kind :nothing keyword ":RATE of what was always true or false, :MEAN of numbers, :MEDIAN of
ticks, :TEXTS of all else, and :NOTHING of what was never measured, under any condition" :addition)
  (count 0 integer "how many trials it was measured in; of ticks, how many succeeded" :addition)
  (value nil (or null real)
         "the rate, from 0 to 1, the mean or the median; NIL of none, and of texts" :addition)
  (low nil (or null real)
       "the low bound of the interval; NIL if there are too few values" :addition)
  (high nil (or null real)
        "the high bound of the interval; NIL if there are too few values" :addition)
  (left-out 0 integer "how many values beside numbers are no numbers, and left out" :addition)
  (texts '() list "an alist from texts to how often there are such, commonest first" :addition)
  (beside '() list "estimates of the same values by other statistics"))

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

;;; Statistics: how a value and an interval are made of what was measured.

(defvar *statistics* '() "Lists (kind heading beside function), in order of definition.")

(defmacro define-statistic (kind (values confidence) (&key heading beside) &body body)
  "Let BODY return, as three values, what estimates of KIND say of VALUES, a vector that is not
empty: a value and the bounds of its interval at CONFIDENCE; any may be NIL. HEADING is said of it
in tables of results, behind the name of what was measured. If BESIDE is a kind, each estimate of
that has one of this, too, in a column beside its own. Return KIND."
  `(progn
     (setf *statistics*
           (append (remove ,kind *statistics* :key #'first)
                   (list (list ,kind ,heading ,beside (lambda (,values ,confidence) ,@body)))))
     ,kind))

(define-statistic :rate (truths confidence) (:heading " %")
  (let ((true (count t truths)) (trials (length truths)))
    (multiple-value-bind (low high) (wilson-interval true trials :confidence confidence)
      (values (/ true trials) low high))))

(define-statistic :mean (numbers confidence) (:heading ", mean")
  (let* ((scale (scale-for numbers))
         (sample (cl:map 'vector (lambda (number) (scaled number scale)) numbers)))
    (multiple-value-bind (low high) (student-interval sample :confidence confidence)
      (values (unscaled (mean sample) scale) (unscaled low scale) (unscaled high scale)))))

(define-statistic :median (numbers confidence) (:heading ", median")
  (multiple-value-bind (low high) (median-interval numbers :confidence confidence)
    (values (median numbers) low high)))

(defun kind-heading (kind)
  (second (assoc kind *statistics*)))

(defun estimate-by (kind name values confidence &optional (left-out 0))
  "Return the estimate of KIND of VALUES, of which LEFT-OUT more were no such values."
  (multiple-value-bind (value low high)
      (if (zerop (length values))
          (values nil nil nil)
          (funcall (fourth (assoc kind *statistics*)) values confidence))
    (make-estimate name kind (length values)
                   :value value :low low :high high :left-out left-out
                   :beside (loop for (other nil beside) in *statistics*
                                 when (eq kind beside)
                                   collect (estimate-by other name values confidence)))))

(defun estimate-of-values (name kind column confidence)
  (let ((values (remove :none column)))
    (ecase kind
      (:nothing (make-estimate name kind 0))
      (:rate (estimate-by :rate name values confidence))
      (:mean (let ((numbers (remove-if-not #'finite-value-p values)))
               (estimate-by :mean name numbers confidence (- (length values) (length numbers)))))
      (:texts (make-estimate name kind (length values)
                             :texts (tally (cl:map 'list #'value-text values)))))))
