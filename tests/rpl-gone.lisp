;;;; rpl-gone.lisp -- plans whose robot is gone, and plans ended from elsewhere.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

(defun lose-robot-and-drive ()
  "Let the robot that is driven be no more, and drive on, in one step of a plan."
  (define-fitter-anew)
  (driver:rpl-robot-turn 1))

(defun failure-told-p ()
  "True if a failed plan is reported in the current queue."
  (find-if (lambda (message) (search "No robot to drive" (base:message-text message)))
           (definitions::message-queue-newest-first base:*message-queue*)))

(test gone.a-plan-that-drives-on-ends-without-a-word
  (call-resident
   (lambda ()
     (destructuring-bind (value state)
         (multiple-value-list
          (run-as-plan (rpl:handle-failure ((error () (return :failed)))
                         (lose-robot-and-drive))))
       (is (null value))
       (is (eq :stopped state)))
     (is-false (failure-told-p)))))

(test gone.a-begun-plan-evaporates-and-cleans-up
  (call-resident
   (lambda ()
     (let* ((cleaned nil)
            (task (driver:begin-plan (rpl:interp-lambda ()
                                       (rpl:evap-protect (lose-robot-and-drive)
                                         (setf cleaned t))))))
       (awaiting (rpl:task-over-p task))
       (is (eq :evaporated (rpl:task-state task)))
       (is-true cleaned)
       (is-false (failure-told-p))))))

;;; Ended from elsewhere.

(defun waiting-plan ()
  (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 1000))))

(test end-plan.works-from-a-thread-that-knows-no-robot
  (with-fitter (:clean t)
    (let ((task (waiting-plan)))
      (base:join-thread (base:start-thread (lambda ()
                                             (let ((driver::*default-interface* nil))
                                               (driver:end-plan task)))
                                           "ends a plan"))
      (run:run-ticks 1)
      (is (eq :evaporated (rpl:task-state task))))))

(test end-plan.works-inside-of-another-simulation
  (with-fitter (:clean t)
    (let ((task (waiting-plan)))
      (run:with-simulation (ars-user::butler :clean t)
        (driver:end-plan task))
      (run:run-ticks 1)
      (is (eq :evaporated (rpl:task-state task))))))

(test end-plan.of-a-plan-that-is-over-does-nothing
  (let ((task nil))
    (with-fitter (:clean t)
      (setf task (waiting-plan)))
    (is (eq :evaporated (rpl:task-state task)))
    (is (null (multiple-value-list (driver:end-plan task))))
    (signals base:misuse (driver:end-plan :all))))
