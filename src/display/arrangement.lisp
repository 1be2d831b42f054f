;;;; arrangement.lisp -- how large a map is drawn, and where what is around it stands.

(in-package :ars-magna.display)

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
says; and how wide and high the whole is."
  (left 0) (top 0) (right 0) (bottom 0) (columns '()) (below-p nil) (legend-left 0)
  (width 0) (height 0))

(defun room-for (layers)
  "Return how much room there is left of, above, right of and below the map for LAYERS without
legend."
  (flet ((shown-p (layer) (member layer layers)))
    (if (intersection layers (layers-of-kind :margin))
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

(defun bar-metres (map)
  "Return how many metres a scale bar is long."
  (or (first (last (round-numbers (min (map-width map) (/ 140 graphics-scale*)))))
      1))

(defun metres-text (metres)
  "Return what stands beside a scale bar of METRES."
  (format nil "~D m" metres))

(defun scale-bar-width (map)
  "Return how wide the scale bar of MAP is with its text, in pixels."
  (let ((metres (bar-metres map)))
    (+ (to-pixels metres) 8 (words-width (metres-text metres)))))

(defun right-edge (map layers)
  "Return how far right MAP and the scale bar below it reach, in pixels."
  (max (to-pixels (map-width map)) (if (member :scale-bar layers) (scale-bar-width map) 0)))

;;; Scales.

(defun fitting-scale (map layers)
  "Return how many pixels a cell of MAP has for a picture with LAYERS not to be too large."
  (destructuring-bind (left top right bottom) (room-for layers)
    (clamp (floor (min (/ (- +widest+ left right) (map-width map))
                       (/ (- +highest+ top bottom) (map-height map))))
           +least-scale+ +greatest-scale+)))

(defun suitable-scale (scale snapshot layers)
  "Return SCALE, or if it is NIL, GRAPHICS-SCALE* if the user has set that, or else the scale that
suits the map of SNAPSHOT. Signals MISUSE if GRAPHICS-SCALE* is no scale."
  (or scale
      (users-scale)
      (fitting-scale (snapshot-map snapshot) layers)))

(defun magnification (scale snapshot layers)
  "Return how much a picture of SNAPSHOT with SCALE pixels to a cell is magnified as a whole, text
and lines included, 1 at least: as far as SCALE is more than suits the map and than is needed to
read all."
  (max 1 (/ (rational scale)
            (max +readable-scale+ (fitting-scale (snapshot-map snapshot) layers)))))

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

(defun column-width (column)
  "Return how wide COLUMN, a list of entries, is, in pixels."
  (+ 36 (loop for entry in column maximize (words-width (entry-text entry)))))

(defun columns-width (columns)
  (reduce #'+ (mapcar #'column-width columns)))

(defun columns-height (columns)
  (* +line-height+ (length (first columns))))

(defun columns-beside (entries height)
  "Return ENTRIES in columns no higher than HEIGHT pixels, if that can be."
  (columns-of entries (max 8 (floor height +line-height+))))

(defun columns-below (entries width)
  "Return ENTRIES in columns, as low as can be, that together are no wider than WIDTH pixels."
  (loop for rows from 1
        for columns = (columns-of entries rows)
        when (or (null (rest columns)) (<= (columns-width columns) width))
          return columns))

;;; The whole. What has been drawn with the origin in the corner of the map is known by now.

(defun arrangement-with (room edge map-height title-width columns below-p)
  "Return an arrangement around a map MAP-HEIGHT pixels high that reaches EDGE pixels right, with a
title TITLE-WIDTH pixels wide. ROOM is as ROOM-FOR has it."
  (destructuring-bind (left top right bottom) room
    (let ((below (if (and columns below-p) (+ 8 (columns-height columns)) 0))
          (beside (if (and columns (not below-p)) (columns-width columns) 0)))
      (make-arrangement
       :left left :top top :right right :bottom bottom :columns columns :below-p below-p
       :legend-left (+ edge 14)
       :width (+ left right (max (+ edge beside) title-width
                                 (if below-p (columns-width columns) 0)))
       :height (+ top (max (+ map-height bottom below)
                           (if below-p 0 (+ 8 (columns-height columns)))))))))

(defun area (arrangement)
  (* (arrangement-width arrangement) (arrangement-height arrangement)))

(defun arrange (snapshot layers entries title-width)
  "Return the arrangement for a picture of SNAPSHOT with LAYERS, a legend of ENTRIES and a title
TITLE-WIDTH pixels wide that takes the least room."
  (let* ((map (snapshot-map snapshot)) (room (room-for layers))
         (width (to-pixels (map-width map))) (height (to-pixels (map-height map))))
    (flet ((with (columns below-p)
             (arrangement-with room (right-edge map layers) height title-width columns below-p)))
      (let ((beside (with (columns-beside entries height) nil))
            (below (with (columns-below entries (max width 480)) t)))
        (if (< (area below) (area beside)) below beside)))))
