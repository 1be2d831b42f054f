;;;; ten-robots.lisp -- ten robots with plans each: forks, starts of plans, ticks while all drive.

(ars:define-user-package :ars-magna.benchmarks.ten-robots
  (:documentation "Benchmarks of ten robots with plans.")
  (:import-from :ars-worlds #:marvin #:fetch-thing)
  (:import-from :ars-magna.base #:real-microseconds)
  (:import-from :ars-magna.benchmarks #:bytes-for #:median #:say #:per-second))

(in-package :ars-magna.benchmarks.ten-robots)

(defmap ten-lanes (60 60)
  (rect (0 0) (59 59) bricks 10))

(defrobot runner (ten-lanes (5 5) 0))

(defun ten-like (name x y dx dy)
  "Return a list of ten robots like NAME, which start at (X,Y) and then at distances of (DX,DY)."
  (loop for i below 10
        collect (list name :as (intern (format nil "~A-~D" name i))
                           :at (list (+ x (* i dx)) (+ y (* i dy))))))

(defun say-forks (name count)
  "Fork the current simulation COUNT times, and print what one of these cost."
  (let* ((times '())
         (bytes (bytes-for (lambda ()
                             (loop repeat count
                                   do (let ((start (real-microseconds)))
                                        (fork-simulation)
                                        (push (- (real-microseconds) start) times)))))))
    (say name (median times) "us")
    (say "  least" (reduce #'min times) "us")
    (say "  memory" (/ bytes count) "bytes")))

(def-interp-proc wait-with-list (number)
  (let ((list (list number)))
    (wait-time (+ 100000 number))
    list))

(def-interp-proc be-ten-tasks ()
  (par (wait-with-list 1) (wait-with-list 2) (wait-with-list 3) (wait-with-list 4)
       (wait-with-list 5) (wait-with-list 6) (wait-with-list 7) (wait-with-list 8)
       (wait-with-list 9)))

(defun begin-for-all (&rest plan)
  (dolist (robot (simulation-robots))
    (apply #'begin-plan (append plan (list :robot robot)))))

(with-simulation ((ten-like 'runner 5 5 0 5) :seed 1)
  (begin-for-all 'be-ten-tasks)
  (run-ticks 10)
  (say-forks "fork of ten robots, a plan of ten tasks each" 2000))

(with-simulation ((ten-like 'marvin 110 24 0 0) :seed 1 :ghosts t)
  (begin-for-all 'fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
  (run-ticks 100)
  (say-forks "fork of ten robots, a fetch at tick 100 each" 1000))

;;; Starts of plans, and ticks.

(def-interp-proc nothing-much () (wait-time 1))

(with-simulation ((ten-like 'runner 5 5 0 5) :seed 1)
  (begin-for-all 'nothing-much)
  (say "begin-plan on ten robots, and its end"
       (per-second 20000 (lambda ()
                           (loop repeat 2000
                                 do (begin-for-all 'nothing-much)
                                    (run-ticks 2))))
       "plans/s"))

(def-interp-proc drive-about ()
  (loop
    (rpl-robot-go-forward 20)
    (wait-for robot-stopped*)
    (rpl-robot-about-face)
    (wait-for robot-stopped*)))

(with-simulation ((ten-like 'runner 5 5 0 5) :seed 1 :clean t)
  (begin-for-all 'drive-about)
  (run-ticks 10)
  (say "ten robots whose plans drive" (per-second 20000 (lambda () (run-ticks 20000))) "ticks/s"))
