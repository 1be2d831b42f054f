;;;; stopwatch.lisp -- how long something has taken by the clock, which no result depends on.

(in-package :ars-magna.experiment)

(defun moment ()
  "Return this moment, for SECONDS-SINCE."
  (get-internal-real-time))

(defun seconds-since (moment)
  (/ (- (moment) moment) (float internal-time-units-per-second 1d0)))

(defun milliseconds-since (moment)
  (* 1000 (seconds-since moment)))
