;;;; robots.lisp -- a robot on the map: a ring with an arrowhead, and a line for each camera.

(in-package :ars-magna.display)

;;; It is drawn below things and hollow, so that it hides nothing of what it is about to grasp.

(defun robot-radius ()
  "Return the radius of the ring that a robot is drawn as, in pixels."
  (max 6 (* 7/8 graphics-scale*)))

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

(define-constant +robot-inks+ '(#x10018C #x0A5018 #x5C0086 #x600C0C)
  :test #'cl:equal
  :documentation "The colours of the robots of a world, in turn.")

(defun robot-color (position)
  "Return the colour of the robot at POSITION among its world's."
  (nth (mod position (length +robot-inks+)) +robot-inks+))

(defun draw-arrowhead (canvas x y radius angle)
  (draw-lines canvas draw-gcontext*
              (append (around x y angle radius)
                      (around x y (+ angle 2.5d0) radius)
                      (around x y angle (* -0.25d0 radius))
                      (around x y (- angle 2.5d0) radius))
              :fill-p t))

(defun draw-camera-line (canvas x y radius angle)
  (inked ((layer-ink :tracks) :width 2)
    (draw-segments canvas draw-gcontext*
                   (append (around x y angle radius) (around x y angle (* 8/5 radius))))))

(defun draw-ring (canvas x y radius angle color)
  "Draw the ring and the arrowhead of a robot that looks in direction ANGLE."
  (inked (color :width 2) (draw-circle canvas x y radius nil))
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-arrowhead canvas x y (- radius 1) angle))
  (with-color color (draw-arrowhead canvas x y (- radius 5/2) angle)))

(defun draw-robot (canvas image color radius)
  (let ((x (to-pixels (robot-image-x image)))
        (y (to-pixels (robot-image-y image)))
        (angle (robot-image-angle image)))
    (with-subject (canvas image)
      (dolist (camera (robot-image-cameras image))
        (unless (camera-image-location camera)
          (draw-camera-line canvas x y radius (+ angle (camera-image-angle camera)))))
      (draw-ring canvas x y radius angle color))))

(defun draw-robots (canvas robots)
  "Draw ROBOTS, the images of all there are; wide rings first, so that they hide none."
  (loop for (image color radius)
          in (stable-sort (loop for image in robots for position from 0
                                collect (list image (robot-color position)
                                              (ring-radius image robots)))
                          #'> :key #'third)
        do (draw-robot canvas image color radius)))
