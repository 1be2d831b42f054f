;;;; manual-3-2-intervals.lisp -- section 3.2.1 of the manual: the operations of Table 3.2.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-2)

;;; GIVES, AT, SPAN and BOX are those of manual-3-2.lisp.

(test manual-3-2-1.interval-intersect?
  "Table 3.2, reading 47: do two intervals share an element, be it a bound?"
  (is-true (interval-intersect? (span 0 1) (span 1 2)))
  (is (not (interval-intersect? (span 0 1) (span 1.5 2))))
  (is-true (interval-intersect? (box 0 2 0 2) (box 1 3 2 4)))
  (is (not (interval-intersect? (box 0 2 0 2) (box 1 3 2.5 4)))))

(test manual-3-2-1.interval-subset?
  "Table 3.2: is each element of the first in the second?"
  (is-true (interval-subset? (span 1 2) (span 1 3)))
  (is (not (interval-subset? (span 1 3) (span 1 2))))
  (is-true (interval-subset? (box 1 2 1 2) (box 0 3 1 2)))
  (is (not (interval-subset? (box 1 2 1 4) (box 0 3 1 2)))))

(test manual-3-2-1.interval-intersect
  "Table 3.2: an interval of the right type; reading 44: #F if they do not meet."
  (gives (interval-intersect (span 1 3) (span 2 4)) (span 2 3)
         (interval-intersect (box 1 3 0 1) (box 2 4 -1 .5)) (box 2 3 0 .5)
         (interval-intersect (span 1 2) (span 3 4)) #F
         (interval-intersect (box 0 1 0 1) (box 0 1 2 3)) #F)
  (is-true (leaves-its-arguments-alone-p 'interval-intersect (span 1 3) (span 2 4))))

(test manual-3-2-1.interval-intersect!
  "Table 3.2, reading 44: changes the first, but leaves it alone if they do not meet."
  (is-true (changes-its-first-argument-p 'interval-intersect! (span 1 3) (span 2 4)))
  (is-true (changes-its-first-argument-p 'interval-intersect! (box 1 3 0 1) (box 2 4 -1 .5)))
  (let ((b (box 0 1 0 1)))
    (gives (interval-intersect! b (box 0 1 2 3)) #F
           b (box 0 1 0 1))))

(test manual-3-2-1.interval-width
  "Table 3.2, reading 45: the largest distance of two elements, of a box its diagonal."
  (gives (interval-width (span -1 2)) 3
         (interval-width (box 0 3 1 5)) 5))

(test manual-3-2-1.interval-dist
  "Table 3.2, reading 46: the gap, of boxes the larger of the two along the axes; 0 if they meet."
  (gives (interval-dist (span 0 1) (span 3 4)) 2
         (interval-dist (span 3 4) (span 0 1)) 2
         (interval-dist (span 0 3) (span 3 4)) 0
         (interval-dist (box 0 1 0 1) (box 3 4 6 7)) 5
         (interval-dist (box 0 1 0 1) (box 0 1 6 7)) 5))

(test manual-3-2-1.interval-overlap-width
  "Table 3.2, reading 47: the width of what both have, 0 without overlap."
  (gives (interval-overlap-width (span 0 2) (span 1 4)) 1
         (interval-overlap-width (span 0 1) (span 2 4)) 0
         (interval-overlap-width (box 0 3 0 4) (box -9 9 -9 9)) 5))

(test manual-3-2-1.interval-lbi
  "Table 3.2: the smallest interval that contains both."
  (gives (interval-lbi (span 0 1) (span 3 4)) (span 0 4)
         (interval-lbi (span 0 9) (span 3 4)) (span 0 9)
         (interval-lbi (box 0 1 0 2) (box 3 4 -1 1)) (box 0 4 -1 2))
  (is-true (leaves-its-arguments-alone-p 'interval-lbi (span 0 1) (span 3 4))))

(test manual-3-2-1.interval-lbi!
  "Table 3.2: the same, destructively."
  (is-true (changes-its-first-argument-p 'interval-lbi! (span 0 1) (span 3 4)))
  (is-true (changes-its-first-argument-p 'interval-lbi! (box 0 1 0 2) (box 3 4 -1 1))))

(test manual-3-2-1.add-to-lbi
  "Table 3.2, reading 3: the LBI with a number or a point."
  (gives (add-to-lbi (span 0 1) 5) (span 0 5)
         (add-to-lbi (span 0 1) .5) (span 0 1)
         (add-to-lbi (box 0 1 0 1) (at 1 -2)) (box 0 1 -2 1))
  (signals wrong-argument (add-to-lbi (span 0 1) (at 1 2)))
  (is-true (leaves-its-arguments-alone-p 'add-to-lbi (span 0 1) 5)))

(test manual-3-2-1.add-to-lbi!
  "Table 3.2: the same, destructively."
  (is-true (changes-its-first-argument-p 'add-to-lbi! (span 0 1) -5))
  (is-true (changes-its-first-argument-p 'add-to-lbi! (box 0 1 0 1) (at 7 7))))

(test manual-3-2-1.nominal
  "Table 3.2: the centre, a number or a point."
  (gives (nominal (span 1 4)) 2.5
         (nominal (box 1 3 0 10)) (at 2 5)))

(test manual-3-2-1.grow-interval
  "Table 3.2: each boundary moves by the number; reading 47: shrinking stops at the centre."
  (gives (grow-interval (span 1 3) 1) (span 0 4)
         (grow-interval (span 1 3) -1/2) (span 1.5 2.5)
         (grow-interval (span 1 3) -5) (span 2 2)
         (grow-interval (box 1 3 0 10) 1) (box 0 4 -1 11)
         (grow-interval (box 1 3 0 10) -2) (box 2 2 2 8))
  (is-true (leaves-its-arguments-alone-p 'grow-interval (span 1 3) 1)))

(test manual-3-2-1.grow-interval!
  "Table 3.2: the same, destructively."
  (is-true (changes-its-first-argument-p 'grow-interval! (span 1 3) 1))
  (is-true (changes-its-first-argument-p 'grow-interval! (box 1 3 0 10) -1)))

(test manual-3-2-1.less
  "Table 3.2, reading 47: each element less than every one of the other, along both axes."
  (is-true (less (span 0 1) (span 2 3)))
  (is (not (less (span 0 2) (span 2 3))))
  (is-true (less (box 0 1 0 1) (box 2 3 2 3)))
  (is (not (less (box 0 1 0 1) (box 2 3 1 3)))))

(test manual-3-2-1.greater
  "Table 3.2, reading 47: each element greater than every one of the other."
  (is-true (greater (span 4 5) (span 2 3)))
  (is (not (greater (span 3 5) (span 2 3))))
  (is-true (greater (box 4 5 4 5) (box 2 3 2 3)))
  (is (not (greater (box 4 5 3 5) (box 2 3 2 3)))))

(test manual-3-2-1.in-interval
  "Table 3.2, reading 47: bounds belong to their interval."
  (loop for (x in) in '((1 t) (2 t) (1.5 t) (2.001 nil) (.999 nil))
        do (is (eq in (and (in-interval x (span 1 2)) t))))
  (is-true (in-interval (at 1 4) (box 0 1 4 5)))
  (is (not (in-interval (at 1 3.9) (box 0 1 4 5)))))

(test manual-3-2-1.interval-lift
  "Table 3.2: the interval that contains only x."
  (gives (interval-lift 3) (span 3 3)
         (interval-lift (at 1 2.5)) (box 1 1 2.5 2.5)))

(test manual-3-2-1.lift-lbi
  "Table 3.2: the smallest interval that contains all that is given, one or more."
  (gives (lift-lbi 3) (span 3 3)
         (lift-lbi 3 7 -1) (span -1 7)
         (lift-lbi (at 1 2) (at 5 -2) (at 0 0)) (box 0 5 -2 2)))

(test manual-3-2-1.results-contain-those-of-elements
  "Reading 42: for any points in two boxes, sum, difference and distance are in the results for the
boxes."
  (let ((dice (roll-source 7)))
    (flet ((some-box ()
             (let ((x (funcall dice -5 5)) (y (funcall dice -5 5)))
               (box x (+ x (funcall dice 0 3)) y (+ y (funcall dice 0 3)))))
           (element (b)
             (at (funcall dice !>b.x.min !>b.x.max) (funcall dice !>b.y.min !>b.y.max))))
      (dotimes (i 200)
        (let* ((a (some-box)) (b (some-box)) (p (element a)) (q (element b)))
          (loop for (operation holds) in '((add t) (subtract t) (dist t))
                do (is (eq holds (and (in-interval (funcall operation p q)
                                                   (grow-interval (funcall operation a b)
                                                                  1d-9))
                                      t)))))))))

(defun roll-source (seed)
  "Return a function of two bounds that rolls numbers between them, the same for each SEED."
  (let ((state seed))
    (lambda (low high)
      (setf state (mod (+ (* 1103515245 state) 12345) (expt 2 31)))
      (+ low (* (- high low) (/ state (expt 2d0 31)))))))
