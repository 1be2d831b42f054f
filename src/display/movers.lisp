;;;; movers.lisp -- robots and things on the map.

(in-package :ars-magna.display)

(export '(draw-ring robot-radius thing-half-width))

;;; Things.

;;; In colour a thing is a shape around its place, which says what the thing does. The larger its
;;; :size, the larger the shape. A black outline and a white halo make any colour visible.

(defconstant +greatest-thing-width+ 3/2 "The greatest width of a thing on the map, in cells.")
(defconstant +size-of-widest-things+ 64
  "The least :size of things that are drawn as wide as +GREATEST-THING-WIDTH+.")
(defconstant +least-thing-width+ 5 "The width of a thing of size 0 on the map, in pixels.")

;; As reading 241 says.
(defun thing-half-width (image)
  "Return half the width of the thing of IMAGE on the map, in pixels. The drawn area grows with the
size of the thing. Without colours all things have the same width."
  (if in-color*
      (let ((largest (max (1+ +least-thing-width+) (* graphics-scale* +greatest-thing-width+)))
            (part (/ (clamp (thing-image-size image) 0 +size-of-widest-things+)
                     +size-of-widest-things+)))
        (* 1/2 (+ +least-thing-width+ (* (- largest +least-thing-width+) (sqrt part)))))
      (* 3/8 graphics-scale*)))

;;; Shapes. Things that move by themselves have a point.

(defun thing-shape (image)
  "Return the shape of the thing of IMAGE. It is :SQUARE if the thing blocks the way, else :ROUND.
For a thing that moves by itself, it is :HOUSE or :DIAMOND."
  (if (thing-image-moving-p image)
      (if (thing-image-obsmove-p image) :house :diamond)
      (if (thing-image-obsmove-p image) :square :round)))

(defun draw-shape (canvas shape x y half)
  "Draw SHAPE, filled, around X, Y. The shape reaches HALF pixels from its middle."
  (flet ((polygon (&rest points)
           (draw-lines canvas draw-gcontext* points :fill-p t)))
    (let ((left (- x half)) (top (- y half)) (right (+ x half)) (bottom (+ y half)))
      (ecase shape
        (:square (draw-rectangle canvas draw-gcontext* left top (* 2 half) (* 2 half) t))
        (:round (draw-circle canvas x y half t))
        (:diamond (polygon x top right y x bottom left y))
        (:house (polygon x (- top (/ half 2)) right (- y (/ half 3)) right bottom
                         left bottom left (- y (/ half 3))))))))

(defun draw-thing-body (canvas image x y half)
  "Draw the shape of the thing of IMAGE with a halo and an outline."
  (let ((shape (thing-shape image)) (more (if (thing-image-moving-p image) 3/2 1)))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-shape canvas shape x y (+ half more)))
    (with-color black* (draw-shape canvas shape x y half))
    (with-color (thing-image-color image)
      (draw-shape canvas shape x y (max 1 (- half more))))))

(defun draw-container-rim (canvas image x y half)
  "Draw the rim of the container of IMAGE, or a dot if there is no room for a rim."
  (let ((inner (- half 3)))
    (cond ((< inner 3/2) (draw-circle canvas x y 1 t))
          ((eq :square (thing-shape image))
           (draw-rectangle canvas draw-gcontext* (- x inner 1/2) (- y inner 1/2)
                           (* 2 inner) (* 2 inner)))
          (t (draw-circle canvas x y (if (thing-image-moving-p image) (/ inner 2) inner) nil)))))

(defun draw-cross (canvas x y reach)
  (draw-segments canvas draw-gcontext*
                 (loop for (dx dy) in (list (list reach reach) (list reach (- reach)))
                       append (list (- x dx 1/2) (- y dy 1/2) (+ x dx -1/2) (+ y dy -1/2)))))

