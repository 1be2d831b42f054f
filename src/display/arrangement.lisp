;;;; arrangement.lisp -- how large a map is drawn, and where what is around it stands.

(in-package :ars-magna.display)

(export '(users-scale drawn-scale lines-within))

(define-constant +usual-scale+ 8 :documentation "What GRAPHICS-SCALE* is until a user sets it.")

(define-argument-type 'picture-scale (lambda (value) (and (finite-p value) (<= 1 value 256)))
  "a number of pixels to a cell, from 1 to 256")

(defun users-scale ()
  "Return GRAPHICS-SCALE* if the user has set it to another value than the default, or NIL. Signals
MISUSE if that is no scale."
  (cond ((eql graphics-scale* +usual-scale+) nil)
        ((argument-of-type-p graphics-scale* 'picture-scale) graphics-scale*)
        (t (reject-use "graphics-scale* is ~S, but should be ~A. Set it to such a number, or to ~
                        ~D: then pictures have the scale that suits their map."
                       graphics-scale* (argument-type-text 'picture-scale) +usual-scale+))))

;;; Where nobody says how many pixels a cell has, there are as many as make the map, with title,
;;; coordinates and scale bar, no larger than +WIDEST+ by +HIGHEST+. The legend comes on top of
;;; that, beside the map or below it, where it makes the page less large: the map does not shrink
;;; for it.

(define-constant +widest+ 900 :documentation "How wide a map should be, in pixels.")
(define-constant +highest+ 700 :documentation "How high a map should be, in pixels.")
(define-constant +least-scale+ 4 :documentation "How many pixels a cell has at least.")
(define-constant +greatest-scale+ 40 :documentation "How many pixels a cell has at most.")
(define-constant +readable-scale+ 20
  :documentation "From how many pixels a cell on a picture may be magnified as a whole.")

(defstruct (arrangement (:copier nil))
  "Where the map begins, how much room there is to its right and below, and the legend: COLUMNS,
lists of entries, BELOW-P or beside the map, there so far from the left of the map as LEGEND-LEFT
says; TITLE and SUBTITLE, lists of lines; and how wide and high the whole is."
  (left 0) (top 0) (right 0) (bottom 0) (columns '()) (below-p nil) (legend-left 0)
  (title '()) (subtitle '()) (width 0) (height 0))

(defun room-for (layers)
  "Return how much room there is left of, above, right of and below the map for LAYERS without
legend."
  (flet ((shown-p (layer) (member layer layers)))
    (if (layers-at :margin layers)
        (list (if (shown-p :coordinates) 36 8)
              (+ (if (shown-p :title) 22 8) (if (shown-p :coordinates) 18 0))
              14
              (if (shown-p :scale-bar) 28 8))
        '(0 0 0 0))))

;;; The scale bar, which may be wider than a small map.

(defun round-numbers (limit)
  "Return 1, 2, 5, 10 and so on up to LIMIT."
  (loop for unit = 1 then (* 10 unit)
        while (<= unit limit)
        append (remove-if (lambda (number) (< limit number)) (list unit (* 2 unit) (* 5 unit)))))

(defun bar-metres (width)
  "Return how many metres a scale bar below WIDTH metres is long."
  (or (first (last (round-numbers (min width (/ 140 graphics-scale*)))))
      1))

(defun metres-text (metres)
  (format nil "~D m" metres))

(defun scale-bar-width (width)
  "Return how wide the scale bar below WIDTH metres is with its text, in pixels."
  (let ((metres (bar-metres width)))
    (+ (to-pixels metres) 8 (words-width (metres-text metres)))))

(defun right-edge (width layers)
  "Return how far right a map WIDTH metres wide and the scale bar below it reach, in pixels."
  (max (to-pixels width) (if (member :scale-bar layers) (scale-bar-width width) 0)))

;;; Scales.

(defun fitting-scale (snapshot layers)
  "Return how many pixels a cell has for a picture of SNAPSHOT with LAYERS not to be too large."
  (destructuring-bind (left top right bottom) (room-for layers)
    (multiple-value-bind (width height) (shown-size snapshot)
      (clamp (floor (min (/ (- +widest+ left right) width) (/ (- +highest+ top bottom) height)))
             +least-scale+ +greatest-scale+))))

(defun suitable-scale (scale snapshot layers)
  "Return SCALE, or if it is NIL, GRAPHICS-SCALE* if the user has set that, or else the scale that
suits the map of SNAPSHOT. Signals MISUSE if GRAPHICS-SCALE* is no scale."
  (or scale
      (users-scale)
      (fitting-scale snapshot layers)))

(defun magnification (scale snapshot layers)
  "Return how much a picture of SNAPSHOT with SCALE pixels to a cell is magnified as a whole, text
and lines included, 1 at least: as far as SCALE is more than suits the map and than is needed to
read all."
  (max 1 (/ (rational scale)
            (max +readable-scale+ (fitting-scale snapshot layers)))))

(defun drawn-scale (scale snapshot layers)
  "Return how many pixels a cell has where a picture of SNAPSHOT with SCALE (see SUITABLE-SCALE) and
LAYERS is drawn, and how much that is then to be magnified as a whole."
  (let* ((scale (suitable-scale scale snapshot layers))
         (zoom (magnification scale snapshot layers)))
    (values (/ scale zoom) zoom)))

;;; The legend.

(defun columns-of (entries rows)
  "Return ENTRIES as a list of lists of no more than ROWS of them."
  (loop while entries
        collect (loop repeat rows while entries collect (pop entries))))

(defun samples-width (column)
  "Return how wide the samples of COLUMN, a list of entries, are, in pixels."
  (reduce #'max column :key #'entry-width))

(defun column-width (column)
  "Return how wide COLUMN, a list of entries, is, in pixels."
  (+ 18 (samples-width column)
     (loop for entry in column maximize (words-width (entry-text entry)))))

(defun columns-width (columns)
  (reduce #'+ (mapcar #'column-width columns)))

(defun columns-height (columns)
  (* +line-height+ (length (first columns))))

(defun columns-below (entries width)
  "Return ENTRIES in columns, as low as can be, that together are no wider than WIDTH pixels."
  (loop for rows from 1
        for columns = (columns-of entries rows)
        when (or (null (rest columns)) (<= (columns-width columns) width))
          return columns))

;;; The whole. What has been drawn with the origin in the corner of the map is known by now.

(defun arrangement-with (room edge map-height columns below-p)
  "Return an arrangement around a map MAP-HEIGHT pixels high that reaches EDGE pixels right. ROOM is
as ROOM-FOR has it."
  (destructuring-bind (left top right bottom) room
    (let ((below (if (and columns below-p) (+ 8 (columns-height columns)) 0))
          (beside (if (and columns (not below-p)) (columns-width columns) 0)))
      (make-arrangement
       :left left :top top :right right :bottom bottom :columns columns :below-p below-p
       :legend-left (+ edge 14)
       :width (+ left right (max (+ edge beside) (if below-p (columns-width columns) 0)))
       :height (+ top (max (+ map-height bottom below)
                           (if below-p 0 (+ 8 (columns-height columns)))))))))

(defun area (arrangement)
  (* (arrangement-width arrangement) (arrangement-height arrangement)))

(defun arrange (snapshot layers entries)
  "Return the arrangement for a picture of SNAPSHOT with LAYERS and a legend of ENTRIES that takes
the least room."
  (multiple-value-bind (width height) (shown-size snapshot)
    (flet ((with (columns below-p)
             (arrangement-with (room-for layers) (right-edge width layers) (to-pixels height)
                               columns below-p)))
      (let ((beside (with (columns-of entries (max 8 (floor (to-pixels height) +line-height+)))
                          nil))
            (below (with (columns-below entries (max (to-pixels width) 480)) t)))
        (if (< (area below) (area beside)) below beside)))))

;;; The title is as wide as the rest, and has as many lines as it needs for that.

(define-constant +title-size+ 13 :documentation "How high the font of titles is, in pixels.")
(define-constant +title-step+ 17 :documentation "How far lines of a title are apart, in pixels.")
(define-constant +subtitle-size+ 11 :documentation "How high the font below titles is, in pixels.")
(define-constant +subtitle-step+ 15 :documentation "How far lines below titles are apart.")
(define-constant +least-title+ 360
  :documentation "How wide a line of a title may be at least, in pixels.")

(defun lines-within (text width per-character)
  "Return TEXT, or NIL, as lines of at most WIDTH pixels, of which a character has PER-CHARACTER."
  (and text
       (loop for line in (uiop:split-string text :separator '(#\Newline))
             append (wrapped-text line (max 1 (floor width per-character))))))

(defun lines-width (lines per-character)
  (ceiling (* per-character (reduce #'max lines :key #'length :initial-value 0))))

(defun with-title (arrangement title subtitle per-pixel)
  "Return ARRANGEMENT with TITLE, and SUBTITLE, a string or NIL, below that; a character is
PER-PIXEL pixels wide for each pixel that its font is high."
  (let* ((room (max +least-title+ (arrangement-width arrangement)))
         (room (- room (arrangement-left arrangement) (arrangement-right arrangement)))
         (title-character (* per-pixel +title-size+))
         (subtitle-character (* per-pixel +subtitle-size+))
         (titles (lines-within title room title-character))
         (subtitles (lines-within subtitle room subtitle-character))
         (more (+ (* +title-step+ (1- (length titles))) (* +subtitle-step+ (length subtitles)))))
    (setf (arrangement-title arrangement) titles
          (arrangement-subtitle arrangement) subtitles
          (arrangement-width arrangement)
          (max (arrangement-width arrangement)
               (+ (arrangement-left arrangement) (arrangement-right arrangement)
                  (max (lines-width titles title-character)
                       (lines-width subtitles subtitle-character)))))
    (incf (arrangement-top arrangement) more)
    (incf (arrangement-height arrangement) more)
    arrangement))
