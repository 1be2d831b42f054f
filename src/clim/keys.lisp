;;;; keys.lisp -- keys that do what the buttons do, while the displays, not the prompt, have them.

(in-package :ars-magna.clim)

;;; A click on the world or the details gives them the keys; return, escape, a click on the
;;; transcript, or a character that is none of theirs gives them back to the prompt. A line that is
;;; half typed gets all characters.

(defun give-keys-to-prompt (window)
  (type-into (pane-named window 'interactor)))

(defun take-keys (pane)
  "PANE was clicked: let what is typed go where it should from now on."
  (typecase pane
    ((or world-pane detail-pane plan-pane)
     (setf (window-typing-p (window-of pane)) nil)
     (focus-on pane))
    (transcript-pane (give-keys-to-prompt (window-of pane)))))

(defun type-at-prompt (window character)
  "Let CHARACTER, and what is typed after it, go to the line of WINDOW that is typed."
  ;; What is typed fast may still come to a display.
  (setf (window-typing-p window) t)
  (take-key window (string character))
  (give-keys-to-prompt window))

(defun half-typed-p (window)
  (let ((shown (line-shown (window-conversation window))))
    (and shown (string/= "" (second shown)))))

(defconstant +arrow-step+ 60 "How far an arrow moves the view, in pixels.")

(defun arrow (key-name)
  "Return how far the key called KEY-NAME moves the view, in pixels, or NIL if it does not."
  (case key-name
    (:left (values (- +arrow-step+) 0))
    (:right (values +arrow-step+ 0))
    (:up (values 0 (- +arrow-step+)))
    (:down (values 0 +arrow-step+))))

(defun press-button (window button)
  "Do what BUTTON does; if it has opened the panel that is on top of WINDOW, close that."
  (unless (eq (button-command button) (close-popup window))
    (funcall (button-command button))))

(defun do-key (window key-name character)
  "Do what the key called KEY-NAME, which types CHARACTER or NIL, does in WINDOW. True if anything."
  (let ((button (and character (find character *buttons* :key #'button-key))))
    (multiple-value-bind (dx dy) (arrow key-name)
      (cond ((press-in-popup window key-name) t)
            ((eq key-name :f10) (open-first-menu window) t)
            ((and (or (window-typing-p window) (half-typed-p window))
                  character
                  (graphic-char-p character))
             (type-at-prompt window character)
             t)
            (button (press-button window button) t)
            (dx (move-view (pane-named window 'world) dx dy) t)
            ((member key-name '(:return :escape))
             (or (close-popup window) (give-keys-to-prompt window))
             t)
            ((and character (graphic-char-p character))
             (type-at-prompt window character)
             t)))))

(defun modified-p (event)
  (or (pressed-with-p event clim:+control-key+) (pressed-with-p event clim:+meta-key+)))

(defmethod clim:handle-event ((pane display-pane) (event clim:key-press-event))
  (let ((window (window-of pane)))
    (with-guarded-command (window "That key")
      (if (or (typep pane 'interactor-pane) (modified-p event))
          (press-in-window window event)
          (do-key window (clim:keyboard-event-key-name event)
            (clim:keyboard-event-character event))))))
