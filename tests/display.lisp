;;;; display.lisp -- what pictures show, element by element.

(in-package :ars-magna.tests)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :canvas :ars-magna.canvas :ars-magna.tests))

(def-suite* display :in ars-magna)

;;; Drawing by hand.

(defun drawn (function &rest options)
  "Return the SVG elements, strings, that FUNCTION draws on the canvas it is given."
  (let* ((document (with-output-to-string (stream)
                     (apply #'canvas:call-with-svg
                            (lambda (canvas)
                              (canvas:with-canvas (canvas) (funcall function canvas))
                              (values 100 100))
                            stream options)))
         (lines (uiop:split-string document :separator '(#\Newline))))
    (remove "" (subseq lines 2 (- (length lines) 2)) :test #'string=)))

(defmacro drawing ((canvas &rest options) &body body)
  `(drawn (lambda (,canvas) (declare (ignorable ,canvas)) ,@body) ,@options))

(defun mentions-p (text part) (and (search part text) t))

(test canvas.rectangles-fill-or-outline-as-in-x
  (is (equal '("<rect x=\"8\" y=\"16\" width=\"8\" height=\"4\" fill=\"#000000\"/>")
             (drawing (canvas)
               (canvas:draw-rectangle canvas canvas:draw-gcontext* 8 16 8 4 t))))
  (is (equal (list (format nil "<rect x=\"1.5\" y=\"1.5\" width=\"6\" height=\"6\" ~
                                fill=\"none\" stroke=\"#000000\"/>"))
             (drawing (canvas)
               (canvas:draw-rectangle canvas canvas:draw-gcontext* 1 1 6 6 nil)))))

(test canvas.a-whole-arc-is-an-ellipse-in-its-box
  "The circle of manual B.1 is inscribed in its cell: the pen stays within, and nothing is cut off."
  (is (equal (list (format nil "<ellipse cx=\"12\" cy=\"20\" rx=\"3.5\" ry=\"3.5\" ~
                                fill=\"none\" stroke=\"#000000\"/>"))
             (drawing (canvas)
               (canvas:draw-arc canvas canvas:draw-gcontext* 8 16 8 8 0 (* 2 pi) nil)))))

(test canvas.arcs-run-counterclockwise-from-the-right
  "A quarter from three o'clock ends at twelve: up, which is where y is smaller."
  (is (equal '("<path d=\"M20 10A10 10 0 0 0 10 0\" fill=\"none\" stroke=\"#000000\"/>")
             (drawing (canvas)
               (canvas:draw-arc canvas canvas:draw-gcontext* 0 0 20 20 0 (/ pi 2)))))
  (is (equal '("<path d=\"M10 10L10 0A10 10 0 1 1 0 10z\" fill=\"#000000\"/>")
             (drawing (canvas)
               (canvas:draw-arc canvas canvas:draw-gcontext* 0 0 20 20
                                (/ pi 2) (* -3/2 pi) t)))))

(test canvas.lines-points-and-glyphs-take-what-clx-takes
  (let ((elements (drawing (canvas)
                    (let ((gc canvas:draw-gcontext*))
                      (canvas:draw-line canvas gc 1 2 3 4)
                      (canvas:draw-line canvas gc 1 2 3 4 t)
                      (canvas:draw-lines canvas gc #(0 0 5 0 5 5) :fill-p t)
                      (canvas:draw-lines canvas gc '(1 1 2 0 0 2) :relative-p t)
                      (canvas:draw-segments canvas gc '(0 0 1 1 2 2 3 3))
                      (canvas:draw-point canvas gc 7 8)
                      (canvas:draw-points canvas gc '(1 1 2 2) t)
                      (canvas:draw-rectangles canvas gc '(0 0 1 1 2 2 1 1) t)
                      (canvas:draw-arcs canvas gc (list 0 0 4 4 0 7 0 0 8 8 0 7) t)
                      (canvas:draw-glyphs canvas gc 3 9 "a<b" :start 1)
                      (canvas:draw-glyph canvas gc 3 9 #\x)))))
    (is (= 12 (length elements)))
    (is (mentions-p (first elements) "M1.5,2.5 L3.5,4.5"))
    (is (mentions-p (second elements) "M1.5,2.5 L4.5,6.5"))
    (is (mentions-p (third elements) "polygon points=\"0,0 5,0 5,5 \""))
    (is (mentions-p (fourth elements) "1.5,1.5 3.5,1.5 3.5,3.5"))
    (is (mentions-p (fifth elements) "L1.5,1.5 M2.5,2.5"))
    (is (mentions-p (sixth elements) "<rect x=\"7\" y=\"8\" width=\"1\" height=\"1\""))
    (is (mentions-p (seventh elements) "M1 1h1v1h-1zM3 3h1v1h-1z"))
    (is (mentions-p (eighth elements) "M0 0h1v1h-1zM2 2"))
    (is (mentions-p (nth 10 elements) ">&lt;b</text>"))))

(test canvas.misuse-is-an-error-that-says-what-to-give
  (signals base:wrong-argument
    (canvas:draw-rectangle nil canvas:draw-gcontext* 0 0 1 1))
  (signals base:wrong-argument
    (drawing (canvas) (canvas:draw-rectangle canvas nil 0 0 1 1)))
  (signals base:wrong-argument
    (drawing (canvas) (canvas:draw-segments canvas canvas:draw-gcontext* '(1 2 3))))
  (signals base:wrong-argument
    (drawing (canvas) (canvas:draw-line canvas canvas:draw-gcontext* 0 0 1 :far)))
  (signals base:wrong-argument (canvas:with-color :red nil))
  (signals base:wrong-argument (canvas:with-lines (:style :wavy) nil)))

(test canvas.with-color-and-with-lines-hold-for-their-body
  (let ((elements (drawing (canvas)
                    (flet ((line () (canvas:draw-line canvas canvas:draw-gcontext* 0 0 9 0)))
                      (canvas:with-color (aref canvas:red* 11)
                        (canvas:with-lines (:width 3 :style :dash) (line)))
                      (canvas:with-lines (:width 2) (line))
                      (line)))))
    (is (mentions-p (first elements)
                    "stroke=\"#f0705c\" stroke-width=\"3\" stroke-dasharray=\"4\""))
    (is (mentions-p (second elements) "stroke=\"#000000\" stroke-width=\"2\"/>"))
    (is (mentions-p (third elements) "stroke=\"#000000\"/>"))))

(test canvas.a-display-without-colour-draws-in-black
  (is (mentions-p (first (drawing (canvas :color-p nil)
                           (is (not canvas:in-color*))
                           (canvas:with-color (aref canvas:red* 11)
                             (canvas:draw-rectangle canvas canvas:draw-gcontext* 0 0 1 1 t))))
                  "fill=\"#000000\"")))

(test canvas.colours-are-vectors-from-dark-to-light
  "Manual B.1: 64 greys, 12 shades of eight hues."
  (flet ((brightness (color)
           (+ (ldb (byte 8 16) color) (ldb (byte 8 8) color) (ldb (byte 8 0) color))))
    (is (= 64 (length canvas:grey*)))
    (is (eql canvas:black* (aref canvas:grey* 0)))
    (is (eql canvas:white* (aref canvas:grey* 63)))
    (dolist (shades (list canvas:red* canvas:green* canvas:blue* canvas:violet* canvas:lightred*
                          canvas:lightgreen* canvas:lightblue* canvas:lightviolet*))
      (is (= 12 (length shades)))
      (is (apply #'< (cl:map 'list #'brightness shades)))))
  (is (eql (aref canvas:lightblue* 9) (canvas:shade 'lightblue)))
  (is (eql canvas:black* (canvas:shade 'no-such-colour))))

(test canvas.clipping-wraps-only-what-reaches-out
  (flet ((elements (size)
           (drawing (canvas)
             (canvas:with-clipping (canvas 8 8 8 8)
               (canvas:draw-rectangle canvas canvas:draw-gcontext* 8 8 size 8 t)))))
    (is (= 1 (length (elements 8))))
    (is (mentions-p (first (elements 9))
                    (format nil "<svg x=\"8\" y=\"8\" width=\"8\" height=\"8\" ~
                                 viewBox=\"8 8 8 8\" overflow=\"hidden\">")))))

;;; Worlds.

(defun call-with-studio (function)
  "Call FUNCTION with a robot in a small world of known things; what is defined is forgotten."
  (with-own-definitions
    (eval '(world:defmap studio (20 10)
            (rect (0 0) (19 9) bricks 10)
            (wall (10 1) (10 3) wood 50)
            (wall (10 5) (10 8) wood 50)
            (obj box (3.5 4.5) ((:size 2) (:color red) (:obsmove t)))
            (obj pen (5.5 4.5) ((:size 0.2) (:color green)))))
    (eval '(robot:defrobot studio-robot (studio (6.5 6.5) 0)
            :cameras ((1 10)) :hands (5) :bins (10)))
    (run:call-with-simulation
     (lambda () (funcall function (first (run:simulation-robots))))
     '(studio-robot) :journal t)))

(defmacro in-studio ((robot) &body body)
  `(call-with-studio (lambda (,robot) (declare (ignorable ,robot)) ,@body)))

(defun plain-picture (robot &rest options)
  "Return a picture of 8 pixels to a cell, and without what is around the map."
  (apply #'display:svg-picture robot (append options '(:scale 8 :layers (:places)))))

(defun wall-fill (parameter substance)
  "Return how the fill of a wall of the studio is written."
  (let ((hue (getf display::+tints+ (display::substance-ink substance))))
    (format nil "fill=\"#~(~6,'0X~)\"" (display::wall-color (display::wall-shade parameter) hue))))

(test world-display.walls-are-grey-by-their-parameter
  (in-studio (robot)
    (let ((picture (plain-picture robot)))
      (is (mentions-p picture "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"160\""))
      (is (mentions-p picture " height=\"80\" viewBox=\"0 0 160 80\""))
      (is (mentions-p picture (wall-fill 10 'bricks)))
      (is (mentions-p picture (concatenate 'string "<path d=\"M80 8h8v24h-8zM80 40h8v32h-8z\" "
                                           (wall-fill 50 'wood)))))))

(test world-display.walls-are-black-without-colour
  (in-studio (robot)
    (let ((picture (plain-picture robot :in-color nil)))
      (is (mentions-p picture "M80 40h8v32h-8z"))
      (is (not (mentions-p picture (wall-fill 50 'wood)))))))

(defun place-element (color x y)
  (format nil "<rect x=\"~D\" y=\"~D\" width=\"8\" height=\"8\" fill=\"#~(~6,'0X~)\"/>" x y color))

(test world-display.places-are-filled-cells-in-colour
  "The opening at (10,4) is a doorway, the corners of the room are concave."
  (in-studio (robot)
    (let ((picture (plain-picture robot)))
      (is (mentions-p picture (place-element (aref canvas:lightblue* 9) 80 32)))
      (is (mentions-p picture (place-element (aref canvas:lightred* 11) 8 8)))
      (is (mentions-p picture (place-element (aref canvas:lightred* 11) 144 64))))))

(test world-display.places-are-symbols-without-colour
  (in-studio (robot)
    (let ((picture (plain-picture robot :in-color nil)))
      (is (mentions-p picture "<rect x=\"81.5\" y=\"33.5\" width=\"6\" height=\"6\" fill=\"none\""))
      (is (mentions-p picture "<ellipse cx=\"12\" cy=\"12\" rx=\"1\" ry=\"1\" fill=\"#000000\"")))))

(test world-display.invisible-types-are-not-marked
  (in-studio (robot)
    (setf (world::place-type-invisible-p (world:find-place-type 'doorway)) t)
    (unwind-protect
         (is (not (mentions-p (display:svg-picture robot)
                              (place-element (aref canvas:lightblue* 9) 80 32))))
      (setf (world::place-type-invisible-p (world:find-place-type 'doorway)) nil))))

(defun shape-fills (picture tag x y)
  "Return, from the outside to the inside, the fills of the shapes TAG around X, Y in PICTURE."
  (flet ((middle (element start size)
           (if (eq tag :rect)
               (+ (of-element element start) (/ (of-element element size) 2))
               (of-element element (if (eq start :x) :cx :cy)))))
    (loop for element in (drawn-with tag picture)
          when (and (realp (of-element element (if (eq tag :rect) :x :cx)))
                    (= x (middle element :x :width)) (= y (middle element :y :height))
                    (not (string= "none" (of-element element :fill))))
            collect (of-element element :fill))))

(test world-display.things-have-their-colour-an-outline-and-a-halo
  (in-studio (robot)
    (let ((picture (plain-picture robot :layers '())))
      (is (mentions-p picture "<title>BOX#1</title>"))
      (is (equal (list "#ffffff" "#000000" (web (aref canvas:red* 9)))
                 (shape-fills picture :rect 28 36)))
      (is (equal (list "#ffffff" "#000000" (web (aref canvas:green* 9)))
                 (shape-fills picture :ellipse 44 36))))))

(test world-display.without-colour-things-are-vertical-lines
  (in-studio (robot)
    (let ((picture (plain-picture robot :in-color nil)))
      (dolist (x '(27 43))
        (is (mentions-p picture (format nil "<rect x=\"~D\" y=\"33\" width=\"2\" height=\"6\" ~
                                             fill=\"#000000\"/>" x)))))))

(test world-display.things-held-are-not-on-the-map
  (in-studio (robot)
    (world:move-thing (world:find-thing 'box) (robot:robot-hand robot 0))
    (is (not (mentions-p (display:svg-picture robot) "BOX#1")))
    (is (mentions-p (display:svg-picture robot :display :hands) "BOX#1"))))

(test world-display.the-robot-is-a-circle-with-an-arrowhead-and-camera-lines
  (in-studio (robot)
    (let ((picture (plain-picture robot)))
      (is (mentions-p picture "<title>STUDIO-ROBOT</title>"))
      (is (mentions-p picture "<ellipse cx=\"52\" cy=\"52\" rx=\"7\" ry=\"7\" fill=\"none\""))
      (is (mentions-p picture "<polygon points=\"56.5,52 "))
      (is (mentions-p picture "M60.5,52.5 L63.7,52.5")))))

(test world-display.layers-can-be-switched
  (in-studio (robot)
    (display:keep-history)
    (flet ((shows-p (layer part) (mentions-p (plain-picture robot :layers layer) part)))
      (is (not (shows-p '() (web (display::layer-ink :wedges)))))
      (is (shows-p '(:wedges) (web (display::layer-ink :wedges))))
      (is (not (shows-p '(:trail) "<polyline points=\"52.5,52.5")))
      (robot:place-robot robot 7.5 6.5 0)
      (run:run-ticks 1)
      (command:robot-go-forward robot 1)
      (run:run-ticks 10)
      (is (shows-p '(:trail) "60.5,52.5 \""))
      (is (not (shows-p '() "60.5,52.5 \"")))
      (is (shows-p '(:odometer) (web (display::layer-ink :odometer)))))
    (signals base:wrong-argument (display:svg-picture robot :layers '(:aura)))))

(test world-display.shows-the-planned-way
  (in-studio (robot)
    (let ((dashes "stroke-dasharray=\"6,4\""))
      (flet ((shown-p (&rest layers) (mentions-p (plain-picture robot :layers layers) dashes)))
        (is (not (shown-p :planned-way)))
        (let ((content (display:snapshot-content (display:snapshot-of robot))))
          (robot:publish-way robot '((6.5 6.5) (8.5 6.5) (8.5 2.5)))
          (is (not (equal content (display:snapshot-content (display:snapshot-of robot))))
              "A window would not show the way."))
        (is (shown-p :planned-way))
        (is (not (shown-p :names)))
        (is (mentions-p (plain-picture robot :layers '(:planned-way))
                        "<polyline points=\"52.5,52.5 68.5,52.5 68.5,20.5"))
        (is (mentions-p (display:svg-picture robot :layers '(:planned-way :legend))
                        ">planned way<"))
        (robot:publish-way robot '())
        (is (not (shown-p :planned-way)))))))

(test world-display.scale-is-what-is-asked-for-or-set
  (in-studio (robot)
    (let ((canvas:graphics-scale* 4))
      (is (mentions-p (display:svg-picture robot :layers '()) "width=\"80\" height=\"40\"")))
    (is (mentions-p (plain-picture robot :scale 16) "width=\"320\" height=\"160\""))
    (signals base:wrong-argument (display:svg-picture robot :scale 0))))

(test world-display.scale-suits-the-map-where-nobody-says
  "20 x 10 cells have 40 pixels each, the most; with all around them, the picture is not too large."
  (in-studio (robot)
    (is (mentions-p (display:svg-picture robot :layers '()) "width=\"800\" height=\"400\""))
    (let ((svg (first (elements (display:svg-picture robot)))))
      (is (<= 600 (of-element svg :width) 900))
      (is (<= (of-element svg :height) 700)))))

;;; The manual's :graphics bodies.

(defun place-picture (graphics in-color)
  "Return the elements that the body GRAPHICS, of :graphics, draws for the doorway of the studio."
  (in-studio (robot)
    (eval `(world:def-place-type doorway (cell)
             :check-matchers ((((- * -) (- - -) (- * -)) 0))
             :graphics ,graphics))
    (world:rebuild-map 'studio)
    (plain-picture robot :in-color in-color)))

(test graphics.the-doorway-of-5.1.1-draws-as-printed
  (dolist (in-color '(t nil))
    (is (mentions-p (place-picture '((win cx cy)
                                     (canvas:draw-rectangle
                                      win canvas:draw-gcontext*
                                      (1+ cx) (1+ cy)
                                      (- canvas:graphics-scale* 2) (- canvas:graphics-scale* 2)
                                      nil))
                                   in-color)
                    (format nil "<rect x=\"81.5\" y=\"33.5\" width=\"6\" height=\"6\" ~
                                 fill=\"none\" stroke=\"#000000\"/>")))))

(test graphics.the-convex-corner-of-b1-draws-as-printed
  (let ((graphics '((win cx cy)
                    (if canvas:in-color*
                        (canvas:with-color (svref canvas:lightred* 9)
                          (canvas:draw-rectangle win canvas:draw-gcontext* cx cy
                                                 canvas:graphics-scale* canvas:graphics-scale* t))
                        (canvas:draw-arc win canvas:draw-gcontext* cx cy
                                         canvas:graphics-scale* canvas:graphics-scale*
                                         0 (* 2 pi) nil)))))
    (is (mentions-p (place-picture graphics t) (place-element (aref canvas:lightred* 9) 80 32)))
    (let ((picture (place-picture graphics nil)))
      (is (mentions-p picture "<ellipse cx=\"84\" cy=\"36\" rx=\"3.5\" ry=\"3.5\" fill=\"none\""))
      (is (not (mentions-p picture "overflow"))))))

(test graphics.a-body-that-fails-is-reported-once-and-marked
  (in-studio (robot)
    (eval '(world:def-place-type doorway (cell)
            :check-matchers ((((- * -) (- - -) (- * -)) 0))
            :graphics ((win cx cy) win cx cy (error "no brush"))))
    (world:rebuild-map 'studio)
    (let ((first (plain-picture robot)) (second (plain-picture robot)))
      (is (string= first second))
      (is (mentions-p first "<rect x=\"80.5\" y=\"32.5\" width=\"7\" height=\"7\" fill=\"none\"")))
    (is (equal '("Error in the :graphics of place type DOORWAY: no brush")
               (mapcar #'base:message-text (base:take-messages))))))
