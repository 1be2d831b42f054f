;;;; subjects.lisp -- descriptions of things, places and robots, and what is visible of them.

(in-package :ars-magna.display)

(export '(describe-subject snapshot-content display-content))

(defmethod subject-title ((image thing-image)) (princ-to-string (thing-image-thing image)))
(defmethod subject-title ((image robot-image)) (robot-image-label image))
(defmethod subject-title ((image camera-image)) (format nil "Camera ~D" (camera-image-index image)))
(defmethod subject-title ((image hand-image)) (format nil "Hand ~D" (hand-image-index image)))
(defmethod subject-title ((image bin-image)) (format nil "Storage-bin ~D" (bin-image-index image)))
(defmethod subject-title ((image designator-image))
  (format nil "Designator ~D" (designator-image-number image)))

(defun angle-text (angle)
  "Return ANGLE, in radians, as a text in degrees and in radians. Degrees are more than -180 and at
most 180. Radians are never reduced (reading 50), so they can be several turns."
  (let ((degrees (- 180 (mod (- 180 (round (* angle (/ 180 pi)))) 360))))
    (format nil "~D deg (~,2F rad~:[~; in all~])" degrees (zero-if-tiny angle)
            (< (+ pi 0.01d0) (abs angle)))))

(defun attribute-value-text (value)
  "Return VALUE, an attribute's value, as lower-case text. Numbers are decimals without exponents."
  (typecase value
    (float (if (sane-number-p value) (number-text value) (princ-to-string value)))
    (cons (format nil "(~{~A~^ ~})" (mapcar #'attribute-value-text (ensure-list value))))
    (t (format nil "~(~A~)" value))))

(defun denoted-object-text (image)
  "Return a text that names what the designator of IMAGE denotes, FALSE if nothing (manual B)."
  (let ((denotation (designator-image-denotation image)))
    (cond ((null denotation) "FALSE")
          ((stringp denotation) denotation)
          (t (subject-title denotation)))))

(defun write-attributes (image stream)
  "Write a line to STREAM for each attribute of the thing of IMAGE."
  (loop for (name value) in (thing-image-attributes image)
        do (format stream "  ~(~S~) ~A~%" name (attribute-value-text value))))

(defgeneric describe-subject (subject stream)
  (:documentation "Write lines to STREAM that describe SUBJECT, an image or a cell.")
  (:method ((image thing-image) stream)
    (format stream "~A ~:[at ~,2F, ~,2F~;~:*~A~]~%" (subject-title image)
            (thing-image-location image) (thing-image-x image) (thing-image-y image))
    (write-attributes image stream)
    (let ((contents (thing-contents (thing-image-thing image))))
      (when contents (format stream "  contains ~{~A~^, ~}~%" contents))))
  (:method ((image robot-image) stream)
    (format stream "~A at ~,2F, ~,2F heading ~A~%" (subject-title image)
            (robot-image-x image) (robot-image-y image) (angle-text (robot-image-angle image)))
    (when (robot-image-body image) (write-attributes (robot-image-body image) stream)))
  (:method ((image designator-image) stream)
    (format stream "~A, ~(~A~), ~,2F m away at ~A: ~A~%" (subject-title image)
            (designator-image-type image) (designator-image-distance image)
            (angle-text (designator-image-angle image)) (denoted-object-text image)))
  (:method ((image camera-image) stream)
    (format stream "~A looks in a direction ~A from the heading~%" (subject-title image)
            (angle-text (camera-image-angle image))))
  (:method ((image hand-image) stream)
    (format stream "~A, of strength ~A, ~:[is empty~;holds ~:*~A~]~%" (subject-title image)
            (number-text (hand-image-strength image))
            (and (hand-image-contents image) (subject-title (hand-image-contents image)))))
  (:method ((image bin-image) stream)
    (format stream "~A, ~:[open~;closed~], of capacity ~A, contains ~:[nothing~;~:*~{~A~^, ~}~]~%"
            (subject-title image) (bin-image-closed-p image)
            (number-text (bin-image-capacity image))
            (mapcar #'subject-title (bin-image-contents image))))
  (:method ((cell cell) stream)
    (format stream "Cell ~D, ~D: ~A~%" (cell-x cell) (cell-y cell)
            (cond ((cell-filled? cell)
                   (format nil "a wall of ~(~A~), parameter ~,1F" (cell-substance-type cell)
                           (cell-substance-parameter cell)))
                  ((cell-type cell) (format nil "~(~A~)" (place-type (cell-type cell))))
                  (t "open space")))))

;;;; Contents

;;; If two contents of a display are EQUAL, the display looks the same. Images are new in each
;;; snapshot, so contents are their slots. Things, maps and image vectors are compared themselves.

(defgeneric visible-content (object)
  (:documentation "Return an object that represents what is visible of OBJECT, an image or a list of
images. It can be compared by EQUAL.")
  (:method (object) object)
  (:method ((list cons)) (cons (visible-content (car list)) (visible-content (cdr list))))
  (:method ((image thing-image))
    (list (thing-image-thing image) (thing-image-attributes image)
          ;; A name may mean another function now.
          (resolve-draw-function (thing-image-draw-function image)))))

(defmacro define-visible-content (image (&rest slots) &rest parts)
  "Define the method of VISIBLE-CONTENT for the image type IMAGE. It returns the values of SLOTS and
the contents of PARTS, which are slots with images."
  (flet ((reader (slot) (symbolicate image '- slot)))
    `(defmethod visible-content ((image ,image))
       (list ,@(loop for slot in slots collect `(,(reader slot) image))
             ,@(loop for part in parts collect `(visible-content (,(reader part) image)))))))

(define-visible-content designator-image (number type angle distance x y) denotation)
(define-visible-content camera-image (angle look view) track location)
(define-visible-content hand-image () contents location)
(define-visible-content bin-image (closed-p) contents)
(define-visible-content odometer-image (x y heading width height axis spread))
(define-visible-content robot-image (x y angle trail planned-way)
  cameras odometer designators notes)

(defun snapshot-content (snapshot)
  "Return an object that represents the looks of the world in SNAPSHOT. The objects for two
snapshots are EQUAL if their worlds look the same."
  (list (snapshot-map snapshot) (snapshot-things snapshot)
        (visible-content (snapshot-robots snapshot))))

(defun display-content (display robot)
  "Return an object that represents what DISPLAY shows of ROBOT, an image. DISPLAY is one of
+DISPLAYS+, but not the world. The objects for two images are EQUAL if DISPLAY shows them alike."
  (ecase display
    (:state (list (robot-image-x robot) (robot-image-y robot) (robot-image-angle robot)
                  (robot-image-speed robot) (robot-image-place robot)
                  (robot-image-under-way robot) (robot-image-interruption robot)))
    (:designators (visible-content (robot-image-designators robot)))
    (:cameras (list (robot-image-angle robot) (visible-content (robot-image-cameras robot))
                    (loop for camera in (robot-image-cameras robot)
                          when (camera-image-view camera) collect (camera-image-view-age camera))))
    (:hands (visible-content (robot-image-hands robot)))
    (:bins (visible-content (robot-image-bins robot)))))
