;;;; rpl-alone.lisp -- run-plan-alone leaves nothing behind, however the plan ends.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun left-of (runner fluent valve)
  "Return what a plan has left in RUNNER, FLUENT and VALVE."
  (remove nil (list* (rpl:valve-owner valve)
                     (fluents::fluent-first-watcher fluent)
                     (fluents::fluent-first-link fluent)
                     (rpl:plan-runner-tasks runner))))

(defun ended-alone (cleanup &optional limit)
  "Return how a plan ends that waits for ever, owning a valve, with CLEANUP, a form; what it has
left; and what was said."
  (let ((runner (rpl:make-plan-runner)) (fluent (rpl:create-fluent 'never))
        (valve (rpl:make-valve 'hand)) (base:*message-queue* (base:make-message-queue)))
    (let ((state (nth-value 1 (rpl:run-plan-alone
                               (rpl:make-plan `(rpl:with-valve (,valve)
                                                 (rpl:evap-protect
                                                     (rpl:wait-for (and ,fluent ,fluent))
                                                   ,cleanup)))
                               :runner runner :limit limit))))
      (list state (left-of runner fluent valve)
            (mapcar #'base:message-text (base:take-messages))))))

(test run-plan-alone.cleans-up-after-a-deadlock
  "What is cleaned up may take time."
  (let ((cleaned '()))
    (destructuring-bind (state left texts)
        (ended-alone `(rpl:seq (rpl:wait-time 3)
                               (funcall ,(lambda () (push (rpl:plan-time) cleaned)))))
      (is (eq :deadlock state))
      (is (null left))
      (is (= 1 (length texts)))
      (is (equal '(3) cleaned)))))

(test run-plan-alone.gives-up-cleanups-that-nothing-ends
  (destructuring-bind (state left texts) (ended-alone '(rpl:wait-for (rpl:create-fluent 'none)))
    (is (eq :deadlock state))
    (is (null left))
    (is (search "given up" (second texts)))))

(test run-plan-alone.cleans-up-until-its-limit
  (let ((cleaned '()))
    (flet ((ended (limit)
             (ended-alone `(rpl:with-policy (rpl:wait-time 50)
                             (rpl:wait-time 2)
                             (funcall ,(lambda () (push :done cleaned))))
                          limit)))
      (is (equal '(:deadlock nil) (subseq (ended 2) 0 2)))
      (is (equal '(:done) cleaned))
      (destructuring-bind (state left texts) (ended 1)
        (is (equal '(:deadlock nil) (list state left)))
        (is (search "given up at tick" (second texts))))
      (is (equal '(:done) cleaned)))))

(test run-plan-alone.ends-what-its-limit-cuts-short
  (let ((runner (rpl:make-plan-runner)) (cleaned nil))
    (is (eq :limit (nth-value 1 (rpl:run-plan-alone
                                 (rpl:interp-lambda ()
                                   (rpl:evap-protect (loop (rpl:wait-time 1)) (setf cleaned t)))
                                 :runner runner :limit 5))))
    (is-true cleaned)
    (is (null (rpl:plan-runner-tasks runner)))))

(test run-plan-alone.cleans-up-at-its-limit
  (let ((runner (rpl:make-plan-runner)) (cleaned nil))
    (rpl:run-plan-alone (rpl:interp-lambda ()
                          (rpl:evap-protect (rpl:wait-time 1000)
                            (setf cleaned (tasks::runner-tick runner))))
                        :runner runner :limit 200)
    (is (eql 200 cleaned))))

(test run-plan-alone.ends-what-is-left-by-a-throw
  (let ((runner (rpl:make-plan-runner)) (valve (rpl:make-valve 'hand)))
    (catch 'out
      (rpl:run-plan-alone (rpl:interp-lambda ()
                            (rpl:with-valve (valve) (rpl:wait-time 3) (throw 'out nil)))
                          :runner runner))
    (is (null (rpl:valve-owner valve)))
    (is (null (rpl:plan-runner-tasks runner)))))

(rpl:def-interp-proc keep-valve (valve)
  (rpl:with-valve (valve) (rpl:wait-for (rpl:create-fluent 'none))))

(test run-plan-alone.a-deadlock-names-who-has-the-valve
  (let ((runner (rpl:make-plan-runner)) (valve (rpl:make-valve 'hand))
        (base:*message-queue* (base:make-message-queue)))
    (rpl:start-plan runner 'keep-valve valve)
    (rpl:run-plan-alone (rpl:make-plan `(rpl:with-valve (,valve) 1)) :runner runner)
    (is (search "the valve hand that keep-valve has"
                (base:message-text (first (base:take-messages)))))))
