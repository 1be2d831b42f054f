;;;; world-pane.lisp -- the bird's eye view in the window: zoomed, moved about, and kept cheap.

(in-package :ars-magna.clim)

;;; The terrain in view is kept in a pixmap and painted anew only when the view, the map or the
;;; colours change; the movers are painted over a copy of it. LEFT and TOP are the pixels of the
;;; whole picture that lie left of and above the pane.

(defclass world-pane (display-pane)
  ((left :initform 0 :accessor pane-left)
   (top :initform 0 :accessor pane-top)
   (zoom :initform 1 :accessor pane-zoom)
   (terrain :initform nil :accessor pane-terrain)
   (terrain-key :initform nil :accessor pane-terrain-key)
   ;; True once the view has been set by something.
   (placed-p :initform nil :accessor pane-placed-p)
   (following-p :initform nil :accessor pane-following-p)
   ;; Where the mouse was when dragging began or last moved on, or NIL.
   (drag :initform nil :accessor pane-drag))
  (:documentation "The pane that shows the world."))

(defun pane-scale (pane)
  "Return how many pixels of PANE there are to a cell."
  (clamp (* graphics-scale* (pane-zoom pane)) 1 128))

(defun window-map (window)
  (snapshot-map (window-snapshot window)))

(defmethod pane-content ((pane world-pane))
  (let* ((window (window-of pane)) (snapshot (window-snapshot window)))
    (list (pane-left pane) (pane-top pane) (pane-scale pane) (multiple-value-list (pane-size pane))
          (window-layers window) (window-color-p window)
          (and snapshot (snapshot-content snapshot)))))

;;; Terrain.

(defun terrain-key (pane width height)
  (let* ((window (window-of pane)) (map (window-map window)))
    (list (pane-left pane) (pane-top pane) (pane-scale pane) width height
          (window-color-p window) map (map-places map) (place-graphics map))))

(defun place-graphics (map)
  "Return a list of the functions that draw the places of MAP."
  (loop for type across (map-place-types map)
        collect (and type (not (place-type-invisible-p type)) (place-type-graphics type))))

(defun call-in-view (function pane medium)
  "Call FUNCTION with a canvas that paints on MEDIUM what is in view in PANE."
  (let ((canvas (make-instance 'clim-canvas :medium medium
                                            :color-p (window-color-p (window-of pane)))))
    (with-canvas (canvas :scale (pane-scale pane))
      (with-origin (canvas (- (pane-left pane)) (- (pane-top pane)))
        (funcall function canvas)))
    canvas))

