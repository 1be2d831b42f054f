;;;; canvas.lisp -- canvases and graphics contexts (manual B.1).

(in-package :ars-magna.canvas)

(export '(gcontext gcontext-p create-gcontext with-gcontext canvas canvas-p canvas-color-p
          paint-rectangles paint-arc paint-path paint-segments paint-string call-with-clipping
          with-clipping call-with-origin with-origin call-with-subject with-subject subject-title
          call-on-canvas with-canvas with-dashes +character-width+ +line-height+))

;;; A graphics context is changed only during a body, as by WITH-GCONTEXT of CLX. WITH-CANVAS binds
;;; a new one, so that threads that draw share nothing.

(deftype line-style () '(member :solid :dash :double-dash))

(deftype dashes () '(or (integer 1 1000) list))

(define-record (gcontext (:constructor create-gcontext
                             (&key foreground background line-width line-style dashes)
                             "Return a graphics context. Default: solid black lines, 1 pixel wide.")
                         (:copier copy-gcontext))
  "A graphics context: colours, line width, line style and dashes for drawing."
  (foreground #x000000 color
              "the colour that the graphics context draws with. Can be set" :writable :export)
  (background #xFFFFFF color
              "the colour that CLEAR-AREA and image glyphs fill with. Can be set" :writable :export)
  (line-width 1 (real 0)
              "the width of lines in pixels; 0 is the thinnest. Can be set" :writable :export)
  (line-style :solid line-style
              "the style of lines: :SOLID, :DASH or :DOUBLE-DASH. Can be set" :writable :export)
  (dashes 4 dashes "the lengths of dashes and gaps, in pixels: one integer for all, by default 4, or
a list (dash gap ...). Can be set. A canvas may use other dashes" :writable :export))

(public draw-gcontext*)
(defvar draw-gcontext* (create-gcontext)
  "The graphics context that :graphics and :draw-function bodies draw with (manual B.1).")

(public (graphics-scale* :ars))
;; As reading 208 says.
(defvar graphics-scale* 8
  "The width of a grid cell in pixels, in the display of the world (manual B), by default 8. While
it is 8, pictures without a :SCALE choose a scale that suits their map. Any other value also scales
these pictures. In a :graphics or :draw-function body, GRAPHICS-SCALE* is the picture's scale.")

(public in-color*)
(defvar in-color* t
  "True while drawing on a display with colours, false on a monochrome display (manual B.1).")

(defun check-pen (foreground line-width line-style &optional dashes)
  (check-argument with-color foreground (typep foreground '(or null color))
                  "a colour, such as (vref red* 9)")
  (check-argument with-lines line-width (or (null line-width)
                                             (and (sane-number-p line-width) (<= 0 line-width)))
                  "a width in pixels, from 0 to 1e9")
  (check-argument with-lines line-style (typep line-style '(or null line-style))
                  ":solid, :dash or :double-dash")
  (check-argument with-gcontext dashes
                  (or (null dashes) (whole-p dashes 1 1000)
                      (and (consp dashes) (every (lambda (dash) (whole-p dash 1 1000)) dashes)))
                  "an integer from 1 to 1000, in pixels, or a list of such integers"))

(defun call-with-gcontext (function gcontext &key foreground background line-width line-style
                                                dashes)
  "Call FUNCTION with GCONTEXT changed: each keyword argument that is not NIL sets an attribute."
  (check-pen foreground line-width line-style dashes)
  (let ((old (copy-gcontext gcontext)))
    (flet ((set-to (foreground background line-width line-style dashes)
             (when foreground (setf (gcontext-foreground gcontext) foreground))
             (when background (setf (gcontext-background gcontext) background))
             (when line-width (setf (gcontext-line-width gcontext) line-width))
             (when line-style (setf (gcontext-line-style gcontext) line-style))
             (when dashes (setf (gcontext-dashes gcontext) dashes))))
      (set-to foreground background line-width line-style dashes)
      (unwind-protect (funcall function)
        (set-to (gcontext-foreground old) (gcontext-background old)
                (gcontext-line-width old) (gcontext-line-style old) (gcontext-dashes old))))))

(defmacro with-gcontext ((gcontext &rest options) &body body)
  "Run BODY while GCONTEXT is changed. OPTIONS are :foreground, :background, :line-width,
:line-style and :dashes, as in CLX."
  `(call-with-gcontext (lambda () ,@body) ,gcontext ,@options))

(public with-color)
(defmacro with-color (color &body body)
  "Run BODY, which draws in COLOR. COLOR is an element of the manual's vectors of colours or any
integer #xRRGGBB. Without colours, BODY draws in black (manual B.1). Signals WRONG-ARGUMENT."
  (with-gensyms (value)
    `(let ((,value ,color))
       (with-gcontext (draw-gcontext* :foreground (if in-color* ,value black*)) ,@body))))

(public with-lines)
(defmacro with-lines ((&key width style) &body body)
  "Run BODY, which draws lines WIDTH pixels wide in the CLX line style STYLE, :SOLID, :DASH or
:DOUBLE-DASH (manual B.1). Signals WRONG-ARGUMENT."
  `(with-gcontext (draw-gcontext* :line-width ,width :line-style ,style) ,@body))

(defmacro with-dashes ((dashes &key (width 1)) &body body)
  "Run BODY, which draws lines WIDTH pixels wide. DASHES are lengths (dash gap ...) or NIL (solid)."
  (with-gensyms (value)
    `(let ((,value ,dashes))
       (with-gcontext (draw-gcontext* :line-width ,width :line-style (if ,value :dash :solid)
                                      :dashes (or ,value '(4)))
         ,@body))))

;;;; Canvases

;;; The bodies of :graphics get a canvas as their window. Coordinates are pixels, x to the right and
;;; y down. As in X, lines and outlines of rectangles run through the middles of pixels, so that an
;;; outline W wide covers W+1 of them. Arcs are inscribed in their box. The outline of a whole
;;; circle stays within the box too, while X would cover one more pixel to the right and below. A
;;; canvas has seven generic functions: five that paint, two that limit where.

(defclass canvas ()
  ((color-p :initarg :color-p :initform t :reader canvas-color-p
            :documentation "True if the canvas shows colours."))
  (:documentation "A canvas: an object to draw on, such as a window or an SVG file."))
(setf (documentation 'canvas-color-p 'function)
      "True if the canvas shows colours.")

(defun canvas-p (object)
  "True if OBJECT is a canvas."
  (typep object 'canvas))

(defconstant +character-width+ 7 "The approximate width of a character on a canvas, in pixels.")
(defconstant +line-height+ 16 "The distance between lines of text on a canvas, in pixels.")

(defgeneric paint-rectangles (canvas gcontext rectangles fill-p)
  (:documentation
   "Paint RECTANGLES, a sequence x y width height ..., as outlines, or filled if FILL-P."))

(defgeneric paint-arc (canvas gcontext x y width height start extent fill-p)
  (:documentation
   "Paint the arc inscribed in the box X, Y, WIDTH, HEIGHT. It begins at the angle START and extends
over the angle EXTENT, both in radians, counterclockwise from the right. If FILL-P, fill the slice
of pie. The outline of a whole circle stays within the box, for any width of the line."))

(defgeneric paint-path (canvas gcontext points fill-p)
  (:documentation "Paint a line through POINTS, a sequence x y ..., or a polygon if FILL-P."))

(defgeneric paint-segments (canvas gcontext segments)
  (:documentation "Paint SEGMENTS, a sequence x1 y1 x2 y2 ..., as separate lines."))

(defgeneric paint-string (canvas gcontext x y string)
  (:documentation "Paint STRING, which has no newlines. Its base line begins at X, Y."))

(defgeneric call-with-clipping (function canvas x y width height)
  (:documentation "Call FUNCTION; clip what it paints to the box X, Y, WIDTH, HEIGHT of CANVAS."))

(defgeneric call-with-origin (function canvas x y)
  (:documentation "Call FUNCTION while X, Y is the origin of all coordinates on CANVAS."))

(defmacro with-clipping ((canvas x y width height) &body body)
  "Run BODY, and clip what it draws on CANVAS to the box X, Y, WIDTH, HEIGHT, in pixels."
  `(call-with-clipping (lambda () ,@body) ,canvas ,x ,y ,width ,height))

(defmacro with-origin ((canvas x y) &body body)
  "Run BODY while X, Y, in pixels, is the origin of all coordinates on CANVAS."
  `(call-with-origin (lambda () ,@body) ,canvas ,x ,y))

;;; Subjects: what a part of a drawing represents.

(defgeneric subject-title (subject)
  (:documentation "Return a short string that names SUBJECT, an object that is drawn on a canvas.")
  (:method (subject) (princ-to-string subject)))

(defgeneric call-with-subject (function canvas subject)
  (:documentation "Call FUNCTION, which paints SUBJECT. A canvas may let users point at SUBJECT.")
  (:method (function canvas subject)
    (declare (ignore canvas subject))
    (funcall function)))

(defmacro with-subject ((canvas subject) &body body)
  "Run BODY, which draws SUBJECT on CANVAS. SUBJECT is an object with a SUBJECT-TITLE."
  `(call-with-subject (lambda () ,@body) ,canvas ,subject))

;;; Starting to draw.

(defun call-on-canvas (function canvas &key (scale graphics-scale*))
  "Call FUNCTION with DRAW-GCONTEXT* and IN-COLOR* (manual B.1) bound for CANVAS, and with
GRAPHICS-SCALE* bound to SCALE."
  (let ((draw-gcontext* (create-gcontext))
        (in-color* (canvas-color-p canvas))
        (graphics-scale* scale))
    (funcall function)))

(defmacro with-canvas ((canvas &rest options) &body body)
  "Run BODY with DRAW-GCONTEXT*, IN-COLOR* and GRAPHICS-SCALE* (option :scale) bound for CANVAS."
  `(call-on-canvas (lambda () ,@body) ,canvas ,@options))
