;;;; stopwatch.lisp -- how long something has taken by the clock, which no result depends on.

(in-package :ars-magna.experiment)

(defun moment ()
  "Return this moment, for SECONDS-SINCE."
  (real-microseconds))

(defun seconds-since (moment)
  (/ (- (moment) moment) 1d6))

(defun milliseconds-since (moment)
  (* 1000 (seconds-since moment)))
