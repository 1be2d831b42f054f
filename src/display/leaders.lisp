;;;; leaders.lisp -- whose name it is: lines from robots to names that have no room beside them.

(in-package :ars-magna.display)

;;; A name without a line belongs to what is nearest to it. Where robots crowd, there is no room for
;;; such: the name stands farther off, and a thin line leads to it, which meets no other robot
;;; unless there is no other way.

(defun rivals (spot)
  "Return the images of the robots for whose names that of SPOT could be taken: all others but those
on the same spot, the rings of which are around each other."
  (and (spot-robot spot)
       (remove-if (lambda (other) (one-spot-p (spot-robot spot) other)) (spot-robots spot))))

(defun nearest-in (box x y)
  "Return the point of BOX that is nearest to X, Y, as two values."
  (destructuring-bind (left top right bottom) box
    (values (clamp x left right) (clamp y top bottom))))

(defun apart (x y to-x to-y)
  (sqrt (+ (expt (- to-x x) 2) (expt (- to-y y) 2))))

(defun off-ring (image x y)
  "Return how far X, Y is from the ring of the robot of IMAGE, in pixels; less than 0 within."
  (- (apart x y (to-pixels (robot-image-x image)) (to-pixels (robot-image-y image)))
     (robot-radius)))

(define-constant +own+ 6
  :documentation "How much farther from other robots than from its own a name is, in pixels.")

(defun own-box-p (spot box)
  "True if who reads a name in BOX takes it for that of SPOT."
  (flet ((off (x y)
           (multiple-value-bind (to-x to-y) (nearest-in box x y) (apart x y to-x to-y))))
    (loop with own = (- (off (spot-x spot) (spot-y spot)) (spot-half spot))
          for rival in (rivals spot)
          never (< (- (off (to-pixels (robot-image-x rival)) (to-pixels (robot-image-y rival)))
                      (robot-radius))
                   (+ own +own+)))))

(define-constant +leader-lengths+ '(10 18 28 40 56 76)
  :test #'cl:equal
  :documentation "How long lines to names are, in pixels: the shortest that is free counts.")

(defun box-at-end (x y angle width)
  "Return the box of a name WIDTH pixels wide that a line ends at which comes to X, Y in direction
ANGLE."
  (flet ((before (share size)
           (cond ((< share -1/3) size) ((< 1/3 share) 0) (t (/ size 2)))))
    (let ((left (- x (before (cos angle) width))) (top (- y (before (sin angle) +name-height+))))
      (list left top (+ left width) (+ top +name-height+)))))

(defun led-boxes (spot width)
  "Return boxes for the name of SPOT, WIDTH pixels wide, farther off: the nearest first."
  (loop for length in +leader-lengths+
        append (loop for turn below 16
                     for angle = (* turn (/ pi 8))
                     collect (destructuring-bind (x y)
                                 (around (spot-x spot) (spot-y spot) angle
                                         (+ length (spot-half spot)))
                               (box-at-end x y angle width)))))

(defun leader-ends (spot box)
  "Return the ends of the line from SPOT to BOX, as a list x y x y."
  (let ((x (spot-x spot)) (y (spot-y spot)))
    (multiple-value-bind (to-x to-y) (nearest-in box x y)
      (append (around x y (atan (- to-y y) (- to-x x)) (spot-half spot)) (list to-x to-y)))))

(defun leader-clear-p (spot box taken)
  "True if the line from SPOT to BOX meets no ring of another robot and none of the boxes TAKEN but
that of SPOT."
  (destructuring-bind (x y to-x to-y) (leader-ends spot box)
    (loop for step from 0 to 8
          for at-x = (+ x (* step 1/8 (- to-x x))) and at-y = (+ y (* step 1/8 (- to-y y)))
          always (and (every (lambda (rival) (< 2 (off-ring rival at-x at-y))) (rivals spot))
                      (or (overlap-p (box-around at-x at-y 1) (spot-box spot))
                          (notany (lambda (other) (overlap-p (box-around at-x at-y 1) other))
                                  taken))))))

(defun led-box (snapshot layers spot width taken)
  "Return the box farther off where the name of SPOT, WIDTH pixels wide, hides least, or NIL: if it
can be, one to which a clear line leads."
  (let ((boxes (led-boxes spot width)))
    (flet ((best (boxes) (best-box snapshot layers boxes taken :anywhere-p t)))
      (or (best (remove-if-not (lambda (box) (leader-clear-p spot box taken)) boxes))
          (best boxes)))))

(defun draw-leader (canvas spot box)
  "Draw the line from SPOT to its name in BOX."
  (inked (black*)
    (draw-segments canvas draw-gcontext* (leader-ends spot box))))
