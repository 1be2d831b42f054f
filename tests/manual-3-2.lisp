;;;; manual-3-2.lisp -- section 3.2.1 of the manual: directions, points and intervals.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-3-2 :in ars-magna)

(defmacro gives (&rest pairs)
  "Claim for each of PAIRS, a form and the next, that their values are ARS:EQUAL, or the same
number."
  `(progn ,@(loop for (form expected) on pairs by #'cddr
                  collect `(is (equalp* ,expected ,form)))))

(defun equalp* (a b)
  (if (and (numberp a) (numberp b)) (= a b) (equal a b)))

(defun at (x y) (make PT x y))
(defun span (min max) (make INTERVAL min max))
(defun box (x-min x-max y-min y-max) (make PT-INTERVAL (span x-min x-max) (span y-min y-max)))

(defun changes-its-first-argument-p (function first &rest more)
  "True if FUNCTION returns FIRST itself, as different as a copy would be by the function named
without the mark, and leaves MORE alone."
  (let* ((plain (intern (string-right-trim "!" (symbol-name function)) :ars))
         (expected (apply plain (copy-obj first) more))
         (copies (mapcar #'copy-obj more)))
    (and (eq first (apply function first more))
         (equal expected first)
         (every #'equal copies more))))

(defun leaves-its-arguments-alone-p (function &rest arguments)
  (let ((copies (mapcar #'copy-obj arguments)))
    (and (not (member (apply function arguments) arguments :test #'eq))
         (every #'equal copies arguments))))

;;; 3.2: directions.

(test manual-3-2.x-grows-to-the-right-and-y-downward
  "3.2, reading 49: as the text map draws it, a robot with the heading pi/2 goes down."
  (flet ((row-of-robot ()
           (count #\Newline (text-map scout)
                  :end (position-if (lambda (c) (find c "<>^v")) (text-map scout)))))
    (with-scout (:clean t)
      (turned-to (/ pi 2))
      (let ((row (row-of-robot)) (y (robot-y scout)))
        (answer 'robot-go-forward scout 5)
        (is (near 4 (- (robot-y scout) y)))
        (is (< row (row-of-robot)))))))

(test manual-3-2.angles-grow-clockwise-from-positive-x
  "3.2, reading 49: 0 is along x, a turn to the right adds pi/2 and faces positive y."
  (at-each-spot (:clean t)
    (is (= 0 (robot-angle scout)))
    (answer 'robot-turn-right scout)
    (is (near (/ pi 2) (robot-angle scout)))
    (answer 'robot-go-forward scout 2)
    (is (near 1.6d0 (- (robot-y scout) (second spot)) 1d-6))
    (answer 'robot-turn-left scout)
    (answer 'robot-turn-left scout)
    (is (near (/ pi -2) (robot-angle scout)))))

(test manual-3-2.pi-and-two-pi-are-constants
  "3.2, reading 35: angles are in radians, and pi and 2pi are defined constants."
  (is-true (constantp 'pi))
  (is-true (constantp '2pi))
  (is (= 2pi (* 2 pi)))
  (is (near -1 (cos pi))))

(test manual-3-2.angles-are-not-reduced
  "Reading 50: whole turns stay in the angles of robot and cameras."
  (at-each-spot (:clean t)
    (dotimes (i 3) (answer 'robot-about-face scout))
    (answer 'camera-turn (eye) -7)
    (is (near (* 3 pi) (robot-angle scout)))
    (is (= -7 (camera-angle (eye))))))

;;; 3.2.1: the datatypes.

(test manual-3-2-1.points-have-x-and-y
  "3.2.1: (make PT x y) makes a point with slots x and y, which can be set."
  (dolist (numbers '((3 4) (1/2 -2.25) (0 1d9)))
    (let ((p (make PT (first numbers) (second numbers))))
      (gives !>p.x (first numbers) !>p.y (second numbers))
      (!= !>p.x 7)
      (gives p (at 7 (second numbers))))))

(test manual-3-2-1.intervals-have-min-and-max
  "3.2.1: (make INTERVAL min max)."
  (let ((i (make INTERVAL -1/2 3)))
    (gives !>i.min -1/2 !>i.max 3)
    (!= !>i.max 4)
    (gives i (span -1/2 4))))

(test manual-3-2-1.intervals-are-never-upside-down
  "Reading 43: a minimum above the maximum is an error; one that equals it is not."
  (signals wrong-argument (make INTERVAL 2 1))
  (gives (interval-width (make INTERVAL 2 2)) 0))

(test manual-3-2-1.point-intervals-of-two-intervals
  "3.2.1: (make PT-INTERVAL x-int y-int), with slots x and y."
  (let ((b (make PT-INTERVAL (span 1 4) (span 2 8))))
    (gives !>b.x (span 1 4) !>b.y (span 2 8))))

(test manual-3-2-1.point-intervals-of-two-corners
  "3.2.1, reading 43: (make PT-INTERVAL pt-min pt-max), opposite corners in any order."
  (dolist (corners '((1 2 4 8) (4 8 1 2) (1 8 4 2) (4 2 1 8)))
    (destructuring-bind (x0 y0 x1 y1) corners
      (gives (make PT-INTERVAL (at x0 y0) (at x1 y1)) (box 1 4 2 8)))))

(test manual-3-2-1.point-intervals-know-their-widths
  "3.2.1: computed slots dx and dy give the widths along the axes."
  (let ((b (box 1 4 2 8)))
    (gives !>b.dx 3 !>b.dy 6)
    (!= !>b.x.max 11)
    (gives !>b.dx 10)))

;;; Table 3.1, on points and, in the obvious fashion, on intervals: readings 42 and 48.

(test manual-3-2-1.add
  "Table 3.1: adds two points as vectors."
  (gives (add (at 1 2) (at 3 4.5)) (at 4 6.5)
         (add (span 1 2) (span 3 5)) (span 4 7)
         (add (box 1 2 3 4) (at 1 -1)) (box 2 3 2 3)
         (add 3 (span 1 2)) (span 4 5))
  (is-true (leaves-its-arguments-alone-p 'add (at 1 2) (at 3 4))))

(test manual-3-2-1.add!
  "Table 3.1: a destructive add, which changes and returns its first argument."
  (is-true (changes-its-first-argument-p 'add! (at 1 2) (at 3 4)))
  (is-true (changes-its-first-argument-p 'add! (span 1 2) (span 3 5)))
  (is-true (changes-its-first-argument-p 'add! (box 1 2 3 4) (at 5 6))))

(test manual-3-2-1.subtract
  "Table 3.1, reading 42: of intervals, the result holds every difference."
  (gives (subtract (at 1 2) (at 3 4.5)) (at -2 -2.5)
         (subtract (span 1 2) (span 3 5)) (span -4 -1)
         (subtract (box 1 2 3 4) (at 1 -1)) (box 0 1 4 5))
  (is-true (leaves-its-arguments-alone-p 'subtract (span 1 2) (span 3 5))))

(test manual-3-2-1.subtract!
  "Table 3.1, reading 48: destructive; right also if both arguments are the same."
  (is-true (changes-its-first-argument-p 'subtract! (at 1 2) (at 3 4)))
  (is-true (changes-its-first-argument-p 'subtract! (box 1 2 3 4) (box 0 1 0 1)))
  (let ((p (at 1 2)) (i (span 1 3)))
    (gives (subtract! p p) (at 0 0)
           (subtract! i i) (span -2 2))))

(test manual-3-2-1.neg
  "Table 3.1, reading 42: an interval swaps its bounds."
  (gives (neg (at 1 -2.5)) (at -1 2.5)
         (neg (span 1 2)) (span -2 -1)
         (neg (box 1 2 -3 4)) (box -2 -1 -4 3))
  (is-true (leaves-its-arguments-alone-p 'neg (box 1 2 3 4))))

(test manual-3-2-1.neg!
  "Table 3.1: a destructive negation."
  (is-true (changes-its-first-argument-p 'neg! (at 1 2)))
  (is-true (changes-its-first-argument-p 'neg! (span 1 2)))
  (is-true (changes-its-first-argument-p 'neg! (box 1 2 3 4))))

(test manual-3-2-1.mul
  "Table 3.1, readings 3 and 42: a negative factor swaps an interval's bounds."
  (gives (mul (at 1 -2) 2.5) (at 2.5 -5)
         (mul (span 1 2) -2) (span -4 -2)
         (mul (box 1 2 -3 4) -1) (box -2 -1 -4 3)
         (mul (span -2 3) (span -2 1)) (span -6 4))
  (is-true (leaves-its-arguments-alone-p 'mul (at 1 2) 3)))

(test manual-3-2-1.mul!
  "Table 3.1: a destructive multiplication."
  (is-true (changes-its-first-argument-p 'mul! (at 1 2) 1/3))
  (is-true (changes-its-first-argument-p 'mul! (span 1 2) -3))
  (is-true (changes-its-first-argument-p 'mul! (box 1 2 3 4) 0)))

(test manual-3-2-1.dist
  "Table 3.1, reading 42: the Euclidean distance, between intervals the interval of all."
  (gives (dist (at 1 2) (at 4 6)) 5
         (dist (at 0.5 0) (at 0.5 0)) 0
         (dist (span 0 2) (span 3 4)) (span 1 4)
         (dist (box 0 1 0 1) (at 4 5)) (span 5 (dist (at 0 0) (at 4 5)))))

(test manual-3-2-1.norm
  "Table 3.1: the Euclidean length, of an interval the interval of the lengths in it."
  (gives (norm (at -3 4)) 5
         (norm (span -3 2)) (span 0 3)
         (norm (box 3 5 -12 -4)) (span 5 13)))

(test manual-3-2-1.equal
  "Table 3.1, reading 234: whether two points are the same, exactly."
  (is-true (equal (at 1 2) (at 1.0 2)))
  (is (not (equal (at 1 2) (at 1 (+ 2 1d-15)))))
  (is-true (equal (span 1 2) (span 1 2)))
  (is (not (equal (span 1 2) (span 1 3))))
  (is-true (equal (box 1 2 3 4) (box 1 2 3 4)))
  (is (not (equal (box 1 2 3 4) (box 1 2 3 5))))
  (is (not (equal (at 1 2) (box 1 1 2 2)))))

(test manual-3-2-1.copy-obj
  "Table 3.1, reading 234: a copy is the same, and shares nothing with the original."
  (dolist (object (list (at 1 2) (span 1 2) (box 1 2 3 4)))
    (let ((copy (copy-obj object)))
      (is-true (equal object copy))
      (neg! copy)
      (is (not (equal object copy)))))
  (let* ((b (box 1 2 3 4)) (copy (copy-obj b)))
    (!= !>copy.x.max 9)
    (gives b (box 1 2 3 4))))
