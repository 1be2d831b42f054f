;;;; troubles.lisp -- errors in users' code reach the caller who started that code.

(in-package :ars-magna.tests)

(def-suite* troubles :in ars-magna)

(defun err-at-turn (&optional (angle 1))
  "Turn ROVER by ANGLE; the continuation signals an error."
  (command:robot-turn rover angle (lambda (&rest results)
                                    (declare (ignore results))
                                    (error "no turns"))))

(defmacro error-output (&body body)
  "Return what BODY writes to the error output."
  `(let ((*error-output* (make-string-output-stream)))
     ,@body
     (get-output-stream-string *error-output*)))

;;; Headless.

(test with-simulation.shows-errors-that-nobody-has-read
  (let ((text (error-output (run:with-simulation (rover) (err-at-turn) (run:run-ticks 30)))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "*ERROR* -> Error in the continuation of robot-turn: no turns")))
  (is (string= "" (error-output (run:with-simulation (rover)
                                  (err-at-turn)
                                  (run:run-ticks 30)
                                  (displayed))))
      "what was read is not shown")
  (is (string= "" (error-output (run:with-simulation (rover :errors :collect)
                                  (err-at-turn)
                                  (run:run-ticks 30))))))

(test with-simulation.shows-errors-also-if-it-is-left
  (is-true (has-words-p (error-output (ignore-errors (run:with-simulation (rover)
                                                       (err-at-turn)
                                                       (run:run-ticks 30)
                                                       (error "out"))))
                        "no turns"))
  (is-true (has-words-p (error-output (run:with-simulation (rover) (err-at-turn)))
                        "no turns")
           "an error as the run ends"))

(test with-simulation.lets-programs-go-on-to-the-end
  "A program in the style of the manual asks for more when it is interrupted by the end."
  (labels ((go-on (&rest results)
             (declare (ignore results))
             (command:robot-turn rover 1 #'go-on)))
    (is (string= "" (error-output (run:with-simulation (rover :errors :signal)
                                    (go-on)
                                    (run:run-ticks 20)))))))

(test with-simulation.counts-what-comes-again
  (let ((text (error-output (run:with-simulation (rover)
                              (loop repeat 3
                                    do (err-at-turn)
                                       (run:run-ticks 30))))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "no turns (3 times)"))))

(test with-simulation.shows-what-a-robot-failed-to-do-unless-its-program-was-told
  (flet ((text (continuation)
           (error-output (run:with-simulation (rover)
                           (command:robot-go-forward rover 999 continuation)
                           (run:run-ticks 900)))))
    (is-true (has-words-p (text nil) "Robot is blocked"))
    (is (string= "" (text (constantly nil))))))

(test errors.are-signalled-where-ticks-pass
  (run:with-simulation (rover :errors :signal)
    (let ((seen 0))
      (run:add-observer (lambda (simulation) (declare (ignore simulation)) (incf seen)))
      (err-at-turn)
      (let ((trouble (handler-case (run:run-ticks 30)
                       (base:user-code-error (condition) condition))))
        (is (string= "Error in the continuation of robot-turn: no turns" (princ-to-string trouble)))
        (is (typep (base:user-code-error-cause trouble) 'simple-error)))
      (is (< 0 (run:simulation-tick) 30))
      (is (= seen (run:simulation-tick)) "its tick has been finished")
      (is (not (search "no turns" (displayed))) "it is no message any more")
      (run:run-ticks 5)
      (is (= 1 (length (run:simulation-errors)))))))

(test errors.that-are-signalled-let-the-other-ticks-pass-if-told-to
  (run:with-simulation (rover :errors :signal)
    (err-at-turn)
    (handler-bind ((base:user-code-error #'continue))
      (is (= 30 (run:run-ticks 30))))))

(test errors.are-signalled-at-the-end-at-last
  (let ((text (error-output
                (signals base:user-code-error
                  (run:with-simulation (rover :errors :signal) (err-at-turn)))
                (signals base:user-code-error
                  (run:with-simulation (rover :errors :signal)
                    (driver:rpl-init-robot rover)
                    (driver:begin-plan (rpl:interp-lambda () (error "at once"))))))))
    (is (null (search "*ERROR*" text)) "what is signalled is not shown, too")
    (is (= 2 (length (lines-of text))) "no ticks have passed"))
  (is (eql 7 (run:with-simulation (rover :errors :signal) 7))))

(test errors.of-a-journal-are-not-shown-again
  (let ((journal nil))
    (error-output (run:with-simulation (rover :journal t)
                    (command:robot-go-forward rover 999)
                    (run:run-ticks 900)
                    (setf journal (run:simulation-journal (time:current-simulation)))))
    (is (string= "" (error-output (run:with-replay (journal) (run:run-ticks 1)))))
    (is-true (has-words-p (error-output (run:with-replay (journal)
                                          (err-at-turn)
                                          (run:run-ticks 30)))
                          "no turns"))))

(test errors.are-signalled-in-forks-too
  (run:with-simulation (rover :errors :signal)
    (signals base:user-code-error
      (run:with-fork ()
        (err-at-turn)
        (run:run-ticks 30)))
    (is (null (run:simulation-errors)) "the run around it knows nothing of that"))
  (is-true (has-words-p (error-output (run:with-simulation (rover)
                                        (run:with-fork ()
                                          (err-at-turn)
                                          (run:run-ticks 30))))
                        "no turns")))

(test errors.of-a-rewound-run-do-not-disturb-the-rewinding
  (run:with-simulation (rover :errors :signal :keep t)
    (run:run-ticks 1)
    (err-at-turn)
    (signals base:user-code-error (run:run-ticks 30))
    (run:run-ticks 10)
    (let ((tick (run:simulation-tick)))
      (run:rewind 12)
      (is (= (- tick 12) (run:simulation-tick)) "it is before the error"))))

(test errors.are-collected
  (let ((simulation nil))
    (run:with-simulation (rover :errors :collect)
      (setf simulation (time:current-simulation))
      (driver:rpl-init-robot rover)
      (loop repeat 2
            do (err-at-turn)
               (run:run-ticks 30))
      (driver:begin-plan (rpl:interp-lambda () (rpl:fail :class :lost)))
      (run:run-ticks 1))
    (let ((errors (run:simulation-errors simulation)))
      (is (= 3 (length errors)))
      (is-true (has-words-p (princ-to-string (first errors)) "no turns"))
      (is (typep (base:user-code-error-cause (third errors)) 'rpl:plan-failure)))))

(test errors.have-one-of-three-policies
  (signals base:wrong-argument (run:with-simulation (rover :errors :ignore))))

(test plans.that-somebody-waits-for-fail-without-an-error
  (run:with-simulation (rover :errors :signal)
    (driver:rpl-init-robot rover)
    (is (eq :failed (nth-value 1 (driver:run-plan (rpl:interp-lambda () (rpl:fail))))))
    (is (eq :failed (nth-value 1 (driver:run-plan (rpl:interp-lambda () (error "no"))))))
    (is (null (run:simulation-errors)))
    (displayed)))

(test plans.that-die-of-an-error-are-shown
  "Also if the caller waits for them and ignores what they return."
  (dolist (function '(driver:run-plan driver:begin-plan))
    (is-true (has-words-p (error-output
                            (run:with-simulation (rover)
                              (driver:rpl-init-robot rover)
                              (funcall function (rpl:interp-lambda () (error "my slip")))
                              (run:run-ticks 2)))
                          "my slip")
             "~A" function))
  (flet ((says (&rest options)
           (error-output (run:call-with-simulation
                          (lambda ()
                            (driver:run-plan (rpl:make-plan '(rpl:fail :class :lost)))
                            (driver:run-plan (rpl:make-plan '(rpl:fail :class :lost))))
                          '(rover) :errors (or (first options) :report)))))
    (is-true (has-words-p (says) "failed: Plan failure :LOST" "which counts as true" ":FAILED"))
    (is (= 1 (count "failed: Plan failure" (lines-of (says)) :test #'search)) "once for a plan")
    (is (string= "" (says :collect)))))

(test errors.that-are-collected-are-the-latest
  (with-messages
    (loop for number to 1000
          do (base:queue-user-error t (princ-to-string number) "slip"))
    (let ((errors (base:user-code-errors-in base:*message-queue* (constantly t))))
      (is (= 1000 (length errors)))
      (is (equal '("1" "1000") (mapcar #'princ-to-string
                                       (list (first errors) (first (last errors)))))))
    (base:remove-errors-of-runs base:*message-queue* (constantly t))
    (is (null (base:user-code-errors-in base:*message-queue* (constantly t))))))

(test warnings.are-shown-that-ask-what-is-so-in-the-end
  "What a warning asks may itself queue a message."
  (flet ((shown (notable errors)
           (error-output (run:with-simulation (rover :errors errors)
                           (base:queue-message (base:make-message :warning '("odd")
                                                                  :notable-p notable)
                                               base:*message-queue*)))))
    (dolist (errors '(:report :signal :collect))
      (is-true (has-words-p (shown (lambda () (base:message-set "asked") t) errors) "odd"))
      (is (string= "" (shown (constantly nil) errors))))))

;;; Live, at a plain REPL.

(defun echo (&rest arguments)
  "Queue a message made of ARGUMENTS, as MAKE-MESSAGE takes them, where runs live. Return what is
shown at once."
  (let ((base:*message-queue* (base:make-message-queue :echoed (make-hash-table :test 'equal)))
        (base:*echo-output* nil))
    (error-output
      (dotimes (count 150)
        (base:queue-message (apply #'base:make-message arguments) base:*message-queue*)))))

(test errors.of-live-runs-are-shown-as-they-happen
  (let ((lines (lines-of (echo :error '("slip") :cause t))))
    (is (equal '("*ERROR* -> slip" "*ERROR* -> slip (10 times so far)"
                 "*ERROR* -> slip (100 times so far)")
               lines)))
  (is-true (has-words-p (echo :error '("blocked")) "blocked") "the robot fails, no code")
  (is (string= "" (echo :error '("blocked") :told-p t)) "a continuation was told")
  (is (string= "" (echo :warning '("interrupted"))))
  (is (string= "" (let ((base:flush-all-errors* t)) (echo :error '("slip") :cause t)))))

(test errors.of-live-runs-are-still-messages
  (let ((base:*message-queue* (base:make-message-queue :echoed (make-hash-table :test 'equal)))
        (base:*echo-output* nil))
    (is-true (has-words-p (error-output (base:queue-user-error t "slip" "slip")) "slip"))
    (is-true (has-words-p (displayed) "slip"))))

(test errors.of-live-runs-are-left-to-who-listens
  (let ((base:*message-queue* (base:make-message-queue :echoed (make-hash-table :test 'equal)))
        (heard 0))
    (setf (base:message-queue-listener base:*message-queue*) (lambda () (incf heard)))
    (is (string= "" (error-output (base:queue-user-error t "slip" "slip"))))
    (is (= 1 heard))))

(test messages.of-interrupts-wait-for-the-queue
  "What interrupts a thread that queues a message, and queues one too, comes after it."
  (let ((base:*message-queue* (base:make-message-queue)))
    (definitions::with-queue (base:*message-queue*)
      (base:interrupt-thread (base:current-thread) (lambda () (base:message-set "later"))))
    (is-true (has-words-p (displayed) "later"))))

;;; Experiments.

(rpl:def-interp-proc plan-to-dig (how)
  (rpl:wait-time 3)
  (if (eq how 'err)
      (error "no spade")
      (rpl:fail :class :too-hard)))

(rpl:def-interp-proc plan-to-loiter () (rpl:wait-time 80))

(defun come-of (&rest clauses)
  "Return what comes of a trial of ROVER with CLAUSES: a list (outcome reason ticks error)."
  (eval `(experiment:defexperiment question (:robots rover) ,@clauses))
  (first (outcomes)))