(defun paint-terrain (pane medium width height)
  "Paint on MEDIUM the terrain that is in view in PANE."
  (let* ((scale (pane-scale pane)) (map (window-map (window-of pane))))
    (flet ((cell (pixels) (floor pixels scale)))
      (clim:draw-rectangle* medium 0 0 width height :ink clim:+gray92+)
      (call-in-view (lambda (canvas)
                      (with-gcontext (draw-gcontext* :foreground white*)
                        (draw-rectangle canvas draw-gcontext* 0 0 (* scale (map-width map))
                                        (* scale (map-height map)) t))
                      (draw-terrain canvas map
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
            (clim:with-output-to-pixmap (medium pane :width width :height height)
              (paint-terrain pane medium width height))
            (pane-terrain-key pane) key))
    (pane-terrain pane)))

(defun place-view (pane width height)
  "The first time, begin with the upper left corner of a map that fits into PANE, or else with the
robot in the middle."
  (unless (pane-placed-p pane)
    (setf (pane-placed-p pane) t)
    (let ((map (window-map (window-of pane))) (scale (pane-scale pane)))
      (when (or (> (* scale (map-width map)) width) (> (* scale (map-height map)) height))
        (setf (values (pane-left pane) (pane-top pane)) (centred-view pane))))))

(defmethod paint ((pane world-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (let* ((window (window-of pane)) (snapshot (window-snapshot window)))
      (when (and snapshot (plusp width) (plusp height))
        (place-view pane width height)
        (clim:copy-from-pixmap (terrain pane width height) 0 0 width height pane 0 0)
        (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
          (setf (pane-subjects pane)
                (canvas-subjects
                 (call-in-view (lambda (canvas)
                                 (draw-movers canvas snapshot (window-layers window)))
                               pane pane))))))))

;;; Moving about and zooming.

(define-constant +in-view+ 40
  :documentation "How many pixels of the map stay in view, however it is moved.")

(defun move-view (pane dx dy)
  "Move the view of PANE by DX, DY pixels, but not off the map."
  (multiple-value-bind (width height) (pane-size pane)
    (let ((map (window-map (window-of pane))) (scale (pane-scale pane)))
      (flet ((within (value cells size)
               (clamp value (- +in-view+ size) (- (floor (* cells scale)) +in-view+))))
        (setf (pane-left pane) (within (+ (pane-left pane) dx) (map-width map) width)
              (pane-top pane) (within (+ (pane-top pane) dy) (map-height map) height))))
    (repaint-if-changed pane)))

(defun zoom (pane factor &optional (x 0) (y 0))
  "Make the view of PANE FACTOR times larger, so that what is at X, Y stays there."
  (let ((old (pane-scale pane)))
    (setf (pane-zoom pane) (clamp (* (pane-zoom pane) factor) 1/16 16))
    (let ((ratio (/ (pane-scale pane) old)))
      (move-view pane (round (* (- ratio 1) (+ (pane-left pane) x)))
                 (round (* (- ratio 1) (+ (pane-top pane) y)))))))

(defun fit (pane)
  "Zoom so that the whole map is in view in PANE."
  (multiple-value-bind (width height) (pane-size pane)
    (let ((map (window-map (window-of pane))))
      (setf (pane-zoom pane)
            (/ (max 1 (floor (min (/ width (map-width map)) (/ height (map-height map)))))
               graphics-scale*)
            (pane-left pane) 0
            (pane-top pane) 0)
      (repaint-if-changed pane))))

(defun centred-view (pane)
  "Return the left and top of the view of PANE that has the window's robot in its middle."
  (multiple-value-bind (width height) (pane-size pane)
    (let ((robot (window-robot (window-of pane))) (scale (pane-scale pane)))
      (if robot
          (values (- (round (* scale (robot-image-x robot))) (floor width 2))
                  (- (round (* scale (robot-image-y robot))) (floor height 2)))
          (values (pane-left pane) (pane-top pane))))))

(defun show-robot (pane)
  "Move the view of PANE so that the window's robot is in its middle."
  (multiple-value-bind (left top) (centred-view pane)
    (move-view pane (- left (pane-left pane)) (- top (pane-top pane)))))

;;; The mouse: a click describes a thing, robot or cell; dragging moves the view; the wheel zooms.

(defmethod wheel ((pane world-pane) steps x y)
  (zoom pane (expt 2 (- (signum steps))) x y))

(defun cell-at (pane x y)
  "Return the cell of the map that is painted at X, Y of PANE, or NIL."
  (let ((map (window-map (window-of pane))) (scale (pane-scale pane)))
    (flet ((coordinate (pixels) (/ pixels scale)))
      (let ((x (coordinate (+ x (pane-left pane)))) (y (coordinate (+ y (pane-top pane)))))
        (and (map-index map x y) (map-cell map x y))))))

(defmethod click ((pane world-pane) button x y)
  (declare (ignore button))
  (setf (pane-drag pane) (list x y))
  (describe-to (window-of pane)
               (or (subject-at (pane-subjects pane) x y) (cell-at pane x y))))

(defmethod clim:handle-event ((pane world-pane) (event clim:pointer-button-release-event))
  (setf (pane-drag pane) nil))

(defmethod clim:handle-event ((pane world-pane) (event clim:pointer-motion-event))
  (let ((drag (pane-drag pane))
        (x (clim:pointer-event-x event)) (y (clim:pointer-event-y event)))
    (when drag
      (setf (pane-drag pane) (list x y))
      (move-view pane (round (- (first drag) x)) (round (- (second drag) y))))))
