;;;; following.lisp -- a window goes along when its user's prompt goes into another run, and back.

(in-package :ars-magna.clim)

;;; TRIAL and FORK lead the prompt into another run, and out again; REWIND and WORLD put another in
;;; the place of one. The window whose own prompt that is goes along; if none is, as when the user
;;; types at a terminal, those that show the run which is left. Such a run is headless, so that the
;;; pacer cannot ask it for a snapshot between ticks, nor need it have a journal that tells of
;;; changes: what lines have made of it is looked at here, before the next is read.

(defun goes-along-p (window old)
  "True if WINDOW goes along with the prompt of this thread, which has been in OLD."
  (let ((thread (conversation-thread (window-conversation window))))
    (if thread
        (eq thread (current-thread))
        (eq old (watcher-simulation (window-watcher window))))))

(defun robot-to-take-along (window new)
  "Return the name of the robot of NEW that WINDOW, which goes along there, is to show: the one that
its own prompt commands, or that it shows; else another. NIL if other windows show all of them."
  (let ((names (mapcar #'robot-name (simulation-robots new)))
        (own-p (eq window (own-window))))
    (find-if (lambda (name)
               (and (member name names) (not (shown-beside-p window name new))))
             (append (and own-p (list ars-magna.cli:*prompt-robot*))
                     (list (shown-robot window) ars-magna.cli:*prompt-robot*)
                     names))))

(defun take-along (window new)
  "Let WINDOW show NEW from now on, if there is a robot for it to show."
  (let ((name (robot-to-take-along window new)))
    (when name
      (note-shown window name)
      (watch-simulation (window-watcher window) new)
      (retitle window)
      (request-refresh window))))

(defun follow-prompt (session old new)
  "Let the windows that go along with SESSION, which was in the run OLD, show NEW, in which it is."
  (declare (ignore session))
  (when new
    (dolist (window (open-windows))
      (let ((watcher (window-watcher window)))
        (cond ((eq new (watcher-simulation watcher))
               (unless (live-p new) (publish watcher new)))
              ((and old (not (eq old new)) (goes-along-p window old))
               (take-along window new)))))))

(attend ars-magna.cli:*whereabouts-hooks* follow-prompt)

;;; A program that has broken asks how it goes on: what it stands in is shown as it stands.

;;; A plan of a live run breaks in a thread of its own, while ticks pass.

(defun show-as-it-stands ()
  "Let the windows on a run whose plans or ticks this thread is at work on show how that stands."
  (dolist (window (open-windows))
    (let* ((watcher (window-watcher window)) (simulation (watcher-simulation watcher)))
      (when simulation
        (when (look-as-it-stands (watcher-plans watcher))
          (funcall (watcher-news watcher)))
        (when (mine-p (timeline-custody (simulation-timeline simulation)))
          (publish watcher simulation))))))

(attend ars-magna.cli:*break-hooks* show-as-it-stands)
