;;;; crowds.lisp -- two, ten and a hundred robots under random commands, and a pursuit.

;;; Prints the commands per second, with checks of the world and the robots after each tick, and the
;;; errors found; there should be none. Then prints for how many seeds a pursuit in the simulator
;;; and in a bare turn-based program differ. The tests do a small part of this.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *robots* '(2 10 100))
(defparameter *rides* 22)
(defparameter *commands* 3040)
(defparameter *pursuits*
  (parse-integer (or (uiop:getenvp "BENCHMARK_NUMBER") "500")))

(defun tests-function (name) (uiop:find-symbol* name :ars-magna.tests))

(defun troubles-of-crowd (count)
  "Return what is wrong in rides of COUNT robots: a list of lists (seed trouble)."
  (funcall (tests-function :define-crowd) count)
  (loop for seed from 1 to *rides*
        append (loop for trouble in (funcall (tests-function :crowd-ride) count *commands* seed)
                     collect (list seed trouble))))

(dolist (count *robots*)
  (let* ((troubles '())
         (seconds (seconds-for (lambda () (setf troubles (troubles-of-crowd count))))))
    (say (format nil "~D robots, every tick watched" count) (/ (* *rides* *commands*) seconds)
         "commands/s")
    (say "  overlaps, contradictions, runs not repeated, calls lost" (length troubles) "")
    (loop for (seed trouble) in troubles repeat 10
          do (format t "seed ~D: ~A~%" seed trouble))))

(let ((differing '()) (mean 0))
  (let ((seconds (seconds-for
                  (lambda ()
                    (setf (values differing mean)
                          (funcall (tests-function :pursuits-that-differ)
                                   (loop for seed from 1 to *pursuits* collect seed)))))))
    (say "pursuits, with the bare program" (/ *pursuits* seconds) "a second")
    (say "  mean time of capture" mean "rounds")
    (say (format nil "  of ~D seeds: capture times that differ" *pursuits*) (length differing) "")))
