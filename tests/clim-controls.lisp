;;;; clim-controls.lisp -- the slider for the rate, the panel of parameters, lines to try.

(in-package :ars-magna.tests)

(in-suite clim)

;;; The slider.

(test slider.the-scale-is-logarithmic-and-ends-with-free
  (loop for width in '(80 240)
        do (flet ((offset (rate) (window::track-offset-of-rate rate width)))
             (is (= 0 (offset 1/2)))
             (is (= width (offset :free)))
             (is (< (offset 1000) (offset :free)))
             (is (<= (abs (- (- (offset 100) (offset 10)) (- (offset 10) (offset 1)))) 1))
             (is (= (offset 1/2) (offset 1/100)))
             (is (= (offset 1000) (offset 100000))))))

(test slider.each-rate-of-the-scale-can-be-set
  (dolist (rate (append window::+slider-rates+ '(:free)))
    (is (eql rate (window::rate-at-track-offset (window::track-offset-of-rate rate 240) 240))))
  (is (eql 1/2 (window::rate-at-track-offset -50 100)))
  (is (eql :free (window::rate-at-track-offset 500 100))))

(test slider.steps-lead-to-free-and-back
  (flet ((steps (rate factor count)
           (loop repeat count do (setf rate (window::rate-of-next-step rate factor)) collect rate)))
    (is (equal '(40 80 160 320 640 1000 :free :free) (steps 20 2 8)))
    (is (equal '(1000 500) (steps :free 1/2 2)))
    (is (equal '(1 1/2 1/2) (steps 2 1/2 3)))
    (is (equal '(1/8) (steps 1/8 1/2 1)) "set at the prompt")
    (is (equal '(2500) (steps 5000 1/2 1)) "set at the prompt")))

(defun slider-x (bar rate)
  "Return where in BAR the slider has RATE."
  (destructuring-bind (left width) (window::pane-track bar)
    (+ left (window::track-offset-of-rate rate width))))

(defmacro in-live-window ((window simulation) &body body)
  "Run BODY with WINDOW, 640 x 480, of the studio's robot, in SIMULATION, which runs at 20/s."
  `(in-window (,window robot)
     (let ((,simulation (time:current-simulation)))
       (lay-out ,window 640 480)
       (run:start-clock ,simulation :rate 20)
       (unwind-protect (progn (window::refresh ,window) ,@body)
         (run:stop-clock ,simulation)))))

(test slider.dragging-sets-the-rate-at-once
  (in-live-window (window simulation)
    (let ((bar (pane window 'window::bar)))
      (flet ((rate () (run:simulation-rate simulation)))
        (window::handle-press bar :left (slider-x bar 20) 12)
        (is (eql 20 (rate)))
        (window::handle-drag bar (slider-x bar 200) 40)
        (is (eql 200 (rate)))
        (window::handle-drag bar 5000 40)
        (is (eql :free (rate)))
        (window::handle-drop bar 5000 40)
        (setf (window::pane-drag bar) nil)
        (is (eql :free (rate)))
        (window::handle-wheel bar 1 (slider-x bar 20) 12)
        (is (eql 1000 (rate)))
        (window::handle-wheel bar -1 (slider-x bar 20) 12)
        (is (eql :free (rate)))
        (is (mentions-p (window::hover-text bar (slider-x bar 20) 12) "as fast as possible"))
        (window::handle-wheel bar -1 20 12)
        (is (eql :free (rate)) "the wheel on a button")))))

(test slider.shows-a-rate-that-was-set-elsewhere
  (in-live-window (window simulation)
    (let ((bar (pane window 'window::bar)))
      (time:set-rate 7 simulation)
      (window::refresh window)
      (is (member 7 (second (window::pane-painted bar))))
      (is (mentions-p (window::hover-text bar (slider-x bar 7) 12) "7 ticks per second")))))

(test slider.in-a-trial-one-line-sets-the-rate
  (in-window (window robot)
    (lay-out window 640 480)
    (call-in-trial
     (lambda (trial)
       (declare (ignore trial))
       (window::refresh window)
       (let ((bar (pane window 'window::bar)))
         (window::handle-press bar :left (slider-x bar 20) 12)
         (window::handle-drag bar (slider-x bar 100) 12)
         (window::handle-drag bar (slider-x bar 200) 12)
         (is (eql 200 (window::rate-of-bar bar)))
         (is (null (lines-given window)))
         (window::handle-drop bar (slider-x bar 200) 12)
         (is (equal '("rate 200") (lines-given window)))))
     window)))

(test slider.says-where-there-is-no-rate
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((bar (pane window 'window::bar)))
      (window::handle-press bar :left (slider-x bar 20) 12)
      (is (null (window::pane-drag bar)))
      (is (mentions-p (window::window-hint window) "no tick rate"))
      (is (mentions-p (window::hover-text bar (slider-x bar 20) 12) "no tick rate")))))

;;; The panel of parameters.

(defun open-panel (window width height)
  "Open the panel of parameters in WINDOW, WIDTH x HEIGHT pixels large. Return its pane."
  (lay-out window width height)
  (window::handle-key window nil #\P)
  (window::refresh window)
  (pane window 'window::parameters))

(defun panel-row (pane name)
  (find name (remove-if #'stringp (window::parameter-rows pane)) :test #'equal
        :key (lambda (row) (definitions:parameter-name (window::parameter-row-parameter row)))))

(defun box-in-panel (pane test)
  "Return the box (left top right bottom) of the first object that PANE shows for which TEST holds."
  (rest (find-if test (window::pane-subjects pane) :key #'first)))

(defun click-in-panel (pane test)
  (destructuring-bind (left top right bottom) (box-in-panel pane test)
    (window::handle-click pane :left (floor (+ left right) 2) (floor (+ top bottom) 2))))

(defun step-button-p (text)
  (lambda (subject)
    (and (window::button-p subject) (equal text (window::button-help subject)))))

(defun row-named-p (name)
  (lambda (subject)
    (and (window::parameter-row-p subject)
         (equal name (definitions:parameter-name (window::parameter-row-parameter subject))))))

(test parameters.the-panel-opens-and-takes-no-room-when-closed
  (in-window (window robot)
    (loop for (width height) in *window-sizes*
          do (let ((pane (open-panel window width height)))
               (is (window::pane-shown-p pane))
               (is (window::pane-shown-p (pane window 'window::parameters-title)))
               (is (<= 100 (nth-value 1 (window::pane-size pane))))
               (is (<= 270 (window::pane-size pane)))
               (window::handle-click (pane window 'window::parameters-title) :left 5 5)
               (is (not (window::pane-shown-p pane)))
               (is (not (window::pane-shown-p (pane window 'window::parameters-title))))))))

(test parameters.the-panel-has-more-room-than-the-plan
  (in-window (window robot)
    (window::fold-section window 'window::plan nil)
    (let ((height (nth-value 1 (window::pane-size (open-panel window 1180 820)))))
      (is (<= 200 height))
      (is (<= (nth-value 1 (window::pane-size (pane window 'window::plan))) height)))))

(test parameters.the-panel-has-all-of-the-chapter
  (in-window (window robot)
    (let ((rows (window::parameter-rows (open-panel window 1180 820))))
      (is (= (length (definitions:all-parameters)) (count-if-not #'stringp rows)))
      (is (equal '("Robot movement" "Cameras" "Sensor error" "Hands" "Storage bins" "Radio"
                   "Rangefinders" "Time")
                 (remove-if-not #'stringp rows))))))

(test parameters.a-step-is-a-line
  (in-window (window robot)
    (let ((pane (open-panel window 1180 820)))
      (click-in-panel pane (step-button-p "Run the line params motion-noise* 0.11"))
      (click-in-panel pane (step-button-p "Run the line params braking* 1"))
      (is (equal '("params motion-noise* 0.11" "params braking* 1") (lines-given window))))))

(test parameters.a-click-puts-the-line-into-the-input-line
  (in-window (window robot)
    (let ((pane (open-panel window 1180 820)))
      (click-in-panel pane (row-named-p "max-turn-angle*"))
      (is (equal (format nil "params max-turn-angle* ~F" (/ pi 8))
                 (second (first (last (keys-handed window))))))
      (is (null (lines-given window))))))

(test parameters.steps-suit-the-default-and-stop-at-the-limits
  (flet ((next (name value direction)
           (window::next-value (definitions:find-parameter name) value direction)))
    (is (equal '(11/100) (next 'motion-noise* 0.1d0 1)))
    (is (equal '(4/100) (next 'min-turn-angle* 0.05d0 -1)))
    (is (equal '(9/1000) (next 'robot-turn-max-error* 0.01d0 -1)))
    (is (equal '(60) (next 'scan-density* 50 1)))
    (is (equal '(1) (next 'scan-density* 3 -1)))
    (is (equal '(3) (next 'braking* 2 1)))
    (is (equal '(2) (next 'tick-quantum* 1 1)))
    (is (equal '(1/10) (next 'prob-lose-message* 0d0 1)) "its default is 0")
    (is (null (next 'tick-quantum* 1 -1)))
    (is (null (next 'braking* 0 -1)))
    (is (null (next 'motion-noise* 0 -1)))
    (is (null (next 'motion-noise* 1 1)))
    (is (equal '(t) (next 'no-sensor-error* nil 1)))
    (is (null (next 'no-sensor-error* t 1)))
    (is (equal '(nil) (next 'no-sensor-error* t -1)))))

(test parameters.steps-suit-any-number-of-the-users-own
  (loop for (default type next) in '((0 real 1/10) (0 t 1/10) (-30 (real * 5) -20) (-1 integer 0))
        for parameter = (definitions::make-parameter :symbol 'depth* :default default :type type)
        do (is (equal (list next) (window::next-value parameter default 1)))))

(test parameters.each-line-of-the-panel-sets-what-it-says
  (in-window (window robot)
    (dolist (row (remove-if #'stringp (window::parameter-rows (open-panel window 1180 820))))
      (let ((parameter (window::parameter-row-parameter row)))
        (loop for direction in '(1 -1)
              for next = (window::next-value parameter (window::parameter-row-value row) direction)
              for values = (and next (list (first next) (window::parameter-row-value row)))
              do (dolist (value values)
                   (type-in-run (window::parameter-line-text parameter value))
                   (is (eql-or-near-p value (definitions:parameter-value parameter)))))))))

(defun eql-or-near-p (value read)
  (if (realp value) (< (abs (- value read)) 1d-9) (eql value read)))

(defun type-in-run (&rest lines)
  "Type LINES at a prompt in the current run. Return its output and the number of errors."
  (let* ((output (make-string-output-stream))
         (session (cli:make-session :input (make-string-input-stream (joined lines))
                                    :output output :batch t)))
    (cli:run-session session)
    (values (get-output-stream-string output) (cli:session-errors session))))

(test parameters.the-panel-says-which-values-hold
  (in-window (window robot)
    (let ((pane (open-panel window 1180 820)))
      (flet ((now (line)
               (type-in-run line)
               (publish-and-refresh window)
               (definitions:parameters-summary (window::parameter-values-in-force pane))))
        (is (equal "default" (now "params default")))
        (is (equal "clean" (now "params clean")))
        (is (window::row-changed-p (panel-row pane "motion-noise*")))
        (is (equal "clean, 1 other changed" (now "params braking* 3")))
        (is (equal "24 changed" (now "params motion-noise* 0.2")))
        (is (equal "clean, 1 other changed" (now "params clean")) "a second time")
        (is (equal "default" (now "params default")))
        (is (not (window::row-changed-p (panel-row pane "motion-noise*"))))))))

(test parameters.the-panel-follows-other-changes
  (in-window (window robot)
    (let ((pane (open-panel window 1180 820)) (watcher (window::window-watcher window)))
      (window::check-parameter-changes watcher)
      (window::refresh window)
      (let ((before (window::pane-painted pane)))
        (window::refresh window)
        (is (eq before (window::pane-painted pane)))
        (setf ars:hand-move-delay* 5)
        (publish-and-refresh window)
        (is (not (eq before (window::pane-painted pane))))
        (is (eql 5 (window::parameter-row-value (panel-row pane "hand-move-delay*"))))))))

(test parameters.the-panel-records-nothing-in-the-run
  "It learns of a change in the thread that runs the lines."
  (run:with-simulation (ars-worlds:dot :journal t)
    (call-with-window
     (lambda (window)
       (let* ((simulation (time:current-simulation))
              (journal (run::simulation-journal simulation))
              (before (run::journal-length journal))
              (pane (open-panel window 1180 820)))
         (setf ars:hand-move-delay* 7)
         (let ((window::*windows* (list window)))
           (window::follow-prompt nil simulation simulation))
         (is (= before (run::journal-length journal)))
         (is (eql 7 (window::parameter-row-value (panel-row pane "hand-move-delay*"))))))
     ars-worlds:dot)))

(test parameters.a-waiting-line-counts-for-the-next-step
  "While a line runs, the panel shows in grey what waiting lines will set."
  (in-window (window robot)
    (let* ((pane (open-panel window 1180 820)) (row (panel-row pane "braking*")))
      (window::set-parameter-by-line pane (window::parameter-row-parameter row) 7)
      (is (equal '(7 t) (multiple-value-list (window::row-value-or-request pane row))))
      (window::forget-fulfilled-requests pane)
      (is (equal '(2 nil) (multiple-value-list (window::row-value-or-request pane row)))
          "no line runs: it was discarded"))))

;;; Lines to try.

(defun suggestions-now (robot)
  "Return the lines suggested for ROBOT in the current run."
  (let ((snapshot (display:take-snapshot (run:simulation-world (time:current-simulation)))))
    (mapcar #'window::suggestion-line
            (window::suggestions-for snapshot (display:snapshot-robot snapshot
                                                                      (robot:robot-name robot))))))

(defun run-suggestions (name seed)
  "Type the lines suggested for the robot called NAME. Return the lines, the ticks, the output and
the number of errors."
  (run:call-with-simulation
   (lambda ()
     (let ((lines (suggestions-now (first (run:simulation-robots)))))
       (multiple-value-bind (output errors) (apply #'type-in-run lines)
         (values lines (run:simulation-tick (time:current-simulation)) output errors))))
   (list name) :seed seed))

(test suggestions.work-in-each-shipped-world
  (dolist (name '(ars-worlds:robbie ars-worlds:marvin ars-worlds:gofer ars-worlds:porter
                  ars-worlds:dot))
    (dolist (seed '(1 2))
      (multiple-value-bind (lines ticks output errors) (run-suggestions name seed)
        (is (equal '("go-to" "plan")
                   (loop for line in (rest lines) collect (subseq line 0 (position #\Space line)))))
        (is (< 20 ticks))
        (is (= 0 errors) "~A, seed ~D, ~S: ~A" name seed lines output)))))

(test suggestions.work-in-a-world-without-things-or-cameras
  (with-own-definitions
    (eval '(world:defmap bare (12 12) (rect (0 0) (12 12) bricks 10)))
    (eval '(robot:defrobot bare-robot (bare (6 6) 0)))
    (eval '(world:defmap cell (3 3) (rect (0 0) (3 3) bricks 10)))
    (eval '(robot:defrobot cell-robot (cell (1.5 1.5) 0)))
    (loop for (name first) in '((bare-robot "go-to") (cell-robot "about-face"))
          do (multiple-value-bind (lines ticks output errors) (run-suggestions name 1)
               (is (= 3 (length lines)))
               (is (eql 0 (search first (first lines))))
               (is (plusp ticks))
               (is (= 0 errors) "~S: ~A" lines output)))))

(defun call-with-new-window (function robot)
  "Call FUNCTION with a window of ROBOT as it is at the first start."
  (call-with-window
   (lambda (window)
     (setf (window::window-preferences window) (window::make-preferences)
           (window::transcript-entered (window::window-transcript window)) 0
           (window::pane-suggestions (pane window 'window::interactor)) :unknown)
     (lay-out window 640 480)
     (funcall function window))
   robot))

(defmacro in-new-window ((window robot) &body body)
  `(in-studio (,robot)
     (call-with-new-window (lambda (,window) ,@body) ,robot)))

(test suggestions.a-click-runs-the-line
  (in-new-window (window robot)
    (let* ((pane (pane window 'window::interactor))
           (suggestions (window::suggestions-in-view pane)))
      (is (= 3 (length suggestions)))
      (is (mentions-p (window::hover-text pane 50 20) (window::suggestion-line
                                                       (second suggestions))))
      (window::handle-click pane :left 50 20)
      (is (equal (list (window::suggestion-line (second suggestions))) (lines-given window)))
      (window::write-entered-line (window::window-transcript window) "Robot> that")
      (window::refresh window)
      (is (equal (remove (second suggestions) suggestions) (window::suggestions-in-view pane))))))

(test suggestions.go-when-the-user-enters-a-line-and-leave-no-gap
  (in-new-window (window robot)
    (let* ((pane (pane window 'window::interactor))
           (height (nth-value 1 (window::pane-size pane))))
      (window::write-entered-line (window::window-transcript window) "Robot> status")
      (window::refresh window)
      (is (null (window::suggestions-in-view pane)))
      (is (= 36 (nth-value 1 (window::pane-size pane))))
      (is (< 36 height)))))

(test suggestions.are-not-made-below-an-earlier-transcript
  (in-new-window (window robot)
    (window::set-initial-lines (window::window-transcript window) '("" "Robot> status"))
    (is (null (window::suggestions-wanted (pane window 'window::interactor))))))

;;; Displays that have nothing to show.

(defun open-displays (window)
  (remove-if-not (lambda (section) (window::pane-shown-p (pane window section)))
                 window::+sections+))

(test folding.displays-open-when-they-have-something-to-show
  (in-new-window (window robot)
    (is (equal '(window::state) (open-displays window)))
    (let ((number (robot:designator-number (robot:add-designator robot :x 2 :y 2))))
      (publish-and-refresh window)
      (is (equal '(window::state window::designators) (open-displays window)))
      (robot:drop-designator (find number (robot:live-designators robot)
                                   :key #'robot:designator-number)))
    (world:move-thing (world:find-thing "PEN#2") (robot:robot-storage-bin robot 0))
    (publish-and-refresh window)
    (is (equal '(window::state window::designators window::bins) (open-displays window))
        "the designators stay open")))

(test folding.what-the-user-has-folded-stays-folded
  (in-new-window (window robot)
    (let ((title (pane window 'window::designators-title)))
      (is (mentions-p (window::hover-text title 5 5) "opens by itself"))
      (window::handle-click title :left 5 5)
      (window::handle-click title :left 5 5)
      (robot:add-designator robot :x 2 :y 2)
      (publish-and-refresh window)
      (is (equal '(window::state) (open-displays window))))))

(test folding.a-plan-opens-its-display
  (in-new-window (window robot)
    (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)
    (publish-and-refresh window)
    (is (member 'window::plan (open-displays window)))
    (mapc #'ars-magna.rpl-robot:end-plan (ars-magna.rpl-robot:plans))))
