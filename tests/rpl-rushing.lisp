;;;; rpl-rushing.lisp -- plans that issue command after command without letting time pass fail.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

(rpl:def-interp-proc staring () (loop (driver:rpl-camera-view 0)))

(rpl:def-interp-proc turn-and-not-wait () (driver:rpl-robot-turn 1) (rpl:wait-time 0))

(rpl:def-interp-proc turning-in-parts ()
  (loop (rpl:par (turn-and-not-wait) (driver:rpl-robot-set-speed 1))))

(defun rushing-failure-p (failure)
  (and (typep failure 'rpl:plan-failure)
       (eq :too-many-commands (rpl:failure-class failure))))

(test rushing.ends-in-a-failure-that-says-how-to-wait
  (with-fitter ()
    (let ((failure (driver:run-plan 'staring)))
      (is-true (rushing-failure-p failure))
      (is (equal '(loop (driver:rpl-camera-view 0)) (rpl:failure-form failure)))
      (let ((remedy (getf (rpl:failure-data failure) :remedy)))
        (is (search "issues rpl-camera-view without waiting" remedy))
        (is (search "such as (wait-for (vref camera-input* 0)) or (wait-time 1)" remedy))))))

(test rushing.in-calls-and-parts-too
  (dolist (plan (list 'turning-in-parts
                      (rpl:interp-lambda () (loop (turn-and-not-wait)))
                      (rpl:interp-lambda () (loop (driver:rpl-robot-turn 1)))))
    (with-fitter ()
      (is-true (rushing-failure-p (driver:run-plan plan))))))

(test rushing.of-a-plan-that-was-begun
  (with-fitter ()
    (let ((task (driver:begin-plan 'staring)))
      (run:run-ticks 2)
      (is-true (rushing-failure-p (rpl:task-result task)))
      (is-true (find-if (lambda (message) (search "too-many-commands" (base:message-text message)
                                                  :test #'char-equal))
                        (base:take-messages))))))

(test rushing.is-not-to-give-many-commands-in-time
  (with-fitter ()
    (let ((driver:*plan-command-limit* 20))
      (is (eq :done (driver:run-plan (rpl:interp-lambda ()
                                       (rpl:n-times 15
                                         (rpl:n-times 5 (driver:rpl-robot-set-speed 1))
                                         (rpl:wait-time 1))
                                       :done)))))))

(test rushing.leaves-a-plan-its-cleanup
  (with-fitter ()
    (let ((stopped nil))
      (driver:run-plan (rpl:interp-lambda ()
                         (rpl:evap-protect (staring)
                                           (rpl:seq (driver:rpl-robot-stop) (setf stopped t)))))
      (is-true stopped))))
