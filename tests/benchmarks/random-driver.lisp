;;;; random-driver.lisp -- the random driver of the tests, for a million commands.

;;; Prints the commands per second, with checks of the world after each tick, and the errors found;
;;; there should be none. The tests issue a twentieth of this number.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *rides* 50)
(defparameter *commands* 20000)

(defun troubles-of-ride (seed)
  "Return what is wrong in a ride, every other of which is of many runs and redefinitions."
  (if (evenp seed)
      (uiop:symbol-call :ars-magna.tests :troubles-of-ride *commands* seed)
      (uiop:symbol-call :ars-magna.tests :troubles-of-runs 20 (floor *commands* 20) seed)))

(let* ((troubles '())
       (seconds (seconds-for (lambda ()
                               (loop for seed from 100 repeat *rides*
                                     do (dolist (trouble (troubles-of-ride seed))
                                          (push (cons seed trouble) troubles)))))))
  (say "random driver, every tick watched" (/ (* *rides* *commands*) seconds) "commands/s")
  (say "  contradictions, lost or doubled answers" (length troubles) "")
  (loop for (seed . trouble) in (reverse troubles) repeat 10
        do (format t "seed ~D: ~A~%" seed trouble)))
