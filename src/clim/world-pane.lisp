;;;; world-pane.lisp -- the bird's eye view in the window: zoomed, moved about, and kept cheap.

(in-package :ars-magna.clim)

;;; The terrain in view is kept in a pixmap and painted anew only when the view, the map or the
;;; colours change; the movers are painted over a copy of it.

(defclass world-pane (view display-pane)
  ((terrain :initform nil :accessor pane-terrain)
   (terrain-key :initform nil :accessor pane-terrain-key)
   ;; Where what is dragged would be: (x y) of the pane, or NIL.
   (ghost :initform nil :accessor pane-ghost))
  (:documentation "The pane that shows the world."))

(defmethod pane-content ((pane world-pane))
  (let* ((window (window-of pane)) (snapshot (window-snapshot window)))
    (when snapshot
      (prepare-view pane)
      (list (pane-left pane) (pane-top pane) (pane-scale pane)
            (multiple-value-list (pane-size pane)) (window-layers window)
            (window-color-p window) (window-selection window) (pane-ghost pane)
            (snapshot-content snapshot)))))

;;; Terrain.

(defun terrain-key (pane width height)
  (let* ((window (window-of pane)) (map (window-map window)))
    (list (pane-left pane) (pane-top pane) (pane-scale pane) width height (magnification pane)
          (window-color-p window) (window-layers window) map (map-places map)
          (place-graphics map))))

(defun place-graphics (map)
  (loop for type across (map-place-types map)
        collect (and type (not (place-type-invisible-p type)) (place-type-graphics type))))

(defun call-in-view (function pane medium)
  (let ((canvas (make-instance 'clim-canvas :medium medium :magnification (magnification pane)
                                            :color-p (window-color-p (window-of pane)))))
    (with-canvas (canvas :scale (pane-scale pane))
      (with-origin (canvas (- (pane-left pane)) (- (pane-top pane)))
        (funcall function canvas)))
    canvas))

(defun paint-terrain (pane medium width height)
  (let* ((scale (pane-scale pane)) (window (window-of pane)) (map (window-map window)))
    (flet ((cell (pixels) (floor pixels scale)))
      (clim:draw-rectangle* medium 0 0 width height :ink clim:+gray92+)
      (call-in-view (lambda (canvas)
                      (with-gcontext (draw-gcontext* :foreground white*)
                        (draw-rectangle canvas draw-gcontext* 0 0 (* scale (map-width map))
                                        (* scale (map-height map)) t))
                      (draw-terrain canvas map
                                    :layers (window-layers window)
                                    :left (cell (pane-left pane)) :top (cell (pane-top pane))
                                    :right (1+ (cell (+ (pane-left pane) width)))
                                    :bottom (1+ (cell (+ (pane-top pane) height)))))
                    pane medium))))

(defun forget-terrain (pane)
  (let ((old (shiftf (pane-terrain pane) nil)))
    (when old (clim:deallocate-pixmap old))))

(defun terrain (pane width height)
  "Return a pixmap of the terrain that is in view in PANE."
  (let ((key (terrain-key pane width height)))
    (unless (and (pane-terrain pane) (equal key (pane-terrain-key pane)))
      (forget-terrain pane)
      (setf (pane-terrain pane)
            (multiple-value-bind (screen-width screen-height) (size-on-screen pane)
              (clim:with-output-to-pixmap (medium pane :width screen-width :height screen-height)
                (call-magnified (lambda () (paint-terrain pane medium width height))
                                medium (magnification pane))))
            (pane-terrain-key pane) key))
    (pane-terrain pane)))

(defun show-terrain (pane pixmap)
  "Cover PANE with PIXMAP, which is as large."
  (clim:with-identity-transformation (pane)
    (multiple-value-bind (width height) (size-on-screen pane)
      (clim:copy-from-pixmap pixmap 0 0 width height pane 0 0))))

(defmethod paint ((pane world-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (let* ((window (window-of pane)) (snapshot (window-snapshot window)))
      (when (and snapshot (plusp width) (plusp height))
        (show-terrain pane (terrain pane width height))
        (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
          (setf (pane-subjects pane)
                (canvas-subjects
                 (call-in-view (lambda (canvas)
                                 (draw-movers canvas snapshot (window-layers window))
                                 (draw-view-margins canvas (snapshot-map snapshot)
                                                    (window-layers window)
                                                    (pane-left pane) (pane-top pane)
                                                    width height))
                               pane pane)))
          (paint-ghost pane))))))

(defun mark-cell (pane x y)
  (let* ((scale (pane-scale pane))
         (left (- (* scale x) (pane-left pane))) (top (- (* scale y) (pane-top pane))))
    (mark-box pane left top (+ left scale) (+ top scale))))

(defmethod paint-selection ((pane world-pane))
  (when (window-snapshot (window-of pane))
    (clim:with-drawing-options (pane :clipping-region
                                     (apply #'clim:make-rectangle* (view-box pane)))
      (let ((key (window-selection (window-of pane))))
        (if (eq :cell (first key))
            (apply #'mark-cell pane (rest key))
            (call-next-method))))))
