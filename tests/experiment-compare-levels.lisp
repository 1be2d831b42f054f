;;;; experiment-compare-levels.lisp -- values of one factor, all else equal, and over all.

(in-package :ars-magna.tests)

(def-suite* experiment-compare-levels :in ars-magna)

(defun contests (comparison)
  "Return what COMPARISON compares with what, and where."
  (mapcar (lambda (contrast)
            (list (experiment:contrast-where contrast) (experiment:contrast-first contrast)
                  (experiment:contrast-second contrast)))
          (experiment:comparison-contrasts comparison)))

(test compare-levels.keeps-all-else-equal
  (with-made-up (results (append (four-plans "0") (four-plans "0.5")))
    (flet ((contrasts (&rest arguments)
             (mapcar (lambda (contrast)
                       (list (experiment:contrast-where contrast)
                             (experiment:contrast-first contrast)
                             (experiment:contrast-second contrast)))
                     (experiment:comparison-contrasts
                      (apply #'experiment:compare-levels results
                             (append arguments '(:stream nil)))))))
      (is (equal '(("noise=0" "a" "c") ("noise=0" "b" "c") ("noise=0" "d" "c")
                   ("noise=0.5" "a" "c") ("noise=0.5" "b" "c") ("noise=0.5" "d" "c"))
                 (contrasts 'plan :against 'c)))
      (is (equal '("plan=a" "noise=0.5" "noise=0") (first (contrasts "noise"))))
      (signals base:unknown-name (contrasts 'plan :against 'e)))))

(test compare-levels.takes-named-conditions-whatever-they-decide
  (with-report (results '("case" "noise") '()
                        `((("calm" "0") ,@(times 9 '("success")))
                          (("rough" "0.2") ,@(times 9 '("failure")))
                          (("wild" "0.5") ,@(times 9 '("failure")))))
    (is (equal '((nil "rough" "calm") (nil "wild" "calm"))
               (contests (experiment:compare-levels results 'case :stream nil))))
    (is (equal '((nil "noise=0" "noise=0.2") (nil "noise=0.5" "noise=0.2"))
               (contests (experiment:compare-levels results 'noise :against 0.2d0 :stream nil))))
    (is (equal '((nil "rough" "wild"))
               (contests (experiment:compare-conditions results 'rough "0.5" :stream nil))))))

;;; Over all.

(defun six-noises ()
  "Return rows of two plans under six noises. Under each, `new' succeeds in three seeds more than
`old', always in others: 3 pairs are p = 1/4, and 18 seeds beyond doubt."
  (loop for noise below 6
        for name = (princ-to-string noise)
        append (rows-of-outcomes "old" name
                                 (repeated #\+ (* 3 noise) #\- 3 #\+ (- 27 (* 3 noise))))
        append (rows-of-outcomes "new" name (repeated #\+ 30)
                                 :ticks (lambda (seed) (+ 90 (mod seed 5))))))

(defun only-overall (comparison)
  (let ((overall (experiment:comparison-overall comparison)))
    (is (= 1 (length overall)))
    (first overall)))

(test compare-levels.tells-over-all-what-no-condition-tells
  (with-made-up (results (six-noises))
    (let* ((comparison (experiment:compare-levels results 'plan :measure 'success :stream nil))
           (overall (only-overall comparison))
           (success (first (experiment:contrast-differences overall)))
           (verdicts (experiment:comparison-verdicts comparison)))
      (is (= 7 (length verdicts)))
      (loop for verdict in (rest verdicts)
            do (is (mentions-p verdict "No significant difference in success between new and old")))
      (is (equal '("new" "old" 30) (list (experiment:contrast-first overall)
                                         (experiment:contrast-second overall)
                                         (experiment:contrast-trials overall))))
      (is (near-p (expt 2 -17) (experiment:paired-p success)))
      (is (near-p (expt 2 -17) (experiment:paired-adjusted-p success)))
      (is (near-p 1/10 (experiment:paired-estimate success)))
      (is (mentions-p (first verdicts) "over all: new succeeds more often than old: p < ."))
      (is (mentions-p (with-output-to-string (out) (experiment:print-comparison comparison out))
                      "each seed counts once, with its mean over the conditions")))))

(test compare-levels.means-over-all-are-of-the-same-conditions-on-both-sides
  (with-made-up (results (six-noises))
    (let* ((overall (only-overall (experiment:compare-levels results 'plan :stream nil)))
           (ticks (experiment::find-difference "ticks" overall)))
      (is (equal '("success" "ticks" "way" "found")
                 (mapcar #'experiment:paired-measure (experiment:contrast-differences overall))))
      (is (= 30 (experiment:paired-trials ticks)))
      (is (= 100 (experiment:paired-second ticks)))
      (is (near-p -8 (experiment:paired-estimate ticks))))))

(test compare-levels.counts-over-all-only-seeds-that-all-conditions-have
  (with-made-up (results (append (rows-of-outcomes "a" "0" "++++" :first 8)
                                 (rows-of-outcomes "a" "1" "++++" :first 10)
                                 (rows-of-outcomes "b" "0" "-+-+" :first 8)
                                 (rows-of-outcomes "b" "1" "++++" :first 10)))
    (let* ((overall (only-overall (experiment:compare-levels results 'plan :stream nil)))
           (success (first (experiment:contrast-differences overall))))
      (is (= 2 (experiment:contrast-trials overall) (experiment:paired-trials success)))
      (is (= 3/4 (experiment:paired-first success)))
      (is (= 1 (experiment:paired-second success))))))

(test compare-levels.says-nothing-over-one-condition
  (with-made-up (results (four-plans "0"))
    (is (null (experiment:comparison-overall
               (experiment:compare-levels results 'plan :stream nil))))))

;;; Words.

(test compare.takes-two-values-of-what-varies
  (with-made-up (results (append (four-plans "0") (four-plans "0.5")))
    (flet ((compared (&rest arguments)
             (apply #'experiment:compare-conditions results (append arguments '(:stream nil)))))
      (let ((comparison (compared 'c "plan=A")))
        (is (equal '(("noise=0" "c" "a") ("noise=0.5" "c" "a")) (contests comparison)))
        (is (equal '("c" "a") (let ((overall (only-overall comparison)))
                                (list (experiment:contrast-first overall)
                                      (experiment:contrast-second overall))))))
      (is (equal '(("plan=a" "noise=0.5" "noise=0"))
                 (list (first (contests (compared "=0.5" 0))))))
      (is (equal '("b" "c" "d" "b" "c" "d")
                 (mapcar #'third (sort (contests (compared "a" :all)) #'string< :key #'first))))
      (is (= 3 (length (experiment:comparison-overall (compared "a" :all))))))))

(test compare.says-what-a-word-could-be
  (flet ((said (results first second)
           (handler-case (progn (experiment:compare-conditions results first second :stream nil)
                                "nothing")
             (base:misuse (condition) (princ-to-string condition)))))
    (with-made-up (results (append (four-plans "0") (four-plans "0.5")))
      (is (mentions-p (said results 'a 1)
                      "A is ambiguous: it could be plan=a noise=0 or plan=a noise=0.5."))
      (is (mentions-p (said results 'a "0.5") "A is ambiguous"))
      (is (mentions-p (said results 'noise 1) "or one of 2 others"))
      (is (mentions-p (said results 'a 'a) "ambiguous")))
    (with-report (results '("noise" "kick") '() (grid '("0" "1") '("0" "1")))
      (is (mentions-p (said results "=0" 0) "=0 is ambiguous"))
      (is (mentions-p (said results "0" '1/1) "ambiguous"))
      (is (mentions-p (said results "kick=0" "noise=1") "kick=0 is ambiguous"))
      (is (string= "nothing" (said results "kick=0" "kick=1"))))))

;; Whole numbers are conditions by number, or values; never one of the one and one of the other.
(test compare.asks-whether-a-number-is-a-value
  (flet ((grown (&rest sizes)
           (loop for size in sizes
                 collect `((,(princ-to-string size)) ,@(times 9 '("success")))))
         (said (results first second)
           (handler-case (contests (experiment:compare-conditions results first second :stream nil))
             (base:misuse (condition) (princ-to-string condition)))))
    (with-report (results '("metres") '() (grown 2 4 8))
      (is (equal '((nil "metres=4" "metres=2")) (said results 4 2)) "there is no fourth condition"))
    (with-report (results '("metres") '() (grown 1 2))
      (is (equal '((nil "metres=1" "metres=2")) (said results 1 2)) "that is the same"))
    (with-report (results '("metres") '() (grown 3 2 1))
      (is (mentions-p (said results 1 2) "1 against 2 is ambiguous"))
      (is (mentions-p (said results 1 2) "metres=1 against metres=2. Give a value")))))

;;; What stands above.

(test comparison.asks-what-the-experiment-asks-and-names-both
  (base:with-own-definitions ()
    (eval '(experiment:defexperiment search "Which way is better? We wonder."
            (:robots ars-worlds:dot) (:run t)))
    (with-made-up (results (append (four-plans "0") (four-plans "0.5")))
      (let ((lines (text-lines (with-output-to-string (out)
                                 (experiment:compare-conditions results 'b 'a :stream out)))))
        (is (string= "The experiment search, seed by seed: b against a." (first lines)))
        (is (string= "Which way is better?" (second lines))))
      (uiop:with-temporary-file (:pathname file :type "svg")
        (experiment:save-comparison-picture
         (experiment:compare-conditions results 'b 'a :stream nil) file)
        (let ((words (format nil "~{~A ~}" (chart-texts (base:file-text file)))))
          (is (mentions-p words "Which way is better? b against a, seed by seed"))
          (is (mentions-p words "noise=0.5"))
          (is (not (mentions-p words "noise=0.5: b against a")))))
      (is (string= "each plan against a"
                   (experiment::comparison-sides
                    (experiment:compare-levels results 'plan :stream nil)))))))
