;;;; pointing.lisp -- the mouse: hovering describes, a click selects, the right button opens a menu.

(in-package :ars-magna.clim)

;;; Hovering.

(defun show-hint (window text)
  (setf (pointer-hint (window-pointer window)) text)
  (repaint-if-changed (pane-named window 'strip)))

(defun show-description-at (pane x y)
  "Describe in the status strip what PANE shows at X, Y, where the mouse is. Record this position."
  (let ((text (hover-text pane x y)))
    (setf (pointer-pointed (window-pointer (window-of pane))) (list pane x y text))
    (show-hint (window-of pane) text)))

(defmethod handle-hover ((pane display-pane) x y)
  (show-description-at pane x y)
  (repaint-if-changed pane))

;; If the strip shows something else meanwhile, that stays until the mouse moves.
(defun update-description (pane)
  "Update the status strip's description if it is about an object in PANE, which has been painted."
  (let ((window (window-of pane)))
    (destructuring-bind (&optional pointed x y text) (pointer-pointed (window-pointer window))
      (when (and (eq pane pointed) (eq text (window-hint window)))
        (show-description-at pane x y)))))

(defun clear-description (window)
  "Clear the description of the object under the mouse in the status strip of WINDOW."
  (setf (pointer-pointed (window-pointer window)) nil
        (pointer-hint (window-pointer window)) ""))

(defun pane-at-mouse (window)
  "Return three values: the pane of WINDOW under the mouse, and the coordinates of the mouse in that
pane. Return NIL if the position of the mouse is unknown."
  (destructuring-bind (&optional x y) (pointer-mouse (window-pointer window))
    (when x
      (dolist (pane (display-panes window))
        (when (clim:sheet-enabled-p pane)
          (multiple-value-bind (x y)
              (clim:untransform-position
               (clim:sheet-delta-transformation pane (clim:frame-top-level-sheet window)) x y)
            (when (clim:region-contains-position-p (clim:sheet-region pane) x y)
              (return (values pane
                              (floor x (magnification pane))
                              (floor y (magnification pane)))))))))))

(defun show-description-at-mouse (window)
  (multiple-value-bind (pane x y) (pane-at-mouse window)
    (when pane (handle-hover pane x y))))

(defmethod describe-subject (subject stream) (format stream "~A~%" (subject-title subject)))

(defun subject-description (subject)
  "Return a description of SUBJECT on one line, or an empty text if SUBJECT is NIL."
  (if subject
      (one-line (with-output-to-string (stream) (describe-subject subject stream)))
      ""))

;;; Picking and offering.

(defun describe-in-transcript (window subject)
  (when subject
    (let ((stream (make-instance 'transcript-stream :transcript (window-transcript window))))
      (fresh-line stream)
      (describe-subject subject stream))))

(defun select-and-describe (window subject)
  (select-subject window subject)
  (describe-in-transcript window subject))

(defconstant +click-tolerance+ 4 "The number of pixels that the mouse may move during a click.")

(defun moved-far-p (x y from-x from-y)
  (> (max (abs (- x from-x)) (abs (- y from-y))) +click-tolerance+))

(defun select-next-subject (pane x y)
  "Select and describe the first subject that PANE shows at X, Y. If an earlier click at X, Y has
selected one of the subjects there, select the next subject."
  (let* ((window (window-of pane)) (subjects (subjects-under pane x y))
         (before (shiftf (pane-clicked pane) (list x y)))
         (picked (and before
                      (not (apply #'moved-far-p x y before))
                      (member (window-selection window) subjects
                              :key #'subject-key :test #'equal))))
    (select-and-describe window (or (second picked) (first subjects)))))

(defun open-offers-at (pane subjects x y)
  "Select the first of SUBJECTS, which PANE shows at X, Y, and open its context menu."
  (let ((window (window-of pane)))
    (when subjects
      (select-subject window (first subjects))
      (multiple-value-bind (x y) (position-in-parent pane x y)
        (open-offers-menu window subjects x y)))))

(defmethod handle-click ((pane display-pane) button x y)
  (if (eq button :right)
      (open-offers-at pane (rotate-to-selected-subject (window-of pane) (subjects-under pane x y)) x
                      y)
      (select-next-subject pane x y)))

;;; In the display of designators, the right button scrolls up and the left one down if they do not
;;; all fit (manual B); then the middle one opens the menu. Readings 26 and 28.

(defclass designators-pane (detail-pane) ())

(defmethod handle-click ((pane designators-pane) button x y)
  (cond ((eq button :middle)
         (open-offers-at pane (subjects-under pane x y) x y))
        ((not (scrollable-p pane)) (call-next-method))
        ((eq button :right) (scroll-pane pane (- +scroll-step+)))
        (t (scroll-pane pane +scroll-step+))))

;;; CLIM's events.

(defun mouse-button-name (event)
  (let ((button (clim:pointer-event-button event)))
    (cond ((eql button clim:+pointer-left-button+) :left)
          ((eql button clim:+pointer-right-button+) :right)
          (t :middle))))

(defun dispatch-press (pane button x y)
  "Handle a press of the mouse BUTTON at X, Y of PANE, on its scroll bar or on its contents."
  (cond ((on-scroll-bar-p pane x)
         (setf (pane-drag pane) :scroll-bar)
         (drag-scroll-bar pane y))
        (t (handle-press pane button x y))))

(defgeneric handle-press-after-popup (pane button x y opener)
  (:documentation "Handle a press of the mouse BUTTON at X, Y of PANE after the press has closed the
popup. OPENER is the command or menu that had opened the popup.")
  (:method (pane button x y opener)
    (declare (ignore opener))
    (unless (eq button :left) (dispatch-press pane button x y)))
  ;; A button opens its own panel at once, but only closes that if it is open.
  (:method ((pane bar-pane) button x y opener)
    (let ((pressed (subject-at (pane-subjects pane) x y)))
      (when (and pressed (not (and (button-p pressed) (eq opener (button-command pressed)))))
        (dispatch-press pane button x y)))))

(defun handle-press-closing-popup (pane button x y)
  "Handle a press of the mouse BUTTON at X, Y of PANE. Close any open popup other than PANE."
  (focus-clicked-pane pane)
  (let ((opener (and (not (typep pane 'popup-pane)) (close-popup (window-of pane)))))
    (if opener
        (handle-press-after-popup pane button x y opener)
        (dispatch-press pane button x y))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-press-event))
  (multiple-value-call #'handle-press-closing-popup pane (mouse-button-name event)
                       (event-position pane event)))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-release-event))
  (let* ((dragged (pane-drag pane)) (window (window-of pane)) (before (window-hint window)))
    (unless (member dragged '(nil :scroll-bar))
      (multiple-value-call #'handle-drop pane (event-position pane event)))
    (setf (pane-drag pane) nil)
    ;; What was said about the drop stays until the mouse moves.
    (when (or (eq before (window-hint window)) (string= "" (window-hint window)))
      (show-description-at-mouse window))))

;; During dragging, the strip describes that, wherever the mouse is.
(defun pane-with-drag (window)
  (find-if #'pane-drag (display-panes window)))

;; Panels that open or close under the mouse make events of a mouse that rests.
(defun record-mouse-position (pane event)
  "Record the mouse's position from EVENT in PANE's window. Return true if the mouse has moved."
  (let* ((window (window-of pane))
         (place (multiple-value-list
                 (clim:transform-position
                  (clim:sheet-delta-transformation pane (clim:frame-top-level-sheet window))
                  (clim:pointer-event-x event) (clim:pointer-event-y event)))))
    (not (equalp place (shiftf (pointer-mouse (window-pointer window)) place)))))

(defmethod clim:handle-event :around ((pane display-pane) (event clim:pointer-motion-event))
  (let ((moved-p (record-mouse-position pane event)))
    (when (or moved-p (not (typep pane 'popup-pane)))
      (call-next-method))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-motion-event))
  (multiple-value-bind (x y) (event-position pane event)
    (case (pane-drag pane)
      ((nil) (unless (pane-with-drag (window-of pane)) (handle-hover pane x y)))
      (:scroll-bar (drag-scroll-bar pane y))
      (t (handle-drag pane x y)))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-exit-event))
  (unless (pane-with-drag (window-of pane))
    (clear-description (window-of pane))
    (repaint-if-changed pane)
    (repaint-if-changed (pane-named (window-of pane) 'strip))))

;;; A turn of the wheel is a button event, too, but not a press.
(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-event))
  (let ((steps (position (clim:pointer-event-button event)
                         (list clim:+pointer-wheel-up+ nil clim:+pointer-wheel-down+))))
    (when steps
      (multiple-value-call #'handle-wheel pane (1- steps) (event-position pane event)))))

;;; What is shown of the robot's parts.

;;; What is drawn there is not where it lies, so it cannot be dragged. If you try, the strip says
;;; what to do instead. (PANE-DRAG PANE) is (thing from-x from-y moved-p).

(defun why-not-draggable-text (image window)
  "Return a text that says why the thing of IMAGE cannot be dragged out of a display of WINDOW."
  (let ((hand (hand-image-holding image window)) (name (subject-title image)))
    (cond (hand (format nil "To let go of ~A, use a prompt line, such as hand-ungrasp ~D. The ~
                             right button offers such lines."
                        name (hand-image-index hand)))
          ((thing-image-location image)
           (format nil "~A is ~A. Use prompt lines to take a thing ~
                        out." name (thing-image-location image)))
          (t (format nil "To move ~A, drag it in the display of the world." name)))))

(defmethod handle-press ((pane detail-pane) button x y)
  (let ((thing (find-if (lambda (subject) (typep subject 'thing-image))
                        (subjects-under pane x y))))
    (if (and thing (eq button :left))
        (setf (pane-drag pane) (list thing x y nil))
        (handle-click pane button x y))))

(defmethod handle-drag ((pane detail-pane) x y)
  (destructuring-bind (thing from-x from-y moved-p) (pane-drag pane)
    (when (and (not moved-p) (moved-far-p x y from-x from-y))
      (setf (pane-drag pane) (list thing from-x from-y t))
      (show-hint (window-of pane) (why-not-draggable-text thing (window-of pane))))))

(defmethod handle-drop ((pane detail-pane) x y)
  (destructuring-bind (thing from-x from-y moved-p) (pane-drag pane)
    (declare (ignore from-x from-y))
    (if moved-p
        (show-hint (window-of pane) (why-not-draggable-text thing (window-of pane)))
        (handle-click pane :left x y))))
