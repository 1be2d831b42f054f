;;;; approaching.lisp -- thousands of approaches in random rooms, all of which must arrive.

(in-package :ars-magna.tests)

(def-suite* approaching :in ars-magna)

;;; A setting is a room with walls and obstacles, a thing to go to, and the robot's start. All
;;; coordinates are rational, so the test can compute exactly which cells the straight way crosses,
;;; without the simulator's geometry. If these are free, the robot must arrive.

(defstruct (setting (:copier nil))
  "A room of WIDTH by HEIGHT: WALLS and OBSTACLES are lists of cells (x y); KIND is that of what
stands at TARGET, in a cell of its own."
  (seed 0 :type integer)
  (width 0 :type integer)
  (height 0 :type integer)
  (walls '() :type list)
  (obstacles '() :type list)
  (kind :lamp :type keyword)
  (target '(0 0) :type list)
  (start '(0 0) :type list)
  (heading 0 :type real)
  (speed 8/10 :type real))

(defun cell-of (point) (mapcar #'floor point))

;;; The judge.

(defun overlap (from to low)
  "Return the part of the way from FROM to TO that is between LOW and LOW + 1: a list (first last)
of fractions from 0 to 1, or NIL. A way along the border belongs to the cell behind it."
  (let ((way (- to from)))
    (if (zerop way)
        (and (<= low from) (< from (1+ low)) (list 0 1))
        (let ((ends (sort (list (/ (- low from) way) (/ (- (1+ low) from) way)) #'<)))
          (let ((first (max 0 (first ends))) (last (min 1 (second ends))))
            (and (<= first last) (list first last)))))))

(defun meeting (start target cell)
  "Return where on the way from START to TARGET one is in CELL: a list (first last), or NIL."
  (let ((x (overlap (first start) (first target) (first cell)))
        (y (overlap (second start) (second target) (second cell))))
    (when (and x y)
      (let ((first (max (first x) (first y))) (last (min (second x) (second y))))
        (and (<= first last) (list first last))))))

(defun straight-way-free-p (start target cells)
  "True if the way from START to TARGET crosses none of CELLS, and passes between no two of them
that touch."
  (let ((meetings (loop for cell in cells
                        for meeting = (meeting start target cell)
                        when meeting collect meeting)))
    (and (loop for (first last) in meetings always (= first last))
         (= (length meetings) (length (remove-duplicates meetings :test #'equal))))))

(defun edge-p (setting cell)
  (destructuring-bind (x y) cell
    (or (member x (list 0 (1- (setting-width setting))))
        (member y (list 0 (1- (setting-height setting)))))))

(defun free-setting-p (setting)
  "True if SETTING makes sense and nothing is in the robot's way."
  (let* ((start (setting-start setting)) (target (setting-target setting))
         (blocking (append (setting-walls setting) (setting-obstacles setting))))
    (flet ((free-p (cell)
             (and (not (edge-p setting cell))
                  (not (member cell blocking :test #'equal)))))
      (and (free-p (cell-of start))
           (free-p (cell-of target))
           (not (equal (cell-of start) (cell-of target)))
           ;; Walls all around the room: no straight way leaves it.
           (straight-way-free-p start target blocking)))))

;;; Settings by chance.

(defun random-coordinate (size dice)
  "Return a coordinate in a room of SIZE, in the middle of a cell, at a border, or anywhere."
  (let ((cell (1+ (base:roll-index (- size 2) dice))))
    (+ cell (ecase (base:roll-index 3 dice)
              (0 0)
              (1 1/2)
              (2 (/ (base:roll-index 1000 dice) 1000))))))

(defun random-cells (count setting dice)
  (loop repeat count
        collect (list (base:roll-index (setting-width setting) dice)
                      (base:roll-index (setting-height setting) dice))))

(defun random-point (setting dice)
  (list (random-coordinate (setting-width setting) dice)
        (random-coordinate (setting-height setting) dice)))

(defun random-start (setting dice)
  "Return any point, or one from which the target is straight ahead along an axis or a diagonal."
  (let ((point (random-point setting dice)))
    (destructuring-bind (x y) (setting-target setting)
      (case (base:roll-index 6 dice)
        (0 (list x (second point)))
        (1 (list (first point) y))
        (2 (list (first point) (+ y (- (first point) x))))
        (3 (list (first point) (- y (- (first point) x))))
        (t point)))))

(defun inside-setting-p (setting point)
  (and (< 0 (first point) (1- (setting-width setting)))
       (< 0 (second point) (1- (setting-height setting)))))

(defun random-setting (seed)
  "Return the setting that the integer SEED decides."
  (let* ((dice (base:make-dice seed "settings"))
         (setting (make-setting :seed seed
                                :width (+ 6 (base:roll-index 40 dice))
                                :height (+ 6 (base:roll-index 30 dice))
                                :kind (base:roll-element '(:lamp :table :post :chest :place) dice)
                                :heading (base:roll-element (list 0 (/ pi 2) pi (/ pi -2) 1 -2.65)
                                                            dice)
                                :speed (base:roll-element '(8/10 1 1/2 37/100 9/100) dice)))
         (count (base:roll-index (floor (* (setting-width setting) (setting-height setting)) 20)
                                 dice)))
    (setf (setting-walls setting) (random-cells count setting dice)
          (setting-obstacles setting) (random-cells (floor count 3) setting dice)
          (setting-target setting) (random-point setting dice)
          (setting-start setting) (random-start setting dice))
    (when (eq :place (setting-kind setting))
      (setf (setting-target setting)
            (mapcar (lambda (number) (+ 1/2 number)) (cell-of (setting-target setting)))))
    setting))

(defun free-settings (count &optional (seed 1))
  "Return the first COUNT settings, by seed, in which nothing is in the robot's way."
  (loop for number from seed
        for setting = (random-setting number)
        when (and (inside-setting-p setting (setting-start setting)) (free-setting-p setting))
          collect setting and count t into found
        until (= found count)))

;;; Building them.

(defun wall-clauses (setting)
  (cons `(rect (0 0) (,(1- (setting-width setting)) ,(1- (setting-height setting))) bricks 10)
        (loop for cell in (setting-walls setting) collect `(wall ,cell ,cell slate 20))))

(defun build-setting (setting)
  "Define the map and the robot of SETTING. Return the robot's name."
  (handler-bind ((warning #'muffle-warning))
    (world:define-map 'approach-room (setting-width setting) (setting-height setting)
      :clauses (wall-clauses setting) :package "ARS-MAGNA.TESTS")
    (robot:define-robot 'goer 'approach-room (setting-start setting) (setting-heading setting)
      :cameras (list (list (/ pi 2) 5) (list (/ pi 4) 3))))
  'goer)

(defun furnish (setting)
  "Put the obstacles of SETTING, posts and glass doors, where they belong."
  (loop for (x y) in (setting-obstacles setting) for opaque = nil then (not opaque)
        do (put 'obstacle (list (+ x 1/2) (+ y 1/2)) :obsmove t :obsview opaque)))

(defun denotation (setting)
  "Return what is to be gone to in SETTING: a new thing, or a place."
  (destructuring-bind (x y) (setting-target setting)
    (flet ((target (&rest attributes) (apply #'put 'target (list x y) attributes)))
      (ecase (setting-kind setting)
        (:lamp (target :size 1 :obsview t))
        (:table (target :size 14 :obsmove t))
        (:post (target :size 200 :obsmove t :obsview t))
        (:chest (target :size 20 :capacity 10 :weight 90))
        (:place (world:make-place (world:find-place-type 'world:doorway) 0d0
                                  (world:map-cell (world:world-map world:*world*)
                                                  (floor x) (floor y))))))))

;;; Going there.

(defun most-ticks (setting robot)
  "Return how many ticks an approach in SETTING takes at most: its delay, one for each step of
turning, one for each of driving, and one for what rounding leaves."
  (destructuring-bind ((x0 y0) (x1 y1)) (list (setting-start setting) (setting-target setting))
    (let ((turn (- (atan (float (- y1 y0) 1d0) (- x1 x0)) (setting-heading setting)))
          (way (sqrt (+ (expt (float (- x1 x0) 1d0) 2) (expt (- y1 y0) 2)))))
      (+ base:robot-move-delay*
         (ceiling (abs (- turn (* 2 pi (fround turn (* 2 pi))))) (robot:robot-turn-angle robot))
         (ceiling way (robot:robot-speed robot))
         1))))

(defun calls-of-approach (setting robot)
  "Let ROBOT track and go to what there is in SETTING. Return what was heard, oldest first: lists
(who tick code), and the designator."
  (let* ((target (denotation setting)) (camera (robot:robot-camera robot 0)) (heard '())
         (designator (robot:add-designator robot :denotation target)))
    (flet ((listener (who)
             (lambda (code &rest more)
               (declare (ignore more))
               (push (list who (run:simulation-tick) code) heard))))
      (command:camera-track camera designator (listener :track))
      (command:robot-set-speed robot (setting-speed setting))
      (run:run-ticks 6)
      (command:robot-goto-designator robot camera (listener :goto))
      (run:run-ticks 6)
      (loop repeat (* 20 (most-ticks setting robot))
            until (find :goto heard :key #'first)
            do (run:run-ticks 1))
      (values (reverse heard) designator))))

(defun found-locally-p (robot thing)
  "True if a search of ROBOT for what is local finds THING."
  (let ((found '()))
    (command:camera-get-all-object-designators (robot:robot-camera robot 0) :local '()
                                               (lambda (code camera designators)
                                                 (declare (ignore code camera))
                                                 (setf found designators)))
    (run:run-ticks 10)
    (find thing found :key #'robot:designator-denotation)))

(defun near-by-p (robot designator)
  "True if what DESIGNATOR denotes is local to ROBOT, by a search if it is a thing."
  (let ((target (robot:designator-denotation designator)))
    (if (world:thing-p target)
        (found-locally-p robot target)
        (multiple-value-call #'robot:within-reach-p robot
          (robot:designator-position designator)))))

(defun troubles-of-approach (setting &rest options)
  "Run SETTING in a simulation with OPTIONS. Return a list of what is wrong with its approach."
  (let ((robot (build-setting setting)))
    (run:call-with-simulation
     (lambda ()
       (furnish setting)
       (let ((robot (symbol-value robot)) (clean base:no-sensor-error*))
         (multiple-value-bind (heard designator) (calls-of-approach setting robot)
           (let ((goto (find :goto heard :key #'first)))
             (append
              (unless (equal '((:track nil) (:goto nil) (:track :lost-track))
                             (loop for (who nil code) in heard collect (list who code)))
                (list (cons :heard heard)))
              (when (and goto clean (> (- (second goto) 6) (most-ticks setting robot)))
                (list (list :late goto (most-ticks setting robot))))
              (when (or (robot:camera-tracks (robot:robot-camera robot 0))
                        (robot:designator-valid-p designator))
                (list :still-tracked))
              (unless (or (not clean) (near-by-p robot designator))
                (list :not-local)))))))
     (list robot) :seed (setting-seed setting) :clean (getf options :clean)
     :parameters (getf options :parameters))))

(defparameter *noise-of-motion-and-angles*
  '((prob-lose-track* 0) (false-thing-prob* 0))
  "The parameters of a noisy world where nothing is lost by mere chance.")

(defun failed-approaches (settings &rest options)
  "Return a list of those of SETTINGS whose approach goes wrong, each with what is wrong."
  (loop for setting in settings
        for troubles = (apply #'troubles-of-approach setting options)
        when troubles collect (cons setting troubles)))

(test approach.always-arrives-in-a-clean-world
  (is (equal '() (failed-approaches (free-settings 300) :clean t))))

(test approach.almost-always-arrives-in-a-noisy-world
  (is (<= (length (failed-approaches (free-settings 200)
                                     :parameters *noise-of-motion-and-angles*))
          2)))

;;; What moves.

(world:defkicker wander (thing) (:prob 1/2)
  (flet ((step-length () (base:roll-within 1/4 (world:world-dice world:*world* :user))))
    (world:kick-thing thing (step-length) (step-length) t)))

(defun wanderers-met (count &rest options)
  "Return how many of COUNT robots reach what wanders about a bare room, in 300 ticks."
  (loop for setting in (free-settings count 9000)
        count (let ((heard '()))
                (setf (setting-walls setting) '())
                (run:call-with-simulation
                 (lambda ()
                   (let* ((robot (symbol-value 'goer)) (camera (robot:robot-camera robot 0))
                          (thing (world:make-new-thing
                                  'wanderer (cons world:*world* (setting-target setting)) '()
                                  :kickers '(wander))))
                     (robot:start-track camera (robot:add-designator robot :denotation thing) nil)
                     (command:robot-goto-designator robot camera
                                                    (lambda (&rest call) (push call heard)))
                     (run:run-ticks 300)))
                 (list (build-setting setting))
                 :seed (setting-seed setting) :clean (getf options :clean)
                 :parameters (getf options :parameters))
                (equal '(nil) (mapcar #'first heard)))))

(test approach.reaches-what-wanders
  (is (= 40 (wanderers-met 40 :clean t)))
  (is (<= 39 (wanderers-met 40 :parameters *noise-of-motion-and-angles*))))

(test approach.is-repeated-from-a-journal
  (let ((setting (first (free-settings 1 77))))
    (run:call-with-simulation
     (lambda ()
       (furnish setting)
       (let* ((robot (symbol-value 'goer)) (camera (robot:robot-camera robot 0)) (code :none))
         (put 'target (setting-target setting) :color 'world:red)
         (apply #'robot:place-robot robot
                (append (setting-start setting)
                        (list (straight-to (setting-start setting) (setting-target setting)))))
         (command:camera-get-object-designator
          camera :non-local '((:color red))
          (lambda (err camera designator)
            (unless err
              (command:camera-track camera designator)
              (command:robot-goto-designator robot camera
                                             (lambda (err &rest more)
                                               (declare (ignore more))
                                               (setf code err))))))
         (run:run-ticks 15)
         ;; A copy, made on the way, goes the same way.
         (let ((copy (run:fork-simulation time:*simulation*)))
           (run:run-ticks 200)
           (is (null code))
           (run:run-ticks 200 copy)
           (is (= (run:state-digest) (run:state-digest copy))))
         (is (= (run:state-digest)
                (nth-value 1 (run:replay (end-journal time:*simulation*)))))))
     (list (build-setting setting)) :clean t :journal t)))

(test goto.loses-what-another-robot-takes-into-its-hand
  "To all others a hand hides what it holds: they can no longer track, approach or find it."
  (with-own-definitions
    (eval '(world:defmap lot (12 12) (obj cone (8.5 5.5) ((:size 1) (:color red)))))
    (eval '(robot:defrobot seeker (lot (2.5 5.5) 0) :cameras ((2 9))))
    (eval '(robot:defrobot taker (lot (8.5 6.5) 0) :hands (10)))
    (run:with-simulation ((seeker taker) :clean t)
      (destructuring-bind (seeker taker) (run:simulation-robots time:*simulation*)
        (let ((camera (robot:robot-camera seeker 0)) (codes '()))
          (flet ((search-for-cone ()
                   (run:run-ticks 1)
                   (end-code 'command:camera-get-object-designator camera :non-local
                                 '((:color red)))))
            (is (null (search-for-cone)))
            (command:camera-track camera (first (robot:live-designators seeker)))
            (command:robot-goto-designator seeker camera
                                           (lambda (code &rest ignore)
                                             (declare (ignore ignore))
                                             (push code codes)))
            (run:run-ticks 8)
            (world:move-thing (world:find-thing 'cone) (robot:robot-hand taker 0))
            (run:run-ticks 30)
            (is (equal '(:not-tracking) codes))
            (is (eq :designator-not-found (search-for-cone)))))))))
