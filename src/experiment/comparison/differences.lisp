;;;; differences.lisp -- by how much two conditions differ in one thing, over trials of equal seeds.

(in-package :ars-magna.experiment)

;;; Trials of one seed have the same chance in them, so the difference between two conditions is
;;; taken seed by seed: what is easy for both, or hard, falls out of it. Rates are compared by
;;; Newcombe's interval and the exact McNemar test, means by Student's and a permutation test.

(defstruct (paired-difference (:conc-name paired-)
                              (:constructor make-difference
                                  (measure kind trials first second low high p
                                   &optional table same-p note))
                              (:copier nil))
  "How two conditions differ in MEASURE, a KIND of number: :RATE or :MEAN."
  (measure "" :type string :read-only t)
  (kind :mean :type (member :rate :mean) :read-only t)
  (trials 0 :type integer :read-only t)
  (first nil :read-only t)
  (second nil :read-only t)
  (low nil :read-only t)
  (high nil :read-only t)
  (p nil :read-only t)
  (table '() :type list :read-only t)
  ;; True if there is no difference in any pair.
  (same-p nil :type boolean :read-only t)
  ;; What is said in place of a verdict: that there is only rounding, or why there is none; or NIL.
  (note nil :type (or null string) :read-only t)
  ;; As one of how many tests it counts, and what P is worth as that.
  (tests 1 :type integer)
  (adjusted-p nil))

(defun paired-estimate (difference)
  "Return by how much the first rate or mean of DIFFERENCE is above the second, or NIL."
  (and (paired-first difference) (- (paired-first difference) (paired-second difference))))

(addition paired-difference-p paired-measure paired-trials paired-first paired-second
          paired-estimate paired-low paired-high paired-p paired-adjusted-p paired-table)
(document-functions
  paired-difference-p "True of how two conditions differ in one thing."
  paired-measure "Return what is compared: success, ticks or the name of a measure, a string."
  paired-trials "Return how many pairs of trials are counted."
  paired-first "Return the rate, from 0 to 1, or mean of the first; NIL of no trials."
  paired-second "Return the rate, from 0 to 1, or mean of the second; NIL of no trials."
  paired-low "Return the lower end of the 95 % interval of the difference; NIL of too few trials."
  paired-high "Return the upper end of the 95 % interval of the difference; NIL of too few trials."
  paired-p "Return the probability of as large a difference, or larger, if there is none; or NIL."
  paired-adjusted-p "Return PAIRED-P as it counts among all tests of the comparison (Holm), or NIL.
Those over several conditions, and those of single ones, count apart."
  paired-table "Return, of a rate, in how many pairs it was so for both, only for the first, only
for the second, and for neither, a list of four; of a mean, or over several conditions, NIL.")

(defmethod print-object ((difference paired-difference) stream)
  (print-unreadable-object (difference stream)
    (format stream "difference in ~A, ~D pairs" (paired-measure difference)
            (paired-trials difference))))

;;; Rates.

(defun pair-table (firsts seconds)
  "Return how often both, only the first, only the second and neither of FIRSTS and SECONDS, lists
of booleans, are true."
  (let ((both 0) (first 0) (second 0) (neither 0))
    (loop for a in firsts
          for b in seconds
          do (cond ((and a b) (incf both)) (a (incf first)) (b (incf second)) (t (incf neither))))
    (list both first second neither)))

(defun rate-difference (measure firsts seconds)
  "Return how often MEASURE is so, by FIRSTS and SECONDS, lists of booleans."
  (destructuring-bind (both first second neither) (pair-table firsts seconds)
    (let ((trials (+ both first second neither)))
      (if (zerop trials)
          (make-difference measure :rate 0 nil nil nil nil nil)
          (multiple-value-bind (low high) (paired-proportion-interval both first second neither)
            (make-difference measure :rate trials
                             (/ (+ both first) trials) (/ (+ both second) trials) low high
                             (values (mcnemar-test first second))
                             (list both first second neither)
                             (= 0 first second)))))))

;;; Means.

(defun draws-for (trials)
  "Return how many draws the test of so many TRIALS is worth: with many, fewer will do. How small p
can be does not depend on it."
  (max 1000 (min 10000 (floor 200000000 (max 1 trials)))))

;; Who adds the same floats in another order gets other last digits: that is no difference. Whole
;; numbers and ratios have none.
(defconstant +grain+ 1d-13 "By which share of them two floats may differ that rounding has parted.")

(defun equal-but-for-rounding-p (a b)
  (and (or (floatp a) (floatp b))
       (<= (abs (- a b)) (* +grain+ (max (abs a) (abs b))))))

(defun without-rounding (firsts seconds)
  "Return FIRSTS with the numbers of SECONDS in place of those that are equal but for rounding."
  (mapcar (lambda (a b) (if (equal-but-for-rounding-p a b) b a)) firsts seconds))

(defun rounding-note (firsts seconds)
  "Return in words that FIRSTS and SECONDS, numbers that rounding may have parted, differ; NIL if
they are equal."
  (unless (every #'= firsts seconds)
    (format nil "differs by no more than rounding may, at most ~A, seed by seed: ~A against ~A on ~
                 average"
            (float-text (double (loop for a in firsts
                                      for b in seconds
                                      maximize (abs (- (rational a) (rational b))))))
            (float-text (mean firsts))
            (float-text (mean seconds)))))

(defun too-large-p (value)
  (and (realp value) (not (quantity-p value))))

(defun too-large-difference (measure kind firsts seconds)
  "Return, as a difference, that MEASURE has numbers among FIRSTS and SECONDS that statistics do not
take; NIL if it has none."
  (let ((count (loop for a in firsts
                     for b in seconds
                     count (or (too-large-p a) (too-large-p b)))))
    (when (plusp count)
      (make-difference measure kind 0 nil nil nil nil nil '() nil
                       (format nil "cannot be compared: under ~D of ~D common seed~:P it is beyond ~
                                    1e15. Measure :none where there is no number, or use a larger ~
                                    unit" count (length firsts))))))

(defun mean-difference (measure firsts seconds &optional (kind :mean))
  "Return how large MEASURE is on average, by FIRSTS and SECONDS, lists of numbers."
  (let* ((trials (length firsts)) (measured firsts) (firsts (without-rounding firsts seconds))
         (same-p (every #'= firsts seconds)))
    (if (zerop trials)
        (make-difference measure kind 0 nil nil nil nil nil)
        (multiple-value-bind (low high) (mean-difference-interval firsts seconds)
          (make-difference measure kind trials (mean firsts) (mean seconds) low high
                           (values (permutation-test (mapcar (lambda (a b)
                                                               (- (rational a) (rational b)))
                                                             firsts seconds)
                                                     :resamples (draws-for trials)
                                                     :rare-too t))
                           '()
                           same-p
                           (and same-p (rounding-note measured seconds)))))))

;;; Several.

;; What is the same in all pairs could not be told to differ, whatever chance did: it is no test.
(defun tested-p (difference)
  (and (paired-p difference) (not (paired-same-p difference))))

(defun adjust-for-all (differences)
  "Let each of DIFFERENCES know what its test is worth among them."
  (let* ((with-p (remove nil differences :key #'paired-p))
         (tested (remove-if-not #'tested-p with-p)))
    (dolist (difference with-p)
      (setf (paired-adjusted-p difference) (paired-p difference)
            (paired-tests difference) (max 1 (length tested))))
    (loop for difference in tested
          for adjusted in (holm-adjusted (mapcar #'paired-p tested))
          do (setf (paired-adjusted-p difference) adjusted))))

(defun least-p (seeds)
  "Return the least p of a test over so many SEEDS: all differences on one side."
  (expt 2 (- 1 (max 1 seeds))))

(defun told-difference-p (difference)
  "True if DIFFERENCE is more than chance, as far as that can be told with 95 % confidence."
  (and (paired-adjusted-p difference) (<= (paired-adjusted-p difference) .05d0)))
