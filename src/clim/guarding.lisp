;;;; guarding.lisp -- what goes wrong in a window is said there, and nothing else comes of it.

(in-package :ars-magna.clim)

;;; The thread of a window handles its mouse and its keys: were it to wait in a debugger, nobody
;;; could answer that there.

(defun refuse-debugger (condition hook)
  "Signal MISUSE, as CONDITION calls for a debugger in the thread of a window."
  (declare (ignore hook))
  (reject-use "It calls for the debugger (~A), and a window does not wait for that. SAVE-PICTURE ~
               at the prompt draws it where the debugger answers."
              (one-line-text condition)))

(defmacro without-debugger (&body body)
  "Run BODY, in which what calls for a debugger is an error."
  `(let ((*break-on-user-error* nil) (*debugger-refused-p* t))
     (with-debugger-hook (#'refuse-debugger) ,@body)))

(defun call-guarded-command (window title function)
  (handler-case (funcall function)
    (error (condition)
      (say-in-window window "*ERROR* -> ~A: ~A.~%" title (one-line-text condition)))))

(defmacro with-guarded-command ((window title) &body body)
  "Run BODY, the work of the command TITLE; what goes wrong is said in WINDOW."
  `(call-guarded-command ,window ,title (lambda () ,@body)))
