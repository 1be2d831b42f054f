;;;; main.lisp -- runs the tests, in order or shuffled, and counts the results.

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
  "Print the results of SUITE, its seconds and its budget. Return a list of how many checks passed,
failed and were skipped."
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
  "Print the sums of COUNTS, a list of values of REPORT-SUITE. True if no check has failed."
  (destructuring-bind (passed failed skipped)
      (if counts (apply #'mapcar #'+ counts) '(0 0 0))
    (format t "~&~%~D passed, ~D failed~[~:;~:*, ~D skipped~]~%" passed failed skipped)
    (zerop failed)))

;;; All suites.

(defun report-in-turn (suites results-of)
  "Report SUITES, whose results the function RESULTS-OF returns. Return their counts."
  (loop for suite in suites
        collect (report-suite suite (funcall results-of suite))))

(defun counts-and-seconds (suite)
  "Run SUITE and report it. Return a list of its counts, and how many seconds it took."
  (list (report-suite suite (run-suite suite)) (seconds-taken suite)))

(defun report-suite-of-child (suite value)
  "Record VALUE, which the child that ran SUITE returned, or NIL. Return its counts."
  (destructuring-bind (&optional (counts '(0 1 0)) (seconds 0)) value
    (unless value (format t "~&FAILED ~(~A~): it ended its process.~%" suite))
    (setf (gethash suite *seconds*) seconds)
    counts))

(defun report-by-children (suites)
  "Run each of SUITES in a process of its own, those that take long first, and report them in their
order. Return their counts."
  (call-with-children
   (lambda (value-of)
     (loop for suite in suites
           collect (report-suite-of-child suite (funcall value-of suite))
           do (finish-output)))
   #'counts-and-seconds
   (stable-sort (copy-list suites) #'> :key #'budget-of)
   (experiment:processors)))

(defun run-suites (names report)
  "Run the suites called NAMES, or all if there are none. REPORT is called with them, and returns
their counts. End with a line that counts the checks. True if no check has failed."
  (clrhash *seconds*)
  (let* ((suites (if names (remove-duplicates (mapcar #'find-suite names)) (suite-names)))
         (counts (funcall report suites)))
    (report-slow-suites suites)
    (report-total counts)))

(defun report-shuffled (suites seed)
  "Run all tests of SUITES mixed, in the order that the integer SEED decides. Return counts."
  (format t "~&The tests are shuffled by the seed ~D.~%" seed)
  (report-in-turn suites (run-shuffled suites seed)))

(defun run-from-shell (names &optional seed)
  "Do as RUN-SUITES does, for ./tests/run: shuffled if there is a SEED, otherwise on all processors.
NIL if there is no such suite, too."
  (handler-case
      (run-suites names (if seed
                            (lambda (suites) (report-shuffled suites seed))
                            #'report-by-children))
    (no-such-suite (condition)
      (format *error-output* "~&~A~%" condition)
      nil)))

(defun run-all ()
  "Run all suites in this process; signal an error if any check fails."
  (unless (run-suites '() (lambda (suites) (report-in-turn suites #'run-suite)))
    (error "Some tests of ARS MAGNA fail."))
  t)
