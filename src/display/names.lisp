;;;; names.lisp -- what things and robots are called, written beside them where there is room.

(in-package :ars-magna.display)

;;; A name is written near by where its box meets no thing, robot, number of a designator or other
;;; name, and rather no wall, no mark of a place and no trail; if there is no such room, not at all.
;;; Other lines end before a name. Robots come first, whose names may lie on any wall if need be, or
;;; farther off at the end of a line: see leaders.lisp. Then come large things.

(define-constant +longest-name+ 24
  :documentation "How many characters of a name are written beside a sample, or on the map.")

(defun short-name (name)
  "Return the string NAME, or its beginning if it is long."
  (cut name +longest-name+))

(defun drawn-name (name)
  "Return what the symbol or string NAME is called in pictures: in small letters, but for names that
have small letters of their own."
  (let ((text (string name)))
    (if (some #'lower-case-p text) text (string-downcase text))))

(defun robot-title (image)
  "Return what the robot that IMAGE is of is called in pictures."
  (drawn-name (robot-image-name image)))

(defun thing-image-name (image)
  (drawn-name (thing-name (thing-image-thing image))))

(defun robot-spot (robot robots)
  "Return the spot of ROBOT, the image of one of ROBOTS."
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

(define-constant +apart+ 6
  :documentation "How far names on a line are apart at least, not to be read as one, in pixels.")

(defun widened (box by)
  (destructuring-bind (left top right bottom) box
    (list (- left by) top (+ right by) bottom)))

(defun marked-spots (snapshot layers)
  "Return the boxes of the numbers and rings that LAYERS show of SNAPSHOT."
  (loop for (layer . arguments) in (shown-lines snapshot layers)
        when (%layer-boxes layer) append (apply (%layer-boxes layer) arguments)))

(defun boxes-of-robots (robots)
  "Return boxes around the lines of the cameras of ROBOTS."
  (loop for robot in robots
        append (loop for (x y to-x to-y)
                       in (camera-lines robot (ring-radius robot robots))
                     collect (widened (list (min x to-x) (min y to-y) (max x to-x) (max y to-y))
                                      1))))

(defun write-name (canvas name box)
  "Write NAME in BOX, on white: what lines lie there end before it."
  (destructuring-bind (left top right bottom) box
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-rectangle canvas draw-gcontext* left top (- right left) (- bottom top) t)))
  (with-color black*
    (draw-words canvas draw-gcontext* (+ 1 (first box)) (- (fourth box) 2) name
                :size +name-size+)))

;;; SPOTS are those of what has a name, as an index.

(define-constant +reach-of-names+ 100
  :documentation "How far around a name what is near to it is looked for, in pixels.")

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
          (when led-p (draw-leader canvas spot box))
          (write-name canvas (spot-name spot) box))))))
