;;;; inference-survival.lisp -- curves and the log-rank test, on Freireich's patients of 1963.

(in-package :ars-magna.tests)

(def-suite* inference-survival :in ars-magna)

;;; The weeks in remission of 21 children with 6-MP and 21 with a placebo, as in Gehan 1965; most
;;; textbooks have them.

(defparameter *treated* '(6 6 6 6 7 9 10 10 11 13 16 17 19 20 22 23 25 32 32 34 35))
(defparameter *relapsed* '(1 1 1 0 1 0 1 0 0 1 1 0 0 0 1 1 0 0 0 0 0))
(defparameter *untreated* '(1 1 2 2 3 4 4 5 5 8 8 8 8 11 11 12 12 15 17 22 23))

(defun all-done (times)
  (make-list (length times) :initial-element t))

(test survival.as-gehan-and-textbooks-print-it
  "Time, at risk, done and survival as in Kalbfleisch and Prentice; the bands as SAS and R print
them on the scale of log(-log)."
  (is (equal '((6 21 3 "0.857" "0.620" "0.952") (7 17 1 "0.807" "0.563" "0.923")
               (10 15 1 "0.753" "0.503" "0.889") (13 12 1 "0.690" "0.432" "0.849")
               (16 11 1 "0.627" "0.368" "0.805") (22 7 1 "0.538" "0.268" "0.747")
               (23 6 1 "0.448" "0.188" "0.680"))
             (loop for (time at-risk done . shares) in (stats:survival-curve *treated* *relapsed*)
                   collect (list* time at-risk done (printed 3 shares)))))
  (is (equal '("0.9048" "0.8095" "0.7619" "0.6667" "0.5714" "0.3810" "0.2857" "0.1905" "0.1429"
               "0.0952" "0.0476" "0.0000")
             (printed 4 (mapcar #'fourth (stats:survival-curve *untreated*
                                                               (all-done *untreated*)))))))

(test median-survival.as-in-textbooks
  (is (equal '(23 13 nil)
             (multiple-value-list
              (stats:median-survival (stats:survival-curve *treated* *relapsed*)))))
  (is (equal '(8 4 11)
             (multiple-value-list
              (stats:median-survival
               (stats:survival-curve *untreated* (all-done *untreated*)))))))

(test log-rank.as-in-textbooks
  "Chi-square is 16.79; 19.25 relapses were to be expected of the treated, and 10.75 of the others."
  (multiple-value-bind (p square done expected)
      (stats:log-rank-test *treated* *relapsed* *untreated* (all-done *untreated*))
    (is-printed 2 '("16.79") square)
    (is-printed 2 '("19.25") expected)
    (is (= 9 done))
    (is (near p 4.17d-5 5d-8)))
  (multiple-value-bind (p square done expected)
      (stats:log-rank-test *untreated* (all-done *untreated*) *treated* *relapsed*)
    (is (near p 4.17d-5 5d-8))
    (is-printed 2 '("16.79") square)
    (is-printed 2 '("10.75") expected)
    (is (= 21 done))))

(test survival.is-the-share-that-is-left-where-nothing-was-cut-short
  (let* ((dice (base:make-dice 1))
         (times (loop repeat 200 collect (base:roll-index 40 dice)))
         (curve (stats:survival-curve times (all-done times))))
    (is (equal (sort (remove-duplicates times) #'<) (mapcar #'first curve)))
    (loop for (time at-risk done survival low high) in curve
          do (is (near survival (/ (count time times :test #'<) 200) 1d-13))
             (is (= at-risk (count time times :test #'<=)))
             (is (= done (count time times)))
             (is (<= 0 low survival high 1)))))

(test survival.is-free-of-order-and-of-how-it-is-said
  (flet ((curve (times events)
           (stats:survival-curve times events)))
    (is (equal (curve *treated* *relapsed*)
               (curve (coerce (reverse *treated*) 'vector)
                      (mapcar (lambda (event) (= event 1)) (reverse *relapsed*)))))))

(test survival.cut-short-in-a-moment-is-at-risk-in-it
  (is (equal '((5 3 1)) (mapcar (lambda (step) (subseq step 0 3))
                                (stats:survival-curve '(5 5 5) '(nil t nil))))))

(test survival.at-the-edges
  (is (null (stats:survival-curve '() '())))
  (is (null (stats:survival-curve '(5000 5000) '(nil nil))))
  (is (equal '(nil nil nil) (multiple-value-list (stats:median-survival '()))))
  (is (equal '((2 1 1 0d0 0d0 1d0)) (stats:survival-curve '(2) '(t))))
  (destructuring-bind (before last)
      (stats:survival-curve '(1 2) '(t t))
    (is (equal (list 0d0 0d0 (sixth before)) (nthcdr 3 last))))
  (is (equal '(1d0 0d0 0 0d0)
             (multiple-value-list (stats:log-rank-test '() '() *treated* *relapsed*))))
  (is (= 1 (stats:log-rank-test '(3 4) '(nil nil) '(5) '(nil)))))

(test survival.of-equal-groups-does-not-differ
  (multiple-value-bind (p square) (stats:log-rank-test *treated* *relapsed* *treated* *relapsed*)
    (is (near 1 p 1d-6))
    (is (near 0 square 1d-12))))

(test survival.is-checked-at-the-door
  (signals-wrong-argument stats:survival-curve (stats:survival-curve '(1 2) '(t)))
  (signals-wrong-argument stats:survival-curve (stats:survival-curve '(1 -2) '(t t)))
  (signals-wrong-argument stats:survival-curve (stats:survival-curve '(1 2) '(t :limit)))
  (signals-wrong-argument stats:survival-curve (stats:survival-curve '(1) '(t) :confidence 95))
  (signals-wrong-argument stats:median-survival (stats:median-survival '(1 2 3)))
  (signals-wrong-argument stats:log-rank-test (stats:log-rank-test '(1) '(t) '(2) '(2))))
