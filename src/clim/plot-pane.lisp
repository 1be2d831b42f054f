;;;; plot-pane.lisp -- the display of plots, the mouse on it, and the panel that chooses plots.

(in-package :ars-magna.clim)

;;; The prompt of the window plots (cli/prompt/plotting.lisp), as the line PLOT does. The display
;;; shows the plots of the robot that the window shows. It has no room while nothing is plotted, and
;;; no samples are taken while it is folded.

(defclass plot-pane (display-pane) ()
  (:documentation "The pane that shows quantities over time."))

(defun call-with-plots (function window &rest more)
  "Call FUNCTION with the session, the run and the name of the robot of WINDOW, and MORE."
  (let ((simulation (window-simulation window)))
    (and simulation
         (window-conversation window)
         (apply function (window-session window) simulation (shown-robot-name window) more))))

(defun anything-plotted-p (window)
  (and (window-conversation window)
       (ars-magna.cli:plotted-names (window-session window))
       t))

(defun plots-title (window)
  (let ((plotter (and (window-conversation window)
                      (ars-magna.cli:session-plotter (window-session window)))))
    (format nil "Plots~@[ of the last ~D tick~:P~]"
            (and plotter (ars-magna.cli:plotter-ticks plotter)))))

(defmethod pane-appearance ((pane plot-pane))
  (list (pane-offset pane) (multiple-value-list (pane-size pane))
        (call-with-plots #'ars-magna.cli:plots-mark (window-of pane))))

(defmethod paint ((pane plot-pane))
  (let ((charts (call-with-plots #'ars-magna.cli:plotted-charts (window-of pane)
                                 (content-width pane))))
    (with-pane-canvas (canvas pane)
      (with-origin (canvas 0 (- (pane-offset pane)))
        (setf (pane-extent pane) (draw-time-charts canvas charts))))))

(defun plots-height (pane)
  (* +time-chart-height+
     (length (ars-magna.cli:plotted-names (window-session (window-of pane))))))

;;; Folding.

(defun follow-plots-in-thread (window)
  "Let samples be taken for the plots of WINDOW. A thread does this, because a tick may be running."
  (start-thread (lambda () (follow-plots-now window))
                (format nil "plots of ~A" (shown-robot-name window))))

(defun follow-plots-now (window)
  (let ((simulation (window-simulation window)))
    (when simulation
      (let ((*message-queue* (simulation-messages simulation)))
        (call-with-plots #'ars-magna.cli:follow-plots window)))))

(defun set-plots-folded (window folded-p)
  "Take no samples while the display of plots of WINDOW is folded."
  (ars-magna.cli:set-plots-shown (window-session window) (not folded-p))
  (unless folded-p (follow-plots-in-thread window)))

;;;; The mouse

(defstruct (plot-point (:constructor make-plot-point (series range)) (:copier nil))
  "A point of the plot of SERIES: RANGE, a sample range."
  (series nil :read-only t)
  (range nil :read-only t))

(defmethod subject-title ((point plot-point))
  (sample-text (plot-point-series point) (plot-point-range point)))

(defmethod offers ((point plot-point) window)
  (let ((tick (sample-range-tick (plot-point-range point))) (snapshot (window-snapshot window)))
    (append (and (< tick (snapshot-tick snapshot))
                 (list (list "Rewind to this tick" (rewind-line-text tick))))
            (list (list "Remove this plot"
                        (format nil "plot ~A off" (time-series-name (plot-point-series point))))
                  (list "Save the plots as SVG" (plot-picture-line window))))))

(defun plot-point-at (pane x y)
  "Return the point of the plot that PANE shows at X, Y, or NIL."
  (let ((chart (subject-at (pane-subjects pane) x y)))
    (and chart
         (let ((range (sample-range-at chart x)))
           (and range (make-plot-point (time-chart-series chart) range))))))

(defmethod hover-text ((pane plot-pane) x y) (subject-description (plot-point-at pane x y)))

(defmethod handle-click ((pane plot-pane) button x y)
  (let ((point (plot-point-at pane x y)))
    (if (eq button :right)
        (open-offers-at pane (and point (list point)) x y)
        (describe-in-transcript (window-of pane) point))))

;;;; The panel

(defun plot-picture-line (window)
  (format nil "plot-picture ~(~A~)-plots-~6,'0D.svg" (shown-robot-label window)
          (snapshot-tick (window-snapshot window))))

(defun send-line-function (window line)
  (lambda () (run-line-at-prompt (window-conversation window) line)))

(defun plot-row (window name)
  (flet ((plotted-p ()
           (member name (ars-magna.cli:plotted-names (window-session window)) :test #'string=)))
    (make-row name :tick #'plotted-p :stays-p t
                   :action (lambda ()
                             (run-line-at-prompt (window-conversation window)
                                                 (format nil "plot ~A~:[~; off~]" name
                                                         (plotted-p)))))))

(defun plot-ticks-row (window text ticks)
  (make-row text :stays-p t
                 :tick (lambda ()
                         (let ((plotter (ars-magna.cli:session-plotter (window-session window))))
                           (eql ticks (and plotter (ars-magna.cli:plotter-ticks plotter)))))
                 :action (send-line-function window (format nil "plot-ticks ~:[all~;~:*~D~]"
                                                            ticks))))

(defun plot-rows (window)
  "Return the rows of the panel that chooses what WINDOW plots."
  (let* ((robot (find (shown-robot-name window)
                      (simulation-robots (window-simulation window)) :key #'robot-name))
         (known (and robot (ars-magna.cli:plottable-names robot)))
         (own (set-difference (ars-magna.cli:plotted-names (window-session window)) known
                              :test #'string=)))
    (append (list (plot-ticks-row window "Show all ticks" nil)
                  (plot-ticks-row window "Show the last 100 ticks" 100)
                  (plot-ticks-row window "Show the last 1000 ticks" 1000)
                  (make-row "Save the plots as SVG"
                            :action (send-line-function window (plot-picture-line window)))
                  (make-row "For a function of your own, type: plot NAME")
                  (make-row ""))
            (mapcar (lambda (name) (plot-row window name)) (append own known)))))
