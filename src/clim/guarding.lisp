;;;; guarding.lisp -- trouble in what the user asks a window for is said in it, and goes no further.

(in-package :ars-magna.clim)

(defun call-guarded-command (window title function)
  (handler-case (funcall function)
    (error (condition)
      (say (window-transcript window)
           (format nil "~&*ERROR* -> ~A: ~A~%" title
                   (substitute #\Space #\Newline (princ-to-string condition)))))))

(defmacro with-guarded-command ((window title) &body body)
  "Run BODY, the work of the command TITLE; what goes wrong is said in WINDOW."
  `(call-guarded-command ,window ,title (lambda () ,@body)))
