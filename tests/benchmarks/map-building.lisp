;;;; map-building.lisp -- how long it takes to build, cache and reload a large map.

;;; Load with the system loaded. Prints seconds for a map of 1000 x 1000 cells in rooms, with the
;;; four built-in place types, and for the same with a fifth that is written as a checker.

(defpackage :ars-magna.benchmarks.map-building
  (:use :cl)
  (:local-nicknames (:world :ars-magna.world)))

(in-package :ars-magna.benchmarks.map-building)

(defparameter *clauses*
  (append '((rect (0 0) (1000 1000) bricks 0 10 30 25))
          (loop for y from 0 below 1000 by 20
                append (loop for x from 0 below 1000 by 20
                             collect `(wall (,x ,y) (,(+ x 8) ,y) bricks 1 20)
                             collect `(wall (,(+ x 10) ,y) (,(+ x 19) ,y) bricks 5)
                             collect `(wall (,x ,y) (,x ,(+ y 14)) slate 10 30)))))

(defun report (name function)
  (let ((start (get-internal-real-time)))
    (funcall function)
    (format t "~40A ~8,3F s~%" name
            (/ (- (get-internal-real-time) start) internal-time-units-per-second))))

(defun build (&optional cache)
  (world:define-map 'map-benchmark 1000 1000 :clauses *clauses* :cache cache))

(let ((cache (merge-pathnames "ars-magna-map-benchmark" (uiop:temporary-directory))))
  (when (probe-file cache) (delete-file cache))
  (report "build" #'build)
  (report "build and write the cache" (lambda () (build cache)))
  (report "reload from the cache" (lambda () (build cache)))
  (delete-file cache)
  (report "make a world" (lambda () (world:make-world 'map-benchmark)))
  (format t "~40A ~8D~%" "walls" (count 1 (world:map-flags (world:find-map 'map-benchmark))))
  (format t "~40A ~8D~%" "places" (count-if #'plusp
                                            (world:map-places (world:find-map 'map-benchmark)))))

(world:def-place-type benchmark-spot (cell)
  :checker (if (world:cell-filled? cell)
               (values (equal (world:cell-occupancy-window cell 3 3)
                              '((nil nil nil) (nil t nil) (nil nil nil)))
                       0 1 0)
               (values nil 0 0 0)))

(report "build with a user's checker as well" #'build)
