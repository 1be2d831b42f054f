;;;; limits.lisp -- calling a function for a limited time; conditions that are for callers.

(in-package :ars-magna.host)

(export '(time-limit let-callers-handle call-with-limit))

(deftype time-limit ()
  "The condition that is signalled when the time for a form is up, as by WITH-TIMEOUT."
  'sb-ext:timeout)

;;; FiveAM signals that a check has failed, and its restart IGNORE-FAILURE lets the test go on after
;;; it has counted that. Whoever runs the test handles this, also where the check is in a plan.

(defun failed-check-p (condition)
  (and (typep condition 'error)
       (find "IGNORE-FAILURE" (compute-restarts condition)
             :key #'restart-name :test #'string=)
       t))

(defun let-callers-handle (condition)
  "Let those who have called the run handle CONDITION first, if it is for them. True if it is a
limit to their time."
  (let ((limit-p (typep condition 'time-limit)))
    (when (or limit-p (failed-check-p condition)) (signal condition))
    limit-p))

(defun call-with-limit (function seconds give-up)
  "Call FUNCTION. Should it not have returned after SECONDS, call GIVE-UP in this thread, which may
leave it; and so again and again."
  (let ((timer (sb-ext:make-timer give-up)))
    (sb-ext:schedule-timer timer seconds :repeat-interval seconds)
    (unwind-protect (funcall function)
      (sb-ext:unschedule-timer timer))))
