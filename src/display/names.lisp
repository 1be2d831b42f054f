;;;; names.lisp -- what things and robots are called, beside them or at the end of a line.

(in-package :ars-magna.display)

(export '(drawn-name draw-names))

;;; A name is written where its box meets no thing, robot, number of a designator or other name. It
;;; avoids walls, marks of places and trails if it can. Without room there is no name. Other lines
;;; are interrupted below a name. Robots are named first: their names may lie on any wall, or
;;; farther off at the end of a line. Then come large things.

(defconstant +longest-name+ 24 "The most characters of a name on the map or beside a sample.")

(defun short-name (name)
  (cut name +longest-name+))

(defun drawn-name (name)
  "Return the text for the symbol or string NAME in pictures: in lower case, or unchanged if NAME
already has lower-case letters."
  (let ((text (string name)))
    (if (some #'lower-case-p text) text (string-downcase text))))

(defun robot-title (image)
  (drawn-name (robot-image-name image)))

(defun drawn-thing-name (image)
  (drawn-name (thing-name (thing-image-thing image))))

(defun robot-label-target (robot robots)
  (make-label-target (short-name (robot-title robot))
                     (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                     (+ 1 (widest-ring-radius robot robots)) robot))

;;; Of things in one place the small ones are drawn last. A thing hides those of its own size.

(defun pile-key (image)
  "Return a list for the image of a thing. If one thing hides another, their lists are EQUALP."
  (list (thing-image-x image) (thing-image-y image) (thing-half-width image)))

(defun thing-label-target (image hidden)
  (make-label-target (format nil "~A~@[ and ~D more~]" (short-name (drawn-thing-name image))
                             (and (plusp hidden) hidden))
                     (to-pixels (thing-image-x image)) (to-pixels (thing-image-y image))
                     (thing-half-width image)))

(defun thing-label-targets (images)
  "Return label targets for the things in IMAGES that no other thing hides. IMAGES are in the order
of drawing, the largest thing first."
  (let ((piles (make-hash-table :test 'equalp)))
    (dolist (image images) (push image (gethash (pile-key image) piles)))
    (loop for image in images
          for (top . hidden) = (gethash (pile-key image) piles)
          when (eq image top) collect (thing-label-target image (length hidden)))))

(defun label-targets (snapshot)
  "Return label targets for the robots and things named on the map, the most important first."
  (append (loop with robots = (snapshot-robots snapshot)
                for robot in robots collect (robot-label-target robot robots))
          (thing-label-targets (stable-sort (coerce (snapshot-things snapshot) 'list) #'>
                                            :key #'thing-image-size))))

;;; Lines to names.

;;; A name without a line belongs to the nearest spot. In a crowd of robots, and for a thing right
;;; beside one, there may be no room for such a name. Then the name stands farther off, and a thin
;;; line leads to it. The line crosses no other robot if that can be avoided.

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

(defun pixel-distance (x y to-x to-y)
  (sqrt (+ (expt (- to-x x) 2) (expt (- to-y y) 2))))

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

(define-constant +leader-lengths+ '(10 18 28 40 56 76)
  :test #'cl:equal
  :documentation "The lengths of lines to names, in pixels; the shortest possible is used.")

(defun name-box-at-line-end (x y angle width)
  "Return the box of a name WIDTH pixels wide at the end X, Y of a line in direction ANGLE."
  (flet ((before (share size)
           (cond ((< share -1/3) size) ((< 1/3 share) 0) (t (/ size 2)))))
    (let ((left (- x (before (cosine angle) width)))
          (top (- y (before (sine angle) +name-height+))))
      (list left top (+ left width) (+ top +name-height+)))))

(defun leader-boxes (spot width)
  "Return boxes, nearest first, for the name of SPOT, WIDTH pixels wide, at the ends of lines."
  (loop for length in +leader-lengths+
        append (loop for turn below 16
                     for angle = (* turn (/ pi 8))
                     collect (destructuring-bind (x y)
                                 (point-at-distance (label-target-x spot) (label-target-y spot)
                                                    angle
                                                    (+ length (label-target-half spot)))
                               (name-box-at-line-end x y angle width)))))

(defun leader-ends (spot box)
  "Return the two ends of the line from SPOT to BOX, as a list x y x y."
  (let ((x (label-target-x spot)) (y (label-target-y spot)))
    (multiple-value-bind (to-x to-y) (nearest-point-in-box box x y)
      (append (point-at-distance x y (arctangent (- to-y y) (- to-x x)) (label-target-half spot))
              (list to-x to-y)))))

(defun robots-to-avoid (spot rivals)
  "Return the images of the robots in RIVALS that a line from SPOT must not cross. If SPOT is a
thing inside the ring of a robot, its line may cross this ring."
  (loop for rival in rivals
        when (and (label-target-robot rival)
                  (or (label-target-robot spot)
                      (<= 2 (distance-from-label-target rival (label-target-box spot)))))
          collect (label-target-robot rival)))

(defun leader-piece-blocked-p (spot at taken)
  "True if the box AT, a piece of a line from SPOT, is outside SPOT and overlaps a box of the index
TAKEN. If SPOT is a thing, boxes that overlap SPOT are ignored."
  (let ((own (label-target-box spot)))
    (and (not (overlap-p at own))
         (find-overlapping-item at taken (lambda (other)
                                           (or (label-target-robot spot)
                                               (not (overlap-p other own))))))))

(defun leader-clear-p (spot box taken rivals)
  "True if the line from SPOT to BOX crosses no ring of a robot in RIVALS, and no box of the index
TAKEN except the box of SPOT."
  (let ((robots (robots-to-avoid spot rivals)))
    (destructuring-bind (x y to-x to-y) (leader-ends spot box)
      (loop for step from 0 to 8
            for at-x = (+ x (* step 1/8 (- to-x x))) and at-y = (+ y (* step 1/8 (- to-y y)))
            always (and (every (lambda (robot) (< 2 (distance-from-ring robot at-x at-y))) robots)
                        (not (leader-piece-blocked-p spot (box-around at-x at-y 1) taken)))))))

(defun leader-box (snapshot layers spot width taken rivals)
  "Return the box at the end of a line where the name of SPOT, WIDTH pixels wide, hides least, or
NIL. If every line crosses something, the value is NIL for a thing, but a box for a robot."
  (let ((boxes (leader-boxes spot width)))
    (flet ((best (own-p)
             (best-box snapshot layers boxes taken :anywhere-p t :own-p own-p)))
      (or (best (lambda (box) (leader-clear-p spot box taken rivals)))
          (and (label-target-robot spot) (best (constantly t)))))))

;;; Writing names.

(defconstant +name-gap+ 6 "The least distance between names on a line, in pixels.")

(defun widen-box (box by)
  (destructuring-bind (left top right bottom) box
    (list (- left by) top (+ right by) bottom)))

(defun layer-mark-boxes (snapshot layers)
  "Return the boxes of the numbers and rings that LAYERS draw of SNAPSHOT."
  (loop for (layer . arguments) in (all-shown-layers snapshot layers)
        when (%layer-boxes layer) append (apply (%layer-boxes layer) arguments)))

(defun camera-line-boxes (robots)
  (loop for robot in robots
        append (loop for (x y to-x to-y)
                       in (camera-lines robot (ring-radius robot robots))
                     collect (widen-box (list (min x to-x) (min y to-y) (max x to-x) (max y to-y))
                                        1))))

(defun write-name (canvas name box)
  (destructuring-bind (left top right bottom) box
    (fill-with-white canvas left top (- right left) (- bottom top))
    (with-color black*
      (draw-words canvas draw-gcontext* (+ 1 left) (- bottom 2) name :size +name-size+))))

;;; From here on SPOTS is a box index.

(defconstant +name-confusion-margin+ 100
  "Confusable names are searched up to this distance from a name, in pixels.")

(defun name-confusion-distance (spot width)
  "Return the distance from SPOT, in pixels, up to which confusable names are searched. The name of
SPOT is WIDTH pixels wide."
  (+ width (label-target-half spot) +name-confusion-margin+))

(defun name-box-beside-label-target (snapshot layers spot width taken marks spots)
  "Return the box beside SPOT where the name of SPOT, WIDTH pixels wide, is unambiguous and hides
least. Return NIL if there is no such box."
  (flet ((own-p (box)
           (unambiguous-name-box-p
            spot box (confusable-label-targets-near spot box spots
                                                    (name-confusion-distance spot width)))))
    (best-box snapshot layers
              (boxes-beside-marks (label-target-x spot) (label-target-y spot)
                                  (label-target-half spot)
                                  width marks)
              taken :anywhere-p (and (label-target-robot spot) t) :own-p #'own-p)))

(defun on-other-label-target-p (spot spots)
  (and (find-overlapping-item (label-target-box spot) spots (lambda (other) (not (eq other spot))))
       t))

(defun name-box (snapshot layers spot width taken marks spots robots)
  "Return two values: the box, WIDTH pixels wide, for the name of SPOT, or NIL; and true if a line
must lead to the box. ROBOTS is a list of those targets in the index SPOTS that are robots."
  (let ((near (name-box-beside-label-target snapshot layers spot width taken marks spots)))
    (if near
        (values near nil)
        (let ((rivals (confusable-label-targets spot robots (name-confusion-distance spot width))))
          (when (or (label-target-robot spot) (on-other-label-target-p spot spots)
                    (too-near-robot-p spot rivals))
            (values (leader-box snapshot layers spot width taken rivals) t))))))

(defun draw-names (canvas snapshot layers &optional boxes)
  "Write the names of robots and things where they overlap neither BOXES nor what LAYERS draw. If
there is no room beside a robot, or beside a thing that overlaps or touches another target, the name
is at the end of a line."
  (let* ((spots (label-targets snapshot)) (robots (snapshot-robots snapshot))
         (per-character (character-width canvas +name-size+))
         (marks (append boxes (layer-mark-boxes snapshot layers)))
         (taken (index-boxes (append marks (camera-line-boxes robots)
                                     (loop for spot in spots
                                           collect (widen-box (label-target-box spot) 1)))))
         (marks (index-boxes marks))
         (index (index-boxes (mapcar #'label-target-box spots) spots))
         (robot-spots (remove nil spots :key #'label-target-robot)))
    (dolist (spot spots)
      (multiple-value-bind (box led-p)
          (name-box snapshot layers spot (+ 2 (* per-character (length (label-target-name spot))))
                    taken marks index robot-spots)
        (when box
          (let ((box (widen-box box +name-gap+))) (add-box box box taken))
          (when led-p
            (with-halo (black*) (draw-segments canvas draw-gcontext* (leader-ends spot box))))
          (write-name canvas (label-target-name spot) box))))))
