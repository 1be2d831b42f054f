;;;; palette.lisp -- colours can be told apart, and drawings be seen on their background.

(in-package :ars-magna.tests)

(in-suite display)

;;; Eyes without one kind of cones are simulated by the method of G. M. Machado, M. M. Oliveira and
;;; L. A. F. Fernandes, "A Physiologically-based Model for Simulation of Color Vision Deficiency",
;;; IEEE Transactions on Visualization and Computer Graphics 15 (2009), 1291-1298: their matrices
;;; for severity 1.0, on linear light. A print in grey keeps the luminance. Colours are compared in
;;; CIE Lab, by the distance of 1976; 2 or 3 can just be told apart side by side.

(defparameter *visions*
  '((:all (1 0 0) (0 1 0) (0 0 1))
    (:protan (0.152286 1.052583 -0.204868) (0.114503 0.786281 0.099216)
     (-0.003882 -0.048116 1.051998))
    (:deutan (0.367322 0.860646 -0.227968) (0.280085 0.672501 0.047413)
     (-0.011820 0.042940 0.968881))
    (:tritan (1.255528 -0.076749 -0.178779) (-0.078411 0.930809 0.147602)
     (0.004733 0.691367 0.303900))
    (:grey (0.2126 0.7152 0.0722) (0.2126 0.7152 0.0722) (0.2126 0.7152 0.0722)))
  "Lists (name row row row): what becomes of linear red, green and blue.")

