;;;; panes.lisp -- a pane: painted off-screen, scrolled, with the selection marked.

(in-package :ars-magna.clim)

(defstruct (pointer (:copier nil))
  "What the mouse points at in a window. HINT describes it as a text. SELECTION is the key of the
selected object, or NIL. POINTED is where the mouse rests, as (pane x y text) with the text that is
shown, or NIL. MOUSE is the last position of the mouse in screen pixels, as (x y), or NIL."
  (hint "" :type string)
  (selection nil :type list)
  (pointed nil :type list)
  (mouse nil :type list))

;;; CLIM's own buffers ask the X server several questions for each pane and picture. At full speed
;;; each answer comes late, and so do pictures. So a pane has a pixmap of its own size and asks
;;; nothing. This works for panes that the X server has as windows, as CLIM's port makes them;
;;; others are painted by CLIM's buffers.

(defclass buffered-pane ()
  ((buffer :initform nil :accessor pane-buffer)
   ;; Its width and height, in screen pixels.
   (buffer-size :initform nil :accessor pane-buffer-size))
  (:documentation "A mixin for panes that are painted off-screen."))

(defun free-buffer (pane)
  (let ((old (shiftf (pane-buffer pane) nil)))
    (when old (clim:deallocate-pixmap old))))

(defun buffer-of (pane width height)
  "Return the pixmap of PANE, WIDTH x HEIGHT screen pixels large. Make it if necessary."
  (let ((size (list width height)))
    (unless (and (pane-buffer pane) (equal size (pane-buffer-size pane)))
      (free-buffer pane)
      (setf (pane-buffer pane) (clim:allocate-pixmap pane width height)
            (pane-buffer-size pane) size))
    (pane-buffer pane)))

(defun call-in-buffer (function pane width height)
  "Call FUNCTION, which paints PANE, so that it paints the pixmap of PANE. Copy the pixmap to the
screen. WIDTH and HEIGHT are in screen pixels."
  (let ((buffer (buffer-of pane width height)) (medium (clim:sheet-medium pane)))
    (setf (clim:medium-drawable medium) buffer)
    (unwind-protect (funcall function)
      (setf (clim:medium-drawable medium) nil))
    (clim:copy-from-pixmap buffer 0 0 width height pane 0 0)
    (clim:medium-force-output medium)))

