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
                             "Return a new graphics context: by default solid black lines, one
pixel wide.")
                         (:copier copy-gcontext))
  "The colours, lines and dashes to draw with."
  (foreground #x000000 color
              "the colour that the graphics context draws with. Can be set" :writable :export)
  (background #xFFFFFF color
              "the colour that CLEAR-AREA and image glyphs fill with. Can be set" :writable :export)
  (line-width 1 (real 0)
              "how wide lines are, in pixels; 0 means the thinnest. Can be set" :writable :export)
  (line-style :solid line-style
              "how lines look: :SOLID, :DASH or :DOUBLE-DASH. Can be set" :writable :export)
  (dashes 4 dashes "how long dashes and the gaps between them are, in pixels: one integer for all,
by default 4, or a list (dash gap ...). Can be set. A canvas may have its own dashes
instead" :writable :export))

(public draw-gcontext*)
(defvar draw-gcontext* (create-gcontext)
  "The graphics context that :graphics and :draw-function bodies draw with (manual B.1).")

(public (graphics-scale* :ars))
;; As reading 208 says.
(defvar graphics-scale* 8
  "The width of a grid cell in pixels, in the display of the world (manual B). The default is 8.
With that value, pictures without a :SCALE choose a scale that suits their map; another value is the
scale of these pictures too. In a body of :graphics or :draw-function, it is the scale of the
picture.")

(public in-color*)
(defvar in-color* t
  "True while drawing on a display that has colours, false on a monochrome one (manual B.1).")

(defun check-pen (foreground line-width line-style &optional dashes)
  (check-argument with-color foreground (typep foreground '(or null color))
                  "a colour, such as (vref red* 9)")
  (check-argument with-lines line-width (or (null line-width)
                                             (and (within-reason-p line-width) (<= 0 line-width)))
                  "a width in pixels, from 0 to 1e9")
  (check-argument with-lines line-style (typep line-style '(or null line-style))
                  ":solid, :dash or :double-dash")
  (check-argument with-gcontext dashes
                  (or (null dashes) (whole-p dashes 1 1000)
                      (and (consp dashes) (every (lambda (dash) (whole-p dash 1 1000)) dashes)))
                  "an integer from 1 to 1000, in pixels, or a list of such"))

(defun call-with-gcontext (function gcontext &key foreground background line-width line-style
                                                dashes)
  "Call FUNCTION while GCONTEXT has the values of the other arguments that are not NIL."
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
  "Run BODY while GCONTEXT has the :foreground, :background, :line-width, :line-style and :dashes of
OPTIONS, as CLX does."
  `(call-with-gcontext (lambda () ,@body) ,gcontext ,@options))

(public with-color)
(defmacro with-color (color &body body)
  "Run BODY drawing in COLOR, one of the colours in the manual's vectors or any integer #xRRGGBB;
in black if the display has no colours (manual B.1). Signals WRONG-ARGUMENT."
  (with-gensyms (value)
    `(let ((,value ,color))
       (with-gcontext (draw-gcontext* :foreground (if in-color* ,value black*)) ,@body))))

(public with-lines)
(defmacro with-lines ((&key width style) &body body)
  "Run BODY drawing lines WIDTH pixels wide in STYLE, one of CLX's: :SOLID, :DASH or :DOUBLE-DASH
(manual B.1). Signals WRONG-ARGUMENT."
  `(with-gcontext (draw-gcontext* :line-width ,width :line-style ,style) ,@body))

(defmacro with-dashes ((dashes &key (width 1)) &body body)
  "Run BODY drawing lines WIDTH pixels wide with DASHES, a list (dash gap ...), or solid if NIL."
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
  (:documentation "An object to draw on."))
(setf (documentation 'canvas-color-p 'function)
      "True if the canvas shows colours.")

(defun canvas-p (object)
  "True of a canvas."
  (typep object 'canvas))

(defconstant +character-width+ 7 "About how wide a character on a canvas is, in pixels.")
(defconstant +line-height+ 16 "The distance between lines of text on a canvas, in pixels.")

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
  (:documentation "Call FUNCTION. What it paints outside the box stays invisible."))

(defgeneric call-with-origin (function canvas x y)
  (:documentation "Call FUNCTION with X, Y as the origin of all coordinates."))

(defmacro with-clipping ((canvas x y width height) &body body)
  "Run BODY. What it draws on CANVAS outside the box, in pixels, stays invisible."
  `(call-with-clipping (lambda () ,@body) ,canvas ,x ,y ,width ,height))

(defmacro with-origin ((canvas x y) &body body)
  "Run BODY with X, Y, in pixels, as the origin of what it draws on CANVAS."
  `(call-with-origin (lambda () ,@body) ,canvas ,x ,y))

;;; Subjects: what a part of a drawing represents.

(defgeneric subject-title (subject)
  (:documentation "Return a short string that names SUBJECT, which is drawn on a canvas.")
  (:method (subject) (princ-to-string subject)))

(defgeneric call-with-subject (function canvas subject)
  (:documentation "Call FUNCTION, which paints SUBJECT. A canvas may let the user point at it.")
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
