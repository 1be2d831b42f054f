;;;; clim-plots.lisp -- plots and the recording of films in the window.

(in-package :ars-magna.tests)

(in-suite clim)

(defun type-in-window (window &rest lines)
  "Run LINES in the session of WINDOW, whose prompt has not begun. Its output is lost."
  (let ((session (window::window-session window))
        (time:*simulation* (window::window-simulation window))
        (*standard-output* (make-broadcast-stream))
        (*package* (find-package :ars-user)))
    (dolist (line lines) (cli::run-typed-line session line))))

(defun plotted-window (window &rest lines)
  "Run LINES in WINDOW, let 30 ticks pass, and return the pane of plots, painted."
  (apply #'type-in-window window lines)
  (run:run-ticks 30)
  (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
  (lay-out window 1000 900)
  (window::refresh window)
  (pane window 'window::plots))

(test plot-pane.has-room-only-if-something-is-plotted
  (in-window (window robot)
    (let ((pane (plotted-window window)))
      (is (not (window::pane-shown-p pane)))
      (is (not (window::pane-shown-p (pane window 'window::plots-title))))
      (plotted-window window "plot speed" "plot distance")
      (is (window::pane-shown-p pane))
      (is (window::pane-shown-p (pane window 'window::plots-title)))
      (is (= (* 2 window::+time-chart-height+) (window::pane-extent pane)))
      (plotted-window window "plot off")
      (is (not (window::pane-shown-p pane))))))

(test plot-pane.the-mouse-tells-tick-and-value
  (in-window (window robot)
    (let ((pane (plotted-window window "plot (lambda (r) (simulation-tick))")))
      (is (equal "(lambda (r) (simulation-tick)): 0 at tick 0" (window::hover-text pane 0 60)))
      (is (mentions-p (window::hover-text pane (window::content-width pane) 60)
                      ": 30 at tick 30"))
      (window::handle-click pane :left 0 60)
      (is (mentions-p (said-in window) ": 0 at tick 0")))))

(test plot-pane.offers-lines
  (in-window (window robot)
    (let ((pane (plotted-window window "plot speed")))
      (window::handle-click pane :right 0 60)
      (let ((rows (cl:mapcar #'whole-row-text
                             (window::pane-rows (window::window-popup window)))))
        (dolist (text '("rewind-to 0" "plot speed off"
                        "plot-picture studio-robot-plots-000030.svg"))
          (is (some (lambda (row) (mentions-p row text)) rows)))))))

(test plot-pane.takes-no-samples-while-folded
  "Its observer is gone, too, so that ticks cost nothing."
  (in-window (window robot)
    (let* ((pane (plotted-window window "plot speed"))
           (session (window::window-session window))
           (count (length (run::simulation-observers (time:current-simulation)))))
      (flet ((mark () (cli:plots-mark session (time:current-simulation) 'studio-robot)))
        (window::fold-section window 'window::plots)
        (is (not (window::pane-shown-p pane)))
        (let ((mark (mark)))
          (run:run-ticks 5)
          (is (equal mark (mark)))
          (is (= (1- count) (length (run::simulation-observers (time:current-simulation)))))
          (cli:set-plots-shown session t)
          (type-in-window window "plot")
          (cli::update-plots session)
          (run:run-ticks 5)
          (is (not (equal mark (mark))))
          (is (= count (length (run::simulation-observers (time:current-simulation))))))))))

(defun ticks-plotted (window)
  "Return a list with the ticks of each curve that WINDOW plots."
  (loop for plotted in (cli::current-plotted (window::window-session window)
                                             (time:current-simulation) 'studio-robot)
        collect (mapcar #'plots:sample-range-tick
                        (plots:time-series-ranges (cli::plotted-series plotted)))))

(defun call-with-next-window (function window robot)
  "Close WINDOW, as far as its settings are concerned. After ten ticks, call FUNCTION with the next
window of ROBOT."
  (let ((window::*last-preferences* nil) (window::*window-states* '()))
    (window::save-settings window)
    (run:run-ticks 10)
    (call-with-window (lambda (next)
                        (window::restore-settings next)
                        (funcall function next))
                      robot)))

(defun ticks-between (first last) (loop for tick from first to last collect tick))

(test plot-pane.next-window-continues-the-curves
  "There is a gap where no window was open, and ticks cost nothing meanwhile."
  (in-window (window robot)
    (let ((count (length (run::simulation-observers (time:current-simulation)))))
      (flet ((observers ()
               (- (length (run::simulation-observers (time:current-simulation))) count)))
        (plotted-window window "plot speed" "plot (lambda (r) (simulation-tick))" "plot-ticks 99")
        (is (= 1 (observers)))
        (call-with-next-window
         (lambda (next)
           ;; The one of the next window's display of the world.
           (is (= 1 (observers)))
           (window::follow-plots-now next)
           (plotted-window next)
           (is (= 2 (observers)))
           (is (equal "Plots of the last 99 ticks" (window::plots-title next)))
           (let ((expected (append (ticks-between 0 30) (ticks-between 40 70))))
             (is (equal (list expected expected) (ticks-plotted next))))
           (let ((pane (pane next 'window::plots)))
             (is (window::pane-shown-p pane))
             (is (= (* 2 window::+time-chart-height+) (window::pane-extent pane)))))
         window robot)))))

(test plot-pane.next-window-has-its-own-plots
  "What the next window plots is nothing to the closed window's prompt, which may end later."
  (in-window (window robot)
    (plotted-window window "plot speed")
    (call-with-next-window
     (lambda (next)
       (window::follow-plots-now next)
       (type-in-window next "plot distance")
       (setf (cli::session-over-p (window::window-session window)) t)
       (cli::stop-plotting (window::window-session window))
       (run:run-ticks 2)
       (is (equal (list (append (ticks-between 0 30) (ticks-between 40 42)) (ticks-between 40 42))
                  (ticks-plotted next)))
       (is (equal '("speed") (cli:plotted-names (window::window-session window)))))
     window robot)))

(test plot-pane.next-window-has-no-curve-of-discarded-ticks
  (in-window (window robot)
    (run:keep-forks)
    (plotted-window window "plot speed")
    (call-with-next-window
     (lambda (next)
       (declare (ignore next))
       (run:rewind 15)
       (call-with-window (lambda (last)
                           (window::restore-settings last)
                           (is (equal (list (ticks-between 0 25)) (ticks-plotted last)))
                           (window::follow-plots-now last)
                           (run:run-ticks 1)
                           (is (equal (list (ticks-between 0 26)) (ticks-plotted last))))
                         (first (run:simulation-robots (time:current-simulation)))))
     window robot)))

(test plot-panel.gives-lines-to-the-prompt
  (in-window (window robot)
    (plotted-window window "plot speed" "plot (lambda (r) 1)")
    (flet ((choose (text)
             (open-menu-called window "View")
             (choose-in-menu window "Plots ...")
             (choose-in-menu window text)
             (window::close-popup window)
             (first (last (lines-given window)))))
      (is (equal "plot distance" (choose "distance")))
      (is (equal "plot speed off" (choose "speed")))
      (is (equal "plot (lambda (r) 1) off" (choose "(lambda (r) 1)")))
      (is (equal "plot-ticks 100" (choose "Show the last 100 ticks")))
      (is (equal "plot-ticks all" (choose "Show all ticks"))))))

(test recording.is-in-the-menu-and-in-the-status-strip
  (in-window (window robot)
    (lay-out window 1000 900)
    (setf (window::preferences-layers (window::window-preferences window))
          display:*picture-layers*)
    (flet ((choose (text)
             (open-menu-called window "Window")
             (choose-in-menu window text)
             (first (last (lines-given window))))
           (strip () (first (window::status-strip-lines window))))
      (is (equal "record on" (choose "Record a film")))
      (is (not (mentions-p (strip) "recording")))
      (run:run-ticks 3)
      (type-in-window window "record on")
      (is (mentions-p (strip) "; recording a film since tick 3"))
      (is (equal "record off" (choose "Stop the film and save it")))
      (type-in-window window "record cancel")
      (window::toggle-layer window :trail)
      (is (equal "record on trail" (choose "Record a film")))
      (setf (window::preferences-layers (window::window-preferences window)) '(:grid))
      (is (equal "record on bare grid legend title" (choose "Record a film"))))))
