;;;; main.lisp -- running the tests, in order or shuffled, and counting what came of them.

(in-package :ars-magna.tests)

(define-condition no-such-suite (error)
  ((name :initarg :name))
  (:report (lambda (condition stream)
             (format stream "There is no suite ~A. There are: ~{~(~A~)~^ ~}."
                     (slot-value condition 'name) (suite-names))))
  (:documentation "Somebody asks for a suite that there is not."))

(defun find-suite (name)
  "Return the suite called NAME, a string of any case. Signals NO-SUCH-SUITE."
  (or (find name (suite-names) :test #'string-equal)
      (error 'no-such-suite :name name)))

;;; Running.

(defun run-test (test suite)
  "Run TEST, a name, of SUITE. Return what came of its checks, a list."
  (let ((*test-dribble* (make-broadcast-stream)))
    (call-timed (lambda () (call-isolated (lambda () (run test)))) suite)))

(defun run-suite (suite)
  "Run the tests of SUITE in order. Return what came of their checks."
  (loop for test in (suite-tests suite) append (run-test test suite)))

(defun shuffled (list seed)
  "Return the elements of LIST in an order that depends on the integer SEED only."
  (let ((dice (base:make-dice seed "order of tests"))
        (vector (coerce list 'simple-vector)))
    (loop for count from (length vector) above 1
          do (rotatef (svref vector (1- count))
                      (svref vector (base:roll-index count dice))))
    (coerce vector 'list)))

(defun run-shuffled (suites seed)
  "Run the tests of all SUITES in the order that SEED decides. Return a function of a suite, which
returns what came of its checks."
  (let ((tests (loop for suite in suites
                     append (loop for test in (suite-tests suite) collect (cons suite test))))
        (results (make-hash-table)))
    (loop for (suite . test) in (shuffled tests seed)
          do (setf (gethash suite results)
                   (append (run-test test suite) (gethash suite results))))
    (lambda (suite) (gethash suite results))))

;;; Reporting.

(defun write-failure (result)
  (format t "~&~%FAILED ~(~A~)~%~A~%" (symbol-name (test-name result)) (failure-reason result)))

(defun report-suite (suite results)
  "Say what came of the checks of SUITE, and how long it took of what it may. Return how many
passed, failed and were skipped, a list."
  (multiple-value-bind (good failed skipped) (results-status results)
    (declare (ignore good))
    (let ((passed (- (length results) (length failed) (length skipped))))
      (format t "~&~(~28A~)~6D passed~7,1F s of ~D~[~:;~:*, ~D failed~]~[~:;~:*, ~D skipped~]~%"
              (symbol-name suite) passed (seconds-taken suite) (budget-of suite)
              (length failed) (length skipped))
      (mapc #'write-failure failed)
      (finish-output)
      (list passed (length failed) (length skipped)))))

(defun report-slow-suites (suites)
  "Say which SUITES have taken more time than they may."
  (format t "~@[~&~%Slower than they may be (tests/budgets.lisp): ~{~(~A~)~^, ~}.~%~]"
          (remove-if #'within-budget-p suites)))

(defun report-total (counts)
  "Say what COUNTS, a list of what REPORT-SUITE returns, come to. True if no check has failed."
  (destructuring-bind (passed failed skipped)
      (if counts (apply #'mapcar #'+ counts) '(0 0 0))
    (format t "~&~%~D passed, ~D failed~[~:;~:*, ~D skipped~]~%" passed failed skipped)
    (zerop failed)))

(defun run-suites (names &optional seed)
  "Run the suites called NAMES, or all if there are none, and end with a line that counts the
checks. With the integer SEED, mix all their tests in the order that it decides. True if no check
has failed."
  (clrhash *seconds*)
  (let* ((suites (if names (remove-duplicates (mapcar #'find-suite names)) (suite-names)))
         (results-of (if seed
                         (run-shuffled suites seed)
                         #'run-suite)))
    (let ((counts (loop for suite in suites
                        collect (report-suite suite (funcall results-of suite)))))
      (report-slow-suites suites)
      (report-total counts))))

(defun run-from-shell (names &optional seed)
  "Do as RUN-SUITES does, for ./tests/run, and say which SEED it was. NIL if there is no such suite,
too."
  (handler-case
      (progn (when seed (format t "~&The tests are shuffled by the seed ~D.~%" seed))
             (run-suites names seed))
    (no-such-suite (condition)
      (format *error-output* "~&~A~%" condition)
      nil)))

(defun run-all ()
  "Run all suites; signal an error if any check fails."
  (unless (run-suites '()) (error "Some tests of ARS MAGNA fail."))
  t)
