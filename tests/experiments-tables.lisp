;;;; experiments-tables.lisp -- the tables of experiments are the same however they are made.

(in-package :ars-magna.tests)

(def-suite* experiments-tables :in ars-magna)

;;; A small experiment, and directories that are gone after each test.

(defun define-walk (&key (speeds '(1 2)) (measure '(way (robot:robot-x ars-worlds:dot))))
  "Define the experiment WALK: one condition for each of SPEEDS."
  (eval `(experiment:defexperiment walk
           (:robots ars-worlds:dot)
           (:vary (base:max-speed* ,@speeds))
           (:run (command:robot-go-forward ars-worlds:dot 3) (run:run-ticks 5) (chance-p 2/3))
           (:measure ,measure (wet (chance-p 1/2))))))

(defun chance-p (probability)
  (base:chance probability (world:world-dice world:*world* :user)))

(defun call-with-directories (function count)
  "Call FUNCTION with the names of COUNT directories that are not there yet."
  (let ((root (uiop:ensure-directory-pathname
               (uiop:tmpize-pathname (uiop:subpathname (uiop:temporary-directory) "tables")))))
    (uiop:delete-file-if-exists (string-right-trim "/" (namestring root)))
    (unwind-protect
         (apply function (loop for i below count
                               collect (format nil "~Adir ~D/" (namestring root) i)))
      (uiop:delete-directory-tree root :validate t :if-does-not-exist :ignore))))

(defmacro with-directories ((&rest names) &body body)
  `(call-with-directories (lambda ,names ,@body) ,(length names)))

(defun walk (directory &rest options)
  (apply #'experiment:run-experiment 'walk :directory directory :stream nil
         (append options '(:trials 20 :workers 1))))

(defun rows-path (directory)
  (uiop:subpathname directory "rows.csv"))

(defun table-text (directory)
  (base:file-text (rows-path directory)))

(defun table-lines (directory)
  (file-lines (rows-path directory)))

(defun write-table (directory lines &key (end (string #\Newline)))
  "Let the table in DIRECTORY have LINES, with END after the last one."
  (ensure-directories-exist directory)
  (with-open-file (out (rows-path directory) :direction :output :if-exists :supersede
                                             :external-format :utf-8)
    (format out "~{~A~^~%~}~A" lines end)))

;;; What stands there.

(test tables.have-a-row-for-each-trial-in-order
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 12)
    (let ((lines (table-lines directory)))
      (is (equal '("experiment" "fingerprint" "condition" "max-speed*" "seed" "trial" "outcome"
                   "reason" "ticks" "way" "wet" "digest" "error")
                 (experiment::csv-fields (first lines))))
      (is (= 25 (length lines)))
      (loop for line in (rest lines)
            for texts = (experiment::csv-fields line)
            for index from 0
            do (is (= 13 (length texts)))
               (is (equal (list "walk" (if (< index 12) "max-speed*=1" "max-speed*=2"))
                          (list (first texts) (third texts))))
               (is (string= (princ-to-string (1+ (mod index 12))) (sixth texts)))
               (is-true (member (nth 10 texts) '("TRUE" "FALSE") :test #'string=))
               (is (= 16 (length (nth 11 texts))))))))

(test tables.keep-what-differs-from-run-to-run-elsewhere
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 3)
    (let ((lines (file-lines (uiop:subpathname directory "machine.csv"))))
      (is (= 7 (length lines)))
      (is (= 8 (length (experiment::csv-fields (second lines))))))
    (let ((text (base:file-text (uiop:subpathname directory "experiment.txt"))))
      (is (search "(run-experiment 'walk :trials 3" text))
      (is (search "defexperiment walk" text))
      (is (search "simulator" text)))))

(test values.stand-as-others-read-them
  (is (equal '("TRUE" "FALSE" "" "7" "0.5" "0.1" "1.5e20" "-1.0e-7" "red" "a (b) \"c\""
               "[1, \"a\"]")
             (mapcar #'experiment::value-text
                     '(t nil :none 7 1/2 0.1 1.5d20 -1d-7 world:red "a (b)
 \"c\"" (1 a)))))
  (is (string= "a thing #<X >" (experiment::plain-text "a thing #<X {10042BD5D3}>")))
  (is (string= "{fed} {12345678" (experiment::plain-text "{fed} {12345678"))))

