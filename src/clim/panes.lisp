;;;; panes.lisp -- one display in a part of the window.

(in-package :ars-magna.clim)

;;; A pane paints all of itself, from the window's last snapshot, whenever CLIM or a new snapshot
;;; asks for it; it does so only when what it shows has changed. Painting records nothing.

(defclass display-pane (buffered-pane clim:basic-pane)
  ((display :initarg :display :initform nil :reader pane-display)
   ;; Boxes of what was painted, for clicks; what was painted, to know whether that has changed.
   (subjects :initform '() :accessor pane-subjects)
   (painted :initform nil :accessor pane-painted)
   ;; How far down the picture the pane begins, in pixels, and how high the picture is.
   (offset :initform 0 :accessor pane-offset)
   (extent :initform 0 :accessor pane-extent)
   ;; Where the mouse was clicked last, as (x y).
   (clicked :initform nil :accessor pane-clicked)
   ;; What the mouse drags, with its button down: NIL for nothing.
   (drag :initform nil :accessor pane-drag))
  (:default-initargs :background clim:+white+)
  (:documentation "A pane that shows one of the displays."))

(defgeneric paint (pane)
  (:documentation "Paint all of PANE."))

(defgeneric pane-content (pane)
  (:documentation "Return an object that is EQUAL to the one before if PANE would look the same."))

(defun window-of (pane) (clim:pane-frame pane))

(defun clear (pane)
  (multiple-value-bind (width height) (pane-size pane)
    (clim:draw-rectangle* pane 0 0 width height :ink (clim:pane-background pane))))

(defun call-painting (function pane)
  "Clear PANE, and call FUNCTION with a canvas on which it paints PANE, but for lines of text that
would be cut; remember what was painted where."
  (clear pane)
  (let ((canvas (make-instance 'clim-canvas :medium pane :bottom (nth-value 1 (pane-size pane))
                                            :magnification (magnification pane)
                                            :color-p (window-color-p (window-of pane)))))
    (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
      (with-canvas (canvas) (funcall function canvas)))
    (setf (pane-subjects pane) (canvas-subjects canvas))))

(defmacro painting ((canvas pane) &body body)
  "Run BODY, which paints PANE on CANVAS, within its bounds."
  `(call-painting (lambda (,canvas) ,@body) ,pane))

(defun draw-button (canvas subject text lit-p x y width height)
  "Draw a button for SUBJECT with TEXT in its middle. Return where it ends."
  (with-subject (canvas subject)
    (with-gcontext (draw-gcontext* :foreground (if lit-p (svref lightblue* 9) (svref grey* 60)))
      (draw-rectangle canvas draw-gcontext* x y width height t))
    (with-gcontext (draw-gcontext* :foreground (svref grey* 30))
      (draw-rectangle canvas draw-gcontext* x y width height))
    (draw-glyphs canvas draw-gcontext*
                 (+ x (floor (- width (* +character-width+ (length text))) 2)) (+ y height -5)
                 text))
  (+ x width))

;;; Repainting.

(defmethod clim:handle-repaint ((pane display-pane) region)
  (declare (ignore region))
  ;; CLIM narrows painting down to REGION, but the rest may have changed as well.
  (setf (clim:medium-clipping-region (clim:sheet-medium pane)) clim:+everywhere+)
  (repaint pane))

(defun shown-p (pane)
  (and (clim:sheet-grafted-p pane) (clim:sheet-enabled-p pane)))

(defun repaint (pane)
  (when (shown-p pane)
    (setf (pane-painted pane) (pane-content pane))
    (call-buffered (lambda ()
                     (paint pane)
                     (when (limit-offset pane) (paint pane))
                     (paint-selection pane)
                     (paint-scroll-bar pane))
                   pane)
    (paint-popup-over pane)
    (point-again pane)))

(defun repaint-if-changed (pane)
  (when (and (shown-p pane) (not (equal (pane-painted pane) (pane-content pane))))
    (repaint pane)))

;;; The mouse: see pointing.lisp.

(defconstant +scroll-step+ (* 3 +line-height+) "How far a turn of the wheel scrolls, in pixels.")

(defgeneric press (pane button x y)
  (:documentation "The mouse's BUTTON, :LEFT, :MIDDLE or :RIGHT, was pressed at X, Y of PANE.")
  (:method (pane button x y) (click pane button x y)))

(defgeneric click (pane button x y)
  (:documentation "The mouse was clicked with BUTTON, :LEFT, :MIDDLE or :RIGHT, at X, Y of PANE."))

(defgeneric drag (pane x y)
  (:documentation "The mouse moved to X, Y of PANE while what (PANE-DRAG PANE) says is dragged.")
  (:method (pane x y) (declare (ignore pane x y))))

(defgeneric drop (pane x y)
  (:documentation "The mouse's button, which dragged something, was released at X, Y of PANE.")
  (:method (pane x y) (declare (ignore pane x y))))

(defgeneric hover (pane x y)
  (:documentation "The mouse moved to X, Y of PANE with no button pressed."))

(defgeneric wheel (pane steps x y)
  (:documentation "The mouse's wheel was turned by STEPS, down if positive, at X, Y of PANE.")
  (:method (pane steps x y)
    (declare (ignore x y))
    (scroll pane (* steps +scroll-step+))))

(defgeneric hover-text (pane x y)
  (:documentation "Return in one line what lies at X, Y of PANE.")
  (:method (pane x y) (subject-text (subject-at (pane-subjects pane) x y))))

;;; Details of the robot.

(defclass detail-pane (display-pane)
  (;; What was measured last, and how high it was.
   (measured :initform '(nil 0) :accessor pane-measured)))

(defun measure-detail (pane width)
  "Return how many pixels high a drawing is of all that PANE shows, WIDTH pixels wide."
  (let ((canvas (make-instance 'svg-canvas :stream (make-broadcast-stream)))
        (window (window-of pane)))
    (with-canvas (canvas)
      (nth-value 1 (draw-display canvas (pane-display pane) (window-snapshot window)
                                 (window-robot window) :width width)))))

(defun detail-height (pane width)
  "Return what MEASURE-DETAIL does, without drawing again what looks as before."
  (let ((key (list width (display-content (pane-display pane)
                                          (window-robot (window-of pane))))))
    (unless (equal key (first (pane-measured pane)))
      (setf (pane-measured pane) (list key (measure-detail pane width))))
    (second (pane-measured pane))))

(defmethod pane-content ((pane detail-pane))
  (list (pane-offset pane) (multiple-value-list (pane-size pane))
        (window-selection (window-of pane))
        (let ((robot (window-robot (window-of pane))))
          (and robot (display-content (pane-display pane) robot)))))

(defmethod paint ((pane detail-pane))
  (let ((window (window-of pane)))
    (painting (canvas pane)
      (with-origin (canvas 0 (- (pane-offset pane)))
        (when (window-robot window)
          (setf (pane-extent pane)
                (nth-value 1 (draw-display canvas (pane-display pane) (window-snapshot window)
                                           (window-robot window)
                                           :width (content-width pane)))))))))
