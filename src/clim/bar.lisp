;;;; bar.lisp -- the tool bar above the displays, and the status strip below them.

(in-package :ars-magna.clim)

;;; Keys that are letters are capitals: a line begins with a small letter, so typing one does not
;;; trigger "go back", wherever the last click was.

(defstruct (button (:constructor make-button (label key command help &optional lit-p))
                   (:copier nil))
  "A button. A click on LABEL calls COMMAND, a function of no arguments. So does the character KEY,
unless KEY is NIL. HELP describes what COMMAND does. LIT-P is true while the button is on. In the
tool bar, LABEL may be a function, and LIT-P is NIL or a function. Both take the window as argument
and return the label or whether the button is on."
  (label "" :read-only t)
  (key nil :type (or null character) :read-only t)
  (command nil :type (or symbol function) :read-only t)
  (help "" :type string :read-only t)
  (lit-p nil :read-only t))

(defun key-label (key)
  (if (char= key #\Space) "space" (string key)))

(defmethod subject-title ((button button))
  (let ((key (button-key button)))
    (format nil "~A~@[ (key: ~A)~]" (button-help button) (and key (key-label key)))))

(defun pause-label (window)
  (if (paused-until-resume-p (window-simulation window)) "Resume" "Pause"))

(defun view-follows-robot-p (window) (pane-following-p (pane-named window 'world)))

(defun all-names-shown-p (window) (and (member :names (window-layers window)) t))

(defparameter *bar-buttons*
  (list (make-button 'pause-label #\Space 'com-pause-or-resume
                     "Pause the run, or let time pass again"
                     (lambda (window) (paused-until-resume-p (window-simulation window))))
        (make-button "Step" #\. 'com-step "Let one tick pass, then pause")
        (make-button "Slower" #\- 'com-slower "Halve the rate of ticks")
        (make-button "Faster" #\+ 'com-faster "Double the rate of ticks")
        (make-button "Back" #\B 'com-back "Go back ten ticks, and pause")
        (make-button "Fit" #\F 'com-fit "Show the whole map")
        (make-button "Follow" #\R 'com-follow "Keep the robot in view" 'view-follows-robot-p)
        (make-button "Names" #\N 'com-names "Show or hide the names of all things" 'all-names-shown-p)
        (make-button "Layers" #\L 'com-layers "Choose what the world shows")
        (make-button "Help" #\? 'com-help "Show what the keys and the mouse do"))
  "The buttons of the tool bar, from left to right.")

;;; The pane.

(defclass bar-pane (display-pane) ()
  (:default-initargs :background (clim-ink +bar-color+))
  (:documentation "The tool bar."))

(defmethod pane-appearance ((pane bar-pane))
  (let ((window (window-of pane)))
    (loop for button in *bar-buttons*
          for label = (button-label button)
          for lit-p = (button-lit-p button)
          collect (list (if (stringp label) label (funcall label window))
                        (and lit-p (funcall lit-p window) t)))))

(defmethod paint ((pane bar-pane))
  (with-pane-canvas (canvas pane)
    (loop with x = 4
          for button in *bar-buttons*
          for (text lit-p) in (pane-appearance pane)
          for width = (max 48 (button-width text))
          do (setf x (+ 4 (draw-button canvas button text lit-p x 3 width
                                       (- +tool-bar-height+ 7)))))))

(defmethod handle-click ((pane bar-pane) mouse-button x y)
  (declare (ignore mouse-button))
  (let ((button (subject-at (pane-subjects pane) x y)))
    (when button (funcall (button-command button)))))

;;;; The strip

;;; The upper line shows how time passes and what waits for an answer, the lower one what is under
;;; the mouse. Text that is too long ends in three dots. A click on the strip shows all of the upper
;;; line among the commands; a click on what the mouse is on shows all of the lower one.

(defclass strip-pane (display-pane) ()
  (:default-initargs :background (clim-ink +bar-color+))
  (:documentation "The status strip."))

(defun tick-text (window)
  "Return a text with the tick that WINDOW shows, or with the last tick if its run is over."
  (let ((snapshot (window-snapshot window)) (simulation (window-simulation window)))
    (format nil "tick ~:[?~;~:*~D~]"
            (if (and simulation (simulation-over simulation))
                (simulation-tick simulation)
                (and snapshot (snapshot-tick snapshot))))))

(defun waiting-programs-text (window)
  "Return a text on how many programs wait for an answer at the prompt of WINDOW, or NIL if none."
  (let ((count (length (ars-magna.cli:waiting-break-texts (window-session window)))))
    (when (plusp count)
      (format nil "the prompt asks how to continue ~:[~R programs~;a program~]"
              (= count 1) count))))

(defun run-status-text (window)
  (format nil "~A  ~A~:[~;; a program waits for your answer~]~@[; ~A~]" (tick-text window)
          (progress-text (watcher-progress (window-watcher window)))
          (line-awaiting-input (window-conversation window))
          (waiting-programs-text window)))

(defun status-strip-lines (window)
  (list (run-status-text window) (window-hint window)))

(defmethod pane-appearance ((pane strip-pane))
  (list (status-strip-lines (window-of pane)) (multiple-value-list (pane-size pane))))

(defmethod paint ((pane strip-pane))
  (with-pane-canvas (canvas pane)
    (loop for line in (status-strip-lines (window-of pane))
          for y from 14 by +line-height+
          do (draw-label canvas 6 y (cut-label line (- (pane-size pane) 12))))))

(defmethod hover-text ((pane strip-pane) x y)
  (declare (ignore x y))
  "Click to print the line above in full among the commands")

(defmethod handle-click ((pane strip-pane) button x y)
  (declare (ignore button x y))
  (let ((window (window-of pane)))
    (write-in-window window "~A~%" (run-status-text window))))
