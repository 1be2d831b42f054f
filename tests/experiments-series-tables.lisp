;;;; experiments-series-tables.lisp -- the table of :each-tick is the same however it is made.

(in-package :ars-magna.tests)

(in-suite experiments-series)

;;; What stands there.

(test series.are-a-tidy-table
  (define-recorded-walk)
  (with-directories (directory)
    (walk directory :trials 3)
    (let ((lines (series-lines directory)))
      (is (equal '("experiment" "fingerprint" "condition" "max-speed*" "mark" "seed" "trial" "tick"
                   "x" "phase" "what" "rolled" "chance")
                 (experiment::csv-fields (first lines))))
      (is (= (+ 1 (* 4 3 9)) (length lines)))
      (is-true (search ",driving,'=a," (third lines)))
      (is (equal (loop for condition in '("1" "2")
                       append (loop for mark in '("=a" "b")
                                    append (loop for trial in '("1" "2" "3")
                                                 append (loop for tick to 8
                                                              collect (list condition mark trial
                                                                            (princ-to-string
                                                                             tick))))))
                 (loop for line in (rest lines)
                       for texts = (experiment::csv-fields line)
                       collect (list (nth 3 texts) (nth 4 texts) (nth 6 texts) (nth 7 texts))))))))

(test series.are-the-same-however-they-came-about
  (define-recorded-walk)
  (with-directories (whole two parts a b merged)
    (walk whole)
    (walk two :workers 2)
    (is-true (same-tables-p whole two))
    (walk parts :trials 7)
    (walk parts :trials 3)
    (walk parts :workers 2)
    (is-true (same-tables-p whole parts))
    (walk a :shard '(0 . 2))
    (walk b :shard '(1 . 2))
    (experiment:merge-results (list b a whole) :to merged)
    (is-true (same-tables-p whole merged))
    (walk merged)
    (is-true (same-tables-p whole merged))))

(test series.that-were-cut-anywhere-become-whole
  "A process that is killed leaves a part of a trial's lines without its row."
  (define-recorded-walk)
  (with-directories (whole broken)
    (walk whole :trials 3)
    (let ((rows (table-lines whole)) (lines (series-lines whole)) (dice (base:make-dice 12)))
      (loop repeat 6
            for count = (base:roll-index 12 dice)
            for cut = (base:roll-index 9 dice)
            for end = (+ 1 (* 9 count) cut)
            do (walk broken :trials 1)
               (write-table broken (subseq rows 0 (1+ count)))
               (write-series broken (append (subseq lines 0 end)
                                            (list (subseq (nth end lines) 0
                                                          (base:roll-index
                                                           (length (nth end lines)) dice))))
                             :end "")
               (walk broken :trials 3)
               (is-true (same-tables-p whole broken) "~D lines" end)
               (uiop:delete-directory-tree (uiop:ensure-directory-pathname broken)
                                           :validate t)))))

(test series.of-trials-without-a-row-are-dropped
  (define-recorded-walk)
  (with-directories (one two)
    (walk one :trials 1)
    (walk two :trials 2)
    (let ((before (series-text one)))
      (write-series one (series-lines two))
      (walk one :trials 1)
      (is (string= before (series-text one))))))

(test series.that-are-missing-are-recorded-again
  (define-recorded-walk)
  (with-directories (whole broken merged)
    (walk whole :trials 3)
    (let ((lines (series-lines whole)))
      (loop for left in (list nil (list (first lines)) (remove (nth 20 lines) lines)
                              (reverse lines) (subseq lines 0 40))
            do (walk broken :trials 3)
               (if (and left (string= (first left) (first lines)))
                   (write-series broken left)
                   (delete-file (series-path broken)))
               (walk broken :trials 3)
               (is-true (same-tables-p whole broken)))
      (write-series broken (butlast lines))
      (signals base:misuse (experiment:merge-results (list broken) :to merged))
      (is-false (probe-file (rows-path merged)))
      (is-false (probe-file (series-path merged)))
      (experiment:merge-results (list broken whole) :to merged)
      (is-true (same-tables-p whole merged)))))

(test series.of-shards-that-are-missing-make-the-shard-missing
  (define-recorded-walk)
  (with-directories (directory)
    (let ((shard (experiment:shard-directory directory 1 2)))
      (walk shard :trials 4 :shard '(1 . 2))
      (flet ((missing ()
               (experiment:missing-shards (experiment:find-experiment 'walk) 4 2 directory)))
        (is (equal '(0) (missing)))
        (write-series shard (butlast (series-lines shard)))
        (is (equal '(0 1) (missing)))))))

(test series.that-differ-are-refused
  (define-recorded-walk)
  (with-directories (whole other merged)
    (walk whole :trials 2)
    (walk other :trials 2)
    (let ((lines (series-lines whole)))
      (write-series other (substitute (changed-cell (nth 5 lines) 8 "77") (nth 5 lines) lines
                                      :test #'string=))
      (signals experiment:damaged-table (experiment:merge-results (list whole other) :to merged))
      (is-false (probe-file (rows-path merged)))
      (write-series other (list* (first lines) (changed-cell (nth 1 lines) 8 "77") (rest lines)))
      (signals experiment:damaged-table (walk other :trials 2)))))

(test series.that-come-out-otherwise-are-refused
  (define-recorded-walk '(:each-tick (what mark) (count (incf (get 'walks :count 0)))))
  (setf (get 'walks :count) 0)
  (with-directories (directory)
    (signals base:misuse (walk directory :trials 2))
    (handler-case (progn (walk directory :trials 3) (fail "they were not"))
      (base:misuse (condition) (is-true (search "its series" (princ-to-string condition)))))))

(test series.that-cannot-be-are-told
  (define-recorded-walk)
  (with-directories (directory merged)
    (walk directory :trials 2)
    (let ((lines (series-lines directory)))
      (flet ((told-p (lines words)
               (write-series directory lines)
               (dolist (use (list (lambda () (walk directory :trials 2))
                                  (lambda ()
                                    (experiment:merge-results (list directory) :to merged))))
                 (handler-case (progn (funcall use) (fail "~A was taken" words))
                   (experiment:damaged-table (condition)
                     (is (search words (princ-to-string condition)) "~A" condition))))))
        (dolist (damaged (list "" "x" "walk,a,b" (format nil "~A,1" (nth 3 lines))
                               (changed-cell (nth 3 lines) 7 "-1")
                               (changed-cell (nth 3 lines) 6 "0")
                               (changed-cell (nth 3 lines) 1 "no")))
          (told-p (append (subseq lines 0 3) (list damaged) (nthcdr 4 lines)) "line 4"))
        (told-p (cons "a,b,c" (rest lines)) "line 1")
        (told-p (cons (format nil "~A,more" (first lines)) (rest lines)) "line ")))))

(test series.of-timeouts-are-left-out
  (define-for-test (:robots ars-worlds:dot) (:trials 1) (:vary (hang nil t))
    (:run (run:run-ticks 3) (loop while hang do (ignore-errors (loop))) t)
    (:each-tick (a 1)))
  (with-directories (directory)
    (let ((rows (timed-outcomes directory :workers 2 :time-limit 1)))
      (is (equal '("success" "timeout") (mapcar #'first rows)))
      (is (= 5 (length (series-lines directory))))
      (is (equal rows (timed-outcomes directory)))
      (is (null (experiment:trial-series directory 2 1))))))

(test series.of-a-form-that-never-returns-are-ended
  (define-for-test (:robots ars-worlds:dot) (:trials 1) (:run (run:run-ticks 3) t)
    (:each-tick (a (when (= 2 (run:simulation-tick)) (loop)))))
  (with-directories (directory)
    (is (equal '(("timeout" "" :none "")) (timed-outcomes directory :workers 1 :time-limit 1)))
    (is (= 1 (length (series-lines directory))))))

(test series.that-nothing-recorded-are-not-asked-for
  "What an experiment has left that had the clause before."
  (define-recorded-walk)
  (with-directories (directory merged)
    (walk directory :trials 2)
    (delete-file (rows-path directory))
    (define-recorded-walk '(:until mark))
    (walk directory :trials 2)
    (experiment:merge-results (list directory) :to merged)
    (is (string= (table-text directory) (table-text merged)))
    (is (= 1 (length (series-lines merged))))))

(test series.have-a-plain-file
  (define-recorded-walk)
  (with-directories (directory)
    (walk directory :trials 2)
    (delete-file (series-path directory))
    (make-odd-file :pipe (series-path directory))
    (dolist (use (list (lambda () (walk directory :trials 2))
                       (lambda () (experiment:trial-series directory 1 1))
                       (lambda () (experiment:merge-results (list directory)))))
      (signals experiment:damaged-table (funcall use)))))

;;; Reading it.

(test series.are-read-by-trial
  (define-recorded-walk)
  (with-directories (directory)
    (let ((results (walk directory :trials 2)))
      (dolist (designator (list results directory 'walk))
        (is (equal (getf (experiment:replay-trial 'walk 3 2) :series)
                   (let ((*print-base* 2)) (experiment:trial-series designator 3 2)))))
      (destructuring-bind (tick x phase what rolled chance)
          (first (last (experiment:trial-series results 1 1)))
        (is (= 8 tick))
        (is-true (floatp x))
        (is (equal '("waiting" "=a") (list phase what)))
        (is (typep rolled '(integer 0 999)))
        (is (typep chance 'boolean)))
      (signals base:unknown-name (experiment:trial-series results 9 1))
      (signals base:misuse (experiment:trial-series results 1 3))
      (signals base:wrong-argument (experiment:trial-series results 1 "one"))
      (write-series directory (butlast (series-lines directory)))
      (signals base:misuse (experiment:trial-series results 4 2))
      (delete-file (series-path directory))
      (signals base:misuse (experiment:trial-series results 1 1))))
  (signals base:misuse (experiment:trial-series (walk nil :trials 1) 1 1)))

(test series.are-there-as-far-as-a-replay-goes
  (define-recorded-walk)
  (is (equal '(0 1 2 3)
             (column-at 0 (getf (experiment:replay-trial 'walk 1 1 :until 3) :series))))
  (is (null (getf (experiment:replay-trial 'trying "well" 1) :series))))
