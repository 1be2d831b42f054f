;;;; window.lisp -- the window: its parts, where they are, and how they are kept up to date.

(in-package :ars-magna.clim)

;;; A new snapshot, or a new line of the transcript, queues one event, however many come before it
;;; is handled; handling it paints the panes that have changed, as one picture. Everything in the
;;; window happens in its own thread.

(defparameter *help-line*
  "Type a command below and press return, or choose one from a menu. HELP lists all commands.")

(defun make-detail-pane (class name display height)
  (clim:make-pane class :name name :display display :width 340 :min-width 120
                        :height height :min-height (min height 50) :max-height clim:+fill+))

(defmacro titled (title pane)
  "Return PANE with TITLE above it."
  `(clim:vertically (:y-spacing 0)
     (clim:make-pane 'clim:label-pane :label ,title :align-x :left :max-height 20)
     (:fill (clim:outlining (:thickness 1) ,pane))))

(clim:define-application-frame robot-window ()
  ((watcher :initarg :watcher :accessor window-watcher
            :documentation "The watcher that supplies the window's snapshots.")
   (layers :initarg :layers :initform *picture-layers* :accessor window-layers
           :documentation "Which layers the window's display of the world shows.")
   (color-p :initarg :color-p :initform t :accessor window-color-p)
   (transcript :initform nil :accessor window-transcript)
   (conversation :initform nil :accessor window-conversation)
   ;; For how many columns and rows its transcript has room.
   (text-size :initform '(80 24) :accessor window-text-size)
   ;; Its car is true while an event is queued.
   (queued :initform (list nil) :reader window-queued)
   (painted :initform nil :accessor window-painted)
   (thread :initform nil :accessor window-thread))
  (:menu-bar menu-bar)
  (:command-table (robot-window))
  (:panes
   (world (clim:make-pane 'world-pane :name 'world :display :world
                                      :width 680 :height 520 :min-width 100 :min-height 100))
   (state (make-detail-pane 'detail-pane 'state :state 76))
   (designators (make-detail-pane 'designators-pane 'designators :designators 110))
   (cameras (make-detail-pane 'detail-pane 'cameras :cameras 140))
   (hands (make-detail-pane 'detail-pane 'hands :hands 84))
   (bins (make-detail-pane 'detail-pane 'bins :bins 84))
   (transcript (clim:make-pane 'transcript-pane :name 'transcript :display :transcript
                                                :width 680 :height 120 :min-height 40
                                                :max-height 400))
   (interactor (clim:make-pane 'interactor-pane :name 'interactor :display :interactor
                                                :width 680 :height 36 :min-height 36
                                                :max-height 36)))
  (:layouts
   (default
    (clim:vertically ()
      (:fill (clim:horizontally (:x-spacing 4)
               (:fill (titled "World" world))
               (clim:vertically (:y-spacing 2)
                 (titled "Robot state" state)
                 (:fill (titled "Robot designators" designators))
                 (titled "Cameras" cameras)
                 (titled "Hands" hands)
                 (titled "Storage bins" bins))))
      (titled "Commands" transcript)
      (clim:outlining (:thickness 1) interactor))))
  (:documentation "The displays of a robot in a window."))

(setf (documentation 'window-layers 'function)
      "Return which layers the window's display of the world shows. Can be set."
      (documentation 'window-watcher 'function)
      "Return the watcher that supplies the window's snapshots.")

(defun window-title (robot-name)
  (format nil "ARS MAGNA: ~A" robot-name))

(defun make-robot-window (watcher &rest options)
  "Return a window, not shown yet, for the robot of WATCHER. OPTIONS are CLIM's for frames, and
:layers and :color-p."
  (let ((window (apply #'clim:make-application-frame 'robot-window
                       :pretty-name (window-title (watcher-robot watcher))
                       :watcher watcher options)))
    (setf (window-transcript window) (make-transcript (lambda () (request-refresh window)))
          (window-conversation window)
          (begin-conversation (window-transcript window)
                              (lambda () (values-list (window-text-size window)))
                              (lambda () (agree-on-robot window))
                              (lambda () (close-window window))))
    (say (window-transcript window) (format nil "~A~%" *help-line*))
    window))

(defun window-snapshot (window)
  "Return the snapshot that WINDOW shows."
  (watcher-snapshot (window-watcher window)))

(defun window-robot (window)
  "Return the image of the robot whose details WINDOW shows, or NIL."
  (let ((snapshot (window-snapshot window)))
    (and snapshot (snapshot-robot snapshot (watcher-robot (window-watcher window))))))

(defun window-simulation (window)
  (watcher-simulation (window-watcher window)))

(defun pane-named (window name)
  (clim:find-pane-named window name))

(defun display-panes (window)
  "Return a list of the panes of WINDOW that show something."
  (remove nil (mapcar (lambda (name) (pane-named window name))
                      '(world state designators cameras hands bins transcript interactor))))

;;; Keeping up to date.

(defclass refresh-event (clim:window-manager-event) ()
  (:documentation "Something in the window may have changed."))

(defun request-refresh (window)
  "Let WINDOW be refreshed soon. Any thread may ask."
  (let ((sheet (clim:frame-top-level-sheet window)))
    (when (and sheet (swap-if (car (window-queued window)) nil t))
      (clim:queue-event sheet (make-instance 'refresh-event :sheet sheet)))))

(defun refresh (window)
  "Paint those panes of WINDOW that would look different now, all at once."
  (let ((snapshot (window-snapshot window)))
    (clim:with-output-buffered ((clim:frame-top-level-sheet window))
      (mapc #'repaint-if-changed (display-panes window)))
    (unless (eq snapshot (window-painted window))
      (setf (window-painted window) snapshot)
      (painted (window-watcher window)))))

(defmethod clim:handle-event ((sheet clime:top-level-sheet-mixin) (event refresh-event))
  (let ((window (clim:pane-frame sheet)))
    (setf (car (window-queued window)) nil)
    (memory-barrier)
    (refresh window)))

;;; What the user types and points at.

(defun describe-to (window subject)
  "Say in WINDOW what SUBJECT is, if it is anything."
  (when subject
    (let ((stream (make-instance 'transcript-stream :transcript (window-transcript window))))
      (fresh-line stream)
      (describe-subject subject stream))))

;;; Reading commands from the menus.

(defmethod clim:read-frame-command ((window robot-window) &key stream)
  (declare (ignore stream))
  (type-into (pane-named window 'interactor))
  (call-next-method window :stream nil))
