;;;; geometry.lisp -- every operation of the manual's Tables 3.1 and 3.2 against its definition.

(in-package :ars-magna.tests)

(def-suite* geometry :in ars-magna)

(defun pt (x y) (geo:make-pt x y))
(defun span (min max) (geo:make-interval min max))
(defun box (x-min x-max y-min y-max)
  (geo:make-pt-interval (span x-min x-max) (span y-min y-max)))

(defun element-of (interval dice)
  "Return an element of INTERVAL, now and then a bound."
  (etypecase interval
    (geo:interval
     (let ((min (geo:interval-min interval)) (max (geo:interval-max interval)))
       (case (base:roll-index 4 dice)
         (0 min)
         (1 max)
         (t (base:roll-between min max dice)))))
    (geo:pt-interval
     (pt (element-of (geo:pt-interval-x interval) dice)
         (element-of (geo:pt-interval-y interval) dice)))))

(defun some-span (dice)
  (let ((min (base:roll-within 5 dice)))
    (span min (+ min (base:roll-between 0 4 dice)))))

(defun some-box (dice)
  (geo:make-pt-interval (some-span dice) (some-span dice)))

(defun nearly-in-p (x interval)
  (geo:in-interval x (geo:grow-interval interval 1d-9)))

(defmacro signals-wrong-argument (operator form)
  "Claim that FORM signals WRONG-ARGUMENT in the name of OPERATOR."
  `(handler-case (progn ,form (fail "~S was accepted" ',form))
     (base:wrong-argument (condition)
       (is (eq ',operator (slot-value condition 'basics::operator)) "~A" condition))))

;;; Making and reading.

(test pt.takes-any-real-and-holds-doubles
  (let ((pt (pt 1/2 3)))
    (is (eql 0.5d0 (geo:pt-x pt)))
    (is (eql 3d0 (geo:pt-y pt)))
    (setf (geo:pt-x pt) 7)
    (is (eql 7d0 (geo:pt-x pt)))
    (signals-wrong-argument geo:make-pt (pt "one" 2))
    (signals-wrong-argument geo:pt-y (setf (geo:pt-y pt) (read-from-string "two")))))

(test interval.min-never-exceeds-max
  (signals-wrong-argument geo:make-interval (span 2 1))
  (let ((interval (span 1 2)))
    (signals-wrong-argument geo:interval-min (setf (geo:interval-min interval) 3))
    (signals-wrong-argument geo:interval-max (setf (geo:interval-max interval) 0))
    (signals-wrong-argument geo:set-interval! (geo:set-interval! interval 4 3))
    (setf (geo:interval-max interval) 5 (geo:interval-min interval) 4)
    (is (geo:equal (span 4 5) interval))))

(test pt-interval.normalises-corners
  (is (geo:equal (box 1 4 2 8) (geo:make-pt-interval (pt 4 2) (pt 1 8))))
  (is (geo:equal (box 1 4 2 8) (geo:make-pt-interval (pt 1 2) (pt 4 8))))
  (is (geo:equal (box 1 4 2 2) (geo:make-pt-interval (span 1 4) 2)))
  (signals-wrong-argument geo:make-pt-interval (geo:make-pt-interval (pt 1 2) (span 1 2)))
  (signals-wrong-argument geo:make-pt-interval (geo:make-pt-interval (span 1 2) (pt 1 2))))

(test pt-interval.shares-its-sides-with-nobody
  (let* ((side (span 0 1))
         (box (geo:make-pt-interval side side)))
    (geo:add! box (pt 1 2))
    (is (geo:equal (box 1 2 2 3) box))
    (is (geo:equal (span 0 1) side))
    (setf (geo:pt-interval-x box) side)
    (geo:add! (geo:pt-interval-x box) 9)
    (is (geo:equal (box 9 10 2 3) box))
    (is (geo:equal (span 0 1) side))))

(test pt-interval.knows-its-widths
  (is (= 3 (geo:pt-interval-dx (box 1 4 2 8))))
  (is (= 6 (geo:pt-interval-dy (box 1 4 2 8))))
  (is (geo:equal (box 5 6 7 8) (geo:set-pt-interval! (box 0 0 0 0) 5 6 7 8))))

(test copy-obj.copies-deeply
  (let* ((box (box 1 4 2 8)) (copy (geo:copy-obj box))
         (pt (pt 1 2)) (pt-copy (geo:copy-obj pt)))
    (geo:add! copy (pt 1 1))
    (geo:neg! pt-copy)
    (is (geo:equal (box 1 4 2 8) box))
    (is (geo:equal (pt 1 2) pt))
    (signals-wrong-argument geo:copy-obj (geo:copy-obj "thing"))))

(test equal.is-exact-on-values-and-cl-equal-elsewhere
  (is-true (geo:equal (pt 1 2) (pt 1 2)))
  (is-false (geo:equal (pt 1 2) (pt 1 2.0000001d0)))
  (is-false (geo:equal (span 1 2) (span 1 3)))
  (is-false (geo:equal (span 1 2) (span 0 2)))
  (is-false (geo:equal (box 1 2 3 4) (box 1 2 3 5)))
  (is-false (geo:equal (pt 1 2) (box 1 1 2 2)))
  (is-true (geo:equal '(a "b" 3) '(a "b" 3)))
  (is-false (geo:equal 1 1d0)))

(test values.print-for-readers-and-for-people
  (is (string= "#<PT 1.0 -2.5>" (prin1-to-string (pt 1 -2.5))))
  (is (string= "(1.00,-2.50)" (princ-to-string (pt 1 -2.5))))
  (is (string= "#<INTERVAL 0.0 1.0>" (prin1-to-string (span 0 1))))
  (is (string= "#<INTERVAL 0.0 0.333333>" (prin1-to-string (span -2d-13 1/3)))
      "no more digits than mean something")
  (is (string= "[0.00,1.00]" (princ-to-string (span 0 1))))
  (is (string= "#<PT-INTERVAL 0.0 1.0 2.0 3.0>" (prin1-to-string (box 0 1 2 3))))
  (is (string= "([0.00,1.00],[2.00,3.00])" (princ-to-string (box 0 1 2 3)))))

;;; Table 3.1 on points and numbers.

(test points.follow-vector-arithmetic
  (is (geo:equal (pt 4 6) (geo:add (pt 1 2) (pt 3 4))))
  (is (geo:equal (pt -2 -2) (geo:subtract (pt 1 2) (pt 3 4))))
  (is (geo:equal (pt -1 2) (geo:neg (pt 1 -2))))
  (is (geo:equal (pt 3 -6) (geo:mul (pt 1 -2) 3)))
  (is (= 5 (geo:dist (pt 1 2) (pt 4 6))))
  (is (= 5 (geo:norm (pt 3 -4)))))

(test points.fresh-operations-leave-their-operands-alone
  (let ((a (pt 1 2)) (b (pt 3 4)))
    (dolist (operation (list #'geo:add #'geo:subtract))
      (is (not (eq a (funcall operation a b)))))
    (is (not (eq a (geo:neg a))))
    (is (not (eq a (geo:mul a 2))))
    (is (geo:equal (pt 1 2) a))
    (is (geo:equal (pt 3 4) b))))

(test points.destructive-operations-return-the-changed-operand
  (let ((a (pt 1 2)))
    (is (eq a (geo:add! a (pt 3 4))))
    (is (geo:equal (pt 4 6) a))
    (is (eq a (geo:subtract! a (pt 1 1))))
    (is (geo:equal (pt 3 5) a))
    (is (eq a (geo:neg! a)))
    (is (geo:equal (pt -3 -5) a))
    (is (eq a (geo:mul! a 1/2)))
    (is (geo:equal (pt -1.5 -2.5) a))))

(test numbers.are-elements-too
  (is (= 3 (geo:add 1 2)))
  (is (= -1 (geo:subtract 1 2)))
  (is (= -1 (geo:neg 1)))
  (is (= 6 (geo:mul 2 3)))
  (is (= 4 (geo:dist 1 -3)))
  (is (= 3 (geo:norm -3))))

(test neg.makes-no-negative-zero
  (is (= pi (geo:atan2 (geo:pt-y (geo:neg (pt 1 0))) -1))))

;;; Table 3.1 on intervals.

(test intervals.have-the-bounds-of-interval-arithmetic
  (is (geo:equal (span 4 7) (geo:add (span 1 2) (span 3 5))))
  (is (geo:equal (span -4 -1) (geo:subtract (span 1 2) (span 3 5))))
  (is (geo:equal (span -2 -1) (geo:neg (span 1 2))))
  (is (geo:equal (span -4 -2) (geo:mul (span 1 2) -2)))
  (is (geo:equal (span -6 4) (geo:mul (span -2 3) (span -2 1))))
  (is (geo:equal (span 0 3) (geo:norm (span -3 2))))
  (is (geo:equal (span 1 4) (geo:dist (span 0 2) (span 3 4))))
  (is (geo:equal (span 5 13) (geo:norm (box 3 5 -12 -4)))))

(test intervals.lift-the-elements-they-are-mixed-with
  (is (geo:equal (span 4 5) (geo:add 3 (span 1 2))))
  (is (geo:equal (span 4 5) (geo:add (span 1 2) 3)))
  (is (geo:equal (span 1 2) (geo:subtract 3 (span 1 2))))
  (is (geo:equal (box 2 3 5 6) (geo:add (pt 1 2) (box 1 2 3 4))))
  (is (geo:equal (box 0 1 1 2) (geo:subtract (box 1 2 3 4) (pt 1 2))))
  (is (geo:equal (span 0 5) (geo:dist (pt 1 1) (box 0 4 1 5))))
  (is (geo:equal (box 2 4 4 8) (geo:mul (pt 2 4) (span 1 2)))))

(test intervals.hold-the-results-of-their-elements
  (let ((dice (base:make-dice 32 "geometry")))
    (dotimes (i 300)
      (dolist (maker (list #'some-span #'some-box))
        (let* ((a (funcall maker dice)) (b (funcall maker dice))
               (x (element-of a dice)) (y (element-of b dice))
               (factor (base:roll-within 3 dice)))
          (is (nearly-in-p (geo:add x y) (geo:add a b)))
          (is (nearly-in-p (geo:subtract x y) (geo:subtract a b)))
          (is (nearly-in-p (geo:neg x) (geo:neg a)))
          (is (nearly-in-p (geo:mul x factor) (geo:mul a factor)))
          (is (nearly-in-p (geo:norm x) (geo:norm a)))
          (is (nearly-in-p (geo:dist x y) (geo:dist a b))))))))

(test intervals.destructive-operations-agree-with-fresh-ones
  (let ((dice (base:make-dice 33 "geometry")))
    (dotimes (i 50)
      (dolist (maker (list #'some-span #'some-box))
        (loop for (fresh destructive)
                in (list (list #'geo:add #'geo:add!)
                         (list #'geo:subtract #'geo:subtract!)
                         (list #'geo:interval-lbi #'geo:interval-lbi!)
                         (list #'geo:interval-intersect #'geo:interval-intersect!))
              for a = (funcall maker dice)
              for b = (funcall maker dice)
              for wanted = (funcall fresh a b)
              for copy = (geo:copy-obj a)
              for result = (funcall destructive copy b)
              do (is (geo:equal wanted result))
                 (is (or (eq copy result) (and (null result) (geo:equal a copy)))))))))

(test intervals.destructive-operations-bear-the-same-operand-twice
  (is (geo:equal (span 2 6) (let ((a (span 1 3))) (geo:add! a a))))
  (is (geo:equal (span -2 2) (let ((a (span 1 3))) (geo:subtract! a a))))
  (is (geo:equal (span -3 9) (let ((a (span -1 3))) (geo:mul! a a))))
  (is (geo:equal (pt 0 0) (let ((a (pt 1 3))) (geo:subtract! a a))))
  (is (geo:equal (box -1 1 -2 2) (let ((a (box 1 2 3 5))) (geo:subtract! a a))))
  (is (geo:equal (box 1 2 3 5) (let ((a (box 1 2 3 5))) (geo:interval-lbi! a a))))
  (is (geo:equal (box 1 4 3 10)
                 (let ((a (box 1 2 3 5))) (geo:mul! a (geo:pt-interval-x a))))))

(test operations.reject-what-they-cannot-take
  (signals-wrong-argument geo:add (geo:add (pt 1 2) 3))
  (signals-wrong-argument geo:add (geo:add 'a 3))
  (signals-wrong-argument geo:add! (geo:add! 1 3))
  (signals-wrong-argument geo:add! (geo:add! (pt 1 2) (box 1 2 3 4)))
  (signals-wrong-argument geo:subtract (geo:subtract (span 1 2) (pt 1 2)))
  (signals-wrong-argument geo:subtract! (geo:subtract! (span 1 2) nil))
  (signals-wrong-argument geo:neg (geo:neg "one"))
  (signals-wrong-argument geo:neg! (geo:neg! 1))
  (signals-wrong-argument geo:mul (geo:mul (pt 1 2) (pt 1 2)))
  (signals-wrong-argument geo:mul! (geo:mul! (pt 1 2) nil))
  (signals-wrong-argument geo:dist (geo:dist (pt 1 2) nil))
  (signals-wrong-argument geo:norm (geo:norm nil))
  (signals-wrong-argument geo:nominal (geo:nominal :here))
  (signals-wrong-argument geo:less (geo:less (span 1 2) (box 1 2 3 4)))
  (signals-wrong-argument geo:in-interval (geo:in-interval (span 1 2) (span 0 3)))
  (signals-wrong-argument geo:add-to-lbi (geo:add-to-lbi (span 1 2) (pt 1 2)))
  (signals-wrong-argument geo:interval-lift (geo:interval-lift (span 1 2)))
  (signals-wrong-argument geo:lift-lbi (geo:lift-lbi 1 (pt 1 2)))
  (signals-wrong-argument geo:grow-interval! (geo:grow-interval! (pt 1 2) 1))
  (signals-wrong-argument geo:interval-intersect! (geo:interval-intersect! 1 (span 1 2))))

;;; Table 3.2.

(test interval-intersect?.counts-shared-bounds
  (is-true (geo:interval-intersect? (span 0 1) (span 1 2)))
  (is-false (geo:interval-intersect? (span 0 1) (span 1.5 2)))
  (is-false (geo:interval-intersect? (span 1.5 2) (span 0 1)))
  (is-true (geo:interval-intersect? (box 0 4 0 4) (pt 4 4)))
  (is-false (geo:interval-intersect? (box 0 1 0 1) (box 0 1 2 3)))
  (is-false (geo:interval-intersect? (box 0 1 0 1) (box 2 3 0 1))))

(test interval-subset?.asks-for-every-element
  (is-true (geo:interval-subset? (span 1 2) (span 1 3)))
  (is-false (geo:interval-subset? (span 1 3) (span 1 2)))
  (is-true (geo:interval-subset? 2 (span 1 2)))
  (is-true (geo:interval-subset? (box 1 2 1 2) (box 0 3 1 2)))
  (is-false (geo:interval-subset? (box 1 2 1 4) (box 0 3 1 2))))

(test interval-intersect.is-what-both-have-or-nothing
  (is (geo:equal (span 2 3) (geo:interval-intersect (span 1 3) (span 2 4))))
  (is (geo:equal (box 2 3 0 1) (geo:interval-intersect (box 1 3 0 1) (box 2 4 -1 2))))
  (is (geo:equal (span 2 2) (geo:interval-intersect 2 (span 2 4))))
  (is (null (geo:interval-intersect (span 1 2) (span 3 4))))
  (let ((box (box 0 1 0 1)))
    (is (null (geo:interval-intersect! box (box 0 1 2 3))))
    (is (geo:equal (box 0 1 0 1) box))
    (is (eq box (geo:interval-intersect! box (box 0.5 2 0 1))))
    (is (geo:equal (box 0.5 1 0 1) box))))

(test interval-width.is-the-largest-distance-of-elements
  (is (= 3 (geo:interval-width (span -1 2))))
  (is (= 5 (geo:interval-width (box 0 3 1 5))))
  (is (= 0 (geo:interval-width (pt 1 2)))))

(test interval-dist.is-the-gap
  (is (= 2 (geo:interval-dist (span 0 1) (span 3 4))))
  (is (= 2 (geo:interval-dist (span 3 4) (span 0 1))))
  (is (= 0 (geo:interval-dist (span 0 3) (span 3 4))))
  (is (= 5 (geo:interval-dist (box 0 1 0 1) (box 3 4 6 7))))
  (is (= 1 (geo:interval-dist (pt 0 0) (box 1 2 0 0)))))

(test interval-overlap-width.is-zero-without-overlap
  (is (= 1 (geo:interval-overlap-width (span 0 2) (span 1 4))))
  (is (= 0 (geo:interval-overlap-width (span 0 1) (span 2 4))))
  (is (= 5 (geo:interval-overlap-width (box 0 3 0 4) (box -9 9 -9 9))))
  (is (= 0 (geo:interval-overlap-width (box 0 3 0 4) (box 0 3 5 6)))))

(test interval-lbi.is-the-least-that-contains-both
  (is (geo:equal (span 0 4) (geo:interval-lbi (span 0 1) (span 3 4))))
  (is (geo:equal (span 0 4) (geo:interval-lbi 4 0)))
  (is (geo:equal (box 0 4 -1 2) (geo:interval-lbi (box 0 1 0 2) (pt 4 -1)))))

(test add-to-lbi.takes-one-element
  (is (geo:equal (span 0 5) (geo:add-to-lbi (span 0 1) 5)))
  (let ((box (box 0 1 0 1)) (span (span 0 1)))
    (is (geo:equal (box 0 1 -2 1) (geo:add-to-lbi box (pt 1 -2))))
    (is (geo:equal (box 0 1 0 1) box))
    (is (eq box (geo:add-to-lbi! box (pt 3 3))))
    (is (geo:equal (box 0 3 0 3) box))
    (is (eq span (geo:add-to-lbi! span -1)))
    (is (geo:equal (span -1 1) span))))

(test nominal.is-the-centre
  (is (= 2 (geo:nominal (span 1 3))))
  (is (geo:equal (pt 2 5) (geo:nominal (box 1 3 0 10))))
  (is (= 7 (geo:nominal 7))))

(test grow-interval.stops-shrinking-at-the-centre
  (is (geo:equal (span 0 4) (geo:grow-interval (span 1 3) 1)))
  (is (geo:equal (span 1.5 2.5) (geo:grow-interval (span 1 3) -1/2)))
  (is (geo:equal (span 2 2) (geo:grow-interval (span 1 3) -5)))
  (is (geo:equal (box 2 2 1 9) (geo:grow-interval (box 1 3 0 10) -1)))
  (is (geo:equal (box 5 5 1 9) (geo:grow-interval (box 4.5 5.5 0 10) -1)))
  (is (geo:equal (box 0 2 1 3) (geo:grow-interval (pt 1 2) 1)))
  (let ((box (box 1 3 0 10)))
    (is (eq box (geo:grow-interval! box 1)))
    (is (geo:equal (box 0 4 -1 11) box))))

(test less-and-greater.ask-every-pair-of-elements
  (is-true (geo:less (span 0 1) (span 2 3)))
  (is-false (geo:less (span 0 2) (span 2 3)))
  (is-true (geo:less (box 0 1 0 1) (box 2 3 2 3)))
  (is-false (geo:less (box 0 1 0 1) (box 2 3 1 3)))
  (is-true (geo:greater 4 (span 2 3)))
  (is-false (geo:greater 3 (span 2 3)))
  (is-true (geo:greater (pt 4 4) (box 2 3 2 3)))
  (is-false (geo:greater (pt 4 3) (box 2 3 2 3))))

(test in-interval.includes-the-bounds
  (is-true (geo:in-interval 1 (span 1 2)))
  (is-true (geo:in-interval 2 (span 1 2)))
  (is-false (geo:in-interval 2.1 (span 1 2)))
  (is-true (geo:in-interval (pt 1 4) (box 0 1 4 5)))
  (is-false (geo:in-interval (pt 1 3) (box 0 1 4 5)))
  (is-false (geo:in-interval (pt 2 4) (box 0 1 4 5))))

(test lifts.hold-just-the-elements
  (is (geo:equal (span 3 3) (geo:interval-lift 3)))
  (is (geo:equal (box 1 1 2 2) (geo:interval-lift (pt 1 2))))
  (is (geo:equal (span -1 7) (geo:lift-lbi 3 7 -1)))
  (is (geo:equal (box 0 5 -2 2) (geo:lift-lbi (pt 1 2) (pt 5 -2) (pt 0 0))))
  (is (geo:equal (span 3 3) (geo:lift-lbi 3))))

;;; Consing.

(defun bytes-consed-by (function &optional (calls 10000))
  "Return how many bytes as many CALLS of FUNCTION cons."
  (let ((before (sb-ext:get-bytes-consed)))
    (dotimes (i calls) (funcall function))
    (- (sb-ext:get-bytes-consed) before)))

(test destructive-operations.do-not-cons
  (let ((pt (pt 1 2)) (still (pt 0 0)) (span (span 1 2)) (point-span (span 0 0))
        (box (box 1 2 3 4)) (other (box 0 0 0 0)))
    (macrolet ((claim (&rest forms)
                 `(progn ,@(loop for form in forms
                                 collect `(is (> 80000 (bytes-consed-by (lambda () ,form)))
                                              "~S conses" ',form)))))
      (claim (geo:add! pt still) (geo:subtract! pt pt) (geo:neg! pt)
             (geo:mul! pt 1) (geo:mul! pt 1f0)
             (geo:add! span 1) (geo:subtract! span point-span) (geo:neg! span) (geo:mul! span 0.5d0)
             (geo:add! box pt) (geo:subtract! box other) (geo:neg! box) (geo:mul! box 0)
             (geo:interval-lbi! span 2) (geo:interval-lbi! box other)
             (geo:interval-intersect! span span) (geo:interval-intersect! box box)
             (geo:add-to-lbi! span 2d0) (geo:add-to-lbi! box pt)
             (geo:grow-interval! span 0) (geo:grow-interval! box 0.25d0)
             (geo:interval-intersect? box other) (geo:in-interval pt box) (geo:less box other)
             (geo:equal box other)
             (geo:set-pt! pt 1 2) (geo:set-interval! span 1 2)
             (geo:set-pt-interval! box 1 2 3 4)))))

;;; Angles.

(test angles.constants-are-what-they-are-called
  (is (= geo:2pi (* 2 pi)))
  (is (geo:equal (pt 0 0) geo:origin*))
  (is (= (/ pi 2) (geo:atan2 1 0)))
  (is (= pi (geo:atan2 0 -1)))
  (signals-wrong-argument geo:atan2 (geo:atan2 (pt 1 2) 0)))

(test angle-difference.is-the-shortest-signed-turn
  (is (= pi (geo:angle-difference pi 0)))
  (is (= pi (geo:angle-difference 0 pi)))
  (is (= 1 (geo:angle-difference 3 2)))
  (is (= -1 (geo:angle-difference 2 3)))
  (let ((dice (base:make-dice 50 "angles")))
    (dotimes (i 500)
      (let* ((a (base:roll-within 100 dice)) (b (base:roll-within 100 dice))
             (turn (geo:angle-difference a b)))
        (is (and (< (- pi) turn) (<= turn pi)))
        (is (< (abs (- (cos (+ b turn)) (cos a))) 1d-9))
        (is (< (abs (- (sin (+ b turn)) (sin a))) 1d-9))))))

(test nearest-angle.chooses-by-turn-and-returns-as-given
  (is (= 7 (geo:nearest-angle 0.5d0 2 7 4)))
  (is (= -5.75 (geo:nearest-angle 0.5d0 -5.75 1.5)))
  (is (eql 1 (geo:nearest-angle 0 1 -1))))
