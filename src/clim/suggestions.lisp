;;;; suggestions.lisp -- lines to try in a new window, above its input line.

(in-package :ars-magna.clim)

;;; They fit the world that is shown: a place that is free, a camera that the robot has, a plan that
;;; is loaded. They are shown until the user has entered a line of his own.

(defstruct (suggestion (:constructor make-suggestion (line text)) (:copier nil))
  "A LINE of the prompt to try, and a TEXT on what it does."
  (line "" :type string :read-only t)
  (text "" :type string :read-only t))

(defconstant +suggestion-count+ 3 "The number of lines to suggest.")

(defmethod subject-title ((suggestion suggestion))
  (format nil "Click to run the line ~A: ~A" (suggestion-line suggestion)
          (suggestion-text suggestion)))

;;; Straight lines.

(defun points-on-line (from-x from-y to-x to-y)
  "Return points (x y) after FROM-X, FROM-Y on the line to TO-X, TO-Y. The last one is TO-X, TO-Y."
  (loop for step from 1 to 20
        for share = (/ step 20)
        collect (list (+ from-x (* share (- to-x from-x))) (+ from-y (* share (- to-y from-y))))))

(defun free-cell-p (map x y)
  (and (map-index map x y) (not (cell-filled? (map-cell map x y)))))

(defun free-square-p (map x y)
  "True if the cell of MAP at X, Y and all cells around it are free."
  (loop for dx from -1 to 1
        always (loop for dy from -1 to 1 always (free-cell-p map (+ x dx) (+ y dy)))))

(defun obstacle-near-p (snapshot robot x y)
  "True if a thing of SNAPSHOT or the body of another robot than ROBOT is near X, Y."
  (flet ((near-p (image)
           (< (max (abs (- x (thing-image-x image))) (abs (- y (thing-image-y image)))) 1)))
    (or (some #'near-p (snapshot-things snapshot))
        (some (lambda (other) (and (robot-image-body other) (near-p (robot-image-body other))))
              (remove robot (snapshot-robots snapshot))))))

(defun drivable-line-p (snapshot robot to-x to-y)
  "True if no walls of SNAPSHOT are near the line from ROBOT to TO-X, TO-Y, and no things or robots
near its second half, because the robot may start beside them."
  (let ((points (points-on-line (robot-image-x robot) (robot-image-y robot) to-x to-y)))
    (and (loop for (x y) in points always (free-square-p (snapshot-map snapshot) x y))
         (loop for (x y) in (last points 10) never (obstacle-near-p snapshot robot x y)))))

(defun reachable-places (snapshot robot)
  "Return places (x y) of SNAPSHOT to which ROBOT can drive straight, the far ones first."
  (let ((from-x (robot-image-x robot)) (from-y (robot-image-y robot)))
    (loop for distance in '(8 6 5 4 3 2)
          append (loop for eighth in '(0 1 -1 2 -2 3 -3 4)
                       for (x y) = (mapcar (lambda (number) (/ (round number 1/2) 2))
                                           (point-at-distance from-x from-y
                                                              (+ (robot-image-angle robot)
                                                                 (* eighth pi 1/4))
                                                              distance))
                       when (drivable-line-p snapshot robot x y) collect (list x y)))))

;;; The suggestions.

(defun place-text (place) (format nil "~{~A~^ ~}" (mapcar #'number-text place)))

(defun suggested-drives (places)
  (when places
    (list (make-suggestion (format nil "go-to ~A" (place-text (first places)))
                           "the robot drives to this place"))))

(defun widest-camera-image (robot)
  "Return the image of the camera of ROBOT with the widest field of view, or NIL."
  (first (sort (copy-list (robot-image-cameras robot)) #'> :key #'camera-image-field-of-view)))

(defun visible-thing-p (snapshot robot camera image)
  "True if ROBOT can see the thing of IMAGE in SNAPSHOT with CAMERA, not at the edge of its view."
  (let* ((dx (- (thing-image-x image) (robot-image-x robot)))
         (dy (- (thing-image-y image) (robot-image-y robot)))
         (angle (- (arctangent dy dx) (robot-image-angle robot) (camera-image-angle camera))))
    (and (< 1 (+ (* dx dx) (* dy dy)) 144)
         (> (cosine angle) (cosine (* 2/5 (camera-image-field-of-view camera))))
         (loop for (x y) in (points-on-line (robot-image-x robot) (robot-image-y robot)
                                            (thing-image-x image) (thing-image-y image))
               always (free-cell-p (snapshot-map snapshot) x y)))))

(defun suggested-looks (snapshot robot)
  (let ((camera (widest-camera-image robot)))
    (when camera
      (list (if (some (lambda (image) (visible-thing-p snapshot robot camera image))
                      (snapshot-things snapshot))
                (make-suggestion (format nil "all-obj-desig ~D non-local ()"
                                         (camera-image-index camera))
                                 "the robot looks for things with a camera")
                (make-suggestion (format nil "cam-view ~D" (camera-image-index camera))
                                 "the robot takes a view with a camera"))))))

(defun suggested-plans (places robot)
  "Return a list of a suggestion to visit some of PLACES by a shipped plan. The list is empty if the
plan is not loaded, or ROBOT has no camera, which the plan needs."
  (when (and (rest places)
             (robot-image-cameras robot)
             (ars-magna.cli:find-plan-named "PATROL-PLACES"))
    (list (make-suggestion (format nil "plan patrol-places ((~A) (~A))"
                                   (place-text (second places)) (place-text (first places)))
                           "a plan visits two places"))))

(defun suggestions-for (snapshot robot)
  "Return +SUGGESTION-COUNT+ suggestions for ROBOT in SNAPSHOT."
  (let* ((places (reachable-places snapshot robot))
         (all (append (suggested-looks snapshot robot)
                      (suggested-drives places)
                      (suggested-plans places robot)
                      (list (make-suggestion "about-face" "the robot turns about")
                            (make-suggestion "status" "what the robot is doing")
                            (make-suggestion "map" "the world as text")))))
    (subseq all 0 +suggestion-count+)))