(test values.come-back-from-texts
  (dolist (value '(0 -7 123456789012345678901234567890 0.1d0 -1d-7 1.5d20 1d100))
    (is (eql value (experiment::number-from-text (experiment::value-text value)))))
  (dolist (text '("" "-" "1-2" "e" "1e" "#.(quit)" "1 2" "red" "1.2.3" "--1" "+" "1e5e5" "e1"
                  "-e1" "E+7" ".e1" "."))
    (is (null (experiment::number-from-text text)) "~S" text)))

(test lines.with-quotes-and-commas-come-back
  (let ((texts '("a,b" "\"" "" "c \"d\", e" "ü")))
    (is (equal texts (experiment::csv-fields
                      (string-right-trim '(#\Newline) (experiment::csv-line texts)))))))

;;; The same however it came about.

(test tables.are-the-same-from-any-number-of-workers
  (define-walk)
  (with-directories (one two five)
    (walk one)
    (walk two :workers 2)
    (walk five :workers 5)
    (is (string= (table-text one) (table-text two)))
    (is (string= (table-text one) (table-text five)))))

(test tables.are-the-same-from-shards
  (define-walk)
  (with-directories (whole a b c merged)
    (walk whole)
    (loop for (directory index) in `((,a 0) (,b 1) (,c 2))
          do (walk directory :shard (cons index 3)))
    (experiment:merge-results (list c a b) :to merged)
    (is (string= (table-text whole) (table-text merged)))
    (is (= 41 (length (table-lines merged))))))

(test tables.are-gone-on-with
  (define-walk)
  (with-directories (whole parts)
    (walk whole)
    (walk parts :trials 7)
    (walk parts :trials 3)
    (is (= 15 (length (table-lines parts))))
    (walk parts)
    (is (string= (table-text whole) (table-text parts)))
    (walk parts)
    (is (string= (table-text whole) (table-text parts)))))

(test tables.get-more-conditions
  (define-walk :speeds '(1 3))
  (with-directories (whole parts)
    (walk parts)
    (define-walk :speeds '(1 2 3))
    (walk parts)
    (walk whole)
    (is (string= (table-text whole) (table-text parts)))))

(test tables.that-were-cut-anywhere-become-whole
  "A process that is killed leaves rows in any order, and perhaps the beginning of one."
  (define-walk)
  (with-directories (whole broken)
    (walk whole :trials 6)
    (let ((lines (table-lines whole)) (dice (base:make-dice 12)))
      (loop repeat 20
            do (let* ((mixed (shuffled (rest lines) (base:roll-index 1000 dice)))
                      (count (base:roll-index (length mixed) dice))
                      (next (nth count mixed)))
                 (write-table broken (append (list (first lines)) (subseq mixed 0 count)
                                             (list (subseq next 0 (base:roll-index
                                                                   (length next) dice))))
                              :end "")
                 (walk broken :trials 6)
                 (is (string= (table-text whole) (table-text broken))))))))

(test tables.that-were-killed-before-they-began-are-begun
  (define-walk)
  (with-directories (whole broken)
    (walk whole :trials 2)
    (dolist (start '("" "experi" "experiment,fingerprint"))
      (write-table broken (list start) :end "")
      (walk broken :trials 2)
      (is (string= (table-text whole) (table-text broken))))))

;;; What does not belong together.

(test rows.of-other-code-are-refused
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 2)
    (let ((before (table-text directory)))
      (eval '(experiment:defexperiment walk (:robots ars-worlds:dot) (:vary (base:max-speed* 1 2))
              (:run (run:run-ticks 5) t)
              (:measure (way (robot:robot-x ars-worlds:dot)) (wet nil))))
      (handler-case (progn (walk directory :trials 2) (fail "they were not"))
        (base:misuse (condition)
          (is (search "experiment walk" (princ-to-string condition)))))
      (is (string= before (table-text directory))))))

(test rows.that-come-out-otherwise-are-refused
  "At the end of a run, and before another goes on."
  (define-walk :measure '(way (incf (get 'walks :count 0))))
  (setf (get 'walks :count) 0)
  (with-directories (directory)
    (signals base:misuse (walk directory :trials 2))
    (is (= 5 (length (table-lines directory))))
    (signals base:misuse (walk directory :trials 3))
    (is (= 5 (length (table-lines directory))))))

(test merging.refuses-rows-that-differ
  (define-walk)
  (with-directories (a b merged)
    (walk a :trials 2)
    (let ((lines (table-lines a)))
      (write-table b (substitute (substitute #\9 #\1 (second lines) :start 40) (second lines)
                                 lines :test #'string=))
      (signals experiment:damaged-table (experiment:merge-results (list a b) :to merged))
      (is-false (probe-file (rows-path merged))))))

(test merging.refuses-rows-of-different-code
  (define-walk)
  (with-directories (a b merged)
    (walk a :trials 2)
    (write-table b (cons (first (table-lines a))
                         (mapcar (lambda (line) (format nil "walk,00~A" (subseq line 7)))
                                 (rest (table-lines a)))))
    (signals base:misuse (experiment:merge-results (list a b) :to merged))))

(test merging.takes-equal-rows-once
  (define-walk)
  (with-directories (a b merged)
    (walk a :trials 4)
    (walk b :trials 2)
    (experiment:merge-results (list b a a) :to merged)
    (is (string= (table-text a) (table-text merged)))))

(test damage.is-named-by-its-line
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 3)
    (let ((lines (table-lines directory)))
      (dolist (damaged '("" "x" "walk,a,b" "\"walk" "walk,,,,,,,,,,,," "a\"b,\"c"))
        (write-table directory (append (subseq lines 0 3) (list damaged) (nthcdr 4 lines)))
        (handler-case (progn (walk directory :trials 3) (fail "~S was taken" damaged))
          (experiment:damaged-table (condition)
            (is (search "line 4" (princ-to-string condition)) "~A" condition))))
      (write-table directory (cons "a,b,c" (rest lines)))
      (signals experiment:damaged-table (walk directory :trials 3)))))

(test directories.are-written-by-one-at-a-time
  (define-walk)
  (with-directories (directory)
    (ensure-directories-exist directory)
    (experiment::call-with-locked-directory
     (lambda () (signals base:misuse (walk directory)))
     (experiment::directory-path directory))
    (walk directory :trials 1)
    (is (= 3 (length (table-lines directory))))))

;;; Reading them.

(test results.are-what-the-table-says
  (define-walk)
  (with-directories (directory)
    (let* ((results (walk directory :trials 9)) (again (experiment:read-results directory)))
      (is (equal '("max-speed*") (experiment:results-factors again)))
      (is (equal '("way" "wet") (experiment:results-measures again)))
      (is (equal (rows-of results) (rows-of again)))
      (is (equal (measured results "way") (measured again 'way)))
      (is (= 18 (length (measured again 'way))))
      (is (every #'floatp (measured again 'way)))
      (is (subsetp (measured again 'wet) '(t nil)))
      (signals base:unknown-name (measured again 'weight))))
  (signals base:misuse (experiment:read-results "/nowhere/at/all")))

;;; Until intervals are narrow.

(test until.stops-at-fixed-counts
  (eval '(experiment:defexperiment walk (:robots ars-worlds:dot) (:vary (rate 1/2 1))
          (:run (chance-p rate))))
  (with-directories (directory fewer)
    (let* ((results (experiment:run-experiment 'walk :until 1/4 :directory directory :stream nil
                                                     :workers 2))
           (counts (mapcar (lambda (sample) (length (experiment:sample-trials sample)))
                           (experiment:results-samples results))))
      (is (equal '(200 50) counts))
      (experiment:run-experiment 'walk :trials 10 :directory fewer :stream nil)
      (experiment:run-experiment 'walk :until 1/4 :directory fewer :stream nil)
      (is (string= (table-text directory) (table-text fewer))))))

(test until.intervals-are-as-wide-as-they-say
  "The share of the K-th look is .05 / (K (K + 1)), and all shares together are .05."
  (is (= 50 (experiment::count-at-look 1)))
  (is (= 400 (experiment::count-at-look 4)))
  (is (< (abs (- 0.975d0 (experiment::confidence-at-look 1))) 1d-12))
  (is (< (abs (- 0.05d0 (loop for look from 1 to 10000
                              sum (- 1 (experiment::confidence-at-look look)))))
         1d-5)))

(test arguments.are-checked-at-the-door
  (define-walk)
  (signals base:wrong-argument (walk nil :trials 0))
  (signals base:wrong-argument (walk nil :trials 1/2))
  (signals base:wrong-argument (walk nil :workers 0))
  (signals base:wrong-argument (walk nil :until 1))
  (signals base:wrong-argument (walk nil :shard '(3 . 3)))
  (signals base:wrong-argument (walk 7))
  (signals base:misuse (walk nil :until 1/10 :shard '(0 . 3)))
  (signals base:misuse (walk "/proc/nothing/here/"))
  (signals base:wrong-argument (experiment:merge-results '()))
  (signals base:unknown-name (experiment:run-experiment 'no-such-question)))

;;; What is no table of ours, or has been changed.

(defun write-raw (path text)
  (ensure-directories-exist path)
  (with-open-file (out path :direction :output :if-exists :supersede :external-format :latin-1)
    (write-string text out)))

(defun raw-text (path)
  (base:read-file-into-string path :external-format :latin-1))

(test tables.of-others-are-left-alone
  (define-walk)
  (with-directories (directory)
    (dolist (text (list "my precious text" (format nil "name,age~%bob,3") (format nil "a~%b~%")
                        (format nil "experiment~%") (string (code-char 0))))
      (write-raw (rows-path directory) text)
      (signals experiment:damaged-table (walk directory :trials 1))
      (is (string= text (raw-text (rows-path directory)))))))

(test tables.saved-by-spreadsheets-are-told
  (define-walk)
  (with-directories (directory merged)
    (walk directory :trials 2)
    (let ((lines (table-lines directory)))
      (dolist (text (list (format nil (format nil "~~{~~A~C~~%~~}" #\Return) lines)
                          (format nil "~A~{~A~%~}" (map 'string #'code-char '(#xEF #xBB #xBF))
                                  lines)))
        (write-raw (rows-path directory) text)
        (dolist (form (list (lambda () (walk directory :trials 2))
                            (lambda () (experiment:merge-results (list directory) :to merged))))
          (handler-case (progn (funcall form) (fail "it was taken"))
            (experiment:damaged-table (condition)
              (is (search "editor" (princ-to-string condition))))))
        (is (string= text (raw-text (rows-path directory))))))))

(defun changed-cell (line column text)
  "Return LINE, of a table, with TEXT for the cell numbered COLUMN."
  (let ((texts (experiment::csv-fields line)))
    (setf (nth column texts) text)
    (string-right-trim '(#\Newline) (experiment::csv-line texts))))

(test rows.that-cannot-be-are-told
  (define-walk)
  (with-directories (directory merged)
    (walk directory :trials 4)
    (let ((lines (table-lines directory)))
      (loop for (column text) in '((0 "wolk") (2 "max-speed*=7") (3 "7") (4 "9") (5 "0") (5 "-1")
                                   (5 "1000000000000") (5 "x") (6 "bogus") (8 "abc") (8 "-3")
                                   (11 "no digest"))
            do (write-table directory
                            (substitute (changed-cell (third lines) column text) (third lines)
                                        lines :test #'string=))
               (signals base:ars-magna-error (walk directory :trials 4))
               (unless (member column '(4))
                 (signals base:ars-magna-error
                   (experiment:merge-results (list directory) :to merged)))))))

(test merging.refuses-other-experiments
  (define-walk)
  (with-directories (a b)
    (walk a :trials 2)
    (eval '(experiment:defexperiment walk-too (:robots ars-worlds:dot)
            (:vary (base:max-speed* 1 2)) (:run t) (:measure (way 1) (wet nil))))
    (experiment:run-experiment 'walk-too :trials 2 :directory b :stream nil)
    (let ((before (table-text b)))
      (signals base:misuse (experiment:merge-results (list a) :to b))
      (is (string= before (table-text b))))))

(test directories.have-the-names-that-they-are-given
  (define-walk)
  (with-directories (directory)
    (dolist (name '("a*b" "a[b" "a?b" "a\\b" "a b" "ü"))
      (let ((path (concatenate 'string directory name "/")))
        (experiment:run-experiment 'walk :trials 1 :directory path :stream nil)
        (is-true (probe-file (base:native-path (concatenate 'string path "rows.csv")))
                 "~A" name)))))
