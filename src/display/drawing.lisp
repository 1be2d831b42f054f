;;;; drawing.lisp -- what programs draw with: operators of CLX (manual B.1), and text of any size.

(in-package :ars-magna.canvas)

(export '(*drawing-calls-left* draw-rectangle draw-rectangles draw-arc draw-arcs draw-line
          draw-lines
          draw-segments draw-point draw-points draw-glyph draw-glyphs draw-image-glyph
          draw-image-glyphs clear-area +text-font+ text-width paint-text character-width
          draw-words call-with-opacity with-opacity))

;;; Signatures and meanings are those of CLX, so that code written for CLX runs. Arguments are
;;; checked here, and the values are of no use.

(defvar *drawing-calls-left* nil
  "The number of calls of drawing functions that user code may still make, or NIL for no limit.")

(defun check-drawing (operator canvas gcontext numbers)
  (when (and *drawing-calls-left* (minusp (decf *drawing-calls-left*)))
    (reject-use "The drawing code has made too many calls for one thing or cell. ~
                 Correct its endless loop."))
  (unless (canvas-p canvas)
    (reject-argument operator "drawable" canvas "the window that was passed to the drawing code"))
  (unless (gcontext-p gcontext)
    (reject-argument operator "gcontext" gcontext "draw-gcontext*"))
  (unless (every #'sane-number-p numbers)
    (reject-argument operator "coordinates" numbers "numbers of pixels, from -1e9 to 1e9")))

(defun check-coordinate-sequence (operator canvas gcontext numbers multiple)
  (check-drawing operator canvas gcontext numbers)
  (unless (zerop (mod (length numbers) multiple))
    (reject-argument operator "coordinates" numbers
                     (format nil "~D numbers for each element" multiple))))

(defmacro define-drawing (name (canvas gcontext numbers . rest) documentation &body body)
  "Define the drawing function NAME, which checks its arguments. NUMBERS is a list of required
arguments that must be numbers. Or NUMBERS is (SEQUENCE MULTIPLE): then the argument SEQUENCE must
have numbers as elements, and its length must be a multiple of MULTIPLE."
  (let ((many (integerp (second numbers))))
    (multiple-value-bind (forms declarations) (parse-body body)
      `(defun ,name (,canvas ,gcontext ,@(if many (list (first numbers)) numbers) ,@rest)
         ,(format nil "~A The function is that of CLX (manual B.1). Signals ~
                       WRONG-ARGUMENT." documentation)
         ,@declarations
         ,(if many
              `(check-coordinate-sequence ',name ,canvas ,gcontext ,@numbers)
              `(check-drawing ',name ,canvas ,gcontext (list ,@numbers)))
         ,@forms
         nil))))

(define-drawing draw-rectangle (drawable gcontext (x y width height) &optional fill-p)
    "Draw a rectangle, filled if FILL-P, with its upper left corner at X, Y."
  (paint-rectangles drawable gcontext (list x y width height) fill-p))

(define-drawing draw-rectangles (drawable gcontext (rectangles 4) &optional fill-p)
    "Draw the rectangles of the sequence RECTANGLES, x y width height ..., filled if FILL-P."
  (paint-rectangles drawable gcontext rectangles fill-p))

(define-drawing draw-arc (drawable gcontext (x y width height angle1 angle2) &optional fill-p)
    "Draw an arc inscribed in the box with the upper left corner X, Y. It begins at ANGLE1 and
extends over ANGLE2, in radians, counterclockwise from three o'clock. If FILL-P, fill the slice."
  (paint-arc drawable gcontext x y width height angle1 angle2 fill-p))

(define-drawing draw-arcs (drawable gcontext (arcs 6) &optional fill-p)
    "Draw the arcs of the sequence ARCS, x y width height angle1 angle2 ..., as DRAW-ARC does."
  (let ((numbers (coerce arcs 'list)))
    (loop for (x y width height angle1 angle2) on numbers by (lambda (list) (nthcdr 6 list))
          do (paint-arc drawable gcontext x y width height angle1 angle2 fill-p))))

(define-drawing draw-line (drawable gcontext (x1 y1 x2 y2) &optional relative-p)
    "Draw a line from X1, Y1 to X2, Y2. If RELATIVE-P, X2 and Y2 are relative to X1 and Y1."
  (paint-segments drawable gcontext
                  (if relative-p
                      (list x1 y1 (+ x1 x2) (+ y1 y2))
                      (list x1 y1 x2 y2))))

(defun absolute-points (points)
  "Each of POINTS, x y ..., is relative to the point before. Return a list of absolute coordinates."
  (loop with x = 0 and y = 0
        for (dx dy) on (coerce points 'list) by #'cddr
        collect (incf x dx)
        collect (incf y dy)))

(define-drawing draw-lines (drawable gcontext (points 2)
                                     &key relative-p fill-p (shape :complex))
    "Draw lines through the sequence POINTS, x y .... If RELATIVE-P, each point is relative to the
point before. If FILL-P, fill the polygon. SHAPE has no effect."
  (declare (ignore shape))
  (paint-path drawable gcontext (if relative-p (absolute-points points) points) fill-p))

(define-drawing draw-segments (drawable gcontext (segments 4))
    "Draw the separate lines of the sequence SEGMENTS, x1 y1 x2 y2 ...."
  (paint-segments drawable gcontext segments))

(defun pixel-rectangles (points)
  "Return a list x y width height ... with a rectangle for the pixel at each of POINTS, x y ...."
  (loop for (x y) on (coerce points 'list) by #'cddr
        append (list (floor x) (floor y) 1 1)))

(define-drawing draw-point (drawable gcontext (x y))
    "Draw the pixel at X, Y."
  (paint-rectangles drawable gcontext (pixel-rectangles (list x y)) t))

(define-drawing draw-points (drawable gcontext (points 2) &optional relative-p)
    "Draw the pixel at each point of the sequence POINTS, x y .... If RELATIVE-P, each point is
relative to the point before."
  (paint-rectangles drawable gcontext
                    (pixel-rectangles (if relative-p (absolute-points points) points)) t))

;;; Text.

(defun glyph-text (sequence start end)
  "Return SEQUENCE from START to END as a string. Its elements are characters or character codes."
  (check-argument draw-glyphs sequence (typep sequence 'sequence) "a string")
  (map 'string (lambda (glyph)
                 (cond ((integerp glyph) (code-char glyph))
                       ((char= glyph #\Newline) #\Space)
                       (t glyph)))
       (subseq sequence start end)))

(define-drawing draw-glyphs (drawable gcontext (x y) sequence
                                      &key (start 0) end translate width size)
    "Draw the characters of SEQUENCE from START to END. Their base line begins at X, Y. TRANSLATE,
WIDTH and SIZE have no effect, because canvases have one font."
  (declare (ignore translate width size))
  (paint-string drawable gcontext x y (glyph-text sequence start end)))

(define-drawing draw-glyph (drawable gcontext (x y) glyph &key translate width size)
    "Draw the character GLYPH with its base line at X, Y. TRANSLATE, WIDTH and SIZE have no effect."
  (declare (ignore translate width size))
  (paint-string drawable gcontext x y (glyph-text (list glyph) 0 1)))

(defun paint-background (canvas gcontext x y width height)
  (with-gcontext (gcontext :foreground (gcontext-background gcontext))
    (paint-rectangles canvas gcontext (list x y width height) t)))

(define-drawing draw-image-glyphs (drawable gcontext (x y) sequence
                                            &key (start 0) end translate width size)
    "Draw as DRAW-GLYPHS does, on a filled background."
  (declare (ignore translate width size))
  (let ((text (glyph-text sequence start end)))
    (paint-background drawable gcontext x (- y 10) (* +character-width+ (length text)) 13)
    (paint-string drawable gcontext x y text)))

(define-drawing draw-image-glyph (drawable gcontext (x y) glyph &key translate width size)
    "Draw as DRAW-GLYPH does, on a filled background."
  (declare (ignore translate width size))
  (draw-image-glyphs drawable gcontext x y (list glyph)))

(defun clear-area (drawable &key (x 0) (y 0) (width 0) (height 0) exposures-p)
  "Fill a rectangle with the background colour. EXPOSURES-P has no effect. The function is that of
CLX. Signals WRONG-ARGUMENT."
  (declare (ignore exposures-p))
  (check-drawing 'clear-area drawable draw-gcontext* (list x y width height))
  (paint-background drawable draw-gcontext* x y width height)
  nil)

;;;; Text of any size, for charts

;;; The width of a text depends on the viewer's fonts. The widths here are upper bounds: those of
;;; the wider of DejaVu Sans and Helvetica, which Arial and Liberation Sans resemble.

(define-constant +text-font+ "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif"
  :test #'equal
  :documentation "The font family of SVG documents that have texts of DRAW-WORDS.")

(defparameter *character-widths*
  (let ((widths (make-array 128 :initial-element 1.02d0)))
    (loop for (width characters) in '((.41d0 " !'(),-./:;I[\\]fijlrt|")
                                      (.59d0 "\"*?J_`ckLsvxyz")
                                      (.64d0 "$0123456789{}abdeghnopquFT")
                                      (.69d0 "ABEKPSVXYZ")
                                      (.84d0 "CDGHNOQRUw#&+<=>^~"))
          do (loop for character across characters
                   do (setf (svref widths (char-code character)) width)))
    widths)
  "The widths of the ASCII characters, as fractions of the height of the font.")

(defun text-width (string size &optional bold-p)
  "Return an upper bound for the width of STRING, in pixels, in a font SIZE pixels high."
  (* size (if bold-p 1.2d0 1)
     (loop for character across string
           for code = (char-code character)
           sum (if (< code 128) (svref *character-widths* code) 1.1d0))))

(defgeneric paint-text (canvas gcontext x y string size anchor upward-p bold-p)
  (:documentation
   "Paint STRING, which has no newlines, in a font SIZE pixels high. ANCHOR, :START, :MIDDLE or
:END, is the point of the base line that lies at X, Y. The text runs upward if UPWARD-P, else to the
right. The default method ignores SIZE, UPWARD-P and BOLD-P, because a canvas has one font.")
  (:method (canvas gcontext x y string size anchor upward-p bold-p)
    (declare (ignore size upward-p bold-p))
    (let ((width (* +character-width+ (length string))))
      (paint-string canvas gcontext
                    (- x (ecase anchor (:start 0) (:middle (/ width 2)) (:end width)))
                    y string))))

(defgeneric character-width (canvas size)
  (:documentation "Return the width in pixels that layouts reserve for a character of DRAW-WORDS on
CANVAS, in a font SIZE pixels high. The default method returns +CHARACTER-WIDTH+.")
  (:method (canvas size)
    (declare (ignore canvas size))
    +character-width+))

(defun draw-words (canvas gcontext x y string &key (size 12) (anchor :start) upward-p bold-p)
  "Draw STRING in a font SIZE pixels high, upward if UPWARD-P, else to the right. ANCHOR, :START,
:MIDDLE or :END, is the point of the base line that lies at X, Y. Signals WRONG-ARGUMENT."
  (check-drawing 'draw-words canvas gcontext (list x y size))
  (check-argument draw-words anchor (member anchor '(:start :middle :end))
                  ":start, :middle or :end")
  (paint-text canvas gcontext x y (glyph-text string 0 nil) size anchor upward-p bold-p)
  nil)

(defgeneric call-with-opacity (function canvas opacity)
  (:documentation "Call FUNCTION. What it paints on CANVAS has OPACITY, from 0 to 1, if possible.")
  (:method (function canvas opacity)
    (declare (ignore canvas opacity))
    (funcall function)))

(defmacro with-opacity ((canvas opacity) &body body)
  "Run BODY. What it draws on CANVAS has OPACITY, from 0 to 1."
  `(call-with-opacity (lambda () ,@body) ,canvas ,opacity))
