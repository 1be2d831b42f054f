;;;; magnification.lisp -- how many screen pixels wide one pixel of a window is.

(in-package :ars-magna.clim)

;;; On a screen with a high resolution, letters of 12 pixels are too small to read. So a window is
;;; arranged, painted and pointed at in its own pixels. Each is several screen pixels wide, as
;;; the user wants: a whole number, so that letters keep their columns.

(define-constant +smallest-size+ '(640 480)
  :test #'equal
  :documentation "Width and height of the smallest window in which everything is visible, in its
pixels.")

(defconstant +most-magnified+ 6 "The largest magnification: screen pixels per window pixel.")

(defun magnification (pane)
  "Return how many screen pixels wide a pixel of PANE is."
  (window-magnification (clim:pane-frame pane)))

(defun pane-size (pane)
  "Return width and height of PANE, in pixels."
  (let ((region (clim:sheet-region pane)) (magnification (magnification pane)))
    (values (floor (clim:bounding-rectangle-width region) magnification)
            (floor (clim:bounding-rectangle-height region) magnification))))

(defun size-on-screen (pane)
  "Return width and height of PANE in screen pixels."
  (let ((region (clim:sheet-region pane)))
    (values (floor (clim:bounding-rectangle-width region))
            (floor (clim:bounding-rectangle-height region)))))

(defun put-pane (pane left top width height)
  "Put PANE there in the pane that holds it, WIDTH times HEIGHT pixels large."
  (let ((magnification (magnification pane)))
    (flet ((on-screen (pixels) (* magnification pixels)))
      (clim:move-and-resize-sheet pane (on-screen left) (on-screen top)
                                  (on-screen width) (on-screen height))
      (clim:allocate-space pane (on-screen width) (on-screen height)))))

(defun place-outside (pane x y)
  "Return where X, Y of PANE is in the pane that holds it."
  (let ((magnification (magnification pane)))
    (multiple-value-bind (left top) (clim:transform-position (clim:sheet-transformation pane) 0 0)
      (values (+ x (floor left magnification)) (+ y (floor top magnification))))))

(defun event-place (pane event)
  (let ((magnification (magnification pane)))
    (values (floor (clim:pointer-event-x event) magnification)
            (floor (clim:pointer-event-y event) magnification))))

;;; How many that is.

(defun graft-size (graft)
  (if graft
      (values (clim:graft-width graft) (clim:graft-height graft))
      (values nil nil)))

(defun window-magnification (window)
  "Return how many screen pixels wide a pixel of WINDOW is: by its user's choice, or else by the
screen's resolution."
  (or (preferences-magnification (window-preferences window)) (window-usual-magnification window)))

(defun most-magnified (width height)
  "Return the largest magnification for a screen of WIDTH times HEIGHT pixels, or NIL for what is
not known: the smallest window in which everything is visible must fit."
  (destructuring-bind (least-width least-height) +smallest-size+
    (clamp (min (if width (floor width least-width) +most-magnified+)
                (if height (floor height least-height) +most-magnified+))
           1 +most-magnified+)))

(defun usual-magnification (resolution &optional width height)
  "Return the magnification that suits a screen of WIDTH times HEIGHT pixels with RESOLUTION in dots
per inch; NIL stands for what is not known."
  (clamp (round (or resolution 96) 96) 1 (most-magnified width height)))

(defun magnify (window magnification)
  "Make a pixel of WINDOW MAGNIFICATION screen pixels wide, or say that there is no room."
  (cond ((< magnification 1) (say-in-window window "Smaller than that nothing could be read.~%"))
        ((< (multiple-value-call #'most-magnified (screen-size (window-layout window)))
            magnification)
         (say-in-window window "Larger than that not all would fit on this screen.~%"))
        ((/= magnification (window-magnification window))
         (setf (preferences-magnification (window-preferences window)) magnification)
         (rearrange window))))
