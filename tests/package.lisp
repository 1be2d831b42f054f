;;;; package.lisp -- the package of all tests, and the only file that names FiveAM.

(defpackage :ars-magna.tests
  (:documentation "One suite per layer, and one per section of the manual (see README.md). Other
layers' symbols are qualified by short local nicknames: geo:add, nisp:matchq, robot::%look.")
  (:use :cl :fiveam))

(in-package :ars-magna.tests)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (loop for (nickname layer) in '((:host "HOST") (:base "BASE") (:basics "BASICS")
                                  (:definitions "DEFINITIONS") (:copying "COPYING")
                                  (:geo "GEOMETRY") (:stats "STATISTICS") (:nisp "NISP")
                                  (:world "WORLD") (:ways "WAYS") (:floors "FLOORS") (:time "TIME")
                                  (:robot "ROBOT")
                                  (:command "COMMAND") (:run "RUN") (:rpl "RPL")
                                  (:fluents "RPL.FLUENTS") (:tasks "RPL.TASKS")
                                  (:language "RPL.LANGUAGE") (:constructs "RPL.CONSTRUCTS")
                                  (:display "DISPLAY") (:trails "TRAILS")
                                  (:experiment "EXPERIMENT") (:rates "FIVEAM") (:cli "CLI")
                                  (:manual "MANUAL"))
        for package = (find-package (concatenate 'string "ARS-MAGNA." layer))
        when package
          do (sb-ext:add-package-local-nickname nickname package :ars-magna.tests)))

(def-suite ars-magna :description "All that ARS MAGNA claims.")

;;; What others need to know of FiveAM's insides.

(defun names-in-bundle (bundle)
  "Return the names of what is in BUNDLE, a suite's tests, in order of definition. It was a hash
table until FiveAM 1.4.3."
  (if (hash-table-p bundle)
      (loop for name being the hash-keys of bundle collect name)
      (reverse (remove-duplicates (uiop:symbol-call :fiveam '#:%test-names bundle)))))

(defun suite-tests (suite)
  "Return a list of the names of the tests in SUITE, a name, in order of definition."
  (names-in-bundle (fiveam::tests (get-test suite))))

(defun suite-names ()
  "Return a list of the names of the suites, in order of definition."
  (suite-tests 'ars-magna))

(defun test-name (result)
  "Return the name of the test that RESULT, a check's, belongs to."
  (fiveam::name (fiveam::test-case result)))

(defun failure-reason (result)
  "Return what RESULT, a failed check's, says."
  (fiveam::reason result))

(defun results-of (function)
  "Return what came of the checks that FUNCTION makes, which do not count for the test that calls
this."
  (fiveam::return-result-list function))

(defun passed-p (result)
  "True if RESULT is that of a check that passed."
  (fiveam::test-passed-p result))

(defun test-claim (test)
  "Return what TEST, a name, says in its documentation."
  (fiveam::description (get-test test)))

(defun call-with-suites-of-its-own (function package)
  "Call FUNCTION, which may define suites, quietly. Then forget those of the package called PACKAGE,
and the package."
  (let ((fiveam::*suite* fiveam::*suite*)
        (*test-dribble* (make-broadcast-stream)))
    (unwind-protect (funcall function)
      (let ((package (find-package package)))
        (when package
          (do-symbols (symbol package)
            (when (eq package (symbol-package symbol)) (rem-test symbol)))
          (delete-package package))))))
