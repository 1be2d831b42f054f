;;;; opening.lisp -- opening and closing windows; this does not affect the simulator.

(in-package :ars-magna.clim)

;;; Kept until this Lisp ends. A new window gets the preferences of the window that was closed last,
;;; and the transcript of its robot's last window.

(defvar *last-settings-lock* (make-lock "settings"))
(defvar *last-settings* '()
  "A list of layers, colour or not, and preferences of the window that was closed last; or NIL.")

(defstruct (legacy (:copier nil))
  "What a window leaves to the next window of its robot: its LINES, newest first; what had been
TYPED, or NIL; LEFT-RUN-P if it was in a trial or fork, which it has left; QUIET-P if its prompt hid
messages from commands of plans."
  (lines '() :type list :read-only t)
  (typed nil :type (or null string) :read-only t)
  (left-run-p nil :read-only t)
  (quiet-p nil :read-only t))

(defvar *legacies* '()
  "An alist from robots' names to what their last windows have left.")

(defun take-legacy (window legacy)
  (let ((conversation (window-conversation window)) (transcript (window-transcript window)))
    (setf (ars-magna.cli:session-quiet-p (window-session window)) (legacy-quiet-p legacy))
    (go-on-from transcript (legacy-lines legacy))
    (when (legacy-left-run-p legacy)
      (say transcript (format nil "From here on: ~A in ~A.~%" (shown-robot window)
                              (ars-magna.cli:words-for-run (window-simulation window)))))
    (when (legacy-typed legacy) (give-key conversation (legacy-typed legacy)))))

(defun keep-settings (window)
  (let* ((settings (list (window-layers window) (window-color-p window)
                         (window-preferences window)))
         (session (window-session window))
         (legacy (make-legacy :lines (transcript-lines (window-transcript window))
                              :typed (being-typed (window-conversation window))
                              :left-run-p (and (ars-magna.cli:in-trial-or-fork-p session) t)
                              :quiet-p (ars-magna.cli:session-quiet-p session))))
    (with-lock (*last-settings-lock*)
      (setf *last-settings* settings)
      (dolist (name (window-robots-shown window))
        (setf *legacies* (acons name legacy (remove name *legacies* :key #'first)))))))

(defun take-settings (window)
  "Apply the settings of earlier windows to WINDOW, which is new, and continue their transcript."
  (destructuring-bind (settings legacy)
      (with-lock (*last-settings-lock*)
        (list *last-settings* (rest (assoc (shown-robot window) *legacies*))))
    (when settings
      (destructuring-bind (layers color-p preferences) settings
        (setf (window-layers window) layers
              (window-color-p window) color-p
              (window-preferences window) (copy-preferences preferences))))
    (if legacy
        (take-legacy window legacy)
        (ars-magna.cli:tell-first-messages (window-session window)))))

;;;; Coming and going

;;; Each window has a thread. Any error in it, such as the loss of the X server, closes only this
;;; window, with a warning.

(defvar *windows* '() "The windows that are open.")
(defvar *windows-lock* (make-lock "windows"))
(defvar *ports* '() "CLIM's ports on which windows were opened.")

(defun open-windows ()
  (with-lock (*windows-lock*) (copy-list *windows*)))

(defun close-window (window)
  "Close WINDOW, from any thread. The simulator continues. Return nothing."
  (call-in-window #'clim:frame-exit window))

(defun show-in-front (window)
  "Show WINDOW in front of others, and not as an icon."
  (let ((sheet (clim:frame-top-level-sheet window)))
    (climb:port-enable-sheet (clim:port sheet) sheet)
    (clim:raise-sheet sheet)))

;;; A window's life.

(defun forget-window (window)
  "Count WINDOW as closed; true if it was open."
  (with-lock (*windows-lock*)
    (when (member window *windows*)
      (setf *windows* (remove window *windows*))
      t)))

(defun window-session (window)
  (conversation-session (window-conversation window)))

(defun clear-lost-prompt (window)
  "Clear the prompt of WINDOW, which is lost: the running line, waiting lines, a break. Return in
words what was cleared, to follow a sentence."
  (let* ((session (window-session window))
         (line (busy-with (window-conversation window)))
         (place (and (ars-magna.cli:in-trial-or-fork-p session)
                     (ars-magna.cli:words-for-run (window-simulation window))))
         (lines (ars-magna.cli:take-waiting (ars-magna.cli:session-input session))))
    (ars-magna.cli:abandon-session session)
    (format nil "~@[. Its prompt was in ~A, which has been left~]~
                 ~@[. The line under way there was ended: ~A~]~
                 ~@[. These waited there and were not done: ~{~A~^; ~}~]~
                 ~:[~;. The break there waits for an answer at another prompt~]"
            place
            (and line (cut (one-line line) 200))
            (loop for line in lines repeat 10 collect (cut (one-line line) 200))
            (ars-magna.cli:asked-of-others-p session))))

(defun run-to-tell (window)
  "Return the run whose messages report that WINDOW has closed: the run that it shows, or, for a
trial or fork, which is no longer shown, the run outside."
  (let ((simulation (window-simulation window)))
    (if (ars-magna.cli:in-trial-or-fork-p (window-session window))
        (or (ars-magna.cli:run-of-robot (shown-robot window))
            (global-value '*simulation*)
            simulation)
        simulation)))

(defun words-for-closing (window condition)
  "Return the message that CONDITION, or a reason in words, has closed WINDOW: whether the run
continues, and how to see it again."
  (format nil "The window of ~A has closed: ~A~:[~;. The run continues; the ~
               line WINDOW opens another~]"
          (shown-robot window)
          (one-line (text-of-condition condition))
          (and (window-simulation window) (not (over-p window)))))

(defun warn-of-closing (window condition)
  "Report, once, that CONDITION has closed WINDOW, and what was lost with it."
  (when (forget-window window)
    (let* ((simulation (run-to-tell window))
           (*message-queue* (if simulation (simulation-messages simulation) *message-queue*)))
      (warning-set (words-for-closing window condition) (clear-lost-prompt window)))))

;;; Which robot a window shows.

(defun note-shown (window name)
  (setf (watcher-robot (window-watcher window)) name)
  (pushnew name (window-robots-shown window)))

(defun show-robot-called (window name simulation)
  (note-shown window name)
  (unless (eq simulation (window-simulation window))
    (watch-simulation (window-watcher window) simulation)
    (setf (pane-fitting-p (pane-named window 'world)) t))
  (retitle window)
  (request-refresh window))

(defun shows-p (window name simulation)
  (and (eq name (watcher-robot (window-watcher window)))
       (eq simulation (window-simulation window))))

(defun shown-beside-p (window name simulation)
  "True if another window than WINDOW shows the robot called NAME of SIMULATION."
  (some (lambda (other) (shows-p other name simulation))
        (remove window (open-windows))))

(defun robot-to-show (window)
  "Return the name of a robot to show in WINDOW, whose run is over, and its run: the robot of a
prompt in that case, or another of the same run if another window shows that one; or NIL."
  (multiple-value-bind (simulation name)
      (ars-magna.cli:run-after (window-simulation window) (watcher-robot (window-watcher window)))
    (when simulation
      (let ((names (mapcar #'robot-name (simulation-robots simulation))))
        (values (find-if-not (lambda (name) (shown-beside-p window name simulation))
                             (cons name names))
                simulation)))))

(defun stay-when-over (window reason)
  "Report in WINDOW, once, that the run that it still shows is over for REASON."
  (let ((over (window-simulation window)))
    (unless (eq over (shiftf (window-known-over window) over))
      (say-in-window window "The run of ~A is over: ~A. This window shows how it ended, until ~
                             WORLD, or SIMULATOR in Lisp, starts another.~%"
                     (shown-robot window) reason))))

(defun leave-run (window reason)
  "Make WINDOW, whose run is over for REASON, show another; close it if other windows show all."
  (multiple-value-bind (name simulation) (robot-to-show window)
    (cond (name
           (show-robot-called window name simulation)
           (ars-magna.cli:tell-of-run (window-session window) simulation name))
          ;; There is a run to show, but other windows show all of its robots.
          ((ars-magna.cli:run-after (window-simulation window) (shown-robot window))
           (warn-of-closing window (format nil "its run is over, ~A" reason))
           (close-window window))
          (t (stay-when-over window reason)))))

(defun match-robot (window)
  "Make the prompt of WINDOW, whose thread this is, command the robot shown there; or, if its user
has chosen another one of the same run, show that one."
  (when (window-simulation window)
    (let ((reason (simulation-over (window-simulation window))))
      (when reason (leave-run window reason)))
    (let ((simulation (window-simulation window)) (watcher (window-watcher window)))
      (cond ((not (eq simulation *simulation*))
             (ars-magna.cli:go-to-run simulation)
             (setf ars-magna.cli:*prompt-robot* (watcher-robot watcher)))
            ((not (eq (watcher-robot watcher) ars-magna.cli:*prompt-robot*))
             (show-robot-called window ars-magna.cli:*prompt-robot* simulation)
             (say-in-window window "~A in ~A.~%" ars-magna.cli:*prompt-robot*
                            (simulation-name simulation)))))))

;;; When the X server goes, the thread that reads the events finds out, or a window's thread that
;;; paints at the time.

(defun windows-on (port)
  (with-lock (*windows-lock*)
    (remove port *windows* :key #'clim:port :test-not #'eq)))

(defun lose-windows (port)
  "Close all windows on PORT, whose X server has gone, and report that."
  ;; None of them can answer for another.
  (dolist (window (windows-on port)) (ars-magna.cli:abandon-session (window-session window)))
  (dolist (window (windows-on port))
    (warn-of-closing window "the X server has gone")
    (close-window window)))

(defun run-window (window)
  "Show WINDOW until it is closed, or an error ends it."
  (let* ((simulation (window-simulation window))
         (*message-queue* (simulation-messages simulation)))
    (start-conversation (window-conversation window) simulation
                        (watcher-robot (window-watcher window)))
    (unwind-protect
         (handler-case (without-debugger
                         (handler-bind ((warning 'muffle-servers-warning))
                           (clim:run-frame-top-level window)))
           ;; The X server has gone.
           ((or stream-error xlib:closed-display) () (lose-windows (clim:port window)))
           (error (condition) (warn-of-closing window condition))
           (:no-error (&rest values) (declare (ignore values)) (forget-window window)))
      (warn-of-closing window "its thread was ended")
      (keep-settings window)
      (ars-magna.cli:end-session (window-session window))
      (stop-watching (window-watcher window))
      ;; The X server may have gone.
      (ignore-errors
       (forget-terrain (pane-named window 'world))
       (mapc #'forget-buffer (cons (window-popup window) (display-panes window)))
       (clim:disown-frame (clim:frame-manager window) window)))))

(defmethod clim:run-frame-top-level :before ((window robot-window) &key &allow-other-keys)
  (painted (window-watcher window)))

;;; Opening.

(defun open-new-window (robot)
  (let* ((port (window-port))
         (simulation (robot-simulation robot))
         (window nil)
         (watcher (make-watcher (robot-name robot)
                                (lambda () (when window (request-refresh window)))
                                (lambda (reason) (when window (leave-run window reason))))))
    (with-lock (*windows-lock*) (pushnew port *ports*))
    (start-watching watcher simulation)
    (setf window (make-robot-window
                  watcher :frame-manager (clim:find-frame-manager :port port)
                          :usual-magnification (multiple-value-call #'usual-magnification
                                                 (screen-resolution port)
                                                 (graft-size (clim:find-graft :port port)))))
    (take-settings window)
    (with-lock (*windows-lock*) (push window *windows*))
    (setf (window-thread window)
          (start-thread (lambda () (run-window window))
                        (format nil "display of ~A" (robot-name robot))))
    window))

(defun own-window ()
  (find (current-thread) (open-windows)
        :key (lambda (window) (conversation-thread (window-conversation window)))))

(defun switchable-windows ()
  "Return the open windows that this thread may switch to another run, its own first; no other
windows whose prompts are in a trial or fork."
  (let ((own (own-window)))
    (append (and own (list own))
            (remove-if (lambda (window)
                         (or (eq window own)
                             (ars-magna.cli:in-trial-or-fork-p (window-session window))))
                       (open-windows)))))

(defun over-p (window)
  (let ((simulation (window-simulation window)))
    (and simulation (simulation-over simulation) t)))

(defun window-for (robot)
  "Return the open window that is to show ROBOT, as OPEN-WINDOW says, or NIL."
  (let ((windows (switchable-windows)) (simulation (robot-simulation robot)))
    (or (find (robot-name robot) windows :key #'shown-robot)
        (and (not (live-p simulation))
             (find simulation windows :key #'window-simulation))
        (find-if #'over-p windows))))

(defun switch-to-robot (window robot)
  "Show ROBOT in WINDOW; its prompt says so unless it was the one that asked."
  (let ((simulation (robot-simulation robot)) (name (robot-name robot)))
    (show-robot-called window name simulation)
    (unless (eq window (own-window))
      (ars-magna.cli:tell-of-run (window-session window) simulation name))))

(defun open-window (robot)
  "Show ROBOT in a window: its own, one that shows its trial or fork, one whose run is over, or
else a new one. It comes to the front. Return the window. Signals MISUSE if there is no X server."
  (let ((window (window-for robot)))
    (cond ((null window) (open-new-window robot))
          (t (unless (shows-p window (robot-name robot) (robot-simulation robot))
               (switch-to-robot window robot))
             (call-in-window #'show-in-front window)
             window))))

(defun await-windows ()
  (loop for window = (first (with-lock (*windows-lock*) *windows*))
        while window
        do (join-thread (window-thread window))))

(setf *display-opener* #'open-window
      *displays-waiter* #'await-windows)

(defun watch-rewound (old new)
  (dolist (window (open-windows))
    (let ((watcher (window-watcher window)))
      (when (eq old (watcher-simulation watcher))
        (remove-observer (watcher-observer watcher) new)
        (watch-simulation watcher new)))))

(attend *rewind-hooks* watch-rewound)
