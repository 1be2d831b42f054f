;;;; recording.lisp -- films of the run: the entry of the menu, and the words in the status strip.

(in-package :ars-magna.clim)

;;; The prompt of the window records the film (cli/prompt/recordings.lisp), as the line RECORD does.

(defun layer-words (layers)
  "Return the words after RECORD on that choose LAYERS: the layers that are not shown by default, or
all of them after the word BARE."
  (let ((added (set-difference layers *picture-layers*)))
    (format nil "~:[ bare~;~]~(~{ ~A~}~)"
            (subsetp *picture-layers* layers)
            ;; In the order of the panel of layers.
            (remove-if-not (lambda (layer)
                             (member layer (if (subsetp *picture-layers* layers) added layers)))
                           (picture-layers)))))

(defun recording-line (window)
  "Return the prompt line that begins a film of what WINDOW shows, or ends the film."
  (if (ars-magna.cli:recording-film-p (window-session window))
      "record off"
      ;; The window shows titles and legends in other ways, but a film needs them.
      (format nil "record on~A" (layer-words (union '(:title :legend) (window-layers window))))))

(defun recording-title (window)
  (if (ars-magna.cli:recording-film-p (window-session window))
      "Stop the film and save it"
      "Record a film"))

(define-window-command (com-record "Record a film") (window)
  (run-line-at-prompt (window-conversation window) (recording-line window)))
