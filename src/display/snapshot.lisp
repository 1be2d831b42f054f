;;;; snapshot.lisp -- what a world looks like at one moment, for those who draw it.

(in-package :ars-magna.display)

(export '(snapshot take-snapshot snapshot-of snapshot-tick snapshot-map snapshot-things
          snapshot-robots snapshot-robot thing-image robot-image robot-image-name robot-image-x
          robot-image-y robot-image-designators thing-image-location camera-image
          camera-image-index hand-image hand-image-index bin-image bin-image-index
          designator-image in-part shown-part thing-image-thing thing-image-attributes
          robot-image-angle robot-image-cameras robot-image-hands robot-image-bins
          camera-image-track hand-image-contents hand-image-location bin-image-closed-p
          bin-image-contents designator-image-number designator-image-denotation snapshot-part
          thing-image-x thing-image-y))

;;; A snapshot is made where the world stands still, and never changes; whoever draws, in whatever
;;; thread, draws from one. An image is what it knows of a thing, a robot or a part. The image of a
;;; thing that has not changed since the snapshot before is the same object.

(defmacro define-image (name documentation &rest slots)
  "Define NAME as a structure with SLOTS, (name default), that are never changed."
  `(defstruct (,name (:copier nil))
     ,documentation
     ,@(loop for (slot default) in slots collect `(,slot ,default :read-only t))))

