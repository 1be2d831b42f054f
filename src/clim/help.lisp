;;;; help.lisp -- the panels that tell what keys and mouse do, and let layers and robots be chosen.

(in-package :ars-magna.clim)

(defparameter *mouse-help*
  '("" "Mouse" "  hover               the strip below tells what is there"
    "  click               pick it; it is described below"
    "  right button        what can be done with it"
    "  drag the map        move the view; the wheel zooms"
    "  drag a thing        while time stands still: put it elsewhere"
    "  titles, splitters   fold displays, make them larger"
    "  designators         where they do not fit: left scrolls down, right up, middle offers")
  "What the help panel says of the mouse.")

(defun help-rows ()
  (mapcar #'make-row
          (append (list "Keys, after a click on a display")
                  (loop for button in *buttons*
                        collect (format nil "  ~7A ~A" (key-text (button-key button))
                                        (button-help button)))
                  (list "  arrows  move the view" "  return  back to the line that is typed"
                        "  escape  close such a panel, or as return"
                        "  F10     the menus: arrows and return choose")
                  *mouse-help*)))

;;; Layers.

(defun switch-layer (window layer)
  (let ((layers (window-layers window)))
    (setf (window-layers window)
          (if (member layer layers) (remove layer layers) (cons layer layers)))
    (repaint-if-changed (pane-named window 'world))))

(defun layer-text (layer)
  "Return what the panel calls LAYER, with the words for it in lines of the prompt."
  (let ((title (layer-title layer)) (words (layer-words layer)))
    (format nil "~A~:[   ~(~A~)~;~]" title (string-equal title words) words)))

(defun layer-rows (window)
  "Return the rows of the panel of layers. A window has a title, and the mouse is told what things
are, so there are none for these."
  (flet ((layer-row (layer)
           (make-row (layer-text layer)
                     :tick (lambda () (member layer (window-layers window)))
                     :action (lambda () (switch-layer window layer)) :stays-p t)))
    (append (mapcar #'layer-row (remove :legend (remove :title (picture-layers))))
            (list (make-row "In colour" :tick (lambda () (window-color-p window))
                                        :action (lambda () (switch-color window)) :stays-p t)))))

(defun switch-color (window)
  (setf (window-color-p window) (not (window-color-p window)))
  (repaint-all window))

;;; Robots.

(defun shown-robot (window)
  "Return the name of the robot whose details WINDOW shows."
  (watcher-robot (window-watcher window)))

(defun window-robots (window)
  (let ((snapshot (window-snapshot window)))
    (and snapshot (mapcar #'robot-image-name (snapshot-robots snapshot)))))

(defun robot-rows (window)
  "Return the rows of the menu of robots. The window shows the one that its prompt commands."
  (flet ((robot-row (name)
           (make-row (format nil "~A" name)
                     :tick (lambda () (same-name-p name (shown-robot window)))
                     :action (lambda ()
                               (give-line (window-conversation window)
                                          (format nil "robot ~(~A~)" name))))))
    (cons (make-row "Which robot?") (mapcar #'robot-row (window-robots window)))))
