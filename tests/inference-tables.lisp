;;;; inference-tables.lisp -- distributions and intervals equal published tables to the last digit.

(in-package :ars-magna.tests)

(def-suite* inference-tables :in ars-magna)

(defun printed (digits numbers)
  "Return NUMBERS as a table with so many DIGITS prints them; what is no number, as it is."
  (mapcar (lambda (number) (if (realp number) (format nil "~,VF" digits number) number)) numbers))

(defmacro is-printed (digits expected form)
  "Claim that the values of FORM, with DIGITS, are EXPECTED, a list of strings."
  `(is (equal ,expected (printed ,digits (multiple-value-list ,form))) "~S" ',form))

(defun relatively-near (a b &optional (tolerance 1d-13))
  (<= (abs (- a b)) (* tolerance (abs b))))

;;; Distributions.

(test normal.as-in-tables
  "Abramowitz and Stegun, Tables 26.1 and 26.5."
  (loop for (z . text) in '((0 . "0.50000") (1 . "0.84134") (1.5 . "0.93319") (2 . "0.97725")
                            (2.5 . "0.99379") (3 . "0.99865") (-1 . "0.15866"))
        do (is-printed 5 (list text) (stats::normal-cdf (base:double z))))
  (loop for (p . text) in '((.975d0 . "1.95996") (.995d0 . "2.57583") (.9995d0 . "3.29053")
                            (.95d0 . "1.64485") (.9d0 . "1.28155") (.5d0 . "0.00000")
                            (.025d0 . "-1.95996"))
        do (is-printed 5 (list text) (stats::normal-quantile p))))

(test normal.to-the-last-digits
  "Reckoned with 60 digits."
  (loop for (z . p) in '((-1 . .15865525393145705d0) (-5 . 2.8665157187919391d-7)
                         (-10 . 7.6198530241605261d-24) (-37 . 5.7255712225239270d-300))
        do (is (relatively-near (stats::normal-cdf (base:double z)) p 2d-13)))
  (is (relatively-near (stats::normal-quantile .975d0) 1.9599639845400542d0 1d-15))
  (is (relatively-near (stats::normal-quantile 1d-20) -9.262340089798408d0 1d-15)))

(test normal.quantile-undoes-probability
  (loop for z from -8d0 to 6d0 by .125d0
        do (is (near z (stats::normal-quantile (stats::normal-cdf z)) 1d-7) "~S" z)))

(test student.as-in-tables
  "Fisher and Yates, Table III; Abramowitz and Stegun, Table 26.10."
  (loop for (freedom . texts) in '((1 "6.314" "12.706" "63.657") (2 "2.920" "4.303" "9.925")
                                   (3 "2.353" "3.182" "5.841") (4 "2.132" "2.776" "4.604")
                                   (5 "2.015" "2.571" "4.032") (10 "1.812" "2.228" "3.169")
                                   (20 "1.725" "2.086" "2.845") (30 "1.697" "2.042" "2.750")
                                   (60 "1.671" "2.000" "2.660") (120 "1.658" "1.980" "2.617"))
        do (loop for confidence in '(.9d0 .95d0 .99d0) for text in texts
                 do (is-printed 3 (list text)
                                (stats::student-critical-value confidence (base:double freedom))))))

(defun student-tail (number freedom)
  "Return the probability that Student's t of FREEDOM degrees is above NUMBER (Abramowitz and
Stegun 26.7.1)."
  (let* ((square (* number number)) (whole (+ freedom square))
         (tail (/ (stats::incomplete-beta (/ freedom 2) .5d0 (/ freedom whole) (/ square whole))
                  2)))
    (if (minusp number) (- 1 tail) tail)))

(test student.tails-have-closed-forms
  "Of one degree of freedom it is Cauchy's; of two, 1/2 - t / (2 sqrt(2 + t^2))."
  (loop for time in '(-3d0 -.1d0 0d0 .001d0 .5d0 1d0 7d0)
        do (is (relatively-near (student-tail time 1d0) (- 1/2 (/ (atan time) pi)) 1d-14))
           (is (relatively-near (student-tail time 2d0)
                                (- 1/2 (/ time (* 2 (sqrt (+ 2 (* time time))))))
                                1d-13)))
  (is (relatively-near (student-tail 1d9 1d0) (/ (* pi 1d9))))
  (loop for confidence in '(1d-6 .3d0 .5d0 .95d0 .999999d0)
        do (is (near confidence
                     (- 1 (* 2 (student-tail (stats::student-critical-value confidence 7d0) 7d0)))
                     1d-15))))

(test chi-square.as-in-tables
  "Fisher and Yates, Table IV: what is above these with a probability of .05 and .01."
  (loop for (freedom five one) in '((1 3.841 6.635) (2 5.991 9.210) (3 7.815 11.345)
                                    (5 11.070 15.086) (10 18.307 23.209) (30 43.773 50.892))
        do (is (near .05 (stats::chi-square-tail five freedom) 2d-5))
           (is (near .01 (stats::chi-square-tail one freedom) 5d-6)))
  (loop for x in '(0d0 1d-9 .1d0 1d0 30d0 900d0)
        do (is (relatively-near (stats::chi-square-tail x 2) (exp (/ x -2))))))

(defun binomial-odds (trials probability)
  "Return a vector of the probabilities of 0, 1 ... TRIALS successes, each from its neighbour."
  (let ((odds (make-array (1+ trials) :initial-element 0d0)) (p (base:double probability))
        (mode (floor (* (1+ trials) probability))))
    (setf mode (min mode trials)
          (aref odds mode) 1d0)
    (loop for k from (1+ mode) to trials
          do (setf (aref odds k) (/ (* (aref odds (1- k)) (- trials k -1) p) (* k (- 1 p)))))
    (loop for k from (1- mode) downto 0
          do (setf (aref odds k) (/ (* (aref odds (1+ k)) (1+ k) (- 1 p)) (* (- trials k) p))))
    (let ((whole (reduce #'+ odds)))
      (map 'vector (lambda (one) (/ one whole)) odds))))

(test incomplete-beta.is-the-tail-of-counts
  (loop for (trials p) in '((1 1/2) (10 1/3) (100 .05d0) (1000 .9d0))
        for odds = (binomial-odds trials p)
        do (loop for k from 1 to trials by (ceiling trials 20)
                 for tail = (reduce #'+ odds :start k)
                 do (is (near tail (stats::incomplete-beta (base:double k)
                                                           (base:double (- trials k -1))
                                                           (base:double p) (base:double (- 1 p)))
                              1d-13)
                        "~D of ~D" k trials))))

(test incomplete-beta.to-the-last-digits
  "Reckoned with 60 digits and more; the last is where factorials would leave nine digits."
  (loop for (a b x share tolerance)
          in '((.5d0 .5d0 .25d0 .33333333333333333d0 1d-15)
               (200d0 300d0 .09698288680676685d0 4.4612482052825133d-72 1d-13)
               (1d5 2d5 .3163478475886302d0 1.6119551888521602d-88 1d-12))
        do (is (relatively-near (stats::incomplete-beta a b x (- 1 x)) share tolerance))))

(test beta-quantile.undoes-incomplete-beta
  (loop for (a b) in '((.5d0 .5d0) (1d0 3d0) (40d0 2d0) (.5d0 5d8) (1d6 1d6))
        do (loop for p in '(1d-12 .001d0 .1d0 .5d0 .9d0 .999d0)
                 do (multiple-value-bind (x y) (stats::beta-quantile p a b)
                      (is (near 1 (+ x y) 1d-15))
                      (is (relatively-near (stats::incomplete-beta a b x y) p 1d-11)
                          "~S" (list a b p))))))

;;; Intervals for proportions.

(test proportions.as-newcombe-prints-them
  "Newcombe 1998, Table I: methods 3 and 5."
  (loop for (successes trials wilson exact)
          in '((81 263 ("0.2553" "0.3662") ("0.2527" "0.3676"))
               (15 148 ("0.0624" "0.1605") ("0.0578" "0.1617"))
               (0 20 ("0.0000" "0.1611") ("0.0000" "0.1684"))
               (1 29 ("0.0061" "0.1718") ("0.0009" "0.1776")))
        do (is-printed 4 wilson (stats:wilson-interval successes trials))
           (is-printed 4 exact (stats:exact-interval successes trials))))

(test proportions.of-failures-mirror-those-of-successes
  (loop for interval in (list #'stats:wilson-interval #'stats:exact-interval)
        do (loop for (successes trials) in '((0 1) (1 1) (3 10) (0 500) (499 500)
                                            (123456 1000000000))
                 do (multiple-value-bind (low high) (funcall interval successes trials)
                      (multiple-value-bind (other-low other-high)
                          (funcall interval (- trials successes) trials)
                        (is (<= 0 low (/ successes trials) high 1))
                        (is (near low (- 1 other-high) 1d-15))
                        (is (near high (- 1 other-low) 1d-15)))))))

(test proportions.at-the-edges
  (is (equal '(0d0 1d0) (multiple-value-list (stats:wilson-interval 0 0))))
  (is (equal '(0d0 1d0) (multiple-value-list (stats:exact-interval 0 0))))
  (loop for trials in '(1 7 1000000000)
        do (is (eql 0d0 (stats:wilson-interval 0 trials)))
           (is (eql 0d0 (stats:exact-interval 0 trials)))
           (is (eql 1d0 (nth-value 1 (stats:wilson-interval trials trials))))
           (is (eql 1d0 (nth-value 1 (stats:exact-interval trials trials))))
           ;; (alpha/2)^(1/n), as nobody can dispute.
           (is (relatively-near (stats:exact-interval trials trials)
                                (expt .025d0 (/ 1d0 trials)) 1d-14))))

(test confidence.means-the-decimals-written
  "A single-float .95 is not 0.949999988."
  (is (equal (multiple-value-list (stats:wilson-interval 3 10))
             (multiple-value-list (stats:wilson-interval 3 10 :confidence .95f0))))
  (is (equal (multiple-value-list (stats:exact-interval 3 10 :confidence 9/10))
             (multiple-value-list (stats:exact-interval 3 10 :confidence .9f0)))))

(test proportions.reject-what-makes-no-sense
  (signals-wrong-argument stats:wilson-interval (stats:wilson-interval 5 4))
  (signals-wrong-argument stats:wilson-interval (stats:wilson-interval -1 4))
  (signals-wrong-argument stats:wilson-interval (stats:wilson-interval 1 4.0))
  (signals-wrong-argument stats:exact-interval (stats:exact-interval 1 2000000000))
  (dolist (confidence '(0 1 95 -1/2 :high))
    (signals-wrong-argument stats:wilson-interval
      (stats:wilson-interval 1 4 :confidence confidence))
    (signals-wrong-argument stats:exact-interval
      (stats:exact-interval 1 4 :confidence confidence))))