(test trials.with-a-begun-plan-that-errs-are-errors
  (destructuring-bind (outcome reason ticks error)
      (come-of '(:run (driver:begin-plan 'plan-to-dig 'err) (run:run-ticks 60)))
    (is (equal '("error" "") (list outcome reason)))
    (is (< ticks 10))
    (is-true (has-words-p error "plan-to-dig" "no spade") "~A" error)))

(test trials.with-a-begun-plan-that-fails-are-failures
  (destructuring-bind (outcome reason ticks error)
      (come-of '(:run (driver:begin-plan 'plan-to-dig 'fail) (run:run-ticks 60)))
    (declare (ignore ticks))
    (is (equal '("failure" "too-hard") (list outcome reason)))
    (is-true (has-words-p error "plan-to-dig" "too-hard") "~A" error))
  (is (string= "success"
               (first (come-of '(:run (driver:begin-plan 'plan-to-dig 'fail) (run:run-ticks 60))
                               '(:success t))))
      ":success decides"))

(test trials.with-a-begun-plan-that-waits-in-vain-are-failures
  (destructuring-bind (outcome reason ticks error)
      (come-of '(:run (driver:begin-plan 'forlorn) (run:run-ticks 60)))
    (is (equal '("failure" "deadlock" 60) (list outcome reason ticks)))
    (is-true (has-words-p error "the plan forlorn waits for" "issue a command before the wait")
             "~A" error))
  (is (equal '("success" "" 60 "")
             (come-of '(:run (driver:begin-plan 'forlorn) (run:run-ticks 60))
                      '(:success t)))
      ":success decides")
  (is (equal '("success" "" 60 "")
             (come-of '(:run (driver:begin-plan 'plan-to-loiter) (run:run-ticks 60))))
      "it goes on"))

(test trials.that-return-a-begun-plan-go-as-that-has-gone
  (destructuring-bind (outcome reason ticks error)
      (come-of '(:run (driver:begin-plan 'plan-to-loiter)))
    (is (equal '("failure" "unfinished" 0) (list outcome reason ticks)))
    (is-true (has-words-p error "plan-to-loiter was not over" "run-plan") "~A" error))
  (is (equal '("success" "" 90 "")
             (come-of '(:run (prog1 (driver:begin-plan 'plan-to-loiter) (run:run-ticks 90))))))
  (is (equal '("success" "" 7 "")
             (come-of '(:run (driver:begin-plan 'plan-to-loiter))
                      '(:until (<= 7 (run:simulation-tick)))))))

(test trials.may-handle-errors
  (dolist (how '(err fail))
    (is (equal '("success" "" 60 "")
               (come-of `(:run (driver:begin-plan 'plan-to-dig ',how)
                               (handler-bind ((base:user-code-error #'continue))
                                 (run:run-ticks 60))))))))

(test measures.that-err-leave-the-others-and-the-outcome
  (eval '(experiment:defexperiment question (:robots rover)
          (:run (run:run-ticks 3) t)
          (:measure (before 1) (bad (error "no scale")) (odd (make-hash-table)) (after 2))))
  (let ((results (experiment:run-experiment 'question :trials 1 :workers 1 :stream nil)))
    (destructuring-bind (condition trial outcome reason ticks error) (first (rows-of results))
      (declare (ignore condition trial))
      (is (equal '("success" "" 3) (list outcome reason ticks)))
      (is-true (has-words-p error "measure bad" "no scale") "~A" error))
    (is (equal '(1) (measured results 'before)))
    (is (equal '(2) (measured results 'after)))))

(test is-success-rate.counts-errors-of-code-that-was-called
  (multiple-value-bind (passed text)
      (check-of (rates:is-success-rate (progn (err-at-turn) (run:run-ticks 30) t)
                  :robots rover :at-least 1 :trials 3))
    (is (not passed))
    (is-true (has-words-p text "error" "no turns") "~A" text)))
