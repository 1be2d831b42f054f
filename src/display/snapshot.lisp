;;;; snapshot.lisp -- what a world looks like at one moment, for drawing.

(in-package :ars-magna.display)

(export '(snapshot take-snapshot snapshot-of snapshot-robot thing-image robot-image camera-image
          hand-image bin-image designator-image snapshot-of-part shown-part))

;;; A snapshot is taken between ticks and never changes, so that any thread can draw it. It has
;;; images of things, robots and their parts. If a thing has not changed since the snapshot before,
;;; its image is the same object.

(define-record snapshot
  "A snapshot: all that pictures show of a world at one moment."
  (tick 0 t "the tick at which the snapshot was taken" :export)
  (map nil t "the map of the world in the snapshot" :export)
  (things #() t "a vector of the images of the things on the floor, by serial number" :export)
  (robots '() t "a list of the images of the robots" :export)
  (part nil t
        "the part of the map to show, (left top right bottom) in cells, or NIL for all" :export))

(define-record thing-image
  "The image of a thing: all that pictures show of the thing at one moment."
  (thing nil t "the thing itself" :export)
  (x 0d0 t "the thing's x coordinate, in metres" :export)
  (y 0d0 t "the thing's y coordinate, in metres" :export)
  (location nil t "a text on the thing's container, such as `in hand 0 of ROBBIE', or NIL" :export)
  (attributes '() t "a list (name value) for each attribute of the thing" :export)
  (color 0 t "the colour in displays")
  (size 0d0 t)
  (obsmove-p nil t)
  (obsview-p nil t)
  (container-p nil t)
  (moving-p nil t "the thing has kickers")
  (draw-function nil t))

(define-record robot-image
  "The image of a robot: all that pictures show of the robot at one moment."
  (name nil t "the name of the robot, a symbol" :export)
  (label "" string "the name of the robot as a text, different from those of other robots" :export)
  (position 0 t "the robot's position in its world's list of robots, which determines its look")
  (x 0d0 t "the robot's x coordinate, in metres" :export)
  (y 0d0 t "the robot's y coordinate, in metres" :export)
  (angle 0d0 t "the robot's heading, in radians" :export)
  (body nil t "the image of the robot's body, or NIL if the robot has none" :export)
  (speed 0d0 t)
  (place nil t)
  (under-way nil t)
  (interruption nil t)
  (cameras '() t "a list of the images of the robot's cameras" :export)
  (hands '() t "a list of the images of the robot's hands" :export)
  (bins '() t "a list of the images of the robot's storage bins" :export)
  (designators '() t "a list of the images of the robot's designators, by number" :export)
  (odometer nil t)
  (trail '() t)
  (planned-way '() t)
  (notes '() t "a property list from names of layers to what their :note functions returned"))

(define-record camera-image
  "The image of a camera: all that pictures show of the camera at one moment."
  (index 0 t "the number of the camera" :export)
  (angle 0d0 t "the angle of the camera relative to the robot, in radians" :export)
  (field-of-view 1d0 t "the camera's field of view, in radians" :export)
  (view '() t "the camera's last view" :export)
  (view-age 0 t "the age of the last view, in ticks")
  (track nil t "the image of the designator that the camera tracks, or NIL" :export)
  (location nil t "the camera's container: the image of a thing, a string, or NIL" :export)
  (look nil t))

(define-record hand-image
  "The image of a hand: all that pictures show of the hand at one moment."
  (index 0 t "the number of the hand" :export)
  (strength 0d0 t)
  (contents nil t "the image of the thing that the hand holds, or NIL" :export)
  (location nil t "the hand's container: the image of a thing, a string, or NIL" :export))

(define-record bin-image
  "The image of a storage bin: all that pictures show of the bin at one moment."
  (index 0 t "the number of the storage bin" :export)
  (capacity 0d0 t)
  (closed-p nil t "the storage bin is closed" :export)
  (contents '() t "a list of the images of the things in the storage bin" :export))

(define-record designator-image
  "The image of a designator: all that pictures show of the designator at one moment."
  (number 0 t "the number of the designator" :export)
  (type nil t)
  (angle 0d0 t)
  (distance 0d0 t)
  (denotation nil t
              "the denotation: the image of a thing, the name of a place type, or NIL" :export)
  (x nil t "the x coordinate in metres of what the designator denotes")
  (y nil t "the y coordinate in metres of what the designator denotes"))

(define-record odometer-image
  "The image of an odometer: its estimate in map coordinates and the estimate's uncertainty."
  (x 0d0 t)
  (y 0d0 t)
  (heading 0d0 t)
  (width 0d0 t)
  (height 0d0 t)
  (axis 0d0 t)
  (spread 0d0 t))

;;; Things.

(defun has-kickers-p (thing) (and (thing-kickers thing) t))

(defun image-of-thing (thing &optional old)
  "Return an image of THING: OLD if this earlier image is given and still valid, else a new image."
  (let ((attributes (thing-attributes thing)))
    (if (and old
             (eq attributes (thing-image-attributes old))
             (= (thing-x thing) (thing-image-x old))
             (= (thing-y thing) (thing-image-y old))
             (eq (has-kickers-p thing) (thing-image-moving-p old)))
        old
        (make-thing-image
         :thing thing :x (thing-x thing) :y (thing-y thing) :attributes attributes
         :location (thing-holders-text thing)
         :color (shade (get-attribute thing :color)) :size (thing-size thing)
         :obsmove-p (thing-obsmove-p thing) :obsview-p (thing-obsview-p thing)
         :container-p (plusp (thing-capacity thing)) :moving-p (has-kickers-p thing)
         :draw-function (get-attribute thing :draw-function)))))

(defun image-serial (image) (thing-serial (thing-image-thing image)))

(defun images-on-floor (world old)
  "Return a vector of the images of the things on the floor of WORLD, sorted by serial number. OLD
is the vector of an earlier moment. If nothing has changed, return OLD. Both vectors are sorted, so
that one pass finds the old image of each thing."
  (declare (type simple-vector old))
  (let ((images '()) (position 0) (count 0) (kept 0))
    (declare (type fixnum position count kept))
    (do-things (thing world)
      (when (eq (thing-location thing) :floor)
        (loop while (and (< position (length old))
                         (< (the fixnum (image-serial (svref old position)))
                            (thing-serial thing)))
              do (incf position))
        (let* ((known (and (< position (length old)) (svref old position)))
               (image (image-of-thing thing (and known (eq thing (thing-image-thing known))
                                                 known))))
          (incf count)
          (when (eq image known) (incf kept))
          (push image images))))
    (if (= kept count (length old))
        old
        (nreverse (coerce images 'simple-vector)))))

;;; Robots.

(defun image-of-location (location)
  "Return an image or a string for LOCATION, the container of a robot's part, or NIL if it is NIL."
  (cond ((null location) nil)
        ((thing-p location) (image-of-thing location))
        (t (location-name location))))

(defun image-of-denotation (denotation)
  (cond ((thing-p denotation) (image-of-thing denotation))
        ((place-p denotation) (princ-to-string (place-type-name (place-type denotation))))))

(defun denotation-coordinates (denotation)
  "Return the coordinates of DENOTATION, a thing or a place, as a list (x y). Return NIL for NIL."
  (cond ((thing-p denotation) (multiple-value-list (thing-position denotation)))
        ((place-p denotation)
         (let ((cell (place-cell denotation)))
           (list (+ 1/2 (cell-x cell)) (+ 1/2 (cell-y cell)))))))

(defun image-of-designator (designator)
  (make-designator-image
   :x (first (denotation-coordinates (designator-denotation designator)))
   :y (second (denotation-coordinates (designator-denotation designator)))
   :number (designator-number designator) :type (designator-type designator)
   :angle (designator-angle designator) :distance (designator-distance designator)
   :denotation (image-of-denotation (designator-denotation designator))))

(defun image-of-camera (camera history)
  (let ((designator (camera-tracks camera)))
    (make-camera-image
     :index (camera-index camera) :angle (camera-angle camera)
     :field-of-view (camera-field-of-view camera) :view (camera-last-view camera)
     :view-age (- (world-tick (robot-world (camera-robot camera))) (camera-last-view-tick camera))
     :track (and designator (image-of-designator designator))
     :location (image-of-location (camera-location camera))
     :look (and history (cdr (assoc camera (history-looks history) :test #'eq))))))

(defun image-of-hand (hand)
  (let ((thing (hand-holding hand)))
    (make-hand-image :index (hand-index hand) :strength (hand-strength hand)
                     :contents (and thing (image-of-thing thing))
                     :location (image-of-location (hand-location hand)))))

(defun image-of-bin (bin)
  (make-bin-image :index (storage-bin-index bin) :capacity (storage-bin-capacity bin)
                  :closed-p (storage-bin-closed-p bin)
                  :contents (mapcar #'image-of-thing (storage-bin-contents bin))))

(defun image-of-odometer (robot)
  (let* ((odometer (robot-main-odometer robot))
         (position (get-odometer-pos odometer))
         (angle (get-odometer-ang odometer)))
    (multiple-value-bind (x y heading) (odometer-estimate odometer)
      (flet ((width (interval) (- (interval-max interval) (interval-min interval))))
        (make-odometer-image
         :x x :y y :heading heading
         :width (width (pt-interval-x position)) :height (width (pt-interval-y position))
         :axis (odometer-origin-angle odometer)
         :spread (width angle))))))

(defun layer-notes-of-robot (robot)
  "Return a property list from names of layers to the values of their :note functions for ROBOT."
  (loop for layer in *layers*
        when (%layer-note layer)
          append (list (%layer-name layer) (funcall (%layer-note layer) robot))))

(defun image-of-robot (robot position history)
  (flet ((images (function parts) (cl:map 'list function parts)))
    (make-robot-image
     :name (robot-name robot) :label (robot-label robot) :position position
     :body (and (robot-body robot) (image-of-thing (robot-body robot)))
     :x (robot-x robot) :y (robot-y robot) :angle (robot-angle robot)
     :speed (robot-speed robot) :place (robot-last-place robot)
     :under-way (under-way-text robot) :interruption (interruption-text robot)
     :cameras (images (lambda (camera) (image-of-camera camera history))
                      (robot-cameras robot))
     :hands (images #'image-of-hand (robot-hands robot))
     :bins (images #'image-of-bin (robot-bins robot))
     :designators (images #'image-of-designator (live-designators robot))
     :odometer (and (robot-main-odometer robot) (image-of-odometer robot))
     :trail (robot-trail-points robot)
     :planned-way (robot-remaining-way robot) :notes (layer-notes-of-robot robot))))

;;; The whole.

(defun take-snapshot (world &optional previous)
  "Return a snapshot of WORLD. Call this function between ticks. If PREVIOUS, an earlier snapshot of
WORLD, is given, unchanged images are reused, which is faster."
  (let* ((timeline (world-timeline world))
         (history (and timeline (timeline-run timeline) (history-of (timeline-run timeline)))))
    (make-snapshot :tick (world-tick world)
                   :map (world-map world)
                   :things (images-on-floor world (if previous (snapshot-things previous) #()))
                   ;; Images contain printed text.
                   :robots (printing-plainly ()
                             (loop for robot in (world-robots world)
                                   for position from 0
                                   collect (image-of-robot robot position history))))))

(defun snapshot-of (robot)
  "Return a snapshot of the world of ROBOT. Any thread may call this function."
  (asking ((robot-simulation robot)) (take-snapshot (robot-world robot))))

(defun snapshot-robot (snapshot name)
  "Return the image of the robot called NAME in SNAPSHOT; if there is none, of the first robot."
  (first (or (robots-meant name (snapshot-robots snapshot) :key #'robot-image-name)
             (snapshot-robots snapshot))))

;;; Parts of the map.

(defun shown-part (snapshot)
  "Return the part of the map that SNAPSHOT shows, as a list (left top right bottom) in cells."
  (or (snapshot-part snapshot)
      (list 0 0 (map-width (snapshot-map snapshot)) (map-height (snapshot-map snapshot)))))

(defun shown-size (snapshot)
  "Return the width and the height of the part of the map that SNAPSHOT shows, in cells."
  (destructuring-bind (left top right bottom) (shown-part snapshot)
    (values (- right left) (- bottom top))))

(defun check-part (operator part map)
  (let ((width (map-width map)) (height (map-height map)))
    (unless (or (null part)
                (and (proper-list-p part) (= 4 (length part)) (every #'integerp part)
                     (destructuring-bind (left top right bottom) part
                       (and (< -1 left right (1+ width)) (< -1 top bottom (1+ height))))))
      (reject-argument operator 'part part
                       (format nil "a list (left top right bottom) of integers within a map of ~D ~
                                    x ~D cells, or NIL" width height)))))

(defun snapshot-of-part (snapshot part operator)
  "Return a snapshot of PART of the map of SNAPSHOT. PART is a list (left top right bottom) in
cells, or NIL for the whole map. Signals WRONG-ARGUMENT for OPERATOR if PART is not in the map."
  (check-part operator part (snapshot-map snapshot))
  (flet ((within-p (x y)
           (destructuring-bind (left top right bottom) part
             (and (<= left x right) (<= top y bottom)))))
    (if part
        (make-snapshot
         :tick (snapshot-tick snapshot) :map (snapshot-map snapshot) :part part
         :things (remove-if-not (lambda (image) (within-p (thing-image-x image)
                                                          (thing-image-y image)))
                                (snapshot-things snapshot))
         :robots (remove-if-not (lambda (image) (within-p (robot-image-x image)
                                                          (robot-image-y image)))
                                (snapshot-robots snapshot)))
        snapshot)))