(define-image snapshot "What a world looks like at one moment; PART is what is to be shown of its
map, a list (left top right bottom) in cells, or NIL for all."
  (tick 0) (map nil) (things #()) (robots '()) (part nil))

(define-image thing-image "What a snapshot knows of a thing; COLOR is that of the display.
LOCATION says in words what it is in, or is NIL. It is MOVING-P if it has kickers."
  (thing nil) (x 0d0) (y 0d0) (location nil) (attributes '()) (color 0) (size 0d0)
  (obsmove-p nil) (obsview-p nil) (container-p nil) (moving-p nil) (draw-function nil))

(define-image robot-image "What a snapshot knows of a robot, which is at POSITION among those of its
world: that decides what it looks like. NOTES has by the names of layers what their :note returned."
  (name nil) (position 0) (x 0d0) (y 0d0) (angle 0d0) (speed 0d0) (place nil)
  (under-way nil) (interruption nil)
  (cameras '()) (hands '()) (bins '())
  (designators '()) (odometer nil) (trail '()) (planned-way '()) (notes '()))

(define-image camera-image "What a snapshot knows of a camera; ANGLE is relative to the robot. Its
last VIEW was taken VIEW-AGE ticks ago."
  (index 0) (angle 0d0) (field-of-view 1d0) (view '()) (view-age 0) (track nil)
  (location nil) (look nil))

(define-image hand-image "What a snapshot knows of a hand."
  (index 0) (strength 0d0) (contents nil) (location nil))

(define-image bin-image "What a snapshot knows of a storage bin."
  (index 0) (capacity 0d0) (closed-p nil) (contents '()))

(define-image designator-image "What a snapshot knows of a designator. DENOTATION is the image of a
thing, the name of a place type, or NIL if the designator is false; X and Y are where that is."
  (number 0) (type nil) (angle 0d0) (distance 0d0) (denotation nil) (x nil) (y nil))

(define-image odometer-image "What a snapshot knows of an odometer: where, seen from outside, it
puts the robot, and how uncertain it is."
  (x 0d0) (y 0d0) (heading 0d0) (width 0d0) (height 0d0) (axis 0d0) (spread 0d0))

(document-functions
  snapshot-tick "Return the tick at which the snapshot was taken."
  snapshot-map "Return the map of the world in the snapshot."
  snapshot-part
  "Return what is to be shown of the map, (left top right bottom) in cells, or NIL for all."
  snapshot-things "Return a vector of the images of the things on the floor, by serial number."
  snapshot-robots "Return a list of the images of the robots."
  robot-image-name "Return the symbol that the robot is called."
  robot-image-x "Return the robot's x coordinate, in metres."
  robot-image-y "Return the robot's y coordinate, in metres."
  robot-image-designators "Return a list of the images of the robot's designators, by number."
  thing-image-thing "Return the thing itself."
  thing-image-x "Return the thing's x coordinate, in metres."
  thing-image-y "Return the thing's y coordinate, in metres."
  thing-image-location "Return in words what the thing is in, as `in hand 0 of ROBBIE', or NIL."
  thing-image-attributes "Return a list (name value) for each attribute of the thing."
  robot-image-angle "Return the robot's heading, in radians."
  robot-image-cameras "Return a list of the images of the robot's cameras."
  robot-image-hands "Return a list of the images of the robot's hands."
  robot-image-bins "Return a list of the images of the robot's storage bins."
  camera-image-index "Return the number of the camera."
  camera-image-track "Return the image of the designator that the camera tracks, or NIL."
  hand-image-index "Return the number of the hand."
  hand-image-contents "Return the image of the thing that the hand holds, or NIL."
  hand-image-location "Return what the hand is inside of: the image of a thing, a string, or NIL."
  bin-image-contents "Return a list of the images of the things in the storage bin."
  bin-image-index "Return the number of the storage bin."
  bin-image-closed-p "True if the storage bin is closed."
  designator-image-number "Return the number of the designator."
  designator-image-denotation
  "Return the image of the thing that it denotes, or the name of a place type, or NIL.")

;;; Things.

(defun moving-p (thing) (and (thing-kickers thing) t))

(defun image-of-thing (thing &optional old)
  "Return the image of THING: OLD, an image of it, if that is still right."
  (let ((attributes (thing-attributes thing)))
    (if (and old
             (eq attributes (thing-image-attributes old))
             (= (thing-x thing) (thing-image-x old))
             (= (thing-y thing) (thing-image-y old))
             (eq (moving-p thing) (thing-image-moving-p old)))
        old
        (make-thing-image
         :thing thing :x (thing-x thing) :y (thing-y thing) :attributes attributes
         :location (thing-holders-text thing)
         :color (shade (get-attribute thing :color)) :size (thing-size thing)
         :obsmove-p (thing-obsmove-p thing) :obsview-p (thing-obsview-p thing)
         :container-p (plusp (thing-capacity thing)) :moving-p (moving-p thing)
         :draw-function (get-attribute thing :draw-function)))))

(defun image-serial (image) (thing-serial (thing-image-thing image)))

(defun images-on-floor (world old)
  "Return a vector of the images of the things on the floor of WORLD by serial number. OLD is such
a vector of an earlier moment, returned if nothing has changed; both are in order, so one pass finds
what it holds of each."
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
  "Return how to show that a part is inside LOCATION: NIL, an image, or a string."
  (cond ((null location) nil)
        ((thing-p location) (image-of-thing location))
        (t (location-name location))))

(defun image-of-denotation (denotation)
  (cond ((thing-p denotation) (image-of-thing denotation))
        ((place-p denotation) (princ-to-string (place-type-name (place-type denotation))))))

(defun place-of-denotation (denotation)
  "Return, as a list, where what DENOTATION is lies; NIL if it is false."
  (cond ((thing-p denotation) (multiple-value-list (thing-position denotation)))
        ((place-p denotation)
         (let ((cell (place-cell denotation)))
           (list (+ 1/2 (cell-x cell)) (+ 1/2 (cell-y cell)))))))

(defun image-of-designator (designator)
  (make-designator-image
   :x (first (place-of-denotation (designator-denotation designator)))
   :y (second (place-of-denotation (designator-denotation designator)))
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
  "Return the image of the main odometer of ROBOT: its box, and its bounds of the heading."
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

(defun notes-of (robot)
  "Return a property list of what layers with a :note want to know of ROBOT."
  (loop for layer in *layers*
        when (%layer-note layer)
          append (list (%layer-name layer) (funcall (%layer-note layer) robot))))

(defun image-of-robot (robot position history)
  (flet ((images (function parts) (cl:map 'list function parts)))
    (make-robot-image
     :name (robot-name robot) :position position
     :x (robot-x robot) :y (robot-y robot) :angle (robot-angle robot)
     :speed (robot-speed robot) :place (robot-last-place robot)
     :under-way (under-way-text robot) :interruption (interruption-text robot)
     :cameras (images (lambda (camera) (image-of-camera camera history))
                      (robot-cameras robot))
     :hands (images #'image-of-hand (robot-hands robot))
     :bins (images #'image-of-bin (robot-bins robot))
     :designators (images #'image-of-designator (live-designators robot))
     :odometer (and (robot-main-odometer robot) (image-of-odometer robot))
     :trail (points-of-trail robot)
     :planned-way (robot-way-left robot) :notes (notes-of robot))))

;;; The whole.

(defun take-snapshot (world &optional previous)
  "Return a snapshot of WORLD as it is now; to be called where it stands still. PREVIOUS, an earlier
snapshot of WORLD, makes it cheaper."
  (let* ((timeline (world-timeline world))
         (history (and timeline (timeline-run timeline) (history-of (timeline-run timeline)))))
    (make-snapshot :tick (world-tick world)
                   :map (world-map world)
                   :things (images-on-floor world (if previous (snapshot-things previous) #()))
                   ;; Some of what an image has is text.
                   :robots (printing-plainly ()
                             (loop for robot in (world-robots world)
                                   for position from 0
                                   collect (image-of-robot robot position history))))))

(defun snapshot-of (robot)
  "Return a snapshot of the world of ROBOT, from whatever thread."
  (asking ((robot-simulation robot)) (take-snapshot (robot-world robot))))

(defun snapshot-robot (snapshot name)
  "Return the image of the robot called NAME in SNAPSHOT; of its first robot if none is so called."
  (or (find name (snapshot-robots snapshot) :key #'robot-image-name :test #'same-name-p)
      (first (snapshot-robots snapshot))))

;;; A part of it.

(defun shown-part (snapshot)
  "Return what is to be shown of the map of SNAPSHOT, as a list (left top right bottom) in cells."
  (or (snapshot-part snapshot)
      (list 0 0 (map-width (snapshot-map snapshot)) (map-height (snapshot-map snapshot)))))

(defun shown-size (snapshot)
  "Return how wide and how high what is to be shown of the map of SNAPSHOT is, in cells."
  (destructuring-bind (left top right bottom) (shown-part snapshot)
    (values (- right left) (- bottom top))))

(defun check-part (operator part map)
  (let ((width (map-width map)) (height (map-height map)))
    (unless (or (null part)
                (and (proper-list-p part) (= 4 (length part)) (every #'integerp part)
                     (destructuring-bind (left top right bottom) part
                       (and (< -1 left right (1+ width)) (< -1 top bottom (1+ height))))))
      (reject-argument operator 'part part
                       (format nil "a list (left top right bottom) of integers within ~D x ~D, or ~
                                    NIL" width height)))))

(defun in-part (snapshot part operator)
  "Return SNAPSHOT with PART (left top right bottom) of its map, in cells, and what is in that. NIL
means all. Signals WRONG-ARGUMENT, of OPERATOR, if PART is no part of that map."
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
