;;;; experiment-compare.lisp -- conditions and versions side by side, seed by seed.

(in-package :ars-magna.tests)

(def-suite* experiment-compare :in ars-magna)

;;; Made-up tables. A row is a list (plan noise seed outcome ticks way digest). The number of the
;;; trial is the seed minus 7.

(defun made-up-line (row fingerprint)
  (destructuring-bind (plan noise seed outcome ticks way digest) row
    (format nil "search,~A~8,'0X,plan=~A noise=~A,~A,~A,~D,~D,~A,,~D,~A,~A,~16,'0X,~A"
            fingerprint (ldb (byte 32 0) (sxhash (format nil "~A ~A" plan noise)))
            plan noise plan noise seed (- seed 7) outcome ticks way
            (if (equal way "") "" (if (string= outcome "success") "TRUE" "FALSE"))
            digest (if (string= outcome "error") "boom" ""))))

(defun made-up-table (directory rows &optional (fingerprint "A1"))
  (write-table directory
               (cons (format nil "experiment,fingerprint,condition,plan,noise,seed,trial,outcome,~
                                  reason,ticks,way,found,digest,error")
                     (mapcar (lambda (row) (made-up-line row fingerprint)) rows))))

(defun rows-of-outcomes (plan noise outcomes &key (ticks 100) (way 5) (first 8))
  "Return rows of trials that went as the string OUTCOMES says: + success, - failure, ! error."
  (loop for char across outcomes
        for seed from first
        collect (list plan noise seed
                      (ecase char (#\+ "success") (#\- "failure") (#\! "error"))
                      (if (functionp ticks) (funcall ticks seed) ticks)
                      (if (char= char #\!) "" (if (functionp way) (funcall way seed) way))
                      (sxhash (list plan noise seed char)))))

(defun repeated (&rest chars-and-counts)
  (apply #'concatenate 'string
         (loop for (char count) on chars-and-counts by #'cddr
               collect (make-string count :initial-element char))))

(defmacro with-made-up ((results rows) &body body)
  "Run BODY with RESULTS bound to those of a table of ROWS."
  `(with-directories (directory)
     (made-up-table directory ,rows)
     (let ((,results (experiment:read-results directory)))
       ,@body)))

;; Both succeed 150 times, only the first 32, only the second 6, neither 12.
(defun patrol-and-spiral ()
  (append (rows-of-outcomes "patrol" "0.1" (repeated #\+ 182 #\- 18) :ticks #'identity
                                                                     :way 4)
          (rows-of-outcomes "spiral" "0.1" (repeated #\+ 150 #\- 32 #\+ 6 #\- 12)
                            :ticks (lambda (seed) (+ 2 seed (mod seed 3)))
                            :way (lambda (seed) (if (evenp seed) 3 5)))))

(defun differences-of (comparison)
  (experiment:contrast-differences (first (experiment:comparison-contrasts comparison))))

(defun difference-in (measure comparison)
  (find measure (differences-of comparison) :key #'experiment:paired-measure :test #'string=))

(defun tail-of-coin (successes trials)
  "Return how likely so few SUCCESSES are in TRIALS with a fair coin, exactly."
  (loop for k to successes
        sum (/ (loop with product = 1
                     for i from 1 to k
                     do (setf product (* product (/ (- trials i -1) i)))
                     finally (return product))
               (expt 2 trials))))

(defun near-p (a b) (< (abs (- a b)) 1d-9))

;;; Two conditions.

(test compare.counts-pairs-of-equal-seeds
  (with-made-up (results (patrol-and-spiral))
    (let* ((comparison (experiment:compare-conditions results 'patrol 'spiral :stream nil))
           (contrast (first (experiment:comparison-contrasts comparison)))
           (success (difference-in "success" comparison)))
      (is (equal '("noise=0.1" "patrol" "spiral" 200 0)
                 (list (experiment:contrast-where contrast) (experiment:contrast-first contrast)
                       (experiment:contrast-second contrast) (experiment:contrast-trials contrast)
                       (experiment:contrast-same contrast))))
      (is (equal '("success" "ticks" "way" "found")
                 (mapcar #'experiment:paired-measure (differences-of comparison))))
      (is (equal '(150 32 6 12) (experiment:paired-table success)))
      (is (equal '(200 91/100 78/100 13/100)
                 (list (experiment:paired-trials success) (experiment:paired-first success)
                       (experiment:paired-second success) (experiment:paired-estimate success))))
      (is (near-p (* 2 (tail-of-coin 6 38)) (experiment:paired-p success)))
      (multiple-value-bind (low high)
          (ars-magna.statistics:paired-proportion-interval 150 32 6 12)
        (is (= low (experiment:paired-low success)))
        (is (= high (experiment:paired-high success)))))))

(test compare.takes-ticks-where-both-succeed-and-measures-everywhere
  (with-made-up (results (patrol-and-spiral))
    (let* ((comparison (experiment:compare-conditions results 'patrol 'spiral :stream nil))
           (ticks (difference-in "ticks" comparison))
           (way (difference-in "way" comparison)))
      (is (= 150 (experiment:paired-trials ticks)))
      (is (near-p -3 (experiment:paired-estimate ticks)))
      (is (> 1d-3 (experiment:paired-p ticks)))
      (is (= 200 (experiment:paired-trials way)))
      (is (near-p 0 (experiment:paired-estimate way)))
      (is (= 1 (experiment:paired-p way)))
      (is (null (experiment:paired-table way))))))

(test compare.says-in-words-what-a-researcher-can-believe
  (with-made-up (results (patrol-and-spiral))
    (destructuring-bind (success ticks way found)
        (experiment:comparison-verdicts
         (experiment:compare-conditions results 'patrol 'spiral :stream nil))
      (is (string= (format nil "noise=0.1: patrol succeeds more often than spiral: p < .001 as one ~
                                of 4 tests, 91.0 % against 78.0 % over 200 common seeds, ~
                                difference 13.0 points (95 % interval 7.2 to 19.0).")
                   success))
      (is (mentions-p ticks (format nil "patrol takes fewer ticks than spiral: p < .001 as one of ~
                                         4 tests, 82.50 against 85.50 on average where both ~
                                         succeed, 150 common seeds, difference -3")))
      (is (mentions-p way (format nil "No significant difference in way between patrol and spiral: ~
                                       p = 1 as one of 4 tests, 4.00 against")))
      (is (mentions-p way "; if there is one, it is at most 0.14."))
      (is (mentions-p found "found is true more often with patrol than with spiral")))))

(test compare.says-what-is-equal-seed-by-seed
  (with-made-up (results (append (rows-of-outcomes "a" "0" "+++-" :way #'identity)
                                 (rows-of-outcomes "b" "0" "++-+" :way #'identity)))
    (is (string= (format nil "noise=0: way of a and b are equal, seed by seed: 9.500 against 9.500 ~
                              on average over 4 common seeds.")
                 (third (experiment:comparison-verdicts
                         (experiment:compare-conditions results 1 2 :stream nil)))))))

(test compare.is-the-same-the-other-way-round
  (with-made-up (results (patrol-and-spiral))
    (let ((one (difference-in "success" (experiment:compare-conditions results 1 2 :stream nil)))
          (other (difference-in "success" (experiment:compare-conditions results 2 1 :stream nil))))
      (is (= (experiment:paired-p one) (experiment:paired-p other)))
      (is (near-p (experiment:paired-low one) (- (experiment:paired-high other))))
      (is (mentions-p (first (experiment:comparison-verdicts
                              (experiment:compare-conditions results 2 1 :stream nil)))
                      "spiral succeeds less often than patrol")))))

(test compare.says-so-where-one-condition-never-measured
  (with-made-up (results (append (rows-of-outcomes "a" "0" "++++" :way 7)
                                 (rows-of-outcomes "b" "0" "++++" :way "")))
    (is (mentions-p (with-output-to-string (out)
                      (experiment:compare-conditions results 1 2 :stream out))
                    "way of a and b cannot be compared: over 0 common seeds (4 left out,"))))

(test compare.counts-common-seeds-and-errors-as-it-says
  (with-made-up (results (append (rows-of-outcomes "a" "0" "!+++-" :first 8)
                                 (rows-of-outcomes "b" "0" "!!--+" :first 10)))
    (let* ((text (with-output-to-string (out)
                   (experiment:compare-conditions results 1 2 :stream out)))
           (success (difference-in "success"
                                   (experiment:compare-conditions results 1 2 :stream nil))))
      (is (equal '(0 2 0 1) (experiment:paired-table success)))
      (is (mentions-p text "Left out, as one side lacks these seeds: noise=0: 2 of a and 2 of b."))
      (is (mentions-p text "with an error, and counted as not succeeded: noise=0: 2 of b."))
      (is (mentions-p text "way of a and b cannot be compared: over 1 common seed (2 left out,")))))

(test compare.needs-something-to-compare
  (with-made-up (results (append (rows-of-outcomes "a" "0" "+++" :first 8)
                                 (rows-of-outcomes "b" "0" "+++" :first 100)))
    (signals base:misuse (experiment:compare-conditions results 1 2 :stream nil))
    (signals base:misuse (experiment:compare-conditions results 1 1 :stream nil))
    (signals base:unknown-name (experiment:compare-conditions results 1 'c :stream nil))
    (signals base:unknown-name (experiment:compare-conditions results 1 3 :stream nil))
    (signals base:unknown-name
      (experiment:compare-conditions results 1 2 :measure 'weight :stream nil))
    (signals base:wrong-argument (experiment:compare-conditions 5 1 2))
    (signals base:wrong-argument (experiment:compare-conditions results 1 2 :stream 5))
    (signals base:unknown-name (experiment:compare-levels results 'plans :stream nil))
    (signals base:misuse (experiment:compare-levels results 'noise :stream nil))))

(test read-results.puts-in-order-what-a-run-under-way-has-written
  (let ((rows (patrol-and-spiral)))
    (flet ((verdicts (rows)
             (with-made-up (results rows)
               (is (= 2 (length (experiment:results-samples results))))
               (experiment:comparison-verdicts
                (experiment:compare-conditions results 'patrol 'spiral :stream nil)))))
      (is (equal (verdicts rows)
                 (verdicts (sort (copy-list rows) #'> :key #'third)))))))

;;; Several.

(defun four-plans (noise)
  (loop for plan in '("a" "b" "c" "d")
        for bad from 0 by 6
        append (rows-of-outcomes plan noise (repeated #\- bad #\+ (- 60 bad)))))

(test compare.counts-no-tests-of-what-is-the-same-in-all-pairs
  "Ticks and way never differ, so success and what is found are the only tests."
  (with-made-up (results (four-plans "0"))
    (let ((success (first (experiment:contrast-differences
                           (first (experiment:comparison-contrasts
                                   (experiment:compare-conditions results 'a 'd :stream nil)))))))
      (is (string= "success" (experiment:paired-measure success)))
      (is (near-p (* 2 (experiment:paired-p success)) (experiment:paired-adjusted-p success))))))

(test compare.corrects-p-for-all-tests
  (with-made-up (results (four-plans "0"))
    (let* ((comparison (experiment:compare-conditions results 'a :all :measure 'success
                                                                      :stream nil))
           (all (loop for contrast in (experiment:comparison-contrasts comparison)
                      append (experiment:contrast-differences contrast))))
      (is (equal '("b" "c" "d")
                 (mapcar #'experiment:contrast-second
                         (experiment:comparison-contrasts comparison))))
      ;; 6, 12 and 18 pairs of which all favour the first: 2/2^6, 2/2^12, 2/2^18.
      (is (every #'near-p (list (expt 2 -5) (expt 2 -11) (expt 2 -17))
                 (mapcar #'experiment:paired-p all)))
      (is (every #'near-p (list (expt 2 -5) (* 2 (expt 2 -11)) (* 3 (expt 2 -17)))
                 (mapcar #'experiment:paired-adjusted-p all)))
      (is (mentions-p (second (experiment:comparison-verdicts comparison))
                      "p < .001 as one of 3 tests")))))

(test compare.tells-no-difference-that-is-one-of-many-tests-only
  "5 pairs against 0 are p = 1/16; 6 are 1/32, and that as one of two no less than 1/16."
  (with-made-up (results (append (rows-of-outcomes "a" "0" (repeated #\+ 40))
                                 (rows-of-outcomes "b" "0" (repeated #\- 6 #\+ 34))
                                 (rows-of-outcomes "c" "0" (repeated #\- 5 #\+ 35))))
    (flet ((first-verdict (&rest arguments)
             (first (experiment:comparison-verdicts
                     (apply #'experiment:compare-conditions results 'a
                            (append arguments '(:measure success :stream nil)))))))
      (is (mentions-p (first-verdict 'b) "a succeeds more often than b"))
      (is (mentions-p (first-verdict :all) "No significant difference in success between a and b"))
      (is (mentions-p (first-verdict :all) "b: p = .062 as one of 2 tests (.031 alone), 100 %"))
      (is (mentions-p (first-verdict :all)
                      "if 2 differences are tested, an interval that leaves out 0"))
      (is (mentions-p (first-verdict 'b) "than b: p = .031, 100 % against")))))

;;; Many tests, few seeds.

(defun measured-differences (count shift trials)
  "Return the differences of COUNT measures over TRIALS, the first of them by SHIFT, adjusted."
  (let ((dice (ars-magna.base:make-dice 600)))
    (flet ((noise () (loop repeat trials collect (ars-magna.base:roll-between 0 1 dice))))
      (let ((differences (loop for number below count
                               collect (ars-magna.experiment::mean-difference
                                        "way"
                                        (mapcar (lambda (x) (+ x (if (zerop number) shift 0)))
                                                (noise))
                                        (noise)))))
        (ars-magna.experiment::adjust-p-values differences)
        differences))))

(test compare.tells-a-plain-difference-among-hundreds-of-tests
  (let ((differences (measured-differences 200 1000 22)))
    (is (< (experiment:paired-adjusted-p (first differences)) .001))
    (is (notany #'ars-magna.experiment::significant-p (rest differences)))))

(defun doubts-of (count trials)
  (ars-magna.experiment::no-difference-text (first (measured-differences count 1000 trials))))

(test compare.says-how-many-seeds-so-many-tests-need
  (is (mentions-p (doubts-of 60 8) (format nil "with 8 seeds p cannot be below .008, too much for ~
                                                60 tests: run 12 or more seeds, or compare fewer")))
  (is (mentions-p (doubts-of 1 5) "with 5 seeds p cannot be below .063: run 6 or more")))

(test compare.explains-a-p-above-the-level-beside-an-interval-without-0
  (is (mentions-p (doubts-of 1 5)
                  "the interval leaves out 0, but it is an approximation, and p is above .05")))

(test compare.calls-no-bound-certain
  (with-made-up (results (patrol-and-spiral))
    (is (mentions-p (third (experiment:comparison-verdicts
                            (experiment:compare-conditions results 1 2 :stream nil)))
                    "at most 0.14. This bound is right about 95 times in 100."))))

;;; Small, large and nearly equal numbers.

(defun verdict-on (firsts seconds)
  "Return the verdict on x, measured as FIRSTS in a and as SECONDS in b, trial by trial."
  (let ((difference (experiment::mean-difference "x" firsts seconds)))
    (experiment::adjust-p-values (list difference))
    (experiment::verdict difference (experiment::make-contrast nil "a" "b"))))

(defun verdict-on-all (first second)
  (verdict-on (make-list 30 :initial-element first) (make-list 30 :initial-element second)))

(test compare.takes-for-equal-only-what-is-equal
  (loop for (first second) in '((1700000010 1700000000) (4000000000.002d0 4000000000.001d0)
                                (1.000000000002d0 1.000000000001d0) (2d-300 1d-300)
                                (100000000000000000002 100000000000000000001))
        do (is (mentions-p (verdict-on-all first second) "x is higher with a than with b: p <")))
  (is (mentions-p (verdict-on '(1d9 2d9) '(1000000000.5d0 2000000000.25d0))
                  "No significant difference in x"))
  (is (mentions-p (verdict-on '(1 0.1d0) '(1.0d0 0.1d0)) "x of a and b are equal, seed by seed")))

(test compare.tells-rounding-as-what-it-is
  (is (string= (format nil "x of a and b differ only by rounding, by at most 1.1e-16 for any seed: ~
                            0.6000000000000001 against 0.6 on average over 30 common ~
                            seeds.")
               (verdict-on-all (+ .1d0 .2d0 .3d0) (+ .3d0 .2d0 .1d0))))
  (is-false (experiment::counts-as-test-p (experiment::mean-difference "x" '(.1d0 .3d0)
                                                                       (list .1d0 (+ .1d0 .2d0)))))
  (is (mentions-p (verdict-on '(.1d0 .3d0 2d0) (list .1d0 (+ .1d0 .2d0) 3d0))
                  "No significant difference in x")))

(test compare.writes-digits-that-tell-numbers-apart
  (loop for (first second . texts)
          in '((2d-300 1d-300 "2e-300 against 1e-300" "difference 1e-300")
               (1.000000002d0 1.000000001d0 "1.00000000200 against 1.00000000100" "1e-9")
               (4000000000.002d0 4000000000.001d0 "4000000000.00200 against 4000000000.00100")
               (3d99 1d99 "3e99 against 1e99" "difference 2e99")
               (12 11 "12.000 against 11.000" "difference 1.000 (95 % interval 1.000 to 1.000)"))
        for verdict = (verdict-on-all first second)
        do (dolist (text texts) (is (mentions-p verdict text)))))

(test compare.takes-numbers-of-any-size
  (let ((numbers (loop for i below 30 collect (if (< (mod i 10) 3) 1d99 5))))
    (let ((text (verdict-on numbers (make-list 30 :initial-element 5))))
      (is (mentions-p text "x is higher with a than with b: p = .004"))
      (is (mentions-p text "against 5 on average"))))
  (is (mentions-p (verdict-on-all 1.5d308 -1.5d308)
                  "difference 3e308 (95 % interval 3e308 to 3e308)"))
  (is (mentions-p (verdict-on-all 1d15 -1d15) "x is higher with a")))

(test compare.says-how-many-seeds-have-no-number
  (with-made-up (results (append (rows-of-outcomes "a" "0" "++++"
                                                   :way (lambda (seed) (if (evenp seed) "w" 5)))
                                 (rows-of-outcomes "b" "0" "++++" :way 7)))
    (is (mentions-p (third (experiment:comparison-verdicts
                            (experiment:compare-conditions results 1 2 :stream nil)))
                    "over 2 common seeds (2 left out, where a number is missing)"))))
