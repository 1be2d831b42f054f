;;;; clim-truths.lisp -- what the window shows is correct: time in trials and forks, the view.

(in-package :ars-magna.tests)

(in-suite clim)

;;; Time in a trial.

(defun call-in-trial (function window)
  "Call FUNCTION with a trial in which the session of WINDOW is, as if its run were a trial."
  (let ((session (window::window-session window))
        (trial (cli::make-open-trial nil nil 1 nil)))
    (setf (cli::session-trial session) trial
          (cli::session-whereabouts session) (time:current-simulation))
    (cli::call-as-running-session session (lambda () (funcall function trial)))))

(defun time-said (window)
  (window::check-progress (window::window-watcher window))
  (window::run-status-text window))

(test trials.strip-and-button-say-how-time-passes
  (in-window (window robot)
    (call-in-trial
     (lambda (trial)
       (is (mentions-p (time-said window) "20/s  paused"))
       (is (equal "Resume" (window::pause-label window)))
       (window::handle-key window nil #\Space)
       (is (equal '("resume") (lines-given window)))
       (cli::resume-trial trial)
       (is (mentions-p (time-said window) "20/s  running"))
       (is (equal "Pause" (window::pause-label window)))
       (setf (cli::open-trial-result trial) t)
       (is (mentions-p (time-said window) "the trial is over")))
     window)))

(test trials.the-buttons-for-the-rate-are-lines
  (in-window (window robot)
    (call-in-trial (lambda (trial)
                     (declare (ignore trial))
                     (window::handle-key window nil #\+)
                     (is (equal '("rate 40") (lines-given window))))
                   window)))

(test trials.the-title-says-so-from-the-first-line-on
  "Before anything listens to the run."
  (in-window (window robot)
    (call-in-trial (lambda (trial)
                     (declare (ignore trial))
                     (is (mentions-p (window::world-title window) ", a trial")))
                   window)))

(test forks.the-strip-says-how-time-passes
  (in-window (window robot)
    (let ((session (window::window-session window)))
      (setf (cli::session-forks session) 1
            (cli::session-whereabouts session) (time:current-simulation))
      (cli::call-as-running-session
       session
       (lambda ()
         (is (mentions-p (time-said window) "in a fork")))))))

(test forks.back-goes-to-the-beginning-of-the-fork-at-most
  (in-window (window robot)
    (run:keep-forks)
    (run:run-ticks 8)
    (let ((fork (run:fork-simulation)))
      (run:keep-forks t fork)
      (run:run-ticks 2 fork)
      (window::watch-simulation (window::window-watcher window) fork)
      (window::handle-key window nil #\B)
      (is (equal '("rewind 2") (lines-given window))))))

(test buttons.back-pauses-a-run-that-goes-on
  (in-window (window robot)
    (let ((simulation (time:current-simulation)))
      (run:keep-forks)
      (run:start-clock simulation :rate 50)
      (unwind-protect
           (progn (window::handle-key window nil #\B)
                  (is (time:paused-p simulation)))
        (run:stop-clock simulation)))))

;; The ticks that go on would undo it.
(test timeline.a-click-pauses-a-run-that-goes-on
  (in-window (window robot)
    (let ((simulation (time:current-simulation)))
      (run:keep-forks)
      (run:run-ticks 8)
      (window::publish-snapshot (window::window-watcher window) simulation)
      (run:start-clock simulation :rate 50)
      (unwind-protect
           (progn (window::rewind-run-to-tick (pane window 'window::plan) 5)
                  (is (time:paused-p simulation))
                  (is (equal '("rewind-to 5") (lines-given window))))
        (run:stop-clock simulation)))))

(test dragging.while-time-passes-it-says-what-to-do-first
  (in-window (window robot)
    (let ((simulation (time:current-simulation)) (pane (painted-world window)))
      (command:robot-turn robot 1 nil)
      (run:run-ticks 1)
      (run:start-clock simulation :rate 1/8)
      (unwind-protect
           (let ((before (list (window::pane-left pane) (window::pane-top pane))))
             (carry pane '(28 36) '(124 20))
             (is (mentions-p (window::window-hint window) "To move BOX#1, pause the run first"))
             (is (null (lines-given window)))
             (is (null (window::pane-ghost pane)))
             (is (equal before (list (window::pane-left pane) (window::pane-top pane))))
             (time:pause simulation)
             (carry pane '(28 36) '(124 20))
             (is (= 1 (length (lines-given window)))))
        (run:stop-clock simulation)))))

;;; The view.

(test strip.says-that-all-is-in-view-while-it-is
  (in-window (window robot)
    (window::fit-whole-map (pane window 'window::world))
    (window::handle-key window nil #\R)
    (is (mentions-p (window::window-hint window) "whole map is in view"))
    (window::handle-key window :left nil)
    (is (equal "" (window::window-hint window)))))

;;; What is typed.

(test typing.what-is-pasted-is-all-to-be-seen
  (in-window (window robot)
    (lay-out window 1180 820)
    (let* ((interactor (pane window 'window::interactor))
           (before (nth-value 1 (window::pane-size interactor)))
           (console (window::conversation-console (window::window-conversation window))))
      (cli::show-prompt console "Robot> ")
      (is (= 2 (window::needed-rows interactor)))
      (setf (window::console-input-line console)
            (list "Robot> " (format nil "turn 1~%turn 2~%turn 3~%turn 4") 0))
      (is (= 5 (window::needed-rows interactor)))
      (window::refresh window)
      (is (= (+ before (* 3 canvas::+line-height+))
             (nth-value 1 (window::pane-size interactor)))))))

(test typing.however-much-is-pasted-the-transcript-stays
  (loop for rows from 1 to 100
        for places = (window::compute-places (window::make-preferences) (constantly 100) 640 480
                                             rows)
        do (is (<= 20 (fifth (assoc 'window::transcript places))))
           (is (= 444 (loop for (name nil top nil height) in places
                            when (eq name 'window::interactor) return (+ top height))))))

;;; Menus.

(defun press-popup (window y time)
  "Press the left button at Y of the menu that is open in WINDOW, at TIME, in milliseconds."
  (let ((popup (window::window-popup window)))
    (clim:handle-event popup (make-instance 'clim:pointer-button-press-event
                                            :sheet popup :x 20 :y y :modifier-state 0
                                            :button clim:+pointer-left-button+
                                            :timestamp time))))

(test menus.the-second-of-two-clicks-chooses-nothing
  (in-window (window robot)
    (lay-out window 1180 820)
    (open-menu-called window "Robot")
    (press-popup window 8 1000)
    (let ((rows (rows-of-popup window)))
      (is (equal "< Robot" (first rows)))
      (press-popup window 26 1200)
      (is (equal rows (rows-of-popup window)))
      (is (null (lines-given window)))
      (press-popup window 8 2000)
      (is (equal "Moving >" (first (rows-of-popup window)))))))

;;; Layers.

(test layers.have-one-table-of-words
  (is (equal "wedges or cones" (window::layer-names-text :wedges)))
  (is (null (window::layer-names-text :grid)))
  (is (equal (list :layers '(:cones :belief) :only-legend nil)
             (cli::map-options "wedges designators")))
  (is (subsetp '(:trail :planned-way) (getf (cli::picture-options "way plan") :layers))))

;;; A plan that is stepped.

(rpl:def-interp-proc ars-user::window-stepped ()
  (rpl:seq (rpl:wait-time 2)
           (rpl:wait-time 3)
           (rpl:wait-time 4)))

(defun stops-seen (window task ticks)
  "Let TICKS pass while TASK is stepped; return lists of what the display of plans in WINDOW says at
each stop that the task is at, and of what tick that is, and of the tick."
  (let ((stops '()) (look (window::watcher-plans (window::window-watcher window))))
    (ars-magna.rpl.seeing:step-task task)
    (flet ((answer (condition hook)
             (declare (ignore condition hook))
             (ars-magna.host:call-listeners cli:*break-hooks*)
             (let ((tree (window::plan-look-tree look)))
               (push (list (rpl:task-image-form (first (rpl:tree-image-rows tree)))
                           (ars-magna.rpl:tree-image-tick tree)
                           (run:simulation-tick (time:current-simulation)))
                     stops))
             (invoke-restart 'ars-magna.rpl.seeing::step)))
      (base:with-debugger-hook (#'answer) (run:run-ticks ticks)))
    (reverse stops)))

(test plan-pane.shows-a-stepped-task-as-it-stands-at-each-stop
  (in-studio (robot)
    (call-with-open-window
     (lambda (window)
       (let ((task (ars-magna.rpl-robot:begin-plan 'ars-user::window-stepped)))
         (run:run-ticks 1)
         (seen-plans window)
         (let ((stops (stops-seen window task 20)))
           (is (equal '("(wait-time 3)" "(wait-time 4)") (mapcar #'first stops)))
           (loop for (nil shown tick) in stops do (is (= shown tick))))))
     robot)))

(test plan-pane.shows-it-where-no-tick-is-under-way
  "Plans of a live run have a thread of their own, and its ticks pass on."
  (in-studio (robot)
    (call-with-open-window
     (lambda (window)
       (ars-magna.rpl-robot:begin-plan 'ars-user::window-stepped)
       (run:run-ticks 1)
       (seen-plans window)
       (run:run-ticks 3)
       (let* ((simulation (time:current-simulation))
              (interface (window::plan-interface-of simulation))
              (look (window::watcher-plans (window::window-watcher window))))
         (ars-magna.rpl-robot::call-holding-plans
          (lambda () (ars-magna.host:call-listeners cli:*break-hooks*)) interface)
         (is (equal "(wait-time 3)"
                    (rpl:task-image-form
                     (first (rpl:tree-image-rows (window::plan-look-tree look))))))))
     robot)))
