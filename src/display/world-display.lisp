;;;; world-display.lisp -- the bird's eye view of robots and things in their world (manual B).

(in-package :ars-magna.display)

;;; Terrain never changes and may be kept by a canvas; movers are drawn over it. Angles grow
;;; clockwise from the right on the map and on the canvas alike.

(define-constant +picture-layers+ '(:wedges :rays :tracks :odometer :trail)
  :test #'cl:equal
  :documentation "What the world's display can show besides walls, places, things and robots.")

(defvar *picture-layers* '(:tracks)
  "Which of the layers in +PICTURE-LAYERS+ the display of the world shows: :WEDGES, the fields of
view of cameras; :RAYS, what the last views came from; :TRACKS; :ODOMETER, how uncertain the
main odometer is; :TRAIL, where robots have been. Rays and trails need KEEP-HISTORY.")

(define-constant +wedge-length+ 6 :documentation "How far camera wedges are drawn, in metres.")

(defun to-pixels (metres) (* metres graphics-scale*))

(defun pixels-of (points)
  "Return the list of coordinates POINTS, in metres, in pixels."
  (mapcar #'to-pixels points))

(defun draw-text (canvas x y text)
  (draw-glyphs canvas draw-gcontext* x y text))

;;; Things: small vertical lines.

(defun draw-thing-on-map (canvas image)
  (let ((x (to-pixels (thing-image-x image)))
        (y (to-pixels (thing-image-y image)))
        (width (max 1 (round graphics-scale* 4)))
        (height (max 3 (round (* 3/4 graphics-scale*)))))
    (with-subject (canvas image)
      (with-color (thing-image-color image)
        (draw-rectangle canvas draw-gcontext* (- x (/ width 2)) (- y (/ height 2))
                        width height t)))))

;;; Robots: a circle around an arrowhead, with a short line for each camera.

(defun robot-radius ()
  "Return the radius of the circle that a robot is drawn as, in pixels."
  (max 5 (* 3/4 graphics-scale*)))

(defun robot-color (position)
  "Return the colour of the robot at POSITION among its world's."
  (svref (svref (vector blue* green* violet* red*) (mod position 4)) 9))

(defun around (x y angle radius)
  "Return a list of the coordinates RADIUS from X, Y in direction ANGLE."
  (list (+ x (* radius (cos angle))) (+ y (* radius (sin angle)))))

(defun draw-circle (canvas x y radius fill-p)
  (draw-arc canvas draw-gcontext* (- x radius) (- y radius) (* 2 radius) (* 2 radius) 0 2pi fill-p))

(defun draw-arrowhead (canvas x y radius angle)
  (draw-lines canvas draw-gcontext*
              (append (around x y angle radius)
                      (around x y (+ angle 2.5d0) radius)
                      (around x y angle (* -0.25d0 radius))
                      (around x y (- angle 2.5d0) radius))
              :fill-p t))

(defun draw-camera-line (canvas x y radius angle)
  (with-color (svref red* 9)
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext*
                     (append (around x y angle radius) (around x y angle (* 8/5 radius)))))))

(defun draw-robot (canvas image color)
  (let ((x (to-pixels (robot-image-x image)))
        (y (to-pixels (robot-image-y image)))
        (angle (robot-image-angle image))
        (radius (robot-radius)))
    (with-subject (canvas image)
      (dolist (camera (robot-image-cameras image))
        (unless (camera-image-location camera)
          (draw-camera-line canvas x y radius (+ angle (camera-image-angle camera)))))
      (with-gcontext (draw-gcontext* :foreground white*) (draw-circle canvas x y radius t))
      (with-color color
        (draw-circle canvas x y radius nil)
        (draw-arrowhead canvas x y (- radius 2) angle)))))

;;; Layers.

(defun draw-wedge (canvas robot camera)
  "Draw the field of view of CAMERA."
  (let ((x (to-pixels (robot-image-x robot)))
        (y (to-pixels (robot-image-y robot)))
        (radius (to-pixels +wedge-length+))
        (half (* 1/2 (camera-image-field-of-view camera)))
        (angle (+ (robot-image-angle robot) (camera-image-angle camera))))
    (with-color (svref lightred* 8)
      (draw-lines canvas draw-gcontext*
                  (append (around x y (- angle half) radius) (list x y)
                          (around x y (+ angle half) radius)))
      (draw-arc canvas draw-gcontext* (- x radius) (- y radius) (* 2 radius) (* 2 radius)
                (- (+ angle half)) (* 2 half) nil))))

(defun draw-rays (canvas look)
  (with-color (svref lightgreen* 7)
    (draw-segments canvas draw-gcontext*
                   (loop for (x y) on (look-ends look) by #'cddr
                         append (pixels-of (list (look-x look) (look-y look) x y))))))

(defun draw-track (canvas robot designator)
  "Draw a line to where ROBOT believes what a camera tracks to be."
  (let* ((x (to-pixels (robot-image-x robot)))
         (y (to-pixels (robot-image-y robot)))
         (target (around x y (+ (robot-image-angle robot) (designator-image-angle designator))
                         (to-pixels (designator-image-distance designator)))))
    (with-color (svref red* 7)
      (with-lines (:style :dash)
        (draw-segments canvas draw-gcontext* (list* x y target)))
      (draw-circle canvas (first target) (second target) (/ graphics-scale* 2) nil))))

(defun draw-odometer (canvas robot)
  "Draw where the main odometer of ROBOT puts it: the box that contains its position, and from the
middle of that the bounds of its heading."
  (let* ((odometer (robot-image-odometer robot))
         (x (odometer-image-x odometer)) (y (odometer-image-y odometer))
         (heading (odometer-image-heading odometer))
         (half-width (* 1/2 (odometer-image-width odometer)))
         (half-height (* 1/2 (odometer-image-height odometer)))
         (cos (cos (odometer-image-axis odometer)))
         (sin (sin (odometer-image-axis odometer)))
         (spread (* 1/2 (odometer-image-spread odometer))))
    (flet ((corner (across down)
             (let ((dx (* across half-width)) (dy (* down half-height)))
               (list (+ x (- (* cos dx) (* sin dy))) (+ y (* sin dx) (* cos dy))))))
      (with-color (svref lightviolet* 4)
        (draw-lines canvas draw-gcontext*
                    (pixels-of (append (corner -1 -1) (corner 1 -1) (corner 1 1)
                                       (corner -1 1) (corner -1 -1))))
        (dolist (angle (list (- heading spread) (+ heading spread)))
          (draw-segments canvas draw-gcontext*
                         (pixels-of (list* x y (around x y angle 3)))))))))

(defun draw-trail (canvas points color)
  (when (cddr points)
    (with-color color
      (draw-lines canvas draw-gcontext*
                  (loop for (x y) on points by #'cddr
                        repeat +trail-length+
                        collect (to-pixels x) collect (to-pixels y))))))

(defun draw-layers (canvas robot color layers)
  (flet ((shown-p (layer) (member layer layers)))
    (when (shown-p :trail) (draw-trail canvas (robot-image-trail robot) color))
    (dolist (camera (robot-image-cameras robot))
      (when (and (shown-p :rays) (camera-image-look camera))
        (draw-rays canvas (camera-image-look camera)))
      (when (and (shown-p :wedges) (null (camera-image-location camera)))
        (draw-wedge canvas robot camera))
      (when (and (shown-p :tracks) (camera-image-track camera))
        (draw-track canvas robot (camera-image-track camera))))
    (when (and (shown-p :odometer) (robot-image-odometer robot))
      (draw-odometer canvas robot))))

;;; The whole.

(defun draw-movers (canvas snapshot layers)
  "Draw what is not terrain of SNAPSHOT on CANVAS: things, robots, and what LAYERS lists."
  (let ((robots (snapshot-robots snapshot)))
    (loop for robot in robots for position from 0
          do (draw-layers canvas robot (robot-color position) layers))
    (loop for image across (snapshot-things snapshot)
          do (draw-thing-on-map canvas image))
    (loop for robot in robots for position from 0
          do (draw-robot canvas robot (robot-color position)))))

(defun draw-world (canvas snapshot &key (layers *picture-layers*))
  "Draw the world of SNAPSHOT on CANVAS, GRAPHICS-SCALE* pixels to a metre, with LAYERS, a list of
some of +PICTURE-LAYERS+ (manual B)."
  (draw-terrain canvas (snapshot-map snapshot))
  (draw-movers canvas snapshot layers))
