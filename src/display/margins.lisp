;;;; margins.lisp -- what stands around the map in a picture: title, coordinates, legend, scale bar.

(in-package :ars-magna.display)

;;; The parts. The origin is that of the map.

(define-constant +title-size+ 13 :documentation "How high the font of titles is, in pixels.")

(defun map-title (snapshot)
  "Return what stands above a picture of SNAPSHOT unless somebody says what."
  (format nil "~{~A~^, ~} in ~A, tick ~D"
          (mapcar #'robot-title (snapshot-robots snapshot))
          (drawn-name (map-name (snapshot-map snapshot))) (snapshot-tick snapshot)))

(defun title-width (canvas title layers)
  "Return how wide TITLE is, in pixels, if LAYERS show it: 0 if not."
  (if (member :title layers)
      (ceiling (* (character-width canvas +title-size+) (length title)))
      0))

(defun draw-map-title (canvas title y)
  (draw-words canvas draw-gcontext* 0 y title :size +title-size+ :bold-p t))

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

(defun draw-scale-bar (canvas map y)
  (let* ((metres (bar-metres map)) (x (to-pixels metres)))
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext* (list 0 y x y 0 (- y 4) 0 (+ y 4) x (- y 4) x (+ y 4))))
    (draw-text canvas (+ x 8) (+ y 4) (metres-text metres))))

(defun draw-entry (canvas entry x y)
  "Draw ENTRY, its upper left corner at X, Y."
  (let ((middle (+ y (/ +line-height+ 2))))
    (flet ((words () (draw-text canvas (+ x 22) (+ middle 4) (entry-text entry))))
      (funcall (entry-sample entry) canvas (+ x 8) middle)
      (if (entry-whole entry)
          (with-subject (canvas (entry-whole entry)) (words))
          (words)))))

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
            (draw-legend canvas arrangement (arrangement-legend-left arrangement) 0))))))

(defun arrangement-for (canvas snapshot layers title more)
  "Return the arrangement for a picture of SNAPSHOT with LAYERS on CANVAS, with TITLE, and with MORE
entries of the legend."
  (arrange snapshot layers
           (and (member :legend layers) (append more (legend-entries snapshot layers)))
           (title-width canvas title layers)))

(defun draw-framed (canvas snapshot layers draw &key title more)
  "Draw around the map of SNAPSHOT what LAYERS lists, and call DRAW, which draws the map and what is
on it; return width and height of all that, and how far from the left the map begins. TITLE stands
above, or if it is NIL, robots, map and tick; MORE are entries of the legend that come first."
  (let* ((title (or title (map-title snapshot)))
         (arrangement (arrangement-for canvas snapshot layers title more))
         (left (arrangement-left arrangement)))
    (with-origin (canvas left (arrangement-top arrangement))
      (draw-margins canvas snapshot layers arrangement title)
      (funcall draw))
    (values (arrangement-width arrangement) (arrangement-height arrangement) left)))

(defun draw-framed-world (canvas snapshot layers)
  "Draw the world of SNAPSHOT and around it what LAYERS lists; return width and height of that."
  (draw-framed canvas snapshot layers
               (lambda () (draw-world canvas snapshot :layers layers))))

(defun call-with-map-svg (function stream snapshot &key layers in-color scale)
  "Call FUNCTION with a canvas, then write what it has drawn, a picture of SNAPSHOT with LAYERS, to
STREAM as an SVG document, magnified as SCALE demands. FUNCTION returns its width and height."
  (multiple-value-bind (scale zoom) (drawn-scale scale snapshot layers)
    (with-svg (canvas stream :color-p in-color :zoom zoom)
      (with-canvas (canvas :scale scale) (funcall function canvas)))))

(defmacro with-map-svg ((canvas stream snapshot &rest options) &body body)
  "Run BODY, which draws a picture of SNAPSHOT on CANVAS and returns its width and height in pixels,
as two values, then write that to STREAM as an SVG document. OPTIONS: :layers, :in-color, :scale."
  `(call-with-map-svg (lambda (,canvas) ,@body) ,stream ,snapshot ,@options))
