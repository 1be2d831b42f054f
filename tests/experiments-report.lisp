;;;; experiments-report.lisp -- reports on results: summaries, the printed report, remarks.

(in-package :ars-magna.tests)

(def-suite* experiments-report :in ars-magna)

;;; Made-up tables. A condition is a list (texts row...), a row a list (outcome &key reason
;;; ticks measures error), and the texts are the values of FACTORS.

(defun report-line (factors measures texts trial row)
  (destructuring-bind (outcome &key (reason "") (ticks 100) values (error "")) row
    (basics::one-line
     (experiment::csv-line
      (append (list "made-up" "A1" (format nil "~{~A~^ ~}"
                                           (or (mapcar (lambda (factor text)
                                                         (format nil "~A=~A" factor text))
                                                       factors texts)
                                               '("all"))))
              texts
              (list (princ-to-string trial) (princ-to-string trial) outcome reason
                    (princ-to-string ticks))
              (loop for nil in measures
                    for value = (pop values)
                    collect (cond ((null value) "")
                                  ((stringp value) value)
                                  (t (experiment::value-text value))))
              (list "" error))))))

(defun report-lines (factors measures conditions)
  (cons (format nil "experiment,fingerprint,condition,~{~A,~}seed,trial,outcome,reason,ticks,~
                     ~{~A,~}digest,error"
                factors measures)
        (loop for (texts . rows) in conditions
              append (loop for row in rows
                           for trial from 1
                           collect (report-line factors measures texts trial row)))))

(defun call-with-report (function factors measures conditions)
  (with-directories (directory)
    (write-table directory (report-lines factors measures conditions))
    (funcall function (experiment:read-results directory))))

(defmacro with-report ((results factors measures conditions) &body body)
  "Run BODY with RESULTS bound to those of a table that is made up."
  `(call-with-report (lambda (,results) ,@body) ,factors ,measures ,conditions))

(defun times (count row) (make-list count :initial-element row))

(defun report-text (results)
  (with-output-to-string (out) (experiment:print-results results out)))

(defun text-lines (text)
  (uiop:split-string (string-right-trim '(#\Newline) text) :separator '(#\Newline)))

(defun legible-p (text)
  (every (lambda (line) (and (<= (length line) 100) (string= line (string-right-trim " " line))))
         (text-lines text)))

(defun close-p (a b) (and a b (< (abs (- a b)) 1d-6)))

;;; Summaries.

(defparameter *two-noises*
  `((("0") ,@(times 7 '("success" :ticks 40)) ,@(times 2 '("failure" :reason "lost"))
           ("limit" :ticks 900))
    (("0.5") ("success" :ticks 60) ,@(times 8 '("failure" :reason "stuck"))
             ("error" :error "boom"))))

(test summary.counts-what-became-of-trials
  (with-report (results '("noise") '() *two-noises*)
    (let ((summaries (experiment:summarize-results results)))
      (flet ((all (reader) (mapcar reader summaries)))
        (is (equal '("noise=0" "noise=0.5") (all #'experiment:summary-condition)))
        (is (equal '(("0") ("0.5")) (all #'experiment:summary-texts)))
        (is (equal '(10 10) (all #'experiment:summary-trials)))
        (is (equal '(2 8) (all #'experiment:summary-failures)))
        (is (equal '(1 0) (all #'experiment:summary-limits)))
        (is (equal '(0 1) (all #'experiment:summary-errors)))
        (is (equal '((("lost" . 2)) (("stuck" . 8))) (all #'experiment:summary-reasons)))))))

(test summary.success-is-wilsons-of-all-trials
  (with-report (results '("noise") '() *two-noises*)
    (let ((success (experiment:summary-success (first (experiment:summarize-results results)))))
      (is (= 7/10 (experiment:estimate-value success)))
      (is (< (abs (- .39678d0 (experiment:estimate-low success))) 1d-5))
      (is (< (abs (- .89221d0 (experiment:estimate-high success))) 1d-5)))))

