;;;; view.lisp -- which part of the world is in view, and how large.

(in-package :ars-magna.clim)

;;; The view fits the whole map, on opening and whenever the pane or the map changes, until the user
;;; zooms or moves it, or sets GRAPHICS-SCALE*. LEFT and TOP are the pixels of the whole picture
;;; that lie left of and above the pane.

(defclass view ()
  ((left :initform 0 :accessor pane-left)
   (top :initform 0 :accessor pane-top)
   ;; Pixels to a cell.
   (scale :initform 8 :accessor pane-scale)
   (fitting-p :initform t :accessor pane-fitting-p)
   ;; The pane's size and the map that the view was fitted to; what GRAPHICS-SCALE* was then.
   (fitted :initform nil :accessor pane-fitted)
   (scale-seen :initform graphics-scale* :accessor pane-scale-seen)
   (following-p :initform nil :accessor pane-following-p))
  (:documentation "A part of the world."))

(defconstant +least-scale+ 1/16 "How many pixels a cell has at least in a window.")
(defconstant +in-view+ 40 "How many pixels of the map stay in view, however it is moved.")

(defun window-map (window)
  (snapshot-map (window-snapshot window)))

(defun view-map (pane) (window-map (window-of pane)))

(defun pane-edges (pane)
  "Return how many pixels at the left, top and bottom of PANE its coordinates and scale bar take."
  (view-edges (view-map pane) (window-layers (window-of pane))))

(defun view-box (pane)
  "Return the box (left top right bottom) of PANE in which the map is in view."
  (multiple-value-bind (width height) (pane-size pane)
    (destructuring-bind (left top bottom) (pane-edges pane)
      (list left top (max left width) (max top (- height bottom))))))

(defun in-view-p (pane x y)
  "True if the map is in view at X, Y of PANE, and not a strip at its edge."
  (destructuring-bind (left top right bottom) (view-box pane)
    (and (<= left x) (< x right) (<= top y) (< y bottom))))

(defun place-view (pane left top)
  "Let the view of PANE begin at LEFT, TOP, but not off the map."
  (destructuring-bind (from-x from-y to-x to-y) (view-box pane)
    (let ((map (view-map pane)) (scale (pane-scale pane)))
      (flet ((within (value cells from to)
               (clamp (round value)
                      (- +in-view+ to) (- (floor (* cells scale)) +in-view+ from))))
        (setf (pane-left pane) (within left (map-width map) from-x to-x)
              (pane-top pane) (within top (map-height map) from-y to-y))))))

(defparameter *all-in-view* "The whole map is in view; the wheel zooms in."
  "What the strip says when there is nothing to follow.")

(defun fit-no-longer (pane)
  "Let the view of PANE be what the user makes of it; the strip says no longer that it fits."
  (setf (pane-fitting-p pane) nil)
  (when (equal *all-in-view* (window-hint (window-of pane)))
    (setf (window-hint (window-of pane)) "")
    (repaint-if-changed (pane-named (window-of pane) 'strip))))

(defun move-view (pane dx dy)
  "Move the view of PANE by DX, DY pixels, but not off the map."
  (fit-no-longer pane)
  (place-view pane (+ (pane-left pane) dx) (+ (pane-top pane) dy))
  (repaint-if-changed pane))

(defun zoom (pane factor &optional (x 0) (y 0))
  "Make the view of PANE FACTOR times larger, so that what is at X, Y stays there."
  (let ((old (pane-scale pane)))
    (setf (pane-scale pane) (clamp (* old factor) +least-scale+ 128))
    (let ((ratio (/ (pane-scale pane) old)))
      (move-view pane (round (* (- ratio 1) (+ (pane-left pane) x)))
                 (round (* (- ratio 1) (+ (pane-top pane) y)))))))

;;; Fitting.

(defun fitting-scale (map width height)
  "Return how many pixels to a cell let all of MAP be in view in WIDTH times HEIGHT pixels."
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

(defun fit (pane)
  "Let the whole map be in view in PANE, also when its size changes."
  (setf (pane-fitting-p pane) t
        (pane-fitted pane) nil)
  (repaint-if-changed pane))

;;; The robot.

(defun robot-place (pane)
  "Return where in PANE the window's robot is, in pixels, or NIL."
  (let ((robot (window-robot (window-of pane))) (scale (pane-scale pane)))
    (and robot
         (values (- (* scale (robot-image-x robot)) (pane-left pane))
                 (- (* scale (robot-image-y robot)) (pane-top pane))))))

(defun centre-robot (pane)
  (multiple-value-bind (x y) (robot-place pane)
    (when x
      (destructuring-bind (left top right bottom) (view-box pane)
        (place-view pane (+ (pane-left pane) (- x (/ (+ left right) 2)))
                    (+ (pane-top pane) (- y (/ (+ top bottom) 2))))))))

(defun off-centre-p (pane)
  "True if the window's robot is not in the middle half of PANE."
  (multiple-value-bind (x y) (robot-place pane)
    (destructuring-bind (left top right bottom) (view-box pane)
      (flet ((off-p (at from to) (> (abs (- at (/ (+ from to) 2))) (/ (- to from) 4))))
        (and x (or (off-p x left right) (off-p y top bottom)))))))

(defun show-robot (pane)
  (fit-no-longer pane)
  (centre-robot pane)
  (repaint-if-changed pane))

;;; Before each picture.

(defun obey-scale (pane)
  "If the user has set GRAPHICS-SCALE*, let it be the scale of the view of PANE, unless it is none."
  (unless (eql graphics-scale* (shiftf (pane-scale-seen pane) graphics-scale*))
    (when (handler-case (progn (users-scale) t)
            (misuse () nil))
      (setf (pane-scale pane) (clamp graphics-scale* 1 128)
            (pane-fitting-p pane) nil)
      (centre-robot pane))))

(defun prepare-view (pane)
  "Let the view of PANE be where it should be for its next picture."
  (multiple-value-bind (width height) (pane-size pane)
    (let ((key (list width height (view-map pane) (pane-edges pane))))
      (obey-scale pane)
      (cond ((pane-fitting-p pane)
             (unless (equal key (pane-fitted pane)) (fit-view pane)))
            ((and (pane-following-p pane) (off-centre-p pane))
             (centre-robot pane)))
      (setf (pane-fitted pane) key))))
