;;;; text.lisp -- text of any size, and how wide it is: for charts, beyond what CLX has.

(in-package :ars-magna.canvas)

(export '(+text-font+ text-width paint-text character-width draw-words call-with-opacity
          with-opacity))

;;; How wide a text is depends on the fonts of whoever looks at it. So the widths here are what it
;;; takes at most: those of the wider one of DejaVu Sans and of Helvetica, to which Arial and
;;; Liberation Sans are alike. What fits by them fits everywhere.

(define-constant +text-font+ "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif"
  :test #'equal
  :documentation "The font family for an SVG document in which DRAW-WORDS writes.")

(defparameter *widths*
  (let ((widths (make-array 128 :initial-element 1.02d0)))
    (loop for (width characters) in '((.41d0 " !'(),-./:;I[\\]fijlrt|")
                                      (.59d0 "\"*?J_`ckLsvxyz")
                                      (.64d0 "$0123456789{}abdeghnopquFT")
                                      (.69d0 "ABEKPSVXYZ")
                                      (.84d0 "CDGHNOQRUw#&+<=>^~"))
          do (loop for character across characters
                   do (setf (svref widths (char-code character)) width)))
    widths)
  "How wide the characters of ASCII are, in heights of the font.")

(defun text-width (string size &optional bold-p)
  "Return how wide STRING is at most, in pixels, if the font is SIZE pixels high."
  (* size (if bold-p 1.2d0 1)
     (loop for character across string
           for code = (char-code character)
           sum (if (< code 128) (svref *widths* code) 1.1d0))))

(defgeneric paint-text (canvas gcontext x y string size anchor upward-p bold-p)
  (:documentation
   "Paint STRING, without new lines, in a font SIZE pixels high. X, Y is where its base line has
its :START, :MIDDLE or :END, as ANCHOR says. It runs upward if UPWARD-P, else to the right. By
default a canvas uses its one font, to the right.")
  (:method (canvas gcontext x y string size anchor upward-p bold-p)
    (declare (ignore size upward-p bold-p))
    (let ((width (* +character-width+ (length string))))
      (paint-string canvas gcontext
                    (- x (ecase anchor (:start 0) (:middle (/ width 2)) (:end width)))
                    y string))))

(defgeneric character-width (canvas size)
  (:documentation "Return how wide a character is that DRAW-WORDS draws on CANVAS in a font SIZE
pixels high, in pixels, if all are alike: by default as in a canvas's one font.")
  (:method (canvas size)
    (declare (ignore canvas size))
    +character-width+))

(defun draw-words (canvas gcontext x y string &key (size 12) (anchor :start) upward-p bold-p)
  "Draw STRING in a font SIZE pixels high, with the :START, :MIDDLE or :END, as ANCHOR says, of its
base line at X, Y; upward if UPWARD-P, else to the right. Signals WRONG-ARGUMENT."
  (check-drawing 'draw-words canvas gcontext (list x y size))
  (check-argument draw-words anchor (member anchor '(:start :middle :end))
                  ":start, :middle or :end")
  (paint-text canvas gcontext x y (glyph-text string 0 nil) size anchor upward-p bold-p)
  nil)

(defgeneric call-with-opacity (function canvas opacity)
  (:documentation "Call FUNCTION; what it paints hides what is below by OPACITY, from 0 to 1, as far
as CANVAS can do that: by default wholly.")
  (:method (function canvas opacity)
    (declare (ignore canvas opacity))
    (funcall function)))

(defmacro with-opacity ((canvas opacity) &body body)
  "Run BODY; what it draws on CANVAS hides what is below by OPACITY, from 0 to 1."
  `(call-with-opacity (lambda () ,@body) ,canvas ,opacity))
