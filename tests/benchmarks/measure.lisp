;;;; measure.lisp -- how the benchmark programs measure: the median of some runs.

(defpackage :ars-magna.benchmarks
  (:documentation "Programs that print how fast the simulator is. Not part of the tests.")
  (:use :cl)
  (:local-nicknames (:base :ars-magna.base) (:geo :ars-magna.geometry) (:world :ars-magna.world)
                    (:time :ars-magna.time) (:robot :ars-magna.robot)
                    (:command :ars-magna.command) (:run :ars-magna.run))
  (:export #:seconds-for #:median #:per-second #:say #:bytes-for))

(in-package :ars-magna.benchmarks)

(defun seconds-for (function)
  "Call FUNCTION; return how many seconds it took."
  (let ((start (get-internal-real-time)))
    (funcall function)
    (/ (max 1 (- (get-internal-real-time) start)) internal-time-units-per-second 1d0)))

(defun median (numbers)
  (let ((sorted (sort (copy-list numbers) #'<)))
    (elt sorted (floor (length sorted) 2))))

(defun per-second (count function &key (runs 5))
  "Call FUNCTION, which does COUNT of something, RUNS times; return the median rate."
  (median (loop repeat runs collect (/ count (seconds-for function)))))

(defun bytes-for (function)
  "Return how many bytes a call of FUNCTION allocates."
  (let ((before (sb-ext:get-bytes-consed)))
    (funcall function)
    (- (sb-ext:get-bytes-consed) before)))

(defun say (name value unit)
  "Print one figure."
  (format t "~&~56A ~15:D ~A~%" name (if (integerp value) value (round value)) unit)
  (finish-output))
