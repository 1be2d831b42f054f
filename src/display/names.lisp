;;;; names.lisp -- what things and robots are called, beside them or at the end of a line.

(in-package :ars-magna.display)

(export '(drawn-name draw-names))

;;; A name is written near by where its box meets no thing, robot, number of a designator or other
;;; name, and rather no wall, no mark of a place and no trail; if there is no such room, not at all.
;;; Other lines end before a name. Robots come first, whose names may lie on any wall if need be, or
;;; farther off at the end of a line. Then come large things.

(defconstant +longest-name+ 24 "The most characters of a name on the map or beside a sample.")

(defun short-name (name)
  "Return the string NAME, or its beginning if it is long."
  (cut name +longest-name+))

(defun drawn-name (name)
  "Return what the symbol or string NAME is called in pictures: in small letters, but for names that
have small letters of their own."
  (let ((text (string name)))
    (if (some #'lower-case-p text) text (string-downcase text))))

(defun robot-title (image)
  (drawn-name (robot-image-name image)))

(defun thing-image-name (image)
  (drawn-name (thing-name (thing-image-thing image))))

(defun robot-spot (robot robots)
  (make-spot (short-name (robot-title robot))
             (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
             (+ 1 (spot-radius robot robots)) robot))

;;; Of things in one place the small ones lie above. One of the same size hides what is below it.

(defun pile-key (image)
  "Return an object that is EQUALP to that of another image of a thing if one hides the other."
  (list (thing-image-x image) (thing-image-y image) (half-width image)))

(defun thing-spot (image hidden)
  "Return the spot of the thing of IMAGE, which hides so many others as HIDDEN says."
  (make-spot (format nil "~A~@[ and ~D more~]" (short-name (thing-image-name image))
                     (and (plusp hidden) hidden))
             (to-pixels (thing-image-x image)) (to-pixels (thing-image-y image))
             (half-width image)))

(defun thing-spots (images)
  "Return the spots of those of IMAGES, of things in the order in which they are drawn, the largest
first, that no other hides."
  (let ((piles (make-hash-table :test 'equalp)))
    (dolist (image images) (push image (gethash (pile-key image) piles)))
    (loop for image in images
          for (top . hidden) = (gethash (pile-key image) piles)
          when (eq image top) collect (thing-spot image (length hidden)))))

(defun named-spots (snapshot)
  "Return the spots of what has a name on the map, in order of importance."
  (append (loop with robots = (snapshot-robots snapshot)
                for robot in robots collect (robot-spot robot robots))
          (thing-spots (stable-sort (coerce (snapshot-things snapshot) 'list) #'>
                                    :key #'thing-image-size))))

;;; Lines to names.

;;; A name without a line belongs to what is nearest to it. Where robots crowd, and for things right
;;; beside one, there may be no room for such: the name stands farther off, and a thin line leads to
;;; it, which meets no other robot unless there is no other way.

(defun rival-p (spot other)
  "True if the name of SPOT could be taken for that of OTHER. The rings of robots on the same spot
are around each other, and what has a place in common has its names there, too."
  (not (or (eq spot other)
           (and (spot-robot spot) (spot-robot other)
                (one-spot-p (spot-robot spot) (spot-robot other)))
           (and (= (spot-x spot) (spot-x other)) (= (spot-y spot) (spot-y other))))))

(defun rivals (spot spots reach)
  "Return those of SPOTS within REACH pixels from SPOT for whose names that of SPOT could be taken."
  (flet ((near-p (from to) (< (abs (- from to)) reach)))
    (remove-if-not (lambda (other)
                     (and (near-p (spot-x spot) (spot-x other))
                          (near-p (spot-y spot) (spot-y other))
                          (rival-p spot other)))
                   spots)))

(defun nearest-in (box x y)
  "Return the point of BOX that is nearest to X, Y, as two values."
  (destructuring-bind (left top right bottom) box
    (values (clamp x left right) (clamp y top bottom))))

(defun apart (x y to-x to-y)
  (sqrt (+ (expt (- to-x x) 2) (expt (- to-y y) 2))))

(defun off-ring (image x y)
  "Return how far X, Y is from the ring of the robot of IMAGE, in pixels; less than 0 within."
  (- (apart x y (to-pixels (robot-image-x image)) (to-pixels (robot-image-y image)))
     (robot-radius)))

(defconstant +own+ 6 "How much nearer a name is to its own robot than to others, in pixels.")
(defconstant +own-thing+ 3
  "How much nearer a name is to its owner if that or the other is a thing, in pixels.")

(defun gap (spot box)
  "Return how far BOX is from SPOT, a ring or a square, in pixels; 0 or less if they meet."
  (let ((x (spot-x spot)) (y (spot-y spot)) (half (spot-half spot)))
    (flet ((off (x y)
             (multiple-value-bind (to-x to-y) (nearest-in box x y) (apart x y to-x to-y))))
      (if (spot-robot spot)
          (- (off x y) half)
          (destructuring-bind (left top right bottom) box
            (off (clamp (clamp x left right) (- x half) (+ x half))
                 (clamp (clamp y top bottom) (- y half) (+ y half))))))))

(defun own-box-p (spot box rivals)
  "True if who reads a name in BOX takes it for that of SPOT rather than for those of RIVALS."
  (loop with own = (gap spot box)
        for rival in rivals
        never (< (gap rival box)
                 (+ own (if (and (spot-robot spot) (spot-robot rival)) +own+ +own-thing+)))))

(defun rivals-near (spot box spots reach)
  "Return the rivals, as RIVALS does, of SPOT within REACH among the index SPOTS that are so near to
BOX that its name there could be taken for theirs."
  (let ((off (+ 1 +own+ (max 0 (gap spot box)))))
    (destructuring-bind (left top right bottom) box
      (rivals spot
              (all-overlapping (list (- left off) (- top off) (+ right off) (+ bottom off)) spots)
              reach))))

(defun beside-robot-p (spot rivals)
  "True if one of RIVALS is a robot so near to SPOT that their names are in each other's way."
  (some (lambda (rival) (and (spot-robot rival) (< (gap rival (spot-box spot)) +own+))) rivals))

(define-constant +leader-lengths+ '(10 18 28 40 56 76)
  :test #'cl:equal
  :documentation "How long lines to names are, in pixels: the shortest that is free counts.")

(defun box-at-end (x y angle width)
  "Return the box of a name WIDTH pixels wide that a line ends at which comes to X, Y in direction
ANGLE."
  (flet ((before (share size)
           (cond ((< share -1/3) size) ((< 1/3 share) 0) (t (/ size 2)))))
    (let ((left (- x (before (cosine angle) width)))
          (top (- y (before (sine angle) +name-height+))))
      (list left top (+ left width) (+ top +name-height+)))))

(defun led-boxes (spot width)
  "Return boxes for the name of SPOT, WIDTH pixels wide, farther off: the nearest first."
  (loop for length in +leader-lengths+
        append (loop for turn below 16
                     for angle = (* turn (/ pi 8))
                     collect (destructuring-bind (x y)
                                 (around (spot-x spot) (spot-y spot) angle
                                         (+ length (spot-half spot)))
                               (box-at-end x y angle width)))))

(defun leader-ends (spot box)
  "Return the ends of the line from SPOT to BOX, as a list x y x y."
  (let ((x (spot-x spot)) (y (spot-y spot)))
    (multiple-value-bind (to-x to-y) (nearest-in box x y)
      (append (around x y (arctangent (- to-y y) (- to-x x)) (spot-half spot))
              (list to-x to-y)))))

(defun off-leaders (spot rivals)
  "Return of RIVALS the images of the robots that a line from SPOT is to leave alone: from a thing
within a ring a line leads out of that."
  (loop for rival in rivals
        when (and (spot-robot rival)
                  (or (spot-robot spot) (<= 2 (gap rival (spot-box spot)))))
          collect (spot-robot rival)))

(defun spot-blocked-p (spot at taken)
  "True if the box AT of a line from SPOT meets a box of the index TAKEN, off SPOT; if that is of a
thing, of a box that does not meet it, either."
  (let ((own (spot-box spot)))
    (and (not (overlap-p at own))
         (find-overlapping at taken (lambda (other)
                                      (or (spot-robot spot) (not (overlap-p other own))))))))

(defun leader-clear-p (spot box taken rivals)
  "True if the line from SPOT to BOX meets no ring of a robot among RIVALS and none of the boxes in
the index TAKEN but that of SPOT."
  (let ((robots (off-leaders spot rivals)))
    (destructuring-bind (x y to-x to-y) (leader-ends spot box)
      (loop for step from 0 to 8
            for at-x = (+ x (* step 1/8 (- to-x x))) and at-y = (+ y (* step 1/8 (- to-y y)))
            always (and (every (lambda (robot) (< 2 (off-ring robot at-x at-y))) robots)
                        (not (spot-blocked-p spot (box-around at-x at-y 1) taken)))))))

(defun led-box (snapshot layers spot width taken rivals)
  "Return the box farther off where the name of SPOT, WIDTH pixels wide, hides least, or NIL: if it
can be, one to which a clear line leads; that of a thing must be clear."
  (let ((boxes (led-boxes spot width)))
    (flet ((best (own-p)
             (best-box snapshot layers boxes taken :anywhere-p t :own-p own-p)))
      (or (best (lambda (box) (leader-clear-p spot box taken rivals)))
          (and (spot-robot spot) (best (constantly t)))))))

;;; Writing names.

(defconstant +apart+ 6 "The least distance between names on a line, in pixels.")

(defun widened (box by)
  (destructuring-bind (left top right bottom) box
    (list (- left by) top (+ right by) bottom)))

(defun marked-spots (snapshot layers)
  "Return the boxes of the numbers and rings that LAYERS show of SNAPSHOT."
  (loop for (layer . arguments) in (shown-lines snapshot layers)
        when (%layer-boxes layer) append (apply (%layer-boxes layer) arguments)))

(defun boxes-of-robots (robots)
  (loop for robot in robots
        append (loop for (x y to-x to-y)
                       in (camera-lines robot (ring-radius robot robots))
                     collect (widened (list (min x to-x) (min y to-y) (max x to-x) (max y to-y))
                                      1))))

(defun write-name (canvas name box)
  "Write NAME in BOX, on white: what lines lie there end before it."
  (destructuring-bind (left top right bottom) box
    (wipe canvas left top (- right left) (- bottom top))
    (with-color black*
      (draw-words canvas draw-gcontext* (+ 1 left) (- bottom 2) name :size +name-size+))))

;;; SPOTS are those of what has a name, as an index.

(defconstant +reach-of-names+ 100 "How far around a name other owners are looked for, in pixels.")

(defun reach-of-name (spot width)
  "Return how far from SPOT what its name, WIDTH pixels wide, could be taken for is looked for."
  (+ width (spot-half spot) +reach-of-names+))

(defun near-box (snapshot layers spot width taken marks spots)
  "Return the box beside SPOT where its name, WIDTH pixels wide, hides least and is not taken for
that of another of SPOTS, or NIL."
  (flet ((own-p (box)
           (own-box-p spot box (rivals-near spot box spots (reach-of-name spot width)))))
    (best-box snapshot layers
              (boxes-beside (spot-x spot) (spot-y spot) (spot-half spot) width marks)
              taken :anywhere-p (and (spot-robot spot) t) :own-p #'own-p)))

(defun on-another-p (spot spots)
  "True if SPOT lies on or right beside another of SPOTS."
  (and (find-overlapping (spot-box spot) spots (lambda (other) (not (eq other spot)))) t))

(defun name-box (snapshot layers spot width taken marks spots robots)
  "Return the box for the name of SPOT, WIDTH pixels wide, or NIL, and as a second value whether a
line has to lead there. ROBOTS are those of SPOTS that are of robots, a list."
  (let ((near (near-box snapshot layers spot width taken marks spots)))
    (if near
        (values near nil)
        (let ((rivals (rivals spot robots (reach-of-name spot width))))
          (when (or (spot-robot spot) (on-another-p spot spots) (beside-robot-p spot rivals))
            (values (led-box snapshot layers spot width taken rivals) t))))))

(defun draw-names (canvas snapshot layers &optional boxes)
  "Write the names of robots and things where there is room beside what LAYERS list and BOXES; those
of robots, and of things right beside one or on another, where there is none at the end of a line."
  (let* ((spots (named-spots snapshot)) (robots (snapshot-robots snapshot))
         (per-character (character-width canvas +name-size+))
         (marks (append boxes (marked-spots snapshot layers)))
         (taken (index-boxes (append marks (boxes-of-robots robots)
                                     (loop for spot in spots
                                           collect (widened (spot-box spot) 1)))))
         (marks (index-boxes marks))
         (index (index-boxes (mapcar #'spot-box spots) spots))
         (robot-spots (remove nil spots :key #'spot-robot)))
    (dolist (spot spots)
      (multiple-value-bind (box led-p)
          (name-box snapshot layers spot (+ 2 (* per-character (length (spot-name spot))))
                    taken marks index robot-spots)
        (when box
          (let ((box (widened box +apart+))) (enter-box box box taken))
          (when led-p
            (inked (black*) (draw-segments canvas draw-gcontext* (leader-ends spot box))))
          (write-name canvas (spot-name spot) box))))))
