;;;; geometry-limits.lisp -- points and boxes at the limits of floats.

(in-package :ars-magna.tests)

(in-suite geometry)

(test norm.of-any-float
  "Squares of 1e200 and of 1e-200 are no floats, the lengths are."
  (flet ((close-p (expected length) (< (abs (- 1 (/ length expected))) 1d-15)))
    (dolist (scale '(1d200 1d-200 1d300 1d-300 1d140 1d-140 1d0))
      (is-true (close-p (* 5 scale) (geo:norm (pt (* 3 scale) (* -4 scale)))))
      (is-true (close-p (* 5 scale) (geo:dist (pt (* 3 scale) 0) (pt 0 (* 4 scale))))))
    (is-true (close-p 1d200 (geo:interval-max (geo:norm (box 0 1d200 0 0))))))
  (is (= 0 (geo:norm (pt 0 0))))
  (signals base:wrong-argument (geo:norm (pt 1.7d308 1.7d308))))

(test operations.tell-of-their-own-operands
  "Also those that use another one."
  (loop for (function . operands) in `((geo:mul ,(box 1 2 1 2) 1d308) (geo:mul ,(pt 1 1d300) 1d300)
                                       (geo:add ,(span 1 1.7d308) 1.7d308)
                                       (geo:subtract ,(span 1 1.7d308) -1.7d308)
                                       (geo:dist ,(span 1 1.7d308) -1.7d308)
                                       (geo:grow-interval ,(span 1 1d308) 1.7d308)
                                       (geo:interval-overlap-width ,(span 1 2) ,(pt 1 2))
                                       (geo:interval-overlap-width 1 a))
        do (handler-case (progn (apply function operands) (fail "~A has a result" function))
             (base:wrong-argument (condition)
               (is (eq function (basics::wrong-argument-operator condition)))))))

(test boxes.are-changed-whole-or-not-at-all
  (flet ((left-p (function &rest arguments)
           (let ((box (box 1 2 1d308 1.5d308)))
             (handler-case (progn (apply function box arguments) nil)
               (base:wrong-argument () (geo:equal box (box 1 2 1d308 1.5d308)))))))
    (is-true (left-p #'geo:add! (pt 1 1.5d308)))
    (is-true (left-p #'geo:subtract! (pt 1 -1.5d308)))
    (is-true (left-p #'geo:mul! 3))
    (is-true (left-p #'geo:grow-interval! 1.5d308))
    (is-true (left-p #'geo:set-pt-interval! 3 4 6 5))))
