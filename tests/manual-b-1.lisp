;;;; manual-b-1.lisp -- Place type graphics methods (manual B.1).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-b-1 :in ars-magna)

(defun chapel-picture (graphics &rest options)
  "Return the picture of a map whose only crossing, at (4 2), is drawn by GRAPHICS, and messages."
  (eval `(def-place-type crossing (cell) :check-matchers ((((* - *)) 0)) :before t
           :graphics ,graphics))
  (eval '(defmap chapel (9 6) (wall (3 2) (3 2) stone 1) (wall (5 2) (5 2) stone 1)))
  (eval '(defrobot sexton (chapel (1.5 4.5) 0)))
  (with-simulation (sexton)
    (values (apply #'svg-picture (find-robot 'sexton)
                   (append options '(:scale 8 :layers (:places))))
            (message-texts))))

(defun has-square-p (picture &rest attributes)
  "True if PICTURE has a rectangle with ATTRIBUTES in the cell (4 2)."
  (apply #'drawn-with :rect picture :x 32 :y 16 attributes))

(test manual-b-1.graphics-draw-the-cell
  "B.1: the body is executed with the variables bound to the window and to the position, in pixels,
of the upper left corner of each cell of the type."
  (let ((picture (chapel-picture
                  '((w left top)
                    (xlib:draw-rectangle w draw-gcontext* left top
                                         graphics-scale* graphics-scale* t)))))
    (is (= 1 (length (has-square-p picture :width 8 :height 8 :fill "#000000"))))))

(test manual-b-1.graphics-follow-the-scale
  "B.1: graphics-scale* is how many pixels a cell's side has there, too."
  (let ((picture (chapel-picture
                  '((w left top)
                    (xlib:draw-rectangle w draw-gcontext* left top
                                         graphics-scale* graphics-scale* t))
                  :scale 12)))
    (is-true (drawn-with :rect picture :x 48 :y 24 :width 12 :height 12))))

(test manual-b-1.in-color*-says-whether-there-is-colour
  "B.1: in-color* is true if the current display is in colour, and false otherwise; so a method can
draw one thing or the other."
  (let ((graphics '((w x y)
                    (if in-color*
                        (with-color (vref lightgreen* 9)
                          (xlib:draw-rectangle w draw-gcontext* x y
                                               graphics-scale* graphics-scale* #t))
                        (xlib:draw-arc w draw-gcontext* x y graphics-scale* graphics-scale*
                                       0 (* 2 pi) #f)))))
    (is-true (has-square-p (chapel-picture graphics) :fill (web (vref lightgreen* 9))))
    (let ((picture (chapel-picture graphics :in-color nil)))
      (is-false (has-square-p picture))
      (is-true (drawn-with :ellipse picture :cx 36 :cy 20 :rx 3.5 :ry 3.5 :fill "none")
               "a circle inscribed in the square"))))

(test manual-b-1.with-color-selects-a-colour
  "B.1: (with-color color -body-) draws in COLOR; in black if the display is not in colour, and only
while the body runs."
  (let ((graphics '((w x y)
                    (with-color (vref violet* 4)
                      (xlib:draw-rectangle w draw-gcontext* x y 4 8 t))
                    (xlib:draw-rectangle w draw-gcontext* (+ x 4) y 4 8 t))))
    (let ((picture (chapel-picture graphics)))
      (is-true (has-square-p picture :width 4 :fill (web (vref violet* 4))))
      (is-true (drawn-with :rect picture :x 36 :y 16 :width 4 :fill "#000000")))
    (is-true (has-square-p (chapel-picture graphics :in-color nil) :width 4 :fill "#000000"))))

(test manual-b-1.with-lines-selects-width-and-style
  "B.1: (with-lines ([:width w] [:style st]) -body-)."
  (let* ((picture (chapel-picture
                   '((w x y)
                     (with-lines (:width 3 :style :dash)
                       (xlib:draw-line w draw-gcontext* x y (+ x 4) (+ y 4)))
                     (with-lines (:width 2)
                       (xlib:draw-line w draw-gcontext* x y (+ x 4) (+ y 4)))
                     (xlib:draw-line w draw-gcontext* x y (+ x 4) (+ y 4)))))
         (lines (drawn-with :path picture :fill "none" :stroke "#000000")))
    (is (equal '((3 t) (2 nil) (nil nil))
               (mapcar (lambda (line) (list (of-element line :stroke-width)
                                            (and (of-element line :stroke-dasharray) t)))
                       lines)))))

(defun brightness (color)
  (+ (ldb (byte 8 16) color) (ldb (byte 8 8) color) (ldb (byte 8 0) color)))

(test manual-b-1.grey*-is-64-shades-from-black-to-white
  "B.1: black* and white* are these colours; grey* is a 64-vector: 0 is black, 63 is white."
  (is (equal '(#x000000 #xffffff) (list black* white*)))
  (is (equal (list 64 black* white*) (list (length grey*) (vref grey* 0) (vref grey* 63))))
  (is-true (apply #'< (coerce (cl:map 'vector #'brightness grey*) 'list))))

(test manual-b-1.hues-are-12-shades-from-dark-to-light
  "B.1: red*, green*, blue*, violet* and lightred* to lightviolet* are 12-vectors, from dark to
light."
  (dolist (shades (list red* green* blue* violet* lightred* lightgreen* lightblue* lightviolet*))
    (is (= 12 (length shades)))
    (is-true (apply #'< (coerce (cl:map 'vector #'brightness shades) 'list))))
  (flet ((part (position color) (ldb (byte 8 position) color)))
    (let ((red (vref red* 9)) (green (vref green* 9)) (blue (vref blue* 9)))
      (is-true (> (part 16 red) (max (part 8 red) (part 0 red))))
      (is-true (> (part 8 green) (max (part 16 green) (part 0 green))))
      (is-true (> (part 0 blue) (max (part 16 blue) (part 8 blue)))))))

(test manual-b-1.names-are-where-the-manual-says
  "B.1, readings 29 and 213: graphics-scale* is in the package ARS, the other variables are in NISP;
a user's package has them all."
  (flet ((homes (name) (loop for package in '("ARS" "NISP")
                             when (eq :external (nth-value 1 (find-symbol name package)))
                               collect package)))
    (is (equal '("ARS") (homes "GRAPHICS-SCALE*")))
    (dolist (name '("DRAW-GCONTEXT*" "IN-COLOR*" "BLACK*" "WHITE*" "GREY*" "RED*" "LIGHTVIOLET*"
                    "WITH-COLOR" "WITH-LINES"))
      (is (equal '("NISP") (homes name)) "~A" name))))

(test manual-b-1.drawing-stays-in-the-cell
  "B.1, reading 214: drawings are clipped to the cell's square."
  (let ((picture (chapel-picture
                  '((w x y) (xlib:draw-rectangle w draw-gcontext* (- x 4) y 40 40 t)))))
    (is-true (drawn-with :svg picture :x 32 :y 16 :width 8 :height 8 :overflow "hidden"))))

(test manual-b-1.types-without-graphics-are-not-marked
  "B, reading 210: nor are invisible ones, whatever :graphics says."
  (is-false (has-square-p (chapel-picture nil)))
  (eval '(def-place-type crossing (cell) :check-matchers ((((* - *)) 0)) :invisible t
          :graphics ((w x y) (xlib:draw-rectangle w draw-gcontext* x y 8 8 t))))
  (with-simulation (sexton)
    (is-false (has-square-p (svg-picture (find-robot 'sexton))))))

(test manual-b-1.bodies-that-fail-are-messages
  "Reading 86: trouble in a user's drawing is a message; the rest of the picture is there."
  (multiple-value-bind (picture messages)
      (chapel-picture '((w x y) w x y (error "No brush")))
    (is-true (drawn-with :ellipse picture) "the robot")
    (is (= 1 (length messages)))
    (is-true (has-words-p (first messages) "crossing" "No brush"))))
