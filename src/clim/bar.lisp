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

;;; The slider's buttons are not drawn. They have the keys that step the rate.

(defparameter *bar-parts*
  (list (make-button 'pause-label #\Space 'com-pause-or-resume
                     "Pause the run, or let time pass again"
                     (lambda (window) (paused-until-resume-p (window-simulation window))))
        (make-button "Step" #\. 'com-step "Let one tick pass, then pause")
        (make-rate-slider
         (list (make-button "Slower" #\- 'com-slower "Halve the rate of ticks")
               (make-button "Faster" #\+ 'com-faster "Double the rate of ticks")))
        (make-button "Back" #\B 'com-back "Go back ten ticks, and pause")
        (make-button "Fit" #\F 'com-fit "Show the whole map")
        (make-button "Follow" #\R 'com-follow "Keep the robot in view" 'view-follows-robot-p)
        (make-button "Names" #\N 'com-names "Show or hide the names of all things"
                     'all-names-shown-p)
        (make-button "Layers" #\L 'com-layers "Choose what the world shows")
        (make-button "Params" #\P 'com-parameters "Show and change the simulation parameters"
                     (lambda (window) (not (section-folded-p window 'parameters))))
        (make-button "Help" #\? 'com-help "Show what the keys and the mouse do"))
  "The parts of the tool bar, from left to right: buttons and a slider.")

(defparameter *bar-buttons*
  (loop for part in *bar-parts*
        append (if (button-p part) (list part) (rate-slider-buttons part)))
  "The buttons of the tool bar and of its slider.")

;;; The pane.

(defclass bar-pane (display-pane)
  (;; The left end and the width of the slider's track, in pixels.
   (track :initform '(0 100) :accessor pane-track)
   ;; The rate to which the slider is dragged, until it takes effect; or NIL.
   (dragged-rate :initform nil :accessor pane-dragged-rate))
  (:default-initargs :background (clim-ink +bar-color+))
  (:documentation "The tool bar."))

(defun rate-of-bar (pane)
  "Return the rate that the slider in PANE shows: ticks per second, :FREE, or NIL if there is none."
  (or (pane-dragged-rate pane) (chosen-rate (window-simulation (window-of pane)))))

(defun button-text (button window)
  (let ((label (button-label button)))
    (if (stringp label) label (funcall label window))))

(defun bar-button-width (button window)
  "Return the width of BUTTON in the tool bar of WINDOW, in pixels. If its label changes, there is
room for both labels, so that the other parts of the tool bar stay in place."
  (if (stringp (button-label button))
      (max 36 (button-width (button-text button window)))
      (button-width "Resume")))

(defmethod pane-appearance ((pane bar-pane))
  (let ((window (window-of pane)))
    (list* (multiple-value-list (pane-size pane)) (rate-of-bar pane)
           (loop for button in (remove-if-not #'button-p *bar-parts*)
                 for lit-p = (button-lit-p button)
                 collect (list (button-text button window)
                               (and lit-p (funcall lit-p window) t))))))

(defun slider-width (pane)
  "Return the width of the slider in PANE: what the buttons leave, within limits, in pixels."
  (let ((window (window-of pane)))
    (clamp (- (pane-size pane) 12
              (loop for part in *bar-parts*
                    when (button-p part) sum (+ 4 (bar-button-width part window))))
           (+ 16 +rate-text-width+ +least-track-width+)
           (+ 16 +rate-text-width+ +greatest-track-width+))))

(defgeneric draw-bar-part (part canvas pane x)
  (:documentation "Draw PART of the tool bar PANE from X on. Return the x coordinate of its end.")
  (:method ((button button) canvas pane x)
    (let* ((window (window-of pane)) (lit-p (button-lit-p button)))
      (draw-button canvas button (button-text button window) (and lit-p (funcall lit-p window)) x 3
                   (bar-button-width button window) (- +tool-bar-height+ 7))))
  (:method ((slider rate-slider) canvas pane x)
    (let ((width (slider-width pane)))
      (setf (pane-track pane)
            (multiple-value-list (draw-rate-slider canvas slider (rate-of-bar pane) x width
                                                   +tool-bar-height+)))
      (+ x width))))

(defmethod paint ((pane bar-pane))
  (with-pane-canvas (canvas pane)
    (loop with x = 4
          for part in *bar-parts*
          do (setf x (+ 4 (draw-bar-part part canvas pane x))))))

;;; The mouse.

(defun bar-part-at (pane x y) (subject-at (pane-subjects pane) x y))

(defmethod hover-text ((pane bar-pane) x y)
  (if (rate-slider-p (bar-part-at pane x y))
      (rate-hover-text (rate-of-bar pane))
      (call-next-method)))

(defmethod handle-press ((pane bar-pane) button x y)
  (cond ((not (rate-slider-p (bar-part-at pane x y))) (handle-click pane button x y))
        ((null (rate-of-bar pane)) (show-hint (window-of pane) +no-rate-text+))
        ((eq button :left)
         (setf (pane-drag pane) :rate)
         (handle-drag pane x y))))

;; A live run has the new rate while the slider is dragged. A trial gets a line for the last rate.
(defmethod handle-drag ((pane bar-pane) x y)
  (declare (ignore y))
  (destructuring-bind (left width) (pane-track pane)
    (let ((rate (rate-at-track-offset (- x left) width))
          (simulation (window-simulation (window-of pane))))
      (unless (eql rate (rate-of-bar pane))
        (setf (pane-dragged-rate pane) rate)
        (when (live-p simulation) (set-rate rate simulation))
        (repaint-if-changed pane)))))

(defmethod handle-drop ((pane bar-pane) x y)
  (declare (ignore x y))
  (let ((rate (shiftf (pane-dragged-rate pane) nil)))
    (when rate (change-rate-to (window-of pane) rate))))

(defmethod handle-wheel ((pane bar-pane) steps x y)
  (when (rate-slider-p (bar-part-at pane x y))
    (funcall (if (plusp steps) 'com-slower 'com-faster))))

(defmethod handle-click ((pane bar-pane) mouse-button x y)
  (declare (ignore mouse-button))
  (let ((part (bar-part-at pane x y)))
    (when (button-p part) (funcall (button-command part)))))

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
  (format nil "~A  ~A~@[; ~A~]~:[~;; a program waits for your answer~]~@[; ~A~]"
          (tick-text window)
          (progress-text (watcher-progress (window-watcher window)))
          (ars-magna.cli:recording-text (window-session window) (window-simulation window))
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
