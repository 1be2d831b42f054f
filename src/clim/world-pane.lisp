;;;; world-pane.lisp -- the world from above in the window: the view and its scale.

(in-package :ars-magna.clim)

;;; The view fits the whole map at first, and again whenever the pane or the map changes, until the
;;; user zooms or moves it or sets GRAPHICS-SCALE*. LEFT and TOP are the pixels of the whole picture
;;; that lie left of and above the pane.

(defclass view ()
  ((left :initform 0 :accessor pane-left)
   (top :initform 0 :accessor pane-top)
   ;; Pixels to a cell.
   (scale :initform 8 :accessor pane-scale)
   (fitting-p :initform t :accessor pane-fitting-p)
   ;; The pane's size and the map that the view was fitted to; GRAPHICS-SCALE* then.
   (fitted :initform nil :accessor pane-fitted)
   (scale-seen :initform graphics-scale* :accessor pane-scale-seen)
   (following-p :initform nil :accessor pane-following-p))
  (:documentation "The part of the world that a pane shows, with its scale."))

(defconstant +least-scale+ 1/16 "The least scale of a window, in pixels per cell.")
(defconstant +pixels-kept-in-view+ 40 "The number of pixels of the map that always stay in view.")

(defun window-map (window)
  (snapshot-map (window-snapshot window)))

(defun view-map (pane) (window-map (window-of pane)))

(defun pane-margins (pane)
  "Return the left, top and bottom margins of PANE in pixels. They hold coordinates and scale bar."
  (view-strip-widths (view-map pane) (window-layers (window-of pane))))

(defun view-box (pane)
  "Return the box (left top right bottom) of the map in PANE, without coordinates and scale bar."
  (multiple-value-bind (width height) (pane-size pane)
    (destructuring-bind (left top bottom) (pane-margins pane)
      (list left top (max left width) (max top (- height bottom))))))

(defun in-view-p (pane x y)
  "True if X, Y of PANE is in the box of the map, not in the coordinates or the scale bar."
  (destructuring-bind (left top right bottom) (view-box pane)
    (and (<= left x) (< x right) (<= top y) (< y bottom))))

(defun set-view-corner (pane left top)
  "Move the upper left corner of the view of PANE to LEFT, TOP, but keep the map in view."
  (destructuring-bind (from-x from-y to-x to-y) (view-box pane)
    (let ((map (view-map pane)) (scale (pane-scale pane)))
      (flet ((within (value cells from to)
               (clamp (round value)
                      (- +pixels-kept-in-view+ to)
                      (- (floor (* cells scale)) +pixels-kept-in-view+ from))))
        (setf (pane-left pane) (within left (map-width map) from-x to-x)
              (pane-top pane) (within top (map-height map) from-y to-y))))))

(defparameter *whole-map-hint* "The whole map is in view; the wheel zooms in."
  "The text in the strip if the robot is to be followed but the view shows the whole map.")

