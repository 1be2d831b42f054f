;;;; strip.lisp -- the status strip: when it is, how fast time goes, what lies under the mouse.

(in-package :ars-magna.clim)

(defclass strip-pane (display-pane) ()
  (:default-initargs :background clim:+gray88+)
  (:documentation "The status strip."))

(defun tick-text (window)
  (let ((snapshot (window-snapshot window)))
    (format nil "tick ~:[?~;~:*~D~]" (and snapshot (snapshot-tick snapshot)))))

(defun strip-text (window)
  "Return what the status strip of WINDOW says."
  (format nil "~A  ~A  ~A" (tick-text window)
          (progress-text (watcher-progress (window-watcher window)))
          (window-hint window)))

(defmethod pane-content ((pane strip-pane))
  (list (strip-text (window-of pane)) (multiple-value-list (pane-size pane))))

(defmethod paint ((pane strip-pane))
  (clear pane clim:+gray88+)
  (painting (canvas pane)
    (draw-glyphs canvas draw-gcontext* 6 14 (strip-text (window-of pane)))))

(defmethod click ((pane strip-pane) button x y)
  (declare (ignore button x y)))
