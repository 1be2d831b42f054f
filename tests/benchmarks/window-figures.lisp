;;;; window-figures.lisp -- frames a second, torn frames, and the cost of a window to a live run.

;;; Loaded by window.lisp. Thirty things, one to a row, move along a map of 75 x 75 cells, 8 pixels
;;; to a cell, all by the same distance in a tick. A picture in which they are not in one column, or
;;; in which one is missing, was grabbed half painted. The grabber is a second client of the X
;;; server. As a check that it finds torn frames, it also grabs while the pane paints without a
;;; buffer.

(in-package :ars-magna.benchmarks)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :window :ars-magna.clim)
  (sb-ext:add-package-local-nickname :canvas :ars-magna.canvas)
  (sb-ext:add-package-local-nickname :display :ars-magna.display)
  (sb-ext:add-package-local-nickname :client :ars-magna.window-client))

(defparameter *movers* 30)
(defparameter *seconds* 5 "How long what takes its own time is watched.")

;;; The stage.

(world:defmap stage (75 75)
  (rect (0 0) (75 75) bricks 1 10 20 30) (wall (20 20) (50 20) wood 40 80)
  (wall (10 64) (60 64) wood 40))
(robot:defrobot watched (stage (70.5 70.5) 0))

(defun row (mover)
  "Return the y coordinate of the thing numbered MOVER."
  (+ 3.5d0 (* 2 mover)))

