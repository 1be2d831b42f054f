;;;; strip.lisp -- the status strip: when it is, how fast time goes, what lies under the mouse.

(in-package :ars-magna.clim)

;;; The upper line says how time goes, and what waits for an answer; the lower one what lies under
;;; the mouse. What is too long ends in three dots: a click on the strip tells all of the upper line
;;; among the commands, one on what the mouse is at all of the lower.

(defclass strip-pane (display-pane) ()
  (:default-initargs :background clim:+gray88+)
  (:documentation "The status strip."))

(defun tick-text (window)
  "Return in words at which tick WINDOW shows its run; of one that is over, when that ended."
  (let ((snapshot (window-snapshot window)) (simulation (window-simulation window)))
    (format nil "tick ~:[?~;~:*~D~]"
            (if (and simulation (simulation-over simulation))
                (simulation-tick simulation)
                (and snapshot (snapshot-tick snapshot))))))

(defun answers-text (window)
  "Return in words how many programs wait for an answer at the prompt of WINDOW, or NIL."
  (let ((count (length (answers-awaited (window-conversation window)))))
    (when (plusp count)
      (format nil "the prompt asks how ~:[~R programs go~;a program goes~] on" (= count 1) count))))

(defun time-text (window)
  (format nil "~A  ~A~:[~;; a program waits for your answer~]~@[; ~A~]" (tick-text window)
          (progress-text (watcher-progress (window-watcher window)))
          (asked-by (window-conversation window))
          (answers-text window)))

(defun strip-lines (window)
  (list (time-text window) (window-hint window)))

(defmethod pane-content ((pane strip-pane))
  (list (strip-lines (window-of pane)) (multiple-value-list (pane-size pane))))

(defmethod paint ((pane strip-pane))
  (let ((columns (max 4 (floor (- (pane-size pane) 12) +character-width+))))
    (painting (canvas pane)
      (loop for line in (strip-lines (window-of pane))
            for y from 14 by +line-height+
            do (draw-glyphs canvas draw-gcontext* 6 y (cut line columns))))))

(defmethod hover-text ((pane strip-pane) x y)
  (declare (ignore x y))
  "Click to have all of the line above among the commands")

(defmethod click ((pane strip-pane) button x y)
  (declare (ignore button x y))
  (let ((window (window-of pane)))
    (say-in-window window "~A~%" (time-text window))))
