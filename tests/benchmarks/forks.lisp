;;;; forks.lisp -- how long it takes to fork a run, and how much memory.

(ars:define-user-package :ars-magna.benchmarks.forks
  (:documentation "Benchmarks of forks.")
  (:import-from :ars-worlds #:dot #:marvin #:fetch-thing)
  (:import-from :ars-magna.base #:real-microseconds #:make-dice #:roll-between)
  (:import-from :ars-magna.world #:define-map #:define-kicker #:make-new-thing)
  (:import-from :ars-magna.benchmarks #:bytes-for #:median #:say))

(in-package :ars-magna.benchmarks.forks)

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

;;; Small and middling.

(def-interp-proc wait-beside (number)
  "Wait, with a list in a variable."
  (let ((list (list number)))
    (wait-time (+ 100000 number))
    list))

(def-interp-proc ten-tasks ()
  "Be ten tasks."
  (par (wait-beside 1) (wait-beside 2) (wait-beside 3) (wait-beside 4) (wait-beside 5)
       (wait-beside 6) (wait-beside 7) (wait-beside 8) (wait-beside 9)))

(with-simulation (dot :seed 1)
  (begin-plan 'ten-tasks)
  (run-ticks 10)
  (say-forks "the tiny room, a plan of ten tasks" 5000))

(with-simulation (marvin :seed 1)
  (begin-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
  (run-ticks 100)
  (say-forks "the office, a fetch at tick 100" 2000))

;;; Large.

(define-map 'fork-benchmark 1000 1000)
(define-kicker 'hop-along :prob .01 :body (lambda (thing) (kick-thing thing 0.3d0 0.4d0 t)))
(defrobot forker (fork-benchmark (500 500) 0))

(with-simulation (forker :seed 1)
  (let ((dice (make-dice 1)))
    (loop repeat 100000
          do (make-new-thing 'box (list *world* (roll-between 0 1000 dice)
                                        (roll-between 0 1000 dice))
                             '((:size 1)) :kickers (list 'hop-along))))
  (run-ticks 10)
  (say-forks "1000 x 1000 cells, 100,000 things with kickers" 20))
