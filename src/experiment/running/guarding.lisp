;;;; guarding.lisp -- a trial that does not return, or ends its thread, ends neither run nor worker.

(in-package :ars-magna.experiment)

(export '(run-guarded))

;;; A worker's thread may be ended in three ways: by the trial itself, which is that trial's error;
;;; when the run is stopped; and when this Lisp is left. In the last two nothing is held up.

(defun call-catching-thread-end (function stopping-p)
  "Call FUNCTION in a worker. True if it has ended this thread, which goes on then, unless the
function STOPPING-P returns true."
  (let ((returned-p nil))
    (block call
      (unwind-protect (progn (funcall function)
                             (setf returned-p t)
                             nil)
        (unless (or returned-p *leaving-p* (funcall stopping-p))
          (return-from call t))))))

(defun call-within (function seconds)
  "Call FUNCTION, but leave it after so many SECONDS, unless these are NIL. True if it was left."
  (block call
    (let ((open-p t))
      (flet ((leave () (when open-p (return-from call t))))
        (unwind-protect (if seconds
                            (call-with-limit function seconds #'leave)
                            (funcall function))
          (setf open-p nil))))
    nil))

;; How far it has come differs from run to run. So that is left out: its row is always the same.
(defun timed-out-result (condition trial seed)
  "Return the result of TRIAL of CONDITION, which has SEED, as its time was up."
  (let ((result (make-result condition trial seed)))
    (setf (result-outcome result) "timeout" (result-ticks result) nil)
    result))

(defun run-guarded (experiment condition trial stopping-p &optional seconds)
  "Run TRIAL of CONDITION of EXPERIMENT in a worker's thread, for at most so many SECONDS, unless
these are NIL. Return its result, whatever the trial does to the thread unless the function
STOPPING-P returns true."
  (let* ((seed (trial-seed experiment trial)) (late-p nil)
         (result (make-result condition trial seed)))
    (if (call-catching-thread-end
         (lambda ()
           (setf late-p (call-within
                         (lambda () (setf result (run-trial experiment condition trial)))
                         seconds)))
         stopping-p)
        (note-error result "The trial has ended the thread that it ran in.")
        (when late-p (setf result (timed-out-result condition trial seed))))
    result))
