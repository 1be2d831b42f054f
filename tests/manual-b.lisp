;;;; manual-b.lisp -- The graphical display (manual appendix B).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-b :in ars-magna)

(defmap museum (20 14)
  (rect (0 0) (19 13) stone 10)
  (wall (10 1) (10 5) bricks 60)
  (wall (10 7) (10 12) bricks 30)
  (wall (3 4) (3 6) wood 5)
  (wall (3 6) (5 6) wood 5)
  (obj bust (6.5 6.5) ((:size 2) (:color red) (:capacity 2)))
  (obj urn (16 10) ((:size 3) (:color blue) (:obsview #t)))
  (obj coin (6.5 9.5) ((:size .5) (:color green))))

(defrobot guide (museum (7.5 6.5) 0)
  :cameras ((1 3) (2 5)) :hands (10 5) :bins (9 9))

(defun picture (&rest options)
  "Return a picture with OPTIONS; by default with 8 pixels to a cell, and without our additions
around the map."
  (apply #'svg-picture guide (append options '(:scale 8 :layers (:places)))))

(defun shows-p (text &rest options)
  "True if a picture with OPTIONS shows TEXT."
  (member text (drawn-with :text (apply #'picture options)) :test #'search
                                                            :key (lambda (e) (of-element e :text))))

(defmacro in-museum ((&rest options) &body body)
  `(with-simulation (guide :clean t ,@options) ,@body))

(defun sees (what &optional (camera 0))
  "Turn CAMERA of GUIDE to the thing called WHAT and search for it; return the designator."
  (let* ((thing (find-thing what)) (camera (robot-camera guide camera))
         (bearing (atan2 (- (thing-y thing) (robot-y guide)) (- (thing-x thing) (robot-x guide)))))
    (answer 'camera-turn camera (- bearing (robot-angle guide) (camera-angle camera)))
    (third (answer 'camera-get-object-designator camera :non-local
                   `((:size ,(get-attribute thing :size) .01))))))

;;; The world.

(test manual-b.there-are-six-displays
  "B, reading 27: the world, robot state, designators, cameras, hands, and storage bins."
  (in-museum ()
    (dolist (title '("Robot state" "Robot designators" "Cameras" "Hands" "Storage bins"))
      (is-true (shows-p title :display :all) "~A" title))
    (dolist (display '(:world :state :designators :cameras :hands :bins))
      (is-true (search "<svg" (picture :display display)) "~A" display))))

(test manual-b.walls-are-black-and-open-space-is-white
  "B: solid black areas are walls, white areas are open space."
  (in-museum ()
    (let ((picture (picture :in-color nil)))
      (is (equal "#ffffff" (of-element (first (drawn-with :rect picture)) :fill)))
      (is-false (remove-if (lambda (fill) (member fill '("#000000" "#ffffff" "none" nil)
                                                  :test #'equal))
                           (mapcar (lambda (element) (of-element element :fill))
                                   (elements picture))))
      (is-true (search "M80 8h8v40h-8z" picture)))))

(defun parts (fill)
  "Return red, green and blue of FILL, such as #804020, as integers."
  (loop for start in '(1 3 5)
        collect (parse-integer fill :start start :end (+ 2 start) :radix 16)))

(defun lightness (fill)
  "Return how light FILL is, as an integer from 0 to 50."
  (destructuring-bind (red green blue)
      (mapcar (lambda (part) (expt (/ part 255) 2.2)) (parts fill))
    (round (* 50 (+ (* .2126 red) (* .7152 green) (* .0722 blue))))))

(test manual-b.walls-are-grey-by-their-parameter
  "B: in colour, walls are in shades of grey, which denote different substance parameters. (They
have a tint of their substance, which is ours.)"
  (eval '(defmap greys (6 6) (wall (0 0) (0 0) stone 10) (wall (2 0) (2 0) wood 10)
          (wall (4 0) (4 0) stone 20) (wall (0 4) (0 4) stone 90)))
  (eval '(defrobot greyer (greys (3.5 3.5) 0)))
  (with-simulation (greyer)
    (let* ((picture (svg-picture (find-robot 'greyer) :scale 8 :layers '()))
           (fills (loop for element in (append (drawn-with :path picture)
                                               (rest (drawn-with :rect picture)))
                        unless (string= (of-element element :fill) "none")
                          collect (of-element element :fill))))
      (is (= 3 (length (remove-duplicates (mapcar #'lightness fills)))))
      (dolist (fill fills)
        (is (> 48 (- (apply #'max (parts fill)) (apply #'min (parts fill))))
            "~A is nearly a grey" fill)))))

(test manual-b.the-robot-is-a-circle-with-an-arrowhead
  "B: the robot is a circle, where it is; the arrowhead in it points towards its direction."
  (in-museum ()
    (loop for (x y angle) in '((7.5 6.5 0) (6 9 1.5) (5.25 2.75 -2.5) (12 6 3.14))
          do (place-robot guide x y angle)
             (let* ((picture (picture :layers '())) (circle (first (drawn-with :ellipse picture)))
                    (points (of-element (first (drawn-with :polygon picture)) :points))
                    (comma (position #\, points))
                    (tip-x (value-of (subseq points 0 comma)))
                    (tip-y (value-of (subseq points (1+ comma) (position #\Space points)))))
               (is (near (* 8 x) (of-element circle :cx) .51))
               (is (near (* 8 y) (of-element circle :cy) .51))
               (is (near 0 (angle-difference angle (atan2 (- tip-y (* 8 y)) (- tip-x (* 8 x))))
                         .15))
               (is (< (abs (- tip-x (* 8 x))) (of-element circle :rx)))))))

(defun camera-lines (picture)
  "Return the directions of the short lines, of width 2, on PICTURE, as angles."
  (loop for line in (drawn-with :path picture :stroke-width 2)
        for (x y end-x end-y) = (with-input-from-string (in (substitute-if
                                                             #\Space
                                                             (lambda (char) (find char "ML,"))
                                                             (of-element line :d)))
                                  (loop repeat 4 collect (read in)))
        collect (atan2 (- end-y y) (- end-x x))))

(test manual-b.small-lines-are-the-cameras-directions
  "B: small radial lines show the directions of the robot's cameras."
  (in-museum ()
    (answer 'camera-turn (robot-camera guide 1) 1.2)
    (loop for heading in '(0 .5 2)
          do (place-robot guide 7.5 6.5 heading)
             (let ((lines (camera-lines (picture))))
               (is (= 2 (length lines)))
               (is (near 0 (angle-difference heading (first lines)) .02))
               (is (near 0 (angle-difference (+ heading 1.2) (second lines)) .02))))))

(test manual-b.things-are-small-vertical-lines
  "B: objects are small vertical lines, where they are."
  (in-museum ()
    (dolist (name '(bust urn coin))
      (let* ((thing (find-thing name))
             (line (first (drawn-with :rect (picture :in-color nil :layers '()) :fill "#000000"
                                      :x (1- (* 8 (thing-x thing)))
                                      :y (- (* 8 (thing-y thing)) 3) :width 2 :height 6))))
        (is-true line "~A" name)))))

(test manual-b.things-are-told-apart-by-colour
  "B: in colour, objects have the colour of their :color. (There they are shapes, which is ours.)"
  (in-museum ()
    (flet ((shown (name shades)
             (let ((thing (find-thing name)))
               (find-if (lambda (element)
                          (and (near (* 8 (thing-x thing)) (of-element element :cx) .51)
                               (near (* 8 (thing-y thing)) (of-element element :cy) .51)))
                        (drawn-with :ellipse (picture) :fill (web (vref shades 9)))))))
      (loop for (name shades) in `((bust ,red*) (urn ,blue*) (coin ,green*))
            do (is-true (shown name shades) "~A" name))
      (set-attribute (find-thing 'coin) :color 'violet)
      (is-true (shown 'coin violet*)))))

(defun cells-filled (color)
  "Return the cells that the picture fills with COLOR, as (x y)."
  (loop for element in (drawn-with :rect (picture) :fill (web color) :width 8 :height 8)
        collect (list (/ (of-element element :x) 8) (/ (of-element element :y) 8))))

(test manual-b.places-are-cells-of-a-colour
  "B: convex corners are pink, concave ones light pink, doorways light blue, beaks violet."
  (in-museum ()
    (let ((cells (loop for y below 14
                       append (loop for x below 20
                                    for place = (cell-type (map-cell museum x y))
                                    when place
                                      collect (list (place-type-name (place-type place)) x y)))))
      (loop for (name color) in `((convex ,(vref lightred* 9)) (concave ,(vref lightred* 11))
                                  (doorway ,(vref lightblue* 9)) (beak ,(vref violet* 11)))
            for there = (loop for (type x y) in cells when (eq type name) collect (list x y))
            do (is-true there "~A" name)
               (is (equal there (cells-filled color)) "~A" name)))))

(test manual-b.places-are-symbols-without-colour
  "B, readings 68 and 209: a small circle is a convex corner, a dot a concave one or a beak, a
square a doorway."
  (in-museum ()
    (let ((picture (picture :in-color nil)))
      (is-true (drawn-with :rect picture :width 6 :height 6 :fill "none" :x 81.5 :y 49.5))
      (is-true (drawn-with :ellipse picture :rx 1 :fill "#000000" :cx 12 :cy 12) "concave")
      (is-true (drawn-with :ellipse picture :rx 1 :fill "#000000" :cx 28 :cy 28) "beak")
      (is-true (drawn-with :ellipse picture :rx 3.5 :fill "none") "convex"))))

(test manual-b.graphics-scale*-is-pixels-to-a-cell
  "B, reading 208: graphics-scale* is how many pixels a cell's side has; 8 unless set."
  (in-museum ()
    (is (= 8 graphics-scale*))
    (flet ((size (picture)
             (let ((svg (first (elements picture))))
               (list (of-element svg :width) (of-element svg :height)))))
      (is (equal '(160 112) (size (picture))))
      (setf graphics-scale* 5)
      (is (equal '(100 70) (size (svg-picture guide :layers '())))))))

(test manual-b.what-is-carried-is-not-on-the-map
  "B: the world shows what is on the floor; what is held or stowed is on its own display."
  (in-museum ()
    (move-thing (find-thing 'coin) (robot-hand guide 0))
    (is-false (drawn-with :title (picture) :text "COIN#3"))
    (is-true (drawn-with :title (picture) :text "URN#2"))
    (is-true (shows-p "COIN#3" :display :hands))))

;;; Objects in detail.

(defun bin-picture (descriptor)
  "Return a picture of bins, with a thing of DESCRIPTOR in one."
  (with-simulation (guide)
    (make-new-thing 'toy (robot-storage-bin guide 0) descriptor)
    (picture :display :bins)))

(defun in-bin (descriptor)
  "Return the rectangle that a thing of DESCRIPTOR in a bin is drawn as, and its crosses."
  (let ((picture (bin-picture descriptor)))
    (values (second (drawn-with :rect picture)) (drawn-with :path picture))))

(test manual-b.objects-are-rectangles-as-wide-as-large
  "B: by default an object is a rectangle of width proportional to its :size."
  (flet ((width (size)
           ;; An outline of N pixels is written as N - 1.
           (1+ (of-element (in-bin `((:size ,size))) :width))))
    (is (= (* 2 (width 1)) (width 2)))
    (is (= (* 4 (width 2)) (width 8)))
    (is (= (width 1.5) (* 1.5 (width 1))))))

(test manual-b.objects-that-obstruct-movement-are-solid
  "B: a solid rectangle obstructs movement."
  (is (equal "none" (of-element (in-bin '((:size 2))) :fill)))
  (is (equal (web (vref red* 9))
             (of-element (in-bin '((:size 2) (:color red) (:obsmove #t))) :fill))))

(test manual-b.objects-that-obstruct-view-are-crossed
  "B: an X is drawn over what obstructs view."
  (flet ((crosses (descriptor) (length (nth-value 1 (in-bin descriptor)))))
    (is (= 0 (crosses '((:size 2)))))
    (is (= 1 (crosses '((:size 2) (:obsview #t)))))
    (is (= 1 (crosses '((:size 2) (:obsview #t) (:obsmove #t)))))))

(test manual-b.objects-have-the-colour-of-their-attribute
  "B, reading 212: :color decides the colour that an object is drawn with."
  (loop for (color shades) in `((green ,green*) (lightviolet ,lightviolet*) (blue ,blue*))
        do (is-true (drawn-with :rect (bin-picture `((:size 2) (:color ,color)))
                                :stroke (web (vref shades 9))))))

(test manual-b.draw-functions-draw-instead
  "B, reading 211: the value of :draw-function is called with window, object, x, y, width, and
height, where the object is to be drawn in detail."
  (in-museum ()
    (let ((coin (find-thing 'coin)) (calls '()))
      (set-attribute coin :draw-function
                     (lambda (window object x y width height)
                       (push (list object x y width height) calls)
                       (xlib:draw-rectangle window draw-gcontext* x y width height t)))
      (move-thing coin (robot-hand guide 0))
      (let ((picture (picture :display :hands)))
        (destructuring-bind ((object x y width height)) calls
          (is (eq coin object))
          (is-true (drawn-with :rect picture :x x :y y :width width :height height)))
        (is-true (shows-p "COIN#3" :display :hands))))))

;;; The robot.

(test manual-b.state-shows-position-and-direction
  "B: the window Robot state shows the position and direction of the robot."
  (in-museum ()
    (place-robot guide 6 9.25 1.5)
    (is-true (shows-p "6.00, 9.25" :display :state))
    (is-true (shows-p "1.50" :display :state))))

(test manual-b.designators-are-shown-by-what-they-denote
  "B: objects are drawn, of places the type's name is shown, false designators are FALSE."
  (in-museum ()
    (sees 'coin)
    (third (answer 'camera-get-place-designator (robot-camera guide 1) 'convex))
    (setf no-sensor-error* nil false-thing-prob* 1)
    (is (null (first (answer 'camera-get-object-designator (robot-camera guide 0) :non-local
                             '((:size 90))))))
    (is-true (shows-p "COIN#3" :display :designators))
    (is (= 1 (length (drawn-with :rect (picture :display :designators)
                                 :stroke (web (vref green* 9))))))
    (is-true (shows-p "FALSE" :display :designators))
    (destroy-thing (find-thing 'coin))
    (is-false (shows-p "COIN#3" :display :designators) "only current ones")))

(test manual-b.designators-of-places-show-the-type
  "B: place types' names are shown."
  (in-museum ()
    (place-robot guide 7.5 3.5 (/ pi 2))
    (is (null (first (answer 'camera-get-place-designator (robot-camera guide 1) 'concave))))
    (is-true (shows-p "CONCAVE" :display :designators))))

(defun dial (picture)
  "Return the two angles that the first wedge of PICTURE, of cameras, is between."
  (let* ((points (of-element (first (drawn-with :polyline picture)) :points))
         (numbers (with-input-from-string (in (substitute #\Space #\, points))
                    (loop repeat 6 collect (read in)))))
    (destructuring-bind (x0 y0 x y x1 y1) numbers
      (list (atan2 (- y0 y) (- x0 x)) (atan2 (- y1 y) (- x1 x))))))

(test manual-b.cameras-are-wedges
  "B: a camera is a wedge whose direction is that of the camera and whose width is its field of
view."
  (in-museum ()
    (loop for (heading turn) in '((0 0) (.5 0) (1 .75))
          do (place-robot guide 7.5 6.5 heading)
             (unless (zerop turn) (answer 'camera-turn (robot-camera guide 0) turn))
             (destructuring-bind (left right) (dial (picture :display :cameras))
               (is (near (+ heading turn -.5) left .02))
               (is (near (+ heading turn .5) right .02))))))

(test manual-b.cameras-show-their-view
  "B: the first line is the camera's view, as a list of numbers."
  (in-museum ()
    (is-false (shows-p "60.0" :display :cameras))
    (place-robot guide 7.5 3.5 0)
    (let ((view (third (answer 'camera-view (robot-camera guide 0)))))
      (is (equalp '(60 60 60) view))
      (is-true (shows-p "60.0 60.0 60.0" :display :cameras)))))

(defun ticks () (drawn-with :path (picture :display :cameras) :stroke-width 2))

(test manual-b.cameras-that-track-show-what
  "B: while a camera tracks, its estimated direction is a tick in the field of view, and the type,
the estimated distance and the denotation of the designator are shown."
  (in-museum ()
    (is (null (ticks)))
    (let ((coin (sees 'coin)))
      (camera-track (robot-camera guide 0) coin nil)
      (run-ticks 6)
      (is (= 1 (length (ticks))))
      (is-true (shows-p (format nil "non-local ~,1F" (sqrt 10)) :display :cameras))
      (is-true (shows-p "COIN#3" :display :cameras))
      (answer 'camera-untrack (robot-camera guide 0))
      (is (null (ticks)))
      (is-false (shows-p "non-local" :display :cameras)))))

(defun put-camera-into (name)
  "Insert GUIDE's camera 0 into the thing called NAME, which is beside the robot."
  (let ((camera (robot-camera guide 0)) (thing (find-thing name)))
    (place-robot guide (thing-x thing) (thing-y thing) 0)
    (let ((there (third (answer 'camera-get-object-designator camera :local '((:color red))))))
      (camera-track camera there nil)
      (run-ticks 6)
      (first (answer 'camera-insert camera there)))))

(test manual-b.cameras-inside-something-say-so
  "B: if the camera is inside a container, that fact is shown."
  (in-museum ()
    (is-false (shows-p "in " :display :cameras))
    (is (null (put-camera-into 'bust)))
    (is-true (shows-p "in " :display :cameras))
    (is-true (shows-p "BUST#1" :display :cameras))))

(test manual-b.hands-show-contents-and-containment
  "B: each hand shows the object that it grasps, and the container or bin, which is told by number
(reading 202), that it is inside of."
  (in-museum ()
    (is (= 2 (length (drawn-with :text (picture :display :hands) :text "empty"))))
    (move-thing (find-thing 'coin) (robot-hand guide 0))
    (is-true (shows-p "COIN#3" :display :hands))
    (is (null (first (answer 'hand-insert-bin (robot-hand guide 1) (robot-storage-bin guide 1)))))
    (is-true (shows-p "in Storage-bin 1" :display :hands))))

(test manual-b.bins-show-closure-and-contents
  "B: whether each bin is open or closed is said in words; its contents are a list of objects. Robot
parts inside are not shown."
  (in-museum ()
    (let ((bin (robot-storage-bin guide 0)))
      (move-thing (find-thing 'coin) bin)
      (move-thing (find-thing 'bust) bin)
      (is-true (and (shows-p "COIN#3" :display :bins) (shows-p "BUST#1" :display :bins)))
      (is (null (first (answer 'storage-bin-close bin))))
      (is-true (and (shows-p "0: closed" :display :bins) (shows-p "1: open" :display :bins)))
      (answer 'hand-insert-bin (robot-hand guide 0) (robot-storage-bin guide 1))
      (is-false (or (shows-p "Hand" :display :bins) (shows-p "hand" :display :bins))))))
