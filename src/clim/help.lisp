;;;; help.lisp -- the panels that tell what keys and mouse do, and let layers be chosen.

(in-package :ars-magna.clim)

(defparameter *mouse-help*
  '("Mouse" "  hover               the strip below tells what is there"
    "  click               pick it; it is described below"
    "  right button        what can be done with it"
    "  drag the map        move the view; the wheel zooms"
    "  drag a thing        while time stands still: put it elsewhere"
    "  titles, splitters   fold displays, make them larger"
    "  designators         where they do not fit: left scrolls down, right up, middle offers")
  "What the help panel says of the mouse.")

(defun key-help ()
  "Return what the help panel says of keys, line by line."
  (append (list "Keys, after a click on a display")
          (loop for button in *buttons*
                collect (format nil "  ~7A ~A" (key-text (button-key button))
                                (button-help button)))
          (list "  arrows  move the view" "  return  back to the line that is typed"
                "  escape  close such a panel, or as return"
                "  F10     the menus: arrows and return choose")))

(defun help-rows ()
  (mapcar #'make-row (append (key-help) (list "") *mouse-help*)))

;;; Layers.

(defun layers-for-windows ()
  "Return the layers that a window can show. It has a title, and the mouse is told what things are."
  (remove :legend (remove :title (picture-layers))))

(defun switch-layer (window layer)
  "Show LAYER in WINDOW, or no longer."
  (let ((layers (window-layers window)))
    (setf (window-layers window)
          (if (member layer layers) (remove layer layers) (cons layer layers)))
    (repaint-if-changed (pane-named window 'world))))

(defun layer-text (layer)
  "Return what the panel calls LAYER, with the words for it in lines of the prompt."
  (let ((title (layer-title layer)) (words (layer-words layer)))
    (format nil "~A~:[   ~(~A~)~;~]" title (string-equal title words) words)))

(defun layer-row (window layer)
  (make-row (layer-text layer)
            :tick-p t :stays-p t
            :tick (lambda () (member layer (window-layers window)))
            :action (lambda () (switch-layer window layer))))

(defun layer-rows (window)
  "Return the rows of the panel of layers."
  (append (loop for layer in (layers-for-windows) collect (layer-row window layer))
          (list (make-row "In colour" :tick-p t :stays-p t
                                      :tick (lambda () (window-color-p window))
                                      :action (lambda () (switch-color window))))))

(defun switch-color (window)
  (setf (window-color-p window) (not (window-color-p window)))
  (repaint-all window))
