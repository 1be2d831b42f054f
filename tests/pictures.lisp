;;;; pictures.lisp -- what pictures show of things and layers, and their names.

(in-package :ars-magna.tests)

(in-suite display)

(defun image-with (&rest attributes)
  "Return the image of a thing that has ATTRIBUTES, slots of images."
  (apply #'display::make-thing-image attributes))

(defun drawn-shape (&rest attributes)
  "Return the elements that the thing with ATTRIBUTES is drawn as on a map."
  (drawing (canvas)
    (display::draw-thing-sample canvas (apply #'image-with attributes) 20 20 10)))

;;; Things.

(test things.shapes-say-what-they-do
  (flet ((shape (&rest attributes) (display::thing-shape (apply #'image-with attributes))))
    (is (eq :round (shape)))
    (is (eq :square (shape :obsmove-p t)))
    (is (eq :diamond (shape :moving-p t)))
    (is (eq :house (shape :moving-p t :obsmove-p t))))
  (is (every (lambda (part) (mentions-p part "<ellipse")) (drawn-shape)))
  (is (every (lambda (part) (mentions-p part "<rect")) (drawn-shape :obsmove-p t)))
  (is (every (lambda (part) (mentions-p part "<polygon")) (drawn-shape :moving-p t))))

(test things.containers-have-a-rim-and-what-obstructs-view-a-cross
  (is (= 3 (length (drawn-shape))))
  (is (= 4 (length (drawn-shape :container-p t))))
  (is (mentions-p (fourth (drawn-shape :container-p t)) "fill=\"none\""))
  (is (mentions-p (fourth (drawn-shape :obsview-p t)) "<path d=\"M")))

(test things.grow-with-the-square-root-of-their-size
  "From 5 pixels for nothing, to a cell and a half."
  (dolist (scale '(4 14 40))
    (let ((canvas:graphics-scale* scale))
      (flet ((more (size) (- (display::thing-half-width (image-with :size size)) 5/2)))
        (is (= (* 2 (more 4)) (more 16)))
        (is (= (* 2 (more 16)) (more 64)))
        (is (< 0 (more 0.01d0) (more 1) (more 2)))
        (is (= (more 64) (more 1000))))))
  (let ((canvas:graphics-scale* 40))
    (is (= 30 (display::thing-half-width (image-with :size 64))))))

(test things.the-small-lie-above-the-large-and-all-above-the-robot
  (in-studio (robot)
    (world:move-thing (world:find-thing 'pen) 3.5 4.5)
    (world:set-attribute (world:find-thing 'pen) :size 0.1)
    (let ((picture (plain-picture robot :layers '())))
      (is (< (search "STUDIO-ROBOT" picture) (search "BOX#1" picture) (search "PEN#2" picture))))))

(test things.that-move-by-themselves-have-a-ring-in-the-layer-reach
  (in-studio (robot)
    (flet ((rings () (drawn-with :ellipse (plain-picture robot :layers '(:reach))
                                 :stroke (web (display::layer-ink :reach)))))
      (is (null (rings)))
      (world:put-kicker stir (pen (world:find-thing 'pen)) (:prob 0.1) pen)
      (is (= 1 (length (rings)))))))

;;; Layers.

(defun legend-of (robot layer &rest options)
  "Return a picture of the world of ROBOT with only LAYER and a legend, as text."
  (apply #'display:svg-picture robot :layers (list layer :legend) options))

(test legend.tells-what-moves-where-no-robot-is-shown
  (in-studio (robot)
    (world:put-kicker stir (pen (world:find-thing 'pen)) (:prob 0.1) pen)
    (multiple-value-bind (x y) (world:thing-position (world:find-thing 'pen))
      (let ((part (list (floor x) (floor y) (1+ (floor x)) (1+ (floor y)))))
        (is-true (mentions-p (legend-of robot :reach :part part) ">may move<"))))))

(test legend.has-no-field-of-view-of-a-camera-that-is-in-something
  (in-studio (robot)
    (flet ((entries (location)
             (mapcar #'display::entry-text
                     (display::line-entries
                      (display::make-snapshot
                       :robots (list (display::make-robot-image
                                      :cameras (list (display::make-camera-image
                                                      :location location)))))
                      '(:wedges)))))
      (is (equal '("in view") (entries nil)))
      (is (null (entries "in a box"))))))

(test legend.planned-ways-of-one-point-are-not-drawn-and-have-no-entry
  (flet ((entries (way)
           (display::line-entries
            (display::make-snapshot
             :robots (list (display::make-robot-image :planned-way way)))
            '(:planned-way))))
    (is (null (entries '((1 1)))))
    (is (= 1 (length (entries '((1 1) (2 1))))))))

(defun draw-range (canvas metres robot snapshot)
  "Draw METRES that a sensor of ROBOT reads, as a line to the right."
  (declare (ignore snapshot))
  (let ((x (display:robot-image-x robot)) (y (display:robot-image-y robot)))
    (display:with-halo ((display::layer-ink :sonar) :dashes (display::layer-dashes :sonar))
      (canvas:draw-segments canvas canvas:draw-gcontext*
                            (display:points-to-pixels (list x y (+ x metres) y))))))

(defun range-marks (view robot)
  (display::glyph-mark-at view (+ 1 (display:robot-image-x robot)) (display:robot-image-y robot)
                          (display::make-glyph :layer #\~ "sonar")))

(defmacro with-range-layer (() &body body)
  "Run BODY while there is a layer :RANGES, of a sensor that reads 2 metres."
  `(let ((display::*layers* display::*layers*)
         (display:*picture-layers* display:*picture-layers*))
     (unwind-protect
          (progn
            (display:define-layer :sonar "Sonar" "What the sonar reads."
              :default-p t :note (constantly 2) :draw 'draw-range
              :ink #x0A4468 :dashes '(8 2) :legend "sonar"
              :text-name :echo :text 'range-marks)
            ,@body)
       (display::document-layers))))

(test layers.one-form-brings-a-new-one-into-pictures-legends-text-maps-and-help
  (with-range-layer ()
    (in-studio (robot)
      (is-true (has-words-p (display:svg-picture robot) (web-dashes '(8 2)) ">sonar<"))
      (is (not (mentions-p (display:svg-picture robot :layers '(:legend)) ">sonar<")))
      (is-true (has-words-p (display:text-map robot :layers '(:echo)) "~ sonar"))
      (is-true (has-words-p (documentation 'display:*picture-layers* 'variable)
                            ":SONAR *" "An addition to the manual."))
      (is (equal '(:sonar :echo "SONAR or ECHO" "RANGES")
                 (list (display:picture-layer-name :echo) (display:text-layer-name :sonar)
                       (display:layer-prompt-text :sonar)
                       (display:layer-prompt-text :ranges)))))))

(test layers.what-they-note-changes-what-displays-show
  "A window draws anew where a note is another one."
  (let ((images (loop for note in '(2 2 3)
                      collect (display::make-robot-image :notes (list :ranges note)))))
    (destructuring-bind (two other-two three)
        (loop for image in images
              collect (display:snapshot-content (display::make-snapshot :robots (list image))))
      (is (equal two other-two))
      (is (not (equal two three))))))

(test layers.each-has-a-title-and-a-sentence
  (dolist (layer (display:picture-layers))
    (is (plusp (length (display:layer-title layer))))
    (is (char= #\. (char (reverse (display::%layer-sentence (display::find-layer layer))) 0)))
    (is (mentions-p (documentation 'display:*picture-layers* 'variable)
                    (display:layer-title layer))))
  (is (subsetp display:*picture-layers* (display:picture-layers)))
  (signals base:wrong-argument (display:layer-title :aura)))

(defun wedge-points (picture)
  "Return the points, in pixels, of the first field of view in PICTURE."
  (let ((line (first (drawn-with :polyline picture
                                 :stroke (web (display::layer-ink :wedges))))))
    (with-input-from-string (in (substitute #\Space #\, (of-element line :points)))
      (loop for number = (read in nil) while number collect number))))

(test layers.fields-of-view-end-at-walls-and-opaque-things
  "The robot at (6.5,7.5) looks east, at the wall from x = 10 on."
  (in-studio (robot)
    (robot:place-robot robot 6.5 7.5 0)
    (flet ((reach ()
             (loop for (x) on (wedge-points (plain-picture robot :layers '(:wedges))) by #'cddr
                   maximize x)))
      (is (near 80.5 (reach) .1))
      (world:make-new-thing 'screen (list (robot:robot-world robot) 8.5 7.5)
                            '((:obsview t) (:size 1)))
      (let ((points (wedge-points (plain-picture robot :layers '(:wedges)))))
        (is (loop for (x y) on points by #'cddr
                  thereis (and (near 64.5 x .1) (near 60.5 y 2))))))))

(test layers.rays-have-the-colour-of-what-they-read
  (in-studio (robot)
    (display:keep-history)
    (setf (robot::camera-last-view (robot:robot-camera robot 0))
          (append (make-list 5 :initial-element 10d0) (make-list 5 :initial-element 50d0)))
    (run:run-ticks 1)
    (let ((picture (plain-picture robot :layers '(:rays))))
      (dolist (ink (list (first display::+ray-inks+) (first (last display::+ray-inks+))))
        (let ((line (first (drawn-with :path picture :stroke (web ink)))))
          (is (= 5 (count #\M (of-element line :d)))))))))

(defun layer-pictured (layer)
  "Return a picture with LAYER alone of a robot that has looked and gone, without colours."
  (in-studio (robot)
    (display:keep-history)
    (setf (robot::camera-last-view (robot:robot-camera robot 0))
          (make-list 5 :initial-element 10d0))
    (run:run-ticks 1)
    (robot:place-robot robot 4.5 4.5 0)
    (run:run-ticks 1)
    (command:robot-go-forward robot 1)
    (run:run-ticks 10)
    (display:svg-picture robot :layers layer :in-color nil)))

(test layers.have-lines-of-their-own-without-colours
  "A line looks as its sample in the legend does, and as no other layer's."
  (let ((own (loop for layer in '(:odometer :trail :rays)
                   for text = (layer-pictured (list layer))
                   for dashes = (web-dashes (display::layer-dashes layer))
                   do (is (search dashes text) "~A" layer)
                      (is (< 1 (times-written dashes (layer-pictured (list layer :legend))))
                          "~A" layer)
                   collect dashes)))
    (is (= 3 (length (remove-duplicates own :test #'string=)))))
  (is (null (display::layer-dashes :wedges)))
  (let ((all (loop for layer in display::*layers*
                   when (display::%layer-legend layer)
                     collect (display::%layer-dashes layer))))
    (is (= (length all) (length (remove-duplicates all :test #'equal))))))

(defun web-dashes (dashes)
  "Return DASHES as they are written in pictures."
  (format nil "stroke-dasharray=\"~{~A~^,~}\"" dashes))

(defun times-written (part text)
  "Return how often PART is in TEXT."
  (loop for start = (search part text) then (search part text :start2 (1+ start))
        while start count t))

(test legend.has-an-entry-for-rays-without-colours
  (is (has-words-p (layer-pictured '(:rays :legend)) ">rays<"))
  (is (not (search ">rays<" (layer-pictured '(:legend))))))

(test layers.designators-join-what-is-believed-to-what-is-so
  (in-studio (robot)
    (let ((designator (robot:add-designator robot :denotation (world:find-thing 'box))))
      (setf (robot::designator-angle designator) (/ pi 2)
            (robot::designator-distance designator) 2d0))
    (let ((line (first (drawn-with :path (plain-picture robot :layers '(:designators))
                                   :stroke (web (display::layer-ink :designators))
                                   :stroke-dasharray 4))))
      (is (equal "M52.5,68.5 L28.5,36.5 " (of-element line :d))))))

(test layers.grid-lies-below-walls
  (in-studio (robot)
    (let* ((picture (plain-picture robot :layers '(:grid) :scale 16))
           (grid (search (web display::+grid-ink+) picture)))
      (is (< grid (search (wall-fill 50 'wood) picture)))
      (is (= (+ 21 11) (count #\M (of-element (first (drawn-with
                                                      :path picture
                                                      :stroke (web display::+grid-ink+)))
                                              :d)))))))

;;; Names.

(defun boxes-of-names (robot)
  "Return the boxes of the names in a picture of ROBOT's world."
  (loop for text in (drawn-with :text (plain-picture robot :scale 24 :layers '(:names)))
        for x = (of-element text :x) for y = (of-element text :y)
        collect (list x (- y 9) (+ x (* 6 (length (of-element text :text)))) (+ y 2))))

(test names.stand-where-nothing-else-is
  (in-studio (robot)
    (loop for x from 1.5 below 10 by 3
          do (loop for y from 1.5 below 9 by 2
                   do (world:make-new-thing 'a-thing (list (robot:robot-world robot) x y)
                                            '((:size 1)))))
    (let ((boxes (boxes-of-names robot)) (map (world:find-map 'studio)))
      (is (< 5 (length boxes)))
      (is (loop for (box . others) on boxes
                never (some (lambda (other) (display::overlap-p box other)) others)))
      (let ((canvas:graphics-scale* 24))
        (is (< (* 2 (count-if (lambda (box) (display::on-wall-p map box)) boxes))
               (length boxes))
            "on a wall only where there is no other room")))))

(test names.are-those-of-robots-and-things
  (in-studio (robot)
    (let ((names (mapcar (lambda (text) (of-element text :text))
                         (drawn-with :text (plain-picture robot :scale 24 :layers '(:names))))))
      (is (equal '("box" "pen" "studio-robot") (sort names #'string<))))))

(test names.give-way-to-labels
  "The attribute :LABEL is written instead, and not at all if it is empty."
  (in-studio (robot)
    (flet ((names (&rest labels)
             (loop for thing in '(box pen) for label in labels
                   do (world:set-attribute (world:find-thing thing) :label label))
             (sort (mapcar (lambda (text) (of-element text :text))
                           (drawn-with :text (plain-picture robot :scale 24 :layers '(:names))))
                   #'string<)))
      (is (equal '("12" "studio-robot" "tool") (names 12 "tool")))
      (is (equal '("pen" "studio-robot") (names "" nil)))
      (is (equal '("box" "pen" "studio-robot") (names 1/2 'tool)) "neither a string nor integer"))))

(test names.end-the-lines-that-they-lie-on
  "Each stands on white, drawn just before it, so no trail or ray goes through it."
  (in-studio (robot)
    (let ((all (elements (plain-picture robot :scale 24 :layers '(:names :grid :wedges)))))
      (is (= 3 (loop for (plate text) on all
                     count (and (eq :text (first text)) (eq :rect (first plate))
                                (equal "#ffffff" (of-element plate :fill))
                                (< (of-element plate :x) (of-element text :x))
                                (<= (+ (of-element text :x)
                                       (* 6 (length (of-element text :text))))
                                    (+ (of-element plate :x) (of-element plate :width))))))))))

(test names.spare-the-rings-where-tracks-and-ways-end
  (in-studio (robot)
    (let* ((image (display::make-robot-image
                   :x 5 :y 5 :planned-way '((5 5) (8 3))
                   :cameras (list (display::make-camera-image
                                   :track (display::make-designator-image :distance 2)))))
           (snapshot (display::make-snapshot :robots (list image)))
           (canvas:graphics-scale* 10))
      (flet ((spared-p (layer x y)
               (some (lambda (box) (display::overlap-p box (display::box-around x y 1)))
                     (display::layer-mark-boxes snapshot (list layer)))))
        (is-true (spared-p :planned-way 80 30))
        (is-true (spared-p :tracks 70 50))
        (is (null (spared-p :tracks 80 30)))))))

(test names.of-what-is-tracked-stand-beside-its-ring
  (in-studio (robot)
    (let* ((snapshot (display:snapshot-of robot)) (canvas:graphics-scale* 16)
           (ring (display::box-around (* 16 5.5) (* 16 4.5) (+ 2 (display::track-radius))))
           (texts (drawn-with :text (format nil "~{~A~}"
                                            (drawing (canvas)
                                              (let ((canvas:graphics-scale* 16))
                                                (display:draw-names canvas snapshot '()
                                                                    (list ring))))))))
      (is (find "pen" texts :key (lambda (text) (of-element text :text)) :test #'equal)))))

(test legend.counts-as-people-do
  (in-studio (robot)
    (dolist (name '(r10 r9 r1 r2))
      (world:make-new-thing name (list (robot:robot-world robot) 8 8) '()))
    (is (equal '("r1" "r2" "r9" "r10")
               (mapcar #'display::drawn-thing-name
                       (find 'r1 (display::things-by-look (display:snapshot-of robot))
                             :key (lambda (images)
                                    (world:thing-name
                                     (display::thing-image-thing (first images))))))))))

(test legend.has-what-looks-the-same-once-with-all-names
  "And what is called the same and looks otherwise once for each look."
  (in-studio (robot)
    (flet ((new (name color)
             (world:make-new-thing name (list (robot:robot-world robot) 8 8)
                                   `((:size 4) (:color ,color))))
           (texts () (mapcar #'display::entry-text
                             (display::thing-entries (display:snapshot-of robot)))))
      (dolist (name '(saucer cup cup)) (new name 'violet))
      (new 'cup 'lightblue)
      (is (subsetp '("cup (2), saucer" "cup") (texts) :test #'string=))
      (dolist (name '(plate bowl dish spoon ladle)) (new name 'violet))
      (is-true (member "bowl, cup (2), dish, ladle and 3 more" (texts) :test #'string=))
      (is-true (mentions-p (display:svg-picture robot)
                           "<title>bowl, cup (2), dish, ladle, plate, saucer, spoon</title>")))))
