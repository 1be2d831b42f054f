;;;; kickers.lisp -- ticks per second of a world full of kickers.

;;; Prints ticks per second for 100,000 things on a 1000 x 1000 map, each with a kicker of
;;; probability .01. The kickers only count; or they move their things, all the same way or each by
;;; a small random step. For comparison: one roll per thing and tick.

(in-package :ars-magna.benchmarks)

(defparameter *things* 100000)

(defun full-world (kicker)
  "Return a world with *THINGS* things strewn over it, each with KICKER."
  (let* ((world (world:make-world (world:define-map 'kicker-benchmark 1000 1000)))
         (dice (world:world-dice world :user)))
    (dotimes (index *things* world)
      (world:make-new-thing 'box (list world (base:roll-between 0 1000 dice)
                                       (base:roll-between 0 1000 dice))
                            '((:size 1)) :kickers (list kicker)))))

(defun measure (name ticks world)
  (flet ((run () (world:permitting-changes (world)
                  (dotimes (tick ticks) (world:run-kickers world)))))
    (say name (per-second ticks #'run :runs 3) "ticks/s")
    (say "  bytes allocated per tick" (/ (bytes-for #'run) ticks) "bytes")))

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
  (world:define-kicker 'stroll :prob .01
    :body (lambda (thing)
            (let ((dice (world:world-dice world:*world* :user)))
              (world:kick-thing thing
                                (base:roll-within .5d0 dice) (base:roll-within .5d0 dice)
                                t))))
  (measure "drawn intervals, counting" 20000 (full-world 'count-kicks))
  (measure "drawn intervals, kicking" 1000 (full-world 'hop))
  (measure "drawn intervals, kicking at random" 1000 (full-world 'stroll))
  (say "one roll per thing and tick"
       (per-second 500 (lambda () (roll-for-each 500)) :runs 3) "ticks/s"))
