;;;; experiments-files.lisp -- how other programs read tables, and files that are no tables.

(in-package :ars-magna.tests)
(in-suite experiments-tables)

(test rows.are-no-formulas
  "Spreadsheets carry those out. What is read is what was written, whatever that begins with."
  (loop for (text written) in '(("=HYPERLINK(1)" "'=HYPERLINK(1)") ("@x" "'@x") ("+a" "'+a")
                                ("-" "'-") ("--1" "'--1") ("'=1" "''=1") ("''+" "'''+")
                                ("-1.5" "-1.5") ("+7" "+7") ("-1/2" "-1/2") ("-1.5d0" "-1.5d0")
                                ("'twas" "'twas") ("a=b" "a=b") ("'" "'") ("" ""))
        do (let ((line (coerce (format nil "1,~A" written) '(simple-array character (*)))))
             (is (equal (format nil "~A~%" line) (base:csv-line (list "1" text))) "~A" text)
             (is (equal (list "1" text) (base:csv-fields line)) "~A" text))))

(test numbers-in-tables.are-told-without-making-names
  (loop for (text . number-p) in '(("-1.5" . t) ("+7" . t) ("-1/2" . t) ("1e-7" . t) ("-1.5d0" . t)
                                   (".5" . t) ("" . nil) ("-" . nil) ("--1" . nil) ("1-2" . nil)
                                   ("1e" . nil) ("-1x2" . nil) ("1.2.3" . nil))
        do (is (eq number-p (and (base:csv-number-p text) t)) "~A" text))
  (let ((before (count-symbols)))
    (dolist (text '("--17" "+18-19" "-20e21e22"))
      (is (null (experiment:number-from-text text)))
      (base:csv-line (list text)))
    (is (= before (count-symbols)))))

;;; Names that no table can have, or that would mean two things there.

(defun said-of-clauses (&rest clauses)
  "Return what is said when an experiment is defined by CLAUSES."
  (said-by (lambda () (eval `(define-for-test (:robots ars-worlds:dot) ,@clauses)))))

(test names.that-no-table-can-have-are-refused
  (dolist (name (list (intern "" :ars-magna.tests)
                      (intern (format nil "a~%b") :ars-magna.tests)))
    (flet ((refused-p (said) (has-words-p said "another name" "cannot be seen")))
      (dolist (clause `((:measure (,name 1)) (:each-tick (,name 1)) (:vary (,name 1 2))
                        (:conditions (,name (base:max-speed* 1)))))
        (is-true (refused-p (said-of-clauses '(:run t) clause)) "~S" clause))
      (is-true (refused-p (said-by (lambda ()
                                     (eval `(experiment:defexperiment ,name
                                              (:robots ars-worlds:dot) (:run t))))))))))

(test names.of-two-conditions-differ
  (is-true (has-words-p (said-of-clauses '(:vary (a "p" "p b=q") (b "q" "q b=q"))
                                         '(:run (list a b)))
                        "(:vary (a" "two conditions would be named a=p b=q b=q"
                        "\"p\" \"q b=q\" and \"p b=q\" \"q\""))
  (is-true (has-words-p (said-of-clauses '(:conditions (a (base:max-speed* 1))
                                           (|a| (base:max-speed* 2)))
                                         '(:run t))
                        "two conditions would be named a,")))

;;; What is no file of bytes: reading a pipe would wait for ever, /dev/zero fill the memory.

(defun make-odd-file (kind file)
  "Let FILE be a pipe, a directory, a device or a link to nothing, as KIND says."
  (let ((name (base:native-name file)))
    (ecase kind
      (:pipe (sb-posix:mkfifo name #o600))
      (:directory (sb-posix:mkdir name #o700))
      (:device (sb-posix:symlink "/dev/zero" name))
      (:nothing (sb-posix:symlink "/no/such/file" name)))))

(test directories.are-left-alone-where-a-table-is-write-protected
  (define-walk)
  (dolist (name '("rows.csv" "machine.csv" "experiment.txt"))
    (with-directories (directory)
      (walk directory :trials 1)
      (let* ((file (uiop:subpathname directory name)) (text (base:file-text file)))
        (sb-posix:chmod file #o444)
        (signals base:ars-magna-error (walk directory :trials 2))
        (is (string= text (base:file-text file)))))))

(test merging.leaves-a-write-protected-description-alone
  (define-walk)
  (with-directories (directory other)
    (walk directory :trials 1)
    (walk other :trials 2)
    (let* ((file (uiop:subpathname other "experiment.txt")) (text (base:file-text file)))
      (sb-posix:chmod file #o444)
      (delete-file (uiop:subpathname other "rows.csv"))
      (signals experiment:damaged-table
        (experiment:merge-results (list directory) :to other))
      (is (string= text (base:file-text file))))))

(test directories.with-something-else-as-their-lock-are-told-so
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 1)
    (let ((file (uiop:subpathname directory ".lock")))
      (delete-file file)
      (make-odd-file :directory file)
      (handler-case (progn (walk directory :trials 2) (fail))
        (experiment:damaged-table (condition)
          (is (search ".lock: it is a directory" (princ-to-string condition)))))
      (is-true (experiment:read-results directory) "reading needs no lock"))))

(test machine-tables.that-are-none-may-be-deleted
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 1)
    (let ((file (uiop:subpathname directory "machine.csv")))
      (base:call-replacing-file (lambda (out) (write-line "no table" out)) file)
      (handler-case (progn (walk directory :trials 1) (fail))
        (experiment:damaged-table (condition)
          (is (search "machine.csv, line 1: its columns are no table" (princ-to-string condition)))
          (is (search "Or delete this file" (princ-to-string condition)))))
      (delete-file file)
      (is-true (walk directory :trials 1)))))

;;; Rows that were changed after their trials, and rows of other experiments.

(defun change-line (file number function)
  "Let FUNCTION change line NUMBER, from 1, of FILE. NIL removes the line."
  (let ((lines (file-lines file)))
    (base:call-replacing-file
     (lambda (out)
       (loop for line in lines
             for index from 1
             for new = (if (= index number) (funcall function line) line)
             do (when new (write-line new out))))
     file)))

(defun with-cell (line index text)
  (string-right-trim '(#\Newline)
                     (base:csv-line (loop for cell in (experiment::csv-fields line)
                                          for place from 0
                                          collect (if (= place index) text cell)))))

(defun said-of-continuing (directory)
  (handler-case (progn (walk directory :trials 6) "")
    (experiment:damaged-table (condition) (princ-to-string condition))))

(test rows.changed-in-the-middle-are-refused-and-run-again
  (define-walk)
  (loop for (index text trouble)
          in '((9 "7.5" "line 4: This row has changed") (8 "99" "line 4: This row has changed")
               (6 "failure" "line 4: This row has changed")
               (7 "sleepy" "line 4: This row has changed")
               (11 "0123456789ABCDEF" "line 4: This row has changed")
               (0 "run" "line 4: this is a row of another experiment, run")
               (1 "123" "other code or another configuration")
               (2 "max-speed*=2" "other code or another configuration")
               (2 "max-speed*=9" "line 4: The condition, factors and fingerprint")
               (4 "77" "line 4: this row is of other seeds")
               (8 "-3" "line 4: -3 cannot be the ticks"))
        do (with-directories (directory)
             (walk directory :trials 5)
             (let* ((file (uiop:subpathname directory "rows.csv")) (before (base:file-text file)))
               (change-line file 4 (lambda (line) (with-cell line index text)))
               (let* ((damaged (base:file-text file))
                      (said (handler-case (said-of-continuing directory)
                              (base:misuse (condition) (princ-to-string condition)))))
                 (is-true (search trouble said) "~A ~A: ~A" index text said)
                 (is-true (or (search "elete" said) (search "another directory" said)))
                 (is (string= damaged (base:file-text file))))
               (change-line file 4 (constantly nil))
               (is-true (walk directory :trials 5))
               (is (string= before (base:file-text file)))))))

(test rows.are-as-their-trials-wrote-them-whatever-they-contain
  "Texts with commas, quotes, formulas and other letters have the same check sum when read again."
  (define-for-test
    (:robots ars-worlds:dot) (:vary (name "=a,b" "Zoe \"ë\"" "-")) (:run t)
    (:measure (said (list name "+1,'" "é"))))
  (with-directories (directory)
    (dolist (trials '(2 3))
      (is-true (experiment:run-experiment 'question :trials trials :workers 1 :stream nil
                                                    :directory directory)))))

(test rows.without-check-sums-are-not-compared
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 3)
    (let ((file (uiop:subpathname directory "machine.csv")))
      (change-line file 3 (lambda (line) (subseq line 0 (position #\, line :from-end t))))
      (is-true (walk directory :trials 4))
      (delete-file file)
      (is-true (walk directory :trials 5)))))

(test rows.with-characters-that-no-text-has-are-damaged
  (define-walk)
  (dolist (char (list (code-char 0) (code-char 27) (code-char #x9B)))
    (with-directories (directory)
      (walk directory :trials 1)
      (let* ((file (uiop:subpathname directory "rows.csv")) (text (base:file-text file))
             (place (search "ess," text)))
        (base:call-replacing-file
         (lambda (out)
           (write-string text out :end (+ 4 place))
           (write-char char out)
           (write-string text out :start (+ 4 place)))
         file)
        (handler-case (progn (walk directory :trials 2) (fail))
          (experiment:damaged-table (condition)
            (is (search "rows.csv, line 2: This is no row: it has bytes that are not text."
                        (princ-to-string condition)))))))))

(test directories.have-plain-files-only
  (define-walk)
  (dolist (kind '(:pipe :directory :device :nothing))
    (dolist (name '("rows.csv" "machine.csv" "experiment.txt"))
      (with-directories (directory other)
        (walk other :trials 2)
        (walk directory :trials 2)
        (let ((file (uiop:subpathname directory name)))
          (delete-file file)
          (make-odd-file kind file)
          (dolist (use (list (lambda () (walk directory :trials 3))
                             (lambda () (experiment:read-results directory))
                             (lambda () (experiment:merge-results (list other directory)))
                             (lambda () (experiment:merge-results (list other) :to directory))))
            (signals experiment:damaged-table (funcall use))))))))

;;; What is beside the table.

(test descriptions.say-what-the-table-was-made-with
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 1)
    (let ((text (base:file-text (uiop:subpathname directory "experiment.txt"))))
      (dolist (words (list "Written 2" " UTC by SBCL " (lisp-implementation-version)
                           "Libraries: alexandria" "bordeaux-threads" "Check sum: "))
        (is (search words text) "~A" words)))))

(test descriptions.name-the-commit-and-whether-files-have-changed
  (if (null (base:run-command "git" '("--version")))
      (skip "no git here")
      (call-in-directory
       (lambda (directory)
         (flet ((git (&rest arguments)
                  (is (eql 0 (base:run-command
                              "git" (list* "-C" (base:native-name directory) "-c" "user.name=a"
                                           "-c" "user.email=a@b" "-c" "commit.gpgsign=false"
                                           arguments))))))
           (is (null (experiment::commit-text directory)) "no tree")
           (git "init" "-q")
           (is (null (experiment::commit-text directory)) "no commit yet")
           (write-octets #(65) (uiop:subpathname directory "a.lisp"))
           (git "add" "a.lisp")
           (git "commit" "-q" "-m" "a")
           (is (= (length "commit 0123456789012345678901234567890123456789")
                  (length (experiment::commit-text directory))))
           (write-octets #(66) (uiop:subpathname directory "a.lisp"))
           (is (search ", and changes since" (experiment::commit-text directory))))))))

(test descriptions.that-are-damaged-are-noticed
  "Wherever they were cut or changed; the rows are read all the same."
  (define-walk)
  (with-directories (directory)
    (walk directory :trials 2)
    (flet ((warned-p ()
             (handler-case (progn (experiment:read-results directory) nil)
               (warning (warning) (search "is damaged" (princ-to-string warning))))))
      (is (not (warned-p)))
      (let* ((file (uiop:subpathname directory "experiment.txt"))
             (text (base:file-text file)) (dice (base:make-dice 5)))
        (loop repeat 20
              for place = (base:roll-index (1- (length text)) dice)
              do (rewrite file (subseq text 0 place))
                 (is-true (warned-p) "cut at ~D" place)
                 (let ((changed (copy-seq text)))
                   (setf (char changed place) #\%)
                   (rewrite file changed)
                   (is-true (warned-p) "changed at ~D" place)))
        (write-octets #(255 254 65) file)
        (is-true (warned-p) "no text")
        (handler-bind ((warning #'muffle-warning)) (walk directory :trials 2))
        (is (not (warned-p)))))))
