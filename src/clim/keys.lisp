;;;; keys.lisp -- keys that do what the buttons do, while the displays, not the prompt, have them.

(in-package :ars-magna.clim)

;;; A click on a display gives it the keys; return or escape gives them back to the prompt.

(defun take-keys (pane)
  "Let what is typed go to PANE."
  (setf (clim:port-keyboard-input-focus (clim:port pane)) pane))

(defun give-keys-to-prompt (window)
  (type-into (pane-named window 'interactor)))

(define-constant +arrow-step+ 60 :documentation "How far an arrow moves the view, in pixels.")

(defun arrow (key-name)
  "Return how far the key called KEY-NAME moves the view, in pixels, or NIL if it does not."
  (case key-name
    (:left (values (- +arrow-step+) 0))
    (:right (values +arrow-step+ 0))
    (:up (values 0 (- +arrow-step+)))
    (:down (values 0 +arrow-step+))))

(defun do-key (window key-name character)
  "Do what the key called KEY-NAME, which types CHARACTER or NIL, does in WINDOW. True if anything."
  (let ((button (and character (find character *buttons* :key #'button-key))))
    (multiple-value-bind (dx dy) (arrow key-name)
      (cond (button (close-popup window) (do-command (button-command button)) t)
            (dx (move-view (pane-named window 'world) dx dy) t)
            ((member key-name '(:return :escape))
             (or (close-popup window) (give-keys-to-prompt window))
             t)))))

(defmethod clim:handle-event ((pane display-pane) (event clim:key-press-event))
  (do-key (window-of pane) (clim:keyboard-event-key-name event)
    (clim:keyboard-event-character event)))
