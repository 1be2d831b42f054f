;;;; clim-client.lisp -- the window from outside: functions run in its thread, and another X client.

;;; Loaded by the tests and benchmarks of the window.

(defpackage :ars-magna.window-client
  (:documentation "What tests and benchmarks ask of a window that is on the screen.")
  (:use :cl)
  (:local-nicknames (:base :ars-magna.base))
  (:export #:run-in-window #:call-with-x-window #:corner-of))

(in-package :ars-magna.window-client)

(defclass errand (clim:window-manager-event)
  ((function :initarg :function :reader errand-function))
  (:documentation "Something that the window's thread is to do."))

(defmethod clim:handle-event ((sheet clime:top-level-sheet-mixin) (event errand))
  (funcall (errand-function event)))

(defun run-in-window (window function &key (seconds 60))
  "Let the thread of WINDOW call FUNCTION, after what it had to do before; return its value. It is
an error if that takes longer than so many SECONDS."
  (let ((done (base:make-semaphore "done")) (sheet (clim:frame-top-level-sheet window)) value)
    (clim:queue-event sheet (make-instance 'errand
                                           :sheet sheet
                                           :function (lambda ()
                                                       (setf value (funcall function))
                                                       (base:signal-semaphore done))))
    (unless (base:wait-on-semaphore done seconds) (error "The window does not answer."))
    value))

(defun seek-x-window (name x-window)
  "Return the X window called NAME that is, or is below, X-WINDOW; NIL if there is none."
  (if (equal name (ignore-errors (xlib:wm-name x-window)))
      x-window
      (some (lambda (child) (seek-x-window name child)) (xlib:query-tree x-window))))

(defun x-window-on (display window)
  "Return the X window of WINDOW on DISPLAY."
  (seek-x-window (clim:frame-pretty-name window)
                 (xlib:screen-root (xlib:display-default-screen display))))

(defun call-with-x-window (function window &key display)
  "Call FUNCTION with the X window of WINDOW, as a second client of the X server knows it: of the
one with the number DISPLAY, or of that which the environment names."
  (let ((display (if display (xlib:open-display "" :display display) (xlib:open-default-display))))
    (unwind-protect (funcall function (x-window-on display window))
      (xlib:close-display display))))

(defun corner-of (pane)
  "Return how far right and down in its X window PANE begins, in pixels."
  (clim:transform-position (clim:sheet-delta-transformation
                            pane (clim:frame-top-level-sheet (clim:pane-frame pane)))
                           0 0))
