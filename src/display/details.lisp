;;;; details.lisp -- the displays of the robot's state, designators, cameras, hands and bins.

(in-package :ars-magna.display)

;;; Each function of a display draws from 0, 0 and is given the image of the robot and how wide to
;;; draw; it returns how many pixels down it has drawn. (In these loops Y steps before the parts run
;;; out, so that it ends below the last.) Manual B.

(define-constant +margin+ 6 :documentation "How far from the edge drawing begins, in pixels.")
(define-constant +object-width+ 90 :documentation "How wide things are drawn at most, in pixels.")
(define-constant +object-height+ 12 :documentation "How high things are drawn, in pixels.")
(define-constant +size-unit+ 8
  :documentation "How many pixels wide a thing is drawn for each unit of its size.")

(defun fit-text (text width)
  "Return as much of TEXT as fits into WIDTH pixels."
  (let ((count (max 1 (floor width +character-width+))))
    (if (<= (length text) count)
        text
        (concatenate 'string (subseq text 0 (1- count)) "~"))))

(defun draw-line-of-text (canvas x y width text)
  "Write TEXT in the line whose top is at Y."
  (draw-text canvas x (+ y 12) (fit-text text (- width x +margin+))))

;;; Things.

(defun thing-width (image)
  "Return how wide to draw the thing, in pixels: in proportion to its size, but not invisible."
  (clamp (round (* +size-unit+ (thing-image-size image))) 4 +object-width+))

(defun draw-block (canvas image x y)
  "Draw a thing as a rectangle: solid if it blocks movement, crossed out if it obstructs view."
  (let* ((width (thing-width image))
         (bottom (+ y +object-height+ -1))
         (solid-p (thing-image-obsmove-p image)))
    (with-color (thing-image-color image)
      (if solid-p
          (draw-rectangle canvas draw-gcontext* x y width +object-height+ t)
          (draw-rectangle canvas draw-gcontext* x y (1- width) (1- +object-height+)))
      (when (thing-image-obsview-p image)
        (with-gcontext (draw-gcontext* :foreground (if solid-p
                                                       white*
                                                       (gcontext-foreground draw-gcontext*)))
          (draw-segments canvas draw-gcontext*
                         (list x y (+ x width -1) bottom x bottom (+ x width -1) y)))))))

(defun draw-object (canvas image x y width)
  "Draw the thing whose image is IMAGE, by its own :draw-function if it has one, and its
name (reading 211)."
  (let ((function (thing-image-draw-function image)))
    (with-subject (canvas image)
      (if (typep function '(or function (and symbol (not null))))
          (draw-by-user canvas function
                        (list "the :draw-function of " (subject-title image))
                        x y +object-width+ +object-height+
                        (thing-image-thing image) x y +object-width+ +object-height+)
          (draw-block canvas image x y))
      (draw-line-of-text canvas (+ x (if function +object-width+ (thing-width image)) +margin+)
                         (- y 2) width (subject-title image)))))

(defun draw-location (canvas location x y width)
  "Draw what a part is inside of: a thing, or the text that LOCATION is."
  (cond ((null location))
        ((stringp location) (draw-line-of-text canvas x y width (format nil "in ~A" location)))
        (t (draw-line-of-text canvas x y width "in ")
           (draw-object canvas location (+ x 21) (+ y 2) width))))

;;; Robot state.

(defun draw-state (canvas robot width)
  (let ((lines (list (format nil "Position: ~,2F, ~,2F"
                             (robot-image-x robot) (robot-image-y robot))
                     (format nil "Direction: ~A" (angle-text (robot-image-angle robot)))
                     (format nil "Speed: ~,2F" (robot-image-speed robot))
                     (format nil "Place: ~:[none~;~:*~(~A~)~]" (robot-image-place robot))
                     (format nil "Under way: ~:[nothing~;~:*~A~]" (robot-image-under-way robot))
                     (format nil "Interrupted: ~:[nothing~;~:*~A~]"
                             (robot-image-interruption robot)))))
    (loop for y from +margin+ by +line-height+
          for line in lines
          do (draw-line-of-text canvas +margin+ y width line)
          finally (return y))))

;;; Robot designators.

(defun draw-denotation (canvas designator x y width)
  (let ((denotation (designator-image-denotation designator)))
    (if (thing-image-p denotation)
        (draw-object canvas denotation x (+ y 2) width)
        (draw-line-of-text canvas x y width (denotation-text designator)))))

(defun draw-designators (canvas robot width)
  (loop for y from +margin+ by +line-height+
        for designator in (robot-image-designators robot)
        do (with-subject (canvas designator)
             (draw-line-of-text canvas +margin+ y width
                                (format nil "~3D" (designator-image-number designator)))
             (draw-denotation canvas designator (+ +margin+ 28) y width))
        finally (return y)))

;;; Cameras.

(define-constant +dial+ 30 :documentation "The radius of the picture of a camera, in pixels.")

(defun draw-tick (canvas x y angle)
  (with-color (svref red* 10)
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext*
                     (append (around x y angle (* 1/2 +dial+)) (around x y angle +dial+))))))

(defun draw-dial (canvas robot camera y)
  "Draw CAMERA as a wedge in the direction in which it looks on the map, as wide as its field of
view, with a tick in the direction in which it believes what it tracks to be."
  (let* ((x (+ +margin+ +dial+)) (y (+ y +dial+))
         (half (* 1/2 (camera-image-field-of-view camera)))
         (angle (+ (robot-image-angle robot) (camera-image-angle camera)))
         (track (camera-image-track camera)))
    (with-color (svref lightblue* 10)
      (draw-arc canvas draw-gcontext* (- x +dial+) (- y +dial+) (* 2 +dial+) (* 2 +dial+)
                (- (+ angle half)) (* 2 half) in-color*))
    (draw-lines canvas draw-gcontext*
                (append (around x y (- angle half) +dial+) (list x y)
                        (around x y (+ angle half) +dial+)))
    (when track
      (draw-tick canvas x y (+ (robot-image-angle robot) (designator-image-angle track))))))

(defun view-text (view)
  (format nil "~{~,1F~^ ~}" (loop for pixel in view repeat 100 collect pixel)))

(defun draw-camera (canvas robot camera y width)
  (let ((left (+ (* 2 +margin+) (* 2 +dial+)))
        (track (camera-image-track camera)))
    (with-subject (canvas camera)
      (draw-dial canvas robot camera y)
      (draw-line-of-text canvas left (+ y 6) width
                         (format nil "View: ~A" (view-text (camera-image-view camera))))
      (when track
        (let ((text (format nil "~(~A~) ~,1F " (designator-image-type track)
                            (designator-image-distance track))))
          (draw-line-of-text canvas left (+ y 6 +line-height+) width text)
          (draw-denotation canvas track (+ left (* +character-width+ (length text)))
                           (+ y 6 +line-height+) width)))
      (draw-location canvas (camera-image-location camera)
                     left (+ y 6 (* 2 +line-height+)) width))))

(defun draw-cameras (canvas robot width)
  (loop with height = (+ (* 2 +dial+) +margin+)
        for y from +margin+ by height
        for camera in (robot-image-cameras robot)
        do (draw-camera canvas robot camera y width)
        finally (return y)))

;;; Hands.

(defun draw-hand (canvas hand y width)
  (let ((left (+ +margin+ (* 10 +character-width+)))
        (contents (hand-image-contents hand)))
    (with-subject (canvas hand)
      (draw-line-of-text canvas +margin+ y width (subject-title hand))
      (if contents
          (draw-object canvas contents left (+ y 2) width)
          (draw-line-of-text canvas left y width "empty"))
      (draw-location canvas (hand-image-location hand) left (+ y +line-height+) width))))

(defun draw-hands (canvas robot width)
  (loop for y from +margin+ by (+ (* 2 +line-height+) +margin+)
        for hand in (robot-image-hands robot)
        do (draw-hand canvas hand y width)
        finally (return y)))

;;; Storage bins.

(defun draw-bin (canvas bin y width)
  "Draw BIN from Y; return where its picture ends."
  (with-subject (canvas bin)
    (draw-line-of-text canvas +margin+ y width
                       (format nil "~A: ~:[open~;closed~]" (subject-title bin)
                               (bin-image-closed-p bin)))
    (loop for top from (+ y +line-height+) by +line-height+
          for thing in (bin-image-contents bin)
          do (draw-object canvas thing (+ (* 4 +margin+)) (+ top 2) width)
          finally (return top))))

(defun draw-bins (canvas robot width)
  (let ((y +margin+))
    (dolist (bin (robot-image-bins robot) y)
      (setf y (+ (draw-bin canvas bin y width) +margin+)))))
