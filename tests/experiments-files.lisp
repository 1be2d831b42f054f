;;;; experiments-files.lisp -- what tables look like to other programs, and what is no table's file.

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
             (is (equal (list "1" text) (base:csv-texts line)) "~A" text))))

;;; What is no file of bytes: reading a pipe would wait for ever, /dev/zero fill the memory.

(defun make-odd-file (kind file)
  "Let FILE be a pipe, a directory, a device or a link to nothing, as KIND says."
  (let ((name (base:native-name file)))
    (ecase kind
      (:pipe (sb-posix:mkfifo name #o600))
      (:directory (sb-posix:mkdir name #o700))
      (:device (sb-posix:symlink "/dev/zero" name))
      (:nothing (sb-posix:symlink "/no/such/file" name)))))

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
