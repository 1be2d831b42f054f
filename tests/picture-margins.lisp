;;;; picture-margins.lisp -- what is drawn around a map in a picture, and its size.

(in-package :ars-magna.tests)

(in-suite display)

(test margins.of-a-view-lie-at-its-edges
  "A view of 160 x 120 pixels that begins at (80,40), 16 pixels to a metre. The number at its right
end is there as well, and whole."
  (let* ((map (world::small-map 40 30 (constantly nil)))
         (elements (elements (format nil "~{~A~}"
                                     (drawing (canvas)
                                       (let ((canvas:graphics-scale* 16))
                                         (display:draw-view-margins
                                          canvas map '(:coordinates :scale-bar)
                                          80 40 160 120))))))
         (texts (remove :text elements :key #'first :test-not #'eq))
         (strips (remove :rect elements :key #'first :test-not #'eq)))
    (is (equal '("10" "15" "5" "5 m")
               (mapcar (lambda (text) (of-element text :text)) texts)))
    ;; From end to end, but for the corners.
    (is (equal '((80 40 160 17) (80 57 25 79) (80 136 160 24))
               (loop for strip in strips
                     collect (loop for key in '(:x :y :width :height)
                                   collect (of-element strip key)))))
    (dolist (text texts)
      (is (<= 76 (of-element text :x)
              (- 240 (display::monospaced-width (of-element text :text)))))
      (is (<= 40 (of-element text :y) 160)))))

(defun words-in-picture (robot &rest options)
  (mapcar (lambda (text) (of-element text :text))
          (drawn-with :text (apply #'display:svg-picture robot options))))

(test margins.legend-names-what-is-there
  (in-studio (robot)
    (let ((words (words-in-picture robot)))
      (dolist (word '("studio-robot" "bricks 10" "wood 50" "doorway" "concave" "box" "pen"
                      "blocks the way" "lets one pass" "studio-robot in studio, tick 0"))
        (is (member word words :test #'string=) "~A" word))
      (dolist (word '("convex" "moves by itself" "container" "blocks the view"))
        (is (not (member word words :test #'string=)) "~A" word)))))

(test margins.legend-counts-things-that-are-called-the-same
  (in-studio (robot)
    (loop for x from 7 to 9 do (world:make-new-thing 'cup (list (robot:robot-world robot) x 8) '()))
    (is-true (find "cup (3)" (words-in-picture robot) :test #'string=))))

(test margins.scale-bar-and-coordinates-are-in-metres
  (in-studio (robot)
    (let ((words (words-in-picture robot :scale 8 :layers '(:coordinates :scale-bar))))
      (is (member "10 m" words :test #'string=))
      (is (equal '("0" "5" "10" "15" "20" "0" "5" "10") (butlast words))))))

(test margins.the-bare-map-has-none
  (in-studio (robot)
    (is (null (words-in-picture robot :layers '())))))

(test margins.legends-do-not-shrink-the-map-and-cut-long-names
  (with-own-definitions
    (eval '(world:defmap named (30 20)
            (obj a-name-that-goes-on-and-on-beyond-what-one-would-call-a-name-at-all (5.5 5.5)
             ((:size 2)))
            (obj |Kettle| (8.5 9.5) ((:size 2)))))
    (eval '(robot:defrobot namer (named (15.5 15.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (let* ((robot (first (run:simulation-robots)))
              (snapshot (display:snapshot-of robot))
              (text (display:svg-picture robot)))
         (is (= (display::suitable-scale nil snapshot '(:title))
                (display::suitable-scale nil snapshot '(:title :legend))))
         (is-true (has-words-p text ">a-name-that-goes-on-a...<" ">Kettle<"
                               "<title>a-name-that-goes-on-and-on-beyond"))))
     '(namer))))

(test margins.text-grows-with-the-scale
  (in-studio (robot)
    (flet ((width (scale) (svg-magnification (display:svg-picture robot :scale scale))))
      (is (= 2 (width 80)))
      (is (= 1 (width 40) (width 20) (width 8))))))

(test picture.of-ways-and-runs-is-magnified-as-others-are
  (in-studio (robot)
    (run:run-ticks 2)
    (dolist (save (list (lambda (file)
                          (display:save-way-picture 'studio '(((1 1) (2 2))) file :scale 80))
                        (lambda (file) (ars:save-run-picture file :scale 80))
                        (lambda (file) (display:save-animation nil file :scale 80))))
      (with-scratch-file (file "svg")
        (funcall save file)
        (is (= 2 (svg-magnification (uiop:read-file-string file))))))))

(defun svg-magnification (text)
  "Return how much larger than drawn the SVG document TEXT is to be shown."
  (/ (parse-integer text :start (+ 7 (search "width=\"" text)) :junk-allowed t)
     (svg-view-width text)))

(defun svg-view-width (text)
  "Return how wide the SVG document TEXT says that what it shows is."
  (parse-integer text :start (+ 13 (search "viewBox=\"0 0 " text)) :junk-allowed t))

(test margins.titles-of-small-maps-are-whole
  (with-own-definitions
    (eval '(world:defmap cell-of-one (1 1)))
    (eval '(robot:defrobot hermit (cell-of-one (0.5 0.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (is (< (* 7 (length "hermit in cell-of-one, tick 0"))
              (svg-view-width (display:svg-picture (first (run:simulation-robots))
                                                   :layers '(:title :coordinates))))))
     '(hermit))))

(test margins.long-titles-have-more-lines-and-leave-the-page-as-wide-as-it-is
  (in-studio (robot)
    (let* ((words (loop repeat 30 collect "a-title"))
           (title (format nil "~{~A~^ ~}" words))
           (short (display:svg-picture robot :title "short"))
           (long (display:svg-picture robot :title title))
           (lines (remove nil (drawn-with :text long)
                          :key (lambda (text) (of-element text :font-weight)))))
      (is (= (svg-view-width short) (svg-view-width long)))
      (is (< 1 (length lines)))
      (is (equal words (loop for line in lines
                             append (uiop:split-string (of-element line :text)))))
      (is (apply #'< (mapcar (lambda (line) (of-element line :y)) lines)))
      (is-true (has-words-p (display:svg-picture robot :title "<&\"") ">&lt;&amp;"))))
  (with-own-definitions
    (eval '(world:defmap cell-of-one (1 1)))
    (eval '(robot:defrobot hermit (cell-of-one (0.5 0.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (is (> 500 (svg-view-width (display:svg-picture
                                   (first (run:simulation-robots))
                                   :title (make-string 200 :initial-element #\x))))))
     '(hermit))))

(test margins.legend-has-an-entry-for-places-that-look-the-same
  "Without colours the manual has one mark for concave corners and beaks."
  (with-own-definitions
    (eval '(world:defmap beaked (12 9)
            (rect (0 0) (11 8) bricks 1) (wall (6 1) (6 4) bricks 1)))
    (eval '(robot:defrobot pecker (beaked (2.5 2.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (flet ((has-p (word &rest options)
                (member word (apply #'words-in-picture (first (run:simulation-robots)) options)
                        :test #'string=)))
         (is-true (has-p "concave"))
         (is-true (has-p "beak"))
         (is-true (has-p "concave, beak" :in-color nil))
         (is (null (has-p "beak" :in-color nil)))))
     '(pecker))))

(test names.keep-apart
  "Two names on one line are not read as one, and none lies on the mark of a place if there is other
room."
  (in-studio (robot)
    (let* ((snapshot (display:snapshot-of robot)) (canvas:graphics-scale* 8)
           (boxes '((20 20 60 31) (40 40 80 51))))
      (is (equal (second boxes)
                 (display::best-box snapshot '() boxes
                                    (display::index-boxes
                                     (list (display::widen-box '(-26 20 15 31) 6))))))
      (flet ((best (layers &rest boxes)
               (display::best-box snapshot layers boxes (display::index-boxes '()))))
        (is (equal '(40 40 80 51) (best '(:places) '(8 8 20 19) '(40 40 80 51))))
        (is (equal '(8 8 20 19) (best '() '(8 8 20 19) '(40 40 80 51))))
        (is (equal '(8 8 20 19) (best '(:places) '(70 12 110 23) '(8 8 20 19))))))))

(test names.of-things-in-the-corners-of-a-room-are-written
  "Though a corner is a place, which has a mark."
  (with-own-definitions
    (eval '(world:defmap cornered (8 6)
            (rect (0 0) (7 5) bricks 1) (obj broom (1.5 1.5) ()) (obj vase (6.5 4.5) ())))
    (eval '(robot:defrobot sweeper (cornered (3.5 3.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (is-true (has-words-p (display:svg-picture (first (run:simulation-robots))
                                                  :layers '(:names :places))
                             ">sweeper</text>" ">broom</text>" ">vase</text>")))
     '(sweeper))))

(test names.are-written-on-a-wall-where-there-is-no-other-room
  "Of a thing in a niche the name is too long for; what is free comes first, along the thing, too."
  (in-studio (robot)
    (let ((snapshot (display:snapshot-of robot)) (canvas:graphics-scale* 8))
      (flet ((best (&rest boxes) (display::best-box snapshot '() boxes (display::index-boxes '()))))
        (is (equal '(70 12 110 23) (best '(70 12 110 23))))
        (is (equal '(20 40 60 51) (best '(70 12 110 23) '(20 40 60 51))))))
    (is (find '(97 84 137 95) (display::candidate-name-boxes 100 100 3 40) :test #'equal))))

(test names.of-robots-are-written-on-thin-walls-if-need-be
  "Those of things are left out there."
  (in-studio (robot)
    (let ((snapshot (display:snapshot-of robot)) (canvas:graphics-scale* 3) (box '(6 0 26 11)))
      (flet ((best (taken &rest options)
               (apply #'display::best-box snapshot '() (list box) (display::index-boxes taken)
                      options)))
        (is (null (best '())))
        (is (equal box (best '() :anywhere-p t)))
        (is (null (best (list box) :anywhere-p t)))))))

(test names.of-robots-on-one-spot-are-beside-each-other
  (run:with-simulation ((ars-worlds:marvin ars-worlds:gofer) :seed 1 :ghosts t)
    (dolist (robot (run:simulation-robots)) (robot:place-robot robot 60.5 38.5 0))
    (is-true (has-words-p (display:svg-picture ars-worlds:marvin) ">marvin<" ">gofer<"))))

(test margins.trails-have-an-entry
  (flet ((entries (trail)
           (mapcar #'display::entry-text
                   (display::line-entries (trail-snapshot trail) '(:trail :odometer)))))
    (is (equal '("trail") (entries '(1 1 50 0 2 1 49 0))))
    (is (null (entries '(1 1 50 0))))))

(defun trail-snapshot (trail)
  "Return a snapshot of a robot with TRAIL, a list x y tick placements ...."
  (display::make-snapshot :part '(0 0 9 9)
                          :robots (list (display::make-robot-image :trail trail))))

(test names.are-rather-not-on-trails
  (let ((snapshot (trail-snapshot '(1 1 50 0 2 1 49 0))) (canvas:graphics-scale* 8))
    (is-true (display::on-trail-p snapshot '(14 6 18 10)))
    (is (null (display::on-trail-p snapshot '(6 390 10 394))))
    (is (null (display::on-trail-p snapshot '(398 14 402 18))))))

;;; Scales that are none.

(test scale.that-is-none-is-misuse-of-every-picture-that-names-the-remedy
  (in-studio (robot)
    (uiop:with-temporary-file (:pathname file :type "svg")
      (dolist (canvas:graphics-scale* '(0 -1 "x" nil 1000))
        (dolist (drawing (list (lambda () (display:svg-picture robot))
                               (lambda () (display:save-way-picture 'studio '(((1 1) (2 2)))
                                                                    file))))
          (handler-case (progn (funcall drawing) (fail "~S" canvas:graphics-scale*))
            (base:misuse (trouble)
              (is-true (has-words-p (princ-to-string trouble) "graphics-scale*"
                                    "from 1 to 256" "With 8")))))))))

(test margins.every-picture-of-a-shipped-size-fits
  "Up to 200 x 150 cells a picture is no larger than 900 x 700."
  (loop for (width height) in '((12 12) (40 30) (75 75) (120 80) (24 18) (200 150) (10 80))
        for map = (world::small-map width height (constantly nil))
        for scale = (display::suitable-scale nil (display::make-snapshot :map map) '(:title))
        do (is (<= 4 scale 40))
           (is (<= (* scale width) 900))
           (is (<= (* scale height) 700))))

(test pictures.no-legend-stands-on-the-scale-bar-of-a-narrow-map
  (with-own-definitions
    (eval '(world:defmap cubbyhole (1 1) (obj speck (0.5 0.5) ((:size 1)))))
    (eval '(robot:defrobot dweller (cubbyhole (0.5 0.5) 0)))
    (run::call-with-simulation
     (lambda ()
       (let* ((canvas:graphics-scale* 4)
              (snapshot (display:snapshot-of (robot:find-robot 'dweller)))
              (bar (display::scale-bar-width 1))
              (entries (display::legend-entries snapshot '())))
         (is (< 4 bar))
         (loop for (layers edge) in `(((:scale-bar :legend) ,bar) ((:legend) 4))
               for arrangement = (display::smallest-arrangement snapshot layers entries)
               do (is (< edge (display::arrangement-legend-left arrangement) (+ edge 20)))
                  (is (<= (+ edge (display::columns-width
                                   (display::arrangement-columns arrangement)))
                          (display::arrangement-width arrangement))))))
     (list 'dweller))))
