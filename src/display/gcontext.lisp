;;;; gcontext.lisp -- with what pen: graphics contexts, WITH-COLOR and WITH-LINES (manual B.1).

(in-package :ars-magna.canvas)

(export '(gcontext gcontext-p create-gcontext with-gcontext))

;;; A graphics context is changed only for the extent of a body, as WITH-GCONTEXT of CLX does.
;;; Whatever starts to draw on a canvas binds a fresh one, so threads that draw share nothing.

(deftype line-style () '(member :solid :dash :double-dash))

(deftype dashes () '(or (integer 1 1000) list))

(define-record (gcontext (:constructor create-gcontext
                             (&key foreground background line-width line-style dashes)
                             "Return a new graphics context: by default solid black lines, one
pixel wide.")
                         (:copier copy-gcontext))
  "With what to draw."
  (foreground #x000000 color
              "the colour that the graphics context draws with. Can be set" :writable :export)
  (background #xFFFFFF color
              "the colour that CLEAR-AREA and image glyphs fill with. Can be set" :writable :export)
  (line-width 1 (real 0)
              "how wide lines are, in pixels; 0 means the thinnest. Can be set" :writable :export)
  (line-style :solid line-style
              "how lines look: :SOLID, :DASH or :DOUBLE-DASH. Can be set" :writable :export)
  (dashes 4 dashes "how long dashes and the gaps between them are, in pixels: one integer for all,
by default 4, or a list (dash gap ...). Can be set. A canvas may have dashes of its own
instead" :writable :export))

(public draw-gcontext*)
(defvar draw-gcontext* (create-gcontext)
  "The graphics context that :graphics and :draw-function bodies draw with (manual B.1).")

(public (graphics-scale* :ars))
;; As reading 208 says.
(defvar graphics-scale* 8
  "How many pixels there are to the side of a grid cell in the display of the world (manual B).
While it is 8, the default, which is ours, pictures for which no :SCALE is given choose a scale that
suits their map; set to another value, it counts for them, too. Where a body of :graphics or
:draw-function runs, it is the scale of the picture.")

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
  "Call FUNCTION while GCONTEXT is as the other arguments say; NIL leaves it as it is."
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
  "Run BODY while GCONTEXT has the :foreground, :background, :line-width, :line-style and :dashes
that OPTIONS give, as CLX does."
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
