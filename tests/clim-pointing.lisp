;;;; clim-pointing.lisp -- what mouse and keys do in the window.

(in-package :ars-magna.tests)

(in-suite clim)

(defun keys-handed (window)
  "Return a list of the keys that WINDOW has handed over to its prompt, which has not begun."
  (let ((octets (coerce (keys-given window) 'list)))
    (loop for key = (cli::read-key (lambda (&optional octet)
                                     (if octet (progn (push octet octets) nil) (pop octets))))
          while key collect key)))

(defun lines-given (window)
  "Return the lines given to the prompt of WINDOW, which has not begun."
  (loop for key in (keys-handed window)
        when (and (consp key) (eq :entry (first key))) collect (second key)))

(test pointing.hovering-tells
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (flet ((told (x y)
               (window::handle-hover pane x y)
               (window::window-hint window)))
        (is (equal "Cell 10, 1: a wall of wood, parameter 50.0" (told 84 12)))
        (is (equal "Cell 10, 4: doorway" (told 84 36)))
        (let ((text (told 28 36)))
          (is (mentions-p text "Cell 3, 4: "))
          (is (mentions-p text "BOX#1 at 3.50, 4.50"))
          (is (mentions-p text ":color red")))
        (is (mentions-p (second (window::status-strip-lines window)) "BOX#1"))))))

(test pointing.the-strip-tells-of-what-is-under-a-resting-mouse-now
  "What was there moves away; the view moves."
  (in-window (window robot)
    (window::refresh window)
    (let ((pane (painted-world window)))
      (flet ((told-p (name) (mentions-p (window::window-hint window) name)))
        (window::handle-hover pane 28 36)
        (is (told-p "BOX#1"))
        (world:move-thing (world:find-thing "BOX#1") (list 15.5 2.5))
        (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
        (window::refresh window)
        (is (told-p "Cell 3, 4"))
        (is (not (told-p "BOX#1")))
        (window::zoom-view pane 2)
        (is (told-p "Cell 1, 2"))
        (window::show-hint window "The run is at this tick now.")
        (window::repaint pane)
        (is (told-p "The run is at this tick now.") "which stays until the mouse moves")
        (window::handle-hover pane 28 36)
        (window::rearrange window)
        (is (equal "" (window::window-hint window)) "panes may have moved")))))

(test strip.what-is-too-long-is-told-by-a-click
  (in-window (window robot)
    (setf (window::watcher-progress (window::window-watcher window))
          (window::make-progress :state :busy :more (make-string 300 :initial-element #\x)))
    (window::handle-click (pane window 'window::strip) :left 5 5)
    (is (mentions-p (remove #\Newline (said-in window)) (make-string 300 :initial-element #\x)))))

(defun robot-beneath (window thing-spot)
  "Let the robot of WINDOW stand at THING-LABEL-TARGET; return its display of the world, painted."
  (apply #'robot:place-robot (first (run:simulation-robots)) (append thing-spot '(0)))
  (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
  (window::refresh window)
  (painted-world window))

(test pointing.a-drag-at-its-middle-takes-a-robot-that-stands-on-a-thing
  "Unless the thing is picked, as by a click."
  (in-window (window robot)
    (let ((pane (robot-beneath window '(5.5 4.5))))
      (flet ((taken () (display::subject-title (window::draggable-at pane 44 36))))
        (is (mentions-p (window::hover-text pane 44 36) "PEN#"))
        (is (mentions-p (window::hover-text pane 44 36) "STUDIO-ROBOT"))
        (is (equal "STUDIO-ROBOT" (taken)))
        (window::select-next-subject pane 44 36)
        (is (mentions-p (taken) "PEN#"))))))

(defun same-place-p (box other)
  "True if the rings in BOX and OTHER, left top right bottom, would be taken for one."
  (every (lambda (one two) (< (abs (- one two)) 3)) box other))

(test pointing.two-robots-on-one-spot-are-told-apart
  "One ring is around the other; a drag takes the robot whose details are shown; the right button
leads to both."
  (run:with-simulation ((ars-worlds:marvin ars-worlds:gofer) :seed 1 :ghosts t)
    (dolist (robot (run:simulation-robots)) (robot:place-robot robot 60.5 38.5 0))
    (dolist (shown (run:simulation-robots))
      (call-with-window
       (lambda (window)
         (lay-out window 1180 820)
         (let* ((pane (pane window 'window::world))
                (boxes (loop for (subject . box) in (window::pane-subjects pane)
                             when (typep subject 'display:robot-image) collect box)))
           (is (= 2 (length boxes)))
           (is (not (same-place-p (first boxes) (second boxes))))
           (multiple-value-bind (x y) (window::robot-position-in-pane pane)
             (is (eq (robot:robot-name shown)
                     (display:robot-image-name (window::draggable-at pane (round x) (round y)))))
             (dolist (name '("MARVIN" "GOFER"))
               (is (mentions-p (window::hover-text pane (round x) (round y)) name))
               (is (mentions-p (format nil "~{~A~}" (offered pane (round x) (round y)))
                               name))))))
       shown))))

;;; Panels, and where keys go.

(defun press-key-in (pane name)
  (clim:handle-event pane (make-instance 'clim:key-press-event
                                         :sheet pane :key-name name :key-character nil
                                         :modifier-state 0 :x 0 :y 0)))

(test panels.close-by-their-key-and-by-escape
  (in-window (window robot)
    (flet ((press (character) (window::handle-key window nil character)))
      (press #\L)
      (is (window::popup-open-p window))
      (press #\L)
      (is (not (window::popup-open-p window)))
      (press #\L)
      (press #\?)
      (is (row-with window "splitters") "another key opens its own")
      (dolist (name '(window::interactor window::world))
        (press #\L)
        (press-key-in (pane window name) :escape)
        (is (not (window::popup-open-p window)))))))

(defvar *focus* nil "In a list, the pane that keys go to, where a test is about that.")

;; By itself the null port gives keys to nobody.
(defmethod clim:port-keyboard-input-focus :around ((port clim-null::null-port))
  (if *focus* (first *focus*) (call-next-method)))

(defmethod (setf clim:port-keyboard-input-focus) :around (sheet (port clim-null::null-port))
  (if *focus* (setf (first *focus*) sheet) (call-next-method)))

(test keys.go-to-the-window-that-was-clicked-last
  "Though the thread of another one comes to its own click only then."
  (in-window (one robot)
    (call-with-window
     (lambda (other)
       (let ((*focus* (list nil)) (port (clim:port one)))
         (flet ((click-in (window)
                  (let ((pane (pane window 'window::interactor)))
                    (window::focus-window-of-event
                     port (make-instance 'clim:pointer-button-press-event
                                         :sheet pane :x 5 :y 5
                                         :button clim:+pointer-left-button+
                                         :modifier-state 0)))))
           (click-in one)
           (click-in other)
           (window::focus-and-repaint (pane other 'window::interactor))
           (window::focus-and-repaint (pane one 'window::interactor))
           (is (window::focused-p (pane other 'window::interactor)))
           (is (not (window::focused-p (pane one 'window::interactor))))
           (click-in one)
           (is (window::focused-p (pane one 'window::interactor))))))
     robot)))

(test pointing.a-click-picks
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (window::handle-click pane :left 28 36)
      (is (= 1 (length (window::selected-boxes pane))))
      (window::handle-click pane :left 84 12)
      (is (equal '(:cell 10 1) (window::window-selection window)))
      (is (null (window::selected-boxes pane))))))

;;; Offers.

(defun offered (pane x y)
  "Return the texts of the menu that a click with the right button at X, Y of PANE brings."
  (let ((window (window::window-of pane)))
    (window::handle-click pane :right x y)
    (mapcar #'whole-row-text (window::pane-rows (window::window-popup window)))))

(defun whole-row-text (row)
  "Return what both columns of ROW say."
  (format nil "~A~@[   ~A~]" (window::row-text row) (window::row-more row)))

(defun row-with (window text)
  (find text (window::pane-rows (window::window-popup window))
        :key #'whole-row-text :test (lambda (part row) (search part row))))

(test pointing.the-right-button-offers-lines
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (is (equal '("Cell 15, 2" "Describe it" "Go there   go-to 15.50 2.50"
                   "Put the robot here   pos 15.50 2.50")
                 (offered pane 124 20)))
      (is (window::popup-open-p window))
      (window::choose-row (window::window-popup window) (row-with window "go-to"))
      (is (not (window::popup-open-p window)))
      (is (equal '("go-to 15.50 2.50") (lines-given window)))
      (let ((rows (offered pane 28 36)))
        (is (member "Go there   go-to 3.50 4.50" rows :test #'equal))
        (is (find "obj-desig 0 non-local ((:color red))" rows :test #'search))))))

(test pointing.offers-names-as-the-prompt-reads-them
  "Also those that users have written between bars, and with what means something to FORMAT."
  (in-window (window robot)
    (dolist (color '(ars-user::|LIGHT RED| ars-user::|dark~red| ars-user::red))
      (let* ((image (display::make-thing-image :attributes `((:color ,color)) :x 1d0 :y 1d0))
             (line (second (first (window::search-offers image window))))
             (typed (subseq line (search "((" line))))
        (is (string= color (second (first (let ((*package* (find-package :ars-user)))
                                            (read-from-string typed))))))))))

(test pointing.what-is-next-to-the-robot-is-looked-for-there
  "A hand grasps only what a local designator denotes."
  (in-window (window robot)
    (robot:place-robot robot 3.1 4.5 0)
    (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
    (let ((rows (offered (painted-world window) 28 36)))
      (is (find "obj-desig 0 local ((:color red))" rows :test #'search) "~A" rows)
      (is (not (find "non-local" rows :test #'search))))))

(test pointing.offers-the-same-when-a-tick-has-passed-since-the-picture
  "What was painted is an image of a moment that is over; the robot is still the one commanded."
  (in-window (window robot)
    (let ((before (window::window-robot window)))
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (is (not (eq before (window::window-robot window))))
      (is (member '("Stop" "stop") (window::offers before window) :test #'equal))
      (is (equal "pos 3 4" (window::subject-moving-line before "3" "4" window))))))

(test pointing.offers-what-can-be-done-with-a-designator
  "Track, as long as it has its colour if it has one, and what is tracked, grasp."
  (in-window (window robot)
    (flet ((lines (name)
             (let ((designator (robot:add-designator
                                robot :denotation (world:find-thing name) :x 1 :y 0)))
               (publish-and-refresh window)
               (lines-offered window (find (robot:designator-number designator)
                                           (display:robot-image-designators
                                            (window::window-robot window))
                                           :key #'display:designator-image-number)))))
      (world:make-new-thing 'ars-user::plain (list (robot:robot-world robot) 2.5 2.5)
                            '((:size 1)))
      (is (equal '("cam-track 0 0" "cam-track-matching 0 0 ((:color red))") (lines "BOX#1")))
      (is (equal '("cam-track 0 1") (lines "PLAIN"))))
    (is (find "cam-track 0 0" (offered (painted-world window) 28 36) :test #'search))))

(test pointing.every-offer-is-a-line-of-the-prompt
  (in-window (window robot)
    (let ((names (mapcar #'ars-magna.cli:line-name (ars-magna.cli:all-line-commands))))
      (painted-world window)
      (dolist (subject (append (coerce (display:snapshot-things (window::window-snapshot window))
                                       'list)
                               (display:snapshot-robots (window::window-snapshot window))
                               (loop for reader in (list #'display:robot-image-cameras
                                                         #'display:robot-image-hands)
                                     append (funcall reader (window::window-robot window)))))
        (loop for (nil line) in (window::offers subject window)
              do (is (or (char= #\( (char line 0))
                         (member (subseq line 0 (position #\Space line)) names
                                 :test #'string-equal))))))))

(test pointing.reaches-all-that-lies-under-the-mouse
  "A box on which another one and the robot stand."
  (in-window (window robot)
    (robot:place-robot robot 3.5 4.5 0)
    (world:make-new-thing 'ars-user::lid (list (robot:robot-world robot) 3.5 4.5) '((:size 1)))
    (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
    (let ((pane (painted-world window)))
      (dolist (name '("LID" "BOX#1" "STUDIO-ROBOT" "Cell 3, 4"))
        (is (mentions-p (window::hover-text pane 28 36) name)))
      (let ((picked (loop repeat 5
                          do (window::handle-click pane :left 28 36)
                          collect (window::window-selection window))))
        (is (= 4 (length (remove-duplicates picked :test #'equal))))
        (is (equal (first picked) (fifth picked)) "after the last comes the first"))
      (window::handle-click pane :left 124 20)
      (is (= 3 (count-if (lambda (text) (search "Also here" text)) (offered pane 28 36))))
      (window::choose-row (window::window-popup window)
                          (row-with window "Also here: STUDIO-ROBOT"))
      (is (window::popup-open-p window))
      (is (row-with window "about-face"))
      (is (row-with window "Also here: BOX#1"))
      (is (equal (list :robot (robot:robot-name robot)) (window::window-selection window))))))

;;; Dragging.

(defun carry (pane from to)
  "Drag what is at the point FROM of PANE, (x y), to the point TO."
  (window::handle-press pane :left (first from) (second from))
  (window::handle-drag pane (first to) (second to))
  (window::handle-drop pane (first to) (second to)))

(test pointing.things-and-the-robot-can-be-dragged
  "This run is not live: time stands still between ticks."
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (carry pane '(28 36) '(124 20))
      (carry pane '(52 52) '(40 60))
      (is (equal '("(move-thing (find-thing \"BOX#1\") 15.50 2.50)" "pos 5.00 7.50")
                 (lines-given window)))
      (is (null (window::pane-ghost pane)))
      (is (equal "" (window::window-hint window)) "the strip says no longer where it would be"))))

(test pointing.a-drag-into-a-wall-says-so-before-and-after
  "As the lines do that it gives."
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (window::handle-press pane :left 28 36)
      (window::handle-drag pane 44 4)
      (is (mentions-p (window::window-hint window) "inside a wall"))
      (window::handle-drag pane 124 20)
      (is (not (mentions-p (window::window-hint window) "wall"))))
    (base:take-messages)
    (world:move-thing (world:find-thing 'box) 5.5 0.5)
    (robot:place-robot robot 0.5 3 0)
    (is (equal '("BOX#1 is inside a wall now, at 5.50, 0.50"
                 "STUDIO-ROBOT is inside a wall now, at 0.50, 3.00")
               (mapcar #'base:message-text (base:take-messages))))
    (world:move-thing (world:find-thing 'box) 5.5 2.5)
    (robot:place-robot robot 2.5 3 0)
    (is (null (base:take-messages)))))

(defun move-mouse (pane x y)
  "Let CLIM tell PANE that the mouse has moved to X, Y of it."
  (clim:handle-event pane (make-instance 'clim:pointer-motion-event
                                         :sheet pane :x x :y y :modifier-state 0)))

(test pointing.what-is-dragged-over-another-display-is-told-of-until-it-is-dropped
  (in-window (window robot)
    (let ((pane (painted-world window)) (title (pane window 'window::state-title)))
      (window::handle-press pane :left 28 36)
      (window::handle-drag pane 124 20)
      (move-mouse title 5 5)
      (is (mentions-p (window::window-hint window) "BOX#1 to 15.50, 2.50"))
      (window::handle-drag pane 5000 20)
      (is (mentions-p (window::window-hint window) "BOX#1: this place is not on the map"))
      (setf (window::pane-drag pane) nil)
      (move-mouse title 5 5)
      (is (mentions-p (window::window-hint window) "Click to fold")))))

(test pointing.dragging-the-map-moves-the-view
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (setf (window::pane-scale pane) 32)
      (window::repaint pane)
      (carry pane '(400 200) '(300 180))
      (is (equal '(100 20) (list (window::pane-left pane) (window::pane-top pane)))))))

(test pointing.a-small-shake-is-a-click
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (carry pane '(28 36) '(30 37))
      (is (mentions-p (said-in window) "BOX#1 at 3.50, 4.50")))))

;;; Keys and buttons.

(test keys.do-what-buttons-do
  (in-window (window robot)
    (let ((simulation (time:current-simulation)))
      (run:start-clock simulation :rate 20)
      (unwind-protect
           (flet ((key (character) (window::handle-key window nil character)))
             (is (key #\Space))
             (is (time:paused-p simulation))
             (is (key #\Space))
             (is (not (time:paused-p simulation)))
             (key #\+)
             (is (= 40 (run:simulation-rate simulation)))
             (key #\-)
             (is (= 20 (run:simulation-rate simulation)))
             (key #\B)
             (is (member (first (lines-given window))
                         (loop for ticks to 10 collect (format nil "rewind ~D" ticks))
                         :test #'string=))
             (key #\L)
             (is (window::popup-open-p window))
             (is (window::handle-key window :return #\Return))
             (is (not (window::popup-open-p window)))
             ;; A line begins with a small letter; what follows belongs to it.
             (is (key #\b))
             (is (key #\B))
             (is (equal '((:paste "bB")) (last (keys-handed window)))))
        (run:stop-clock simulation)))))

(test bar.names-its-keys
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((pane (pane window 'window::bar)))
      (is (= (length window::*bar-parts*) (length (window::pane-subjects pane))))
      (is (equal "Pause the run, or let time pass again (key: space)"
                 (window::hover-text pane 20 12)))
      (loop for (nil left nil right) in (window::pane-subjects pane)
            do (is (<= 0 left right 640))))))

(test robots.can-be-chosen
  (in-window (window robot)
    (is (equal (list "Which robot?" "STUDIO-ROBOT")
               (mapcar #'window::row-text (window::robot-rows window))))
    (funcall (window::row-action (second (window::robot-rows window))))
    (is (equal '("robot studio-robot") (lines-given window)))))
