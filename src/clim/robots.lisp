;;;; robots.lisp -- which of the robots of its run a window shows in detail, and commands.

(in-package :ars-magna.clim)

(defun window-robots (window)
  "Return the names of the robots of the run that WINDOW shows."
  (let ((snapshot (window-snapshot window)))
    (and snapshot (mapcar #'robot-image-name (snapshot-robots snapshot)))))

(defun shown-robot (window)
  "Return the name of the robot whose details WINDOW shows."
  (or (window-robot-name window) (watcher-robot (window-watcher window))))

(defun show-details (window name)
  "Show the details of the robot called NAME in WINDOW."
  (setf (window-robot-name window) name)
  (refresh window))

(defun choose-robot (window name)
  "Show the details of the robot called NAME in WINDOW, and let the prompt command it."
  (show-details window name)
  (give-line (window-conversation window) (format nil "robot ~(~A~)" name)))

(defun robot-row (window name)
  (make-row (format nil "~A" name)
            :tick-p t :tick (lambda () (same-name-p name (shown-robot window)))
            :action (lambda () (choose-robot window name))))

(defun robot-rows (window)
  "Return the rows of the menu of robots."
  (cons (make-row "Which robot?")
        (loop for name in (window-robots window) collect (robot-row window name))))
