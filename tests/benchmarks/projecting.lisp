;;;; projecting.lisp -- the cost of looking ahead.

(defpackage :ars-magna.benchmarks.projecting
  (:documentation "Benchmarks of rollouts.")
  (:use :cl :ars-magna.benchmarks :ars-magna.rpl :ars-magna.rpl-robot :ars-magna.rpl-projecting))

(in-package :ars-magna.benchmarks.projecting)

(ars-magna.world:defmap court (30 20)
  (rect (0 0) (29 19) bricks 10)
  (obj ball (20 5) ((:size 1))))

(ars-magna.robot:defrobot runner (court (10 10) 0) :cameras ((3 5)) :hands (10))

(def-interp-proc wait-a-tick ()
  (wait-time 1))

(def-interp-proc drive-off (ticks)
  (rpl-robot-turn 1)
  (wait-for robot-stopped*)
  (rpl-robot-go-forward ticks)
  (wait-for robot-stopped*))

(defun say-rollouts (name plan &optional (trials 1000))
  (ars-magna.run:with-simulation (runner)
    (say name
         (per-second trials (lambda () (project-plan plan :trials trials)))
         "rollouts/s")))

(say-rollouts "rollouts of a tick, a court of 30 x 20" '(wait-a-tick))
(say-rollouts "rollouts of some 15 ticks, one drive" '(drive-off 8))

(ars-magna.run:with-simulation (ars-worlds:marvin)
  (say "rollouts of a tick, the office, 170 things"
       (per-second 200 (lambda () (project-plan '(wait-a-tick) :trials 200)))
       "rollouts/s"))

(ars-magna.run:with-simulation (runner)
  (let ((plan (interp-lambda ()
                (n-times 100 (try-best (:trials 5 :horizon 20) (wait-time 1) (wait-time 2))))))
    (say "choices of 2 branches by 5 rollouts of 20 ticks each"
         (per-second 100 (lambda () (run-plan plan)) :runs 3)
         "choices/s")))
