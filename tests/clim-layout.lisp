;;;; clim-layout.lisp -- positions of the parts of the window; all of them can be reached.

(in-package :ars-magna.tests)

(in-suite clim)

(defun places-at (width height &optional (preferences (preferences-with-displays-open)))
  "Return the places of all parts of a window in which each section wants 200 pixels."
  (window::compute-places preferences (constantly 200) width height))

(defun place-of (name places) (rest (assoc name places)))

(defun inside-p (place width height)
  (destructuring-bind (left top across down) place
    (and (<= 0 left) (<= 0 top) (<= (+ left across) width) (<= (+ top down) height))))

(defun apart-p (one other)
  "True if the places ONE and OTHER have no pixel in common."
  (destructuring-bind (left top width height) one
    (destructuring-bind (left-2 top-2 width-2 height-2) other
      (or (zerop (* width height width-2 height-2))
          (<= (+ left width) left-2) (<= (+ left-2 width-2) left)
          (<= (+ top height) top-2) (<= (+ top-2 height-2) top)))))

(defparameter *window-sizes* '((640 480) (800 600) (1280 900) (1920 1080) (2600 1400)))

(test layout.every-part-has-a-place-of-its-own
  (loop for (width height) in *window-sizes*
        for places = (mapcar #'rest (places-at width height))
        do (is (every (lambda (place) (inside-p place width height)) places))
           (is (loop for (place . others) on places
                     always (every (lambda (other) (apart-p place other)) others)))))

(test layout.every-display-can-be-seen-at-640-by-480
  (let ((places (places-at 640 480)))
    (dolist (name '(window::state window::designators window::cameras window::hands window::bins))
      (destructuring-bind (left top width height) (place-of name places)
        (declare (ignore left top))
        (is (>= width 200))
        (is (>= height 32))))
    (is (>= (third (place-of 'window::world places)) 320))
    (is (>= (fourth (place-of 'window::transcript places)) 60))))

(test layout.who-needs-little-gets-it
  (is (null (set-exclusive-or '((window::hands 20) (window::state 86) (window::cameras 94))
                              (window::divide-height '((window::state 150) (window::cameras 300)
                                                       (window::hands 20))
                                                     200)
                              :test #'equal)))
  (is (equal '((window::state 30) (window::designators 150) (window::hands 20))
             (window::divide-height '((window::state 30) (window::designators 10)
                                      (window::hands 20))
                                    200))))

(test layout.displays-of-text-show-whole-lines
  "But for the last, which has what is left over."
  (loop for height from 40 to 400 by 7
        for shares = (window::divide-height '((window::state 150) (window::hands 300)
                                              (window::bins 250))
                                            height)
        do (is (= height (reduce #'+ shares :key #'second)))
           (when (< 70 height)
             (is (every (lambda (share) (= 6 (mod (second share) 16))) (butlast shares))))))

(test layout.sections-go-down-beside-the-commands-of-a-low-window
  (flet ((bottom (name places)
           (destructuring-bind (left top width height) (place-of name places)
             (declare (ignore left width))
             (+ top height)))
         (needs (section) (second (assoc section window::*initial-heights*))))
    (let ((places (window::compute-places (preferences-with-displays-open) #'needs 640 480)))
      (is (= (bottom 'window::transcript places) (bottom 'window::plan-title places)))
      (loop for (section lines) in '((window::state 4) (window::cameras 3) (window::hands 1)
                                     (window::bins 1))
            do (is (<= (+ 6 (* 16 lines)) (fourth (place-of section places))))))
    (let ((places (window::compute-places (preferences-with-displays-open) #'needs 1280 900)))
      (is (<= (bottom 'window::plan-title places)
              (second (place-of 'window::low-splitter places)))))))

(test layout.lines-that-would-be-cut-are-left-out
  (let ((canvas (make-instance 'window::clim-canvas :medium nil :bottom 38)))
    (flet ((whole (offset)
             (setf (window::canvas-dy canvas) (- offset))
             (loop for base from 18 to 66 by 16 collect
                   (window::text-fully-visible-p canvas base))))
      (is (equal '(t t nil nil) (whole 0)))
      (is (equal '(nil t t nil) (whole 16)))
      (is (equal '(nil nil t nil) (whole 28))))))

(test layout.plans-have-a-column-where-there-is-room
  (let ((preferences (window::make-preferences :folded '(window::parameters))))
    (flet ((plan-left (width) (first (place-of 'window::plan (places-at width 1080 preferences))))
           (state-left (width)
             (first (place-of 'window::state (places-at width 1080 preferences)))))
      (is (= (plan-left 1200) (state-left 1200)))
      (is (< (plan-left 1920) (state-left 1920))))))

(test layout.the-column-of-plans-can-be-made-larger
  (let ((preferences (window::make-preferences :folded '(window::parameters) :plan-width 700)))
    (is (= 700 (third (place-of 'window::plan (places-at 1920 1080 preferences)))))
    (let ((places (places-at 1500 900 (window::make-preferences
                                       :folded '(window::parameters) :plan-width 5000))))
      (is (every (lambda (place) (inside-p place 1500 900)) (mapcar #'rest places)))
      (is (<= 120 (third (place-of 'window::world places)))))))

(test layout.a-plan-can-be-read-at-640-by-480
  (let ((places (places-at 640 480 (window::make-preferences :folded '(window::parameters)))))
    (destructuring-bind (left top width height) (place-of 'window::plan places)
      (declare (ignore left top))
      (is (<= 280 width))
      (is (<= 130 height)))
    (is (<= 320 (third (place-of 'window::world places))))))

;;; In a window.

(defun lay-out (window width height)
  (clim:layout-frame window width height)
  (window::refresh window))

(test layout.titles-fold-displays
  (in-window (window robot)
    (lay-out window 800 600)
    (is (not (window::pane-shown-p (pane window 'window::plan))))
    (window::handle-click (pane window 'window::plan-title) :left 5 5)
    (is (window::pane-shown-p (pane window 'window::plan)))
    (window::handle-click (pane window 'window::state-title) :left 5 5)
    (is (not (window::pane-shown-p (pane window 'window::state))))
    (window::handle-click (pane window 'window::state-title) :left 5 5)
    (is (window::pane-shown-p (pane window 'window::state)))))

(test layout.splitters-move
  (in-window (window robot)
    (lay-out window 1000 700)
    (flet ((size (name) (multiple-value-list (window::pane-size (pane window name))))
           (pull (name x y)
             (let ((pane (pane window name)))
               (window::handle-press pane :left 1 1)
               (window::handle-drag pane x y))))
      (let ((world (size 'window::world)) (transcript (size 'window::transcript)))
        (pull 'window::side-splitter -100 0)
        (is (= (- (first world) 100) (first (size 'window::world))))
        (pull 'window::low-splitter 0 -50)
        (is (= (+ (second transcript) 50) (second (size 'window::transcript))))
        (pull 'window::low-splitter 0 -5000)
        (is (plusp (second (size 'window::world))))))))

(test layout.the-splitters-of-the-plans-column-move
  (in-window (window robot)
    (lay-out window 1600 900)
    (window::fold-section window 'window::plan nil)
    (flet ((width (name) (window::pane-size (pane window name)))
           (pull (name x)
             (let ((pane (pane window name)))
               (window::handle-press pane :left 1 1)
               (window::handle-drag pane x 0))))
      (let ((world (width 'window::world)) (plan (width 'window::plan))
            (state (width 'window::state)))
        (pull 'window::side-splitter -100)
        (is (equal (list (- world 100) (+ plan 100) state)
                   (mapcar #'width '(window::world window::plan window::state))))
        (pull 'window::plan-splitter 80)
        (is (equal (list (- world 100) (+ plan 180) (- state 80))
                   (mapcar #'width '(window::world window::plan window::state))))
        (window::fold-section window 'window::plan)
        (is (not (window::pane-shown-p (pane window 'window::plan-splitter))))))))

(defun high-as-needed-p (window)
  "True if each display of details in WINDOW is as high as what it shows, designators at least so."
  (loop for section in '(window::state window::designators window::cameras window::hands
                         window::bins)
        for pane = (pane window section)
        for height = (nth-value 1 (window::pane-size pane))
        always (funcall (if (eq section 'window::designators) #'<= #'=)
                        (+ window::+section-bottom-margin+ (window::pane-extent pane)) height)))

(test layout.displays-have-room-for-what-they-show-of-another-robot
  "MARVIN has three cameras, GOFER one; also after a display has been folded away meanwhile."
  (run:with-simulation ((ars-worlds:marvin ars-worlds:gofer) :seed 1)
    (call-with-window
     (lambda (window)
       (flet ((show (name)
                (window::show-robot-called window name (time:current-simulation))
                (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
                (window::refresh window)
                (high-as-needed-p window)))
         (lay-out window 1180 900)
         (is (show 'ars-worlds:gofer))
         (is (show 'ars-worlds:marvin))
         (window::fold-section window 'window::cameras)
         (show 'ars-worlds:gofer)
         (window::fold-section window 'window::cameras nil)
         (is (high-as-needed-p window))))
     ars-worlds:marvin)))

(test layout.displays-get-room-for-what-is-new-in-them
  "A bin of the same robot contains something now."
  (in-window (window robot)
    (lay-out window 1180 900)
    (is (high-as-needed-p window))
    (world:move-thing (world:find-thing "PEN#2") (robot:robot-storage-bin robot 0))
    (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
    (window::refresh window)
    (is (high-as-needed-p window))))

(defun publish-and-refresh (window)
  "Let WINDOW show how its run is now."
  (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
  (window::refresh window))

(defun title-tops (window)
  "Return where the titles of the column of WINDOW begin, from the top."
  (loop for (name nil top) in (window::pane-places (window::window-layout window))
        when (search "-TITLE" (symbol-name name)) collect top))

(defun stay-when-a-display-shows-less (plan-p height designators)
  "Check that titles in a window HEIGHT pixels high, with the plan open if PLAN-P, stay where they
are when so many DESIGNATORS and a thing in a bin go."
  (in-window (window robot)
    (when plan-p (window::fold-section window 'window::plan nil))
    (lay-out window 1280 height)
    (let ((before (title-tops window)))
      (dotimes (count designators) (robot:add-designator robot :x 2 :y 2))
      (world:move-thing (world:find-thing "PEN#2") (robot:robot-storage-bin robot 0))
      (publish-and-refresh window)
      (let ((grown (title-tops window)))
        (is (not (equal before grown)))
        (mapc #'robot:drop-designator (robot:live-designators robot))
        (world:move-thing (world:find-thing "PEN#2") 3.5 3.5)
        (publish-and-refresh window)
        (is (equal grown (title-tops window)))
        (window::fold-section window 'window::hands)
        (window::fold-section window 'window::hands nil)
        (is (equal before (title-tops window)))))))

(test layout.titles-stay-when-a-display-shows-less
  "Until the user folds a display, or makes the window another size; with the plan open, too, which
takes all the room that there is."
  (loop for (plan-p height designators) in '((nil 900 8) (t 1000 2))
        do (stay-when-a-display-shows-less plan-p height designators)))

(test layout.a-display-that-needs-room-gets-what-another-had-needed
  (in-window (window robot)
    (lay-out window 1180 900)
    (dotimes (count 30) (robot:add-designator robot :x 2 :y 2))
    (publish-and-refresh window)
    (mapc #'robot:drop-designator (robot:live-designators robot))
    (world:move-thing (world:find-thing "PEN#2") (robot:robot-storage-bin robot 0))
    (publish-and-refresh window)
    (is (high-as-needed-p window))))

(defun show-many-designators (window robot)
  "Let ROBOT have 40 designators; return the pane of WINDOW that shows them."
  (dotimes (count 40) (robot:add-designator robot :x 2 :y 2))
  (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
  (window::refresh window)
  (pane window 'window::designators))

(test layout.displays-that-are-too-high-scroll
  (in-window (window robot)
    (lay-out window 640 480)
    (let* ((pane (show-many-designators window robot)) (extent (window::pane-extent pane)))
      (is (window::scrollable-p pane))
      (window::handle-wheel pane 1 5 5)
      (is (= 48 (window::pane-offset pane)))
      (multiple-value-bind (width height) (window::pane-size pane)
        (is (window::on-scroll-bar-p pane (- width 3)))
        (window::drag-scroll-bar pane height)
        (is (= (- extent height) (window::pane-offset pane)))))))

(defun cameras-drawn (window pane)
  "Return the numbers of the cameras of WINDOW of which the upper line is in view in PANE."
  (multiple-value-bind (width height) (window::pane-size pane)
    (loop for camera in (display:robot-image-cameras (window::window-robot window))
          for top from 0 by (/ (window::pane-extent pane) 3)
          for shown = (- top (window::pane-offset pane))
          when (and (plusp width) (<= 0 shown (- height 16)))
            collect (display:camera-image-index camera))))

(test layout.each-of-three-cameras-can-be-reached-in-a-small-window
  "In the window of MARVIN of the office, which has three, the display scrolls to each of them."
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (call-with-window
     (lambda (window)
       (lay-out window 640 480)
       (let ((pane (pane window 'window::cameras)) (reached '()))
         (is (= (window::pane-extent pane) (cameras-height window pane)) "all are drawn")
         (loop repeat 20
               do (setf reached (union reached (cameras-drawn window pane)))
                  (window::scroll-pane pane 16))
         (is (equal '(0 1 2) (sort reached #'<)))))
     ars-worlds:marvin)))

(defun cameras-height (window pane)
  "Return how high a drawing of all cameras of WINDOW is that is as wide as PANE."
  (let ((height 0))
    (drawing (canvas)
      (setf height (nth-value 1 (display:draw-display canvas :cameras
                                                      (window::window-snapshot window)
                                                      (window::window-robot window)
                                                      :width (window::content-width pane)))))
    height))

(test layout.a-picture-that-has-shrunk-is-in-view
  "Nothing of what was there before is left."
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((pane (show-many-designators window robot)))
      (window::scroll-pane pane 300)
      (is (= 300 (window::pane-offset pane)))
      (mapc #'robot:drop-designator (robot:live-designators robot))
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::refresh window)
      (is (= 0 (window::pane-offset pane))))))
