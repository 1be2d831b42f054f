;;;; pointing.lisp -- the mouse: hovering describes, a click selects, the right button opens a menu.

(in-package :ars-magna.clim)

;;; Hovering.

(defun hint (window text)
  (setf (window-hint window) text)
  (repaint-if-changed (pane-named window 'strip)))

(defun point-at-place (pane x y)
  "Note that the mouse rests at X, Y of PANE, and show in the status strip what is there."
  (let ((text (hover-text pane x y)))
    (setf (window-pointed (window-of pane)) (list pane x y text))
    (hint (window-of pane) text)))

(defmethod handle-hover ((pane display-pane) x y) (point-at-place pane x y))

;; If the strip shows something else meanwhile, that stays until the mouse moves.
(defun update-pointing (pane)
  "Update the strip, as PANE was painted, if it describes what is under the mouse there."
  (let ((window (window-of pane)))
    (destructuring-bind (&optional pointed x y text) (window-pointed window)
      (when (and (eq pane pointed) (eq text (window-hint window)))
        (point-at-place pane x y)))))

(defun clear-pointing (window)
  "Clear the strip of WINDOW: the mouse has left, or what was there has moved."
  (setf (window-pointed window) nil
        (window-hint window) ""))

(defun pane-at-mouse (window)
  "Return the pane of WINDOW that the mouse is on, as far as is known, and where there; or NIL."
  (destructuring-bind (&optional x y) (window-mouse window)
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

(defun point-at-mouse (window)
  "Describe in the strip of WINDOW what is under the mouse now, though it has not moved."
  (multiple-value-bind (pane x y) (pane-at-mouse window)
    (when pane (handle-hover pane x y))))

(defmethod describe-subject (subject stream) (format stream "~A~%" (subject-title subject)))

(defun subject-text (subject)
  "Return a description of SUBJECT on one line; nothing for NIL."
  (if subject
      (one-line (with-output-to-string (stream) (describe-subject subject stream)))
      ""))

;;; Picking and offering.

(defun describe-to (window subject)
  (when subject
    (let ((stream (make-instance 'transcript-stream :transcript (window-transcript window))))
      (fresh-line stream)
      (describe-subject subject stream))))

(defun pick (window subject)
  (select window subject)
  (describe-to window subject))

(defconstant +click-slack+ 4 "By how many pixels the mouse may move in a click.")

(defun moved-far-p (x y from-x from-y)
  (> (max (abs (- x from-x)) (abs (- y from-y))) +click-slack+))

(defun pick-next (pane x y)
  "Select what is at X, Y of PANE; after an earlier click there, the next of what overlaps."
  (let* ((window (window-of pane)) (subjects (subjects-under pane x y))
         (before (shiftf (pane-clicked pane) (list x y)))
         (picked (and before
                      (not (apply #'moved-far-p x y before))
                      (member (window-selection window) subjects
                              :key #'subject-key :test #'equal))))
    (pick window (or (second picked) (first subjects)))))

(defun offer (pane subjects x y)
  "Show what can be done with the first of SUBJECTS, which lie at X, Y of PANE; name the others."
  (let ((window (window-of pane)))
    (when subjects
      (select window (first subjects))
      (multiple-value-bind (x y) (place-outside pane x y)
        (offer-at window subjects x y)))))

(defmethod handle-click ((pane display-pane) button x y)
  (if (eq button :right)
      (offer pane (picked-first (window-of pane) (subjects-under pane x y)) x y)
      (pick-next pane x y)))

;;; In the display of designators, the right button scrolls up and the left one down if they do not
;;; all fit (manual B); then the middle one opens the menu. Readings 26 and 28.

(defclass designators-pane (detail-pane) ())

(defmethod handle-click ((pane designators-pane) button x y)
  (cond ((eq button :middle)
         (offer pane (subjects-under pane x y) x y))
        ((not (scrollable-p pane)) (call-next-method))
        ((eq button :right) (scroll pane (- +scroll-step+)))
        (t (scroll pane +scroll-step+))))

;;; CLIM's events.

(defun button-name (event)
  (let ((button (clim:pointer-event-button event)))
    (cond ((eql button clim:+pointer-left-button+) :left)
          ((eql button clim:+pointer-right-button+) :right)
          (t :middle))))

(defun route-press (pane button x y)
  "Handle a press of BUTTON at X, Y of PANE: on its scroll bar, or on what it shows."
  (cond ((on-scroll-bar-p pane x)
         (setf (pane-drag pane) :scroll-bar)
         (drag-scroll-bar pane y))
        (t (handle-press pane button x y))))

(defgeneric handle-press-past-popup (pane button x y opener)
  (:documentation "Handle a press of BUTTON at X, Y of PANE that has closed the popup which OPENER
had opened.")
  (:method (pane button x y opener)
    (declare (ignore opener))
    (unless (eq button :left) (route-press pane button x y)))
  ;; A button opens its own panel at once, but only closes that if it is open.
  (:method ((pane bar-pane) button x y opener)
    (let ((pressed (subject-at (pane-subjects pane) x y)))
      (when (and pressed (not (eq opener (button-command pressed))))
        (route-press pane button x y)))))

(defun take-press (pane button x y)
  "Handle a press of BUTTON at X, Y of PANE; close an open popup unless PANE is that."
  (take-keys pane)
  (let ((opener (and (not (typep pane 'popup-pane)) (close-popup (window-of pane)))))
    (if opener
        (handle-press-past-popup pane button x y opener)
        (route-press pane button x y))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-press-event))
  (multiple-value-call #'take-press pane (button-name event) (event-place pane event)))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-release-event))
  (let ((dragged (pane-drag pane)))
    (unless (member dragged '(nil :scroll-bar))
      (multiple-value-call #'handle-drop pane (event-place pane event)))
    (setf (pane-drag pane) nil)
    (point-at-mouse (window-of pane))))

;; During dragging, the strip describes that, wherever the mouse is.
(defun dragging-pane (window)
  (find-if #'pane-drag (display-panes window)))

;; Panels that open or close under the mouse make events of a mouse that rests.
(defun note-mouse (pane event)
  "Note where in the window of PANE the mouse is, by EVENT. True if it was elsewhere before."
  (let* ((window (window-of pane))
         (place (multiple-value-list
                 (clim:transform-position
                  (clim:sheet-delta-transformation pane (clim:frame-top-level-sheet window))
                  (clim:pointer-event-x event) (clim:pointer-event-y event)))))
    (not (equalp place (shiftf (window-mouse window) place)))))

(defmethod clim:handle-event :around ((pane display-pane) (event clim:pointer-motion-event))
  (let ((moved-p (note-mouse pane event)))
    (when (or moved-p (not (typep pane 'popup-pane)))
      (call-next-method))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-motion-event))
  (multiple-value-bind (x y) (event-place pane event)
    (case (pane-drag pane)
      ((nil) (unless (dragging-pane (window-of pane)) (handle-hover pane x y)))
      (:scroll-bar (drag-scroll-bar pane y))
      (t (handle-drag pane x y)))))

(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-exit-event))
  (unless (dragging-pane (window-of pane))
    (clear-pointing (window-of pane))
    (repaint-if-changed (pane-named (window-of pane) 'strip))))

;;; A turn of the wheel is a button event, too, but not a press.
(defmethod clim:handle-event ((pane display-pane) (event clim:pointer-button-event))
  (let ((steps (position (clim:pointer-event-button event)
                         (list clim:+pointer-wheel-up+ nil clim:+pointer-wheel-down+))))
    (when steps
      (multiple-value-call #'handle-wheel pane (1- steps) (event-place pane event)))))

;;; What is shown of the robot's parts.

;;; What is drawn there is not where it lies, so it cannot be dragged. If you try, the strip says
;;; what to do instead. (PANE-DRAG PANE) is (thing from-x from-y moved-p).

(defun no-dragging-text (image window)
  "Return in words why the thing of IMAGE cannot be dragged out of a display of WINDOW."
  (let ((hand (hand-with image window)) (name (subject-title image)))
    (cond (hand (format nil "Only lines let go of ~A, such as hand-ungrasp ~D: the right button ~
                             offers them."
                        name (hand-image-index hand)))
          ((thing-image-location image)
           (format nil "~A is ~A: only lines take it out." name (thing-image-location image)))
          (t (format nil "~A can be dragged where it lies in the world." name)))))

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
      (hint (window-of pane) (no-dragging-text thing (window-of pane))))))

(defmethod handle-drop ((pane detail-pane) x y)
  (unless (fourth (pane-drag pane)) (handle-click pane :left x y)))