(test summary.ticks-are-those-of-successes
  (with-report (results '("noise") '() *two-noises*)
    (destructuring-bind (calm rough)
        (mapcar #'experiment:summary-ticks (experiment:summarize-results results))
      (is (= 40 (experiment:estimate-value calm) (experiment:estimate-low calm)
             (experiment:estimate-high calm)))
      (is (= 7 (experiment:estimate-count calm)))
      (is (= 60 (experiment:estimate-value rough)))
      (is (null (experiment:estimate-low rough))))))

(test statistics.are-one-form-each
  (with-report (results '("noise") '() *two-noises*)
    (let ((experiment::*statistics* experiment::*statistics*))
      (eval '(experiment::define-statistic :range (numbers confidence)
              (:heading ", range" :beside :median)
              (declare (ignore confidence))
              (- (reduce #'max numbers) (reduce #'min numbers))))
      (is-true (has-words-p (report-text results) "ticks of successes, median"
                            "ticks of successes, range"))
      (is-false (has-words-p (report-text results) "n=")))))

(defun measured-estimates (&rest columns)
  "Return the estimates of measures whose values are COLUMNS, lists of equally many."
  (let ((names (loop for nil in columns for i from 1 collect (format nil "m~D" i))))
    (with-report (results '() names
                          (list (cons '()
                                      (apply #'mapcar (lambda (&rest values)
                                                        (list "success" :values values))
                                             columns))))
      (experiment:summary-measures (first (experiment:summarize-results results))))))

(test measures.are-rates-means-or-texts
  (destructuring-bind (rate mean mixed words nothing)
      (measured-estimates '("TRUE" "FALSE" "TRUE" nil) '(1 2 3.5d0 nil) '(4 "TRUE" 8 "FALSE")
                          '("left" "TRUE" "left" nil) '(nil nil nil nil))
    (is (equal '(:rate :mean :mean :texts :nothing)
               (mapcar #'experiment:estimate-kind (list rate mean mixed words nothing))))
    (is (equal '(3 3 2 3 0)
               (mapcar #'experiment:estimate-count (list rate mean mixed words nothing))))
    (is (= 2/3 (experiment:estimate-value rate)))
    (is (close-p (/ 6.5d0 3) (experiment:estimate-value mean)))
    (is (= 6 (experiment:estimate-value mixed)))
    (is (= 2 (experiment:estimate-left-out mixed)))
    (is (equal '(("left" . 2) ("TRUE" . 1)) (experiment:estimate-texts words)))
    (multiple-value-bind (low high) (ars-magna.statistics:student-interval '(1 2 3.5d0))
      (is (close-p low (experiment:estimate-low mean)))
      (is (close-p high (experiment:estimate-high mean))))))

;;; The report.

(test report.of-a-known-table
  (with-report (results '("noise") '("way")
                        `((("0") ,@(times 6 '("success" :ticks 40 :values (2)))
                                 ,@(times 2 '("failure" :reason "lost" :values (4))))
                          (("0.5") ,@(times 7 '("success" :ticks 1061 :values (3)))
                                   ("error" :error "boom"))))
    (is (equal
         `("made-up: 2 conditions, 8 trials each" ""
           "  noise  success %      errors  ticks of successes, median  way, mean"
           "      0  75 (41 to 93)       0    40 (  40 to   40)         2.500 (1.726 to 3.274)  n=8"
           "    0.5  88 (53 to 98)       1  1061 (1061 to 1061)         3.000 (3.000 to 3.000)  n=7"
           "" "Why trials failed, and how to see one:"
           "  2  lost: noise=0 (2)"
           "     (replay-trial 'made-up \"noise=0\" 7)"
           "" "Errors that ended trials, and how to see one:"
           "  1  boom: noise=0.5 (1)"
           "     (replay-trial 'made-up \"noise=0.5\" 8)"
           ""
           ,(concatenate 'string "In parentheses: 95 % intervals, Wilson's for rates, by ranks for "
                         "medians, Student's for means.")
           "A trial that ended with an error counts as one that did not succeed.")
         (text-lines (report-text results))))))

(test report.returns-the-results-and-writes-where-it-is-told
  (with-report (results '("noise") '() *two-noises*)
    (is (string= (report-text results)
                 (with-output-to-string (*standard-output*)
                   (is (eq results (experiment:print-results results))))))))

(test report.asks-what-the-experiment-asks
  (base:with-own-definitions ()
    (eval '(experiment:defexperiment made-up
            "Is it so? If not, why?

And more."
            (:robots ars-worlds:dot) (:run t)))
    (with-report (results '("noise") '() *two-noises*)
      (is (string= "Is it so?" (second (text-lines (report-text results))))))))

(test report.says-how-many-trials-if-they-differ
  (with-report (results '("noise") '() `((("0") ,@(times 3 '("success"))) (("1") ("success"))))
    (let ((text (report-text results)))
      (is (search "2 conditions, 1 to 3 trials each" text))
      (is (search "noise  trials  success" text)))))

(test report.and-pictures-take-numbers-of-any-size
  (with-report (results '("way") '("x") '((("a") ("success" :values (1.5d308))
                                           ("success" :values (-1.5d308)))
                                          (("b") ("success" :values (1d99))
                                           ("success" :values (5)))))
    (destructuring-bind (wide other)
        (loop for summary in (experiment:summarize-results results)
              collect (first (experiment:summary-measures summary)))
      (is (equal '(:mean 2 0) (list (experiment:estimate-kind wide) (experiment:estimate-count wide)
                                    (experiment:estimate-left-out wide))))
      (is (zerop (experiment:estimate-value wide)))
      (is (< (expt 10 308) (experiment:estimate-high wide)))
      (is (< 4.9d98 (experiment:estimate-value other) 5.1d98)))
    (is (mentions-p (report-text results) "5e98"))
    (with-directories (directory)
      (is-true (experiment:save-result-pictures results directory)))))

(test report.tells-what-is-left-out-and-what-was-outlived
  (with-report (results '() '("way")
                        `((() ("success" :values (1) :error "kicker failed")
                              ("success" :values ("TRUE")) ("success" :values (3)))))
    (let ((text (report-text results)))
      (is (search "way: left out 1 value that is not a number." text))
      (is (search "Errors that did not end their trials" text))
      (is (search "1  kicker failed" text)))))

(test report.is-legible-whatever-there-is
  (flet ((check (factors measures conditions)
           (with-report (results factors measures conditions)
             (let ((text (report-text results)))
               (is (legible-p text) "~A" text)
               text))))
    (check '() '() '((() ("success"))))
    (check '() '() `((() ,@(times 9 '("failure" :reason "lost")))))
    (check '("a") '() `((("1") ,@(times 3 '("error" :error "boom")))))
    (let ((long (make-string 300 :initial-element #\x)))
      (check (list long) (list long)
             `(((,long) ("failure" :reason ,long :values (,long))
                        ("error" :error ,(substitute #\Space #\y (subseq long 0 200)))))))
    (let ((text (check '("one" "two") (loop for i from 1 to 8 collect (format nil "measure-~D" i))
                       (loop for i from 1 to 40
                             collect (list* (list (princ-to-string i) "a value of some length")
                                            (loop for j from 1 to 7
                                                  collect (list "success" :ticks (* i j 1000)
                                                                :values (list 1d6 "TRUE" (* i j)
                                                                              1d-9 "word" (/ j 7d0)
                                                                              nil -3))))))))
      (loop for i from 1 to 8
            do (is (search (format nil "measure-~D" i) text)))
      (loop for i from 1 to 40
            do (is (search (format nil "~2D  a value of some length" i) text))))))

(test report.of-nothing
  (with-report (results '("noise") '() '())
    (is (string= (format nil "There are no trials yet.~%") (report-text results)))
    (is (null (experiment:summarize-results results)))
    (with-directories (pictures)
      (is (null (experiment:save-result-pictures results pictures))))))

(test report.rejects-what-is-no-results
  (signals base:wrong-argument (experiment:print-results 3))
  (signals base:wrong-argument (experiment:summarize-results "nowhere"))
  (with-report (results '() '() '((() ("success"))))
    (signals base:wrong-argument (experiment:print-results results nil))))

(test report.breaks-lines-between-conditions-and-not-in-them
  (let ((way "((1.0 8) (2.5 3.25) (7.75 1.0))"))
    (with-report (results '("way" "noise") '()
                          (loop for noise in '("0" "0.1" "0.25" "0.5" "0.75")
                                collect `((,way ,noise)
                                          ,@(times 9 '("failure" :reason "lost its way")))))
      (let ((text (report-text results)))
        (is (legible-p text))
        (loop for noise in '("0" "0.1" "0.25")
              do (is (search (format nil "way=~A noise=~A (9)" way noise) text)))
        (is (search (format nil "\"way=~A noise=0\"" way) text))))))

(test report.breaks-what-is-longer-than-a-line
  (is (equal '("aaa bbb" "ccc") (base:wrapped-text "aaa bbb ccc" 8)))
  (is (equal '("x," "aaa bbb") (base:wrapped-text
                                (format nil "x, ~A" (experiment::no-break-text "aaa bbb")) 8)))
  (is (equal '("aaa bbb" "ccc") (base:wrapped-text (experiment::no-break-text "aaa bbb ccc") 8)))
  (is (equal '("aaaa" "aa") (base:wrapped-text "aaaaaa" 4))))

;;; Trials added until intervals are narrow.

(test report.has-the-confidence-of-the-last-look
  (define-walk)
  (with-directories (directory)
    (dolist (results (list (walk directory :trials 400 :until 2/10)
                           (experiment:read-results directory)))
      (let ((summary (first (experiment:summarize-results results))))
        (is (< 50 (experiment:summary-trials summary)))
        (is (= (experiment::confidence-at-look
                (experiment::interim-look-number (experiment:summary-trials summary)))
               (experiment:summary-confidence summary)))
        (is (>= 2/10 (- (experiment:estimate-high (experiment:summary-success summary))
                        (experiment:estimate-low (experiment:summary-success summary)))))
        (is (search ".05 / (K (K + 1))" (report-text results)))
        (is (has-words-p (substitute #\Space #\Newline (report-text results))
                         "The K-th look at a condition has a wrong interval with a probability of"
                         "each of these 2 conditions by itself"))
        (is (legible-p (report-text results)))))
    (walk directory :trials 410)
    (let ((summary (first (experiment:summarize-results (experiment:read-results directory)))))
      (is (= .95d0 (experiment:summary-confidence summary))))))

;;; Conditions that are gone.

(test report.sets-apart-what-the-experiment-no-longer-has
  (with-directories (directory)
    (flet ((results (&rest ways)
             (eval `(experiment:defexperiment question (:robots ars-worlds:dot) (:trials 2)
                      (:vary (way ,@ways)) (:run way)))
             (experiment:run-experiment 'question :directory directory :stream nil))
           (text (results)
             (with-output-to-string (out) (experiment:print-results results out))))
      (is (null (search "earlier runs" (text (results 1 5 9)))))
      (loop with now = (results 1 9)
            for results in (list now (experiment:read-results directory))
            for text = (text results)
            do (is (search "question: 2 conditions, 2 trials each; the table also has 1 condition"
                           text))
               (is (search "earlier runs, see" text))
               (is (< (search "1  100 (" text) (search "9  100 (" text)
                      (search "Conditions of earlier runs, which the last run did not have:" text)
                      (search "5  100 (" text)))))))

(test report.tells-of-errors-when-the-experiment-ends
  (define-for-test (:robots ars-worlds:dot)
    (:vary (size 1 2))
    (:run (if (= size 2) (error "Boom.") size)))
  (flet ((said () (with-output-to-string (out)
                    (experiment:run-experiment 'question :trials 2 :stream out))))
    (is-true (has-words-p (said) "2 trials had errors, the first: Boom."))
    (define-for-test (:robots ars-worlds:dot) (:run t))
    (is (not (mentions-p (said) "had errors")))))

(test report.shows-none-as-a-value-of-a-factor
  (define-for-test (:robots ars-worlds:dot) (:vary (way :none :some)) (:run t)
    (:measure (size (identity :none))))
  (with-directories (directory)
    (let ((results (experiment:run-experiment 'question :trials 2 :directory directory
                                                        :stream nil)))
      (is (equal '("way=none" "way=some") (experiment::results-conditions results)))
      (is-true (search (format nil "~%  none  100 (")
                       (with-output-to-string (out) (experiment:print-results results out))))
      (let ((cells (experiment::csv-fields (second (table-lines directory)))))
        (is (equal '("way=none" "none") (subseq cells 2 4)))
        (is (string= "" (nth 9 cells)) "a measure without a value is an empty cell: ~S" cells))
      (is-true (experiment:compare-conditions results :some :none :stream nil)))))
