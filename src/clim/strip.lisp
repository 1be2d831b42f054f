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

(defmethod pane-content ((pane strip-pane)) (strip-text (window-of pane)))

(defmethod paint ((pane strip-pane))
  (let ((canvas (make-instance 'clim-canvas :medium pane)))
    (clear pane clim:+gray88+)
    (with-canvas (canvas)
      (draw-glyphs canvas draw-gcontext* 6 14 (strip-text (window-of pane))))))
