;;;; rpl-fairness.lisp -- plans that never wait, kills, changes from outside, depth.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Runaways.

(defun start-listener (runner fluent note)
  "Start a plan of RUNNER that calls NOTE when FLUENT is pulsed."
  (rpl:start-plan runner (rpl:interp-lambda ()
                           (rpl:wait-for fluent)
                           (funcall note))))

(test fairness.a-runaway-deafens-nobody
  (with-runner (runner)
    (let ((fluents (loop repeat 100 collect (fluent))) (heard 0) (stop nil))
      (rpl:start-plan runner (rpl:interp-lambda () (loop until stop (itself 1))))
      (dolist (f fluents) (start-listener runner f (lambda () (incf heard))))
      (is (eq :budget (rpl:react-to-all runner)))
      (dolist (f fluents) (rpl:post-entry runner `((:pulse ,f))))
      (is (eq :budget (rpl:react-to-all runner)))
      (is (= 100 heard))
      (setf stop t)
      (is (eq :idle (rpl:react-to-all runner)))
      (is (null (rpl:plan-runner-tasks runner))))))

(test fairness.two-that-wake-each-other-deafen-nobody
  (with-runner (runner)
    (let ((ping (fluent)) (pong (fluent)) (f (fluent)) (heard nil))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:par (rpl:whenever ping (rpl:pulse pong))
                                        (rpl:whenever pong (rpl:pulse ping))
                                        (rpl:pulse ping))))
      (start-listener runner f (lambda () (setf heard t)))
      (rpl:react-to-all runner)
      (rpl:post-entry runner `((:pulse ,f)))
      (rpl:react-to-all runner)
      (is-true heard))))

(test fairness.a-long-plan-ends
  (with-runner (runner)
    (let ((task (rpl:start-plan runner (rpl:interp-lambda () (rpl:n-times 2500000 nil) :done)))
          (reactions 0))
      (loop until (eq :idle (rpl:react-to-all runner)) do (incf reactions))
      (is (<= 2 reactions 9))
      (is (eq :done (rpl:task-result task))))))

(test fairness.a-failure-that-is-retried-for-ever-lets-time-pass
  (is (eq :limit (nth-value 1 (let ((base:*message-queue* (base:make-message-queue))
                                    (rpl:*runaway-limit* 10000))
                                (rpl:run-plan-alone
                                 (rpl:interp-lambda ()
                                   (rpl:handle-failure ((t () (rpl:retry))) (rpl:fail)))
                                 :limit 5))))))

(test fairness.a-reaction-can-be-ended-early
  (with-runner (runner)
    (let ((turns 0))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:n-times 3
                                 (incf turns)
                                 (rpl:exhaust-reaction))))
      (loop for expected from 1 to 3
            do (is (eq :budget (rpl:react-to-all runner)))
               (is (= expected turns)))
      (rpl:react-to-all runner)
      (is (null (base:take-messages)))
      (is (null (rpl:plan-runner-tasks runner))))))

;;; Kills.

(test stop-plan.is-heard-between-steps
  (with-runner (runner)
    (let* ((n 0) (cleaned nil)
           (task (rpl:start-plan
                  runner (rpl:interp-lambda ()
                           (rpl:evap-protect
                            (loop (rpl:seq (when (= 1000 (incf n))
                                             (base:join-thread
                                              (base:start-thread (lambda () (rpl:stop-plan runner))
                                                                 "killer")))
                                           (itself 1)))
                            (setf cleaned t))))))
      (is (eq :idle (rpl:react-to-all runner)))
      (is (eq :evaporated (rpl:task-state task)))
      (is (<= 1000 n 1001))
      (is-true cleaned))))

(test stop-plan.ends-what-has-used-its-slice
  (with-runner (runner)
    (let ((task (rpl:start-plan runner (rpl:interp-lambda ()
                                         (rpl:evap-protect (loop (itself 1)) (rpl:wait-time 2))))))
      (is (eq :budget (rpl:react-to-all runner)))
      (rpl:stop-plan runner task)
      (is (eq :idle (rpl:react-to-all runner)))
      (is (not (rpl:task-over-p task)))
      (rpl:advance-timers runner 2)
      (rpl:react-to-all runner)
      (is (eq :evaporated (rpl:task-state task))))))

(test evaporate.from-outside-is-heard-by-the-plan
  (with-runner (runner)
    (let ((task (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-time 9)))))
      (rpl:react-to-all runner)
      (rpl:evaporate task)
      (is (not (rpl:runner-idle-p runner)))
      (rpl:react-to-all runner)
      (is (eq :evaporated (rpl:task-state task))))))

