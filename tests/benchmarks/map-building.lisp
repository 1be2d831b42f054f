;;;; map-building.lisp -- how long it takes to build, cache and reload a large map.

;;; Prints milliseconds for a map of 1000 x 1000 cells in rooms, with the
;;; four built-in place types, and for the same with a fifth that is written as a checker.

(in-package :ars-magna.benchmarks)

(defparameter *clauses*
  (append '((rect (0 0) (1000 1000) bricks 0 10 30 25))
          (loop for y from 0 below 1000 by 20
                append (loop for x from 0 below 1000 by 20
                             collect `(wall (,x ,y) (,(+ x 8) ,y) bricks 1 20)
                             collect `(wall (,(+ x 10) ,y) (,(+ x 19) ,y) bricks 5)
                             collect `(wall (,x ,y) (,x ,(+ y 14)) slate 10 30)))))

(defun say-milliseconds (name function)
  (say name (* 1000 (median (loop repeat 3 collect (seconds-for function)))) "ms"))

(defun forget (cache)
  (when (probe-file cache) (delete-file cache)))

(defun build (&optional cache)
  (world:define-map 'map-benchmark 1000 1000 :clauses *clauses* :cache cache))

(let ((cache (merge-pathnames "ars-magna-map-benchmark" (uiop:temporary-directory))))
  (say-milliseconds "build" #'build)
  (say-milliseconds "build and write the cache" (lambda () (forget cache) (build cache)))
  (say-milliseconds "reload from the cache" (lambda () (build cache)))
  (forget cache)
  (say-milliseconds "make a world" (lambda () (world:make-world 'map-benchmark)))
  (say "walls" (count 1 (world:map-flags (world:find-map 'map-benchmark))) "cells")
  (say "places" (count-if #'plusp (world:map-places (world:find-map 'map-benchmark))) "cells"))

(world:def-place-type benchmark-spot (cell)
  :checker (if (world:cell-filled? cell)
               (values (equal (world:cell-occupancy-window cell 3 3)
                              '((nil nil nil) (nil t nil) (nil nil nil)))
                       0 1 0)
               (values nil 0 0 0)))

(say-milliseconds "build with a user's checker as well" #'build)
