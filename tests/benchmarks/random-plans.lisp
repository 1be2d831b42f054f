;;;; random-plans.lisp -- random plans, disturbed and killed at random, all end and leave nothing.

;;; A million kills, ten of each plan; the tests make some of them.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *rounds* 100)
(defparameter *plans* 1000 "How many plans a round has.")

(let* ((troubles '())
       (seconds (seconds-for
                 (lambda ()
                   (loop for seed from 1 to *rounds*
                         do (setf troubles
                                  (nconc (uiop:symbol-call :ars-magna.tests :trouble-with-kills
                                                           *plans* 10 seed)
                                         troubles)))))))
  (say "random plans, killed" (/ (* 10 *plans* *rounds*) seconds) "kills/s")
  (say "  of 1,000,000, that hang or leave something" (length troubles) "")
  (loop for trouble in troubles repeat 10 do (print trouble)))