(test blocking.what-evaporates-is-kept-by-nobody
  "A cleanup that has begun before it was blocked ends when the whole evaporates."
  (with-runner (runner)
    (let ((task (rpl:start-plan
                 runner
                 (rpl:interp-lambda ()
                   (rpl:with-tags
                     (rpl:par (:tag a (rpl:evap-protect 1 (rpl:wait-time 2)))
                              (rpl:seq (rpl:wait-time 1)
                                       (rpl:with-task-blocked a
                                         (rpl:evap-protect
                                          (rpl:wait-time 100)
                                          (rpl:wait-for
                                           (rpl:fl-funcall #'member (rpl:task-status a)
                                                           '(:evaporated :succeeded))))))))))))
      (loop for tick from 0 to 10
            do (rpl:advance-timers runner tick)
               (rpl:react-to-all runner))
      (is (not (rpl:task-over-p task)))
      (rpl:stop-plan runner task)
      (rpl:react-to-all runner)
      (is (rpl:task-over-p task)))))

(test blocking.a-cleanups-own-parts-can-be-blocked
  (let ((log '()))
    (rpl:run-plan-alone
     (rpl:interp-lambda ()
       (rpl:pursue
         (rpl:wait-time 1)
         (rpl:evap-protect
          (rpl:wait-time 9)
          (rpl:with-tags
            (rpl:par (:tag part (rpl:seq (rpl:wait-time 1) (push (list :part (rpl:plan-time)) log)))
                     (rpl:with-task-blocked part
                       (rpl:wait-time 5)
                       (push (list :blocker (rpl:plan-time)) log))))))))
    (is (equal '((:part 6) (:blocker 6)) log))))

;;; Changes from outside.

(test set-value.from-outside-wakes-who-waits
  (with-runner (runner)
    (let* ((f (fluent)) (g (fluent))
           (task (rpl:start-plan runner (rpl:interp-lambda ()
                                          (list (rpl:wait-for f)
                                                (rpl:wait-for (and f g)))))))
      (rpl:react-to-all runner)
      (rpl:set-value f 1)
      (is (= 1 (rpl:fluent-value f)))
      (rpl:react-to-all runner)
      (base:join-thread (base:start-thread (lambda () (rpl:pulse g 2)) "pulser"))
      (is (null (rpl:fluent-value g)))
      (rpl:react-to-all runner)
      (is (equal '(1 2) (rpl:task-result task))))))

(test set-value.from-another-thread-during-a-reaction-is-heard
  (with-runner (runner)
    (let* ((f (fluent)) (other (fluent))
           (task (rpl:start-plan
                  runner (rpl:interp-lambda ()
                           (rpl:pursue
                             (rpl:wait-for f)
                             (rpl:seq
                               (base:join-thread
                                (base:start-thread (lambda () (rpl:set-value f :set)) "setter"))
                               (rpl:wait-for other)))))))
      (rpl:react-to-all runner)
      (is (eq :set (rpl:task-result task)))
      (is (eq :set (rpl:fluent-value f))))))

(test set-value.no-change-from-threads-is-lost
  "A plan follows a count that another thread raises, wherever it is when it is raised."
  (with-runner (runner)
    (let* ((f (fluent 0)) (last 2000)
           (task (rpl:start-plan runner (rpl:interp-lambda ()
                                          (loop until (= f last)
                                            (let ((seen (rpl:fluent-value f)))
                                              (rpl:wait-for (or (> f seen) (= f last))))))))
           (thread (base:start-thread (lambda () (dotimes (i last) (rpl:set-value f (1+ i))))
                                      "counter")))
      (loop until (rpl:task-over-p task) do (rpl:react-to-all runner))
      (base:join-thread thread)
      (is (eq :succeeded (rpl:task-state task))))))

;;; Depth.

(rpl:def-interp-proc down-without-end () (rpl:seq (rpl:wait-time 0) (down-without-end)))
(rpl:def-interp-proc wide-without-end () (rpl:par (wide-without-end) (rpl:wait-time 9)))
(rpl:def-interp-proc down-by (n) (if (> n 0) (down-by (- n 1)) :bottom))

(test depth.recursion-without-end-fails
  (dolist (plan '(down-without-end wide-without-end))
    (multiple-value-bind (failure state) (rpl:run-plan-alone plan)
      (is (eq :failed state))
      (is (eq :too-deep (rpl:failure-class failure))))))

(test depth.the-limit-can-be-set
  (let ((rpl:*plan-depth-limit* 10))
    (is (eq :bottom (rpl:run-plan-alone 'down-by :arguments '(10))))
    (is (eq :failed (nth-value 1 (rpl:run-plan-alone 'down-by :arguments '(11)))))))

(test pulse.from-outside-is-heard-after-who-is-ready-has-come-to-its-wait
  (with-runner (runner)
    (let* ((f (fluent)) (plan (rpl:interp-lambda () (rpl:wait-for f) :heard))
           (first (rpl:start-plan runner plan)))
      (rpl:react-to-all runner)
      (let ((second (rpl:start-plan runner plan)))
        (rpl:pulse f)
        (rpl:react-to-all runner)
        (is (eq :heard (rpl:task-result first)))
        (is (eq :heard (rpl:task-result second)))))))
