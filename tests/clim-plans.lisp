;;;; clim-plans.lisp -- plans in the window, and windows that follow into other runs.

(in-package :ars-magna.tests)

(in-suite clim)

(rpl:def-interp-proc ars-user::window-plan ()
  (rpl:par (rpl:wait-time 20)
           (:tag ars-user::second-part (rpl:wait-time 40))))

(defun seen-plans (window &optional (view :tree))
  "Return the pane of plans in WINDOW, which shows them as VIEW, as they are now."
  (let ((pane (pane window 'window::plan)))
    (lay-out window 1600 900)
    (window::fold-section window 'window::plan nil)
    (window::set-plan-view pane view)
    (window::repaint pane)
    (setf (window::plan-look-due (window::plan-look-of pane)) 0d0)
    (window::update-look-if-changed (window::plan-look-of pane))
    (window::repaint-if-changed pane)
    pane))

(defun drawn-in (pane test)
  "Return what is drawn in PANE and satisfies TEST, and its box."
  (let ((entry (find-if test (reverse (window::pane-subjects pane)) :key #'first)))
    (values (first entry) (rest entry))))

(defun click-on (pane test &optional (button :left))
  "Click with BUTTON on what is drawn in PANE and satisfies TEST."
  (destructuring-bind (left top right bottom) (nth-value 1 (drawn-in pane test))
    (window::handle-click pane button (/ (+ left right) 2) (/ (+ top bottom) 2))))

(defun task-with-number (serial)
  (lambda (subject)
    (and (typep subject 'rpl:task-image) (= serial (rpl:task-image-serial subject)))))

(test plan-pane.says-that-there-is-no-plan-and-how-to-start-one
  (in-window (window robot)
    (let ((pane (seen-plans window)))
      (click-on pane (lambda (subject)
                       (and (window::button-p subject)
                            (string= "List the plans" (window::button-label subject)))))
      (is (equal '("plan") (lines-given window))))))

(test plan-pane.shows-the-tasks
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let ((pane (seen-plans window)))
      (is (drawn-in pane (task-with-number 1)))
      (is (drawn-in pane (task-with-number 3)))
      (click-on pane (task-with-number 3))
      (is (mentions-p (said-in window) "Task 3, second-part: waiting"))
      (is (mentions-p (said-in window) "waits for tick")))))

(test plan-pane.offers-lines
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let ((pane (seen-plans window)))
      (click-on pane (task-with-number 3) :right)
      (dolist (line '("plan-tree 3" "why 3" "step-task 3" "end-task 3"))
        (is (row-with window line)))
      (window::choose-row (window::window-popup window) (row-with window "end-task"))
      (is (equal '("end-task 3") (lines-given window))))))

(test plan-pane.folds
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let ((pane (seen-plans window)))
      (click-on pane (lambda (subject) (typep subject 'ars-magna.rpl-pictures:fold-mark)))
      (seen-plans window)
      (is (drawn-in pane (task-with-number 1)))
      (is (null (drawn-in pane (task-with-number 3)))))))

(test plan-pane.is-not-looked-at-while-nothing-goes-on
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let* ((pane (seen-plans window)) (look (window::plan-look-of pane)))
      (setf (window::plan-look-due look) 0d0)
      (is (not (window::update-look-if-changed look)))
      (run:run-ticks 30)
      (is (window::update-look-if-changed look))
      (window::fold-section window 'window::plan)
      (run:run-ticks 30)
      (setf (window::plan-look-due look) 0d0)
      (is (not (window::update-look-if-changed look)) "what nobody sees is not looked at"))))

(test plan-pane.tells-how-the-last-plan-ended
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 60)
    (let ((look (window::plan-look-of (seen-plans window))))
      (is (mentions-p (window::plan-look-ended look) "window-plan succeeded at tick")))))

(test plan-pane.does-not-wait-for-plans-at-work
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let* ((look (window::plan-look-of (seen-plans window)))
           (interface (window::plan-interface-of (time:current-simulation)))
           (before (window::plan-look-tree look)))
      (run:run-ticks 40)
      (setf (window::plan-look-due look) 0d0)
      (ars-magna.rpl-robot:call-with-plans
       (lambda ()
         (base:join-thread (base:start-thread (lambda () (window::update-look-if-changed look))
                                              "look")))
       interface)
      (is (eq before (window::plan-look-tree look)))
      (is (window::update-look-if-changed look)))))

(test plan-pane.shows-the-state-at-a-break-though-it-opens-later
  "Until the break is answered only the thread of the plans can look at them. A change of the view
shows that state, too."
  (in-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let* ((pane (pane window 'window::plan)) (look (window::plan-look-of pane)))
      (ars-magna.rpl-robot:call-with-plans
       (lambda () (is (window::update-look-of-own-plans look)))
       (window::plan-interface-of (time:current-simulation)))
      (lay-out window 1600 900)
      (window::fold-section window 'window::plan nil)
      (window::repaint pane)
      (is (drawn-in pane (task-with-number 3)))
      (setf (window::plan-look-view look) :timeline)
      (window::repaint pane)
      (is (drawn-in pane (lambda (subject)
                           (and (window::button-p subject)
                                (string= "Keep a trace from now on"
                                         (window::button-label subject)))))))))

;;; The timeline.

(test plan-timeline.a-click-goes-back-to-that-moment
  (in-window (window robot)
    (let ((ars-magna.rpl-robot:*trace-plans* t))
      (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
      (run:run-ticks 30)
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (let* ((pane (seen-plans window :timeline))
             (page (window::plan-look-page (window::plan-look-of pane)))
             (x (ars-magna.rpl-pictures::x-of-tick
                 10 (ars-magna.rpl-pictures:timeline-page-scale page
                                                                (window::content-width pane)))))
        (is (mentions-p (window::hover-text pane x 60) "Tick 10"))
        (window::handle-click pane :left x 60)
        (is (equal '("rewind-to 10") (lines-given window)))
        (window::handle-click pane :right x 60)
        (is (row-with window "rewind-to 10"))))))

(test canvas.what-is-clipped-away-is-not-there
  "It is neither marked nor pointed at; of what is half hidden the half that is seen is there."
  (in-window (window robot)
    (let ((pane (seen-plans window)) (switch (window::make-button "x" nil nil "")))
      (flet ((box-of (y)
               (window::with-pane-canvas (canvas pane)
                 (canvas:with-clipping (canvas 0 23 200 100)
                   (canvas:with-origin (canvas 0 (- y))
                     (canvas:with-subject (canvas switch)
                       (canvas:draw-rectangle canvas canvas:draw-gcontext* 10 30 50 17 t)))))
               (nth-value 1 (drawn-in pane (lambda (subject) (eq subject switch))))))
        (is (equal '(10 30 60 47) (box-of 0)))
        (is (equal '(10 23 60 37) (box-of 10)))
        (is (null (box-of 40)))))))

(test plan-timeline.ticks-stay-above-the-rows
  (in-window (window robot)
    (let ((ars-magna.rpl-robot:*trace-plans* t))
      (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
      (run:run-ticks 30)
      (let ((page (window::plan-look-page
                   (window::plan-look-of (seen-plans window :timeline)))))
        (loop for from in '(0 20)
              for picture = (with-output-to-string (stream)
                              (canvas:with-svg (canvas stream)
                                (canvas:with-canvas (canvas)
                                  (ars-magna.rpl-pictures:draw-timeline-page canvas page :from
                                                                             from))
                                (values 640 400)))
              do (is (mentions-p picture (format nil "y=\"~D\"" (+ 16 from)))))))))

(test plan-timeline.names-have-the-room-that-they-need
  (in-window (window robot)
    (let ((ars-magna.rpl-robot:*trace-plans* t))
      (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
      (run:run-ticks 30)
      (let ((page (window::plan-look-page (window::plan-look-of (seen-plans window :timeline)))))
        (flet ((names (width)
                 (let ((left (ars-magna.rpl-pictures::scale-left
                              (ars-magna.rpl-pictures:timeline-page-scale page width))))
                   (loop for row in (ars-magna.rpl-pictures::page-rows page)
                         collect (ars-magna.rpl-pictures::cut-row-label row (- left 20))))))
          (is (some (lambda (name) (search "..." name)) (names 200)))
          (is (notany (lambda (name) (search "..." name)) (names 700))))))))

(test plan-timeline.says-how-to-get-a-trace
  (in-window (window robot)
    (let ((ars-magna.rpl-robot:*trace-plans* nil))
      (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
      (run:run-ticks 3)
      (let ((pane (seen-plans window :timeline)))
        (is (eq :untraced (window::plan-look-page (window::plan-look-of pane))))
        (click-on pane (lambda (subject)
                         (and (window::button-p subject)
                              (search "from now on" (window::button-label subject)))))
        (is (equal '("trace-plans on") (lines-given window)))))))

(defun trace-lit-p (window)
  "True if the switch Trace of WINDOW is lit when its plans have been looked at."
  (window::plan-look-traced-p (window::plan-look-of (seen-plans window))))

(test plan-switches.trace-is-lit-as-the-prompt-says
  "Also where no plan is under way, as after REWIND to a tick before there was one."
  (in-window (window robot)
    (is (not (trace-lit-p window)))
    (let ((ars-magna.rpl-robot:*trace-plans* t))
      (is (trace-lit-p window))
      (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
      (run:run-ticks 3)
      (is (trace-lit-p window)))))

(test plan-switches.a-trace-is-kept-after-rewind-to-a-tick-before-it-was-wanted
  (in-window (window robot)
    (run:keep-forks)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (run:run-ticks 3)
    (let ((ars-magna.rpl-robot:*trace-plans* t))
      (ars-magna.rpl:start-trace (ars-magna.rpl-robot:interface-runner
                                  (window::plan-interface-of (time:current-simulation))))
      (run:run-ticks 2)
      (run:rewind 3)
      (window::watch-simulation (window::window-watcher window) (time:current-simulation))
      (is (trace-lit-p window)))))

(test plan-switches.are-lines-of-the-prompt
  (let ((names (mapcar #'ars-magna.cli:line-name (ars-magna.cli:all-line-commands))))
    (dolist (name '("TRACE-PLANS" "END-TASK" "STEP-TASK" "PLAN-TREE" "WHY" "PLAN" "REWIND-TO"))
      (is (member name names :test #'string=)))))

;;; Going along.

(defun call-with-open-window (function robot)
  "Call FUNCTION as CALL-WITH-WINDOW does, while the window counts as open."
  (call-with-window (lambda (window)
                      (let ((window::*windows* (list window))) (funcall function window)))
                    robot))

(test following.goes-into-a-fork-and-back
  (in-studio (robot)
    (call-with-open-window
     (lambda (window)
       (let ((run (time:current-simulation)) (fork (run:fork-simulation))
             (watcher (window::window-watcher window)))
         (window::follow-prompt nil nil run)
         (run:call-in-fork
          fork
          (lambda ()
            (window::follow-prompt nil run fork)
            (is (eq fork (window::watcher-simulation watcher)))
            (run:run-ticks 5)
            (window::follow-prompt nil fork fork)
            (is (= (run:simulation-tick fork)
                   (display:snapshot-tick (window::watcher-snapshot watcher))))))
         (window::follow-prompt nil fork run)
         (is (eq run (window::watcher-simulation watcher)))))
     robot)))

(test following.shows-what-a-line-has-changed-between-ticks-of-a-fork
  "Also if no journal tells of it."
  (in-studio (robot)
    (call-with-open-window
     (lambda (window)
       (let ((run (time:current-simulation)) (fork (run:fork-simulation))
             (watcher (window::window-watcher window)))
         (setf (run:simulation-journal fork) nil)
         (window::follow-prompt nil nil run)
         (run:call-in-fork
          fork
          (lambda ()
            (window::follow-prompt nil run fork)
            (robot:place-robot (first (run:simulation-robots fork)) 2.5 2.5 0)
            (window::follow-prompt nil fork fork)
            (is (= 2.5d0 (display:robot-image-x (window::window-robot window))))))))
     robot)))

(test following.windows-hear-when-what-a-line-asked-for-is-done
  "Where the prompt lets ticks pass for that."
  (in-studio (robot)
    (let* ((seen '())
           (cli:*before-line-hooks* (list (lambda (session old new)
                                            (declare (ignore session old))
                                            (push (run:simulation-tick new) seen))))
           (session (cli:make-session :input (make-string-input-stream ""))))
      (setf (cli::session-lisp-p session) t)
      (command:robot-turn robot 1 nil)
      (cli::await-session-commands session)
      (is (plusp (run:simulation-tick (time:current-simulation))))
      (is (equal (list (run:simulation-tick (time:current-simulation))) seen)))))

(test following.leaves-windows-of-other-prompts-alone
  (in-studio (robot)
    (call-with-open-window
     (lambda (window)
       (setf (window::conversation-thread (window::window-conversation window)) t)
       (let ((run (time:current-simulation)) (fork (run:fork-simulation)))
         (run:call-in-fork fork (lambda () (window::follow-prompt nil run fork)))
         (is (eq run (window::watcher-simulation (window::window-watcher window))))))
     robot)))

(test following.buttons-are-lines-where-the-prompt-lets-ticks-pass
  "The studio's run is not live, as that of a trial."
  (in-window (window robot)
    (window::handle-key window nil #\.)
    (is (equal '("step 1") (lines-given window)))))
