;;;; world-display.lisp -- the bird's eye view of robots and things in their world (manual B).

(in-package :ars-magna.display)

;;; Terrain never changes and may be kept by a canvas; movers are drawn over it. Angles grow
;;; clockwise from the right on the map and on the canvas alike.

(defun draw-camera-layers (canvas snapshot robot camera layers)
  (flet ((shown-p (layer) (member layer layers)))
    (when (and (shown-p :rays) (camera-image-look camera))
      (draw-rays canvas (snapshot-map snapshot) (camera-image-look camera)))
    (when (and (shown-p :wedges) (null (camera-image-location camera)))
      (draw-wedge canvas snapshot robot camera))
    (when (and (shown-p :tracks) (camera-image-track camera))
      (draw-track canvas robot (camera-image-track camera)))))

(defun draw-layers (canvas snapshot robot layers)
  "Draw what LAYERS lists of what ROBOT sees and believes, and lies below things."
  (dolist (camera (robot-image-cameras robot))
    (draw-camera-layers canvas snapshot robot camera layers))
  (when (and (member :odometer layers) (robot-image-odometer robot))
    (draw-odometer canvas (robot-image-odometer robot))))

(defun draw-labels (canvas snapshot layers)
  "Draw what LAYERS lists that lies above things."
  (when (member :designators layers)
    (dolist (robot (snapshot-robots snapshot))
      (dolist (designator (robot-image-designators robot))
        (draw-designator-on-map canvas robot designator))))
  (when (member :names layers) (draw-names canvas snapshot layers)))

(define-constant +beyond+ 8
  :documentation "How far robots at the edges of the map are seen beyond these, in pixels: no more
than all margins have.")

(defun call-on-map (function canvas map beyond)
  "Call FUNCTION; what it draws on CANVAS more than BEYOND pixels outside of MAP stays invisible."
  (with-clipping (canvas (- beyond) (- beyond)
                  (+ (to-pixels (map-width map)) (* 2 beyond))
                  (+ (to-pixels (map-height map)) (* 2 beyond)))
    (funcall function)))

(defmacro on-map ((canvas map &optional (beyond 0)) &body body)
  "Run BODY; what it draws on CANVAS more than BEYOND pixels outside of MAP stays invisible."
  `(call-on-map (lambda () ,@body) ,canvas ,map ,beyond))

(defun draw-below-robots (canvas snapshot layers)
  "Draw what LAYERS lists of SNAPSHOT that robots and things lie on."
  (draw-ways-of-robots canvas (snapshot-robots snapshot) layers)
  (dolist (robot (snapshot-robots snapshot))
    (draw-layers canvas snapshot robot layers))
  (when (member :reach layers) (draw-reach canvas (snapshot-things snapshot))))

(defun draw-movers (canvas snapshot layers)
  "Draw what is not terrain of SNAPSHOT on CANVAS: things, robots, and what LAYERS lists of them."
  (let ((map (snapshot-map snapshot)))
    (on-map (canvas map) (draw-below-robots canvas snapshot layers))
    (on-map (canvas map +beyond+) (draw-robots canvas (snapshot-robots snapshot)))
    (on-map (canvas map)
      (draw-things canvas (snapshot-things snapshot))
      (draw-labels canvas snapshot layers))))

(defun draw-world (canvas snapshot &key (layers *picture-layers*))
  "Draw the map of SNAPSHOT on CANVAS, GRAPHICS-SCALE* pixels to a metre, with what LAYERS lists
that lies on it (manual B)."
  (draw-terrain canvas (snapshot-map snapshot) :layers layers)
  (draw-movers canvas snapshot layers))