(defun call-buffered (function pane)
  "Call FUNCTION, which paints PANE. The painting becomes visible when FUNCTION has returned."
  (multiple-value-bind (width height) (size-on-screen pane)
    (flet ((paint () (clim:with-scaling (pane (magnification pane)) (funcall function))))
      (cond ((not (and (plusp width) (plusp height))))
            ((clim:sheet-direct-mirror pane) (call-in-buffer #'paint pane width height))
            (t (clim:with-output-buffered (pane) (paint)))))))

;;;; Panes

;;; A pane paints all of itself from the window's last snapshot, when CLIM or a new snapshot asks
;;; for it, and only if its contents have changed. Painting records nothing.

(defclass display-pane (buffered-pane clim:basic-pane)
  ((display :initarg :display :initform nil :reader pane-display)
   ;; Boxes of what was painted, for clicks; what was painted, to know whether that has changed.
   (subjects :initform '() :accessor pane-subjects)
   (painted :initform nil :accessor pane-painted)
   ;; How far down the picture the pane begins, in pixels, and how high the picture is.
   (offset :initform 0 :accessor pane-offset)
   (extent :initform 0 :accessor pane-extent)
   ;; Where the mouse was clicked last, as (x y); the key of the object chosen by keys.
   (clicked :initform nil :accessor pane-clicked)
   (chosen :initform nil :accessor pane-chosen)
   ;; What the mouse drags, with its button down: NIL for nothing.
   (handle-drag :initform nil :accessor pane-drag))
  (:default-initargs :background clim:+white+)
  (:documentation "A pane that shows one of the displays."))

(defgeneric paint (pane)
  (:documentation "Paint the whole PANE."))

(defgeneric pane-appearance (pane)
  (:documentation "Return an object that represents the looks of PANE. It is EQUAL to the object
returned before if PANE would look the same."))

(defun window-of (pane) (clim:pane-frame pane))

(defun has-keys-p (pane) (eq pane (window-focus (window-of pane))))

(defun clear-pane (pane)
  (multiple-value-bind (width height) (pane-size pane)
    (clim:draw-rectangle* pane 0 0 width height :ink (clim:pane-background pane))))

(defun call-with-pane-canvas (function pane)
  "Clear PANE and call FUNCTION with a canvas for PANE. The canvas leaves out lines of text that
would be cut off. Record in PANE what was painted where."
  (clear-pane pane)
  (let ((canvas (make-instance 'clim-canvas :medium pane :bottom (nth-value 1 (pane-size pane))
                                            :magnification (magnification pane)
                                            :color-p (window-color-p (window-of pane)))))
    (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
      (with-canvas (canvas) (funcall function canvas)))
    (setf (pane-subjects pane) (canvas-subjects canvas))))

(defmacro with-pane-canvas ((canvas pane) &body body)
  "Run BODY, which paints PANE on CANVAS, clipped to the bounds of PANE."
  `(call-with-pane-canvas (lambda (,canvas) ,@body) ,pane))

(defun button-width (text)
  (+ 12 (label-width text)))

(defun draw-button (canvas subject text lit-p x y width height)
  "Draw a button for SUBJECT with TEXT in its middle. Return the x coordinate of its right edge."
  (with-subject (canvas subject)
    (with-gcontext (draw-gcontext* :foreground (if lit-p +lit-color+ +button-color+))
      (draw-rectangle canvas draw-gcontext* x y width height t))
    (with-gcontext (draw-gcontext* :foreground +border-color+)
      (draw-rectangle canvas draw-gcontext* x y width height))
    (draw-label canvas (+ x (/ width 2)) (+ y (floor (+ height 8) 2)) text :anchor :middle))
  (+ x width))

;;; Repainting.

(defmethod clim:handle-repaint ((pane display-pane) region)
  (declare (ignore region))
  ;; CLIM limits painting to REGION, but the rest may have changed as well.
  (setf (clim:medium-clipping-region (clim:sheet-medium pane)) clim:+everywhere+)
  (repaint pane))

(defun pane-shown-p (pane)
  (and (clim:sheet-grafted-p pane) (clim:sheet-enabled-p pane)))

(defun whole-appearance (pane)
  (list (pane-chosen pane) (pane-appearance pane)))

(defun paint-all (pane)
  (paint pane)
  (when (limit-scroll-offset pane) (paint pane))
  (paint-selection pane)
  (paint-scroll-bar pane))

(defun repaint (pane)
  (when (pane-shown-p pane)
    (setf (pane-painted pane) (whole-appearance pane))
    (call-with-messages-of-run (lambda () (call-buffered (lambda () (paint-all pane)) pane))
                               (window-of pane))
    (repaint-popup-if-covered pane)
    (update-description pane)))

(defun repaint-if-changed (pane)
  (when (and (pane-shown-p pane) (not (equal (pane-painted pane) (whole-appearance pane))))
    (repaint pane)))

;;; The mouse: see pointing.lisp.

(defconstant +scroll-step+ (* 3 +line-height+)
  "The distance that one step of the mouse wheel scrolls, in pixels.")

(defgeneric handle-press (pane button x y)
  (:documentation "Handle a press of the mouse BUTTON, :LEFT, :MIDDLE or :RIGHT, at X, Y of PANE.")
  (:method (pane button x y) (handle-click pane button x y)))

(defgeneric handle-click (pane button x y)
  (:documentation "Handle a click of BUTTON (:LEFT, :MIDDLE or :RIGHT) at X, Y of PANE."))

(defgeneric handle-drag (pane x y)
  (:documentation "Handle a mouse movement to X, Y of PANE during the drag (PANE-DRAG PANE).")
  (:method (pane x y) (declare (ignore pane x y))))

(defgeneric handle-drop (pane x y)
  (:documentation "Handle the end of a drag: the mouse button was released at X, Y of PANE.")
  (:method (pane x y) (declare (ignore pane x y))))

(defgeneric handle-hover (pane x y)
  (:documentation "Handle a movement of the mouse to X, Y of PANE without a button pressed."))

(defgeneric handle-wheel (pane steps x y)
  (:documentation "Handle a turn of the mouse wheel by STEPS, positive for down, at X, Y of PANE.")
  (:method (pane steps x y)
    (declare (ignore x y))
    (scroll-pane pane (* steps +scroll-step+))))

(defgeneric hover-text (pane x y)
  (:documentation "Return a description of what PANE shows at X, Y, on one line.")
  (:method (pane x y) (subject-description (subject-at (pane-subjects pane) x y))))

;;; Details of the robot.

(defclass detail-pane (display-pane)
  (;; What was measured last, and how high it was.
   (measured :initform '(nil 0) :accessor pane-measured)))

(defun measure-content-height (pane width)
  "Return the height in pixels of the complete contents of PANE, drawn WIDTH pixels wide."
  (let ((canvas (make-instance 'svg-canvas :stream (make-broadcast-stream)))
        (window (window-of pane)))
    (with-canvas (canvas)
      (nth-value 1 (draw-display canvas (pane-display pane) (window-snapshot window)
                                 (window-robot window) :width width)))))

(defun cached-content-height (pane width)
  "Return the value of MEASURE-CONTENT-HEIGHT for PANE and WIDTH, cached while the contents do not
change."
  (let ((key (list width (display-content (pane-display pane)
                                          (window-robot (window-of pane))))))
    (unless (equal key (first (pane-measured pane)))
      (setf (pane-measured pane) (list key (measure-content-height pane width))))
    (second (pane-measured pane))))

(defmethod pane-appearance ((pane detail-pane))
  (list (pane-offset pane) (multiple-value-list (pane-size pane))
        (window-selection (window-of pane))
        (let ((robot (window-robot (window-of pane))))
          (and robot (display-content (pane-display pane) robot)))))

(defmethod paint ((pane detail-pane))
  (let ((window (window-of pane)))
    (with-pane-canvas (canvas pane)
      (with-origin (canvas 0 (- (pane-offset pane)))
        (when (window-robot window)
          (setf (pane-extent pane)
                (nth-value 1 (draw-display canvas (pane-display pane) (window-snapshot window)
                                           (window-robot window)
                                           :width (content-width pane)))))))))

;;;; Scrolling

(defconstant +scroll-bar-width+ 10 "The width of scroll bars, in pixels.")

(defgeneric scroll-state (pane)
  (:documentation "Return three values in one unit: the position in the contents of PANE where the
visible part begins, the length of the visible part, and the length of the contents.")
  (:method (pane)
    (values (pane-offset pane) (nth-value 1 (pane-size pane)) (pane-extent pane))))

(defgeneric scroll-to (pane position)
  (:documentation "Scroll PANE so that it shows POSITION first, in the unit of SCROLL-STATE.")
  (:method (pane position)
    (setf (pane-offset pane) (max 0 (round position)))
    (limit-scroll-offset pane)
    (repaint-if-changed pane)))

(defun scrollable-p (pane)
  (multiple-value-bind (position page total) (scroll-state pane)
    (declare (ignore position))
    (> total page)))

(defun content-width (pane)
  "Return the width of PANE without its scroll bar, in pixels."
  (max 1 (- (pane-size pane) +scroll-bar-width+)))

(defgeneric limit-scroll-offset (pane)
  (:documentation
   "Scroll PANE back if it is scrolled beyond its contents. Return true if PANE was scrolled back.")
  (:method (pane)
    (let ((room (max 0 (- (pane-extent pane) (nth-value 1 (pane-size pane))))))
      (when (> (pane-offset pane) room)
        (setf (pane-offset pane) room)
        t))))

(defun scroll-pane (pane pixels)
  "Scroll PANE down by PIXELS, but not beyond its contents."
  (scroll-to pane (+ (scroll-state pane) pixels)))

;;; The bar.

(defun thumb-bounds (pane)
  "Return the top and bottom, in pixels, of the thumb, the movable part of PANE's scroll bar."
  (multiple-value-bind (position page total) (scroll-state pane)
    (let* ((height (nth-value 1 (pane-size pane)))
           (length (clamp (round (* height page) (max 1 total)) (min 12 height) height))
           (top (round (* (- height length) position) (max 1 (- total page)))))
      (values top (+ top length)))))

(defun paint-scroll-bar (pane)
  (when (scrollable-p pane)
    (multiple-value-bind (width height) (pane-size pane)
      (multiple-value-bind (top bottom) (thumb-bounds pane)
        (clim:draw-rectangle* pane (- width +scroll-bar-width+) 0 width height
                              :ink (clim-ink +bar-color+))
        (clim:draw-rectangle* pane (- width +scroll-bar-width+ -2) top (- width 2) bottom
                              :ink (clim-ink +thumb-color+))))))

(defun on-scroll-bar-p (pane x)
  (and (scrollable-p pane) (>= x (content-width pane))))

(defun drag-scroll-bar (pane y)
  "Scroll PANE so that the middle of its scroll bar's thumb moves to Y, as far as possible."
  (multiple-value-bind (position page total) (scroll-state pane)
    (declare (ignore position))
    (multiple-value-bind (top bottom) (thumb-bounds pane)
      (let ((length (- bottom top)) (height (nth-value 1 (pane-size pane))))
        (scroll-to pane (* (- total page)
                           (/ (clamp (- y (/ length 2)) 0 (max 0 (- height length)))
                              (max 1 (- height length)))))))))

;;;; What is picked

(defgeneric subject-key (subject)
  (:documentation "Return a key that identifies SUBJECT in all snapshots and is compared by EQUAL.
Return NIL if SUBJECT cannot be selected.")
  (:method (subject) (declare (ignore subject)) nil)
  (:method ((image thing-image))
    (let ((thing (thing-image-thing image)))
      ;; A designator can denote a robot.
      (if (body-p thing)
          (list :robot (robot-name (body-robot thing)))
          (list :thing thing))))
  (:method ((image robot-image)) (list :robot (robot-image-name image)))
  (:method ((image designator-image)) (list :designator (designator-image-number image)))
  (:method ((cell cell)) (list :cell (cell-x cell) (cell-y cell))))

(defgeneric choice-key (subject)
  (:documentation "Return a key that identifies SUBJECT in a pane when keys choose an object, and is
compared by EQUAL. Return NIL if keys cannot choose SUBJECT.")
  (:method (subject) (or (subject-key subject) (subject-title subject)))
  (:method ((subject string)) nil))

(defun same-subject-p (one other)
  (or (eq one other)
      (let ((key (subject-key one))) (and key (equal key (subject-key other))))))

(defgeneric subjects-under (pane x y)
  (:documentation "Return the subjects that PANE shows at X, Y, the most likely one first.")
  (:method (pane x y)
    (remove-duplicates (subjects-at (pane-subjects pane) x y)
                       :test #'same-subject-p :from-end t)))

(defun rotate-to-selected-subject (window subjects)
  "Return SUBJECTS, rotated so that the selected subject of WINDOW comes first if it is there."
  (let* ((key (window-selection window))
         (picked (and key (member key subjects :key #'subject-key :test #'equal))))
    (append picked (ldiff subjects picked))))

(defun marked-p (pane subject)
  "True if SUBJECT is selected, or chosen in PANE by keys."
  (let ((key (window-selection (window-of pane))) (chosen (pane-chosen pane)))
    (or (and key (equal key (subject-key subject)))
        (and chosen (equal chosen (choice-key subject))))))

(defun selected-boxes (pane)
  "Return a list of the boxes (left top right bottom) where PANE shows the selected subject."
  (loop for (subject . box) in (pane-subjects pane)
        when (marked-p pane subject) collect box))

(defun mark-box (pane left top right bottom)
  (clim:draw-rectangle* pane (- left 2) (- top 2) (+ right 2) (+ bottom 2)
                        :filled nil :ink clim:+dark-orange+ :line-thickness 2))

(defgeneric paint-selection (pane)
  (:documentation "Mark the selected subject in PANE.")
  (:method (pane)
    (loop for box in (selected-boxes pane) do (apply #'mark-box pane box))))

(defun select-subject (window subject)
  (setf (pointer-selection (window-pointer window)) (subject-key subject))
  (refresh window))
