;;;; experiment-compare-versions.lisp -- two versions of one experiment, as tables and pictures.

(in-package :ars-magna.tests)

(def-suite* experiment-compare-versions :in ars-magna)

(defun compare-tables (before-rows after-rows &rest arguments)
  "Return the comparison of two tables of these rows, and what it says, as text."
  (with-directories (before after)
    (made-up-table before before-rows "A1")
    (made-up-table after after-rows "B2")
    (let ((comparison (apply #'experiment:compare-results before after
                             (append arguments '(:stream nil)))))
      (values comparison
              (with-output-to-string (out) (experiment:print-comparison comparison out))))))

(defun table-of-versions (worse better)
  "Return rows under four conditions, as of a version with so many more failures and successes."
  (append (rows-of-outcomes "a" "0" (repeated #\+ 100))
          (rows-of-outcomes "a" "1" (repeated #\- worse #\+ (- 100 worse)))
          (rows-of-outcomes "b" "0" (repeated #\+ better #\- (- 100 better)))
          (rows-of-outcomes "b" "1" (repeated #\- 4 #\+ (- 94 (floor worse 10))
                                              #\- (+ 2 (floor worse 10))))))

(test compare-results.says-what-got-better-and-worse
  (multiple-value-bind (comparison text)
      (compare-tables (table-of-versions 0 50) (table-of-versions 20 70))
    (is (string= (format nil "Of 4 conditions 1 succeeds more often than before, 1 less often, 1 ~
                              is the same, and 1 not significantly different. Of 400 trials that ~
                              both have, 358 are the same to the last bit.")
                 (first (experiment:comparison-verdicts comparison))))
    (is (equal '(100 80 80 98)
               (mapcar #'experiment:contrast-same (experiment:comparison-contrasts comparison))))
    (is (mentions-p text "plan=a noise=0: dir 1 and dir 0 are the same in all 100 trials"))
    (is (mentions-p (base:one-line text)
                    (format nil "noise=1: dir 1 succeeds less often than dir 0: p < .001 as ~
                                 one of 6 tests, 80 % against 100 %")))
    (is (mentions-p text "plan=b noise=0: dir 1 succeeds more often than dir 0: p < .001"))
    (is (mentions-p text
                    "over all: No significant difference in success between dir 1 and dir 0"))))

(test compare-results.counts-a-seed-once-over-all-conditions
  "Under ten conditions that share their chance, three seeds of thirty got worse: 30 pairs of 300
would be beyond doubt, and three seeds are p = 1/4."
  (flet ((rows (bad)
           (loop for noise below 10
                 append (rows-of-outcomes "a" (princ-to-string noise)
                                          (repeated #\- bad #\+ (- 30 bad))))))
    (let* ((comparison (compare-tables (rows 0) (rows 3) :measure 'success))
           (overall (first (experiment:contrast-differences
                            (first (experiment:comparison-overall comparison))))))
      (is (= 30 (experiment:paired-trials overall)))
      (is (near-p -1/10 (experiment:paired-estimate overall)))
      (is (near-p 1/4 (experiment:paired-p overall)))
      (is (null (experiment:paired-table overall))))))

(test compare-results.knows-identical-runs
  (multiple-value-bind (comparison text)
      (compare-tables (table-of-versions 5 50) (table-of-versions 5 50))
    (is (equal '("All 400 trials that both have are the same to the last bit.")
               (experiment:comparison-verdicts comparison)))
    (is (not (mentions-p text "p =")))))

(test compare-results.tells-runs-apart-by-their-digests
  (flet ((rows (change)
           (cons (list "a" "0" 8 "success" 100 5 change)
                 (rows-of-outcomes "a" "0" "+++" :first 9))))
    (let ((contrast (first (experiment:comparison-contrasts (compare-tables (rows 1) (rows 2))))))
      (is (= 4 (experiment:contrast-trials contrast)))
      (is (= 3 (experiment:contrast-same contrast)))
      (is (= 1 (experiment:paired-p (first (experiment:contrast-differences contrast))))))))

(test compare-results.says-which-conditions-only-one-has
  (multiple-value-bind (comparison text)
      (compare-tables (rows-of-outcomes "a" "0" "++-")
                      (append (rows-of-outcomes "a" "0" "+--+")
                              (rows-of-outcomes "b" "0" "+++")))
    (is (= 1 (length (experiment:comparison-contrasts comparison))))
    (is (mentions-p text "Only one of the tables has the condition plan=b noise=0."))
    (is (mentions-p text "Left out, as one side lacks these seeds: plan=a noise=0: 1 of dir 1."))))

(test compare-results.refuses-what-does-not-belong-together
  (with-directories (before after nothing)
    (made-up-table before (rows-of-outcomes "a" "0" "+++"))
    (made-up-table after (rows-of-outcomes "b" "0" "+++"))
    (signals base:misuse (experiment:compare-results before nothing))
    (signals base:misuse (experiment:compare-results before after))
    (signals base:wrong-argument (experiment:compare-results before 5))
    (write-table after (mapcar (lambda (line) (concatenate 'string "x" line))
                               (table-lines before)))
    (signals error (experiment:compare-results before after))))

(test compare-results.is-for-tables-of-any-run
  "Two runs of one experiment, of which the second has more trials."
  (define-walk)
  (with-directories (before after)
    (walk before :trials 10)
    (walk after :trials 20)
    (let ((comparison (experiment:compare-results before after :stream nil)))
      (is (equal '(10 10) (mapcar #'experiment:contrast-same
                                  (experiment:comparison-contrasts comparison)))))
    (let ((comparison (experiment:compare-levels (experiment:read-results after) 'max-speed*
                                                 :stream nil)))
      (is (equal '("max-speed*=2") (mapcar #'experiment:contrast-first
                                           (experiment:comparison-contrasts comparison))))
      (is (= 20 (experiment:paired-trials (difference-in "way" comparison)))))))

;;; What has changed.

(defun define-ruled (length &key (speed 1))
  "Define the experiment RULED, whose trials succeed if they come so far."
  (eval `(experiment:defexperiment ruled
           (:robots ars-worlds:dot)
           (:parameters (base:max-speed* ,speed))
           (:vary (steps 3 4))
           (:run (command:robot-go-forward ars-worlds:dot steps) (run:run-ticks 5))
           (:success (< ,length (robot:robot-x ars-worlds:dot))))))

(defun ruled-against (first-arguments second-arguments)
  "Return what is said of RULED, run as it is defined by these arguments in turn."
  (base:with-own-definitions ()
    (with-directories (before after)
      (loop for arguments in (list first-arguments second-arguments)
            for directory in (list before after)
            do (apply #'define-ruled arguments)
               (experiment:run-experiment 'ruled :directory directory :stream nil :trials 5
                                                 :workers 1))
      (let ((comparison (experiment:compare-results before after :stream nil)))
        (values (format nil "~{~A~%~}" (experiment:comparison-changes comparison))
                (with-output-to-string (out) (experiment:print-comparison comparison out)))))))

(test compare-results.warns-that-the-ruler-has-changed
  (multiple-value-bind (changes text) (ruled-against '(4) '(5))
    (is (eql 0 (search "WARNING: the experiment itself is not the same" changes)))
    (is (mentions-p text "WARNING: the experiment itself is not the same"))
    (is (has-words-p (substitute #\Space #\No-break_space changes)
                     "before: (:success (< 4 (" "now: (:success (< 5 ("))
    (is (mentions-p changes "between the tables, under 2 conditions: experiment ruled."))
    (is (not (mentions-p changes "(:vary")))))

(test compare-results.says-what-else-has-changed
  (let ((changes (ruled-against '(4) '(4 :speed 2))))
    (is (mentions-p changes "the parameters, robots or values of conditions")))
  (is (string= (format nil "Both tables are of the same code and configuration: the fingerprints ~
                            are equal.~%")
               (ruled-against '(4) '(4))))
  (is (mentions-p (nth-value 1 (compare-tables (rows-of-outcomes "a" "0" "++-")
                                               (rows-of-outcomes "a" "0" "+-+")))
                  "What differs between the tables is not known")))

(test compare-results.warns-of-rows-that-no-fingerprint-explains
  (with-directories (before after)
    (made-up-table before (rows-of-outcomes "a" "0" "++-") "A1")
    (made-up-table after (rows-of-outcomes "a" "0" "+-+") "A1")
    (is (mentions-p (format nil "~{~A~}" (experiment:comparison-changes
                                          (experiment:compare-results before after :stream nil)))
                    "nevertheless the rows of 2 trials differ"))))

;;; Pictures.

(test comparison-picture.shows-each-pair
  (with-made-up (results (append (four-plans "0") (four-plans "0.5")))
    (let ((comparison (experiment:compare-levels results 'plan :stream nil)))
      (uiop:with-temporary-file (:pathname file :type "svg")
        (is (equal (truename file) (experiment:save-comparison-picture comparison file)))
        (let ((text (base:file-text file)))
          (is (mentions-p text "b against a"))
          (is (mentions-p text "difference in success, in percentage points"))
          (is (mentions-p text "-10"))))
      (signals base:unknown-name
        (experiment:save-comparison-picture comparison "x.svg" :measure 'weight))
      (signals base:wrong-argument (experiment:save-comparison-picture 5 "x.svg")))))
