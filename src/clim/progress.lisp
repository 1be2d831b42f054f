;;;; progress.lisp -- how time goes in a run: the rate as set and as reached, and whether it stands.

(in-package :ars-magna.clim)

(defstruct (progress (:copier nil))
  "How time goes. STATE is a word; RATE as set, a number or :FREE, or NIL; REACHED in ticks a second,
or NIL if that is not known."
  (state :still :type symbol :read-only t)
  (rate nil :read-only t)
  (reached nil :read-only t))

(defun state-text (state)
  (ecase state
    (:running "running") (:paused "paused") (:still "not live") (:over "over")
    (:idle "idle: time stands still until somebody asks for something")
    (:thinking "waiting for a plan that thinks")
    (:busy "busy: a user's function does not return")))

(defun progress-text (progress)
  "Return what the status strip says of PROGRESS."
  (format nil "~@[~A/s~]~@[ (~A/s reached)~]  ~A"
          (let ((rate (progress-rate progress))) (if (eq rate :free) "free" (and rate (number-text rate))))
          (progress-reached progress)
          (state-text (progress-state progress))))
