;;;; buffering.lisp -- a pane is painted out of sight and shown as a whole, without waiting.

(in-package :ars-magna.clim)

;;; CLIM's own buffers ask the X server several questions for each pane and picture. While ticks
;;; pass as fast as they can, each answer comes late, and pictures with them. So a pane has a pixmap
;;; of its own, as large as it is; nothing is asked. It takes a pane that the X server knows as a
;;; window, as CLIM's port to it makes them; others are painted by CLIM's buffers.

(defclass buffered-pane ()
  ((buffer :initform nil :accessor pane-buffer)
   ;; Its width and height, in pixels of the screen.
   (buffer-size :initform nil :accessor pane-buffer-size))
  (:documentation "What a pane needs in order to be painted out of sight."))

(defun forget-buffer (pane)
  (let ((old (shiftf (pane-buffer pane) nil)))
    (when old (clim:deallocate-pixmap old))))

(defun buffer-of (pane width height)
  "Return a pixmap of WIDTH times HEIGHT of the screen's pixels for PANE."
  (let ((size (list width height)))
    (unless (and (pane-buffer pane) (equal size (pane-buffer-size pane)))
      (forget-buffer pane)
      (setf (pane-buffer pane) (clim:allocate-pixmap pane width height)
            (pane-buffer-size pane) size))
    (pane-buffer pane)))

(defun call-in-buffer (function pane width height)
  "Call FUNCTION, which paints PANE, of WIDTH times HEIGHT of the screen's pixels; show all of that
at once."
  (let ((buffer (buffer-of pane width height)) (medium (clim:sheet-medium pane)))
    (setf (clim:medium-drawable medium) buffer)
    (unwind-protect (funcall function)
      (setf (clim:medium-drawable medium) nil))
    (clim:copy-from-pixmap buffer 0 0 width height pane 0 0)
    (clim:medium-force-output medium)))

(defun call-buffered (function pane)
  "Call FUNCTION, which paints PANE; nothing is seen of that before it returns."
  (multiple-value-bind (width height) (size-on-screen pane)
    (flet ((paint () (call-magnified function pane (magnification pane))))
      (cond ((not (and (plusp width) (plusp height))))
            ((clim:sheet-direct-mirror pane) (call-in-buffer #'paint pane width height))
            (t (clim:with-output-buffered (pane) (paint)))))))
