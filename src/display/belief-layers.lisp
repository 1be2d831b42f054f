;;;; belief-layers.lisp -- layers of what robots believe.

(in-package :ars-magna.display)

(defun believed-place (robot designator)
  "Return, in pixels, where ROBOT believes DESIGNATOR to be: it knows that from where it is."
  (around (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
          (+ (robot-image-angle robot) (designator-image-angle designator))
          (to-pixels (designator-image-distance designator))))

(defun track-radius () (max 4 (* 1/2 graphics-scale*)))

(defun draw-track (canvas designator robot snapshot)
  "Draw a line to where ROBOT believes DESIGNATOR, which a camera tracks, to be."
  (declare (ignore snapshot))
  (let ((target (believed-place robot designator)))
    (inked ((layer-ink :tracks) :dashes (layer-dashes :tracks))
      (draw-segments canvas draw-gcontext*
                     (list* (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                            target)))
    (inked ((layer-ink :tracks))
      (draw-circle canvas (first target) (second target) (track-radius) nil))))

(defun track-boxes (designator robot snapshot)
  "Return the box of the ring around where ROBOT believes DESIGNATOR to be, in pixels, as a list."
  (declare (ignore snapshot))
  (destructuring-bind (x y) (believed-place robot designator)
    (list (box-around x y (+ 2 (track-radius))))))

(defun robots-that-designate (snapshot)
  (remove-if-not #'robot-image-designators (snapshot-robots snapshot)))

(defun designator-box (robot designator)
  "Return the box (left top right bottom) of the cross and the number of DESIGNATOR, in pixels."
  (destructuring-bind (x y) (believed-place robot designator)
    (let ((text (princ-to-string (designator-image-number designator))))
      (list (- x 5) (- y 13) (+ x 9 (words-width text)) (+ y 5)))))

(defun draw-designator-on-map (canvas robot designator)
  "Draw a cross with the number of DESIGNATOR where ROBOT believes it to be, and a line from there
to what it denotes."
  (destructuring-bind (x y) (believed-place robot designator)
    (let ((true-x (designator-image-x designator)) (true-y (designator-image-y designator))
          (color (layer-ink :designators)))
      (with-subject (canvas designator)
        (when true-x
          (inked (color :dashes (layer-dashes :designators))
            (draw-segments canvas draw-gcontext*
                           (list x y (to-pixels true-x) (to-pixels true-y)))))
        (inked (color :width 2) (draw-cross canvas x y 4))
        (with-color color
          (draw-text-on-plate canvas (+ x 7) (- y 3)
                              (princ-to-string (designator-image-number designator))))))))

(defun designator-boxes (robots)
  "Return the boxes of the crosses and numbers of all designators of ROBOTS."
  (loop for robot in robots
        append (loop for designator in (robot-image-designators robot)
                     collect (designator-box robot designator))))

(defun draw-designators-on-map (canvas robots)
  (dolist (robot robots)
    (dolist (designator (robot-image-designators robot))
      (draw-designator-on-map canvas robot designator))))

(defun odometer-box (odometer)
  "Return the corners of the box that contains the position of ODOMETER, x y ..., in metres."
  (let ((cos (cosine (odometer-image-axis odometer))) (sin (sine (odometer-image-axis odometer))))
    (loop for (across down) in '((-1 -1) (1 -1) (1 1) (-1 1) (-1 -1))
          for dx = (* across 1/2 (odometer-image-width odometer))
          for dy = (* down 1/2 (odometer-image-height odometer))
          collect (+ (odometer-image-x odometer) (- (* cos dx) (* sin dy)))
          collect (+ (odometer-image-y odometer) (* sin dx) (* cos dy)))))

(defun draw-odometer (canvas odometer robot snapshot)
  "Draw where ODOMETER puts its robot: the box that contains its position, and from the middle of
that the bounds of its heading."
  (declare (ignore robot snapshot))
  (let* ((x (odometer-image-x odometer)) (y (odometer-image-y odometer))
         (heading (odometer-image-heading odometer))
         (half (* 1/2 (odometer-image-spread odometer))))
    (inked ((layer-ink :odometer) :dashes (layer-dashes :odometer))
      (draw-lines canvas draw-gcontext* (pixels-of (odometer-box odometer)))
      (dolist (angle (list (- heading half) (+ heading half)))
        (draw-segments canvas draw-gcontext* (pixels-of (list* x y (around x y angle 3))))))))
