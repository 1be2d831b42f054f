;;;; robots.lisp -- a robot on the map: a ring with an arrowhead, and a line for each camera.

(in-package :ars-magna.display)

;;; It is drawn below things and hollow, so that it hides nothing of what it is about to grasp.
;;; Where there are several, each has a colour and dashes in its turn; without colours, the heads of
;;; every second five are hollow.

(defun robot-radius ()
  "Return the radius of the ring that a robot is drawn as, in pixels: nearly a cell, but half of one
where cells are large, so that the ring fits into a map of one cell."
  (max 6 (min (* 7/8 graphics-scale*) (+ 10 (* 1/4 graphics-scale*)))))

(define-constant +between-rings+ 4
  :documentation "How far the rings of robots on one spot are apart, in pixels.")

(defun one-spot-p (image other)
  "True if the rings of two robots would be taken for one."
  (> (robot-radius)
     (* 2 (to-pixels (max (abs (- (robot-image-x image) (robot-image-x other)))
                          (abs (- (robot-image-y image) (robot-image-y other))))))))

(defun ring-radius (image robots)
  "Return the radius of the ring that IMAGE, one of ROBOTS, is drawn as, in pixels: around those of
them before it that are on the same spot."
  (+ (robot-radius)
     (* +between-rings+ (count-on-spot image (ldiff robots (member image robots))))))

(defun count-on-spot (image robots)
  (count-if (lambda (other) (one-spot-p image other)) robots))

(defun spot-radius (image robots)
  "Return the radius of the widest ring of ROBOTS on the spot of IMAGE, in pixels."
  (+ (robot-radius) (* +between-rings+ (1- (count-on-spot image robots)))))

(defun draw-arrowhead (canvas x y radius angle fill-p)
  (let ((tip (around x y angle radius)))
    (draw-lines canvas draw-gcontext*
                (append tip
                        (around x y (+ angle 2.5d0) radius)
                        (around x y angle (* -0.25d0 radius))
                        (around x y (- angle 2.5d0) radius)
                        (and (not fill-p) tip))
                :fill-p fill-p)))

(defun hollow-head-p (position)
  "True if the arrowhead of the robot at POSITION among its world's is drawn hollow."
  (and (not in-color*) (oddp (floor position (length +turn-dashes+)))))

(defun camera-line (x y radius angle)
  "Return the ends of the line, x y x y in pixels, of a camera that looks in direction ANGLE."
  (append (around x y angle (+ radius 1)) (around x y angle (* 8/5 radius))))

(defun camera-lines (image radius)
  "Return the lines of those cameras that the robot of IMAGE, a ring of RADIUS, has with it."
  (loop for camera in (robot-image-cameras image)
        unless (camera-image-location camera)
          collect (camera-line (to-pixels (robot-image-x image)) (to-pixels (robot-image-y image))
                               radius (+ (robot-image-angle image) (camera-image-angle camera)))))

(defun draw-ring (canvas x y radius angle position)
  "Draw the ring and the arrowhead of the robot at POSITION among its world's, which looks in
direction ANGLE."
  (let ((color (turn-ink position)))
    (inked (color :width 2 :dashes (turn-dashes position)) (draw-circle canvas x y radius nil))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-arrowhead canvas x y (- radius 1) angle t))
    (with-color color
      (draw-arrowhead canvas x y (- radius 5/2) angle (not (hollow-head-p position))))))

(defun draw-robot (canvas image radius)
  (with-subject (canvas image)
    (draw-ring canvas (to-pixels (robot-image-x image)) (to-pixels (robot-image-y image))
               radius (robot-image-angle image) (robot-image-position image))
    (dolist (line (camera-lines image radius))
      (inked ((layer-ink :tracks) :width 2) (draw-segments canvas draw-gcontext* line)))))

(defun draw-robots (canvas robots)
  "Draw ROBOTS, the images of all there are; wide rings first, so that they hide none."
  (loop for (image radius)
          in (stable-sort (loop for image in robots
                                collect (list image (ring-radius image robots)))
                          #'> :key #'second)
        do (draw-robot canvas image radius)))
