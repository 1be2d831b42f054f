;;;; interrupts.lisp -- where a thread may be interrupted from outside, and by what.

(in-package :ars-magna.base)

;;; What interrupts a thread is a time limit, Ctrl-C, another thread, or that it is to end. It may
;;; leave what it interrupts. Where that would lock others out for ever, it waits for a moment. Not
;;; for longer, though: Lisp's own runtime dies if a timer strikes while memory is collected in a
;;; thread that holds interrupts off.

(deftype time-limit ()
  "The condition that is signalled when the time for a form is up, as by WITH-TIMEOUT."
  'sb-ext:timeout)

(defmacro deferring-interrupts (&body body)
  "Run BODY. What interrupts this thread waits, but for the extent of ALLOWING-INTERRUPTS."
  `(sb-sys:without-interrupts (sb-sys:allow-with-interrupts ,@body)))

(defmacro allowing-interrupts (&body body)
  "Run BODY, in which this thread can be interrupted."
  `(sb-sys:with-interrupts ,@body))

(defun call-with-limit (function seconds give-up)
  "Call FUNCTION. Should it not have returned after SECONDS, call GIVE-UP in this thread, which may
leave it; and so again and again."
  (let ((timer (sb-ext:make-timer give-up)))
    (sb-ext:schedule-timer timer seconds :repeat-interval seconds)
    (unwind-protect (funcall function)
      (sb-ext:unschedule-timer timer))))

;;; The same for functions, and strictly: what happens to be called in between cannot let any in.

(defvar *open-to-interrupts* #'funcall
  "A function that calls another, in which this thread takes interrupts.")

(defun call-holding-interrupts (function)
  "Call FUNCTION. Until it returns, interrupts wait, but in what CALL-OPEN-TO-INTERRUPTS calls."
  (sb-sys:without-interrupts
    (let ((*open-to-interrupts* (lambda (function)
                                  (sb-sys:with-local-interrupts (funcall function)))))
      (funcall function))))

(defun call-open-to-interrupts (function)
  "Call FUNCTION, in which this thread takes interrupts, those too that wait."
  (funcall *open-to-interrupts* function))
