;;;; displays.lisp -- the six displays: the world, the robot's state and its parts (manual B).

(in-package :ars-magna.display)

(export '(draw-display display-title +displays+))

;;; The function of a display (manual B) gets the robot's image and the width. It draws from 0,0 and
;;; returns its height. (In the loops, Y steps before the parts run out, so it ends below the last.)

(defconstant +margin+ 6 "The margin of a display, in pixels.")
(defconstant +thing-width-limit+ 90 "The greatest width of a thing in a display, in pixels.")
(defconstant +thing-height+ 12 "The height of things in a display, in pixels.")
(defconstant +greatest-size-unit+ 8
  "The greatest width of a thing in a display, in pixels per unit of its size.")

(defun character-count-in-width (width)
  "Return the number of characters that fit into WIDTH pixels, but at least 1."
  (max 1 (floor width +character-width+)))

(defun draw-line-of-text (canvas x y width text)
  "Write TEXT on one line with its top at Y, cut to end before WIDTH."
  (let ((count (character-count-in-width (- width x +margin+))))
    (draw-text canvas x (+ y 12)
               (if (<= (length text) count)
                   text
                   (concatenate 'string (subseq text 0 (1- count)) "~")))))

(defun draw-paragraph (canvas x y width text)
  "Write TEXT from Y down, wrapped to end before WIDTH. Return the y coordinate of its end."
  (dolist (line (wrapped-text text (character-count-in-width (- width x +margin+))) y)
    (draw-line-of-text canvas x y width line)
    (incf y +line-height+)))

;;; Things.

(defun displayed-thing-images (robot)
  (remove-if-not #'thing-image-p
                 (append (mapcar #'designator-image-denotation (robot-image-designators robot))
                         (loop for camera in (robot-image-cameras robot)
                               for track = (camera-image-track camera)
                               collect (camera-image-location camera)
                               when track collect (designator-image-denotation track))
                         (loop for hand in (robot-image-hands robot)
                               collect (hand-image-contents hand)
                               collect (hand-image-location hand))
                         (mapcan (lambda (bin) (copy-list (bin-image-contents bin)))
                                 (robot-image-bins robot)))))

(defvar *size-unit* +greatest-size-unit+
  "The width in pixels of a thing of size 1. It is the same for all things in the displays of a
robot, so that their widths are in proportion.")

(defun size-unit (robot)
  "Return the width in pixels of a thing of size 1, chosen so that the largest thing fits."
  (let ((largest (reduce #'max (mapcar #'thing-image-size (displayed-thing-images robot))
                         :initial-value 0)))
    (if (< (* largest +greatest-size-unit+) +thing-width-limit+)
        +greatest-size-unit+
        (/ +thing-width-limit+ largest))))

(defun thing-width (image)
  "Return the width of the thing of IMAGE in a display, in pixels. The width is in proportion to the
size of the thing, but at least 2."
  (max 2 (* *size-unit* (thing-image-size image))))

(defun draw-hollow (canvas x y width)
  "Draw a frame in the current colour. Its black outline makes light colours visible on white."
  (let ((height (1- +thing-height+)) (pen (if (< width 7) 1 2)))
    (with-color black* (draw-rectangle canvas draw-gcontext* x y (max 0 (1- width)) height))
    (when (and in-color* (<= 4 width))
      (with-lines (:width pen)
        (draw-rectangle canvas draw-gcontext* (+ x 1/2 (/ pen 2)) (+ y 1/2 (/ pen 2))
                        (- width 2 pen) (- height 1 pen))))))

(defun draw-solid (canvas x y width)
  (draw-rectangle canvas draw-gcontext* x y width +thing-height+ t)
  (with-color black*
    (draw-rectangle canvas draw-gcontext* x y (max 0 (1- width)) (1- +thing-height+))))

(defun draw-thing-rectangle (canvas image x y)
  "Draw the thing of IMAGE as a rectangle, which is filled if the thing blocks movement and crossed
out if the thing obstructs view."
  (let* ((width (thing-width image)) (right (+ x (max 0 (1- width))))
         (bottom (+ y +thing-height+ -1)) (solid-p (thing-image-obsmove-p image)))
    (with-color (thing-image-color image)
      (if solid-p (draw-solid canvas x y width) (draw-hollow canvas x y width)))
    (when (thing-image-obsview-p image)
      (with-gcontext (draw-gcontext* :foreground (if solid-p
                                                     (black-or-white-on
                                                      (if in-color*
                                                          (thing-image-color image)
                                                          black*))
                                                     black*))
        (draw-segments canvas draw-gcontext* (list x y right bottom x bottom right y))))))

(defun report-undrawable (image value trouble)
  "Report once that VALUE, the :draw-function of IMAGE, cannot be used because of TROUBLE, a text."
  (unless (gethash value *broken-graphics*)
    (setf (gethash value *broken-graphics*) t)
    (error-set (subject-title image) " is drawn plainly: " trouble)))

(defun draw-by-draw-function (canvas image x y)
  "Draw the thing of IMAGE by its :draw-function (reading 211). Return true if that function works."
  (let ((value (thing-image-draw-function image)))
    (multiple-value-bind (function trouble) (resolve-draw-function value)
      (when trouble (report-undrawable image value trouble))
      (and function
           (or (draw-by-user-code canvas function
                                  (list "the :draw-function of " (subject-title image))
                                  x y +thing-width-limit+ +thing-height+
                                  (thing-image-thing image) x y +thing-width-limit+ +thing-height+)
               (fill-with-white canvas x y +thing-width-limit+ +thing-height+))))))

(defun draw-thing-with-title (canvas image x y width)
  (with-subject (canvas image)
    (let ((wide (cond ((draw-by-draw-function canvas image x y) +thing-width-limit+)
                      (t (draw-thing-rectangle canvas image x y)
                         (thing-width image)))))
      (draw-line-of-text canvas (+ x wide +margin+) (- y 2) width (subject-title image)))))

(defun draw-container (canvas location x y width)
  "Draw LOCATION, the container that a hand or camera is in: the image of a thing, a text, or NIL."
  (cond ((null location))
        ((stringp location) (draw-line-of-text canvas x y width (format nil "in ~A" location)))
        (t (draw-line-of-text canvas x y width "in ")
           (draw-thing-with-title canvas location (+ x 21) (+ y 2) width))))

;;; Robot state.

(defun draw-state (canvas robot width)
  (let ((lines (list (format nil "Position: ~,2F, ~,2F"
                             (robot-image-x robot) (robot-image-y robot))
                     (format nil "Direction: ~A" (angle-text (robot-image-angle robot)))
                     (format nil "Speed: ~,2F" (robot-image-speed robot))
                     (format nil "Place: ~:[none~;~:*~(~A~)~]" (robot-image-place robot))
                     (format nil "Under way: ~:[nothing~;~:*~A~]" (robot-image-under-way robot))
                     (format nil "Interrupted: ~:[nothing~;~:*~A~]"
                             (robot-image-interruption robot))))
        (y +margin+))
    (dolist (line lines y)
      (setf y (draw-paragraph canvas +margin+ y width line)))))

;;; Robot designators.

(defun draw-denotation (canvas designator x y width)
  (let ((denotation (designator-image-denotation designator)))
    (if (thing-image-p denotation)
        (draw-thing-with-title canvas denotation x (+ y 2) width)
        (draw-line-of-text canvas x y width (denoted-object-text designator)))))

(defun draw-designators (canvas robot width)
  (loop for y from +margin+ by +line-height+
        for designator in (robot-image-designators robot)
        do (with-subject (canvas designator)
             (draw-line-of-text canvas +margin+ y width
                                (format nil "~3D" (designator-image-number designator)))
             (draw-denotation canvas designator (+ +margin+ 28) y width))
        finally (return y)))

;;; Cameras.

(defconstant +camera-symbol-radius+ 30 "The radius of the picture of a camera, in pixels.")

(defun draw-tracking-line (canvas x y angle)
  (with-color (layer-ink :tracks)
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext*
                     (append (point-at-distance x y angle (* 1/2 +camera-symbol-radius+))
                             (point-at-distance x y angle +camera-symbol-radius+))))))

(defun draw-camera-symbol (canvas robot camera y)
  "Draw the field of view of CAMERA as a wedge, in its direction on the map. A short line shows the
believed direction of the thing that CAMERA tracks."
  (let* ((x (+ +margin+ +camera-symbol-radius+)) (y (+ y +camera-symbol-radius+))
         (half (* 1/2 (camera-image-field-of-view camera)))
         (angle (+ (robot-image-angle robot) (camera-image-angle camera)))
         (track (camera-image-track camera)))
    (with-color (svref lightblue* 9)
      (draw-arc canvas draw-gcontext* (- x +camera-symbol-radius+) (- y +camera-symbol-radius+)
                (* 2 +camera-symbol-radius+) (* 2 +camera-symbol-radius+)
                (- (+ angle half)) (* 2 half) in-color*))
    (draw-lines canvas draw-gcontext*
                (append (point-at-distance x y (- angle half) +camera-symbol-radius+) (list x y)
                        (point-at-distance x y (+ angle half) +camera-symbol-radius+)))
    (when track
      (draw-tracking-line canvas x y
                          (+ (robot-image-angle robot) (designator-image-angle track))))))

(defun view-text (camera)
  "Return a text with the last view that was requested of CAMERA, and its age. Unlike STATUS, a
display takes no new view, so that it shows only what the robot knows."
  (if (camera-image-view camera)
      (format nil "Camera ~D, view ~[now~:;~:*~D tick~:P ago~]: ~{~,1F~^ ~}"
              (camera-image-index camera) (camera-image-view-age camera) (camera-image-view camera))
      (format nil "Camera ~D: no view yet" (camera-image-index camera))))

(defun draw-tracked-object (canvas track x y width)
  "Write the type and distance of TRACK, a tracked designator's image. Draw what it denotes."
  (let ((text (format nil "~(~A~) ~,1F " (designator-image-type track)
                      (designator-image-distance track))))
    (draw-line-of-text canvas x y width text)
    (draw-denotation canvas track (+ x (monospaced-width text)) y width)))

(defun draw-camera (canvas robot camera y width)
  "Draw CAMERA from Y down. Return the y coordinate of the end of the drawing."
  (let ((left (+ (* 2 +margin+) (* 2 +camera-symbol-radius+))) (track (camera-image-track camera))
        (next y))
    (with-subject (canvas camera)
      (draw-camera-symbol canvas robot camera y)
      (setf next (draw-paragraph canvas left (+ y 6) width (view-text camera)))
      (when track (draw-tracked-object canvas track left next width))
      (draw-container canvas (camera-image-location camera)
                      left (+ next +line-height+) width))
    (+ +margin+ (max (+ y (* 2 +camera-symbol-radius+)) (+ next (* 2 +line-height+))))))

;;; Hands.

(defun draw-hand (canvas robot hand y width)
  "Draw HAND from Y down. Return the y coordinate of the end of the drawing."
  (declare (ignore robot))
  (let ((left (+ +margin+ (* 10 +character-width+)))
        (contents (hand-image-contents hand)))
    (with-subject (canvas hand)
      (draw-line-of-text canvas +margin+ y width (subject-title hand))
      (if contents
          (draw-thing-with-title canvas contents left (+ y 2) width)
          (draw-line-of-text canvas left y width "empty"))
      (draw-container canvas (hand-image-location hand) left (+ y +line-height+) width)))
  (+ y (* +line-height+ (if (hand-image-location hand) 2 1))))

;;; Storage bins.

(defun draw-bin (canvas robot bin y width)
  "Draw BIN from Y down. Return the y coordinate of the end of the drawing."
  (declare (ignore robot))
  (with-subject (canvas bin)
    (draw-line-of-text canvas +margin+ y width
                       (format nil "~A: ~:[open~;closed~]" (subject-title bin)
                               (bin-image-closed-p bin)))
    (loop for top from (+ y +line-height+) by +line-height+
          for thing in (bin-image-contents bin)
          do (draw-thing-with-title canvas thing (+ (* 4 +margin+)) (+ top 2) width)
          finally (return top))))

;;;; The displays by name, and all in one picture

(define-constant +details+
    '((:state "Robot state" draw-state) (:designators "Robot designators" draw-designators)
      (:cameras "Cameras" draw-camera robot-image-cameras)
      (:hands "Hands" draw-hand robot-image-hands) (:bins "Storage bins" draw-bin robot-image-bins))
  :test #'cl:equal
  :documentation "The displays except the world: lists (name title function [parts]). FUNCTION draws
the display or, if PARTS is given, one of the parts of the robot that PARTS returns.")

;; As reading 27 says.
(define-constant +displays+ (cons :world (mapcar #'first +details+))
  :test #'cl:equal
  :documentation "The names of the displays: bird's eye view, robot state, robot designators,
cameras, hands and storage bins.")

(defconstant +robot-display-width+ 340
  "The width of each display except the display of the world, in pixels.")

(defun display-title (display)
  "Return the title of the window of DISPLAY, one of +DISPLAYS+ (manual B)."
  (if (eq :world display) "World" (second (assoc display +details+))))

(defun draw-robot-display (canvas display robot width)
  "DISPLAY is not the world. Draw it for ROBOT, WIDTH pixels wide. Return its height in pixels."
  (destructuring-bind (draw &optional parts) (cddr (assoc display +details+))
    (let ((*size-unit* (size-unit robot)))
      (if parts
          (reduce (lambda (y part) (funcall draw canvas robot part y width))
                  (funcall parts robot) :initial-value +margin+)
          (funcall draw canvas robot width)))))

(defun draw-titled-display (canvas display robot x y)
  "Draw DISPLAY of ROBOT with title and frame, from X, Y down. Return its height in pixels."
  (let ((height 0) (top (+ +line-height+ 2)))
    (with-origin (canvas x (+ y top))
      (setf height (draw-robot-display canvas display robot +robot-display-width+)))
    (with-origin (canvas x y)
      (with-color (svref grey* 56)
        (draw-rectangle canvas draw-gcontext* 0 0 +robot-display-width+ top in-color*))
      (draw-text canvas +margin+ 13 (display-title display))
      (with-color (svref grey* 40)
        (draw-rectangle canvas draw-gcontext* 0 0 +robot-display-width+ (+ top height))))
    (+ top height 1)))

(defun draw-all-displays (canvas snapshot robot layers title subtitle)
  "Draw the world and, beside it, the other five displays. Return the width and height in pixels."
  (multiple-value-bind (width height) (draw-framed-world canvas snapshot layers
                                                      :title title :subtitle subtitle)
    (let ((left (+ width +margin+)) (bottom 0))
      (dolist (display (rest +displays+))
        (incf bottom (+ (draw-titled-display canvas display robot left bottom) +margin+)))
      (values (+ left +robot-display-width+ 1) (max height bottom)))))

(defun draw-display (canvas display snapshot robot &key (layers *picture-layers*)
                                                     (width +robot-display-width+) title subtitle)
  "Draw DISPLAY, one of +DISPLAYS+ or :ALL, on CANVAS. ROBOT is the image of a robot in SNAPSHOT.
Return the width and height in pixels. WIDTH is the width of the displays except the world. LAYERS,
TITLE and SUBTITLE are for the world: see DRAW-FRAMED. Call this within WITH-CANVAS."
  (case display
    (:all (draw-all-displays canvas snapshot robot layers title subtitle))
    (:world (draw-framed-world canvas snapshot layers :title title :subtitle subtitle))
    (t (values width (draw-robot-display canvas display robot width)))))

(defun check-display (operator display)
  (unless (member display (cons :all +displays+))
    (reject-argument operator "display" display
                     (format nil "one of ~{~(~S~)~^, ~}" (append +displays+ '(:all))))))
