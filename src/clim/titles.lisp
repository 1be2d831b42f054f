;;;; titles.lisp -- the titles of displays.

(in-package :ars-magna.clim)

(defclass title-pane (display-pane)
  ((section :initarg :section :reader pane-section))
  (:default-initargs :background clim:+gray88+)
  (:documentation "The title of a display. A click folds the display away, or brings it back."))

(defun foldable-p (section) (and (member section +sections+) t))

(defun world-title (window)
  "Return the map that WINDOW shows, the robot if there are several, and whether that is a fork or
trial."
  (let ((map (and (window-snapshot window) (window-map window)))
        (simulation (window-simulation window)))
    (format nil "World~@[: ~(~A~)~]~@[, ~A~]~@[, ~A of ~D robots~]" (and map (map-name map))
            (and simulation (ars-magna.cli:way-in simulation))
            (and (rest (window-robots window)) (shown-robot window))
            (length (window-robots window)))))

(defun section-title (window section)
  (case section
    (world (world-title window))
    (transcript "Commands")
    (plan "Plan")
    (t (display-title (pane-display (pane-named window section))))))

(defmethod pane-content ((pane title-pane))
  (let ((window (window-of pane)) (section (pane-section pane)))
    (list (section-title window section) (folded-p window section)
          (multiple-value-list (pane-size pane)))))

(defmethod paint ((pane title-pane))
  (let* ((window (window-of pane)) (section (pane-section pane))
         (foldable-p (foldable-p section)))
    (painting (canvas pane)
      (when foldable-p
        (draw-lines canvas draw-gcontext*
                    (if (folded-p window section) '(5 4 10 8 5 12) '(4 6 12 6 8 11))
                    :fill-p t))
      (draw-glyphs canvas draw-gcontext* (if foldable-p 18 6) 13
                   (section-title window section)))))

(defmethod hover-text ((pane title-pane) x y)
  (declare (ignore x y))
  (case (pane-section pane)
    (world "Click to choose a robot")
    (transcript "")
    (t "Click to fold this display away, or to bring it back")))

(defmethod click ((pane title-pane) button x y)
  (declare (ignore button))
  (let ((window (window-of pane)) (section (pane-section pane)))
    (cond ((foldable-p section)
           (fold window section (not (folded-p window section))))
          ((eq section 'world)
           (multiple-value-bind (x y) (place-outside pane x y)
             (open-popup window (robot-rows window) x y))))))