(defun through (rows primaries)
  "Return what the matrix of ROWS makes of PRIMARIES, within what can be shown."
  (loop for row in rows collect (base:clamp (reduce #'+ (mapcar #'* row primaries)) 0 1)))

(defun lab-of (primaries)
  "Return the CIE Lab coordinates of PRIMARIES, linear, for the white of daylight D65."
  (flet ((curve (value)
           (if (< (/ 216 24389) value)
               (expt value 1/3)
               (/ (+ 16 (* 24389/27 value)) 116))))
    (destructuring-bind (x y z)
        (mapcar (lambda (row white) (curve (/ (reduce #'+ (mapcar #'* row primaries)) white)))
                '((0.4124564 0.3575761 0.1804375) (0.2126729 0.7151522 0.0721750)
                  (0.0193339 0.1191920 0.9503041))
                '(0.95047 1 1.08883))
      (list (- (* 116 y) 16) (* 500 (- x y)) (* 200 (- y z))))))

(defun least-difference (colors &optional (visions *visions*))
  "Return how far apart those two of COLORS are that are told apart worst, by whatever eyes of
VISIONS."
  (loop for (nil . rows) in visions
        for labs = (loop for color in colors
                         collect (lab-of (through rows (canvas:primaries color))))
        minimize (loop for (lab . others) on labs
                       when others
                         minimize (loop for other in others
                                        minimize (sqrt (reduce #'+ (mapcar (lambda (a b)
                                                                             (expt (- a b) 2))
                                                                           lab other)))))))

(defparameter *plain-colors*
  (mapcar #'canvas:shade '(red green blue violet lightred lightgreen lightblue lightviolet))
  "The colours of things.")

(test palette.plain-colours-are-told-apart-by-all-eyes-and-in-grey
  (is (<= 10 (least-difference *plain-colors*))))

(test palette.bars-of-timelines-are-told-apart-by-all-eyes-and-in-grey
  "From each other, and from the page."
  (is (<= 10 (least-difference (cons canvas:white*
                                     (mapcar #'second ars-magna.rpl-pictures::*bar-looks*)))))
  (is (<= 10 (least-difference (mapcar #'third trails::*outcome-looks*)))))

(test palette.the-measure-would-find-colours-that-are-alike
  "Red, green, blue and violet as they come to mind, with their tints, are not told apart in grey."
  (is (> 3 (least-difference '(#xDF3127 #x24AE34 #x3155E2 #x9B48D5
                               #xF1B8C4 #xA9E1B6 #xB5CFF1 #xD7BBF1)))))

(test palette.colours-mean-what-the-manual-says
  "Manual B: convex corners are pink, concave ones light pink, doorways light blue, beaks violet."
  (flet ((parts (color) (mapcar (lambda (position) (ldb (byte 8 position) color)) '(16 8 0))))
    (destructuring-bind (red green blue) (parts (aref canvas:lightred* 9))
      (is (< green blue red)))
    (destructuring-bind (red green blue) (parts (aref canvas:lightblue* 9))
      (is (< red green blue)))
    (destructuring-bind (red green blue) (parts (aref canvas:violet* 11))
      (is (< green red blue)))
    (is (< (canvas:luminance (aref canvas:lightred* 9))
           (canvas:luminance (aref canvas:lightred* 11))))))

;;; What there are several of, in turn.

(defun robot-look (position)
  "Return how a robot is drawn without colours: the dashes of its ring, and how its head is."
  (let ((canvas:in-color* nil))
    (list (display::nth-dashes position) (display::hollow-arrowhead-p position))))

(defun way-look (position)
  "Return what is drawn of a way without colours, but for where its dashes are."
  (drawing (canvas)
    (let ((canvas:in-color* nil))
      (display:draw-way-sample canvas '(0 0 100 0) (display:nth-ink position) position))))

(test palette.many-robots-and-ways-are-told-apart-by-all-eyes
  "The first forty by colour and dashes; ten robots and ways without colours as well."
  (is (<= 20 (least-difference display::+line-inks+ (remove :grey *visions* :key #'first))))
  (flet ((distinct-p (count function)
           (= count (length (remove-duplicates (loop for position below count
                                                     collect (funcall function position))
                                               :test #'equal)))))
    (is (distinct-p 40 (lambda (position)
                         (list (display:nth-ink position) (display::nth-dashes position)))))
    (is (distinct-p 10 #'robot-look))
    (is (distinct-p 10 #'way-look))))

;;; Contrast.

(defparameter *place-tints*
  (list (aref canvas:lightred* 9) (aref canvas:lightred* 11) (aref canvas:violet* 11)
        (aref canvas:lightblue* 9))
  "What cells of the built-in place types are filled with.")

;;; Substances.

(defun shipped-materials (&rest more)
  (display::textures-for (append '(world::wood world::metal world::bricks world::slate world::stone
                                   world::plaster world::glass world::cloth world::paper
                                   world::plastic)
                                 more)))

(test substances.of-one-map-have-textures-of-their-own
  "So they are told apart in grey, too, be their parameters what they will."
  (let ((textures (mapcar #'second (shipped-materials))))
    (is (= 10 (length (remove-duplicates textures)))))
  (with-own-definitions
    (dolist (name '(ivoryx tar snow))
      (eval `(world:defsubstance ,name 250))
      (loop for (shipped) in (shipped-materials)
            for textures = (mapcar #'second (display::textures-for (list name shipped)))
            do (is (not (eq (first textures) (second textures))))))))

(defun marks-in-tile (texture)
  "Return the coordinates of all marks of TEXTURE in a tile 6 pixels wide."
  (loop for mark in (getf canvas:+textures+ texture)
        append (if (eq :box (first mark))
                   (canvas::mark-boxes mark 0 0 6 6 6)
                   (canvas::mark-segments mark 0 0 6 6 6))))

(test textures.are-all-different-in-a-cell-of-six-pixels
  (let ((tiles (loop for (texture) on canvas:+textures+ by #'cddr
                     collect (marks-in-tile texture))))
    (is (= (length tiles) (length (remove-duplicates tiles :test #'equal))))
    (is (null (set-difference display::+wall-textures+ canvas:+textures+)))))

(test textures.stay-within-their-rectangles-and-fit-together
  (loop for (nil marks) on canvas:+textures+ by #'cddr
        do (dolist (mark (remove :box marks :key #'first))
             (is (loop for (x y) on (canvas::mark-segments mark 12 6 30 24 6) by #'cddr
                       always (and (<= 12 x 30) (<= 6 y 24))))))
  (is (equal '(0 6 6 0) (canvas::mark-segments '(:rising) 0 0 6 6 6)))
  (is (equal '(0 0 6 6) (canvas::mark-segments '(:falling) 0 0 6 6 6))))

(test walls.are-as-light-in-every-map
  (is (= 14 (display::wall-shade 0)))
  (is (= 25 (display::wall-shade 60)))
  (is (= 31 (display::wall-shade 200)))
  (is (= 36 (display::wall-shade 1d15)))
  (is (= 8 (display::wall-shade -1d15)))
  (is (apply #'<= (mapcar #'display::wall-shade '(-100 -10 0 5 10 40 120 250 1000)))))

(defun wall-colors ()
  "Return the colours of all walls that there can be."
  (loop for shade from display::+least-shade+ to display::+greatest-shade+
        append (loop for hue in (cons nil (remove-if-not #'integerp display::+tints+))
                     collect (display::wall-color shade hue))))

(defun backgrounds () (append (list canvas:white*) *place-tints* (wall-colors)))

(defun authors-colors ()
  "Return all colours that the author of a world can give a thing."
  (list* canvas:black* *plain-colors*))

(defun seen-p (color &rest backgrounds)
  (loop for background in backgrounds
        always (<= canvas:+least-contrast+ (canvas:color-contrast color background))))

(test contrast.is-that-of-the-guidelines
  "Black on white has 21, by definition; #767676 is known as the lightest grey that has 4.5."
  (is (near 21 (canvas:color-contrast canvas:black* canvas:white*) 1d-9))
  (is (near 4.54 (canvas:color-contrast #x767676 canvas:white*) .01))
  (is (= 1 (canvas:color-contrast #x123456 #x123456))))

(test contrast.outlines-of-things-are-seen-on-everything
  "Of the black outline and its white halo at least one is, on the floor, marks, walls and things."
  (is (null (remove-if (lambda (below)
                         (or (seen-p canvas:black* below) (seen-p canvas:white* below)))
                       (append (backgrounds) (authors-colors)))))
  (is (seen-p canvas:black* canvas:white*)))

(test contrast.crosses-and-rims-are-seen-on-whatever-colour-a-thing-has
  (dolist (color (authors-colors))
    (is (seen-p (canvas:black-or-white-on color) color)))
  (loop for color from 0 to #xFFFFFF by 40009
        unless (seen-p (canvas:black-or-white-on color) color)
          do (fail "~6,'0X" color)))

(test contrast.symbols-of-places-are-seen-on-their-tints
  (loop for (ink tint) in (list (list (aref canvas:lightred* 0) (aref canvas:lightred* 9))
                                (list (aref canvas:lightred* 0) (aref canvas:lightred* 11))
                                (list (aref canvas:violet* 0) (aref canvas:violet* 11))
                                (list (aref canvas:lightblue* 0) (aref canvas:lightblue* 9)))
        do (is (seen-p ink tint))))

(defun layer-inks ()
  "Return the colours of the lines of layers, of robots and of their cameras."
  (append (mapcar #'display::layer-ink (display:picture-layers)) display::+line-inks+))

(test contrast.lines-of-layers-and-robots-are-seen-on-everything
  "They have a halo; without it they are seen on the floor and on all marks."
  (let ((backgrounds (backgrounds)))
    (dolist (ink (layer-inks))
      (is (apply #'seen-p ink canvas:white* *place-tints*))
      (is (null (remove-if (lambda (below) (or (seen-p ink below) (seen-p canvas:white* below)))
                           backgrounds))
          "~6,'0X" ink))))

(test contrast.names-are-seen-on-floor-and-marks
  (is (apply #'seen-p canvas:black* canvas:white* *place-tints*)))

(defun css-color (style selector property)
  "Return the colour that PROPERTY has in STYLE for SELECTOR, written as # and three digits."
  (let* ((rule (subseq style (search (format nil "~A {" selector) style)))
         (body (subseq rule 0 (position #\} rule)))
         (start (search "#" body :start2 (search (format nil " ~A: " property) body))))
    (parse-integer (loop for at from (1+ start) repeat 3
                         collect (char body at) into digits
                         collect (char body at) into digits
                         finally (return (coerce digits 'string)))
                   :radix 16)))

(test contrast.ticks-of-animations-are-seen
  "In a page the text has the colours of all; in an animated picture it lies on a white strip."
  (is (seen-p (css-color display::*film-style* "body" "color")
              (css-color display::*film-style* "body" "background")))
  (is (null (search "color" (between "#tick {" "}" display::*film-style*))))
  (destructuring-bind (strip text)
      (elements (format nil "~{~A~}" (drawing (canvas) (display::draw-tick-label canvas 12345))))
    (flet ((color (element) (parse-integer (of-element element :fill) :start 1 :radix 16)))
      (is (seen-p (color text) (color strip))))
    (is (<= (+ (of-element text :x) (* 7 (length "tick 12345"))) (of-element strip :width)))
    (is (<= 0 (- (of-element text :y) 10) (of-element text :y) (of-element strip :height)))))

(test contrast.rays-grid-and-frames-are-seen-where-they-lie
  "Rays lie on floor and marks, the grid on the floor, coordinates and frames beside the map."
  (dolist (ink display::+ray-inks+)
    (is (apply #'seen-p ink canvas:white* *place-tints*)))
  (is (seen-p display::+grid-ink+ canvas:white*))
  (is (seen-p display::+frame-ink+ canvas:white*))
  (dolist (ink display::+line-inks+)
    (is (apply #'seen-p ink canvas:white* *place-tints*))))

(test contrast.tints-of-walls-leave-them-as-light-as-they-are
  "So the parameter can still be told from the lightness, and on a print in grey."
  (loop for shade from display::+least-shade+ to display::+greatest-shade+
        for light = (canvas:luminance (aref canvas:grey* shade))
        do (is (loop for hue in (remove-if-not #'integerp display::+tints+)
                     always (near light (canvas:luminance (display::wall-color shade hue))
                                  .01)))))
