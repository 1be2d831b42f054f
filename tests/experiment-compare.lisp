;;;; experiment-compare.lisp -- conditions and versions side by side, seed by seed.

(in-package :ars-magna.tests)

(def-suite* experiment-compare :in ars-magna)

;;; Tables that are made up. A row is a list (plan noise seed outcome ticks way digest); the
;;; number of the trial is the seed less 7.

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
      (is (mentions-p way (format nil "No difference in way between patrol and spiral can be told: ~
                                       p = 1 as one of 4 tests, 4.00 against")))
      (is (mentions-p way "; if there is one, it is at most 0.14."))
      (is (mentions-p found "found is true more often with patrol than with spiral")))))

(test compare.says-what-is-equal-seed-by-seed
  (with-made-up (results (append (rows-of-outcomes "a" "0" "+++-" :way #'identity)
                                 (rows-of-outcomes "b" "0" "++-+" :way #'identity)))
    (is (string= (format nil "noise=0: way of a and b is equal, seed by seed: 9.500 against 9.500 ~
                              on average over 4 common seeds.")
                 (third (experiment:comparison-verdicts
                         (experiment:compare-conditions results 1 2 :stream nil)))))))

;;; Numbers that are near each other, and very large and small ones.

(defun mentions-all-p (text &rest words)
  (every (lambda (word) (mentions-p text word)) words))

(defun told-of-means (function)
  "Return what a comparison says of a measure that FUNCTION gives for a seed and 1 or 2."
  (let ((difference (experiment::mean-difference
                     "x"
                     (loop for seed from 1 to 12 collect (funcall function seed 1))
                     (loop for seed from 1 to 12 collect (funcall function seed 2)))))
    (experiment::adjust-for-all (list difference))
    (experiment::verdict difference (experiment::make-contrast "" "one" "two"))))

(test compare.calls-equal-only-what-is
  (flet ((told (base step)
           (told-of-means (lambda (seed way) (declare (ignore seed)) (+ base (* way step))))))
    (is (mentions-all-p (told 4d9 1d-3) "x is less with one than with two" "4000000000.001"
                    "4000000000.002"))
    (let ((text (told 1 1d-15)))
      (is (mentions-all-p text "differs by no more than rounding may, at most 8.88178"
                          "1.000000000000001" "1.000000000000002"))
      (is (not (mentions-p text "equal"))))
    (is (mentions-all-p (told 5 0) "is equal, seed by seed"))))

(test compare.shows-small-differences
  (is (mentions-all-p (told-of-means (lambda (seed way) (* 1d-300 (+ seed way))))
                  "7.500e-300 against 8.500e-300" "difference -1.000e-300"))
  (is (mentions-all-p (told-of-means (lambda (seed way) (+ 1 (* way 1d-9 (+ 1 (/ seed 1d6))))))
                  "1.000000001" "1.000000002")))

(test compare.tells-of-numbers-that-are-too-large
  (let ((difference (experiment::difference-of-values "x" '(1d99 5 5) '(5 5 5))))
    (is (mentions-all-p (experiment::verdict difference (experiment::make-contrast "" "one" "two"))
                        "x of one and two cannot be compared: under 1 of 3 common seeds it is "
                        "beyond 1e15" ":none"))))

(test tables.have-decimal-numbers-whatever-a-trial-sets
  (let ((*print-base* 16) (*print-radix* t))
    (is (equal '("17" "-255" "[17, 1]" "100")
               (mapcar #'experiment::value-text '(17 -255 (17 1) 100))))))

(test compare.is-the-same-the-other-way-round
  (with-made-up (results (patrol-and-spiral))
    (let ((one (difference-in "success" (experiment:compare-conditions results 1 2 :stream nil)))
          (other (difference-in "success" (experiment:compare-conditions results 2 1 :stream nil))))
      (is (= (experiment:paired-p one) (experiment:paired-p other)))
      (is (near-p (experiment:paired-low one) (- (experiment:paired-high other))))
      (is (mentions-p (first (experiment:comparison-verdicts
                              (experiment:compare-conditions results 2 1 :stream nil)))
                      "spiral succeeds less often than patrol")))))

(test compare.counts-common-seeds-and-errors-as-it-says
  (with-made-up (results (append (rows-of-outcomes "a" "0" "!+++-" :first 8)
                                 (rows-of-outcomes "b" "0" "!!--+" :first 10)))
    (let* ((text (with-output-to-string (out)
                   (experiment:compare-conditions results 1 2 :stream out)))
           (success (difference-in "success"
                                   (experiment:compare-conditions results 1 2 :stream nil))))
      (is (equal '(0 2 0 1) (experiment:paired-table success)))
      (is (mentions-p text "Left out, as only one has their seeds: noise=0: 2 of a and 2 of b."))
      (is (mentions-p text "with an error, and counted as not succeeded: noise=0: 2 of b."))
      (is (mentions-p text "way of a and b cannot be compared: over 1 common seed.")))))

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
      (is (mentions-p (first-verdict :all) "No difference in success between a and b can be told"))
      (is (mentions-p (first-verdict :all) "told: p = .062 as one of 2 tests (.031 alone), 100 %"))
      (is (mentions-p (first-verdict :all) "where 2 are tested, one that leaves out 0 is no proof"))
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
        (ars-magna.experiment::adjust-for-all differences)
        differences))))

(test compare.tells-a-plain-difference-among-hundreds-of-tests
  (let ((differences (measured-differences 600 1000 22)))
    (is (< (experiment:paired-adjusted-p (first differences)) .001))
    (is (notany #'ars-magna.experiment::told-difference-p (rest differences)))))

(defun doubts-of (count trials)
  (ars-magna.experiment::doubt-words (first (measured-differences count 1000 trials))))

(test compare.says-how-many-seeds-so-many-tests-need
  (is (mentions-p (doubts-of 60 8) (format nil "over 8 seeds p cannot be below .008, too much for ~
                                                60 tests: run 12 or more, or compare fewer")))
  (is (mentions-p (doubts-of 1 5) "over 5 seeds p cannot be below .063: run 6 or more")))

(test compare.explains-a-p-above-the-level-beside-an-interval-without-0
  (is (mentions-p (doubts-of 1 5)
                  "the interval leaves out 0, but it is an approximation, and p is above .05")))

(test compare.calls-no-bound-certain
  (with-made-up (results (patrol-and-spiral))
    (is (mentions-p (third (experiment:comparison-verdicts
                            (experiment:compare-conditions results 1 2 :stream nil)))
                    "at most 0.14. This bound is right about 95 times in 100."))))

(test compare.takes-for-equal-only-what-rounding-parts
  "Whole numbers are what they are, however large; floats, but for their last digits."
  (flet ((means (firsts seconds)
           (let ((difference (experiment::mean-difference "x" firsts seconds)))
             (list (experiment::paired-same-p difference)
                   (experiment::paired-first difference)
                   (experiment::paired-second difference)))))
    (is (equalp '(nil 1700000010 1700000000)
                (means (make-list 30 :initial-element 1700000010)
                       (make-list 30 :initial-element 1700000000))))
    (is-false (first (means '(1d9 2d9) '(1000000000.5d0 2000000000.25d0))))
    (is-true (first (means (list (+ .1d0 .2d0 .3d0) 1) (list (+ .3d0 .2d0 .1d0) 1))))))
