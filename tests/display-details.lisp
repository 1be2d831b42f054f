;;;; display-details.lisp -- what the displays of a robot's state and parts show.

(in-package :ars-magna.tests)

(in-suite display)

(defun detail (robot display) (plain-picture robot :display display))

(test details.state-shows-position-and-direction
  (in-studio (robot)
    (is (mentions-p (detail robot :state) "Position: 6.50, 6.50"))
    (is (mentions-p (detail robot :state) "Direction: 0 deg (0.00 rad)"))))

(test details.designators-are-shown-by-what-they-denote
  (in-studio (robot)
    (robot:add-designator robot :denotation (world:find-thing 'box))
    (robot:add-designator robot :denotation (world:cell-type (world:map-cell
                                                              (world:find-map 'studio) 10 4)))
    (robot:add-designator robot :x 2 :y 2)
    (let ((picture (detail robot :designators)))
      (is (mentions-p picture ">BOX#1</text>"))
      (is (mentions-p picture ">DOORWAY</text>"))
      (is (mentions-p picture ">FALSE</text>")))))

(test details.things-are-as-wide-as-their-size-and-solid-if-they-block-the-way
  (in-studio (robot)
    (let ((bin (robot:robot-storage-bin robot 0)) (box (world:find-thing 'box)))
      (world:move-thing box bin)
      (is (drawn-with :rect (detail robot :bins) :width 16 :height 12
                                               :fill (web (aref canvas:red* 9))))
      (world:set-attribute box :size 4)
      (world:set-attribute box :obsmove nil)
      (is (mentions-p (detail robot :bins) "width=\"31\" height=\"11\" fill=\"none\""))
      (is (not (mentions-p (detail robot :bins) "<path")))
      (world:set-attribute box :obsview t)
      (is (mentions-p (detail robot :bins) "<path")))))

(test details.a-draw-function-is-used-instead
  (in-studio (robot)
    (let ((box (world:find-thing 'box)) (got '()))
      (world:set-attribute box :draw-function
                           (lambda (window &rest arguments)
                             (setf got arguments)
                             (canvas:draw-glyphs window canvas:draw-gcontext*
                                                 (second arguments) 20 "cardboard")))
      (world:move-thing box (robot:robot-hand robot 0))
      (is (mentions-p (detail robot :hands) "cardboard"))
      (is (eq box (first got)))
      (is (= 5 (length got)))
      (is (every #'realp (rest got))))))

(test details.bins-say-whether-they-are-open-and-hands-where-they-are
  (in-studio (robot)
    (is (mentions-p (detail robot :bins) "Storage-bin 0: open"))
    (setf (robot::hand-location (robot:robot-hand robot 0)) (robot:robot-storage-bin robot 0))
    (is (mentions-p (detail robot :hands) "in Storage-bin 0"))
    (setf (robot::storage-bin-closed-p (robot:robot-storage-bin robot 0)) t)
    (is (mentions-p (detail robot :bins) "Storage-bin 0: closed"))))

(test details.cameras-show-view-and-containment
  (in-studio (robot)
    (setf (robot::camera-last-view (robot:robot-camera robot 0)) '(1.0d0 20.25d0)
          (robot::camera-location (robot:robot-camera robot 0)) (world:find-thing 'box))
    (let ((picture (detail robot :cameras)))
      (is (mentions-p picture "Camera 0, view now: 1.0"))
      (is (mentions-p picture ">in </text>"))
      (is (mentions-p picture ">BOX#1</text>")))))

(defun y-of-text (picture text)
  "Return what PICTURE says of the height at which the last TEXT stands in it."
  (let ((start (search " y=\"" picture :from-end t :end2 (search text picture :from-end t))))
    (subseq picture (+ start 4) (position #\" picture :start (+ start 4)))))

(test details.what-a-camera-tracks-stands-under-what-it-sees-on-one-line
  (in-studio (robot)
    (let ((box (robot:add-designator robot :denotation (world:find-thing 'box) :x 8 :y 6.5)))
      (robot:start-track (robot:robot-camera robot 0) box nil)
      (let ((picture (detail robot :cameras)))
        (is (string= (y-of-text picture "local ") (y-of-text picture ">BOX#1<")))
        (is (< (parse-integer (y-of-text picture ">Camera 0: no view"))
               (parse-integer (y-of-text picture "local "))))))))

(test details.all-displays-fit-in-one-picture
  (in-studio (robot)
    (let ((picture (detail robot :all)))
      (dolist (display (rest display:+displays+))
        (is (mentions-p picture (display:display-title display)))))))

;;; Widths, angles, numbers, views.

(test details.widths-are-in-proportion-however-large-the-largest-is
  (let ((display::*size-unit* (display::size-unit
                               (display::make-robot-image
                                :bins (list (display::make-bin-image
                                             :contents (list (image-with :size 200)
                                                             (image-with :size 20))))))))
    (flet ((width (size) (display::thing-width (image-with :size size))))
      (is (= 90 (width 200)))
      (is (= 9 (width 20))))))

(test details.angles-tell-where-one-looks-and-how-often-one-has-turned
  (is (string= "52 deg (-17.95 rad in all)" (display::angle-text -17.95d0)))
  (is (string= "86 deg (1.50 rad)" (display::angle-text 1.5d0)))
  (is (string= "-29 deg (-0.50 rad)" (display::angle-text -0.5d0)))
  (is (string= "180 deg (3.14 rad)" (display::angle-text pi)))
  (is (string= "0 deg (6.28 rad in all)" (display::angle-text (* 2 pi)))))

(test details.numbers-are-written-plainly
  (in-studio (robot)
    (flet ((told (subject)
             (with-output-to-string (out) (display:describe-subject subject out))))
      (let ((image (display:snapshot-robot (display:take-snapshot (robot:robot-world robot))
                                           'studio-robot)))
        (is (mentions-p (told (first (display::robot-image-hands image))) "strength 5,"))
        (is (mentions-p (told (first (display::robot-image-bins image))) "capacity 10,")))
      (world:set-attribute (world:find-thing 'box) :size 2.5d0)
      (is (mentions-p (told (aref (display:snapshot-things
                                   (display:take-snapshot (robot:robot-world robot)))
                                  0))
                      ":size 2.5")))))

(test details.long-views-are-wrapped-and-tell-their-age
  (in-studio (robot)
    (setf (robot::camera-last-view (robot:robot-camera robot 0))
          (loop for number from 1 to 80 collect (+ 100d0 number)))
    (run:run-ticks 3)
    (let ((texts (format nil "~{~A~^ ~}" (words-in-picture robot :display :cameras))))
      (is (mentions-p texts "Camera 0, view 3 ticks ago: 101.0"))
      (is (mentions-p texts "180.0"))
      (is (not (find #\~ texts))))
    (let ((other (words-in-picture robot :display :hands)))
      (is (member "empty" other :test #'string=)))))

(test details.where-no-view-was-asked-for-it-says-so
  (in-studio (robot)
    (is (mentions-p (format nil "~{~A~^ ~}" (words-in-picture robot :display :cameras))
                    "Camera 0: no view yet"))))

(test names.stand-where-they-did-though-not-all-places-are-tried
  "The first place that hides nothing is the best one."
  (in-studio (robot)
    (let* ((snapshot (display:take-snapshot (robot:robot-world robot)))
           (boxes (loop for x from 20 to 60 by 10 collect (list x 20 (+ x 8) 28))))
      (canvas:with-canvas ((make-instance 'canvas:canvas) :scale 8)
        (is (equal (first boxes) (display::best-box snapshot '() boxes (display::index-boxes '()))))
        (is (equal (third boxes)
                   (display::best-box snapshot '() boxes
                                      (display::index-boxes '((0 0 39 100))))))))))
