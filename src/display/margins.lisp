;;;; margins.lisp -- what stands around the map in a picture: title, coordinates, legend, scale bar.

(in-package :ars-magna.display)

;;; A picture is an arrangement of the map and of what is around it. Where nobody says how many
;;; pixels a cell has, there are as many as make the picture no larger than +WIDEST+ by +HIGHEST+.

(define-constant +widest+ 900 :documentation "How wide a picture of a world should be, in pixels.")
(define-constant +highest+ 700 :documentation "How high a picture of a world should be, in pixels.")
(define-constant +least-scale+ 4 :documentation "How many pixels a cell has at least.")
(define-constant +greatest-scale+ 40 :documentation "How many pixels a cell has at most.")
(define-constant +usual-scale+ 8 :documentation "What GRAPHICS-SCALE* is until a user sets it.")

(defstruct (arrangement (:copier nil))
  "Where the map begins, how much room there is to its right and below, and the legend: COLUMNS,
lists of entries, beside the map or BELOW-P, and how high it is."
  (left 0) (top 0) (right 0) (bottom 0) (columns '()) (high 0) (below-p nil))

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

(defun columns-of (entries rows)
  "Return ENTRIES as a list of lists of no more than ROWS of them."
  (loop while entries
        collect (loop repeat rows while entries collect (pop entries))))

(defun column-width (column)
  "Return how wide COLUMN, a list of entries, is, in pixels."
  (+ 36 (loop for entry in column maximize (words-width (entry-text entry)))))

(defun columns-width (columns)
  (reduce #'+ (mapcar #'column-width columns)))

(defun legend-beside (entries room)
  "Return the arrangement with a legend of ENTRIES to the right of the map. ROOM is as ROOM-FOR has
it."
  (destructuring-bind (left top right bottom) room
    (let ((columns (columns-of entries (floor (- +highest+ top bottom) +line-height+))))
      (make-arrangement :left left :top top :right (+ right (columns-width columns))
                        :bottom bottom :columns columns
                        :high (* +line-height+ (length (first columns)))))))

(defun legend-below (entries room)
  "Return the arrangement with a legend of ENTRIES below the map."
  (destructuring-bind (left top right bottom) room
    (loop for rows from 1
          for columns = (columns-of entries rows)
          when (or (null (rest columns))
                   (<= (columns-width columns) (- +widest+ left right)))
            return (let ((high (* rows +line-height+)))
                     (make-arrangement :left left :top top :right right :below-p t
                                       :bottom (+ bottom 8 high) :columns columns :high high)))))

(defun fitting-scale (map arrangement)
  "Return how many pixels a cell of MAP has for the picture not to be too large."
  (clamp (floor (min (/ (- +widest+ (arrangement-left arrangement) (arrangement-right arrangement))
                        (map-width map))
                     (/ (- +highest+ (arrangement-top arrangement) (arrangement-bottom arrangement))
                        (map-height map))))
         +least-scale+ +greatest-scale+))

(defun arrange (snapshot layers &optional more)
  "Return the arrangement for a picture of SNAPSHOT with LAYERS in which the map is largest. MORE
are entries of the legend that come before the others."
  (let ((room (room-for layers)) (map (snapshot-map snapshot))
        (entries (and (member :legend layers)
                      (append more (legend-entries snapshot layers)))))
    (if entries
        (let ((beside (legend-beside entries room)) (below (legend-below entries room)))
          (if (< (fitting-scale map beside) (fitting-scale map below)) below beside))
        (destructuring-bind (left top right bottom) room
          (make-arrangement :left left :top top :right right :bottom bottom)))))

(defun suitable-scale (scale snapshot layers &optional more)
  "Return SCALE, or if it is NIL, GRAPHICS-SCALE* if the user has set that, or else the scale that
suits the map of SNAPSHOT with LAYERS, and MORE entries of the legend."
  (cond (scale)
        ((/= graphics-scale* +usual-scale+) graphics-scale*)
        (t (fitting-scale (snapshot-map snapshot) (arrange snapshot layers more)))))

;;; The parts. The origin is that of the map.

(defun map-title (snapshot)
  "Return what stands above a picture of SNAPSHOT unless somebody says what."
  (format nil "~(~{~A~^, ~} in ~A~), tick ~D"
          (mapcar #'robot-image-name (snapshot-robots snapshot))
          (map-name (snapshot-map snapshot)) (snapshot-tick snapshot)))

(defun draw-map-title (canvas title y)
  (draw-words canvas draw-gcontext* 0 y title :size 13 :bold-p t))

(defun draw-coordinates (canvas map)
  "Write metres above and to the left of MAP."
  (let ((step (steps-apart 40)))
    (with-color +frame-ink+
      (loop for metres from 0 to (map-width map) by step
            for x = (to-pixels metres) for text = (princ-to-string metres)
            do (draw-segments canvas draw-gcontext* (list x -6 x -2))
               (draw-text canvas (- x (/ (words-width text) 2)) -8 text))
      (loop for metres from 0 to (map-height map) by step
            for y = (to-pixels metres) for text = (princ-to-string metres)
            do (draw-segments canvas draw-gcontext* (list -6 y -2 y))
               (draw-text canvas (- -8 (words-width text)) (+ y 4) text)))))

(defun round-numbers (limit)
  "Return 1, 2, 5, 10 and so on up to LIMIT."
  (loop for unit = 1 then (* 10 unit)
        while (<= unit limit)
        append (remove-if (lambda (number) (< limit number)) (list unit (* 2 unit) (* 5 unit)))))

(defun bar-metres (map)
  "Return how many metres a scale bar is long."
  (or (first (last (round-numbers (min (map-width map) (/ 140 graphics-scale*)))))
      1))

(defun draw-scale-bar (canvas map y)
  (let* ((metres (bar-metres map)) (x (to-pixels metres)))
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext* (list 0 y x y 0 (- y 4) 0 (+ y 4) x (- y 4) x (+ y 4))))
    (draw-text canvas (+ x 8) (+ y 4) (format nil "~D m" metres))))

(defun draw-entry (canvas entry x y)
  "Draw ENTRY, its upper left corner at X, Y."
  (let ((middle (+ y (/ +line-height+ 2))))
    (funcall (entry-sample entry) canvas (+ x 8) middle)
    (draw-text canvas (+ x 22) (+ middle 4) (entry-text entry))))

(defun draw-legend (canvas arrangement x y)
  "Draw the legend of ARRANGEMENT, its upper left corner at X, Y."
  (dolist (column (arrangement-columns arrangement))
    (loop for entry in column for row from 0
          do (draw-entry canvas entry x (+ y (* row +line-height+))))
    (incf x (column-width column))))

(defun draw-margins (canvas snapshot layers arrangement title)
  (let* ((map (snapshot-map snapshot))
         (width (to-pixels (map-width map))) (height (to-pixels (map-height map))))
    (flet ((shown-p (layer) (member layer layers)))
      (when (intersection layers (layers-of-kind :margin))
        (with-color +frame-ink+
          (draw-rectangle canvas draw-gcontext* -1 -1 (1+ width) (1+ height))))
      (when (shown-p :title)
        (draw-map-title canvas title (- 16 (arrangement-top arrangement))))
      (when (shown-p :coordinates) (draw-coordinates canvas map))
      (when (shown-p :scale-bar) (draw-scale-bar canvas map (+ height 14)))
      (when (arrangement-columns arrangement)
        (if (arrangement-below-p arrangement)
            (draw-legend canvas arrangement 0 (+ height (if (shown-p :scale-bar) 32 8)))
            (draw-legend canvas arrangement (+ width 14) 0))))))

(defun draw-framed (canvas snapshot layers draw &key title more)
  "Draw around the map of SNAPSHOT what LAYERS lists, and call DRAW, which draws the map and what is
on it; return width and height of all that, and how far from the left the map begins. TITLE is what
stands above, instead of the robots, map and tick; MORE are entries of the legend that come first."
  (let* ((arrangement (arrange snapshot layers more)) (map (snapshot-map snapshot))
         (left (arrangement-left arrangement)) (top (arrangement-top arrangement)))
    (with-origin (canvas left top)
      (draw-margins canvas snapshot layers arrangement (or title (map-title snapshot)))
      (funcall draw))
    (values (+ left (max (to-pixels (map-width map))
                         (if (arrangement-below-p arrangement)
                             (columns-width (arrangement-columns arrangement))
                             0))
               (arrangement-right arrangement))
            (max (+ top (to-pixels (map-height map)) (arrangement-bottom arrangement))
                 (if (arrangement-below-p arrangement)
                     0
                     (+ top (arrangement-high arrangement) 8)))
            left)))

(defun draw-framed-world (canvas snapshot layers)
  "Draw the world of SNAPSHOT and around it what LAYERS lists; return width and height of that."
  (draw-framed canvas snapshot layers
               (lambda () (draw-world canvas snapshot :layers layers))))
