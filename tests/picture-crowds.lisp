;;;; picture-crowds.lisp -- pictures with many robots, of very small maps, and of ways with arrows.

(in-package :ars-magna.tests)

(in-suite display)

(defun call-with-crowd (function places width height)
  "Call FUNCTION with a snapshot of robots at PLACES, lists (x y), on a bare map of WIDTH by HEIGHT
cells, where a cell has 20 pixels."
  (let ((canvas:graphics-scale* 20))
    (funcall function
             (display::make-snapshot
              :map (world::small-map width height (constantly nil))
              :robots (loop for (x y) in places for number from 1
                            collect (display::make-robot-image
                                     :name (intern (format nil "ROBOT-~D" number) :keyword)
                                     :x x :y y))))))

(defparameter *crowd* '((5 5) (5.6 5.2) (6.3 5) (5.4 5.9) (6.1 5.9) (5.8 4.4) (9 9) (9.7 9.3) (2 8))
  "Places of nine robots, of which eight are in each other's way.")

(defun crowd-names (snapshot)
  "Return lists (x y text) of the names in a picture of SNAPSHOT and, as the second value, the ends
of the lines that lead to names, x y x y each."
  (let* ((text (format nil "~{~A~}" (drawing (canvas)
                                      (let ((canvas:graphics-scale* 20))
                                        (display::draw-names canvas snapshot '(:names))))))
         (lines (drawn-with :path text :stroke (web canvas:black*))))
    (values (loop for name in (drawn-with :text text)
                  collect (list (of-element name :x) (of-element name :y) (of-element name :text)))
            (length lines))))

(test names.of-all-robots-of-a-crowd-are-written
  "Beside their robots, or at the end of a line that leads there."
  (call-with-crowd (lambda (snapshot)
                     (multiple-value-bind (names lines) (crowd-names snapshot)
                       (is (= 9 (length names)))
                       (is (<= 1 lines 6))))
                   *crowd* 14 14))

(test names.without-a-line-are-nearer-to-their-robots-than-to-others
  (call-with-crowd
   (lambda (snapshot)
     (let* ((robots (display:snapshot-robots snapshot))
            (spots (loop for robot in robots collect (display::robot-label-target robot robots)))
            (spot (first spots))
            (rivals (display::confusable-label-targets spot spots
                                                       200)) (taken (display::index-boxes '())))
       (destructuring-bind (x y) (display::points-to-pixels '(5 5))
         (is-true (display::unambiguous-name-box-p spot (list (- x 60) (- y 5) (- x 20) (+ y 5))
                                                   rivals))
         (is (not (display::unambiguous-name-box-p spot (list (+ x 34) (- y 5) (+ x 80) (+ y 5))
                                                   rivals)))
         (flet ((clear-p (box) (display::leader-clear-p spot box taken rivals)))
           (is (not (clear-p (list (+ x 70) y (+ x 99) (+ y 11)))))
           (is-true (clear-p (list (- x 99) y (- x 70) (+ y 11))))))))
   *crowd* 14 14))

(test names.of-robots-stand-close-beside-them
  (call-with-crowd (lambda (snapshot)
                     (multiple-value-bind (names lines) (crowd-names snapshot)
                       (is (zerop lines))
                       (is (<= (+ 100 (display:robot-radius)) (first (first names))
                               (+ 100 (display:robot-radius) 6)))))
                   '((5 5)) 14 14))

(defun name-drawn (text robot scale)
  "Return the element that TEXT is in a picture of the world of ROBOT, or NIL."
  (find text (drawn-with :text (plain-picture robot :scale scale :layers '(:names)))
        :key (lambda (element) (of-element element :text)) :test #'equal))

(test names.of-robots-are-not-taken-for-those-of-things
  "Not on the far side of a thing that stands beside the robot."
  (in-studio (robot)
    (robot:place-robot robot 5.5 6.5 0)
    (let* ((snapshot (display:snapshot-of robot)) (canvas:graphics-scale* 20)
           (spot (first (display::label-targets snapshot)))
           (thing (display::make-label-target "pen" 135 130 8)))
      (flet ((own-p (box) (display::unambiguous-name-box-p spot box (list thing))))
        (is-true (own-p '(50 125 90 136)))
        (is (not (own-p '(146 125 190 136))))))))

(test names.of-things-beside-a-robot-are-written
  "At the end of a line, if there is no room right beside them."
  (in-studio (robot)
    (robot:place-robot robot 6.5 6.5 0)
    (dolist (scale '(8 12 20 28))
      (loop for (x y) in '((5.8 7.2) (6.5 7.1) (7.2 5.9))
            do (world:move-thing (world:find-thing 'pen) x y)
               (is-true (name-drawn "pen" robot scale) "~A, ~A at ~A" x y scale)
               (is-true (name-drawn "studio-robot" robot scale))))))

(test robots.have-their-colours-in-parts-of-a-map-too
  "The second robot is drawn alike where the first is not to be seen."
  (run:with-simulation ((ars-worlds:marvin ars-worlds:gofer) :seed 3 :ghosts t)
    (let ((gofer (second (run:simulation-robots))))
      (dolist (robot (run:simulation-robots)) (robot:place-robot robot 20.5 20.5 0))
      (robot:place-robot gofer 60.5 38.5 0)
      (is-true (drawn-with :ellipse (plain-picture gofer :part '(50 30 70 45))
                           :stroke (web (display:nth-ink 1)))))))

(test robots.are-whole-on-a-map-of-one-cell
  (with-own-definitions
    (eval '(world:defmap cupboard (1 1)))
    (eval '(robot:defrobot lodger (cupboard (0.5 0.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (let ((ring (first (drawn-with :ellipse (display:svg-picture (robot:find-robot 'lodger)
                                                                    :layers '(:title))
                                      :stroke (web (display:nth-ink 0))))))
         (is (= 20 (of-element ring :rx)))
         (is (< (* 2 (of-element ring :rx)) (+ 40 (* 2 display::+robot-overhang+))))))
     '(lodger))))

(test robots.alone-reach-beyond-the-edges-of-the-map
  "What odometers say is cut off there, so that it does not cross numbers in the margins."
  (let* ((canvas:graphics-scale* 20)
         (odometer (display::make-odometer-image :x 0.5 :y 0.5 :width 9 :height 9))
         (snapshot (display::make-snapshot
                    :map (world::small-map 2 2 (constantly nil))
                    :robots (list (display::make-robot-image :name :edgar :x 0.5 :y 0.5
                                                             :odometer odometer))))
         (text (format nil "~{~A~}" (drawing (canvas)
                                      (let ((canvas:graphics-scale* 20))
                                        (display:draw-movers canvas snapshot '(:odometer))))))
         (clipped (first (drawn-with :svg text))))
    (is (= 0 (of-element clipped :x)))
    (is (= 40 (of-element clipped :width)))
    (is (search "<ellipse" text :start2 (search "</svg>" text)))))

(test things.in-walls-are-seen-without-colours
  "The small line of the manual's figure has a white halo."
  (destructuring-bind (halo line)
      (drawing (canvas)
        (let ((canvas:graphics-scale* 8)) (display::draw-thing-as-line canvas 20 20)))
    (is (mentions-p halo (web canvas:white*)))
    (is (mentions-p line (web canvas:black*)))))

;;; Arrowheads on ways.

(test ways.have-arrowheads-in-their-direction-and-few
  (flet ((arrows (&rest points) (display::arrows-along points)))
    (is (equalp '((50 0 0)) (arrows 0 0 100 0)))
    (is (near pi (third (first (arrows 100 0 0 0))) 1d-6))
    (is (null (arrows 0 0 10 0)))
    (is (null (arrows 5 5 5 5)))
    (is (null (arrows 5 5)))
    (is (= 10 (length (arrows 0 0 0 0 900 0))))
    (is (near (/ pi 2) (third (second (arrows 0 0 90 0 90 90))) .01))))

(test ways.that-lead-back-have-arrowheads-beside-each-other
  (destructuring-bind ((x y angle) (back-x back-y back-angle)) (display::arrows-along
                                                                '(0 0 100 0 0 0))
    (is (< 9 (abs (- back-x x))))
    (is (near 0 y 1d-6))
    (is (near 0 back-y 1d-6))
    (is (near 0 angle 1d-6))
    (is (near pi (abs back-angle) 1d-6))))

(test way-picture.shows-which-way-a-way-leads
  (uiop:with-temporary-file (:pathname file :type "svg")
    (dolist (color-p '(t nil))
      (display:save-way-picture 'ars-worlds:tiny '(((2 2) (8 2)) ((2 8) (8 8))) file
                                :in-color color-p :layers '())
      (let ((picture (uiop:read-file-string file)))
        (dolist (position '(0 1))
          (is (<= 2 (length (drawn-with :polygon picture
                                        :fill (web (if color-p
                                                       (display:nth-ink position)
                                                       canvas:black*)))))))))))

;;; Titles.

(test film.title-has-robots-as-far-as-there-is-room-and-the-map
  (let ((names '("ada" "ben" "cleo" "dora" "emil" "fay" "gus" "hal" "ida")))
    (is (string= "ada, ben, cleo, dora, emil, fay and 3 more in study"
                 (display::robots-and-map-title names 'study)))
    (is (string= "ada in study" (display::robots-and-map-title '("ada") 'study))))
  (in-studio (robot)
    (is (mentions-p (film-of robot #'ungrasp-nothing) "<title>studio-robot in studio, tick"))))

(defun names-with-a-pile (&rest sizes)
  "Return the texts in a picture of a world where things of SIZES, A, B ..., are in one place."
  (in-studio (robot)
    (loop for size in sizes for name in '(a b c d)
          do (world:make-new-thing name (list (robot:robot-world robot) 9 8)
                                   `((:size ,size) (:weight 1))))
    (mapcar (lambda (text) (of-element text :text))
            (drawn-with :text (display:svg-picture robot :layers '(:names))))))

(test names.of-what-lies-on-another-are-written
  (let ((names (names-with-a-pile 40 2)))
    (is (member "a" names :test #'equal))
    (is (member "b" names :test #'equal))))

(test names.of-a-pile-say-what-is-seen-and-how-many-are-not
  (let ((names (names-with-a-pile 2 2 2 2)))
    (is (member "d and 3 more" names :test #'equal))
    (is (not (member "a" names :test #'equal)))))

(defun rolled-box (dice)
  "Return a box that DICE roll, some of them large, some of none's width."
  (flet ((roll (limit) (abs (base:roll-within limit dice))))
    (let ((x (- (roll 900) 50)) (y (roll 700)))
      (list x y (+ x (roll (if (< (roll 10) 1) 3000 90))) (+ y (roll 40))))))

(test boxes.in-an-index-are-found-as-by-a-look-at-all
  (let* ((dice (base:make-dice 6 "boxes"))
         (boxes (list* '(-9000 -9000 9000 9000) (loop repeat 300 collect (rolled-box dice))))
         (index (display::index-boxes boxes)))
    (loop repeat 200
          for box = (rolled-box dice)
          for found = (display::overlapping-items box index)
          do (is (null (set-exclusive-or
                        found
                        (remove-if-not (lambda (other) (display::overlap-p box other)) boxes)))))))

(test boxes.far-from-each-other-are-not-compared
  "So a picture of many things takes no longer for each than one of few."
  (let ((index (display::index-boxes (loop for x below 4000 by 40
                                           append (loop for y below 4000 by 40
                                                        collect (display::box-around x y 5))))))
    (is (null (display::box-index-large index)))
    (is (<= (loop for entries being the hash-values of (display::box-index-squares index)
                  maximize (length entries))
            4))))

(test names.of-a-pile-say-how-many-are-hidden
  (in-studio (robot)
    (let* ((coin (world:make-new-thing 'coin (list (robot:robot-world robot) 3.5 4.5)
                                       '((:size 1))))
           (images (loop repeat 5000
                         collect (display::make-thing-image :thing coin :x 3.5d0 :y 4.5d0))))
      (is (equal '("coin and 4999 more")
                 (mapcar #'display::label-target-name (display::thing-label-targets images)))))))
