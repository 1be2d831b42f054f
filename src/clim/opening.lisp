;;;; opening.lisp -- windows come and go; the simulator does not notice.

(in-package :ars-magna.clim)

;;; Each window has a thread of its own. Whatever goes wrong in it, the loss of the X server
;;; included, closes the window with a warning, and nothing else.

(defvar *windows* '() "The windows that are open.")
(defvar *windows-lock* (make-lock "windows"))

(defun find-window (name)
  "Return the open window of the robot called NAME, or NIL."
  (with-lock (*windows-lock*)
    (find name *windows* :key (lambda (window) (watcher-robot (window-watcher window)))
                         :test #'same-name-p)))

(defun close-window (window)
  "Close WINDOW, from whatever thread. The simulator goes on. Return nothing."
  (let ((sheet (clim:frame-top-level-sheet window)))
    (when sheet
      (clim:queue-event sheet (make-instance 'close-event :sheet sheet))))
  (values))

(defclass close-event (clim:window-manager-event) ()
  (:documentation "The window is to be closed."))

(defmethod clim:handle-event ((sheet clime:top-level-sheet-mixin) (event close-event))
  (clim:frame-exit (clim:pane-frame sheet)))

;;; A window's life.

(defun forget-window (window)
  "Count WINDOW as closed; true if it was open."
  (with-lock (*windows-lock*)
    (when (member window *windows*)
      (setf *windows* (remove window *windows*))
      t)))

(defun warn-of-closing (window condition)
  "Say, once, that CONDITION has closed WINDOW."
  (when (forget-window window)
    (let ((*message-queue* (simulation-messages (window-simulation window))))
      (warning-set (format nil "The display of ~A has closed: ~A"
                           (watcher-robot (window-watcher window))
                           (substitute #\Space #\Newline
                                       (handler-case (princ-to-string condition)
                                         (error () (string (type-of condition))))))))))

;;; Which robot a window shows.

(defun show-robot-called (window name simulation)
  "Let WINDOW show the robot called NAME of SIMULATION from now on."
  (setf (watcher-robot (window-watcher window)) name)
  ;; Not all of CLIM's ports can do that.
  (ignore-errors (setf (clim:frame-pretty-name window) (window-title name)))
  (unless (eq simulation (window-simulation window))
    (watch-simulation (window-watcher window) simulation)
    (setf (pane-fitting-p (pane-named window 'world)) t)
    (ars-magna.cli:listen-instead (conversation-session (window-conversation window)) simulation))
  (say (window-transcript window)
       (format nil "~A in ~A.~%" name (simulation-name simulation)))
  (request-refresh window))

(defun agree-on-robot (window)
  "See to it that the prompt of WINDOW, in whose thread this is, commands the robot shown there; or
else, if its user has chosen another one of the same run, that that is shown."
  (let ((simulation (window-simulation window)) (watcher (window-watcher window)))
    (cond ((null simulation))
          ((not (eq simulation *simulation*))
           (ars-magna.cli:go-to-run simulation)
           (setf ars-magna.cli:*prompt-robot* (watcher-robot watcher)))
          ((not (eq (watcher-robot watcher) ars-magna.cli:*prompt-robot*))
           (show-robot-called window ars-magna.cli:*prompt-robot* simulation)))))

(defun run-of-robot (name)
  "Return the live run that the robot called NAME is in now, or NIL."
  (let* ((robot (find-robot name nil))
         (simulation (and robot (robot-simulation robot))))
    (and simulation (live-p simulation) (not (simulation-over simulation)) simulation)))

(defun leave-run (window reason)
  "Let WINDOW, which shows a run that is over for REASON, show the one in which its robot is now, or
close."
  (let ((simulation (run-of-robot (watcher-robot (window-watcher window)))))
    (cond (simulation
           (show-robot-called window (watcher-robot (window-watcher window)) simulation))
          (t (warn-of-closing window (format nil "its run is over, ~A" reason))
             (close-window window)))))

(defun discard (window)
  "Let the X server forget WINDOW, which has closed, and its pixmaps."
  (forget-pixmaps window)
  (clim:disown-frame (clim:frame-manager window) window))

(defun run-window (window)
  "Show WINDOW until it is closed, or something goes wrong."
  (let* ((simulation (window-simulation window))
         (*message-queue* (simulation-messages simulation)))
    (start-conversation (window-conversation window) simulation
                        (watcher-robot (window-watcher window)))
    (unwind-protect
         (handler-case (clim:run-frame-top-level window)
           (error (condition) (warn-of-closing window condition)))
      (forget-window window)
      (end-conversation (window-conversation window))
      (stop-watching (window-watcher window))
      ;; The X server may have gone.
      (ignore-errors (discard window)))))

(defmethod clim:run-frame-top-level :before ((window robot-window) &key &allow-other-keys)
  (painted (window-watcher window)))

;;; The X server may go. CLIM's thread that reads events from it must not take Lisp along.

(defun windows-on (port)
  (with-lock (*windows-lock*)
    (remove port *windows* :key #'clim:port :test-not #'eq)))

(defun lose-port (port condition)
  "Close the windows on PORT, whose X server has gone; end the thread that reads its events."
  (let ((windows (windows-on port)))
    (when windows
      (dolist (window windows)
        (warn-of-closing window condition)
        (close-window window))
      (ignore-errors (clim:destroy-port port))
      (abort))))

(defmethod clim:process-next-event :around ((port clim:basic-port) &key &allow-other-keys)
  ;; McCLIM warns of what the X server could not do at once, such as to give keys to a window that
  ;; is just being hidden. That is nobody's fault, and nothing for the terminal.
  (handler-bind ((error (lambda (condition) (lose-port port condition)))
                 (warning #'muffle-warning))
    (call-next-method)))

;;; Opening.

(defun x-server-named-p ()
  (or clim:*default-server-path*
      (let ((display (environment-value "DISPLAY")))
        (and display (string/= display "")))))

(defun window-port ()
  "Return CLIM's port to the X server. Signals MISUSE if there is none."
  (unless (x-server-named-p)
    (reject-use "No display: there is no X server; set the environment variable DISPLAY."))
  (handler-case (clim:find-port)
    (error (condition)
      (reject-use "No display: the X server ~A does not answer (~A)."
                  (environment-value "DISPLAY")
                  (substitute #\Space #\Newline (princ-to-string condition))))))

(defun open-new-window (robot)
  (let* ((port (window-port))
         (simulation (robot-simulation robot))
         (window nil)
         (watcher (make-watcher (robot-name robot)
                                (lambda () (when window (request-refresh window)))
                                (lambda (reason) (when window (leave-run window reason))))))
    (make-menu-bar)
    (start-watching watcher simulation)
    (setf window (make-robot-window watcher :frame-manager (clim:find-frame-manager :port port)))
    (with-lock (*windows-lock*) (push window *windows*))
    (setf (window-thread window)
          (start-thread (lambda () (run-window window))
                        (format nil "display of ~A" (robot-name robot))))
    window))

(defun open-windows ()
  (with-lock (*windows-lock*) (copy-list *windows*)))

(defun window-of-visit (robot)
  "Return the window that shows the run of ROBOT if that is a trial or a fork; or NIL."
  (let ((simulation (robot-simulation robot)))
    (unless (live-p simulation)
      (find simulation (open-windows)
            :key (lambda (window) (watcher-simulation (window-watcher window)))))))

(defun window-left ()
  "Return an open window whose run is over, or NIL."
  (find-if (lambda (window)
             (let ((simulation (window-simulation window)))
               (and simulation (simulation-over simulation))))
           (open-windows)))

(defun open-window (robot)
  "Show ROBOT in a window: in the one that it has, or that shows the trial or fork that it is in, in
one whose run is over, or else in a new one. Return the window. Signals MISUSE where there is no X
server."
  (let ((window (or (find-window (robot-name robot)) (window-of-visit robot) (window-left))))
    (cond ((null window) (open-new-window robot))
          ((and (eq (watcher-robot (window-watcher window)) (robot-name robot))
                (eq (window-simulation window) (robot-simulation robot)))
           window)
          (t (show-robot-called window (robot-name robot) (robot-simulation robot))
             window))))

(defun await-windows ()
  "Wait until no window is open."
  (loop for window = (first (with-lock (*windows-lock*) *windows*))
        while window
        do (join-thread (window-thread window))))

(setf *display-opener* #'open-window
      *displays-waiter* #'await-windows)

(defun watch-rewound (old new)
  "Let the windows that show OLD show NEW, which is to go on in its place."
  (dolist (window (open-windows))
    (let ((watcher (window-watcher window)))
      (when (eq old (watcher-simulation watcher))
        (remove-observer (watcher-observer watcher) new)
        (watch-simulation watcher new)))))

(pushnew 'watch-rewound *rewind-hooks*)
