;;;; view-margins.lisp -- coordinates and scale bar for a window, at the edges of what is in view.

(in-package :ars-magna.display)

;;; A window shows a part of the map and has no room around it; so numbers and bar lie on the map,
;;; on white plates. All is in pixels of the whole map: LEFT and TOP are where the view begins.

(defun marks-between (start end step)
  "Return the multiples of STEP, in metres, from the pixel START to the pixel END."
  (loop for metres from (* step (ceiling start (* step graphics-scale*))) by step
        while (<= (to-pixels metres) end)
        collect metres))

(defun draw-view-coordinates (canvas map left top width height)
  (let ((step (steps-apart 60)))
    (dolist (metres (marks-between (max 0 left)
                                   (min (+ left width -12) (to-pixels (map-width map))) step))
      (let ((text (princ-to-string metres)))
        (draw-text-on-plate canvas (- (to-pixels metres) (/ (words-width text) 2)) (+ top 12)
                            text)))
    (dolist (metres (marks-between (max 0 (+ top 24))
                                   (min (+ top height -24) (to-pixels (map-height map))) step))
      (draw-text-on-plate canvas (+ left 3) (+ (to-pixels metres) 4) (princ-to-string metres)))))

(defun draw-view-bar (canvas map left top height)
  (let ((x (+ left 36)) (y (+ top height -16)))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-rectangle canvas draw-gcontext* (- x 6) (- y 9)
                      (+ 60 (to-pixels (bar-metres map))) 18 t))
    (with-origin (canvas x 0)
      (draw-scale-bar canvas map y))))

(defun draw-view-margins (canvas map layers left top width height)
  "Draw what LAYERS lists of :COORDINATES and :SCALE-BAR of MAP at the edges of a view of it, WIDTH
by HEIGHT pixels, that begins LEFT and TOP pixels from the corner of MAP. To be called within
WITH-CANVAS, with the origin in that corner."
  (when (member :coordinates layers) (draw-view-coordinates canvas map left top width height))
  (when (member :scale-bar layers) (draw-view-bar canvas map left top height)))