(defun stop-fitting-map (pane)
  "Record that the user has changed the view of PANE, so that it is no longer fitted to the map."
  (setf (pane-fitting-p pane) nil)
  (when (equal *whole-map-hint* (window-hint (window-of pane)))
    (setf (pointer-hint (window-pointer (window-of pane))) "")
    (repaint-if-changed (pane-named (window-of pane) 'strip))))

(defun move-view (pane dx dy)
  "Move the view of PANE by DX, DY pixels, but keep the map in view."
  (stop-fitting-map pane)
  (set-view-corner pane (+ (pane-left pane) dx) (+ (pane-top pane) dy))
  (repaint-if-changed pane))

(defun least-useful-scale (map)
  "Return the scale with which MAP is +PIXELS-KEPT-IN-VIEW+ pixels wide or high."
  (max +least-scale+ (/ +pixels-kept-in-view+ (max (map-width map) (map-height map)))))

(defun zoom-view (pane factor &optional (x 0) (y 0))
  "Magnify the view of PANE by FACTOR, so that the point at X, Y of PANE stays in place."
  (let ((old (pane-scale pane)))
    (setf (pane-scale pane)
          (clamp (* old factor) (min old (least-useful-scale (view-map pane))) 128))
    (let ((ratio (/ (pane-scale pane) old)))
      (move-view pane (round (* (- ratio 1) (+ (pane-left pane) x)))
                 (round (* (- ratio 1) (+ (pane-top pane) y)))))))

;;; Fitting.

(defun fitting-scale (map width height)
  "Return the largest scale, in pixels per cell, with which MAP fits into WIDTH x HEIGHT pixels."
  (let* ((scale (min (/ width (map-width map)) (/ height (map-height map))))
         (step (cond ((< scale 1) +least-scale+) ((< scale 4) 1/4) (t 1))))
    (clamp (* step (floor scale step)) +least-scale+ 64)))

(defun fit-view (pane)
  (destructuring-bind (left top right bottom) (view-box pane)
    (let* ((width (max 1 (- right left))) (height (max 1 (- bottom top))) (map (view-map pane))
           (scale (fitting-scale map width height)))
      (flet ((rest-of (size cells) (floor (max 0 (- size (* scale cells))) 2)))
        (setf (pane-scale pane) scale
              (pane-left pane) (- (+ left (rest-of width (map-width map))))
              (pane-top pane) (- (+ top (rest-of height (map-height map)))))))))

(defun fit-whole-map (pane)
  "Fit the view of PANE to the whole map, now and whenever the size of PANE changes."
  (setf (pane-fitting-p pane) t
        (pane-fitted pane) nil)
  (repaint-if-changed pane))

;;; The robot.

(defun robot-position-in-pane (pane)
  "Return the pixel coordinates in PANE of the window's robot, two values, or NIL without a robot."
  (let ((robot (window-robot (window-of pane))) (scale (pane-scale pane)))
    (and robot
         (values (- (* scale (robot-image-x robot)) (pane-left pane))
                 (- (* scale (robot-image-y robot)) (pane-top pane))))))

(defun centre-robot (pane)
  (multiple-value-bind (x y) (robot-position-in-pane pane)
    (when x
      (destructuring-bind (left top right bottom) (view-box pane)
        (set-view-corner pane (+ (pane-left pane) (- x (/ (+ left right) 2)))
                         (+ (pane-top pane) (- y (/ (+ top bottom) 2))))))))

(defun robot-off-centre-p (pane)
  "True if the window's robot is outside the middle half of PANE."
  (multiple-value-bind (x y) (robot-position-in-pane pane)
    (destructuring-bind (left top right bottom) (view-box pane)
      (flet ((off-p (at from to) (> (abs (- at (/ (+ from to) 2))) (/ (- to from) 4))))
        (and x (or (off-p x left right) (off-p y top bottom)))))))

(defun show-robot (pane)
  (stop-fitting-map pane)
  (centre-robot pane)
  (repaint-if-changed pane))

;;; Before each picture.

(defun apply-user-scale (pane)
  "If the user has changed GRAPHICS-SCALE* to a valid scale, give the view of PANE this scale."
  (unless (eql graphics-scale* (shiftf (pane-scale-seen pane) graphics-scale*))
    (when (handler-case (progn (user-graphics-scale) t)
            (misuse () nil))
      (setf (pane-scale pane) (clamp graphics-scale* 1 128)
            (pane-fitting-p pane) nil)
      (centre-robot pane))))

(defun prepare-view (pane)
  "Fit or move the view of PANE as the user has chosen, before PANE is painted."
  (multiple-value-bind (width height) (pane-size pane)
    (let ((key (list width height (view-map pane) (pane-margins pane))))
      (apply-user-scale pane)
      (cond ((pane-fitting-p pane)
             (unless (equal key (pane-fitted pane)) (fit-view pane)))
            ((and (pane-following-p pane) (robot-off-centre-p pane))
             (centre-robot pane)))
      (setf (pane-fitted pane) key))))

;;;; The pane

;;; The terrain in view is kept in a pixmap and painted again only when the view, the map or the
;;; colours change; moving things are painted over a copy of it.

(defclass world-pane (view display-pane)
  ((terrain :initform nil :accessor pane-terrain)
   (terrain-key :initform nil :accessor pane-terrain-key)
   ;; Where names were in the last picture.
   (live-view :initform (make-live-view) :reader pane-live-view)
   ;; Where what is dragged would be: (x y) of the pane, or NIL.
   (ghost :initform nil :accessor pane-ghost))
  (:documentation "The pane that shows the world."))

(defmethod pane-appearance ((pane world-pane))
  (let* ((window (window-of pane)) (snapshot (window-snapshot window)))
    (when snapshot
      (prepare-view pane)
      (list (pane-left pane) (pane-top pane) (pane-scale pane)
            (multiple-value-list (pane-size pane)) (window-layers window)
            (window-color-p window) (window-selection window) (pane-ghost pane)
            (shown-robot-name window) (owner-at-mouse pane) (snapshot-content snapshot)))))

(defun owner-at-mouse (pane)
  "Return the thing, or the name of the robot, that the mouse points at in PANE, or NIL."
  (destructuring-bind (&optional pointed x y text)
      (pointer-pointed (window-pointer (window-of pane)))
    (declare (ignore text))
    (let ((subject (and (eq pane pointed) (first (subjects-under pane x y)))))
      (typecase subject
        (thing-image (thing-image-thing subject))
        (robot-image (robot-image-name subject))))))

(defun update-live-view (pane)
  "Record in the live view of PANE what is to stand out in the next picture. Return the live view."
  (let ((view (pane-live-view pane)))
    (setf (live-view-robot view) (shown-robot-name (window-of pane))
          (live-view-pointed view) (owner-at-mouse pane))
    view))

;;; Terrain.

(defun terrain-key (pane width height)
  (let* ((window (window-of pane)) (map (window-map window)))
    (list (pane-left pane) (pane-top pane) (pane-scale pane) width height (magnification pane)
          (window-color-p window) (window-layers window) map (map-places map)
          (loop for type across (map-place-types map)
                collect (and type (not (place-type-invisible-p type))
                             (place-type-graphics type))))))

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
      (clim:draw-rectangle* medium 0 0 width height :ink (clim-ink +outside-color+))
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

(defun free-terrain-pixmap (pane)
  (let ((old (shiftf (pane-terrain pane) nil)))
    (when old (clim:deallocate-pixmap old))))

(defun terrain-pixmap (pane width height)
  "Return a pixmap of the terrain that PANE shows, cached while the view does not change."
  (let ((key (terrain-key pane width height)))
    (unless (and (pane-terrain pane) (equal key (pane-terrain-key pane)))
      (free-terrain-pixmap pane)
      (setf (pane-terrain pane)
            (multiple-value-bind (screen-width screen-height) (size-on-screen pane)
              (clim:with-output-to-pixmap (medium pane :width screen-width :height screen-height)
                (clim:with-scaling (medium (magnification pane))
                  (paint-terrain pane medium width height))))
            (pane-terrain-key pane) key))
    (pane-terrain pane)))

(defun copy-terrain-to-pane (pane pixmap)
  (clim:with-identity-transformation (pane)
    (multiple-value-bind (width height) (size-on-screen pane)
      (clim:copy-from-pixmap pixmap 0 0 width height pane 0 0))))

(defmethod paint ((pane world-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (let* ((window (window-of pane)) (snapshot (window-snapshot window)))
      (when (and snapshot (plusp width) (plusp height))
        (copy-terrain-to-pane pane (terrain-pixmap pane width height))
        (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
          (setf (pane-subjects pane)
                (canvas-subjects
                 (call-in-view (lambda (canvas)
                                 (draw-movers canvas snapshot (window-layers window)
                                              (update-live-view pane))
                                 (draw-view-margins canvas (snapshot-map snapshot)
                                                    (window-layers window)
                                                    (pane-left pane) (pane-top pane)
                                                    width height))
                               pane pane)))
          (paint-drop-place pane))))))

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
