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
          (drawing-code (thing-image-draw-function image))))
  (:method ((image designator-image))
    (list (designator-image-number image) (designator-image-type image)
          (designator-image-angle image) (designator-image-distance image)
          (designator-image-x image) (designator-image-y image)
          (content (designator-image-denotation image))))
  (:method ((image camera-image))
    (list (camera-image-angle image) (camera-image-look image) (camera-image-view image)
          (content (camera-image-track image)) (content (camera-image-location image))))
  (:method ((image hand-image))
    (list (content (hand-image-contents image)) (content (hand-image-location image))))
  (:method ((image bin-image))
    (list (bin-image-closed-p image) (content (bin-image-contents image))))
  (:method ((image odometer-image))
    (list (odometer-image-x image) (odometer-image-y image) (odometer-image-heading image)
          (odometer-image-width image) (odometer-image-height image)
          (odometer-image-axis image) (odometer-image-spread image)))
  (:method ((image robot-image))
    (list (robot-image-x image) (robot-image-y image) (robot-image-angle image)
          (content (robot-image-cameras image)) (content (robot-image-odometer image))
          (content (robot-image-designators image)) (robot-image-trail image)
          (robot-image-planned-way image) (content (robot-image-notes image)))))

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
