;;;; looks.lisp -- colours, markers, wrapped text, titles.

(in-package :ars-magna.plots)

(export '(draw-marker save-chart))

;;; The colours are those of Okabe and Ito (Color Universal Design, 2008), which most colour-blind
;;; people can tell apart, except yellow, which is faint on white. Markers and dashes tell series
;;; apart without colours. With 7 colours, 10 markers and 6 dashes, the first 210 series differ.

(defconstant +text-color+ #x202020 "The colour of text.")
(defconstant +faint-text-color+ #x505050 "The colour of text that is less important.")
(defconstant +axis-color+ #x404040 "The colour of axes.")
(defconstant +grid-color+ #xDEDEDE "The colour of the lines behind the data.")

(defparameter *series-colors* #(#x0072B2 #xD55E00 #x009E73 #x000000 #xE69F00 #x56B4E9 #xCC79A7)
  "The colours of series, in turn: blue, vermilion, green, black, orange, sky blue, purple.")

(defparameter *series-dashes* #(nil (7 3) (2 3) (9 3 2 3) (4 2) (12 3 2 3 2 3))
  "The dashes of series, in turn: lengths of dashes and gaps, in pixels; NIL is a solid line.")

(defparameter *series-markers*
  #((:circle t) (:square t) (:triangle t) (:diamond t) (:kite t)
    (:circle nil) (:square nil) (:triangle nil) (:diamond nil) (:kite nil))
  "The markers of series, in turn: lists (outline filled-p).")

(defparameter *marker-outlines*
  '((:square -9/10 -9/10 9/10 -9/10 9/10 9/10 -9/10 9/10)
    (:triangle 0 -6/5 23/20 4/5 -23/20 4/5)
    (:diamond 0 -27/20 1 0 0 27/20 -1 0)
    (:kite 0 6/5 23/20 -4/5 -23/20 -4/5))
  "An alist from names of markers to their outlines, polygons x y ... around the point 0, 0.")

(defun series-color (index)
  (nth-cyclic index *series-colors*))

(defun call-with-series-look (function index width)
  (with-gcontext (draw-gcontext* :foreground (series-color index))
    (with-dashes ((nth-cyclic index *series-dashes*) :width width)
      (funcall function))))

(defmacro with-series-look ((index width) &body body)
  "Run BODY. It draws lines WIDTH pixels wide, with the colour and dashes of the series INDEX."
  `(call-with-series-look (lambda () ,@body) ,index ,width))

(defmacro with-ink ((color &optional (width 1)) &body body)
  "Run BODY. It draws solid lines WIDTH pixels wide in COLOR."
  `(with-gcontext (draw-gcontext* :foreground ,color :line-width ,width :line-style :solid)
     ,@body))

;;; Markers. A line runs through the middles of pixels, the edge of a filled shape between pixels. A
;;; shift of half a pixel makes the two meet.

(defun marker-outline-points (outline x y radius)
  (loop for (dx dy) on (rest (assoc outline *marker-outlines*)) by #'cddr
        collect (+ x 1/2 (* radius dx))
        collect (+ y 1/2 (* radius dy))))

(defun fill-marker (canvas outline color x y radius)
  (with-ink (color)
    (if (eq :circle outline)
        (draw-arc canvas draw-gcontext* (- (+ x 1/2) radius) (- (+ y 1/2) radius)
                  (* 2 radius) (* 2 radius) 0 (* 2 pi) t)
        (draw-lines canvas draw-gcontext* (marker-outline-points outline x y radius) :fill-p t))))

(defun draw-marker (canvas index x y &optional (radius 4) (color (series-color index)))
  "Draw the marker of the series INDEX in COLOR, with its middle at X, Y and a white rim."
  (destructuring-bind (outline filled-p) (nth-cyclic index *series-markers*)
    (fill-marker canvas outline white* x y (+ radius 6/5))
    (fill-marker canvas outline color x y radius)
    (unless filled-p
      (fill-marker canvas outline white* x y (- radius 8/5)))))

(defun draw-vertical-interval (canvas x low high)
  (draw-segments canvas draw-gcontext* (list x low x high
                                             (- x 3) low (+ x 3) low
                                             (- x 3) high (+ x 3) high)))

(defun draw-horizontal-interval (canvas y low high)
  (draw-segments canvas draw-gcontext* (list low y high y
                                             low (- y 3) low (+ y 3)
                                             high (- y 3) high (+ y 3))))

;;;; Text, broken into lines, never cut

(defconstant +text-size+ 12 "The height of the font of charts, in pixels.")
(defconstant +chart-line-height+ 15 "The distance between lines of text, in pixels.")

(defun name-text (name)
  "Return the text of NAME, a string, symbol, character or number; or the empty string for NIL."
  (check-argument chart name (typep name '(or string symbol character real))
                  "a string, symbol, character or number")
  (typecase name
    (null "")
    (symbol (string-downcase name))
    (real (rounded-number-text name))
    (t (string name))))

(defun split-text (text separator-p)
  "Return a list of the non-empty pieces of TEXT between characters for which SEPARATOR-P is true."
  (loop with start = 0
        for end = (position-if separator-p text :start start)
        unless (eql start (or end (length text)))
          collect (subseq text start end)
        while end
        do (setf start (1+ end))))

(defun fitting-character-count (word width size bold-p)
  "Return the number of characters at the beginning of WORD that fit in WIDTH pixels, at least 1."
  (loop for count from 1 to (length word)
        while (<= (text-width (subseq word 0 count) size bold-p) width)
        finally (return (max 1 (1- count)))))

(defun break-position (word count)
  "Return the position at which to break WORD. The first COUNT characters of WORD fit in a line. The
position is after the last dash, slash or the like among them, but not after the first character.
Without such a character it is COUNT."
  (let ((place (position-if (lambda (char) (find char "-/_,;:)"))
                            word :end count :from-end t)))
    (if (and place (plusp place)) (1+ place) count)))

(defun break-word (word width size bold-p)
  (loop for fitting = (fitting-character-count word width size bold-p)
        while (< fitting (length word))
        for count = (break-position word fitting)
        collect (subseq word 0 count) into pieces
        do (setf word (subseq word count))
        finally (return (append pieces (list word)))))

(defun wrap-words (words width size bold-p)
  "Return WORDS as a list of lines of text, each as long as fits in WIDTH pixels."
  (let ((lines '()) (line nil))
    (dolist (word words)
      (dolist (piece (break-word word width size bold-p))
        (let ((longer (if line (concatenate 'string line " " piece) piece)))
          (cond ((or (null line) (<= (text-width longer size bold-p) width))
                 (setf line longer))
                (t (push line lines)
                   (setf line piece))))))
    (nreverse (if line (cons line lines) lines))))

(defun space-p (character) (not (and (graphic-char-p character) (char/= #\Space character))))

(defun wrap-text (text width &key (size +text-size+) bold-p)
  "Return TEXT, a string or NIL, as lines that fit in WIDTH pixels. TEXT is broken at newlines and
between words. A word longer than a line is broken after a dash or the like, else anywhere."
  (check-argument chart text (typep text '(or null string)) "a string, or NIL for none")
  (and text
       (loop for paragraph in (split-text text (lambda (character) (char= #\Newline character)))
             append (wrap-words (split-text paragraph #'space-p) width size bold-p))))

(defun text-lines-width (lines &optional (size +text-size+) bold-p)
  (reduce #'max lines :key (lambda (line) (text-width line size bold-p)) :initial-value 0))

(defun text-lines-height (lines) (* +chart-line-height+ (length lines)))

(defun draw-text-lines (canvas x y lines &key (anchor :start) (color +text-color+)
                                           (size +text-size+) bold-p
                                           (step +chart-line-height+))
  "Write LINES of text from the base line Y down. Return the base line for the next line."
  (with-ink (color)
    (dolist (line lines y)
      (draw-words canvas draw-gcontext* x y line :anchor anchor :size size :bold-p bold-p)
      (incf y step))))

(defun draw-vertical-text-lines (canvas x y lines)
  "Write LINES as vertical text, side by side around X. The texts end at Y."
  (with-ink (+text-color+)
    (loop for line in lines
          for shift from (- (/ (1- (length lines)) 2))
          do (draw-words canvas draw-gcontext* (+ x 4 (* shift +chart-line-height+)) y line
                        :anchor :end :size +text-size+ :upward-p t))))

;;;; The page: margin, title, document

(defconstant +chart-margin+ 16 "The margin around a chart, in pixels.")

(defun check-chart-size (width height)
  (check-argument chart width (whole-p width 300 10000)
                  "an integer from 300 to 10000, in pixels")
  (check-argument chart height (whole-p height 200 10000)
                  "an integer from 200 to 10000, in pixels"))

;;; A heading is a list of a title and a subtitle, each a list of lines.

(defun lay-out-heading (title subtitle width)
  (let ((room (- width (* 2 +chart-margin+))))
    (list (wrap-text title room :size 15 :bold-p t) (wrap-text subtitle room))))

(defun heading-bottom (heading)
  (+ +chart-margin+ (* 19 (length (first heading))) (text-lines-height (second heading))))

(defun draw-heading (canvas heading)
  (destructuring-bind (title subtitle) heading
    (let ((y (draw-text-lines canvas +chart-margin+ (+ +chart-margin+ 13) title :size 15 :step 19
                              :bold-p t)))
      (draw-text-lines canvas +chart-margin+ (- y 2) subtitle :color +faint-text-color+))))

(defun save-chart (file chart)
  "Save CHART, an SVG document from a function such as LINE-CHART, in FILE, replacing it. Return the
truename of FILE. The name of FILE must end in .svg or, if the program rsvg-convert is installed, in
.png. Signals WRONG-ARGUMENT, and MISUSE for .png without rsvg-convert."
  (check-argument save-chart chart (stringp chart) "an SVG document from a function such as
LINE-CHART")
  (save-svg chart file (picture-kind 'save-chart file)))
