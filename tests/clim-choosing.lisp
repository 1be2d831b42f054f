;;;; clim-choosing.lisp -- the window without a mouse, on CLIM's null port. See clim.lisp.

(in-package :ars-magna.tests)

(in-suite clim)

(defun pane-with-keys (window) (clim:pane-name (window::window-focus window)))

(defun press-in-focus (window name &optional character)
  "Press the key NAME, or CHARACTER, in the pane of WINDOW that has the keys."
  (clim:handle-event (window::window-focus window)
                     (make-instance 'clim:key-press-event
                                    :sheet (window::window-focus window) :key-name name
                                    :key-character character :modifier-state 0 :x 0 :y 0)))

(defun press-keys (window &rest keys)
  (dolist (key keys)
    (if (characterp key) (press-in-focus window nil key) (press-in-focus window key))))

(defun focus-pane-named (window name)
  (window::give-keys-to (pane window name)))

(defmacro in-painted-window ((window robot) &body body)
  "Run BODY with WINDOW laid out, in which the input line has the keys."
  `(in-window (,window ,robot)
     (lay-out ,window 1180 820)
     (focus-pane-named ,window 'window::interactor)
     ,@body))

(test choosing.tab-goes-to-each-display-in-turn
  (in-painted-window (window robot)
    (flet ((round-trip (key)
             (loop do (press-in-focus window key)
                   collect (pane-with-keys window)
                   until (eq 'window::interactor (pane-with-keys window)))))
      (let ((names (round-trip :tab)))
        (is (equal '(window::world window::state window::designators window::cameras
                     window::hands window::bins window::plan-title window::side-splitter
                     window::low-splitter window::interactor)
                   names))
        (is (equal (reverse (butlast names)) (butlast (round-trip :iso-left-tab))))))))

(test choosing.tab-completes-while-a-line-is-typed
  (in-painted-window (window robot)
    (window::pass-key (window::window-conversation window) "sta")
    (let ((console (window::conversation-console (window::window-conversation window))))
      (setf (cli:console-line console)
            (cli::make-drawn-line :label "Robot> " :text "sta" :point 3))
      (cli:draw-typed-line console nil))
    (press-in-focus window :tab)
    (is (eq 'window::interactor (pane-with-keys window)))
    (is (member :tab (keys-handed window)))))

(test choosing.the-display-with-the-keys-is-marked
  (in-painted-window (window robot)
    (flet ((marked ()
             (loop for section in window::+titled+
                   when (window::focused-section-p window section) collect section)))
      (is (null (marked)))
      (press-keys window :tab :tab)
      (is (equal '(window::state) (marked)))
      (is (mentions-p (window::window-hint window) "Tab goes on"))
      (press-in-focus window :escape)
      (is (null (marked))))))

(test choosing.keys-choose-the-nearest-things-first
  (in-painted-window (window robot)
    (let ((pane (painted-world window)))
      (focus-pane-named window 'window::world)
      (press-keys window #\>)
      (is (equal (list :robot (robot:robot-name robot)) (window::window-selection window)))
      (press-keys window #\>)
      (is (mentions-p (window::window-hint window) "PEN#2"))
      (is (= 1 (length (window::selected-boxes pane))))
      (press-keys window #\>)
      (is (mentions-p (window::window-hint window) "BOX#1"))
      (press-keys window #\<)
      (is (mentions-p (window::window-hint window) "PEN#2"))
      (press-keys window :return)
      (is (mentions-p (said-in window) "PEN#2 at 5.50, 4.50"))
      (press-keys window #\M :down :return)
      (is (equal '("go-to 5.50 4.50") (lines-given window)))
      (is (eq 'window::interactor (pane-with-keys window)) "as after a click on that row"))))

(test choosing.what-is-out-of-view-comes-into-view
  (in-painted-window (window robot)
    (let ((pane (painted-world window)))
      (window::move-view pane 400 0)
      (focus-pane-named window 'window::world)
      (press-keys window #\>)
      (multiple-value-bind (x y) (window::robot-position-in-pane pane)
        (is (window::in-view-p pane x y))))))

(test choosing.a-panel-gets-return-before-what-is-chosen
  (in-painted-window (window robot)
    (painted-world window)
    (focus-pane-named window 'window::world)
    (press-keys window #\> #\L :return)
    (is (not (window::popup-open-p window)))
    (is (not (mentions-p (said-in window) "STUDIO-ROBOT at")))))

(test choosing.arrows-fold-unfold-and-scroll
  (in-painted-window (window robot)
    (focus-pane-named window 'window::cameras)
    (press-in-focus window :left)
    (is (window::section-folded-p window 'window::cameras))
    (is (eq 'window::cameras-title (pane-with-keys window)))
    (press-in-focus window :right)
    (is (not (window::section-folded-p window 'window::cameras)))
    (is (eq 'window::cameras (pane-with-keys window)))
    (dotimes (count 60) (robot:add-designator robot :x 2 :y 2))
    (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
    (window::refresh window)
    (focus-pane-named window 'window::designators)
    (let ((pane (pane window 'window::designators)))
      (press-keys window :down :down)
      (is (= 96 (window::pane-offset pane)))
      (press-keys window :up :next)
      (is (< 96 (window::pane-offset pane)))
      (press-keys window :prior :prior)
      (is (= 0 (window::pane-offset pane)))
      (press-keys window #\<)
      (is (plusp (window::pane-offset pane)) "the last designator is in view"))))

(test choosing.page-keys-zoom-the-world
  (in-painted-window (window robot)
    (let ((pane (painted-world window)))
      (focus-pane-named window 'window::world)
      (press-keys window :prior)
      (is (= 16 (window::pane-scale pane)))
      (press-keys window :next :next)
      (is (= 4 (window::pane-scale pane))))))

(test choosing.arrows-move-the-bars-between-displays
  (in-painted-window (window robot)
    (flet ((width () (window::pane-size (pane window 'window::world))))
      (let ((before (width)))
        (focus-pane-named window 'window::side-splitter)
        (press-keys window :left :left)
        (is (= 30 (- before (width))))
        (press-keys window :right :right)
        (is (= before (width)))))))

(test choosing.return-presses-the-buttons-of-the-plans
  (in-painted-window (window robot)
    (window::fold-section window 'window::plan nil)
    (focus-pane-named window 'window::plan)
    (press-keys window #\> #\>)
    (is (mentions-p (window::window-hint window) "as bars over ticks"))
    (press-keys window :return)
    (is (eq :timeline (window::plan-look-view
                       (window::plan-look-of (pane window 'window::plan)))))))

;;; Pasting.

(test choosing.keys-paste-as-in-other-programs
  (in-painted-window (window robot)
    (let ((pasted '()))
      (host:wrap-function 'window::paste-text
                          (lambda (paste window selection)
                            (declare (ignore paste window))
                            (push selection pasted))
                          'test)
      (unwind-protect
           (flet ((press (pane name character modifiers)
                    (clim:handle-event (pane window pane)
                                       (make-instance 'clim:key-press-event
                                                      :sheet (pane window pane) :key-name name
                                                      :key-character character :x 0 :y 0
                                                      :modifier-state modifiers))))
             (dolist (pane '(window::interactor window::world))
               (press pane :|v| #\v clim:+control-key+)
               (press pane :v #\V (logior clim:+control-key+ clim:+shift-key+))
               (press pane :insert nil clim:+shift-key+)))
        (host:unwrap-function 'window::paste-text 'test))
      (is (equal '(:clipboard :clipboard :primary :clipboard :clipboard :primary)
                 (reverse pasted))))))

(test choosing.escape-clears-the-selection-and-closes-the-panel
  (in-painted-window (window robot)
    (let ((pane (painted-world window)))
      (declare (ignore pane))
      (window::fold-section window 'window::parameters nil)
      (focus-pane-named window 'window::world)
      (press-keys window #\> #\L :escape)
      (is (not (window::popup-open-p window)))
      (is-true (window::window-selection window))
      (press-keys window :escape)
      (is (null (window::window-selection window)))
      (is (not (window::section-folded-p window 'window::parameters)))
      (press-keys window :escape)
      (is (window::section-folded-p window 'window::parameters)))))

(test choosing.zooming-out-keeps-some-of-the-map
  (in-painted-window (window robot)
    (let ((pane (painted-world window)))
      (dotimes (count 60) (window::zoom-view pane 1/2 50 50))
      (is (<= 40 (* (window::pane-scale pane)
                    (max (world:map-width (window::view-map pane))
                         (world:map-height (window::view-map pane)))))))))
