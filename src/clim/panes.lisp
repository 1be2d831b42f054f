;;;; panes.lisp -- one display in a part of the window.

(in-package :ars-magna.clim)

;;; A pane paints all of itself, from the window's last snapshot, whenever CLIM or a new snapshot
;;; asks for it; it does so only when what it shows has changed. Painting records nothing.

(defclass display-pane (clim:basic-pane)
  ((display :initarg :display :reader pane-display)
   ;; Boxes of what was painted, for clicks; what was painted, to know whether that has changed.
   (subjects :initform '() :accessor pane-subjects)
   (painted :initform nil :accessor pane-painted)
   ;; How far down the picture the pane begins, in pixels, and how high the picture is.
   (offset :initform 0 :accessor pane-offset)
   (extent :initform 0 :accessor pane-extent))
  (:default-initargs :background clim:+white+)
  (:documentation "A pane that shows one of the displays."))

(defgeneric paint (pane)
  (:documentation "Paint all of PANE."))

(defgeneric pane-content (pane)
  (:documentation "Return an object that is EQUAL to the one before if PANE would look the same."))

(defmethod clim:handle-repaint ((pane display-pane) region)
  (declare (ignore region))
  ;; CLIM narrows painting down to REGION, but the rest may have changed as well.
  (setf (clim:medium-clipping-region (clim:sheet-medium pane)) clim:+everywhere+)
  (repaint pane))

(defun pane-size (pane)
  "Return width and height of PANE, in pixels."
  (let ((region (clim:sheet-region pane)))
    (values (floor (clim:bounding-rectangle-width region))
            (floor (clim:bounding-rectangle-height region)))))

(defun repaint (pane)
  "Paint PANE, all at once."
  (when (clim:sheet-grafted-p pane)
    (setf (pane-painted pane) (pane-content pane))
    (clim:with-output-buffered (pane)
      (paint pane))))

(defun repaint-if-changed (pane)
  (unless (equal (pane-painted pane) (pane-content pane)) (repaint pane)))

(defun clear (pane &optional (ink clim:+white+))
  "Paint all of PANE with INK."
  (multiple-value-bind (width height) (pane-size pane)
    (clim:draw-rectangle* pane 0 0 width height :ink ink)))

;;; Details of the robot.

(defclass detail-pane (display-pane) ())

(defun window-of (pane) (clim:pane-frame pane))

(defmethod pane-content ((pane detail-pane))
  (list (pane-offset pane)
        (let ((robot (window-robot (window-of pane))))
          (and robot (display-content (pane-display pane) robot)))))

(defmethod paint ((pane detail-pane))
  (let* ((window (window-of pane))
         (canvas (make-instance 'clim-canvas :medium pane :color-p (window-color-p window)))
         (snapshot (window-snapshot window)))
    (clear pane)
    (when snapshot
      (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
        (with-canvas (canvas)
          (with-origin (canvas 0 (- (pane-offset pane)))
            (setf (pane-extent pane)
                  (nth-value 1 (draw-display canvas (pane-display pane) snapshot
                                             (window-robot window) :width (pane-size pane))))))))
    (setf (pane-subjects pane) (canvas-subjects canvas))))

(defun scroll (pane pixels)
  "Show what is PIXELS further down in the picture in PANE, but not more than there is."
  (let ((room (max 0 (- (pane-extent pane) (nth-value 1 (pane-size pane))))))
    (setf (pane-offset pane) (max 0 (min room (+ (pane-offset pane) pixels))))
    (repaint-if-changed pane)))

;;; The mouse. A click describes what it hits; in the display of designators, the right button
;;; scrolls up and the left one down (manual B), and the middle one describes.

(defclass designators-pane (detail-pane) ())

(define-constant +scroll-step+ (* 3 +line-height+)
  :documentation "How far a click or a turn of the wheel scrolls, in pixels.")

;; As readings 26 and 28 say.
(defgeneric click (pane button x y)
  (:documentation "The mouse's BUTTON, :LEFT, :MIDDLE or :RIGHT, was pressed at X, Y of PANE."))

(defmethod click ((pane display-pane) button x y)
  (declare (ignore button))
  (describe-to (window-of pane) (subject-at (pane-subjects pane) x y)))

(defmethod click ((pane designators-pane) button x y)
  (declare (ignore x y))
  (case button
    (:right (scroll pane (- +scroll-step+)))
    (:left (scroll pane +scroll-step+))
    (t (call-next-method))))

(defgeneric wheel (pane steps x y)
  (:documentation "The mouse's wheel was turned by STEPS, down if positive, at X, Y of PANE.")
  (:method (pane steps x y)
    (declare (ignore x y))
    (scroll pane (* steps +scroll-step+))))

(defun button-name (event)
  (let ((button (clim:pointer-event-button event)))
    (cond ((eql button clim:+pointer-left-button+) :left)
          ((eql button clim:+pointer-right-button+) :right)
          (t :middle))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-press-event))
  (click pane (button-name event) (clim:pointer-event-x event) (clim:pointer-event-y event)))

;;; A turn of the wheel is an event of a button, too, but no press of it.
(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-event))
  (let ((steps (position (clim:pointer-event-button event)
                         (list clim:+pointer-wheel-up+ nil clim:+pointer-wheel-down+))))
    (when steps
      (wheel pane (1- steps) (clim:pointer-event-x event) (clim:pointer-event-y event)))))
