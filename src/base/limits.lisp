;;;; limits.lisp -- calling a function for a limited time.

(in-package :ars-magna.base)

(deftype time-limit ()
  "The condition that is signalled when the time for a form is up, as by WITH-TIMEOUT."
  'sb-ext:timeout)

(defun call-with-limit (function seconds give-up)
  "Call FUNCTION. Should it not have returned after SECONDS, call GIVE-UP in this thread, which may
leave it; and so again and again."
  (let ((timer (sb-ext:make-timer give-up)))
    (sb-ext:schedule-timer timer seconds :repeat-interval seconds)
    (unwind-protect (funcall function)
      (sb-ext:unschedule-timer timer))))
