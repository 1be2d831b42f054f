;;;; following.lisp -- windows follow their prompt into another run, and back.

(in-package :ars-magna.clim)

;;; TRIAL and FORK lead the prompt into another run and out again; REWIND and WORLD replace a run by
;;; another. The window of that prompt follows. If the prompt has no window, because it is the
;;; terminal's, the windows that show the old run follow. The new run is headless, so the pacer
;;; cannot ask it for a snapshot between ticks, and it may have no journal that records changes. So
;;; the window looks at the effects of each line before the next is read.

(defun follows-prompt-p (window old)
  "True if WINDOW must follow this thread's prompt, which has left the run OLD for another run."
  (let ((thread (conversation-thread (window-conversation window))))
    (if thread
        (eq thread (current-thread))
        (eq old (watcher-simulation (window-watcher window))))))

(defun robot-name-after-switch (window new)
  "Return the name of the robot that WINDOW will show in the run NEW. First choice is the robot that
the prompt of WINDOW commands, then one with the same name as before, then any other. Return NIL if
other windows show all robots of NEW."
  (let ((names (mapcar #'robot-name (simulation-robots new)))
        (own-p (eq window (window-of-this-thread))))
    (find-if (lambda (name)
               (and (member name names) (not (shown-in-other-window-p window name new))))
             (append (and own-p (list ars-magna.cli:*prompt-robot*))
                     (list (shown-robot-name window) ars-magna.cli:*prompt-robot*)
                     names))))

(defun switch-window-to-run (window new)
  "Make WINDOW show the run NEW from now on, if NEW has a robot that no other window shows."
  (let ((name (robot-name-after-switch window new)))
    (when name
      (record-shown-robot window name)
      (watch-simulation (window-watcher window) new)
      (update-title window)
      (request-refresh window))))

(defun follow-prompt (session old new)
  "Make the windows that follow the prompt show the run NEW, which the prompt has entered from OLD."
  (declare (ignore session))
  (when new
    (dolist (window (open-window-list))
      (let ((watcher (window-watcher window)))
        (cond ((eq new (watcher-simulation watcher))
               (unless (live-p new) (publish-snapshot watcher new)))
              ((and old (not (eq old new)) (follows-prompt-p window old))
               (switch-window-to-run window new)))))))

(add-listener ars-magna.cli:*before-line-hooks* follow-prompt)

;;; A program that has broken asks how to continue: the window shows the state in which it broke.

;;; A plan of a live run breaks in a separate thread, while ticks pass.

(defun update-windows-of-this-thread ()
  "Update the windows that show the run whose plans or ticks this thread executes."
  (dolist (window (open-window-list))
    (let* ((watcher (window-watcher window)) (simulation (watcher-simulation watcher)))
      (when simulation
        (when (update-look-of-own-plans (watcher-plans watcher))
          (funcall (watcher-news watcher)))
        (when (has-custody-p (timeline-custody (simulation-timeline simulation)))
          (publish-snapshot watcher simulation))))))

(add-listener ars-magna.cli:*break-hooks* update-windows-of-this-thread)
