;;;; main.lisp -- running the suites and counting what came of it.

(in-package :ars-magna.tests)

(defun find-suite (name)
  "Return the suite called NAME, a string of any case; signal an error if there is none."
  (or (find name (suite-names) :test #'string-equal)
      (error "There is no suite ~A. There are: ~{~(~A~)~^ ~}." name (suite-names))))

(defun write-failure (result)
  (format t "~&~%FAILED ~(~A~)~%~A~%" (test-name result) (failure-reason result)))

(defun run-suite (suite)
  "Run SUITE, report its failures. Return how many checks passed, failed and were skipped."
  (format t "~&~(~20A~)" suite)
  (let ((results (let ((*test-dribble* (make-broadcast-stream))
                       ;; What one suite leaves unread is not for the next.
                       (base:*message-queue* (base:make-message-queue)))
                   (run suite))))
    (multiple-value-bind (good failed skipped) (results-status results)
      (declare (ignore good))
      (let ((passed (- (length results) (length failed) (length skipped))))
        (format t "~6D passed~[~:;~:*, ~D failed~]~[~:;~:*, ~D skipped~]~%"
                passed (length failed) (length skipped))
        (mapc #'write-failure failed)
        (finish-output)
        (list passed (length failed) (length skipped))))))

(defun run-suites (names)
  "Run the suites called NAMES, or all if there are none, and end with a line that counts the
checks. True if none has failed."
  (let* ((suites (if names (mapcar #'find-suite names) (suite-names)))
         (counts (mapcar #'run-suite suites)))
    (destructuring-bind (passed failed skipped)
        (if counts (apply #'mapcar #'+ counts) '(0 0 0))
      (format t "~&~%~D passed, ~D failed~[~:;~:*, ~D skipped~]~%" passed failed skipped)
      (zerop failed))))

(defun run-all ()
  "Run all suites; signal an error if any check fails."
  (unless (run-suites '()) (error "Some tests of ARS MAGNA fail."))
  t)
