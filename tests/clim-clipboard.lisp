;;;; clim-clipboard.lisp -- text copied between programs arrives whole, however long it is.

(in-package :ars-magna.tests)

(in-suite clim)

(defun lines-of-length (length)
  "Return a text of about so many characters, in lines."
  (format nil "~{~A~^~%~}"
          (loop for number below (floor length 100)
                collect (format nil "line ~5,'0D für uns ~80,,,'.A" number ""))))

(defun held-in (window)
  "Return what the clipboard of the X server of WINDOW holds, as another program gets it."
  (window::fetch-text (clim:port window) :clipboard))

(defun hold-for (window text)
  "Let another program than WINDOW have copied TEXT."
  (window::offer-text (clim:port window) text '(:clipboard)))

(test clipboard.a-long-text-is-pasted-whole
  "20,000 characters, and more than X hands over at once."
  (in-x-window (window robot)
    (dolist (length '(20000 300000))
      (let ((text (lines-of-length length)))
        (hold-for window text)
        (is (equal text (held-in window)))
        (inside (window) (window::paste-text window :clipboard))
        (is (mentions-p (said-or-typed window) "line 00199 für uns"))
        (window::pass-key (window::window-conversation window) :control-c)))))

(defun said-or-typed (window)
  "Return what is being typed in WINDOW, once something is."
  (loop for shown = (window::shown-input-line (window::window-conversation window))
        until (and shown (string/= "" (second shown)))
        do (base:wait-on-semaphore *never-comes* 0.01)
        finally (return (second shown))))

(test clipboard.what-is-too-long-is-refused-with-what-to-do
  (in-x-window (window robot)
    (hold-for window (make-string (1+ window::+longest-paste+) :initial-element #\x))
    (inside (window)
      (window::with-guarded-command (window "Pasting") (window::paste-text window :clipboard)))
    (is (mentions-p (said-in window) "The text is too long to be pasted. Save the text in a file"))
    (hold-for window "status")
    (is (equal "status" (held-in window)))))

(test clipboard.a-long-transcript-can-be-copied
  (in-x-window (window robot)
    (let ((text (lines-of-length 100000)))
      (window::write-to-transcript (window::window-transcript window) text)
      (inside (window) (window::copy-text window))
      (is (mentions-p (held-in window) text)))))

(test clipboard.another-program-may-copy-something-else
  (in-x-window (window robot)
    (let ((thread (hold-for window "one")))
      (hold-for window "two")
      (base:join-thread thread)
      (is (equal "two" (held-in window))))))
