;;;; inference-samples.lisp -- means, medians and resampling, against published examples.

(in-package :ars-magna.tests)

(def-suite* inference-samples :in ars-magna)

(defparameter *maize* '(49 -67 8 16 6 23 28 41 14 29 56 24 75 60 -48)
  "How many eighths of an inch Darwin's crossed plants outgrew the others (Fisher 1935, 17).")

(defparameter *spatial* '(48 36 20 29 42 42 20 42 22 41 45 14 6 0 33 28 34 4 32 24 47 41 24 26 30
                          41)
  "The spatial test data A of Efron and Tibshirani 1993, Table 14.1.")

(defun own-variance (numbers)
  "Return the variance of NUMBERS, a vector, with n below."
  (let ((mean (/ (reduce #'+ numbers) (length numbers))))
    (/ (reduce #'+ (map 'vector (lambda (x) (expt (- x mean) 2)) numbers)) (length numbers))))

;;; Averages.

(defun as-sample (numbers)
  (stats::checked-sample 'as-sample 'numbers numbers))

(defun sample-variance (numbers)
  (stats::variance-of (as-sample numbers)))

(defun sample-deviation (numbers)
  (stats::mean-standard-error (as-sample numbers)))

(defun sample-quantile (numbers share)
  (stats::sorted-quantile (stats::sort-sample (as-sample numbers)) (stats:share-as-double share)))

(test averages.as-fisher-has-them
  (is-printed 3 '("20.933") (stats:mean *maize*))
  (is-printed 2 '("37.74") (sample-deviation *maize*))
  (is (= 24 (stats:median *maize*) (stats:median (coerce *maize* 'vector)))))

(test averages.of-any-numbers
  (is (eql 1.5d0 (stats:mean '(1 2.0 3/2 1.5d0))))
  (is (eql 7d0 (stats:mean #(7))))
  (is (eql 2.5d0 (sample-variance '(1 2 3 4 5)))))

(test averages.keep-their-digits
  "The variance of 1e9 + 1, 2 and 3 is 1, and equal numbers have none."
  (is (eql 1d0 (sample-variance (list (+ 1d9 1) (+ 1d9 2) (+ 1d9 3)))))
  (loop for number in '(.1d0 1/3 1d15 -7.7f0)
        for numbers = (make-list 1001 :initial-element number)
        do (is (= (base:double number) (stats:mean numbers)))
           (is (eql 0d0 (sample-variance numbers)))))

(test averages.of-too-few-are-nil
  (is (null (stats:mean '())))
  (is (null (stats:median #()))))

(test quantiles.are-of-type-7
  "Hyndman and Fan 1996: between the ranks (n - 1) p."
  (loop for (share . quantile) in '((0 . 1) (.1 . 1.9d0) (1/4 . 3.25d0) (.5 . 5.5d0) (.9 . 9.1d0)
                                    (1 . 10))
        do (is (near quantile (sample-quantile '(7 3 9 1 5 2 10 4 8 6) share) 1d-14))))

(test sorting.sorts
  (loop with dice = (base:make-dice 4)
        for size in '(0 1 2 3 7 8 9 100 1000)
        for numbers = (coerce (loop repeat size collect (base:roll-within 5 dice)) 'stats::doubles)
        do (is (equalp (sort (copy-seq numbers) #'<) (stats::sort-sample (copy-seq numbers))))))

;;; Intervals.

(test student-interval.as-fisher-has-it
  "t is 2.148 there; so 95.03 % of intervals would just reach 0."
  (is-printed 2 '("0.03" "41.84") (stats:student-interval *maize*))
  (is-printed 4 '("0.0039" "5.2294")
              (stats:student-interval (mapcar (lambda (eighths) (/ eighths 8)) *maize*))))

(test student-interval.at-the-edges
  (is (equal '(nil nil) (multiple-value-list (stats:student-interval '()))))
  (is (equal '(nil nil) (multiple-value-list (stats:student-interval '(4)))))
  (is (equal '(.1d0 .1d0) (multiple-value-list (stats:student-interval '(.1d0 .1d0 .1d0)))))
  ;; Two numbers: 12.706 times half their distance.
  (is-printed 3 '("-5.853" "6.853") (stats:student-interval #(0 1) :confidence 95/100)))

(test statistics.of-very-small-numbers-are-those-of-others-made-small
  "Though the squares of these are nothing to double-floats. A power of two changes no digit."
  (let* ((numbers '(1d0 2d0 4d0 4.5d0 5d0 9d0)) (small (scale-float 1d0 -600))
         (less (mapcar (lambda (number) (* small number)) numbers)))
    (flet ((agree (function &rest options)
             (is (equal (mapcar (lambda (bound) (* small bound))
                                (multiple-value-list (apply function numbers options)))
                        (multiple-value-list (apply function less options))))))
      (agree 'sample-deviation)
      (agree 'stats:student-interval)
      (agree 'stats:bootstrap-interval))
    (is (plusp (sample-deviation (list 0 least-positive-double-float))))))

(test mean-difference.is-that-of-the-differences
  (let ((firsts '(188 96 168 176 153 172 177 163 146 173 186 168 177 184 96))
        (seconds '(139 163 160 160 147 149 149 122 132 144 130 144 102 124 144)))
    (is (equal *maize* (mapcar #'- firsts seconds)))
    (is (equal (multiple-value-list (stats:student-interval *maize* :confidence .99))
               (multiple-value-list
                (stats:mean-difference-interval firsts (coerce seconds 'vector)
                                                :confidence .99))))
    (signals-wrong-argument stats:mean-difference-interval
      (stats:mean-difference-interval firsts (rest seconds)))))

(test median-interval.as-in-tables
  "The ranks and confidences of David and Nagaraja 2003, 7.1, and NIST's tables of the sign test."
  (loop for (size low high text) in '((6 1 6 "96.88") (8 1 8 "99.22") (9 2 8 "96.09")
                                      (10 2 9 "97.85") (15 4 12 "96.48") (20 6 15 "95.86")
                                      (25 8 18 "95.67") (50 18 33 "96.72"))
        for numbers = (loop for i from size downto 1 collect i)
        do (multiple-value-bind (found-low found-high confidence) (stats:median-interval numbers)
             (is (= low found-low))
             (is (= high found-high))
             (is (equal text (format nil "~,2F" (* 100 confidence)))))))

(test median-interval.of-too-few-is-nil
  (is (equal '(nil nil nil) (multiple-value-list (stats:median-interval '()))))
  (is (equal '(nil nil nil) (multiple-value-list (stats:median-interval '(1 2 3 4 5)))))
  (is (equal '(1d0 5d0 .9375d0)
             (multiple-value-list (stats:median-interval '(5 2 3 4 1) :confidence .9)))))

;;; The bootstrap.

(test bootstrap.as-efron-and-tibshirani-print-it
  "Table 14.2: the variance is 171.5, the acceleration .061, the 90 % interval 115.8 to 259.6 from
2000 samples of theirs."
  (is-printed 1 '("171.5") (own-variance (map 'vector #'base:double *spatial*)))
  (is-printed 3 '("0.061")
              (stats::bootstrap-acceleration (map 'stats::doubles #'base:double *spatial*)
                                             #'own-variance))
  (multiple-value-bind (low high)
      (stats:bootstrap-interval *spatial* :statistic #'own-variance :confidence .9)
    (is (near low 115.8 3))
    (is (near high 259.6 3))))

(test bootstrap.is-the-same-each-time
  (flet ((bounds (&rest options)
           (multiple-value-list (apply #'stats:bootstrap-interval *maize* options))))
    (is (equal (bounds) (bounds :seed 0 :statistic :mean)))
    (is (not (equal (bounds) (bounds :seed 1))))
    (is (equal (bounds :statistic #'stats:mean) (bounds)))
    (is (equal (bounds :statistic (lambda (numbers) (elt (sort numbers #'<) 7)))
               (bounds :statistic :median)))))

(test bootstrap.is-near-student-where-that-holds
  (let* ((dice (base:make-dice 3))
         (numbers (loop repeat 400 collect (base:roll-gaussian 10 2 dice))))
    (multiple-value-bind (low high) (stats:student-interval numbers)
      (multiple-value-bind (other-low other-high) (stats:bootstrap-interval numbers)
        (is (near low other-low .02))
        (is (near high other-high .02))))))

(test bootstrap.leaves-groups-out-of-large-samples
  "The acceleration of a mean is its skewness by 6 sqrt(n); of exponential numbers that is 2."
  (let* ((dice (base:make-dice 6))
         (numbers (coerce (loop repeat 5000 collect (- (log (- 1 (base:roll dice)))))
                          'stats::doubles)))
    (is (near (stats::bootstrap-acceleration numbers #'stats:mean)
              (/ 2 (* 6 (sqrt 5000)))
              25d-4))))

(test bootstrap.at-the-edges
  (is (equal '(nil nil) (multiple-value-list (stats:bootstrap-interval '()))))
  (is (equal '(nil nil) (multiple-value-list (stats:bootstrap-interval '(3)))))
  (is (equal '(3d0 3d0) (multiple-value-list (stats:bootstrap-interval '(3 3 3)))))
  (multiple-value-bind (low high) (stats:bootstrap-interval '(0 0 0 0 0 0 0 0 0 1000)
                                                            :confidence .999)
    (is (<= 0 low high 1000))))

(test samples.are-checked-at-the-door
  (dolist (numbers (list 7 '(1 . 2) '(1 :two) #(1 nil) (list 1d16) "ab"))
    (signals-wrong-argument stats:mean (stats:mean numbers))
    (signals-wrong-argument stats:median (stats:median numbers))
    (signals-wrong-argument stats:student-interval (stats:student-interval numbers))
    (signals-wrong-argument stats:median-interval (stats:median-interval numbers))
    (signals-wrong-argument stats:bootstrap-interval (stats:bootstrap-interval numbers))
    (signals-wrong-argument stats:permutation-test (stats:permutation-test numbers)))
  (dolist (options '((:statistic :mode) (:resamples 5) (:seed .5) (:confidence 2)))
    (signals-wrong-argument stats:bootstrap-interval
      (apply #'stats:bootstrap-interval '(1 2 3) options)))
  (signals-wrong-argument stats:bootstrap-interval
    (stats:bootstrap-interval '(1 2 3) :statistic (constantly :many))))
