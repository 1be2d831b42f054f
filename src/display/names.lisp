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

(defun same-place-p (image other)
  (and (= (thing-image-x image) (thing-image-x other))
       (= (thing-image-y image) (thing-image-y other))))

(defun hides-p (image other)
  "True if IMAGE, which is drawn later than OTHER, hides that."
  (and (same-place-p image other) (<= (half-width other) (half-width image))))

(defun thing-spot (image hidden)
  "Return the spot of the thing of IMAGE, which hides so many others as HIDDEN says."
  (make-spot (format nil "~A~@[ and ~D more~]" (short-name (thing-image-name image))
                     (and (plusp hidden) hidden))
             (to-pixels (thing-image-x image)) (to-pixels (thing-image-y image))
             (half-width image)))

(defun thing-spots (images)
  "Return the spots of those of IMAGES, of things in the order in which they are drawn, that no
other hides."
  (loop for (image . above) on images
        for below = (ldiff images (member image images))
        unless (find-if (lambda (other) (hides-p other image)) above)
          collect (thing-spot image (count-if (lambda (other) (hides-p image other)) below))))

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

(defun marked-spots (robot layers)
  "Return the boxes of the numbers and rings that LAYERS show of ROBOT."
  (append (and (member :designators layers)
               (loop for designator in (robot-image-designators robot)
                     collect (designator-box robot designator)))
          (and (member :tracks layers)
               (loop for camera in (robot-image-cameras robot)
                     when (camera-image-track camera)
                       collect (track-box robot (camera-image-track camera))))
          (let ((end (first (last (robot-image-planned-way robot)))))
            (and end (member :planned-way layers)
                 (list (box-around (to-pixels (first end)) (to-pixels (second end))
                                   (+ 2 +mark-radius+)))))))

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

(defun near-box (snapshot layers spot width taken marks rivals)
  "Return the box beside SPOT where its name, WIDTH pixels wide, hides least and is not taken for
that of one of RIVALS, or NIL."
  (best-box snapshot layers
            (boxes-beside (spot-x spot) (spot-y spot) (spot-half spot) width marks)
            taken :anywhere-p (and (spot-robot spot) t)
                  :own-p (lambda (box) (own-box-p spot box rivals))))

(define-constant +reach-of-names+ 100
  :documentation "How far around a name what is near to it is looked for, in pixels.")

(defun boxes-near (spot reach boxes)
  "Return those of BOXES that come within REACH pixels of SPOT: a film looks at them in each frame."
  (let ((area (box-around (spot-x spot) (spot-y spot) reach)))
    (remove-if-not (lambda (box) (overlap-p area box)) boxes)))

(defun on-another-p (spot spots)
  "True if SPOT lies on or right beside another of SPOTS."
  (some (lambda (other)
          (and (not (eq other spot)) (overlap-p (spot-box spot) (spot-box other))))
        spots))

(defun name-box (snapshot layers spot width taken marks rivals led-p)
  "Return the box for the name of SPOT, WIDTH pixels wide, or NIL, and as a second value whether a
line has to lead there, as it may if LED-P."
  (let ((near (near-box snapshot layers spot width taken marks rivals)))
    (cond (near (values near nil))
          ((or led-p (spot-robot spot) (beside-robot-p spot rivals))
           (values (led-box snapshot layers spot width taken rivals) t)))))

(defun draw-names (canvas snapshot layers &optional boxes)
  "Write the names of robots and things where there is room beside what LAYERS list and BOXES; those
of robots, and of things right beside one or on another, where there is none at the end of a line."
  (let* ((spots (named-spots snapshot)) (robots (snapshot-robots snapshot))
         (per-character (character-width canvas +name-size+))
         (marks (append boxes (loop for robot in robots append (marked-spots robot layers))))
         (taken (append marks (boxes-of-robots robots)
                        (loop for spot in spots collect (widened (spot-box spot) 1)))))
    (dolist (spot spots)
      (let* ((width (+ 2 (* per-character (length (spot-name spot)))))
             (reach (+ width (spot-half spot) +reach-of-names+)))
        (multiple-value-bind (box led-p)
            (name-box snapshot layers spot width (boxes-near spot reach taken) marks
                      (rivals spot spots reach) (on-another-p spot spots))
          (when box
            (push (widened box +apart+) taken)
            (when led-p (draw-leader canvas spot box))
            (write-name canvas (spot-name spot) box)))))))
