;;;; contents.lisp -- what a display shows, as data: to know whether it must be drawn again.

(in-package :ars-magna.display)

(export '(snapshot-content display-content))

;;; Contents of one display that are EQUAL look the same. Images are made anew for each snapshot, so
;;; they are taken apart; things, maps and vectors of images stand for themselves.

(defgeneric content (object)
  (:documentation "Return what is to be seen of OBJECT, an image or a list of such, for EQUAL.")
  (:method (object) object)
  (:method ((list cons)) (cons (content (car list)) (content (cdr list))))
  (:method ((image thing-image))
    (list (thing-image-thing image) (thing-image-attributes image)
          ;; A name may mean another function now.
          (drawing-code (thing-image-draw-function image)))))

(defmacro define-content (image (&rest slots) &rest parts)
  "Let what is to be seen of IMAGE be what its SLOTS hold, and what is to be seen of its PARTS."
  (flet ((reader (slot) (symbolicate image '- slot)))
    `(defmethod content ((image ,image))
       (list ,@(loop for slot in slots collect `(,(reader slot) image))
             ,@(loop for part in parts collect `(content (,(reader part) image)))))))

(define-content designator-image (number type angle distance x y) denotation)
(define-content camera-image (angle look view) track location)
(define-content hand-image () contents location)
(define-content bin-image (closed-p) contents)
(define-content odometer-image (x y heading width height axis spread))
(define-content robot-image (x y angle trail planned-way) cameras odometer designators notes)

(defun snapshot-content (snapshot)
  "Return an object that is EQUAL to that of another snapshot if their worlds look the same."
  (list (snapshot-map snapshot) (snapshot-things snapshot) (content (snapshot-robots snapshot))))

(defun display-content (display robot)
  "Return an object that is EQUAL to that of another image of a robot if DISPLAY, one of +DISPLAYS+
but the world, shows the same of it and of ROBOT, an image too."
  (ecase display
    (:state (list (robot-image-x robot) (robot-image-y robot) (robot-image-angle robot)
                  (robot-image-speed robot) (robot-image-place robot)
                  (robot-image-under-way robot) (robot-image-interruption robot)))
    (:designators (content (robot-image-designators robot)))
    (:cameras (list (robot-image-angle robot) (content (robot-image-cameras robot))
                    (loop for camera in (robot-image-cameras robot)
                          when (camera-image-view camera) collect (camera-image-view-age camera))))
    (:hands (content (robot-image-hands robot)))
    (:bins (content (robot-image-bins robot)))))
