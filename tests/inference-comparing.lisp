;;;; inference-comparing.lisp -- tests of pairs, of several, and of growing results.

(in-package :ars-magna.tests)

(def-suite* inference-comparing :in ars-magna)

;;; Pairs of outcomes.

(test mcnemar.as-fagerland-prints-it
  "Fagerland, Lydersen and Laake 2013, Table 5: the exact p and the mid-p of Bentur's and Cavo's
patients."
  (is-printed 4 '("0.0703" "0.0391") (stats:mcnemar-test 1 7))
  (is-printed 4 '("0.0525" "0.0347") (stats:mcnemar-test 6 16)))

(test mcnemar.is-the-sign-test
  (loop for (first second) in '((0 6) (3 11) (20 31) (400 460))
        for odds = (binomial-odds (+ first second) 1/2)
        for tail = (reduce #'+ odds :end (1+ first))
        do (multiple-value-bind (p mid-p) (stats:mcnemar-test second first)
             (is (relatively-near p (* 2 tail) 1d-12))
             (is (relatively-near mid-p (- (* 2 tail) (aref odds first)) 1d-12)))))

(test mcnemar.at-the-edges
  (is (equal '(1d0 1d0) (multiple-value-list (stats:mcnemar-test 0 0))))
  ;; Of two pairs half of all outcomes are as these. Half of them count, and all farther off.
  (is (near 3/4 (nth-value 1 (stats:mcnemar-test 1 1))))
  (is (= 1 (stats:mcnemar-test 7 7)))
  (is (near 1 (stats:mcnemar-test 7 8) 1d-14))
  (is (<= 0 (stats:mcnemar-test 0 1000000000) 1d-300))
  (signals-wrong-argument stats:mcnemar-test (stats:mcnemar-test -1 3))
  (signals-wrong-argument stats:mcnemar-test (stats:mcnemar-test 1 3.0)))

(test paired-proportions.as-newcombe-and-fagerland-print-them
  "Newcombe 1998, method 10; Fagerland, Lydersen and Laake 2014, the same two studies."
  (is-printed 4 '("0.0569" "0.3404") (stats:paired-proportion-interval 36 12 2 0))
  (is-printed 3 '("-0.507" "-0.026") (stats:paired-proportion-interval 1 1 7 12))
  (is-printed 3 '("-0.119" "-0.005") (stats:paired-proportion-interval 59 6 16 80)))

(test paired-proportions.mirror-each-other
  (loop for (both first second neither) in '((36 12 2 0) (0 0 0 7) (0 5 0 0) (30 1 2 900))
        do (multiple-value-bind (low high)
               (stats:paired-proportion-interval both first second neither)
             (multiple-value-bind (other-low other-high)
                 (stats:paired-proportion-interval both second first neither)
               (is (near low (- other-high) 1d-14))
               (is (near high (- other-low) 1d-14))
               (is (<= -1 low (/ (- first second) (+ both first second neither)) high 1))))))

(test paired-proportions.at-the-edges
  (is (equal '(-1d0 1d0) (multiple-value-list (stats:paired-proportion-interval 0 0 0 0))))
  (is (= 1 (nth-value 1 (stats:paired-proportion-interval 0 5 0 0))))
  (signals-wrong-argument stats:paired-proportion-interval
    (stats:paired-proportion-interval 1 1 1 1000000000))
  (signals-wrong-argument stats:paired-proportion-interval
    (stats:paired-proportion-interval 1 1 1/2 1)))

(test paired-proportions.narrow-as-outcomes-agree
  "Common seeds pay: the same margins, but trials that go the same way both times."
  (flet ((width (&rest counts)
           (multiple-value-bind (low high) (apply #'stats:paired-proportion-interval counts)
             (- high low))))
    (is (< (width 45 5 10 40) (* .7 (width 28 22 27 23))))))

;;; Pairs of numbers.

(defun share-of-signs (differences)
  "Return the share of all choices of signs for which the sum of DIFFERENCES, rational, is as far
from 0 as it is."
  (let ((sum (abs (reduce #'+ differences))) (all (expt 2 (length differences))))
    (/ (loop for signs below all
             count (<= sum (abs (loop for difference in differences for i from 0
                                      sum (if (logbitp i signs) difference (- difference))))))
       all)))

(test permutation.as-fisher-counted-it
  "The Design of Experiments, 21: 1726 of 32768."
  (is (equal '(1726d0 t) (multiple-value-bind (p exact) (stats:permutation-test *maize*)
                           (list (* p 32768) exact)))))

(test permutation.goes-through-all-signs
  (loop with dice = (base:make-dice 2)
        repeat 40
        for numbers = (loop repeat (1+ (base:roll-index 9 dice))
                            collect (/ (- (base:roll-index 15 dice) 5) 8))
        do (is (= (share-of-signs numbers) (stats:permutation-test numbers)) "~S" numbers)))

(test permutation.takes-for-equal-what-rounding-parts
  "In double-floats .1 + .2 is not .3; as tenths they are ties."
  (is (= (stats:permutation-test '(1 2 3 4 -3 7 5))
         (stats:permutation-test '(.1d0 .2d0 .3d0 .4d0 -.3d0 .7d0 .5d0)))))

(test permutation.is-mcnemars-test-of-ones
  (let ((ones (append (make-list 30 :initial-element 1) (make-list 13 :initial-element -1)
                      (make-list 100 :initial-element 0))))
    (multiple-value-bind (p exact) (stats:permutation-test ones)
      (is (relatively-near p (stats:mcnemar-test 30 13) 1d-12))
      (is (eq t exact)))))

(test permutation.draws-where-there-are-too-many
  "Of many numbers that are not badly skewed the sum is nearly normal."
  (let* ((dice (base:make-dice 8))
         (numbers (loop repeat 300 collect (base:roll-gaussian .1 1 dice)))
         (z (/ (reduce #'+ numbers) (sqrt (reduce #'+ (mapcar (lambda (x) (* x x)) numbers))))))
    (multiple-value-bind (p exact) (stats:permutation-test numbers)
      (is (null exact))
      (is (near p (* 2 (stats::normal-cdf (- (abs z)))) .015))
      (is (= p (stats:permutation-test numbers :seed 0)))
      (is (/= p (stats:permutation-test numbers :seed 1))))
    (is (= (/ 1001d0) (stats:permutation-test (mapcar #'abs numbers) :resamples 1000)))))

(test permutation.at-the-edges
  (is (equal '(1d0 t) (multiple-value-list (stats:permutation-test '()))))
  (is (= 1 (stats:permutation-test '(0 0 0)) (stats:permutation-test #(5))))
  (is (= 1/512 (stats:permutation-test (make-list 10 :initial-element 1d-300))))
  (signals-wrong-argument stats:permutation-test (stats:permutation-test '(1 2) :resamples 3))
  (signals-wrong-argument stats:permutation-test (stats:permutation-test '(1 2) :seed :lucky)))

(test permutation.weighs-rare-sums-instead-of-waiting-for-them
  "All on one side are 2 of 2^n; sizes that are nearly equal, or some of which outweigh all others,
are nearly as McNemar counts."
  (flet ((rare (numbers) (stats:permutation-test numbers :rare-too t :resamples 2000)))
    (let ((apart (loop for i below 40 collect (+ 1000 (/ (sin (float i 1d0)) 2)))))
      (multiple-value-bind (p exact) (rare apart)
        (is (null exact))
        (is (relatively-near p (expt 2d0 -39) .01))))
    ;; Five are negative, and all are nearly 1.
    (let ((ones (loop for i below 40 collect (* (if (< i 5) -1 1) (+ 1 (* 1d-7 (sin (* i i))))))))
      (is (<= (/ (stats:mcnemar-test 35 4) 20) (rare ones) (stats:mcnemar-test 35 5))))
    ;; A few numbers that are far larger than the others.
    (let ((mixed (append (loop for i below 12 collect (+ 1d6 (* 7 (sin (float i 1d0)))))
                         (loop for i below 60 collect (sin (* 1d0 i i))))))
      (is (<= (expt 2d0 -12) (rare mixed) (expt 2d0 -11))))))

(test permutation.rare-sums-are-near-their-normal-law
  (loop with dice = (base:make-dice 12)
        for mean in '(.06d0 .07d0 .08d0)
        for numbers = (loop repeat 3000 collect (base:roll-gaussian mean 1 dice))
        for z = (/ (reduce #'+ numbers) (sqrt (reduce #'+ (mapcar (lambda (x) (* x x)) numbers))))
        for p = (stats:permutation-test numbers :rare-too t :resamples 2000)
        do (is (relatively-near p (* 2 (stats::normal-cdf (- z))) .15) "~A ~A" z p)))

;;; Several tests.

(test holm.as-in-examples
  "Holm's steps of the four p-values of the common example; Wright 1992 for what they become."
  (flet ((adjusted (p-values) (printed 4 (stats:holm-adjusted p-values))))
    (is (equal '("0.0300" "0.0600" "0.0600" "0.0200") (adjusted '(.01 .04 .03 .005))))
    (is (equal '("0.0300" "0.0600" "0.0600" "0.0200") (adjusted #(1/100 .04d0 .03 .005))))
    (is (equal '("1.0000" "1.0000" "0.0003") (adjusted '(.9 .8 .0001))))
    (is (equal '("0.0400" "0.0400") (adjusted '(.02 .02))))
    (is (equal '("0.0500") (adjusted '(.05))))
    (is (equal '() (adjusted '())))))

(test holm.rejects-as-its-steps-say
  "A p-value is at most .05 after it just if Holm's procedure, written out, gets to it."
  (loop with dice = (base:make-dice 5)
        repeat 50
        for p-values = (loop repeat 8 collect (expt (base:roll dice) 3))
        for rejected = (loop for p in (sort (copy-list p-values) #'<) for left downfrom 8
                             while (<= p (/ .05d0 left)) collect p)
        for adjusted = (stats:holm-adjusted p-values)
        do (is (equal (loop for p in p-values collect (and (member p rejected) t))
                      (loop for p in adjusted collect (<= p .05d0))))))

(test holm.rejects-what-is-no-probability
  (dolist (p-values '((.5 2) (-1) 7 (:small)))
    (signals-wrong-argument stats:holm-adjusted (stats:holm-adjusted p-values))))

;;; Growing results.

(test sequential-levels.add-up
  (is (near 1/40 (stats:sequential-level 1 :level 1/20) 1d-17))
  (is (near (/ .05d0 6) (stats:sequential-level 2) 1d-17))
  (is (near (* .1d0 (- 1 (/ 1001d0)))
            (loop for look from 1 to 1000 sum (stats:sequential-level look :level .1))
            1d-14))
  (signals-wrong-argument stats:sequential-level (stats:sequential-level 0))
  (signals-wrong-argument stats:sequential-level (stats:sequential-level 1 :level 1)))

(test rate-evidence.is-one-on-average-if-the-rate-is-so
  "That is what makes it a martingale, and Ville's bound hold."
  (loop for (trials rate) in '((1 1/2) (10 .1d0) (100 .95d0) (300 1/3))
        for odds = (binomial-odds trials rate)
        do (is (near 1 (loop for successes from 0 to trials
                             sum (* (aref odds successes)
                                    (exp (stats:rate-evidence successes trials rate))))
                     1d-11))))

(test rate-evidence.by-its-definition
  "The mixture of s successes and f failures is s! f! / (s + f + 1)!: of 3 and 1 it is 1/20."
  (is (relatively-near (exp (stats:rate-evidence 3 4 1/2)) (/ 16 20d0)))
  (is (relatively-near (exp (stats:rate-evidence 0 9 .1)) (/ (* 10 (expt .9d0 9)))))
  (is (relatively-near (exp (stats:rate-evidence 9 9 .1)) 1d8))
  (is (eql 0d0 (stats:rate-evidence 0 0 .05)))
  (is (near 200 (stats:rate-evidence 520000 1000000 1/2) 800)))

(test rate-verdict.says-which-way
  (is (eq :above (stats:rate-verdict 70 100 .5)))
  (is (eq :below (stats:rate-verdict 30 100 .5)))
  (is (null (stats:rate-verdict 55 100 .5)))
  (is (null (stats:rate-verdict 0 0 .5)))
  (is (eq :below (stats:rate-verdict 990 1000 .999)))
  (is (null (stats:rate-verdict 70 100 .5 :level 1/1000)))
  (signals-wrong-argument stats:rate-verdict (stats:rate-verdict 3 2 .5))
  (signals-wrong-argument stats:rate-verdict (stats:rate-verdict 1 2 1))
  (signals-wrong-argument stats:rate-evidence (stats:rate-evidence 1 2 0)))
