;;;; windows.lisp -- opening a window; coordinates and scale bar at the edges of its view.

(in-package :ars-magna.display)

(export '(draw-view-margins view-strip-widths *display-opener* *window-close-waiter*
                            open-display-or-report))

;;; A window shows a part of the map. Numbers and scale bar are in strips along its edges. The map
;;; is in view between the strips, so that they hide nothing. A number at the end of a strip is
;;; moved to be complete. Coordinates are pixels of the whole map: the view begins at LEFT, TOP.

(defconstant +strip-height+ 17 "The height of the strip of numbers, in pixels.")
(defconstant +scale-bar-strip-height+ 24 "The height of the strip of the scale bar, in pixels.")

(defun view-strip-widths (map layers)
  "Return a list of the widths, in pixels, of the strips for coordinates and scale bar at the left,
top and bottom of a view of MAP. The width is 0 if LAYERS do not show the strip."
  (let ((numbers-p (member :coordinates layers)))
    (list (if numbers-p (+ 11 (monospaced-width (princ-to-string (map-height map)))) 0)
          (if numbers-p +strip-height+ 0)
          (if (member :scale-bar layers) +scale-bar-strip-height+ 0))))

(defun draw-strip-background (canvas left top width height)
  (with-gcontext (draw-gcontext* :foreground (svref grey* 58))
    (draw-rectangle canvas draw-gcontext* left top width height t)))

(defun draw-axis-mark (canvas x y end-x end-y)
  (with-color +frame-ink+
    (draw-segments canvas draw-gcontext* (list x y end-x end-y))))

(defun draw-x-coordinates (canvas map left top start end)
  "Draw x coordinates in metres for the pixels from START to END of MAP in a strip at LEFT, TOP."
  (draw-strip-background canvas left top (- end left) +strip-height+)
  (dolist (metres (marks-between (/ (max 0 start) graphics-scale*)
                                 (min (/ end graphics-scale*) (map-width map)) 60))
    (let* ((text (princ-to-string metres)) (x (to-pixels metres)) (width (monospaced-width text)))
      (draw-axis-mark canvas x (+ top 14) x (+ top 17))
      (draw-text canvas (clamp (- x (/ width 2)) left (max left (- end width))) (+ top 11)
                 text))))

(defun draw-y-coordinates (canvas map left top width end)
  "Draw the strip of y coordinates, in metres, for the pixels from TOP to END of MAP. The strip
begins at LEFT and is WIDTH pixels wide."
  (draw-strip-background canvas left top width (- end top))
  (dolist (metres (marks-between (/ (max 0 top) graphics-scale*)
                                 (min (/ end graphics-scale*) (map-height map)) 60))
    (let* ((text (princ-to-string metres)) (y (to-pixels metres)) (right (+ left width)))
      (draw-axis-mark canvas (- right 3) y right y)
      (draw-text canvas (- right 8 (monospaced-width text)) (min (+ y 4) (- end 2)) text))))

(defun draw-view-margins (canvas map layers left top width height)
  "Draw coordinates and scale bar at the edges of a view of MAP, if LAYERS contain :COORDINATES and
:SCALE-BAR. The view is WIDTH by HEIGHT pixels large and begins LEFT and TOP pixels from the corner
of MAP. Call this within WITH-CANVAS, with the origin in the corner of MAP."
  (destructuring-bind (left-edge top-edge bottom-edge) (view-strip-widths map layers)
    (let* ((right (+ left width)) (bottom (- (+ top height) bottom-edge)))
      (when (member :coordinates layers)
        ;; In this order: the first number of a row may reach into the empty corner.
        (draw-x-coordinates canvas map left top (+ left left-edge) right)
        (draw-y-coordinates canvas map left (+ top top-edge) left-edge bottom))
      (when (member :scale-bar layers)
        (draw-strip-background canvas left bottom width bottom-edge)
        (with-origin (canvas (+ left 36) 0)
          (draw-scale-bar canvas (map-width map) (+ bottom (floor bottom-edge 2))))))))

;;;; Opening windows

(defvar *display-opener* nil
  "A function of a robot that opens a window with its displays, or NIL without ars-magna/clim.")

(defvar *window-close-waiter* nil
  "A function that waits until all windows are closed, or NIL if ars-magna/clim is not loaded.")

(addition open-display)
(defun open-display (robot)
  "Show ROBOT and its world in a window that follows the run (manual B). Return ROBOT. A robot has
one window. If this window is already open, it comes to the front and shows the run of ROBOT, which
can be a fork or a trial. Signals MISUSE if no window can be opened: see ars-magna/clim."
  (check-argument open-display robot (robot-p robot) "a robot")
  (unless *display-opener*
    (reject-use "No display: windows need McCLIM and the system ars-magna/clim. At the ~
                 prompt, WINDOW loads both. PICTURE and MAP need no window."))
  (funcall *display-opener* robot)
  robot)

(defvar *reported-messages* '()
  "The messages already printed about displays that could not be opened, each printed only once.")

(defun open-display-or-report (robot options)
  "Open the window of ROBOT, which SIMULATOR has started. If this fails, print the reason and the
remedy, but only the first time. Do nothing if the OPTIONS of SIMULATOR have :DISPLAY NIL."
  (when (getf options :display t)
    (handler-case (open-display robot)
      (error (condition)
        (let ((text (format nil "Note: the run continues without a window. ~A"
                            (one-line (text-of-condition condition)))))
          (unless (member text *reported-messages* :test #'string=)
            (push text *reported-messages*)
            (out text t)))))))

(add-listener *simulator-hooks* open-display-or-report)
(pushnew 'display *simulator-hook-options*)
