;;;; saying.lisp -- warnings that come once for each name in a run.

(in-package :ars-magna.time)

;;; What is allowed, but most likely not what the user wanted, is said once: further warnings about
;;; the same name would only hide others. A fork knows what was said before it was made.

(defun first-time-p (object topic name)
  "True if nothing has been said yet of TOPIC and NAME in the run of OBJECT; from now on it has."
  (let ((timeline (timeline-of object)) (key (cons topic name)))
    (loop for said = (timeline-said timeline)
          when (member key said :test #'equal) return nil
          when (swap-if (timeline-said timeline) said (cons key said)) return t)))

(defun warn-once (object topic name items &key (notable t))
  "Queue a warning made of the list ITEMS, unless the run of OBJECT has had one of TOPIC, a keyword,
and NAME, a symbol or string. It is shown like an error if nobody reads it, and NOTABLE is true, or a
function that returns true by then. Return true if it was queued."
  (when (first-time-p object topic name)
    (queue-message (make-message :warning items :notable-p notable) *message-queue*)
    t))
