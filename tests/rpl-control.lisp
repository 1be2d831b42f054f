;;;; rpl-control.lisp -- suspending tasks, joining them, their variables, deadlines, k of n.

(in-package :ars-magna.tests)
(in-suite rpl)

(defmacro signals-failure (condition &body body)
  "Check that BODY, as a plan, fails of a Lisp error of type CONDITION."
  `(is (typep (rpl:lisp-failure-condition (plan-failure-of ,@body)) ',condition)))

;;; Suspend and wake up.

(test suspend.waits-still-count
  (is (equal '((:suspended 1) (:woken 6) (:worker 6))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker (rpl:wait-time 3) (note :worker))
                          (rpl:seq (rpl:wait-time 1)
                                   (rpl:suspend worker)
                                   (rpl:suspend worker)
                                   (note (rpl:fluent-value (rpl:task-status worker)))
                                   (rpl:wait-time 5)
                                   (note :woken)
                                   (rpl:wake-up worker))))))))

(test suspend.a-fluent-set-meanwhile-counts
  "CRAM's: what a suspended task waits for may happen; it hears of it when it is woken."
  (let ((f (fluent)))
    (is (equal '((:set 1) (:heard 3))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag worker (rpl:wait-for f) (note :heard))
                            (rpl:seq (rpl:suspend worker)
                                     (rpl:wait-time 1)
                                     (rpl:pulse f)
                                     (note :set)
                                     (rpl:wait-time 2)
                                     (rpl:wake-up worker)))))))))

(test suspend.a-failure-in-a-suspended-tree-counts-after-waking
  (is (equal '((:woken 4) (:lost 4))
             (with-log (note)
               (plan-value
                 (rpl:handle-failure ((:lost () (note :lost) (return)))
                   (rpl:par (:tag worker
                              (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:fail :class :lost))
                                       (rpl:wait-time 9)))
                            (rpl:seq (rpl:wait-time 1/2)
                                     (rpl:suspend worker)
                                     (rpl:wait-time 7/2)
                                     (note :woken)
                                     (rpl:wake-up worker)
                                     (rpl:wait-time 9)))))))))

(test suspend.a-suspended-part-does-not-hold-the-whole
  "CRAM's: the parent succeeds, the suspended child evaporates."
  (let (child)
    (is (eq :done (plan-value
                    (rpl:pursue (:tag worker (setf child worker) (rpl:wait-time 1))
                                (rpl:seq (rpl:suspend worker) (rpl:wait-time 2) :done)))))
    (is (eq :evaporated (rpl:task-state child)))))

(test suspend.oneself-and-what-one-is-part-of
  "The step in which it happens is the last one."
  (dolist (depth '(0 1 2))
    (is (equal '((:before 0) (:after 3))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag worker
                              (labels ((deeper (n)
                                         (if (plusp n)
                                             (rpl:par (deeper (1- n)))
                                             (rpl:seq (note :before)
                                                      (rpl:suspend worker)
                                                      (note :after)))))
                                (deeper depth)))
                            (rpl:seq (rpl:wait-time 3) (rpl:wake-up worker)))))))))

(test suspend.before-the-start
  (is (equal '((:suspended 1) (:started 4))
             (with-log (note)
               (plan-value
                 (rpl:with-tags
                   (rpl:suspend later)
                   (rpl:wait-time 1)
                   (rpl:par (:tag later (note :started))
                            (rpl:seq (note (rpl:fluent-value (rpl:task-status later)))
                                     (rpl:wait-time 3)
                                     (rpl:wake-up later)))))))))

(test suspend.with-task-blocked-is-another-matter
  "Neither undoes the other."
  (is (equal '((:suspended 0) (:blocked 0) (:running 2))
             (with-log (note)
               (plan-value
                 (rpl:pursue (:tag worker (rpl:wait-time 9))
                             (rpl:seq (rpl:with-task-blocked worker
                                        (rpl:suspend worker)
                                        (note (rpl:fluent-value (rpl:task-status worker)))
                                        (rpl:wake-up worker)
                                        (note (rpl:fluent-value (rpl:task-status worker)))
                                        (rpl:wait-time 2))
                                      (note (rpl:fluent-value (rpl:task-status worker))))))))))

(test with-task-suspended.is-cram-s-name
  (is (equal '((:suspended 0) (:worker 2))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker (rpl:wait-time 1) (note :worker))
                          (rpl:with-task-suspended worker
                            (note (rpl:fluent-value (rpl:task-status worker)))
                            (rpl:wait-time 2))))))))

(test suspend.from-outside
  "From a REPL, headless or in another thread, it is heard before the plans react again."
  (with-runner (runner)
    (let ((task (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-time 1) :done))))
      (rpl:react-to-all runner)
      (base:join-thread (base:start-thread (lambda () (rpl:suspend task)) "suspender"))
      (rpl:apply-next-batch runner)
      (rpl:advance-timers runner 1)
      (rpl:react-to-all runner)
      (is (not (rpl:task-over-p task)))
      (rpl:wake-up task)
      (rpl:apply-next-batch runner)
      (rpl:react-to-all runner)
      (is (eq :done (rpl:task-result task)))
      (is (zerop (rpl:runner-blocks runner))))))

(test suspend.a-suspended-plan-can-be-ended
  (with-runner (runner)
    (let* ((cleaned '())
           (task (rpl:start-plan
                  runner
                  (rpl:interp-lambda ()
                    (rpl:evap-protect (rpl:wait-time 9)
                      (rpl:par (push 1 cleaned) (rpl:seq (rpl:wait-time 1) (push 2 cleaned))))))))
      (rpl:react-to-all runner)
      (rpl:suspend task)
      (rpl:apply-next-batch runner)
      (rpl:stop-plan runner)
      (rpl:apply-next-batch runner)
      (rpl:react-to-all runner)
      (rpl:advance-timers runner 1)
      (rpl:react-to-all runner)
      (is (equal '(2 1) cleaned))
      (is (eq :evaporated (rpl:task-state task)))
      (is (zerop (rpl:runner-blocks runner))))))

(test suspend.wants-a-task
  (signals base:wrong-argument (rpl:suspend 3))
  (signals base:wrong-argument (rpl:wake-up 'worker)))

(test suspend.plans-of-another-runner
  "They can be suspended, not blocked while something lasts: nobody would know for how long."
  (with-runner (runner)
    (let ((other (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-time 9)))))
      (signals-failure base:misuse (rpl:with-task-blocked other (rpl:wait-time 1)))
      (signals-failure base:misuse (rpl:join-task other))
      (signals-failure base:misuse (rpl:partial-order ((:tag a 1)) (:order other a)))
      (is (eq other (plan-value (rpl:suspend other))))
      (rpl:apply-next-batch runner)
      (is (eq :suspended (rpl:fluent-value (rpl:task-status other)))))))

;;; What a task does about it.

(test on-suspension.reacts-each-time
  (is (equal '((:stop 1) (:stop 1) (:on 3) (:stop 4) (:stop 4) (:done 5))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker
                            (rpl:on-suspension (note :stop)
                              (rpl:par (rpl:on-suspension (note :stop) (rpl:wait-time 5))
                                       (rpl:seq (rpl:wait-time 2) (note :on)))
                              (note :done)))
                          (rpl:seq (rpl:wait-time 1)
                                   (rpl:with-task-blocked worker
                                     (rpl:with-task-blocked worker (rpl:wait-time 2)))
                                   (rpl:wait-time 1)
                                   (rpl:suspend worker)
                                   (rpl:wake-up worker))))))))

(test on-suspension.trouble-changes-nothing-else
  (let ((base:*message-queue* (base:make-message-queue)))
    (is (eq :done (rpl:run-plan-alone
                   (rpl:interp-lambda ()
                     (rpl:pursue (:tag worker
                                   (rpl:on-suspension (rpl:fail :class :stuck)
                                     (rpl:on-suspension (error "oops") (rpl:wait-time 2)))
                                   :done)
                                 (rpl:seq (rpl:with-task-blocked worker) (rpl:wait-time 9)))))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (is (= 2 (length texts)))
      (is (search "an on-suspension" (first texts)))
      (is (search "stuck" (string-downcase (second texts)))))))

(test on-suspension.its-reaction-cannot-wait
  (refuses rpl:misplaced-suspension (rpl:on-suspension (rpl:wait-time 1) (rpl:wait-time 2)))
  (refuses base:malformed-definition (rpl:on-suspension)))

(test retry-after-suspension.the-body-is-unwound-and-run-anew
  "Its cleanup is done while the task is blocked; the second run starts when it is so no longer."
  (is (equal '((:begin 0) (:unwound 3) (:woken 4) (:begin 4) (:unwound 10) (:value 10))
             (with-log (note)
               (plan-value
                 (rpl:par (rpl:seq (rpl:wait-time 2)
                                   (rpl:with-task-blocked worker (rpl:wait-time 2))
                                   (note :woken))
                          (:tag worker
                            (note (rpl:retry-after-suspension
                                    (note :begin)
                                    (rpl:evap-protect (rpl:wait-time 5)
                                      (rpl:seq (rpl:wait-time 1) (note :unwound)))
                                    :value))))))))
  (is (eq :left (plan-value (block nil (rpl:retry-after-suspension (return :left))))))
  (is (eq :lost (rpl:failure-class
                 (plan-failure-of (rpl:retry-after-suspension (rpl:fail :class :lost)))))))

(test retry-after-suspension.a-cleanup-longer-than-the-suspension
  (is (equal '((:begin 0) (:woken 2) (:begin 6) (:done 7))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker
                            (rpl:retry-after-suspension
                              (note :begin)
                              (if (zerop (rpl:plan-time))
                                  (rpl:evap-protect (rpl:wait-time 3) (rpl:wait-time 5))
                                  (rpl:wait-time 1)))
                            (note :done))
                          (rpl:seq (rpl:wait-time 1)
                                   (rpl:with-task-suspended worker (rpl:wait-time 1))
                                   (note :woken))))))))

(test without-scheduling.nobody-comes-between
  (let ((f (fluent)))
    (flet ((log-of (plan) (with-log (note) (rpl:run-plan-alone plan :arguments (list #'note)))))
      (is (equal '((:one 0) (:two 0) (:policy 0))
                 (log-of (rpl:interp-lambda (note)
                           (rpl:with-policy (rpl:whenever f (funcall note :policy))
                             (rpl:without-scheduling (rpl:set-value f t) (funcall note :one)
                                                     (funcall note :two))
                             (rpl:wait-time 1)))))))))

(test without-scheduling.a-kill-is-heard-at-its-end
  (is (equal '((:inside 0) (:rest 0))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker
                            (rpl:without-scheduling (rpl:evaporate worker) (rpl:suspend worker)
                                                    (note :inside))
                            (note :after))
                          (note :rest))))))
  (refuses rpl:misplaced-suspension (rpl:without-scheduling (rpl:wait-time 1)))
  (refuses rpl:misplaced-suspension (rpl:without-scheduling (rpl:par 1 2))))

;;; Joining.

(test join-task.the-value-or-the-failure
  (is (equal '(:value 3) (plan-value
                           (let ((value nil))
                             (rpl:par (:tag worker (rpl:wait-time 3) :value)
                                      (setf value (rpl:join-task worker)))
                             (list value (rpl:plan-time))))))
  (is (eq :again (plan-value (rpl:seq (:tag worker :again) (rpl:join-task worker)))))
  (is (eq :lost (rpl:failure-class
                 (plan-failure-of
                   (rpl:try-all (:tag worker (rpl:wait-time 1) (rpl:fail :class :lost))
                                (rpl:wait-time 2))
                   (rpl:join-task worker)))))
  (is (equal '(nil nil)
             (plan-value
               (list (rpl:seq (rpl:par (:tag worker (rpl:wait-time 9))
                                       (rpl:seq (rpl:wait-time 1) (rpl:evaporate worker)))
                              (rpl:join-task worker))
                     (rpl:seq (block away (:tag leaver (return-from away 1)))
                              (rpl:join-task leaver)))))))

(test join-task.chain-and-oneself
  (is (= 6 (plan-value
             (rpl:par (:tag a (rpl:wait-time 1) 1)
                      (:tag b (rpl:wait-time 1) (+ 2 (rpl:join-task a)))
                      (+ 3 (rpl:join-task b))))))
  (is (typep (rpl:lisp-failure-condition (plan-failure-of (:tag me (rpl:join-task me))))
             'base:misuse))
  (let ((base:*message-queue* (base:make-message-queue)))
    (is (eq :done (rpl:run-plan-alone
                   (rpl:interp-lambda ()
                     (rpl:pursue (rpl:par (:tag a (rpl:join-task b)) (:tag b (rpl:join-task a)))
                                 (rpl:seq (rpl:wait-time 9) :done))))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (is (= 1 (length texts)))
      (is (search "Deadlock at tick 0: b waits for the end of a; a waits for the end of b."
                  (first texts))))))

;;; Tags that are run again, and side by side.

(test task-status.of-a-tag-goes-on-with-its-next-run
  (is (equal '((:done 2) (:done 4))
             (with-log (note)
               (plan-value
                 (rpl:pursue (rpl:seq (rpl:n-times 2 (rpl:wait-time 1) (:tag w (rpl:wait-time 1)))
                                      (rpl:wait-time 1))
                             (rpl:whenever (eq (rpl:task-status w) :succeeded) (note :done))))))))

(test par-loop.each-turn-has-tags-of-its-own
  (is (equal '((1 1) (2 2) (3 2))
             (sort (with-log (note)
                     (plan-value
                       (rpl:par-loop (n '(1 2 3))
                         (rpl:par (rpl:seq (:tag job (rpl:wait-time 2)) (note n))
                                  (when (= n 1) (rpl:seq (rpl:wait-time 1) (rpl:evaporate job)))))))
                   #'< :key #'first))))
