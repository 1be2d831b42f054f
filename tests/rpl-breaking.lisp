;;;; rpl-breaking.lisp -- breaks where plans fail, and stepping through plans.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun call-answering (function answers)
  "Call FUNCTION; each time the debugger is entered, invoke the next restart that ANSWERS names, or
CONTINUE when there are no more. Return the texts of all breaks, and the values of FUNCTION in a
list."
  (let ((texts '()))
    (flet ((answer (condition hook)
             (declare (ignore hook))
             (push (princ-to-string condition) texts)
             (let ((name (or (pop answers) "CONTINUE")))
               (invoke-restart (find name (compute-restarts condition) :key #'restart-name
                                                                       :test #'string=)))))
      (let ((values (multiple-value-list
                     (base:with-debugger-hook (#'answer) (funcall function)))))
        (values (nreverse texts) values)))))

(defun first-lines (texts)
  (mapcar (lambda (text) (first (lines-of text))) texts))

;;; Where plans fail.

(rpl:def-interp-proc slipping (class)
  (let ((speed 3))
    (rpl:handle-failure ((:slip () (return :caught)))
      (rpl:par (rpl:wait-time speed)
               (rpl:seq (rpl:wait-time 1) (rpl:fail :class class :speed speed))))))

(defun breaks-of (types class)
  "Return the texts of the breaks of SLIPPING with CLASS, and how that ended."
  (let ((rpl:*break-on-plan-failures* types))
    (multiple-value-bind (texts values)
        (call-answering (lambda () (rpl:run-plan-alone 'slipping :arguments (list class))) '())
      (values texts (second values) (first values)))))

(test break.happens-where-a-failure-does-if-wanted
  (dolist (types '(t :slip (:slip) (:other :slip) (or :other :slip) rpl:plan-failure))
    (multiple-value-bind (texts state value) (breaks-of types :slip)
      (is (= 1 (length texts)) "~S" types)
      (is (equal '(:succeeded :caught) (list state value)))))
  (dolist (types '(nil :other (:other) rpl:lisp-failure))
    (is (null (breaks-of types :slip)) "~S" types)))

(test break.shows-the-plans-stack-and-variables
  (let ((text (first (breaks-of t :slip))))
    (is (string= "Plan failure :SLIP :SPEED 3" (first (lines-of text))))
    (is-true (has-words-p text "in task slipping > " "at tick 1" "fail :class class") "~A" text)
    (is-true (has-words-p text "speed = 3" "class = :slip" "handle-failure ((:slip") "~A" text)))

(test frames.show-the-variables-of-the-plan
  "A debugger shows the calls under way, and frames are arguments of those."
  (with-runner (runner)
    (let ((task (tasks:start-plan runner (rpl:interp-lambda (depth)
                                           (let ((twice (* 2 depth)))
                                             (rpl:seq (rpl:wait-time 9) (list twice))))
                                  5)))
      (rpl:react-to-all runner)
      (is-true (has-words-p (princ-to-string (tasks::task-frame task))
                            "twice = 10, depth = 5, (")))))

(test break.of-lisp-errors-too
  (let ((rpl:*break-on-plan-failures* 'parse-error))
    (multiple-value-bind (texts values)
        (call-answering (lambda ()
                          (with-runner (runner :on-end #'identity)
                            (rpl:run-plan-alone (rpl:interp-lambda ()
                                                  (rpl:wait-time 1)
                                                  (parse-integer "x"))
                                                :runner runner)))
                        '())
      (is (= 1 (length texts)))
      (is (eq :failed (second values))))))

(defmacro with-nobody-there (() &body body)
  "Run BODY as in a script: nobody answers a debugger."
  `(let ((*debugger-hook* nil))
     (base:with-debugger-hook ('debugger-disabled-hook) ,@body)))

(defun debugger-disabled-hook (condition hook)
  (declare (ignore hook))
  (error "The debugger was entered where nobody is: ~A" condition))

(test break.is-a-message-where-nobody-is
  (let ((base:*message-queue* (base:make-message-queue))
        (rpl:*break-on-plan-failures* t)
        (rpl:*step-plans* t))
    (with-nobody-there ()
      (is (eq :caught (rpl:run-plan-alone 'slipping :arguments '(:slip)))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (is (find-if (lambda (text) (search ": Plan failure :SLIP" text)) texts))
      (is (find-if (lambda (text) (search ": Next: " text)) texts)))))

;;; Step by step.

(rpl:def-interp-proc stepped-inner (x)
  (rpl:wait-time x)
  (list x))

(defvar *steps-done* '())

(rpl:def-interp-proc stepped (count)
  (push :first *steps-done*)
  (stepped-inner 1)
  (push :second *steps-done*)
  (rpl:par (rpl:wait-time count)
           (rpl:seq (rpl:wait-time 1) (rpl:wait-time 1)))
  (push :third *steps-done*)
  :done)

(defun stops (answers)
  "Return what STEPPED stops before if ANSWERS are given, and its value."
  (let ((rpl:*step-plans* t))
    (multiple-value-bind (texts values)
        (call-answering (lambda () (rpl:run-plan-alone 'stepped :arguments '(3))) answers)
      (is (eq :done (first values)))
      (values (loop for text in (first-lines texts)
                    collect (operator-in text))
              texts))))

(defun operator-in (text)
  "Return the operator of the expression that TEXT says is next, or that expression if it is an
atom."
  (read-from-string text t nil :start (1+ (or (position #\( text) 5))))

(test step.stops-before-each-expression
  (is (equal '(push stepped-inner wait-time list push par
               wait-time wait-time wait-time push :done)
             (stops (make-list 30 :initial-element "STEP")))))

(test next.leaves-out-what-is-inside
  (is (equal '(push stepped-inner push par push :done)
             (stops (make-list 30 :initial-element "NEXT")))))

(test out.stops-after-what-the-expression-is-part-of
  (is (equal '(push stepped-inner wait-time push)
             (stops '("STEP" "STEP" "OUT" "CONTINUE")))))

(test continue.stops-no-more
  (is (equal '(push) (stops '("CONTINUE"))))
  (is (equal '(push stepped-inner) (stops '("STEP" "CONTINUE")))))

(test step.shows-where-it-is
  (let ((text (second (nth-value 1 (stops '("STEP" "CONTINUE"))))))
    (is-true (has-words-p text "Next: (stepped-inner 1)" "in task stepped, at tick 0"
                          "count = 3"))))

(test step-task.is-for-one-task-and-can-be-ended
  (let* ((runner (rpl:make-plan-runner))
         (free (rpl:start-plan runner 'stepped 2))
         (watched (rpl:start-plan runner 'stepped 2)))
    (rpl:step-task watched)
    (let ((texts (call-answering (lambda () (rpl:react-to-all runner)) '("STEP" "STEP" "STEP"))))
      (is (= 3 (length texts)))
      (is (every (lambda (text) (search "in task stepped" text)) texts)))
    (rpl:step-task watched nil)
    (is (null (call-answering (lambda ()
                                (loop for tick from 1 to 9
                                      do (rpl:advance-timers runner tick)
                                         (rpl:react-to-all runner)))
                              '())))
    (is (rpl:task-over-p free))
    (is (rpl:task-over-p watched)))
  (signals base:wrong-argument (rpl:step-task 7)))

(test step-plan.goes-through-a-robots-plan
  (run:with-simulation (ars-user::butler :clean t)
    (multiple-value-bind (texts values)
        (call-answering (lambda () (driver:step-plan 'ars-user::stroll 1/2)) '("STEP" "STEP"))
      (is (equal '(rpl-robot-turn wait-for fluent-value)
                 (mapcar #'operator-in texts)))
      (is (eq :succeeded (second values))))))

(test break.nobody-is-nobody-inside-of-others-code-too
  "A plan that handles its own Lisp errors does so where nobody answers a debugger."
  (let ((base:*message-queue* (base:make-message-queue))
        (base:*break-on-user-error* t))
    (with-nobody-there ()
      (is (eq :handled
              (base:call-user-code
               (lambda ()
                 (rpl:run-plan-alone (rpl:interp-lambda ()
                                       (rpl:handle-failure ((error () (return :handled)))
                                         (parse-integer "x")))))
               "a test")))
      (base:call-user-code (lambda () (is-false (base:debugger-available-p))) "a test"))
    (base:with-debugger-hook ((lambda (condition hook) (declare (ignore condition hook))))
      (base:call-user-code (lambda () (is-true (base:debugger-available-p))) "a test"))))

;;; Restarts.

(defun restarts-of-plan (form)
  "Return the texts of the restarts that are offered when the plan of FORM signals an error."
  (let ((base:*break-on-user-error* t) (texts '()))
    (flet ((note (condition hook)
             (declare (ignore hook))
             (setf texts (mapcar #'princ-to-string (compute-restarts condition)))
             (invoke-restart 'rpl:leave-plan)))
      (run:with-simulation (ars-worlds:dot)
        (base:with-debugger-hook (#'note)
          (driver:run-plan (rpl:make-plan form)))))
    texts))

(test restarts.name-the-plan-and-offer-each-thing-once
  (dolist (form '((rpl:seq (rpl:wait-time 1) (car 'x)) (rpl:seq (car 'x)) (+ 1 (car 'x))))
    (let ((texts (restarts-of-plan form)))
      (is (= 1 (count-if (lambda (text) (eql 0 (search "Do (" text))) texts)) "~A" texts)
      (is-false (find-if (lambda (text) (search "participant" text)) texts)))))

(defun restart-called (name condition)
  "Return the innermost restart for CONDITION of that NAME, or NIL."
  (find name (compute-restarts condition) :key #'restart-name :test #'string=))

(test restarts.offer-nothing-again-that-would-end-the-plan
  "To try the plans' whole reaction again would leave the step under way, which ends its plan."
  (is-false (find-if (lambda (text) (search "Try the plans" text))
                     (restarts-of-plan '(rpl:seq (rpl:wait-time 1) (car 'x)))))
  (run:with-simulation (ars-user::butler :clean t)
    (let ((offered :none))
      (base:with-debugger-hook ((lambda (break hook)
                                  (declare (ignore hook))
                                  (setf offered (restart-called "RETRY" break))
                                  (invoke-restart (find-restart 'continue break))))
        (is (eq :succeeded
                (nth-value 1 (driver:step-plan 'ars-user::stroll 1/2)))))
      (is (null offered)))))

(test restarts.of-code-that-a-plan-has-called-are-its-own
  (let ((calls 0) (base:*break-on-user-error* t))
    (run:with-simulation (ars-worlds:dot)
      (base:with-debugger-hook ((lambda (condition hook)
                                  (declare (ignore hook))
                                  (invoke-restart (restart-called "RETRY" condition))))
        (is (eql 2 (driver:run-plan
                    (rpl:make-plan `(funcall ,(lambda ()
                                                (base:call-user-code
                                                 (lambda ()
                                                   (when (< (incf calls) 2) (error "Once."))
                                                   calls)
                                                 "a test")))))))))))
