;;;; signals.lisp -- signals from the system: control C, and the request to end.

(in-package :ars-magna.host)

(export '(user-interrupt signal-user-interrupt call-on-interrupt call-on-continuing
          die-of-interrupts die-of-termination))

(deftype user-interrupt ()
  "The condition that the user has pressed control C."
  (internal-name :sb-sys '#:interactive-interrupt))

(defun signal-user-interrupt ()
  "Signal the error USER-INTERRUPT."
  (error (internal-name :sb-sys '#:interactive-interrupt)))

(defun handle-signal (signal handler)
  (internal (:sb-sys #:enable-interrupt) signal handler))

(defun call-on-interrupt (function)
  "Call FUNCTION, in any thread, whenever control C is pressed."
  (handle-signal sb-posix:sigint
                 (lambda (signal info context)
                   (declare (ignore signal info context))
                   (funcall function))))

(defun call-on-continuing (function)
  "Call FUNCTION, in any thread, whenever this process goes on that was stopped, as by control Z."
  (handle-signal sb-posix:sigcont
                 (lambda (signal info context)
                   (declare (ignore signal info context))
                   (funcall function))))

;;; There are states in which no Lisp runs any more that would handle a signal, so the system itself
;;; ends the process. (With a terminal that goes away it does so anyway, unless it was told NOHUP.)

(defun die-of-interrupts ()
  "Let control C end this process at once, as when its memory is being saved."
  (handle-signal sb-posix:sigint :default))

(defun die-of-termination ()
  "Let this process end at once when it is told to terminate, as by control \\."
  (handle-signal sb-posix:sigterm :default)
  (handle-signal sb-posix:sigquit :default))
