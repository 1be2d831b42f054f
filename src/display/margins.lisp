;;;; margins.lisp -- the scale of a map, and what is around it: title, legend, scale bar.

(in-package :ars-magna.display)

(export '(user-graphics-scale drawn-scale wrap-text-to-width draw-framed with-map-svg
                              framed-picture-svg))

(defconstant +usual-scale+ 8 "The default of GRAPHICS-SCALE*.")

(define-argument-type 'picture-scale (lambda (value) (and (finite-p value) (<= 1 value 256)))
  "a number of pixels per cell, from 1 to 256")

(defun user-graphics-scale ()
  "Return GRAPHICS-SCALE* if the user has set a value other than the default, else NIL. Signals
MISUSE if GRAPHICS-SCALE* is not a valid scale."
  (cond ((eql graphics-scale* +usual-scale+) nil)
        ((argument-of-type-p graphics-scale* 'picture-scale) graphics-scale*)
        (t (reject-use "graphics-scale* is ~S, but must be ~A. Set it to such a number. With ~D, ~
                        each picture has the scale that suits its map."
                       graphics-scale* (argument-type-text 'picture-scale) +usual-scale+))))

;;; Without a given scale, the map with title, coordinates and scale bar is at most
;;; +GREATEST-MAP-WIDTH+ by +GREATEST-MAP-HEIGHT+ pixels large. The legend is added beside the map
;;; or below it, where the page becomes less large. The map does not shrink for it.

(defconstant +greatest-map-width+ 900
  "The greatest width of a map if no scale is given, in pixels.")
(defconstant +greatest-map-height+ 700
  "The greatest height of a map if no scale is given, in pixels.")
(defconstant +least-scale+ 4 "The least scale if no scale is given, in pixels per cell.")
(defconstant +greatest-scale+ 40 "The greatest scale if no scale is given, in pixels per cell.")
(defconstant +greatest-unmagnified-scale+ 20
  "Scales above this number of pixels per cell also magnify text, unless they suit the map.")

(defstruct (arrangement (:copier nil))
  "The layout of a picture, in pixels. LEFT, TOP, RIGHT and BOTTOM are the map's margins, WIDTH and
HEIGHT the size of the picture. COLUMNS are the legend's columns, lists of entries. The legend is
below the map if BELOW-P, else at x LEGEND-LEFT. TITLE and SUBTITLE are lists of lines."
  (left 0) (top 0) (right 0) (bottom 0) (columns '()) (below-p nil) (legend-left 0)
  (title '()) (subtitle '()) (width 0) (height 0))

(defun margins-for-layers (layers)
  "Return a list of the left, top, right and bottom margins that LAYERS need, without a legend."
  (flet ((shown-p (layer) (member layer layers)))
    (if (layers-at-depth :margin layers)
        (list (if (shown-p :coordinates) 36 8)
              (+ (if (shown-p :title) 22 8) (if (shown-p :coordinates) 18 0))
              14
              (if (shown-p :scale-bar) 28 8))
        '(0 0 0 0))))

;;; The scale bar, which may be wider than a small map.

(defun scale-bar-length (width)
  "Return the length in metres of the scale bar for a map WIDTH metres wide."
  (or (first (last (one-two-five-series (min width (/ 140 graphics-scale*)))))
      1))

(defun metres-text (metres)
  (format nil "~D m" metres))

(defun scale-bar-width (width)
  "Return the width in pixels of the scale bar and its text for a map WIDTH metres wide."
  (let ((metres (scale-bar-length width)))
    (+ (to-pixels metres) 8 (monospaced-width (metres-text metres)))))

;;; Scales.

(defun fitting-scale (snapshot layers)
  "Return the scale, in pixels per cell, with which a picture of SNAPSHOT with LAYERS is at most
+GREATEST-MAP-WIDTH+ by +GREATEST-MAP-HEIGHT+ pixels large."
  (destructuring-bind (left top right bottom) (margins-for-layers layers)
    (multiple-value-bind (width height) (shown-size snapshot)
      (clamp (floor (min (/ (- +greatest-map-width+ left right) width)
                         (/ (- +greatest-map-height+ top bottom) height)))
             +least-scale+ +greatest-scale+))))

(defun suitable-scale (scale snapshot layers)
  "Return SCALE unless it is NIL. Otherwise return GRAPHICS-SCALE* if the user has set a value, else
the scale that suits the map of SNAPSHOT. Signals MISUSE if GRAPHICS-SCALE* is not a valid scale."
  (or scale
      (user-graphics-scale)
      (fitting-scale snapshot layers)))

(defun drawn-scale (scale snapshot layers)
  "Return two values for a picture of SNAPSHOT with LAYERS: the scale for drawing, in pixels per
cell, and the factor by which to magnify the drawn picture with its text and lines. SCALE is the
wanted scale: see SUITABLE-SCALE. The factor is 1 unless SCALE is above the scale for the map and
above +GREATEST-UNMAGNIFIED-SCALE+."
  (let* ((scale (suitable-scale scale snapshot layers))
         (zoom (max 1 (/ (rational scale)
                         (max +greatest-unmagnified-scale+ (fitting-scale snapshot layers))))))
    (values (/ scale zoom) zoom)))

;;; The legend.

(defun divide-into-columns (entries rows)
  (loop while entries
        collect (loop repeat rows while entries collect (pop entries))))

(defun samples-width (column)
  (reduce #'max column :key #'entry-width))

(defun column-width (column)
  (+ 18 (samples-width column)
     (loop for entry in column maximize (monospaced-width (entry-text entry)))))

(defun columns-width (columns)
  (reduce #'+ (mapcar #'column-width columns)))

(defun columns-height (columns)
  (* +line-height+ (length (first columns))))

(defun fit-into-columns (entries width)
  "Return ENTRIES divided into columns, together at most WIDTH pixels wide and as low as possible."
  (loop for rows from 1
        for columns = (divide-into-columns entries rows)
        when (or (null (rest columns)) (<= (columns-width columns) width))
          return columns))

;;; The whole.

(defun arrangement-with-columns (room edge map-height columns below-p)
  "Return an arrangement for a map MAP-HEIGHT pixels high and EDGE pixels wide, with the legend
COLUMNS below the map if BELOW-P, else beside it. ROOM is a value of MARGINS-FOR-LAYERS."
  (destructuring-bind (left top right bottom) room
    (let ((below (if (and columns below-p) (+ 8 (columns-height columns)) 0))
          (beside (if (and columns (not below-p)) (columns-width columns) 0)))
      (make-arrangement
       :left left :top top :right right :bottom bottom :columns columns :below-p below-p
       :legend-left (+ edge 14)
       :width (+ left right (max (+ edge beside) (if below-p (columns-width columns) 0)))
       :height (+ top (max (+ map-height bottom below)
                           (if below-p 0 (+ 8 (columns-height columns)))))))))

(defun arrangement-area (arrangement)
  (* (arrangement-width arrangement) (arrangement-height arrangement)))

(defun smallest-arrangement (snapshot layers entries)
  "Return the smallest arrangement for a picture of SNAPSHOT with LAYERS and a legend of ENTRIES."
  (multiple-value-bind (width height) (shown-size snapshot)
    (flet ((with (columns below-p)
             (arrangement-with-columns (margins-for-layers layers)
                                       (max (to-pixels width)
                                            (if (member :scale-bar layers) (scale-bar-width width)
                                                0))
                                       (to-pixels height) columns below-p)))
      (let ((beside (with (divide-into-columns entries
                                               (max 8 (floor (to-pixels height) +line-height+)))
                          nil))
            (below (with (fit-into-columns entries (max (to-pixels width) 480)) t)))
        (if (< (arrangement-area below) (arrangement-area beside)) below beside)))))

;;; The title is as wide as the rest, and has as many lines as it needs for that.

(defconstant +title-size+ 13 "The height of the font of titles, in pixels.")
(defconstant +title-step+ 17 "The distance between lines of a title, in pixels.")
(defconstant +subtitle-size+ 11 "The height of the font of subtitles, in pixels.")
(defconstant +subtitle-step+ 15 "The distance between lines of a subtitle, in pixels.")
(defconstant +least-title-width+ 360 "The least room for a line of a title, in pixels.")

(defun wrap-text-to-width (text width per-character)
  "Return TEXT, a string or NIL, as a list of lines of at most WIDTH pixels. A character is
PER-CHARACTER pixels wide."
  (and text
       (loop for line in (uiop:split-string text :separator '(#\Newline))
             append (wrapped-text line (max 1 (floor width per-character))))))

(defun lines-width (lines per-character)
  (ceiling (* per-character (reduce #'max lines :key #'length :initial-value 0))))

(defun add-title (arrangement title subtitle per-pixel)
  "Add TITLE to ARRANGEMENT, and below it SUBTITLE, a string or NIL. The width of a character is
PER-PIXEL times the height of its font."
  (let* ((room (max +least-title-width+ (arrangement-width arrangement)))
         (room (- room (arrangement-left arrangement) (arrangement-right arrangement)))
         (title-character (* per-pixel +title-size+))
         (subtitle-character (* per-pixel +subtitle-size+))
         (titles (wrap-text-to-width title room title-character))
         (subtitles (wrap-text-to-width subtitle room subtitle-character))
         (more (+ (* +title-step+ (1- (length titles))) (* +subtitle-step+ (length subtitles)))))
    (setf (arrangement-title arrangement) titles
          (arrangement-subtitle arrangement) subtitles
          (arrangement-width arrangement)
          (max (arrangement-width arrangement)
               (+ (arrangement-left arrangement) (arrangement-right arrangement)
                  (max (lines-width titles title-character)
                       (lines-width subtitles subtitle-character)))))
    (incf (arrangement-top arrangement) more)
    (incf (arrangement-height arrangement) more)))

;;;; Drawing what stands around the map

;;; The parts. The origin is that of the map.

(defun robots-and-map-title (robots map)
  "Return a title for a picture. ROBOTS are the names of its robots as drawn, MAP names its map."
  (format nil "~@[~A in ~]~A" (and robots (join-names robots)) (drawn-name map)))

(defun default-picture-title (snapshot)
  "Return the default title of a picture of SNAPSHOT: its robots, map and tick."
  (format nil "~A, tick ~D"
          (robots-and-map-title (mapcar #'robot-title (snapshot-robots snapshot))
                                (map-name (snapshot-map snapshot)))
          (snapshot-tick snapshot)))

(defun draw-title (canvas arrangement)
  (let ((y (- 16 (arrangement-top arrangement))))
    (dolist (line (arrangement-title arrangement))
      (draw-words canvas draw-gcontext* 0 y line :size +title-size+ :bold-p t)
      (incf y +title-step+))
    (with-color +frame-ink+
      (dolist (line (arrangement-subtitle arrangement))
        (draw-words canvas draw-gcontext* 0 (- y 2) line :size +subtitle-size+)
        (incf y +subtitle-step+)))))

(defun draw-coordinates (canvas snapshot)
  "Write coordinates in metres above and to the left of the part of the map that SNAPSHOT shows."
  (destructuring-bind (left top right bottom) (shown-part snapshot)
    (with-color +frame-ink+
      (dolist (metres (marks-between left right 40))
        (let ((x (to-pixels (- metres left))) (text (princ-to-string metres)))
          (draw-segments canvas draw-gcontext* (list x -6 x -2))
          (draw-text canvas (- x (/ (monospaced-width text) 2)) -8 text)))
      (dolist (metres (marks-between top bottom 40))
        (let ((y (to-pixels (- metres top))) (text (princ-to-string metres)))
          (draw-segments canvas draw-gcontext* (list -6 y -2 y))
          (draw-text canvas (- -8 (monospaced-width text)) (+ y 4) text))))))

(defun draw-scale-bar (canvas width y)
  "Draw the scale bar for a map WIDTH metres wide, with its middle at Y."
  (let* ((metres (scale-bar-length width)) (x (to-pixels metres)))
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext* (list 0 y x y 0 (- y 4) 0 (+ y 4) x (- y 4) x (+ y 4))))
    (draw-text canvas (+ x 8) (+ y 4) (metres-text metres))))

(defun draw-entry (canvas entry x y width)
  "Draw ENTRY with its upper left corner at X, Y. Samples in its column are WIDTH pixels wide."
  (let ((middle (+ y (/ +line-height+ 2))))
    (flet ((words () (draw-text canvas (+ x width 4) (+ middle 4) (entry-text entry))))
      (funcall (entry-sample entry) canvas (+ x -1 (/ width 2)) middle)
      (if (entry-whole entry)
          (with-subject (canvas (entry-whole entry)) (words))
          (words)))))

(defun draw-legend (canvas arrangement x y)
  (dolist (column (arrangement-columns arrangement))
    (loop for entry in column for row from 0
          do (draw-entry canvas entry x (+ y (* row +line-height+)) (samples-width column)))
    (incf x (column-width column))))

(defun draw-margins (canvas snapshot layers arrangement)
  (multiple-value-bind (metres-wide metres-high) (shown-size snapshot)
    (let ((width (to-pixels metres-wide)) (height (to-pixels metres-high)))
      (flet ((shown-p (layer) (member layer layers)))
        (when (layers-at-depth :margin layers)
          (with-color +frame-ink+
            (draw-rectangle canvas draw-gcontext* -1 -1 (1+ width) (1+ height))))
        (when (shown-p :title) (draw-title canvas arrangement))
        (when (shown-p :coordinates) (draw-coordinates canvas snapshot))
        (when (shown-p :scale-bar) (draw-scale-bar canvas metres-wide (+ height 14)))
        (when (arrangement-columns arrangement)
          (if (arrangement-below-p arrangement)
              (draw-legend canvas arrangement 0 (+ height (if (shown-p :scale-bar) 32 8)))
              (draw-legend canvas arrangement (arrangement-legend-left arrangement) 0)))))))

(defun call-on-map-part (function canvas snapshot)
  "Call FUNCTION with the origin of CANVAS in the corner of the map of SNAPSHOT. Clip what FUNCTION
draws on CANVAS to the part of the map that SNAPSHOT shows."
  (if (snapshot-part snapshot)
      (destructuring-bind (left top right bottom) (points-to-pixels (snapshot-part snapshot))
        (with-clipping (canvas 0 0 (- right left) (- bottom top))
          (with-origin (canvas (- left) (- top)) (funcall function))))
      (funcall function)))

(defun draw-framed (canvas snapshot layers draw &key title subtitle more legend)
  "Draw a picture of SNAPSHOT with the margins, title and legend that LAYERS list. DRAW is a
function that draws the map and its contents. Return three values in pixels: the width and the
height of the picture, and the left margin of the map. TITLE is by default the robots, the map and
the tick. SUBTITLE is a string or NIL. MORE are the first entries of the legend. LEGEND are options
of LEGEND-ENTRIES for the other entries."
  (let* ((entries (and (member :legend layers)
                       (append more (apply #'legend-entries snapshot layers legend))))
         (arrangement (smallest-arrangement snapshot layers entries))
         (left (arrangement-left arrangement)))
    (when (member :title layers)
      (add-title arrangement (or title (default-picture-title snapshot)) subtitle
                 (character-width canvas 1)))
    (with-origin (canvas left (arrangement-top arrangement))
      (draw-margins canvas snapshot layers arrangement)
      (call-on-map-part draw canvas snapshot))
    (values (arrangement-width arrangement) (arrangement-height arrangement) left)))

(defun draw-framed-world (canvas snapshot layers &key title subtitle)
  "Draw SNAPSHOT with LAYERS, and with TITLE and SUBTITLE as in DRAW-FRAMED. Return the width and
height in pixels."
  (draw-framed canvas snapshot layers
               (lambda ()
                 (draw-terrain canvas (snapshot-map snapshot) :layers layers)
                 (draw-movers canvas snapshot layers))
               :title title :subtitle subtitle))

(defun call-with-map-svg (function stream snapshot &key layers in-color scale)
  (multiple-value-bind (scale zoom) (drawn-scale scale snapshot layers)
    (with-svg (canvas stream :color-p in-color :zoom zoom)
      (with-canvas (canvas :scale scale) (funcall function canvas)))))

(defmacro with-map-svg ((canvas stream snapshot &rest options) &body body)
  "Run BODY, which draws a picture of SNAPSHOT on CANVAS and returns its width and height in pixels.
Then write the picture to STREAM as an SVG document. OPTIONS: :layers, :in-color, :scale."
  `(call-with-map-svg (lambda (,canvas) ,@body) ,stream ,snapshot ,@options))

(defun framed-picture-svg (snapshot draw &key layers in-color scale title subtitle more legend)
  "Return an SVG document of SNAPSHOT. DRAW, a function of a canvas, draws the map and its contents.
The other arguments are those of WITH-MAP-SVG and DRAW-FRAMED."
  (with-output-to-string (out)
    (with-map-svg (canvas out snapshot :layers layers :in-color in-color :scale scale)
      (draw-framed canvas snapshot layers (lambda () (funcall draw canvas))
                   :title title :subtitle subtitle :more more :legend legend))))
