;;;; tests-readme.lisp -- tests/README.md describes the suites correctly.

(in-package :ars-magna.tests)

(def-suite* tests-readme :in ars-magna)

;;; The README has tables whose rows begin with the name of a suite. For suites that follow the
;;; manual, the third cell is the number of their tests.

(defun table-rows (path)
  "Return the rows of tables in the file PATH, each as a list of its cells."
  (loop for line in (file-lines path)
        when (begins-with-p "| `" line)
          collect (mapcar (lambda (cell) (string-trim " `" cell))
                          (rest (butlast (uiop:split-string line :separator "|"))))))

(defun suite-rows () (table-rows (project-file "tests/README.md")))

(defun manual-suites ()
  "Return the names of the suites that follow the manual."
  (remove-if-not (lambda (suite) (begins-with-p "MANUAL-" (symbol-name suite))) (suite-names)))

(test readme.counts-the-claims
  "Each suite that follows the manual has one row, with the number of its tests."
  (is (< 5 (length (manual-suites))))
  (dolist (suite (manual-suites))
    (let ((rows (remove suite (suite-rows) :key #'first :test-not #'string-equal))
          (count (princ-to-string (length (suite-tests suite)))))
      (is (equal (list count) (mapcar #'third rows))
          "tests/README.md needs one row like this: | `~(~A~)` | section | ~A | what about |"
          suite count))))

(test readme.names-suites-that-there-are
  (dolist (row (suite-rows))
    (is (member (first row) (suite-names) :test #'string-equal) "~A" (first row))))

(test readme.counts-nothing-that-says-nothing
  "Each test in these suites has a claim in its documentation."
  (dolist (suite (manual-suites))
    (dolist (test (suite-tests suite))
      (is (< 0 (length (test-claim test))) "~(~A~) does not say what it claims" test))))
