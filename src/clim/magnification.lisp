;;;; magnification.lisp -- how many screen pixels wide one pixel of a window is.

(in-package :ars-magna.clim)

;;; On a screen with a high resolution, letters of 12 pixels are too small to read. So a window is
;;; arranged, painted and pointed at in its own pixels. Each is several screen pixels wide, as
;;; the user wants: a whole number, so that letters keep their columns.

(define-constant +smallest-size+ '(640 480)
  :test #'equal
  :documentation "The least width and height, in window pixels, that show everything.")

(defun magnification (pane)
  "Return the magnification of the window of PANE, in screen pixels per window pixel."
  (window-magnification (clim:pane-frame pane)))

(defun pane-size (pane)
  "Return the width and height of PANE, in window pixels."
  (let ((region (clim:sheet-region pane)) (magnification (magnification pane)))
    (values (floor (clim:bounding-rectangle-width region) magnification)
            (floor (clim:bounding-rectangle-height region) magnification))))

(defun size-on-screen (pane)
  "Return the width and height of PANE, in screen pixels."
  (let ((region (clim:sheet-region pane)))
    (values (floor (clim:bounding-rectangle-width region))
            (floor (clim:bounding-rectangle-height region)))))

(defun move-and-resize-pane (pane left top width height)
  "Move PANE to LEFT, TOP of its parent and make it WIDTH x HEIGHT large, all in window pixels."
  (let ((magnification (magnification pane)))
    (flet ((on-screen (pixels) (* magnification pixels)))
      (clim:move-and-resize-sheet pane (on-screen left) (on-screen top)
                                  (on-screen width) (on-screen height))
      (clim:allocate-space pane (on-screen width) (on-screen height)))))

(defun position-in-parent (pane x y)
  (let ((magnification (magnification pane)))
    (multiple-value-bind (left top) (clim:transform-position (clim:sheet-transformation pane) 0 0)
      (values (+ x (floor left magnification)) (+ y (floor top magnification))))))

(defun event-position (pane event)
  (let ((magnification (magnification pane)))
    (values (floor (clim:pointer-event-x event) magnification)
            (floor (clim:pointer-event-y event) magnification))))

;;; How many that is.

(defun graft-size (graft)
  (if graft
      (values (clim:graft-width graft) (clim:graft-height graft))
      (values nil nil)))

(defun window-magnification (window)
  "Return the magnification of WINDOW, in screen pixels per window pixel. The user chooses it; the
default depends on the screen's resolution."
  (or (preferences-magnification (window-preferences window)) (window-usual-magnification window)))

(defun greatest-magnification (width height)
  "Return the largest magnification with which a window of +SMALLEST-SIZE+ fits on a screen of WIDTH
x HEIGHT pixels. An unknown WIDTH or HEIGHT is NIL."
  (destructuring-bind (least-width least-height) +smallest-size+
    (clamp (min (if width (floor width least-width) +greatest-magnification+)
                (if height (floor height least-height) +greatest-magnification+))
           1 +greatest-magnification+)))

(defun usual-magnification (resolution &optional width height)
  "Return the default magnification for a screen of WIDTH x HEIGHT pixels with RESOLUTION in dots
per inch. An unknown argument is NIL."
  (clamp (round (or resolution 96) 96) 1 (greatest-magnification width height)))

(defun set-magnification (window magnification)
  "Set the magnification of WINDOW. If MAGNIFICATION is too small or too large, say so in WINDOW."
  (cond ((< magnification 1) (write-in-window window "The window is at its smallest size: smaller ~
                                                      letters could not be read.~%"))
        ((< (multiple-value-call #'greatest-magnification (screen-size (window-layout window)))
            magnification)
         (write-in-window window "The window is at its largest size: a larger one would not fit on ~
                                  this screen.~%"))
        ((/= magnification (window-magnification window))
         (setf (preferences-magnification (window-preferences window)) magnification)
         (rearrange window))))
