;;;; display.lisp -- how long pictures take, and what a history costs a run.

;;; Prints milliseconds for snapshots and SVG documents of an office floor of 300 x 200 cells with
;;; 150 rooms and 500 things, and microseconds a tick takes with and without a history kept.

(in-package :ars-magna.benchmarks)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :display :ars-magna.display))

(defun rooms (width height size)
  (append `((rect (0 0) (,(1- width) ,(1- height)) bricks 0 10 30 25))
          (loop for y from 0 below height by size
                append (loop for x from 0 below width by size
                             collect `(wall (,x ,y) (,(+ x (- size 6)) ,y) wood 40 90)
                             collect `(wall (,(+ x (- size 3)) ,y) (,(+ x size -1) ,y)
                                                   wood 60)
                             collect `(wall (,x ,y) (,x ,(+ y (- size 8))) slate 10 30)
                             collect `(rect (,(+ x 6) ,(+ y 8)) (,(+ x 10) ,(+ y 11))
                                                   wood 50)))))

(defun strew (world count width height)
  (let ((dice (base:make-dice 1)))
    (dotimes (index count)
      (world:make-new-thing 'box (list world (base:roll-between 0 width dice)
                                       (base:roll-between 0 height dice))
                            '((:size 2) (:color green))))))

(defun milliseconds (function &optional (count 50))
  "Return how many milliseconds a call of FUNCTION takes; the clock is coarse, so COUNT calls are
timed at once."
  (flet ((calls () (loop repeat count do (funcall function))))
    (* 1000 (/ (median (loop repeat 5 collect (seconds-for #'calls))) count))))

(world:define-map 'floor-benchmark 300 200
  :clauses (rooms 300 200 20))
(defvar viewer)
(robot:define-robot 'viewer 'floor-benchmark '(25 25) 0 :cameras '((1 50)) :hands '(1) :bins '(1))

(run:with-simulation (viewer)
  (let ((world (robot:robot-world viewer)) (last nil))
    (strew world 500 300 200)
    (say "snapshot of 500 things"
         (* 1000 (milliseconds (lambda () (setf last (display:take-snapshot world))) 500)) "us")
    (say "the same again, nothing changed"
         (* 1000 (milliseconds (lambda () (display:take-snapshot world last)) 500)) "us")
    (say "SVG of the floor, in colour" (milliseconds (lambda () (display:svg-picture viewer)))
         "ms")
    (say "SVG of the floor, monochrome"
         (milliseconds (lambda () (display:svg-picture viewer :in-color nil))) "ms")
    (say "length of the SVG document" (length (display:svg-picture viewer)) "characters")
    (flet ((drive ()
             (robot:drive-tick viewer 1d-3)
             (robot:turn-tick viewer 0.01d0)
             (run:run-ticks 1)))
      (say "driving without a history" (* 1000000 (milliseconds #'drive 100000)) "ns a tick")
      (display:keep-history)
      (say "driving with a history" (* 1000000 (milliseconds #'drive 100000)) "ns a tick"))))
