;;;; corners.lisp -- driving and seeing exactly along borders and through corners of cells.

(in-package :ars-magna.tests)

(in-suite moving)

;;; A robot drives across a bare field, 20 by 20, with blocks put in its way.
(world:defmap field (20 20))
(robot:defrobot rider (field (5.5 5.5) 0) :cameras (((/ pi 2) 5)))

(defun blocks (cells)
  (loop for (x y) in cells do (put 'block (list (+ x .5) (+ y .5)) :obsmove t :obsview t)))

(defun ride (start direction blocks &key (speed 1) (ticks 6))
  "Let RIDER drive from START, a list (x y), in DIRECTION, in radians, with BLOCKS, cells, in the
way. Return where it comes to, x and y, and the error code."
  (let ((code :none))
    (run:with-simulation (rider :clean t)
      (blocks blocks)
      (robot:set-robot-pose rider (first start) (second start) direction)
      (command:robot-set-speed rider speed)
      (command:robot-go-forward rider ticks (lambda (err robot)
                                              (declare (ignore robot))
                                              (setf code err)))
      (run:run-ticks (+ 10 ticks))
      (values (robot:robot-x rider) (robot:robot-y rider) code))))

(defmacro is-ride ((x y code) &rest arguments)
  "Claim that RIDE with ARGUMENTS ends at X and Y, but for the contact gap, with CODE."
  `(multiple-value-bind (x y code) (ride ,@arguments)
     (is (near ,x x 2d-6))
     (is (near ,y y 2d-6))
     (is (eq ,code code))))

(defun straight-to (start goal)
  (atan (float (- (second goal) (second start)) 1d0) (- (first goal) (first start))))

(test border.is-ridden-along
  "What lies on the other side does not matter, whichever way the robot goes."
  (loop for turns from -3 to 3
        do (is-ride (4 10 nil) '(10 10) (+ pi (* 2 pi turns)) '((8 9) (6 9)))
           (is-ride (16 10 nil) '(10 10) (* 2 pi turns) '((12 9) (14 9)))
           (is-ride (10 4 nil) '(10 10) (+ (/ pi -2) (* 2 pi turns)) '((9 8) (9 6)))
           (is-ride (10 16 nil) '(10 10) (+ (/ pi 2) (* 2 pi turns)) '((9 12) (9 14)))))

(test border.belongs-to-the-cell-behind-it
  (is-ride (12 10 :robot-blocked) '(8 10) 0 '((12 10)))
  (is-ride (9 10 :robot-blocked) '(13 10) pi '((8 10)))
  (is-ride (10 9 :robot-blocked) '(10 13) (/ pi -2) '((10 8))))

(test border.is-reached-exactly
  "A robot that drives as far as a border is beyond it if it goes on to the right or down."
  (loop for (start direction x y) in `(((10.5 10.5) 0 11 10) ((10.5 10.5) ,pi 10 10)
                                       ((10.5 10.5) ,(/ pi 2) 10 11) ((10.5 10.5) ,(/ pi -2) 10 10))
        do (multiple-value-bind (to-x to-y) (ride start direction '() :speed .5 :ticks 1)
             (is (= x (floor to-x)))
             (is (= y (floor to-y))))))

(test corner.of-one-block-is-passed
  "From each side, with the block to the left or to the right."
  (loop for (x y) in '((6 6) (14 6) (6 14) (14 14))
        do (dolist (beside '(((9 10)) ((10 9)) ((9 9)) ((10 10))))
             (unless (member (list (first (first beside)) (second (first beside)))
                             (if (eq (< x 10) (< y 10)) '((9 9) (10 10)) '((9 10) (10 9)))
                             :test #'equal)
               (multiple-value-bind (to-x to-y code)
                   (ride (list x y) (straight-to (list x y) '(10 10)) beside :ticks 8)
                 (is (null code))
                 (is (near (/ 8 (sqrt 2d0)) (abs (- to-x x)) 2d-6))
                 (is (near (/ 8 (sqrt 2d0)) (abs (- to-y y)) 2d-6)))))))

(test corner.between-two-blocks-is-closed
  "So an oblique wall has no holes."
  (loop for (x y) in '((6 6) (14 6) (6 14) (14 14))
        do (let ((beside (if (eq (< x 10) (< y 10)) '((9 10) (10 9)) '((9 9) (10 10)))))
             (is-ride (10 10 :robot-blocked)
                      (list x y) (straight-to (list x y) '(10 10)) beside :ticks 8))))

(test corner.is-seen-past-as-it-is-driven-past
  (loop for (blocks clear) in '((((10 9)) t) (((9 10)) t) (((10 9) (9 10)) nil) (((9 9)) nil)
                                (((10 10)) nil))
        do (run:with-simulation (rider :clean t)
             (blocks blocks)
             (is (eq clear (and (robot:line-clear-p world:*world* 8.5d0 8.5d0 12.5d0 12.5d0) t)))
             (is (eq clear (and (robot:line-clear-p world:*world* 12.5d0 12.5d0 8.5d0 8.5d0) t))))))

(test corner.is-looked-past-as-it-is-driven-past
  "Reading 100: in views, and in searches by a single ray."
  (loop for (blocks clear) in '((((10 9)) t) (((9 10)) t) (((10 9) (9 10)) nil) (((9 9)) nil))
        do (loop for (x angle goal) in `((8.5 ,(/ pi 4) 12.5d0) (12.5 ,(* -3/4 pi) 7.5d0))
                 do (run:with-simulation (rider :clean t :parameters '((base:scan-density* 1)))
                      (blocks blocks)
                      (put 'post (list goal goal) :substance 'world:metal :obsview t)
                      (robot:set-robot-pose rider x x angle)
                      (let* ((camera (robot:robot-camera rider 0))
                             (pixel (third (robot:take-view camera)))
                             (seen (mapcar #'world:thing-x
                                           (robot::things-in-view camera :non-local))))
                        (is (eq clear (and (member goal seen) t)) "~S ~S" blocks seen)
                        (is (eq clear (= pixel 80))
                            "~S ~S" blocks pixel))))))

(test edge-of-the-map.stops-robots
  (is-ride (0 10 :robot-blocked) '(3 10) pi '())
  (is-ride (20 10 :robot-blocked) '(17 10) 0 '())
  (is-ride (0 0 :robot-blocked) '(3 3) (straight-to '(3 3) '(0 0)) '())
  (is-ride (20 20 :robot-blocked) '(17 17) (straight-to '(17 17) '(20 20)) '())
  ;; Along the edge itself.
  (is-ride (6 0 nil) '(12 0) pi '()))

(test robot.leaves-a-cell-that-was-blocked-around-it
  (is-ride (8.5 10 nil) '(10.5 10) pi '((10 10)) :ticks 2))

(test sight.is-the-same-in-mirrors
  "The robot sees a cell if it sees one of its corners, whichever. In the mirrored field, with the
blocks mirrored, it sees the same."
  (let ((dice (base:make-dice 11)) (seen 0))
    (flet ((roll () (floor (base:roll-between 0 20 dice))))
      (loop repeat 40
            do (let* ((cells (loop repeat 60 collect (list (roll) (roll))))
                      (pairs (loop repeat 20 collect (list (+ (roll) .3d0) (+ (roll) .4d0)
                                                           (+ (roll) .7d0) (+ (roll) .6d0))))
                      (answers (loop for mirror in '(nil :across :down)
                                     collect (cells-seen cells pairs mirror))))
                 (incf seen (count t (first answers)))
                 (is (equal (first answers) (second answers)))
                 (is (equal (first answers) (third answers))))))
    (is (< 80 seen 720))))

(defun cells-seen (cells pairs mirror)
  "Return for each of PAIRS (x y to-x to-y) T if the second point's cell is seen from the first past
blocks in CELLS, or NIL, all mirrored :ACROSS or :DOWN."
  (flet ((turn (x y size)
           (list (if (eq mirror :across) (- size x) x) (if (eq mirror :down) (- size y) y))))
    (run:with-simulation (rider :clean t)
      (blocks (loop for (x y) in cells collect (turn x y 19)))
      (loop for (x y to-x to-y) in pairs
            collect (and (apply #'robot:in-sight-p world:*world*
                                (append (turn x y 20d0) (turn to-x to-y 20d0)))
                         t)))))
