;;;; threads.lisp -- many threads command one live robot.

(in-package :ars-magna.benchmarks)

(world:defmap yard (20 20) (rect (0 0) (20 20) bricks 1))
(robot:defrobot servant (yard (10.5 10.5) 0))

(defun command-from-threads (robot threads each answers)
  "Let THREADS threads issue EACH commands to ROBOT, counting the continuations in ANSWERS."
  (mapc #'base:join-thread
        (loop for thread below threads
              collect (let ((first (* thread each)))
                        (base:start-thread
                         (lambda ()
                           (loop for index from first below (+ first each)
                                 do (let ((index index))
                                      (command:robot-turn
                                       robot 0.1d0
                                       (lambda (&rest ignore)
                                         (declare (ignore ignore))
                                         (incf (aref answers index)))))))
                         "commander")))))

(let* ((threads 8) (each 12500)
       (simulation (run:fresh-simulation '(servant) :seed 1 :journal t))
       (robot (first (run:simulation-robots simulation)))
       (answers (make-array (* threads each) :initial-element 0)))
  (run:start-clock simulation :rate :free)
  (let ((seconds (seconds-for (lambda ()
                                (command-from-threads robot threads each answers)
                                (run:await-idle simulation)))))
    (run:stop-clock simulation)
    (say "8 threads, one live robot, commands answered" (/ (* threads each) seconds) "commands/s")
    (say "  commands not answered exactly once" (count 1 answers :test #'/=) "commands")))
