;;;; ticks.lisp -- ticks per second of robots that drive, and of a world where nothing happens.

(in-package :ars-magna.benchmarks)

(world:defmap open-field (75 75) (rect (0 0) (75 75) bricks 1 10 20 30))
(robot:defrobot driver (open-field (3.5 37.5) 0))

(defun keep-driving (robot)
  "Let ROBOT drive to and fro for ever, slowly, so that most ticks are driving."
  (labels ((drive (err &rest ignore)
             (declare (ignore ignore))
             (if (eq err :robot-blocked)
                 (command:robot-about-face robot #'drive)
                 (command:robot-go-forward robot 1000000 #'drive))))
    (command:robot-set-speed robot 0.01d0
                             (lambda (&rest ignore)
                               (declare (ignore ignore))
                               (drive nil)))))

(run:with-simulation (driver :seed 1)
  (let ((ticks 2000000))
    (flet ((run () (run:run-ticks ticks)))
      (say "idle world, one robot" (per-second ticks #'run) "ticks/s")
      (say "  bytes allocated in that many ticks" (bytes-for #'run) "bytes")
      (keep-driving driver)
      (run:run-ticks 20)
      (say "one robot driving, odometer on" (per-second ticks #'run) "ticks/s")
      (say "  bytes allocated per 1,000 ticks" (/ (bytes-for #'run) (/ ticks 1000)) "bytes"))))
