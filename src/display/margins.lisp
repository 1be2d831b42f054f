;;;; margins.lisp -- what stands around the map in a picture: title, coordinates, legend, scale bar.

(in-package :ars-magna.display)

(export '(draw-framed with-map-svg))

;;; The parts. The origin is that of the map.

(defun title-of (robots map)
  "Return what a title says of ROBOTS, a list of names as they are drawn, in MAP, a name."
  (format nil "~@[~A in ~]~A" (and robots (joined robots)) (drawn-name map)))

(defun map-title (snapshot)
  "Return what stands above a picture of SNAPSHOT unless somebody says what."
  (format nil "~A, tick ~D"
          (title-of (mapcar #'robot-title (snapshot-robots snapshot))
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
  "Write metres above and to the left of what is to be shown of the map of SNAPSHOT."
  (destructuring-bind (left top right bottom) (shown-part snapshot)
    (with-color +frame-ink+
      (dolist (metres (marks-between left right 40))
        (let ((x (to-pixels (- metres left))) (text (princ-to-string metres)))
          (draw-segments canvas draw-gcontext* (list x -6 x -2))
          (draw-text canvas (- x (/ (words-width text) 2)) -8 text)))
      (dolist (metres (marks-between top bottom 40))
        (let ((y (to-pixels (- metres top))) (text (princ-to-string metres)))
          (draw-segments canvas draw-gcontext* (list -6 y -2 y))
          (draw-text canvas (- -8 (words-width text)) (+ y 4) text))))))

(defun draw-scale-bar (canvas width y)
  "Draw a scale bar around Y that suits WIDTH metres."
  (let* ((metres (bar-metres width)) (x (to-pixels metres)))
    (with-lines (:width 2)
      (draw-segments canvas draw-gcontext* (list 0 y x y 0 (- y 4) 0 (+ y 4) x (- y 4) x (+ y 4))))
    (draw-text canvas (+ x 8) (+ y 4) (metres-text metres))))

(defun draw-entry (canvas entry x y width)
  "Draw ENTRY, its upper left corner at X, Y, in a column of samples WIDTH pixels wide."
  (let ((middle (+ y (/ +line-height+ 2))))
    (flet ((words () (draw-text canvas (+ x width 4) (+ middle 4) (entry-text entry))))
      (funcall (entry-sample entry) canvas (+ x -1 (/ width 2)) middle)
      (if (entry-whole entry)
          (with-subject (canvas (entry-whole entry)) (words))
          (words)))))

(defun draw-legend (canvas arrangement x y)
  "Draw the legend of ARRANGEMENT, its upper left corner at X, Y."
  (dolist (column (arrangement-columns arrangement))
    (loop for entry in column for row from 0
          do (draw-entry canvas entry x (+ y (* row +line-height+)) (samples-width column)))
    (incf x (column-width column))))

(defun draw-margins (canvas snapshot layers arrangement)
  (multiple-value-bind (metres-wide metres-high) (shown-size snapshot)
    (let ((width (to-pixels metres-wide)) (height (to-pixels metres-high)))
      (flet ((shown-p (layer) (member layer layers)))
        (when (layers-at :margin layers)
          (with-color +frame-ink+
            (draw-rectangle canvas draw-gcontext* -1 -1 (1+ width) (1+ height))))
        (when (shown-p :title) (draw-title canvas arrangement))
        (when (shown-p :coordinates) (draw-coordinates canvas snapshot))
        (when (shown-p :scale-bar) (draw-scale-bar canvas metres-wide (+ height 14)))
        (when (arrangement-columns arrangement)
          (if (arrangement-below-p arrangement)
              (draw-legend canvas arrangement 0 (+ height (if (shown-p :scale-bar) 32 8)))
              (draw-legend canvas arrangement (arrangement-legend-left arrangement) 0)))))))

(defun arrangement-for (canvas snapshot layers title subtitle more legend)
  "Return the arrangement for a picture of SNAPSHOT with LAYERS on CANVAS, with TITLE and SUBTITLE,
and with MORE entries of the legend, of which LEGEND has the options."
  (let ((arrangement (arrange snapshot layers
                              (and (member :legend layers)
                                   (append more
                                           (apply #'legend-entries snapshot layers legend))))))
    (if (member :title layers)
        (with-title arrangement (or title (map-title snapshot)) subtitle
          (character-width canvas 1))
        arrangement)))

(defun call-on-part (function canvas snapshot)
  "Call FUNCTION with the origin in the corner of the map of SNAPSHOT; what it draws on CANVAS
beside what is to be shown of that stays invisible."
  (if (snapshot-part snapshot)
      (destructuring-bind (left top right bottom) (pixels-of (snapshot-part snapshot))
        (with-clipping (canvas 0 0 (- right left) (- bottom top))
          (with-origin (canvas (- left) (- top)) (funcall function))))
      (funcall function)))

(defun draw-framed (canvas snapshot layers draw &key title subtitle more legend)
  "Draw around the map of SNAPSHOT what LAYERS lists, and call DRAW, which draws the map and what is
on it; return width and height of all that, and how far from the left the map begins. TITLE stands
above, or if it is NIL, robots, map and tick; then SUBTITLE, if any. MORE are entries of the legend
that come first; LEGEND are options of LEGEND-ENTRIES for the others."
  (let* ((arrangement (arrangement-for canvas snapshot layers title subtitle more legend))
         (left (arrangement-left arrangement)))
    (with-origin (canvas left (arrangement-top arrangement))
      (draw-margins canvas snapshot layers arrangement)
      (call-on-part draw canvas snapshot))
    (values (arrangement-width arrangement) (arrangement-height arrangement) left)))

(defun draw-framed-world (canvas snapshot layers &key title)
  "Draw the world of SNAPSHOT and around it what LAYERS lists, with TITLE as DRAW-FRAMED has it;
return width and height of that."
  (draw-framed canvas snapshot layers
               (lambda ()
                 (draw-terrain canvas (snapshot-map snapshot) :layers layers)
                 (draw-movers canvas snapshot layers))
               :title title))

(defun call-with-map-svg (function stream snapshot &key layers in-color scale)
  (multiple-value-bind (scale zoom) (drawn-scale scale snapshot layers)
    (with-svg (canvas stream :color-p in-color :zoom zoom)
      (with-canvas (canvas :scale scale) (funcall function canvas)))))

(defmacro with-map-svg ((canvas stream snapshot &rest options) &body body)
  "Run BODY, which draws a picture of SNAPSHOT on CANVAS and returns its width and height in pixels,
as two values, then write that to STREAM as an SVG document. OPTIONS: :layers, :in-color, :scale."
  `(call-with-map-svg (lambda (,canvas) ,@body) ,stream ,snapshot ,@options))
