;;;; saying.lisp -- warnings that come once for each name in a run.

(in-package :ars-magna.world)

(export '(first-time-p said-p note-looked-after looked-after-p warn-once doubt-angle))

;;; What is allowed, but most likely not what the user wanted, is said once: further warnings about
;;; the same name would only hide others. Saved runs know a world's slots by name: NOTED-NAMES has
;;; all that has been said, though it began with names of attributes.

;;; Plans of live runs warn in a thread of their own: NOTED-NAMES is read and changed under a lock.

(defvar *saying-lock* (make-lock "what has been said"))

(defun said-p (key world)
  "True if a warning about KEY has been queued in the run of WORLD."
  (with-lock (*saying-lock*)
    (and (member key (world-noted-names world) :test #'equal) t)))

(defun first-time-p (key world)
  "True if nothing has been said yet about KEY in the run of WORLD; from now on it has."
  (with-lock (*saying-lock*)
    (unless (member key (world-noted-names world) :test #'equal)
      (push key (world-noted-names world))
      t)))

(defun note-looked-after (world)
  "Note that the program has looked itself at what was under way in the run of WORLD."
  (first-time-p '(:looked-after) world))

(defun looked-after-p (world)
  "True if the program has looked itself at what was under way in the run of WORLD."
  (said-p '(:looked-after) world))

(defun warn-once (key world items &key (notable t))
  "Queue a warning made of ITEMS, a list or a string, unless the run of WORLD has had one about KEY,
such as a list of a topic and a name. It is shown like an error if nobody reads it and NOTABLE is
true, or a function that returns true by then. Return true if it was queued."
  (when (first-time-p key world)
    (queue-message (make-message :warning (ensure-list items) :notable-p notable) *message-queue*)
    t))

(defun doubt-angle (operator world angle)
  "Say once for OPERATOR, a symbol or string, in WORLD if ANGLE, in radians, was perhaps meant in
degrees."
  (when (perhaps-degrees-p angle)
    (warn-once (list :angle operator) world
               (format nil "~(~A~): ~A" operator (degrees-advice angle)))))