(defun draw-thing-sample (canvas image x y half)
  "Draw the thing of IMAGE in colour around X, Y. The drawing reaches HALF pixels to each side."
  (draw-thing-body canvas image x y half)
  (with-color (black-or-white-on (thing-image-color image))
    (when (thing-image-container-p image) (draw-container-rim canvas image x y half))
    (when (thing-image-obsview-p image)
      (draw-cross canvas x y (* half (if (eq :square (thing-shape image)) 3/4 1/2))))))

(defun draw-thing-as-line (canvas x y)
  "Draw a thing as a small vertical line, like the manual's figure. A halo shows the line on walls."
  (let ((width (max 2 (round graphics-scale* 4)))
        (height (max 5 (round (* 3/4 graphics-scale*)))))
    (flet ((upright (more)
             (draw-rectangle canvas draw-gcontext* (- x (/ width 2) more) (- y (/ height 2) more)
                             (+ width (* 2 more)) (+ height (* 2 more)) t)))
      (with-gcontext (draw-gcontext* :foreground white*) (upright 3/2))
      (upright 0))))

(defun draw-things (canvas images)
  "Draw the things of IMAGES, the large things first, so that they hide no small things."
  (dolist (image (stable-sort (coerce images 'list) #'> :key #'thing-image-size))
    (let ((x (to-pixels (thing-image-x image))) (y (to-pixels (thing-image-y image))))
      (with-subject (canvas image)
        (if in-color*
            (draw-thing-sample canvas image x y (thing-half-width image))
            (draw-thing-as-line canvas x y))))))

(defun moving-thing-images (snapshot)
  (coerce (remove-if-not #'thing-image-moving-p (snapshot-things snapshot)) 'list))

(defun draw-reach-marks (canvas images)
  (loop for image in images
        do (with-halo ((layer-ink :reach) :dashes (layer-dashes :reach))
             (draw-circle canvas (to-pixels (thing-image-x image))
                          (to-pixels (thing-image-y image))
                          (+ (thing-half-width image) (/ graphics-scale* 2) 2) nil))))

;;; Robots.

;;; Robots are drawn hollow, below things, to show what they are about to grasp. Several robots
;;; have colours and dashes by position. Without colours, the heads of every second five are hollow.

(defun robot-radius ()
  "Return the radius of the ring of a robot, in pixels. It is nearly a cell, but half a cell where
cells are large, so that the ring fits into a map of one cell."
  (max 6 (min (* 7/8 graphics-scale*) (+ 10 (* 1/4 graphics-scale*)))))

(defconstant +ring-distance+ 4 "The distance between rings of robots at one place, in pixels.")

(defun rings-coincide-p (image other)
  "True if the robots of IMAGE and OTHER are so close that their rings would look like one ring."
  (> (robot-radius)
     (* 2 (to-pixels (max (abs (- (robot-image-x image) (robot-image-x other)))
                          (abs (- (robot-image-y image) (robot-image-y other))))))))

(defun ring-radius (image robots)
  "Return the radius of the ring of IMAGE, one of ROBOTS, in pixels. The ring is around the rings of
earlier ROBOTS at the same place."
  (+ (robot-radius)
     (* +ring-distance+ (count-coinciding-rings image (ldiff robots (member image robots))))))

(defun count-coinciding-rings (image robots)
  (count-if (lambda (other) (rings-coincide-p image other)) robots))

(defun widest-ring-radius (image robots)
  "Return the radius in pixels of the widest of ROBOTS' rings around the robot of IMAGE."
  (+ (robot-radius) (* +ring-distance+ (1- (count-coinciding-rings image robots)))))

(defun draw-arrowhead (canvas x y radius angle fill-p)
  (let ((tip (point-at-distance x y angle radius)))
    (draw-lines canvas draw-gcontext*
                (append tip
                        (point-at-distance x y (+ angle 2.5d0) radius)
                        (point-at-distance x y angle (* -0.25d0 radius))
                        (point-at-distance x y (- angle 2.5d0) radius)
                        (and (not fill-p) tip))
                :fill-p fill-p)))

(defun hollow-arrowhead-p (position)
  "True if the robot at POSITION in its world's list of robots has a hollow arrowhead."
  (and (not in-color*) (oddp (floor position (length +line-dashes+)))))

(defun camera-lines (image radius)
  "Return lines, lists x y x y in pixels, for the cameras that are on the robot of IMAGE. The robot
is drawn as a ring of RADIUS."
  (loop with x = (to-pixels (robot-image-x image)) and y = (to-pixels (robot-image-y image))
        for camera in (robot-image-cameras image)
        for angle = (+ (robot-image-angle image) (camera-image-angle camera))
        unless (camera-image-location camera)
          collect (append (point-at-distance x y angle (+ radius 1))
                          (point-at-distance x y angle (* 8/5 radius)))))

(defun draw-ring (canvas x y radius angle position)
  "Draw the ring of a robot, with an arrowhead in direction ANGLE. POSITION is the position of the
robot in the list of robots of its world."
  (let ((color (nth-ink position)))
    (with-halo (color :width 2 :dashes (nth-dashes position)) (draw-circle canvas x y radius nil))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-arrowhead canvas x y (- radius 1) angle t))
    (with-color color
      (draw-arrowhead canvas x y (- radius 5/2) angle (not (hollow-arrowhead-p position))))))

;;; The robot that a window commands stands out as a disc.

(defconstant +least-disc-radius+ 10 "The least radius of the disc of a robot, in pixels.")

(defun disc-radius (image robots)
  "Return the radius in pixels of the disc that shows the robot of IMAGE, one of ROBOTS. If other
robots are at the same place, the disc is as large as the ring would be, to tell them apart."
  (let ((radius (ring-radius image robots)))
    (if (= 1 (count-coinciding-rings image robots))
        (max +least-disc-radius+ (* 5/4 radius))
        radius)))

(defun drawn-radius (image robots shown)
  "Return the radius in pixels of the robot of IMAGE, one of ROBOTS. It is drawn as a disc if its
name is SHOWN, else as a ring."
  (if (and shown (eq shown (robot-image-name image)))
      (disc-radius image robots)
      (ring-radius image robots)))

(defun draw-disc-body (canvas x y radius angle)
  "Draw a disc with a nose in direction ANGLE, which shows the heading if a thing covers the disc."
  (draw-circle canvas x y radius t)
  (draw-lines canvas draw-gcontext*
              (append (point-at-distance x y angle (* 1.5d0 radius))
                      (point-at-distance x y (+ angle 0.7d0) radius)
                      (point-at-distance x y (- angle 0.7d0) radius))
              :fill-p t))

(defun draw-disc (canvas x y radius angle position)
  "Draw a robot like DRAW-RING, but as a disc in its colour with a white arrowhead."
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-disc-body canvas x y (+ radius 2) angle))
  (with-color (nth-ink position) (draw-disc-body canvas x y radius angle))
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-arrowhead canvas x y (- radius 2) angle t)))

(defun draw-robot (canvas image radius &optional (draw 'draw-ring))
  "Draw the robot of IMAGE and its cameras. DRAW, a function with the arguments of DRAW-RING, draws
the robot."
  (with-subject (canvas image)
    (funcall draw canvas (to-pixels (robot-image-x image)) (to-pixels (robot-image-y image))
             radius (robot-image-angle image) (robot-image-position image))
    (dolist (line (camera-lines image radius))
      (with-halo ((layer-ink :tracks) :width 2) (draw-segments canvas draw-gcontext* line)))))

(defun draw-robots (canvas robots &optional shown)
  "Draw ROBOTS, the images of all robots. Wide rings come first, so that they hide no other rings.
The robot called SHOWN is drawn as a disc, below rings at the same place."
  (let ((disc (and shown (find shown robots :key #'robot-image-name))))
    (when disc (draw-robot canvas disc (disc-radius disc robots) 'draw-disc))
    (loop for (image radius)
            in (stable-sort (loop for image in robots
                                  collect (list image (ring-radius image robots)))
                            #'> :key #'second)
          unless (eq image disc) do (draw-robot canvas image radius))))
