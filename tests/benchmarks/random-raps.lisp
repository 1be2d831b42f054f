;;;; random-raps.lisp -- random reactive action packages do what a model of them does.

;;; 5,000 runs, ten of each program; the tests make some of them.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *programs* 500)
(defparameter *runs* 10 "How many runs each program has.")

(let ((differences '()) (successes 0))
  (let ((seconds (seconds-for
                  (lambda ()
                    (let ((*standard-output* (make-broadcast-stream))
                          (*error-output* (make-broadcast-stream))
                          (*random-state* (sb-ext:seed-random-state 1)))
                      (setf (values differences successes)
                            (uiop:symbol-call :ars-magna.tests.rap :random-raps-that-differ
                                              *programs* *runs*)))))))
    (say "random RAPs" (/ (* *runs* *programs*) seconds) "runs/s")
    (say "  of 5,000, that succeed" successes "")
    (say "  that differ from the model" (length differences) "")
    (loop for difference in differences repeat 5 do (print difference))))
