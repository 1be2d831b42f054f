;;;; label-targets.lisp -- which things and robots are named, and which names could be confused.

(in-package :ars-magna.display)

(export '(drawn-name names-shown-p layers-without-names))

(defconstant +longest-name+ 24 "The most characters of a name on the map or beside a sample.")

(defun name-columns (name)
  "Return the width of NAME in characters. East Asian characters count twice."
  (loop for char across name sum (if (< (char-code char) 256) 1 (char-width char))))

(defun short-name (name)
  (let ((columns (name-columns name)))
    (if (<= columns +longest-name+)
        name
        (cut name (floor (* +longest-name+ (length name)) columns)))))

(defun drawn-name (name)
  "Return the text for the symbol or string NAME in pictures: in lower case, or unchanged if NAME
already has lower-case letters."
  (let ((text (string name)))
    (if (some #'lower-case-p text) text (string-downcase text))))

(defun robot-title (image)
  (drawn-name (robot-image-label image)))

(defun drawn-thing-name (image)
  (drawn-name (thing-name (thing-image-thing image))))

;; Like :DOOR, the attribute :LABEL is not declared.
(defun thing-label (image)
  "Return the text for the thing of IMAGE on the map: its attribute :LABEL, a string or an integer,
or else its name."
  (let ((label (second (assoc :label (thing-image-attributes image)))))
    (typecase label
      (string label)
      (integer (format nil "~D" label))
      (t (drawn-thing-name image)))))

(defun robot-label-target (robot robots &optional shown)
  "Return the label target for ROBOT, one of ROBOTS. SHOWN is the name of the robot that is drawn as
a disc, or NIL."
  (make-label-target (short-name (robot-title robot))
                     (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                     (+ 1 (if (eq shown (robot-image-name robot))
                              (max (disc-radius robot robots) (widest-ring-radius robot robots))
                              (widest-ring-radius robot robots)))
                     robot))

(defun robot-label-targets (robots &optional shown)
  (loop for robot in robots collect (robot-label-target robot robots shown)))

;;; Of things in one place the small ones are drawn last. A thing hides those of its own size.

(defun pile-key (image)
  "Return a list for the image of a thing. If one thing hides another, their lists are EQUALP."
  (list (thing-image-x image) (thing-image-y image) (thing-half-width image)))

(defun thing-label-target (image hidden)
  (make-label-target (format nil "~A~@[ and ~D more~]" (short-name (thing-label image))
                             (and (plusp hidden) hidden))
                     (to-pixels (thing-image-x image)) (to-pixels (thing-image-y image))
                     (thing-half-width image) nil image))

(defun thing-label-targets (images)
  "Return label targets for the things in IMAGES that no other thing hides. IMAGES are in the order
of drawing, the largest thing first."
  (let ((piles (make-hash-table :test 'equalp)))
    (dolist (image images) (push image (gethash (pile-key image) piles)))
    (loop for image in images
          for (top . hidden) = (gethash (pile-key image) piles)
          when (eq image top) collect (thing-label-target image (length hidden)))))

(defun label-targets-by-size (images)
  "Return label targets for the things in IMAGES, a list, that no other thing hides. The largest is
first."
  (thing-label-targets (stable-sort (copy-list images) #'> :key #'thing-image-size)))

(defun label-targets (snapshot)
  "Return label targets for the robots and things on the map, the most important first."
  (append (robot-label-targets (snapshot-robots snapshot))
          (label-targets-by-size (coerce (snapshot-things snapshot) 'list))))

(defun names-shown-p (layers)
  "True if LAYERS show names of things or robots."
  (and (intersection '(:names :mover-names) layers) t))

(defun layers-without-names (layers)
  "Return LAYERS without those that show names."
  (remove :names (remove :mover-names layers)))

(defun named-targets (targets layers)
  "Return those of TARGETS whose names LAYERS show: all, robots and things with kickers, or none."
  (cond ((member :names layers) targets)
        ((member :mover-names layers)
         (remove-if-not (lambda (target)
                          (or (label-target-robot target)
                              (thing-image-moving-p (label-target-thing target))))
                        targets))))

;;; A name without a line belongs to the nearest target.

(defun names-confusable-p (spot other)
  "True if the name of SPOT could be taken for the name of OTHER. False for targets at the same
point and for rings around each other, whose names belong together."
  (not (or (eq spot other)
           (and (label-target-robot spot) (label-target-robot other)
                (rings-coincide-p (label-target-robot spot) (label-target-robot other)))
           (and (= (label-target-x spot) (label-target-x other))
                (= (label-target-y spot) (label-target-y other))))))

(defun confusable-label-targets (spot spots reach)
  "Return the SPOTS within REACH pixels of SPOT whose names could be confused with that of SPOT."
  (flet ((near-p (from to) (< (abs (- from to)) reach)))
    (remove-if-not (lambda (other)
                     (and (near-p (label-target-x spot) (label-target-x other))
                          (near-p (label-target-y spot) (label-target-y other))
                          (names-confusable-p spot other)))
                   spots)))

(defun nearest-point-in-box (box x y)
  (destructuring-bind (left top right bottom) box
    (values (clamp x left right) (clamp y top bottom))))

(defun distance-from-ring (image x y)
  "Return the distance in pixels of X, Y from the ring of the robot of IMAGE, negative if inside."
  (- (pixel-distance x y (to-pixels (robot-image-x image)) (to-pixels (robot-image-y image)))
     (robot-radius)))

(defconstant +robot-margin+ 6
  "How much nearer, in pixels, a name must be to its own robot than to another robot.")
(defconstant +thing-margin+ 3 "Like +ROBOT-MARGIN+, unless both are robots.")

(defun distance-from-label-target (spot box)
  "Return the distance in pixels of BOX from SPOT, a ring or a square: 0 or less for an overlap."
  (let ((x (label-target-x spot)) (y (label-target-y spot)) (half (label-target-half spot)))
    (flet ((off (x y)
             (multiple-value-call #'pixel-distance x y (nearest-point-in-box box x y))))
      (if (label-target-robot spot)
          (- (off x y) half)
          (destructuring-bind (left top right bottom) box
            (off (clamp (clamp x left right) (- x half) (+ x half))
                 (clamp (clamp y top bottom) (- y half) (+ y half))))))))

(defun unambiguous-name-box-p (spot box rivals)
  "True if a name in BOX clearly belongs to SPOT, not to RIVALS, targets with confusable names."
  (loop with own = (distance-from-label-target spot box)
        for rival in rivals
        for robots-p = (and (label-target-robot spot) (label-target-robot rival))
        never (< (distance-from-label-target rival box)
                 (+ own (if robots-p +robot-margin+ +thing-margin+)))))

(defun confusable-label-targets-near (spot box spots reach)
  "Return the CONFUSABLE-LABEL-TARGETS in the index SPOTS to which a name in BOX might belong."
  (let ((off (+ 1 +robot-margin+ (max 0 (distance-from-label-target spot box)))))
    (destructuring-bind (left top right bottom) box
      (confusable-label-targets
       spot
       (overlapping-items (list (- left off) (- top off) (+ right off) (+ bottom off)) spots)
       reach))))

(defun too-near-robot-p (spot rivals)
  "True if one of RIVALS is a robot so near to SPOT that there is no room for both names."
  (some (lambda (rival)
          (and (label-target-robot rival)
               (< (distance-from-label-target rival (label-target-box spot)) +robot-margin+)))
        rivals))
