;;;; commands.lisp -- what the menus, buttons and keys of the window do.

(in-package :ars-magna.clim)

(defmacro define-window-command ((name title) (window) &body body)
  "Define NAME, a function, as the action of the menu entry TITLE. The window shows errors in BODY."
  `(defun ,name ()
     (let ((,window clim:*application-frame*))
       (with-guarded-command (,window ,title) ,@body))))

;;; Running. A fork or trial is not live: there the prompt lets ticks pass.

(defun call-live-or-send-line (window function line)
  "Call FUNCTION with the simulation of WINDOW if it is live. Otherwise send LINE to the prompt."
  (let ((simulation (window-simulation window)))
    (if (live-p simulation)
        (funcall function simulation)
        (run-line-at-prompt (window-conversation window) line))))

(define-window-command (com-pause "Pause") (window)
  (call-live-or-send-line window #'pause "pause"))

(define-window-command (com-resume "Resume") (window)
  (call-live-or-send-line window #'resume "resume"))

(define-window-command (com-pause-or-resume "Pause or go on") (window)
  (if (paused-until-resume-p (window-simulation window)) (com-resume) (com-pause)))

(defconstant +ticks-of-step-back+ 10 "The number of ticks that the button Back goes back.")

;; Ticks that pass would undo a rewind at once.
(defun pause-before-rewind (window)
  (when (live-p (window-simulation window)) (pause (window-simulation window))))

;; This goes back some ticks, as REWIND does, or to the first tick there is.
(define-window-command (com-back "Go back") (window)
  (let ((simulation (window-simulation window)))
    (pause-before-rewind window)
    (let ((passed (- (simulation-tick simulation) (or (earliest-tick simulation) 0))))
      (run-line-at-prompt (window-conversation window)
                          (format nil "rewind ~D" (min +ticks-of-step-back+ passed))))))

(define-window-command (com-step "Step") (window)
  (if (ars-magna.cli:simulator-broken-p (window-session window))
      (request-answer-first (window-conversation window) "Step")
      (call-live-or-send-line window (lambda (simulation) (step-ticks 1 simulation)) "step 1")))

(defun change-rate-to (window rate)
  "Set the tick rate of the run of WINDOW to RATE, if its ticks pass by themselves."
  (let ((simulation (window-simulation window)))
    (cond ((live-p simulation) (set-rate rate simulation))
          ((chosen-rate simulation)
           (run-line-at-prompt (window-conversation window)
                               (format nil "rate ~:[free~;~:*~A~]"
                                      (and (realp rate) (number-text rate)))))
          (t (write-in-window window "~A~%" +no-rate-text+)))
    (repaint-if-changed (pane-named window 'bar))))

(defun multiply-rate (window factor)
  (let ((rate (chosen-rate (window-simulation window))))
    (change-rate-to window (and rate (rate-of-next-step rate factor)))))

(define-window-command (com-faster "Twice as fast") (window)
  (multiply-rate window 2))

(define-window-command (com-slower "Half as fast") (window)
  (multiply-rate window 1/2))

(define-window-command (com-default-rate "Default rate") (window)
  (change-rate-to window *default-rate*))

(define-window-command (com-free "As fast as possible") (window)
  (change-rate-to window :free))

(define-window-command (com-interrupt "Interrupt") (window)
  (ars-magna.cli:interrupt-session (window-session window)))

(define-window-command (com-copy "Copy") (window)
  (copy-text window))

(define-window-command (com-paste "Paste") (window)
  (paste-text window :clipboard))

(define-window-command (com-close "Close window") (window)
  (clim:frame-exit window))

;;; The view.

(define-window-command (com-zoom-in "Zoom in") (window)
  (zoom-window window 2))

(define-window-command (com-zoom-out "Zoom out") (window)
  (zoom-window window 1/2))

(defun zoom-window (window factor)
  (let ((pane (pane-named window 'world)))
    (multiple-value-bind (width height) (pane-size pane)
      (zoom-view pane factor (floor width 2) (floor height 2)))))

(define-window-command (com-fit "Whole map") (window)
  (fit-whole-map (pane-named window 'world)))

(define-window-command (com-find "Go to the robot") (window)
  (show-robot (pane-named window 'world)))

(define-window-command (com-follow "Follow the robot") (window)
  (let ((pane (pane-named window 'world)))
    (setf (pane-following-p pane) (not (pane-following-p pane)))
    (when (and (pane-following-p pane) (pane-fitting-p pane))
      (show-hint window *whole-map-hint*))
    (refresh window)))

(define-window-command (com-larger "All larger") (window)
  (set-magnification window (1+ (window-magnification window))))

(define-window-command (com-smaller "All smaller") (window)
  (set-magnification window (1- (window-magnification window))))

(define-window-command (com-color "Colours on or off") (window)
  (toggle-color window))

(defun button-left-edge (window command)
  "Return the distance in pixels from the left edge of the tool bar of WINDOW to the button that
calls COMMAND. Return 8 if no button calls COMMAND."
  (loop for (subject left) in (pane-subjects (pane-named window 'bar))
        when (and (button-p subject) (eq command (button-command subject))) return (floor left)
        finally (return 8)))

(defun open-popup-below-bar (window rows opener)
  (open-popup window rows (button-left-edge window opener) (+ +menus-height+ +tool-bar-height+ 2)
              opener))

(define-window-command (com-names "Names of all things") (window)
  (toggle-layer window :names))

(define-window-command (com-layers "Layers") (window)
  (open-popup-below-bar window (layer-rows window) 'com-layers))

(define-window-command (com-plots "Plots") (window)
  (open-popup-below-bar window (plot-rows window) 'com-plots))

(define-window-command (com-robots "Which robot") (window)
  (open-popup-below-bar window (robot-rows window) 'com-robots))

(define-window-command (com-parameters "Parameters") (window)
  (fold-section window 'parameters (not (section-folded-p window 'parameters))))

(define-window-command (com-help "Keys and mouse") (window)
  (open-popup-below-bar window (help-rows) 'com-help))

;;; Pictures.

(defun save-window-picture (window type)
  "Save a picture of the displays of WINDOW in the current directory, in a file of TYPE."
  (let ((file (save-snapshot (window-snapshot window) (window-robot window)
                             (format nil "~(~A~)-~6,'0D.~A" (shown-robot-label window)
                                     (snapshot-tick (window-snapshot window)) type)
                             :layers (window-layers window)
                             :in-color (window-color-p window)
                             :scale (pane-scale (pane-named window 'world)))))
    (write-in-window window "Saved ~A~%" (native-name file))))

(define-window-command (com-save-svg "Save as SVG") (window)
  (save-window-picture window "svg"))

(define-window-command (com-save-png "Save as PNG") (window)
  (save-window-picture window "png"))
