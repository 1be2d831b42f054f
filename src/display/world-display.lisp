;;;; world-display.lisp -- the bird's eye view of robots and things in their world (manual B).

(in-package :ars-magna.display)

(export '(draw-movers))

;;; Terrain never changes and may be kept by a canvas; movers are drawn over it. Angles grow
;;; clockwise from the right on the map and on the canvas alike.

(defun shown-by (layer image)
  "Return what LAYER shows of IMAGE, a snapshot or the image of a robot or camera; NIL if nothing."
  (if (%layer-shown layer)
      (funcall (%layer-shown layer) image)
      (getf (robot-image-notes image) (%layer-name layer))))

(defun shown-at (depth layers image &rest more)
  "Return lists (layer shown . MORE) of those of LAYERS at DEPTH that show something of IMAGE."
  (loop for layer in (layers-at depth layers)
        for shown = (shown-by layer image)
        when shown collect (list* layer shown more)))

(defun shown-below-things (snapshot layers)
  "Return what LAYERS list of SNAPSHOT that things lie on, as SHOWN-AT does, from the lowest up."
  (append (shown-at :ways layers snapshot)
          (loop for robot in (snapshot-robots snapshot)
                append (loop for camera in (robot-image-cameras robot)
                             append (shown-at :looks layers camera robot snapshot)
                             append (shown-at :cameras layers camera robot snapshot))
                append (shown-at :robots layers robot robot snapshot))
          (shown-at :things layers snapshot)))

(defun shown-above-things (snapshot layers)
  "Return what LAYERS list of SNAPSHOT that lies above things, as SHOWN-AT does."
  (loop for robot in (snapshot-robots snapshot)
        append (shown-at :labels layers robot robot snapshot)))

(defun shown-lines (snapshot layers)
  "Return all that LAYERS list of SNAPSHOT that is drawn for them alone, as SHOWN-AT does."
  (append (shown-below-things snapshot layers) (shown-above-things snapshot layers)))

(defun draw-shown (canvas shown)
  (loop for (layer . arguments) in shown
        do (apply (%layer-draw layer) canvas arguments)))

(define-constant +beyond+ 8
  :documentation "How far robots at the edges of the map are seen beyond these, in pixels: no more
than all margins have.")

(defun call-on-map (function canvas map beyond)
  (with-clipping (canvas (- beyond) (- beyond)
                  (+ (to-pixels (map-width map)) (* 2 beyond))
                  (+ (to-pixels (map-height map)) (* 2 beyond)))
    (funcall function)))

(defmacro on-map ((canvas map &optional (beyond 0)) &body body)
  "Run BODY; what it draws on CANVAS more than BEYOND pixels outside of MAP stays invisible."
  `(call-on-map (lambda () ,@body) ,canvas ,map ,beyond))

(defun draw-movers (canvas snapshot layers)
  "Draw what is not terrain of SNAPSHOT on CANVAS: things, robots, and what LAYERS lists of them."
  (let ((map (snapshot-map snapshot)))
    (on-map (canvas map) (draw-shown canvas (shown-below-things snapshot layers)))
    (on-map (canvas map +beyond+) (draw-robots canvas (snapshot-robots snapshot)))
    (on-map (canvas map)
      (draw-things canvas (snapshot-things snapshot))
      (draw-shown canvas (shown-above-things snapshot layers))
      (when (member :names layers) (draw-names canvas snapshot layers)))))
