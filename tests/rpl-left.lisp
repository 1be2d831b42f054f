;;;; rpl-left.lisp -- plans whose caller leaves them, and robots taken over by others.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

(rpl:def-interp-proc guarded (valve log leave)
  "Own VALVE, turn, call LEAVE after some ticks, and note in LOG, a cons, what is cleaned up."
  (rpl:with-valve (valve)
    (rpl:evap-protect
     (rpl:seq (driver:rpl-robot-turn 30)
              (rpl:wait-time 3)
              (funcall leave)
              (rpl:wait-time 50))
     (push :cleaned (cdr log)))))

(defmacro leaving-run-plan (leave &body call)
  "Evaluate CALL, which runs the plan GUARDED by (RUN-IT), whose LEAVE leaves it; all must be well
after that."
  `(with-fitter (:clean t)
     (with-messages
       (let ((valve (rpl:make-valve 'body)) (log (list :log)))
         (flet ((run-it () (driver:run-plan 'guarded valve log ,leave)))
           ,@call)
         (is (equal '(:log :cleaned) log))
         (is (null (rpl:valve-owner valve)))
         (is (null (driver:plans)))
         (is-false (moves-p fitter))
         (is (eq :fine (run-as-plan (rpl:with-valve (valve) (turned .1) :fine))))))))

(test run-plan.left-by-a-throw
  (leaving-run-plan (lambda () (throw 'out nil))
    (catch 'out (run-it))))

(test run-plan.left-by-a-restart-of-its-caller
  (leaving-run-plan (lambda () (invoke-restart 'give-up))
    (restart-case (run-it)
      (give-up ()))))

(test run-plan.left-while-time-passes
  "As by Ctrl-C, or a time limit, in an observer."
  (leaving-run-plan (lambda ())
    (let ((observer (lambda (simulation)
                      (when (= 5 (run:simulation-tick simulation)) (throw 'out nil)))))
      (run:add-observer observer)
      (catch 'out (run-it)))))

(test run-plan.an-abort-in-a-leaf-ends-that-plan-only
  (with-fitter (:clean t)
    (with-messages
      (let ((other (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 9) :done))))
        (is (eq :evaporated (nth-value 1 (run-as-plan (rpl:wait-time 1) (abort)))))
        (run:run-ticks 10)
        (is (eq :done (rpl:task-result other)))))))

;;; Closing.

(defun plan-in-cleanup (log)
  "Begin a plan and let it get to a cleanup that takes more time than it will have."
  (prog1 (driver:begin-plan (rpl:interp-lambda ()
                              (rpl:evap-protect
                               (rpl:wait-time 2)
                               (rpl:evap-protect (rpl:seq (push :begun (cdr log))
                                                          (rpl:wait-time 99)
                                                          (push :never (cdr log)))
                                                 (push :inner (cdr log))))))
    (run:run-ticks 4)))

(test closing.leaves-no-plan
  "Neither when another robot is to be driven nor when the simulation ends, also by an error."
  (dolist (way (list (lambda () (driver:rpl-init-robot fitter))
                     (constantly nil)
                     (lambda () (error "on purpose"))))
    (let ((log (list :log)) (task nil) (runner nil))
      (ignore-errors
       (with-fitter (:clean t)
         (setf task (plan-in-cleanup log)
               runner (driver:rpl-runner))
         (funcall way)))
      (is (equal '(:log :inner :begun) log))
      (is (eq :evaporated (rpl:task-state task)))
      (is (null (rpl:plan-runner-tasks runner)))
      (is (null (rpl:next-wake-time runner))))))

(test closing.from-inside-of-a-plan
  "A plan that calls RPL-INIT-ROBOT for its robot ends itself; the robot has new fluents."
  (with-fitter (:clean t)
    (let* ((fluent driver:robot-stopped*)
           (task (driver:begin-plan (rpl:interp-lambda ()
                                      (rpl:wait-time 1)
                                      (driver:rpl-init-robot fitter)
                                      (rpl:wait-time 1)
                                      :not-reached))))
      (run:run-ticks 3)
      (is (eq :evaporated (rpl:task-state task)))
      (is (not (eq fluent driver:robot-stopped*)))
      (is (eq :fine (run-as-plan (turned .1) :fine))))))

(test closing.cleanups-of-an-old-plan-set-only-its-own-fluents
  (with-fitter (:clean t)
    (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                     (rpl:evap-protect (rpl:wait-time 9)
                                       (driver:rpl-robot-turn .3)))))
          (old driver:robot-angle-diff*))
      (run:run-ticks 2)
      (driver:rpl-init-robot fitter)
      (is (eq :evaporated (rpl:task-state task)))
      (run:run-ticks 3)
      (is (plusp (robot:robot-angle fitter)))
      (is (not (eq old driver:robot-angle-diff*)))
      (is (null (rpl:fluent-value driver:robot-angle-diff*))))))

(test rpl-init-robot.only-of-this-world
  (run:with-simulation (rover)
    (let ((outer rover))
      (run:with-simulation (fitter)
        (signals base:misuse (driver:rpl-init-robot outer))
        (is (search "with-simulation"
                    (handler-case (driver:rpl-init-robot outer)
                      (base:misuse (condition) (string-downcase (princ-to-string condition))))))
        (is (eq fitter (driver:rpl-init-robot fitter)))))))

(test rpl-robot-valve.one-errand-at-a-time
  "A plan that is started while another, that was ended, still cleans up waits for that."
  (with-fitter (:clean t)
    (let* ((log '())
           (plan (rpl:interp-lambda (number)
                   (rpl:with-valve ((driver:rpl-robot-valve))
                     (rpl:evap-protect (rpl:seq (push (list :begin number) log)
                                                (rpl:wait-time 5))
                                       (rpl:seq (rpl:wait-time 5)
                                                (push (list :end number) log))))))
           (first (driver:begin-plan plan 1)))
      (run:run-ticks 2)
      (driver:end-plan first)
      (is (eq :succeeded (nth-value 1 (driver:run-plan plan 2))))
      (is (equal '((:begin 1) (:end 1) (:begin 2) (:end 2)) (reverse log))))))

(test rpl-robot-valve.who-has-lost-it-does-not-run
  "An errand loses the robot, of which a part that is to begin anew has been given it."
  (with-fitter (:clean t)
    (let ((log '()))
      (driver:run-plan
       (rpl:interp-lambda ()
         (rpl:par (rpl:with-valve ((driver:rpl-robot-valve))
                    (rpl:par (rpl:n-times 4 (rpl:wait-time 1) (push :errand log))
                             (rpl:retry-after-suspension
                               (rpl:with-valve ((driver:rpl-robot-valve)) (rpl:wait-time 2)))))
                  (rpl:seq (rpl:wait-time 1)
                           (rpl:with-valve ((driver:rpl-robot-valve) :priority 1)
                             (push :begin log) (rpl:wait-time 9) (push :end log))))))
      (is (eql 1 (- (position :begin log) (position :end log)))))))

;;; What is told.

(defun told-by (function)
  "Return what FUNCTION queues as messages, as one text."
  (funcall function)
  (format nil "~{~A~%~}" (mapcar #'base:message-text (base:take-messages))))

(test run-plan.a-limit-says-who-waited-for-what
  (with-fitter ()
    (let* ((driver:*plan-limit* 20)
           (text (told-by (lambda ()
                            (driver:run-plan (rpl:interp-lambda ()
                                               (rpl:par (rpl:wait-time 50)
                                                        (rpl:wait-for driver:robot-stopped*))))))))
      (is (search "given up at tick 20" text))
      (is (search "robot-stopped*" text))
      (is (search "tick 50" text)))))

(test run-plan.a-failure-prints-readably
  (let ((text (run:with-simulation (fitter)
                (with-messages
                  (prin1-to-string
                   (run-as-plan (rpl:wait-time 2)
                                (rpl:handle-failure ((:oops () (rpl:fail :class :worse :why 7)))
                                  (rpl:fail :class :oops))))))))
    (dolist (part '(":WORSE" ":WHY 7" "tick 2" "class :worse :why 7)" "after" ":OOPS"))
      (is (search part text) "~A in ~A" part text))))

(test run-plan.reports-are-of-bounded-length
  (with-fitter ()
    (let ((text (told-by (lambda ()
                           (run-as-plan (rpl:fail :class :oops :data (make-list 100000)
                                                  :text (make-string 100000)))))))
      (is (< (length text) 10000))
      (is (search ":OOPS" text)))))
