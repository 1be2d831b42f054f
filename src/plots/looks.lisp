;;;; looks.lisp -- what tells one series from another: colour, marker and dashes.

(in-package :ars-magna.plots)

(export '(draw-marker))

;;; The colours are those of Okabe and Ito (Color Universal Design, 2008), which most colour-blind
;;; people tell apart, without yellow, which is faint on white. Markers and dashes tell series apart
;;; without any colour. There are 7, 10 and 6: so no two of the first 210 series look alike.

(defconstant +ink+ #x202020 "The colour of text.")
(defconstant +faint-ink+ #x505050 "The colour of text that is less important.")
(defconstant +line-ink+ #x404040 "The colour of axes.")
(defconstant +grid-ink+ #xDEDEDE "The colour of the lines behind the data.")

(defparameter *colors* #(#x0072B2 #xD55E00 #x009E73 #x000000 #xE69F00 #x56B4E9 #xCC79A7)
  "Blue, vermilion, green, black, orange, sky blue, purple.")

(defparameter *dashes* #(nil (7 3) (2 3) (9 3 2 3) (4 2) (12 3 2 3 2 3))
  "Lengths of dashes and gaps, in pixels; NIL is a solid line.")

(defparameter *shapes*
  #((:circle t) (:square t) (:triangle t) (:diamond t) (:kite t)
    (:circle nil) (:square nil) (:triangle nil) (:diamond nil) (:kite nil))
  "Lists (outline filled-p).")

(defparameter *outlines*
  '((:square -9/10 -9/10 9/10 -9/10 9/10 9/10 -9/10 9/10)
    (:triangle 0 -6/5 23/20 4/5 -23/20 4/5)
    (:diamond 0 -27/20 1 0 0 27/20 -1 0)
    (:kite 0 6/5 23/20 -4/5 -23/20 -4/5))
  "Polygons x y ... around 0, 0.")

(defun look (index vector) (svref vector (mod index (length vector))))
(defun look-color (index)
  "Return the colour of the series INDEX, as a pixel's value."
  (look index *colors*))

(defun call-with-look (function index width)
  (let ((dashes (look index *dashes*)))
    (with-gcontext (draw-gcontext* :foreground (look-color index) :line-width width
                                   :line-style (if dashes :dash :solid)
                                   :dashes (or dashes '(4)))
      (funcall function))))

(defmacro with-look ((index width) &body body)
  "Run BODY drawing lines WIDTH pixels wide in colour and dashes of the series INDEX."
  `(call-with-look (lambda () ,@body) ,index ,width))

(defmacro with-ink ((color &optional (width 1)) &body body)
  "Run BODY drawing solid lines WIDTH pixels wide in COLOR."
  `(with-gcontext (draw-gcontext* :foreground ,color :line-width ,width :line-style :solid)
     ,@body))

;;; Markers. As a line runs through the middle of a pixel, and the edge of what is filled between
;;; pixels, half a pixel makes the two meet.

(defun shape-points (outline x y radius)
  (loop for (dx dy) on (rest (assoc outline *outlines*)) by #'cddr
        collect (+ x 1/2 (* radius dx))
        collect (+ y 1/2 (* radius dy))))

(defun fill-shape (canvas outline color x y radius)
  (with-ink (color)
    (if (eq :circle outline)
        (draw-arc canvas draw-gcontext* (- (+ x 1/2) radius) (- (+ y 1/2) radius)
                  (* 2 radius) (* 2 radius) 0 (* 2 pi) t)
        (draw-lines canvas draw-gcontext* (shape-points outline x y radius) :fill-p t))))

(defun draw-marker (canvas index x y &optional (radius 4) (color (look-color index)))
  "Draw the marker of the series INDEX around X, Y, in COLOR, with a white rim."
  (destructuring-bind (outline filled-p) (look index *shapes*)
    (fill-shape canvas outline white* x y (+ radius 6/5))
    (fill-shape canvas outline color x y radius)
    (unless filled-p
      (fill-shape canvas outline white* x y (- radius 8/5)))))

(defun draw-interval (canvas x low high)
  "Draw a bar upward at X from the pixel LOW to HIGH, with caps."
  (draw-segments canvas draw-gcontext* (list x low x high
                                             (- x 3) low (+ x 3) low
                                             (- x 3) high (+ x 3) high)))

(defun draw-interval-across (canvas y low high)
  (draw-segments canvas draw-gcontext* (list low y high y
                                             low (- y 3) low (+ y 3)
                                             high (- y 3) high (+ y 3))))
