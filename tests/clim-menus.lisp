;;;; clim-menus.lisp -- the menu bar: each entry can be reached, at any size of the window.

(in-package :ars-magna.tests)

(in-suite clim)

(defun open-menu-called (window title)
  "Click on the menu called TITLE in the bar of WINDOW."
  (let ((bar (pane window 'window::menus)))
    (window::handle-press-closing-popup bar :left
                              (+ 5 (window::menu-left-edge bar (find title window::*menus*
                                                                :key #'window::menu-title
                                                                :test #'equal)))
                              5)))

(defun rows-of-popup (window)
  "Return the texts of the menu or panel that is open in WINDOW, or NIL."
  (and (window::popup-open-p window)
       (cl:mapcar #'window::row-text (window::pane-rows (window::window-popup window)))))

(defun choose-in-menu (window text)
  "Click on the row called TEXT of the menu that is open in WINDOW."
  (let* ((popup (window::window-popup window))
         (position (position text (rows-of-popup window) :test #'equal)))
    (window::scroll-to popup (* position window::+row-height+))
    (window::handle-press-closing-popup popup :left 20
                              (- (+ 8 (* position window::+row-height+))
                                 (window::pane-offset popup)))))

(defun popup-inside-p (window)
  (let ((popup (window::window-popup window)))
    (multiple-value-bind (width height) (window::pane-size popup)
      (multiple-value-bind (left top)
          (clim:transform-position (clim:sheet-transformation popup) 0 0)
        (multiple-value-call #'inside-p (list left top width height)
          (window::pane-size (clim:sheet-parent popup)))))))

(test window.what-was-said-comes-back-for-each-robot-that-it-has-shown
  "ROBOT may have led the window to another one."
  (in-window (window robot)
    (let ((window::*last-preferences* nil) (window::*window-states* '()))
      (window::write-to-transcript (window::window-transcript window)
                                  (format nil "That was said.~%"))
      (window::show-robot-called window 'other (time:current-simulation))
      (window::save-settings window)
      (call-with-window
       (lambda (next)
         (window::restore-settings next)
         (is (mentions-p (said-in next) "That was said.")))
       robot))))

(test window.a-new-one-is-as-the-user-left-the-last
  "Layers, displays folded away, sizes, and what was said."
  (in-window (window robot)
    (window::toggle-layer window :grid)
    (window::fold-section window 'window::hands)
    (window::set-plan-view (pane window 'window::plan) :timeline)
    (setf (window::preferences-details-width (window::window-preferences window)) 300)
    (window::write-to-transcript (window::window-transcript window) (format nil "That was said.~%"))
    (let ((window::*last-preferences* nil) (window::*window-states* '())
          (layers (window::window-layers window)))
      (window::save-settings window)
      (call-with-window
       (lambda (next)
         (window::restore-settings next)
         (is (equal layers (window::window-layers next)))
         (is (window::section-folded-p next 'window::hands))
         (is (eq :timeline (window::plan-look-view (window::plan-look-of
                                                    (pane next 'window::plan)))))
         (is (= 300 (window::preferences-details-width (window::window-preferences next))))
         (is (mentions-p (said-in next) "That was said."))
         (window::fold-section next 'window::hands nil)
         (is (window::section-folded-p window 'window::hands) "each has its own"))
       robot))))

(test menus.open-one-another
  "A click on another title opens that menu at once, on the same one closes it."
  (in-window (window robot)
    (lay-out window 640 480)
    (open-menu-called window "Run")
    (is (member "Pause" (rows-of-popup window) :test #'equal))
    (open-menu-called window "Edit")
    (is (equal '("Copy" "Paste") (rows-of-popup window)))
    (open-menu-called window "Edit")
    (is (null (rows-of-popup window)))))

(test menus.are-inside-of-a-small-window
  "Each of the prompt's lines can be chosen in a menu, at 640 x 480."
  (in-window (window robot)
    (lay-out window 640 480)
    (dolist (group (window::prompt-line-menus))
      (open-menu-called window "Robot")
      (is (popup-inside-p window))
      (choose-in-menu window (format nil "~A >" (window::menu-title group)))
      (is (popup-inside-p window))
      (is (equal (cons "< Robot" (cl:mapcar #'first (window::current-menu-items group)))
                 (rows-of-popup window)))
      (window::close-popup window))))

(test menus.give-lines-to-the-prompt
  (in-window (window robot)
    (lay-out window 640 480)
    (flet ((choose (&rest texts)
             (open-menu-called window "Robot")
             (dolist (text texts) (choose-in-menu window text))))
      (choose "Running >" "< Robot" "Seeing >" "STATUS")
      (is (equal '("status") (lines-given window)))
      (is (null (rows-of-popup window)))
      (choose "Moving >" "TURN")
      (is (equal '("status" "turn ") (cl:mapcar #'second (keys-handed window)))))))

(test menus.do-what-they-say
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((pane (pane window 'window::world)))
      (open-menu-called window "View")
      (choose-in-menu window "Zoom in")
      (is (not (window::pane-fitting-p pane)))
      (open-menu-called window "View")
      (choose-in-menu window "Whole map")
      (is (window::pane-fitting-p pane))
      (open-menu-called window "View")
      (choose-in-menu window "Layers ...")
      (is (member "In colour" (rows-of-popup window) :test #'equal)))))

(test panels.open-one-another
  "A button of the tool bar opens its panel at once while another is open."
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((bar (pane window 'window::bar)))
      (flet ((press (label)
               (destructuring-bind (left top . rest)
                   (rest (find label (window::pane-subjects bar)
                               :key (lambda (subject) (window::button-label (first subject)))
                               :test #'equal))
                 (declare (ignore rest))
                 (window::handle-press-closing-popup bar :left (+ left 3) (+ top 3)))))
        (press "Layers")
        (is (member "In colour" (rows-of-popup window) :test #'equal))
        (press "Help")
        (is (member "Mouse" (rows-of-popup window) :test #'equal))
        (press "Help")
        (is (null (rows-of-popup window)))))))

(test menus.can-be-used-without-a-mouse
  "F10 opens the first; arrows lead through rows and menus, return chooses."
  (in-window (window robot)
    (lay-out window 640 480)
    (press-in window :f10 nil)
    (is (equal "Pause" (first (rows-of-popup window))))
    (press-in window :down nil)
    (press-in window :up nil)
    (press-in window :up nil)
    (is (equal "Interrupt" (window::row-text (window::pane-pointed
                                              (window::window-popup window)))))
    (press-in window :right nil)
    (press-in window :right nil)
    (is (equal "Zoom in" (first (rows-of-popup window))))
    (press-in window :left nil)
    (press-in window :right nil)
    (press-in window :down nil)
    (press-in window :down nil)
    (let ((scale (window::pane-scale (pane window 'window::world))))
      (press-in window :return #\Return)
      (is (> scale (window::pane-scale (pane window 'window::world)))))
    (is (null (rows-of-popup window)))
    (is (equal "" (keys-given window)))))

(test menus.a-mouse-that-rests-does-not-point
  "Where a menu drops under it, the key's choice stays."
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((popup (window::window-popup window)))
      (window::toggle-first-menu window)
      (move-mouse popup 20 60)
      (window::highlight-further-row popup 1)
      (let ((row (window::pane-pointed popup)))
        (move-mouse popup 20 60)
        (is (eq row (window::pane-pointed popup)))
        (move-mouse popup 20 160)
        (is (not (eq row (window::pane-pointed popup))))))))
