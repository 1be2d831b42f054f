;;;; opening.lisp -- opening and closing windows; this does not affect the simulator.

(in-package :ars-magna.clim)

;;; Kept until this Lisp ends. A new window gets the preferences of the window that was closed last,
;;; and the transcript and the plots of its robot's last window.

(defvar *last-window-lock* (make-lock "last window"))
(defvar *last-preferences* nil "The preferences of the last closed window, or NIL.")

(defstruct (window-state (:copier nil))
  "The state of a closed window for the next window of its robot. LINES are the lines of the
transcript, newest first. TYPED is the text of the input line, or NIL. LEFT-RUN-P is true if the
window has left a trial or fork. QUIET-P is true if its prompt hid messages from commands of plans.
PLOTTER is what it plotted, or NIL."
  (lines '() :type list :read-only t)
  (typed nil :type (or null string) :read-only t)
  (left-run-p nil :read-only t)
  (quiet-p nil :read-only t)
  (plotter nil :read-only t))

(defvar *window-states* '()
  "An alist from names of robots to the states of their last windows.")

(defun restore-window-state (window state)
  (let ((conversation (window-conversation window)) (transcript (window-transcript window)))
    (setf (ars-magna.cli:session-quiet-p (window-session window)) (window-state-quiet-p state))
    (when (window-state-plotter state)
      (ars-magna.cli:continue-plots (window-session window) (window-state-plotter state)
                                    (shown-robot-name window)))
    (set-initial-lines transcript (window-state-lines state))
    (when (window-state-left-run-p state)
      (write-to-transcript transcript
                           (format nil "From here on: ~A in ~A.~%" (shown-robot-label window)
                                   (ars-magna.cli:run-description (window-simulation window)))))
    (when (window-state-typed state) (pass-key conversation (window-state-typed state)))))

(defun save-settings (window)
  (let* ((session (window-session window))
         (state (make-window-state :lines (transcript-lines (window-transcript window))
                                   :typed (text-in-input-line (window-conversation window))
                                   :left-run-p (and (ars-magna.cli:in-trial-or-fork-p session) t)
                                   :quiet-p (ars-magna.cli:session-quiet-p session)
                                   :plotter (ars-magna.cli:leave-plots session))))
    (with-lock (*last-window-lock*)
      (setf *last-preferences* (window-preferences window))
      (dolist (name (window-robots-shown window))
        (setf *window-states* (acons name state (remove name *window-states* :key #'first)))))))

(defun restore-settings (window)
  "Give the new WINDOW the preferences of the last closed one, and the state saved for its robot."
  (destructuring-bind (preferences state)
      (with-lock (*last-window-lock*)
        (list *last-preferences* (rest (assoc (shown-robot-name window) *window-states*))))
    (when preferences
      (setf (window-preferences window) (copy-preferences preferences)
            (plan-look-view (watcher-plans (window-watcher window)))
            (preferences-plan-view preferences)))
    (if state
        (restore-window-state window state)
        (ars-magna.cli:show-definition-messages (window-session window)))))

;;;; Coming and going

;;; An error in a window's thread, even losing the X server, only closes the window, with a warning.

(defvar *windows* '() "The windows that are open.")
(defvar *windows-lock* (make-lock "windows"))
(defvar *ports* '() "CLIM's ports to X servers, whether or not a window could be opened there.")

(defun open-window-list ()
  (with-lock (*windows-lock*) (copy-list *windows*)))

(defun close-window (window)
  "Close WINDOW. The simulator continues. Any thread may call this. Return no values."
  (call-in-window #'clim:frame-exit window))

(defun raise-window (window)
  "Raise WINDOW above other windows, and show it if it is an icon."
  (let ((sheet (clim:frame-top-level-sheet window)))
    (climb:port-enable-sheet (clim:port sheet) sheet)
    (clim:raise-sheet sheet)))

;;; A window's life.

(defun remove-from-open-windows (window)
  (with-lock (*windows-lock*)
    (when (member window *windows*)
      (setf *windows* (remove window *windows*))
      t)))

(defun window-session (window)
  (conversation-session (window-conversation window)))

(defun end-lines-of-lost-prompt (window)
  "The prompt of WINDOW has been lost. End its running line, its waiting lines and its break. Return
a text about what was ended, to append to a sentence."
  (let* ((session (window-session window))
         (line (running-line (window-conversation window)))
         (place (and (ars-magna.cli:in-trial-or-fork-p session)
                     (ars-magna.cli:run-description (window-simulation window))))
         (lines (ars-magna.cli:take-waiting-lines (ars-magna.cli:session-input session))))
    (ars-magna.cli:abandon-session session)
    (format nil "~@[. Its prompt was in ~A and has left this run~]~
                 ~@[. The running line was ended: ~A~]~
                 ~@[. Waiting lines were not run: ~{~A~^; ~}~]~
                 ~:[~;. Its break waits for an answer at another prompt~]"
            place
            (and line (cut (one-line line) 200))
            (loop for line in lines repeat 10 collect (cut (one-line line) 200))
            (ars-magna.cli:answerable-by-others-p session))))

(defun run-to-notify (window)
  "Return the run to notify that WINDOW has closed: the run that WINDOW shows or, instead of a trial
or fork, the live run of the robot, if any."
  (let ((simulation (window-simulation window)))
    (if (ars-magna.cli:in-trial-or-fork-p (window-session window))
        (or (ars-magna.cli:live-run-of-robot (shown-robot-name window))
            (global-value '*simulation*)
            simulation)
        simulation)))

(defun closing-message (window condition)
  "Return the message that WINDOW has closed because of CONDITION, a condition or a text. The
message says whether the run continues, and how to open another window."
  (format nil "The window of ~A has closed: ~A~:[~;. The run continues; the ~
               line WINDOW opens another~]"
          (shown-robot-label window)
          (one-line (text-of-condition condition))
          (and (window-simulation window) (not (run-over-p window)))))

(defun warn-of-closing (window condition)
  "Report once that WINDOW has closed because of CONDITION, and what was lost."
  (when (remove-from-open-windows window)
    (let* ((simulation (run-to-notify window))
           (*message-queue* (if simulation (simulation-messages simulation) *message-queue*)))
      (warning-set (closing-message window condition) (end-lines-of-lost-prompt window)))))

;;; Which robot a window shows.

(defun record-shown-robot (window name)
  (setf (watcher-robot (window-watcher window)) name)
  (pushnew name (window-robots-shown window)))

(defun show-robot-called (window name simulation)
  (record-shown-robot window name)
  (unless (eq simulation (window-simulation window))
    (watch-simulation (window-watcher window) simulation)
    (setf (pane-fitting-p (pane-named window 'world)) t))
  (follow-plots-now window)
  (update-title window)
  (request-refresh window))

(defun window-shows-p (window name simulation)
  (and (eq name (watcher-robot (window-watcher window)))
       (eq simulation (window-simulation window))))

(defun shown-in-other-window-p (window name simulation)
  (some (lambda (other) (window-shows-p other name simulation))
        (remove window (open-window-list))))

(defun robot-to-show (window)
  "Return the name and the run of the robot that WINDOW shows next, because its run is over. It is
the robot that a prompt would command or, if another window shows this robot, another of the same
run. Return NIL if there is no such robot."
  (multiple-value-bind (simulation name)
      (ars-magna.cli:run-to-continue-in (window-simulation window)
                                        (watcher-robot (window-watcher window)))
    (when simulation
      (let ((names (mapcar #'robot-name (simulation-robots simulation))))
        (values (find-if-not (lambda (name) (shown-in-other-window-p window name simulation))
                             (cons name names))
                simulation)))))

(defun report-run-over (window reason)
  "Report once in WINDOW that its run is over because of REASON."
  (let ((over (window-simulation window)))
    (unless (eq over (shiftf (window-known-over window) over))
      (write-in-window window "The run of ~A is over: ~A. This window shows its end. Start another ~
                               run with the line WORLD, or with SIMULATOR in Lisp.~%"
                       (shown-robot-label window) reason))))

(defun leave-finished-run (window reason)
  "Make WINDOW, whose run is over because of REASON, show another run. Close WINDOW if other windows
show all robots of that run."
  (multiple-value-bind (name simulation) (robot-to-show window)
    (cond (name
           (show-robot-called window name simulation)
           (ars-magna.cli:announce-run (window-session window) simulation name))
          ;; There is a run to show, but other windows show all of its robots.
          ((ars-magna.cli:run-to-continue-in (window-simulation window) (shown-robot-name window))
           (warn-of-closing window (format nil "its run is over (~A)" reason))
           (close-window window))
          (t (report-run-over window reason)))))

(defun match-window-and-prompt (window)
  "Make WINDOW and its prompt agree on the robot. The prompt enters the run of WINDOW. If the user
has chosen another robot of the run, WINDOW shows that robot. Only the prompt's thread calls this."
  (when (window-simulation window)
    (let ((reason (simulation-over (window-simulation window))))
      (when reason (leave-finished-run window reason)))
    (let ((simulation (window-simulation window)) (watcher (window-watcher window)))
      (cond ((not (eq simulation *simulation*))
             (ars-magna.cli:make-run-current simulation)
             (setf ars-magna.cli:*prompt-robot* (watcher-robot watcher)))
            ((not (eq (watcher-robot watcher) ars-magna.cli:*prompt-robot*))
             (show-robot-called window ars-magna.cli:*prompt-robot* simulation)
             (write-in-window window "~A in ~A.~%" ars-magna.cli:*prompt-robot*
                              (simulation-name simulation)))))
    ;; A run that was rewound may have become live since the title was set.
    (update-title window)))

;;; When the X server goes, the thread that reads events, or a window's that paints, finds out.

(defun windows-on-port (port)
  (with-lock (*windows-lock*)
    (remove port *windows* :key #'clim:port :test-not #'eq)))

(defun close-lost-windows (port)
  "Close all windows on PORT, whose X server has gone, and report their closing."
  ;; None of them can answer for another.
  (dolist (window (windows-on-port port)) (ars-magna.cli:abandon-session (window-session window)))
  (dolist (window (windows-on-port port))
    (warn-of-closing window "the connection to the X server has ended")
    (close-window window)))

(defun run-window-loop (window)
  "Run the event loop of WINDOW until the window is closed or an error ends it."
  (let* ((simulation (window-simulation window))
         (*message-queue* (simulation-messages simulation)))
    (start-conversation (window-conversation window) simulation
                        (watcher-robot (window-watcher window)))
    (unwind-protect
         (handler-case (without-debugger
                         (handler-bind ((warning 'muffle-x-server-warning))
                           (clim:run-frame-top-level window)))
           ;; The X server has gone.
           ((or stream-error xlib:closed-display) () (close-lost-windows (clim:port window)))
           (error (condition) (warn-of-closing window condition))
           (:no-error (&rest values) (declare (ignore values)) (remove-from-open-windows window)))
      (warn-of-closing window "its thread was ended")
      (save-settings window)
      (ars-magna.cli:end-session (window-session window))
      (stop-watching (window-watcher window))
      ;; The X server may have gone.
      (ignore-errors
       (free-terrain-pixmap (pane-named window 'world))
       (mapc #'free-buffer (cons (window-popup window) (display-panes window)))
       (clim:disown-frame (clim:frame-manager window) window)))))

(defmethod clim:run-frame-top-level :before ((window robot-window) &key &allow-other-keys)
  (report-painted (window-watcher window)))

;;; Opening.

(defun open-new-window (robot)
  (check-layers 'open-display '*window-layers* *window-layers*)
  (let* ((port (window-port))
         (simulation (robot-simulation robot))
         (window nil)
         (watcher (make-watcher (robot-name robot)
                                (lambda () (when window (request-refresh window)))
                                (lambda (reason)
                                  (when window (leave-finished-run window reason))))))
    (start-watching watcher simulation)
    (setf window (make-robot-window
                  watcher :frame-manager (clim:find-frame-manager :port port)
                          :usual-magnification (multiple-value-call #'usual-magnification
                                                 (screen-resolution port)
                                                 (graft-size (clim:find-graft :port port)))))
    (restore-settings window)
    (when (anything-plotted-p window)
      (set-plots-folded window (section-folded-p window 'plots)))
    (with-lock (*windows-lock*) (push window *windows*))
    (setf (window-thread window)
          (start-thread (lambda () (run-window-loop window))
                        (format nil "display of ~A" (robot-name robot))))
    window))

(defun window-of-this-thread ()
  (find (current-thread) (open-window-list)
        :key (lambda (window) (conversation-thread (window-conversation window)))))

(defun switchable-windows ()
  "Return the open windows that this thread may switch to another run. The window of this thread
comes first. Other windows are left out while their prompts are in a trial or fork."
  (let ((own (window-of-this-thread)))
    (append (and own (list own))
            (remove-if (lambda (window)
                         (or (eq window own)
                             (ars-magna.cli:in-trial-or-fork-p (window-session window))))
                       (open-window-list)))))

(defun run-over-p (window)
  (let ((simulation (window-simulation window)))
    (and simulation (simulation-over simulation) t)))

(defun window-to-show-robot (robot)
  "Return the open window in which OPEN-WINDOW shows ROBOT, or NIL if a new window is needed."
  (let ((windows (switchable-windows)) (simulation (robot-simulation robot)))
    (or (find (robot-name robot) windows :key #'shown-robot-name)
        (and (not (live-p simulation))
             (find simulation windows :key #'window-simulation))
        (find-if #'run-over-p windows))))

(defun switch-to-robot (window robot)
  "Show ROBOT in WINDOW. The prompt of WINDOW reports the change, unless it runs in this thread."
  (let ((simulation (robot-simulation robot)) (name (robot-name robot)))
    (show-robot-called window name simulation)
    (unless (eq window (window-of-this-thread))
      (ars-magna.cli:announce-run (window-session window) simulation name))))

(defun open-window (robot)
  "Show ROBOT in a window; raise and return it. Use the first of: ROBOT's window, one of its trial
or fork, one of a finished run, a new one. Signals MISUSE if there is no X server."
  (let ((window (window-to-show-robot robot)))
    (cond ((null window) (open-new-window robot))
          (t (unless (window-shows-p window (robot-name robot) (robot-simulation robot))
               (switch-to-robot window robot))
             (call-in-window #'raise-window window)
             window))))

(defun join-window-threads ()
  (loop for window = (first (with-lock (*windows-lock*) *windows*))
        while window
        do (join-thread (window-thread window))))

(setf *display-opener* #'open-window
      *window-close-waiter* #'join-window-threads)

(defun cut-plots-of-closed-windows (old new)
  (dolist (state (with-lock (*last-window-lock*) (mapcar #'rest *window-states*)))
    (when (window-state-plotter state)
      (ars-magna.cli:cut-plotter (window-state-plotter state) old new))))

(add-listener *rewind-hooks* cut-plots-of-closed-windows)

(defun watch-rewound-run (old new)
  (dolist (window (open-window-list))
    (let ((watcher (window-watcher window)))
      (when (eq old (watcher-simulation watcher))
        (remove-observer (watcher-observer watcher) new)
        (watch-simulation watcher new)))))

(add-listener *rewind-hooks* watch-rewound-run)
