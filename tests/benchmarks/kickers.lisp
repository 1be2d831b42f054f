;;;; kickers.lisp -- how many ticks a second a world full of kickers runs.

;;; Load with the system loaded. Prints ticks per second for 100,000 things on a 1000 x 1000 map,
;;; each with a kicker of probability .01: once with kickers that only count, once with kickers
;;; that move their things, and once with one roll per thing and tick, for comparison.

(defpackage :ars-magna.benchmarks.kickers
  (:use :cl)
  (:local-nicknames (:world :ars-magna.world) (:base :ars-magna.base)))

(in-package :ars-magna.benchmarks.kickers)

(defparameter *things* 100000)

(defun seconds-for (function)
  (let ((start (get-internal-real-time)))
    (funcall function)
    (/ (- (get-internal-real-time) start) internal-time-units-per-second 1d0)))

(defun full-world (kicker)
  "Return a world with *THINGS* things strewn over it, each with KICKER."
  (let* ((world (world:make-world (world:define-map 'kicker-benchmark 1000 1000)))
         (dice (world:world-dice world :user)))
    (dotimes (index *things* world)
      (world:make-new-thing 'box (list world (base:roll-between 0 1000 dice)
                                       (base:roll-between 0 1000 dice))
                            '((:size 1)) :kickers (list kicker)))))

(defun measure (name ticks world)
  (let ((bytes (sb-ext:get-bytes-consed))
        (seconds (seconds-for (lambda () (dotimes (tick ticks) (world:run-kickers world))))))
    (format t "~30A ~10,0F ticks/s ~12,1F bytes/tick~%" name (/ ticks seconds)
            (/ (- (sb-ext:get-bytes-consed) bytes) ticks))))

(defun roll-for-each (ticks)
  (let ((dice (base:make-dice 1)) (hits 0))
    (declare (type fixnum hits))
    (dotimes (tick ticks hits)
      (dotimes (thing *things*)
        (when (< (base:roll dice) .01d0) (incf hits))))))

(let ((hits 0))
  (declare (type fixnum hits))
  (world:define-kicker 'count-kicks :prob .01
    :body (lambda (thing) (declare (ignore thing)) (incf hits)))
  (world:define-kicker 'hop :prob .01
    :body (lambda (thing) (world:kick-thing thing 0.3d0 0.4d0 t)))
  (measure "drawn intervals, counting" 20000 (full-world 'count-kicks))
  (measure "drawn intervals, kicking" 1000 (full-world 'hop))
  (format t "~30A ~10,0F ticks/s~%" "one roll per thing and tick"
          (/ 500 (seconds-for (lambda () (roll-for-each 500))))))
