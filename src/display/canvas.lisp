;;;; canvas.lisp -- what can be drawn on, and what whoever makes a new kind of it must supply.

(in-package :ars-magna.canvas)

(export '(canvas canvas-p canvas-color-p paint-rectangles paint-arc paint-path paint-segments
          paint-string call-with-clipping with-clipping call-with-origin with-origin
          call-with-subject with-subject subject-title call-on-canvas with-canvas
          +character-width+ +line-height+))

;;; A canvas is what the bodies of :graphics get as their window. Coordinates are pixels, x to the
;;; right and y down. As in X, the outline of a rectangle and a line run through the middles of
;;; pixels, so an outline W wide covers W+1 of them. Arcs are inscribed in their box; the outline of
;;; a whole circle, too, stays within it, where X would cover one more pixel to the right and below.
;;; Seven generic functions make a canvas: five that paint, two that narrow down where.

(defclass canvas ()
  ((color-p :initarg :color-p :initform t :reader canvas-color-p
            :documentation "True if the canvas shows colours."))
  (:documentation "Something to draw on."))
(setf (documentation 'canvas-color-p 'function)
      "True if the canvas shows colours.")

(defun canvas-p (object)
  "True of a canvas."
  (typep object 'canvas))

(define-constant +character-width+ 7
  :documentation "How wide a character of a canvas's text is, in pixels, about.")
(define-constant +line-height+ 16
  :documentation "How far the lines of a canvas's text should be apart, in pixels.")

(defgeneric paint-rectangles (canvas gcontext rectangles fill-p)
  (:documentation
   "Paint each of RECTANGLES, a sequence x y width height ..., filled if FILL-P."))

(defgeneric paint-arc (canvas gcontext x y width height start extent fill-p)
  (:documentation
   "Paint the arc inscribed in a box from the angle START over EXTENT, both in radians,
counterclockwise from the right; a slice of pie if FILL-P. The outline of a whole circle stays
within the box, however wide the line is."))

(defgeneric paint-path (canvas gcontext points fill-p)
  (:documentation "Paint the lines through POINTS, a sequence x y ..., or the polygon if FILL-P."))

(defgeneric paint-segments (canvas gcontext segments)
  (:documentation "Paint each of SEGMENTS, a sequence x1 y1 x2 y2 ..., as a line."))

(defgeneric paint-string (canvas gcontext x y string)
  (:documentation "Paint STRING, without new lines, its base line beginning at X, Y."))

(defgeneric call-with-clipping (function canvas x y width height)
  (:documentation "Call FUNCTION; what it paints outside the box stays invisible."))

(defgeneric call-with-origin (function canvas x y)
  (:documentation "Call FUNCTION with X, Y as the origin of all coordinates."))

(defmacro with-clipping ((canvas x y width height) &body body)
  "Run BODY; what it draws on CANVAS outside the box, in pixels, stays invisible."
  `(call-with-clipping (lambda () ,@body) ,canvas ,x ,y ,width ,height))

(defmacro with-origin ((canvas x y) &body body)
  "Run BODY with X, Y, in pixels, as the origin of what it draws on CANVAS."
  `(call-with-origin (lambda () ,@body) ,canvas ,x ,y))

;;; What is drawn stands for something.

(defgeneric subject-title (subject)
  (:documentation "Return a short string that says what SUBJECT, drawn on a canvas, is.")
  (:method (subject) (princ-to-string subject)))

(defgeneric call-with-subject (function canvas subject)
  (:documentation "Call FUNCTION, which paints SUBJECT; a canvas may let the user point at it.")
  (:method (function canvas subject)
    (declare (ignore canvas subject))
    (funcall function)))

(defmacro with-subject ((canvas subject) &body body)
  "Run BODY, which draws SUBJECT on CANVAS: an object with a SUBJECT-TITLE."
  `(call-with-subject (lambda () ,@body) ,canvas ,subject))

;;; Starting to draw.

(defun call-on-canvas (function canvas &key (scale graphics-scale*))
  "Call FUNCTION with the variables of manual B.1 bound for CANVAS, GRAPHICS-SCALE* to SCALE."
  (let ((draw-gcontext* (create-gcontext))
        (in-color* (canvas-color-p canvas))
        (graphics-scale* scale))
    (funcall function)))

(defmacro with-canvas ((canvas &rest options) &body body)
  "Run BODY with DRAW-GCONTEXT*, IN-COLOR* and GRAPHICS-SCALE* bound for CANVAS. OPTIONS: :scale."
  `(call-on-canvas (lambda () ,@body) ,canvas ,@options))
