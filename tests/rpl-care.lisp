;;;; rpl-care.lisp -- plans whose Lisp code is aborted, left or debugged; plans that must end.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun finish (runner)
  "Let RUNNER react to all."
  (let ((base:*message-queue* (base:make-message-queue)))
    (rpl:react-to-all runner)))

;;; Left for good.

(test left.a-throw-out-of-a-plan-ends-it-and-no-other
  (with-runner (runner)
    (let* ((cleaned nil) (go (fluent)) (valve (rpl:make-valve 'door))
           (other (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-for go) :heard)))
           (task (rpl:start-plan runner
                                 (rpl:interp-lambda ()
                                   (rpl:with-valve (valve)
                                     (rpl:par
                                       (rpl:wait-time 5)
                                       (rpl:evap-protect
                                        (rpl:seq (rpl:wait-time 1) (throw 'out :thrown))
                                        (setf cleaned t))))))))
      (rpl:react-to-all runner)
      (is (eq task (rpl:valve-owner valve)))
      (rpl:advance-timers runner 1)
      (is (eq :thrown (catch 'out (rpl:react-to-all runner))))
      (is (eq :idle (rpl:react-to-all runner)))
      (is-true cleaned)
      (is (eq :evaporated (rpl:task-state task)))
      (is (null (rpl:valve-owner valve)))
      (is (null (rpl:next-wake-time runner)))
      (rpl:set-value go t)
      (rpl:react-to-all runner)
      (is (eq :heard (rpl:task-result other))))))

(test left.a-throw-out-of-a-network-leaves-the-others-right
  "Who waits for a network that cannot be computed fails; the others hear what they wait for."
  (with-runner (runner)
    (let* ((f (fluent 0)) (armed nil)
           (bad (rpl:start-plan
                 runner
                 (rpl:interp-lambda ()
                   (rpl:wait-for (rpl:fl-funcall (lambda (x)
                                                   (if (and armed (= x 1))
                                                       (throw 'out nil)
                                                       (= x 9)))
                                                 f)))))
           (other (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-for (= f 2)) :heard))))
      (rpl:react-to-all runner)
      (setf armed t)
      (catch 'out (rpl:set-value f 1))
      (rpl:set-value f 2)
      (finish runner)
      (is (eq :failed (rpl:task-state bad)))
      (is (eq :heard (rpl:task-result other))))))

(test abort.ends-the-plan-not-the-runner
  (with-runner (runner)
    (let* ((cleaned nil)
           (other (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-time 1) :done)))
           (task (rpl:start-plan runner (rpl:interp-lambda ()
                                          (rpl:evap-protect (rpl:par (abort) (rpl:wait-time 3))
                                                            (setf cleaned t))))))
      (is (eq :idle (rpl:react-to-all runner)))
      (is (eq :evaporated (rpl:task-state task)))
      (is-true cleaned)
      (let ((messages (base:take-messages)))
        (is (= 1 (length messages)))
        (is (search "was aborted at (abort)" (base:message-text (first messages)))))
      (rpl:advance-timers runner 1)
      (rpl:react-to-all runner)
      (is (eq :done (rpl:task-result other))))))

(test abort.in-a-cleanup-gives-the-cleanup-up
  (with-runner (runner)
    (let* ((log '())
           (task (rpl:start-plan runner (rpl:interp-lambda ()
                                          (rpl:evap-protect
                                           (rpl:evap-protect 1 (rpl:seq (abort) (push :no log)))
                                           (push :outer log))))))
      (finish runner)
      (is (equal '(:outer) log))
      (is (eq :evaporated (rpl:task-state task))))))

;;; Ending all.

(test close-runner.leaves-nothing
  "Cleanups go on as far as they can without time; what they wait for is given up, aloud."
  (with-runner (runner)
    (let* ((log '()) (valve (rpl:make-valve 'door)) (f (fluent))
           (tasks (loop repeat 2
                        collect (rpl:start-plan
                                 runner
                                 (rpl:interp-lambda ()
                                   (rpl:evap-protect
                                    (rpl:with-valve (valve)
                                      (rpl:evap-protect (rpl:wait-for f)
                                                        (rpl:seq (push :begun log)
                                                                 (rpl:wait-time 3)
                                                                 (push :never log))))
                                    (rpl:seq (push :outer log)
                                             (rpl:par (rpl:wait-for f) (rpl:wait-time 8)))))))))
      (rpl:react-to-all runner)
      (rpl:close-runner runner)
      (is (null (rpl:plan-runner-tasks runner)))
      (is (every (lambda (task) (eq :evaporated (rpl:task-state task))) tasks))
      (is (equal '(:begun :outer :outer) (sort log #'string<)))
      (is (null (rpl:valve-owner valve)))
      (is (null (rpl:next-wake-time runner)))
      (is (null (fluents::fluent-first-watcher f)))
      (let ((texts (mapcar #'base:message-text (base:take-messages))))
        (is (= 3 (length texts)))
        (is (every (lambda (text) (search "was given up" text)) texts))))))

(test close-runner.also-during-a-cleanup
  (with-runner (runner)
    (let* ((task (rpl:start-plan runner (rpl:interp-lambda ()
                                          (rpl:evap-protect 1 (rpl:wait-time 3))
                                          (error "not reached")))))
      (rpl:react-to-all runner)
      (rpl:close-runner runner)
      (is (eq :evaporated (rpl:task-state task)))
      (is (= 1 (length (base:take-messages)))))))

;;; In the debugger.

(defun answer-debugger (runner &rest answers)
  "Let RUNNER react; when plans enter the debugger invoke the restarts ANSWERS, each (name
value...), one after the other."
  (let ((base:*break-on-user-error* t)
        (base:*message-queue* (base:make-message-queue)))
    (base:with-debugger-hook ((lambda (condition hook)
                                (declare (ignore hook))
                                (destructuring-bind (name &rest values) (pop answers)
                                  (apply #'invoke-restart (find-restart name condition) values))))
      (rpl:react-to-all runner))))

(defmacro answered (answers &body body)
  "Return how BODY, a plan, ends if its errors are answered with ANSWERS: value and state."
  `(with-runner (runner)
     (let ((task (rpl:start-plan runner (rpl:interp-lambda () ,@body))))
       (answer-debugger runner ,@(loop for answer in answers collect `',answer))
       (list (rpl:task-result task) (rpl:task-state task)))))

(rpl:def-interp-proc stumbling ()
  (rpl:seq (error "no")))

(test debugger.restarts-name-the-plan
  (let ((offered '()) (again 0))
    (with-runner (runner)
      (let ((base:*break-on-user-error* t)
            (base:*message-queue* (base:make-message-queue)))
        (rpl:start-plan runner 'stumbling)
        (base:with-debugger-hook ((lambda (condition hook)
                                    (declare (ignore hook))
                                    (dolist (name '(tasks::fail-task tasks::leave-plan abort))
                                      (push (princ-to-string (find-restart name condition))
                                            offered))
                                    (setf again (count 'tasks::retry (compute-restarts condition)
                                                       :key #'restart-name))
                                    (invoke-restart (find-restart 'tasks::fail-task condition))))
          (rpl:react-to-all runner))))
    (is (equal '("Let the task stumbling fail." "End the plan stumbling, without a message."
                 "End the plan stumbling, with a message.")
               (reverse offered)))
    (is (= 1 again) "what can be done again is offered once")))

(test debugger.a-leaf-can-be-done-again
  (let ((tries 0))
    (is (equal '(:fine :succeeded)
               (answered ((tasks::retry) (tasks::retry))
                 (rpl:seq (rpl:wait-time 0)
                          (if (< (incf tries) 3) (error "not yet") :fine)))))
    (is (= 3 tries))))

(test debugger.what-is-no-step-of-its-own-can-be-done-again
  "The values that a binding, a condition or a wait needs."
  (let ((tries 0))
    (flet ((late (value) (if (oddp (incf tries)) (error "not yet") value)))
      (is (equal '((1 2) :succeeded)
                 (answered ((tasks::retry) (tasks::retry) (tasks::retry))
                   (rpl:seq (rpl:wait-time (late 0))
                            (let ((x (late 1)))
                              (rpl:wait-time 0)
                              (if (late t) (rpl:seq (rpl:wait-time 0) (list x 2)) 3))))))
      (is (= 6 tries)))))

(test debugger.a-leaf-can-return-a-value
  (is (equal '(5 :succeeded)
             (answered ((use-value 4))
               (let ((x (rpl:seq (rpl:wait-time 0) (error "oops"))))
                 (+ x 1))))))

(test debugger.the-task-can-be-let-fail
  (is (equal '((:handled "oops") :succeeded)
             (answered ((tasks::fail-task))
               (rpl:handle-failure ((error (e) (return (list :handled (princ-to-string e)))))
                 (rpl:par (rpl:wait-time 1) (error "oops")))))))

(test debugger.the-plan-can-be-ended
  (is (equal '(nil :evaporated)
             (answered ((abort))
               (rpl:handle-failure ((t () (return :handled)))
                 (rpl:par (rpl:wait-time 1) (error "oops")))))))

(test debugger.breaks-go-on
  (is (equal '(:went-on :succeeded)
             (answered ((continue)) (break "here") :went-on))))

(test debugger.without-anybody-there-errors-are-failures-and-breaks-pass
  (with-runner (runner)
    (let ((task (rpl:start-plan runner (rpl:interp-lambda ()
                                         (break "here")
                                         (rpl:handle-failure ((error () (return :failed)))
                                           (error "oops"))))))
      (let ((base:*break-on-user-error* t))
        (base:with-debugger-hook ('debugger-disabled-hook)
          (rpl:react-to-all runner)))
      (is (eq :failed (rpl:task-result task)))
      (is (= 1 (length (base:take-messages)))))))

(test abort.in-a-network-fails-who-waits-for-it-and-no-other-is-deaf
  (with-runner (runner)
    (let* ((f (fluent 1))
           (bad (rpl:start-plan runner (rpl:interp-lambda ()
                                         (rpl:wait-for (rpl:fl-funcall
                                                        (lambda (value)
                                                          (if (eql value 2) (abort) nil))
                                                        f)))))
           (other (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-for (eql f 2)) :heard))))
      (finish runner)
      (rpl:start-plan runner (rpl:interp-lambda () (rpl:set-value f 2)))
      (let ((base:*message-queue* (base:make-message-queue)))
        (rpl:react-to-all runner))
      (is (eq :failed (rpl:task-state bad)))
      (is (eq :heard (rpl:task-result other))))))

;;; Left in the middle of anything.

(defun left-at-change (nth)
  "Run a plan whose change number NTH of a fluent is left halfway by a throw; then end all. Return
what is wrong, NIL if nothing is."
  (with-runner (runner)
    (let* ((f (fluent 0)) (valve (rpl:make-valve 'door)) (changes 0) (cleaned 0)
           (other (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-for (= f -1)) :heard))))
      (rpl:start-plan runner
                      (rpl:interp-lambda ()
                        (rpl:with-valve (valve)
                          (rpl:evap-protect
                           (rpl:par (rpl:whenever (> f 2) (rpl:wait-time 1))
                                    (rpl:n-times 4
                                      (rpl:wait-time 1)
                                      (rpl:set-value f (+ 1 (rpl:fluent-value f)))
                                      (rpl:pursue (rpl:wait-for (> f 9)) (rpl:pulse f 10))))
                           (incf cleaned)))))
      (setf (fluents:home-on-change runner)
            (lambda (kind fluent value)
              (declare (ignore kind fluent value))
              (when (= nth (incf changes)) (throw 'out nil))))
      (loop for tick from 0 to 8
            do (rpl:advance-timers runner tick)
               (catch 'out (rpl:react-to-all runner))
               (rpl:react-to-all runner))
      (rpl:set-value f -1)
      (finish runner)
      (rpl:close-runner runner)
      (remove nil (list (and (< changes nth) :never-left)
                        (and (/= 1 cleaned) :not-cleaned)
                        (and (rpl:valve-owner valve) :valve-kept)
                        (and (not (eq :heard (rpl:task-result other))) :deaf)
                        (and (fluents::fluent-first-watcher f) :watched)
                        (and (rpl:next-wake-time runner) :timer)
                        (rpl:plan-runner-tasks runner))))))

(test left.in-the-middle-of-any-change-nothing-is-poisoned
  (loop for nth from 1 to 8
        do (is (null (left-at-change nth)) "change ~D" nth)))
