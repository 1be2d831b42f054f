;;;; rpl-clashes.lisp -- a command that interrupts another task's command is reported, once.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

(rpl:def-interp-proc turn-and-wait ()
  (driver:rpl-robot-turn 1)
  (rpl:wait-for driver:robot-stopped*))

(rpl:def-interp-proc go-and-wait ()
  (driver:rpl-robot-go-forward 5)
  (rpl:wait-for driver:robot-stopped*))

(defun clashes-told (&rest plans)
  "Return the warnings of interrupted commands that come when PLANS run side by side."
  (with-fitter (:clean t)
    (mapc #'driver:begin-plan plans)
    (run:run-ticks 40)
    (remove-if-not (lambda (text) (search "was interrupted by" text)) (texts-of-warnings))))

(test clashes.of-branches-are-told
  (let ((texts (clashes-told (rpl:interp-lambda ()
                               (rpl:n-times 3 (rpl:par (turn-and-wait) (go-and-wait)))))))
    (is (= 1 (length texts)))
    (is-true (has-words-p (first texts) "rpl-robot-turn of (turn-and-wait) in the plan"
                          "was interrupted by rpl-robot-go-forward of (go-and-wait)"
                          "FITTER carries out one command at a time"
                          "(with-valve ((rpl-robot-valve)) ...)"))))

(test clashes.of-plans-are-told
  (let ((texts (clashes-told 'turn-and-wait 'go-and-wait)))
    (is (= 1 (length texts)))
    (is-true (has-words-p (first texts) "of the plan turn-and-wait was interrupted by"
                          "of the plan go-and-wait"))))

(test clashes.on-purpose-are-not-told
  (dolist (plan (list
                 (rpl:interp-lambda ()  ; one's own older command
                   (driver:rpl-robot-turn 1) (rpl:wait-time 2) (go-and-wait))
                 (rpl:interp-lambda ()  ; a part that takes over from the whole
                   (driver:rpl-robot-turn 1) (rpl:wait-time 2) (rpl:par (go-and-wait)))
                 (rpl:interp-lambda ()  ; a policy
                   (rpl:with-policy (rpl:seq (rpl:wait-time 2) (go-and-wait)) (turn-and-wait)))
                 (rpl:interp-lambda ()  ; a race
                   (rpl:pursue (turn-and-wait) (rpl:seq (rpl:wait-time 2) (go-and-wait))))
                 (rpl:interp-lambda ()  ; a reaction
                   (let ((alarm (rpl:state 'alarm)))
                     (rpl:par (turn-and-wait)
                              (rpl:whenever alarm (go-and-wait) (return))
                              (rpl:seq (rpl:wait-time 2) (rpl:pulse alarm)))))
                 (rpl:interp-lambda ()  ; stopping
                   (rpl:par (turn-and-wait) (rpl:seq (rpl:wait-time 2) (driver:rpl-robot-stop))))
                 (rpl:interp-lambda ()  ; one at a time
                   (rpl:par (rpl:with-valve ((driver:rpl-robot-valve)) (turn-and-wait))
                            (rpl:with-valve ((driver:rpl-robot-valve)) (go-and-wait))))
                 (rpl:interp-lambda ()  ; one that is more urgent
                   (rpl:par (rpl:with-valve ((driver:rpl-robot-valve)) (turn-and-wait))
                            (rpl:seq (rpl:wait-time 2)
                                     (rpl:with-valve ((driver:rpl-robot-valve) :priority 1)
                                       (go-and-wait)))))
                 (rpl:interp-lambda ()  ; several parts of the robot
                   (rpl:par (turn-and-wait) (driver:rpl-camera-turn 0 1)))))
    (is (null (clashes-told plan)))))
