;;;; window.lisp -- the window: its parts, where they are, and how they are updated.

(in-package :ars-magna.clim)

;;; A new snapshot, or a new line of the transcript, queues one event, however many come before it
;;; is handled. Handling it paints the panes that have changed, as one picture. Everything in the
;;; window happens in its own thread.

(defparameter *window-parts*
  `((world world-pane) (state detail-pane :display :state)
    (designators designators-pane :display :designators) (cameras detail-pane :display :cameras)
    (hands detail-pane :display :hands) (bins detail-pane :display :bins) (plots plot-pane)
    (plan plan-pane) (parameters parameter-pane)
    (transcript transcript-pane) (interactor interactor-pane) (strip strip-pane) (bar bar-pane)
    (menus menu-pane)
    ,@(loop for section in +titled+
            collect (list (title-pane-name section) 'title-pane :section section))
    ,@(loop for name in +splitters+ collect (list name 'splitter-pane)))
  "Lists (name class option...): the parts of a window except its popup, in the order of painting.")

(defun make-window-parts ()
  (loop for (name class . options) in *window-parts*
        collect (apply #'clim:make-pane class :name name options)))

(defstruct (painting (:copier nil))
  "The progress of painting a window. QUEUED-P is true while an event that requests painting is
queued. ERASED-P is true if all must be painted, changed or not. SNAPSHOT was painted last."
  (queued-p nil)
  (erased-p nil)
  (snapshot nil))

(clim:define-application-frame robot-window ()
  ((watcher :initarg :watcher :accessor window-watcher)
   ;; How many screen pixels wide one of its pixels is, unless its user chooses.
   (usual-magnification :initarg :usual-magnification :initform 1
                        :reader window-usual-magnification)
   ;; The user's preferences for the arrangement.
   (preferences :initform (make-preferences) :accessor window-preferences)
   (conversation :initform nil :accessor window-conversation)
   ;; The names of the robots that it has shown.
   (robots-shown :initform '() :accessor window-robots-shown)
   ;; The run that is over, if this has been reported.
   (known-over :initform nil :accessor window-known-over)
   ;; For how many columns and rows its transcript has room.
   (text-size :initform '(80 24) :accessor window-text-size)
   (pointer :initform (make-pointer) :reader window-pointer)
   ;; The pane that has the keys while the window has the focus, or NIL before there is one.
   (focus :initform nil :accessor window-focus)
   ;; True if a line was begun by a key that came to a display.
   (typing-p :initform nil :accessor window-typing-p)
   ;; The parts found so far, by name.
   (panes-found :initform (make-hash-table :test 'eq) :reader window-panes)
   (painting :initform (make-painting) :reader window-painting)
   (thread :initform nil :accessor window-thread))
  (:menu-bar nil)
  (:panes
   (popup (clim:make-pane 'popup-pane :name 'popup :enabled-p nil)))
  (:layouts
   (default (clim:make-pane 'layout-pane :name 'layout :contents (cons popup (make-window-parts)))))
  (:documentation "A window that shows the displays of a robot and has a prompt."))

(defun window-title (robot-label &optional place)
  (format nil "ARS MAGNA: ~A~@[, ~A~]" robot-label place))

(defun title-now (window)
  (let ((simulation (window-simulation window)))
    (window-title (shown-robot-label window)
                  (and (not (live-p simulation))
                       (not (simulation-over simulation))
                       (ars-magna.cli:run-description simulation)))))

(defun update-title (window)
  ;; Not all of CLIM's ports can do that.
  (ignore-errors
   (let ((title (title-now window)))
     (unless (equal title (clim:frame-pretty-name window))
       (setf (clim:frame-pretty-name window) title)))))

(defun make-robot-window (watcher &rest options)
  "Return a new window, not yet visible, for the robot of WATCHER. OPTIONS are CLIM's options for
frames, and :usual-magnification."
  (let ((window (apply #'clim:make-application-frame 'robot-window
                       :pretty-name (window-title (ars-magna.cli:label-in-run
                                                   (watcher-robot watcher)
                                                   (watcher-simulation watcher)))
                       :watcher watcher options)))
    (setf (window-conversation window)
          (make-window-conversation (make-transcript (lambda () (request-refresh window)))
                                    (lambda () (values-list (window-text-size window)))
                                    (lambda () (match-window-and-prompt window))
                                    (lambda () (close-window window))))
    (push (watcher-robot watcher) (window-robots-shown window))
    (write-in-window window "Type a command below and press Return, or choose a command from a ~
                             menu. HELP lists all commands.~%")
    window))

(defun window-transcript (window)
  (console-transcript (conversation-console (window-conversation window))))

(defun window-layers (window) (preferences-layers (window-preferences window)))
(defun window-color-p (window) (preferences-color-p (window-preferences window)))
(defun window-hint (window) (pointer-hint (window-pointer window)))
(defun window-selection (window) (pointer-selection (window-pointer window)))

(defun window-snapshot (window)
  (watcher-snapshot (window-watcher window)))

(defun window-robot (window)
  (let ((snapshot (window-snapshot window)))
    (and snapshot (snapshot-robot snapshot (shown-robot-name window)))))

(defun shown-robot-p (window image)
  "True if IMAGE, from any snapshot, is an image of the robot whose details WINDOW shows."
  (let ((shown (window-robot window)))
    (and shown (eq (robot-image-name image) (robot-image-name shown)))))

(defun window-simulation (window)
  (watcher-simulation (window-watcher window)))

(defun display-panes (window)
  (loop for (name) in *window-parts*
        for pane = (pane-named window name)
        when pane collect pane))

(defun repaint-all (window)
  (mapc #'repaint (display-panes window)))

;;; Keeping up to date.

(defclass call-event (clim:window-manager-event)
  ((function :initarg :function :reader function-to-call))
  (:documentation "An event with a FUNCTION that the thread of the window calls with the window."))

(defmethod clim:handle-event ((sheet clime:top-level-sheet-mixin) (event call-event))
  (funcall (function-to-call event) (clim:pane-frame sheet)))

(defun call-in-window (function window)
  "Make the thread of WINDOW call FUNCTION with WINDOW, if it is open. Any thread may call this."
  (let ((sheet (clim:frame-top-level-sheet window)))
    (when sheet
      (clim:queue-event sheet (make-instance 'call-event :sheet sheet :function function)))
    (values)))

(defun request-refresh (window)
  "Request that WINDOW be refreshed soon. Any thread may call this."
  (when (and (clim:frame-top-level-sheet window)
             (swap-if-eq (painting-queued-p (window-painting window)) nil t))
    (call-in-window #'refresh-as-requested window)))

(defun refresh-as-requested (window)
  (setf (painting-queued-p (window-painting window)) nil)
  (memory-barrier)
  (refresh window))

(defun refresh (window)
  "Paint all panes of WINDOW whose contents have changed, as one picture."
  (let ((snapshot (window-snapshot window)))
    (restart-prompt-if-lost (window-conversation window) (window-simulation window)
                            (shown-robot-name window))
    (restart-pacer-if-lost (window-watcher window))
    (restart-event-thread (clim:port window))
    (open-sections-with-contents window)
    (if (shiftf (painting-erased-p (window-painting window)) nil)
        (repaint-all window)
        (mapc #'repaint-if-changed (display-panes window)))
    (call-with-messages-of-run (lambda () (rearrange-if-needed window)) window)
    ;; The X server may be slower than we are.
    (clim:medium-finish-output (clim:sheet-medium (pane-named window 'world)))
    (unless (eq snapshot (painting-snapshot (window-painting window)))
      (setf (painting-snapshot (window-painting window)) snapshot)
      (report-painted (window-watcher window)))))

(defun request-repaint (window)
  "Request that the whole WINDOW be painted soon. Any thread may call this."
  (setf (painting-erased-p (window-painting window)) t)
  (request-refresh window))

;;; CLIM's loop reads commands, but there are none: everything is an event.

(defmethod clim:read-frame-command ((window robot-window) &key stream)
  (declare (ignore stream))
  (focus-and-repaint (pane-named window 'interactor))
  (call-next-method window :stream nil))