(defun strew-movers (world)
  "Return a list of new things in WORLD, one below the other."
  (loop for mover below *movers*
        collect (world:make-new-thing 'box (list world 6.5d0 (row mover))
                                      '((:size 1) (:color red)))))

(defun step-movers (movers)
  "Move all MOVERS by a pixel to the right, and from there back to the left; not so far that the
numbers of the rows cover them."
  (let ((x (+ 6 (mod (+ (world:thing-x (first movers)) -6 1/8) 60))))
    (dolist (mover movers)
      (world:place-thing mover :floor x (world:thing-y mover)))))

(defun move-every-tick (movers)
  "Let MOVERS be moved in each tick by a thing that stays; what moves by itself looks different."
  (let ((motor (world:make-new-thing 'motor (list (world:thing-world (first movers)) 70.5d0 66.5d0)
                                     '((:size 1) (:color blue)))))
    (world:put-kicker sidestep (thing motor) ()
      (declare (ignore thing))
      (step-movers movers))))

;;; The window's own thread paints.

(defun world-pane (window) (clim:find-pane-named window 'window::world))

(defun place-window (window)
  "Make WINDOW large enough for the whole map; wait until it is."
  (let ((pane (world-pane window)))
    (loop until (clim:sheet-grafted-p pane) do (sleep 0.05))
    (sleep 1)
    (client:run-in-window window (lambda () (clim:layout-frame window 1100 900)))
    (sleep 1)
    (client:run-in-window window (lambda ()
                            (setf (window::pane-fitting-p pane) nil
                                  (window::pane-scale pane) 8
                                  (window::pane-left pane) 0
                                  (window::pane-top pane) 0)
                            (window::repaint pane)))))

;;; Frames, as fast as they can be painted. A frame is a new snapshot and its picture.

(defvar *frames* 0 "How many pictures of the world have been painted.")

(defmethod window::paint :after ((pane window::world-pane))
  (incf *frames*))

(defun paint-frames (count window movers paint)
  "Paint COUNT frames in WINDOW with the function PAINT; wait for the X server to have done so."
  (let ((watcher (window::window-watcher window)) (pane (world-pane window)))
    (loop repeat count
          do (step-movers movers)
             (window::publish-snapshot watcher (window::window-simulation window))
             (funcall paint pane))
    (clim:medium-finish-output (clim:sheet-medium pane))))

(defun frame-rate (window movers)
  (client:run-in-window window (lambda ()
                          (per-second 1000 (lambda ()
                                             (paint-frames 1000 window movers
                                                           #'window::repaint-if-changed))))))

;;; Torn frames.

(defun mover-bytes ()
  "Return the bytes of a pixel of a mover, as the X server gives them."
  (let ((color (canvas:shade 'red)))
    (list (ldb (byte 8 0) color) (ldb (byte 8 8) color) (ldb (byte 8 16) color))))

(defun grab (x-window pane)
  "Return the pixels of the map in PANE, four bytes each, as they are on the screen now."
  (multiple-value-bind (x y) (client:corner-of pane)
    (xlib:get-raw-image x-window :x (round x) :y (round y) :width 600 :height 600
                                 :format :z-pixmap)))

(defun mover-column (image mover color)
  "Return the leftmost column of IMAGE that has COLOR in the row of MOVER, or NIL."
  (let ((start (* 4 600 (round (* 8 (row mover))))))
    (loop for column below 600
          when (loop for byte in color for index from (+ start (* 4 column))
                     always (= byte (aref image index)))
            return column)))

(defun aligned-column (image color)
  "Return the column of IMAGE in which all movers stand, or NIL."
  (let ((columns (loop for mover below *movers* collect (mover-column image mover color))))
    (and (every #'eql columns (rest columns))
         (first columns))))

(defun say-torn (name grabs window)
  "Print how many of GRABS pictures of the world in WINDOW are torn, and how many of the others
differ from each other."
  (flet ((columns (x-window)
           (loop with color = (mover-bytes) with pane = (world-pane window)
                 repeat grabs
                 collect (aligned-column (grab x-window pane) color))))
    (let ((columns (client:call-with-x-window #'columns window)))
      (say name (count nil columns) "frames")
      (say "  positions seen among the others"
           (length (remove-duplicates (remove nil columns))) "positions"))))

(defun say-torn-painting (name window movers paint)
  "Print how many of 1,000 grabs are torn while frames are painted in WINDOW with PAINT."
  (let* ((over-p nil)
         (painter (base:start-thread
                   (lambda ()
                     (loop until over-p
                           do (client:run-in-window window (lambda ()
                                                      (paint-frames 5 window movers paint)))))
                   "painter")))
    (say-torn name 1000 window)
    (setf over-p t)
    (base:join-thread painter)))

;;; Live.

(defun tick-rate (simulation)
  "Return how many ticks a second the live SIMULATION passes."
  (let ((before (run:simulation-tick simulation)))
    (let ((seconds (seconds-for (lambda () (sleep *seconds*)))))
      (/ (- (run:simulation-tick simulation) before) seconds))))

(defun cpu-milliseconds (before)
  "Return how long processors have worked for us since BEFORE, in milliseconds a second."
  (/ (- (get-internal-run-time) before) (* *seconds* internal-time-units-per-second 1d-3)))

(defun say-shown (name simulation)
  "Print, of the live SIMULATION, which is shown, how many ticks a second pass, how many pictures of
them are painted, and how busy processors are."
  (let* ((frames *frames*) (before (get-internal-run-time)) (ticks (tick-rate simulation)))
    (say name ticks "ticks/s")
    (say "  frames shown" (/ (- *frames* frames) *seconds*) "frames/s")
    (say "  time of a processor" (cpu-milliseconds before) "ms a second")))

(defun keep-turning (robot)
  "Let ROBOT turn on and on."
  (command:robot-turn robot 3 (lambda (err robot angle)
                                (declare (ignore angle))
                                (unless err (keep-turning robot)))))

;; At that rate ticks pass only while a command is under way.
(defun say-free (simulation)
  "Print the same while ticks pass as fast as they can, and the movers with each of them."
  (time:set-rate :free simulation)
  (keep-turning (first (run:simulation-robots simulation)))
  (sleep 1)
  (say-shown "live, shown, as fast as possible" simulation)
  (time:set-rate 1000 simulation))

(defun say-idle (simulation)
  "Print how busy processors are while the shown SIMULATION is paused."
  (time:pause simulation)
  (sleep 1)
  (let ((before (get-internal-run-time)))
    (sleep *seconds*)
    (say "paused, shown: time of a processor" (cpu-milliseconds before) "ms a second")))

;;; All of it.

(defun call-with-shown (function robot)
  "Call FUNCTION with a window that shows ROBOT."
  (let ((window (window::open-window robot)))
    (place-window window)
    (unwind-protect (funcall function window)
      (window::close-window window)
      (base:join-thread (window::window-thread window)))))

(defun say-painting (window movers)
  (say "frames painted, 30 movers, 8 pixels a cell" (frame-rate window movers) "frames/s")
  (say-torn-painting "torn frames of 1,000, as fast as they are painted" window movers
                     #'window::repaint-if-changed)
  (say-torn-painting "  the same, were there no buffer" window movers
                     (lambda (pane)
                       (window::paint pane)
                       (clim:medium-force-output (clim:sheet-medium pane)))))

(defun say-living (window simulation)
  (say-shown "live, shown, at 1000 ticks/s" simulation)
  (say-torn "torn frames of 10,000, live" 10000 window)
  (say-free simulation)
  (say-idle simulation))

;;; Names, in a large world with robots that drive.

(defun keep-travelling (robot points)
  "Let ROBOT go to each of POINTS, (x y), in turn, on and on."
  (destructuring-bind ((x y) . more) points
    (ars-worlds:robot-go-to robot x y
                            (lambda (&rest answers)
                              (declare (ignore answers))
                              (keep-travelling robot (append more (list (first points))))))))

(defun placed-names (window)
  "Return lists (target box) of the names of things at rest in WINDOW."
  (client:run-in-window
   window
   (lambda ()
     (loop for name in (display::live-view-names (window::pane-live-view (world-pane window)))
           collect (list (display::label-target-owner (display::placed-name-target name))
                         (display::placed-name-box name))))))

(defun say-names (name window)
  "Print figures of a live run that is shown with names, and how many of them have moved, though
their things have not."
  (let ((frames *frames*) (before (get-internal-run-time)) (names (placed-names window)))
    (sleep 10)
    (let ((frames (- *frames* frames)) (time (- (get-internal-run-time) before)))
      (say name (/ frames 10) "frames/s")
      (say "  time of a processor for each frame"
           (/ time (max 1 frames) internal-time-units-per-second 1d-6) "us"))
    (say "  names of things at rest" (length names) "names")
    (say "  of these, moved in 10 s"
         (loop with after = (placed-names window)
               for (thing box) in names
               for now = (second (assoc thing after))
               count (and now (not (equal box now))))
         "names")))

(defun say-office (window simulation)
  (client:run-in-window window (lambda () (window::fit-whole-map (world-pane window))))
  (keep-travelling (first (run:simulation-robots simulation))
                   '((100 24) (20 10) (62 38) (30 28) (110 12)))
  (keep-travelling (second (run:simulation-robots simulation))
                   '((60 38) (15 24) (90 38) (30 28)))
  (sleep 3)
  (loop for (name . layers) in `(("office, 100 ticks/s, all names" :names
                                  ,@display:*window-layers*)
                                 ("office, 100 ticks/s, names of what moves"
                                  ,@display:*window-layers*)
                                 ("office, 100 ticks/s, no names"
                                  ,@(remove :mover-names display:*window-layers*)))
        do (client:run-in-window window
                                 (lambda ()
                                   (setf (window::preferences-layers
                                          (window::window-preferences window))
                                         layers)))
           (sleep 1)
           (say-names name window)))

(let* ((simulation (run:fresh-simulation '(ars-worlds:marvin ars-worlds:gofer) :seed 1)))
  (run:start-clock simulation :rate 100)
  (call-with-shown (lambda (window) (say-office window simulation))
                   (first (run:simulation-robots simulation)))
  (run:stop-clock simulation))

(let* ((simulation (run:fresh-simulation '(watched) :seed 1))
       (robot (first (run:simulation-robots simulation)))
       (movers (strew-movers (robot:robot-world robot))))
  (call-with-shown (lambda (window) (say-painting window movers)) robot)
  (move-every-tick movers)
  (run:start-clock simulation :rate 1000)
  (say "live, not shown, at 1000 ticks/s" (tick-rate simulation) "ticks/s")
  (call-with-shown (lambda (window) (say-living window simulation)) robot)
  (run:stop-clock simulation))
