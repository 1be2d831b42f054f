;;;; motion.lisp -- one tick of driving, coasting or turning (manual 3.5, chapter 4).

(in-package :ars-magna.robot)

(export '(set-robot-pose set-robot-angle drive-tick turn-tick robot-speed-now speed-zero-p
          longest-step tick-distance robot-turn-angle-now record-movement-start robot-last-move
          robot-last-move-estimate robot-cell-index drives-robot-p robot-in-way))

;;; Motion is swept: the robot passes through each cell between its position and its target, and
;;; stops just short of the first that blocks. Its own cell never blocks, so a thing that moves
;;; there cannot trap it. The world's flags say which cells block. If the robot would enter a cell
;;; by less than the contact gap, it only touches it and continues. A robot whose way is barred by
;;; others that have yet to drive in this tick lets these go first. A robot that waits so is not
;;; waited for: robots that would change places, or follow one another in a circle, are blocked.

(declaim (inline cell-obstacle))
(defun cell-obstacle (flag)
  "Return what keeps a robot out of a cell with FLAG: :WALL, also for a closed door, :THING or NIL
(reading 101)."
  (declare (type (unsigned-byte 8) flag))
  (cond ((logtest flag +wall-or-door+) :wall)
        ((logtest flag +obsmove+) :thing)))

;; Inline, so that no float has to be boxed on the way. A position on a border belongs to the cell
;; behind it when moving right or down, and to the cell before it when moving left or up.
(declaim (inline free-distance))
(defun free-distance (world x y dx dy distance)
  "Return five values for the way from (X,Y), a point of the map, in direction (DX,DY): its free
length, at most DISTANCE; the column and row of the cell at its end; the obstacle, :WALL, :THING or
NIL; and whether the obstacle is in another column."
  (declare (type world world) (type double-float x y dx dy distance))
  (let* ((map (world-map world)) (flags (world-flags world))
         (cell-x (column-or-row x)) (cell-y (column-or-row y))
         (back-x (minusp dx)) (back-y (minusp dy))
         (step-x (if back-x -1 1)) (step-y (if back-y -1 1))
         (done nil) (block nil) (sideways nil)
         (at (walk-cells-on-line (lambda (index at column)
                                   (cond ((and (>= at distance)
                                               (or (> at distance) (if column back-x back-y)))
                                          (setf done t))
                                         ((setf block (cell-obstacle (aref flags index)))
                                          (setf sideways column)
                                          t)
                                         (t (if column
                                                (incf cell-x step-x)
                                                (incf cell-y step-y))
                                            nil)))
                                 (map-width map) (map-height map) x y dx dy +no-limit+ t)))
    (declare (type fixnum cell-x cell-y) (type double-float at))
    (if (or done (< distance at))
        (values distance cell-x cell-y nil nil)
        (values at cell-x cell-y (or block :wall)
                (if block
                    sideways
                    (<= (abs (- (+ x (* dx at)) (if back-x 0 (map-width map))))
                        (abs (- (+ y (* dy at)) (if back-y 0 (map-height map))))))))))

(defgeneric drives-robot-p (event)
  (:documentation "EVENT is pending on a robot. True if EVENT may drive the robot.")
  (:method (event)
    (declare (ignore event))
    nil))

(defun drive-early (robot)
  "If ROBOT has yet to drive in this tick, let it drive now. Return true if so."
  (let ((event (resource-event robot)) (agenda (timeline-agenda (timeline-of robot))))
    (when (and event (due-event-p agenda event) (drives-robot-p event))
      (run-early agenda event)
      t)))

(declaim (inline carry-body))
(defun carry-body (robot)
  "Move the body of ROBOT, if it has one, to the position of ROBOT."
  (let ((body (robot-body robot)))
    (when body (move-body body (robot-x robot) (robot-y robot)))))

(defun let-others-go-first (robot x y)
  "Let robots in the cell that holds (X,Y), which bar the way of ROBOT, drive now if they have yet
to drive in this tick. Return true if there were any. ROBOT must then look for its way again."
  (let* ((world (robot-world robot)) (index (map-index (world-map world) x y)) (robots '()))
    (when index
      (do-cell-bodies (body index world)
        (when (thing-obsmove-p body) (push (body-robot body) robots)))
      ;; ROBOT may have passed a corner already.
      (when robots (carry-body robot))
      (some #'identity (mapcar #'drive-early (nreverse robots))))))

(defun let-others-leave-corner (robot x y column row)
  "If ROBOT, in the cell at COLUMN and ROW, could pass a corner at (X,Y) but for robots in the cell
beyond, call LET-OTHERS-GO-FIRST for these and return its value."
  (let ((world (robot-world robot)))
    (multiple-value-bind (beyond-x beyond-y) (point-beyond-corner world +blocking+ x y column row)
      (and beyond-x
           (blocked-cell-p world beyond-x beyond-y +blocking+)
           (let-others-go-first robot beyond-x beyond-y)))))

(defun robot-in-way (robot)
  "Return the robot whose body is in a cell that ROBOT touches ahead, and blocks ROBOT; or NIL."
  (let* ((reach (* 2 +contact-gap+)) (x (robot-x robot)) (y (robot-y robot))
         (next-x (+ x (* reach (signum (robot-cos robot)))))
         (next-y (+ y (* reach (signum (robot-sin robot)))))
         (map (world-map (robot-world robot))))
    (loop for (x y) in (list (list next-x y) (list x next-y) (list next-x next-y))
          for other = (and (not (eql (map-index map x y) (robot-cell-index robot)))
                           (robot-at (robot-world robot) x y))
          when (and other (thing-obsmove-p (robot-body other))) return other)))

(defun pass-corner (robot x y column row)
  "If only a corner at (X,Y) blocks ROBOT, which is in the cell at COLUMN and ROW, move ROBOT past
the corner. Return true if ROBOT moved."
  (let ((world (robot-world robot)))
    (multiple-value-bind (beyond-x beyond-y) (point-beyond-corner world +blocking+ x y column row)
      (unless (or (null beyond-x)
                  (blocked-cell-p world beyond-x beyond-y +blocking+))
        (setf (robot-x robot) beyond-x
              (robot-y robot) beyond-y)))))

(defun only-touches-p (direction left)
  "True if a move by LEFT metres covers at most the contact gap along an axis. DIRECTION is the
component of the robot's heading along this axis."
  (<= (* left (abs direction)) +contact-gap+))

(defun may-cross-border-p (position cell direction left)
  "True if a robot at POSITION on an axis may be moved over the nearest border of cells: the robot
moves towards or along it. CELL is the robot's column or row; LEFT metres are to go."
  (cond ((zerop direction) (/= position (fround position)))
        ((only-touches-p direction left) t)
        ((= cell (round position)) (minusp direction))
        (t (plusp direction))))

(declaim (inline move-within-cells move-through-cells))
(defun move-within-cells (robot dx dy moved cell-x cell-y &optional (from-x cell-x) (from-y cell-y))
  "Move ROBOT by MOVED metres in direction (DX,DY), but not out of the cells from FROM- to CELL-."
  (declare (type robot robot) (type double-float dx dy moved) (type fixnum from-x from-y))
  (setf (robot-x robot) (clip-to-cell (+ (robot-x robot) (* dx moved))
                                      (min from-x cell-x) (max from-x cell-x))
        (robot-y robot) (clip-to-cell (+ (robot-y robot) (* dy moved))
                                      (min from-y cell-y) (max from-y cell-y))
        (robot-moved robot) moved))

(defun move-through-cells (robot world dx dy distance)
  "Move ROBOT, in the map of WORLD, by DISTANCE in direction (DX,DY), or to an obstacle. Store the
metres moved in ROBOT-MOVED. Return the obstacle, :WALL, :THING or NIL."
  (declare (type robot robot) (type world world) (type double-float dx dy distance))
  (multiple-value-bind (moved cell-x cell-y block sideways)
      (free-distance world (robot-x robot) (robot-y robot) dx dy distance)
    (declare (type double-float moved))
    (cond (block
           (meet-obstacle robot block dx dy moved (- distance moved) cell-x cell-y sideways))
          (t (move-within-cells robot dx dy moved cell-x cell-y)
             nil))))

(defun meet-obstacle (robot block dx dy moved left cell-x cell-y sideways)
  "ROBOT has moved MOVED metres and has LEFT to go. Stop ROBOT before the obstacle BLOCK, which is
in the next column if SIDEWAYS, else in the next row. If ROBOT only touches the obstacle, continue.
Return the obstacle that stops ROBOT, or NIL."
  (let* ((x (+ (robot-x robot) (* dx moved))) (y (+ (robot-y robot) (* dy moved)))
         (crosses (if sideways
                      (may-cross-border-p y cell-y dy left)
                      (may-cross-border-p x cell-x dx left))))
    (cond ((only-touches-p (if sideways dx dy) left)
           (move-within-cells robot dx dy moved cell-x cell-y)
           (if sideways
               (continue-move robot 0d0 dy left moved)
               (continue-move robot dx 0d0 left moved)))
          ((and (robot-body robot)
                (or (and (eq block :thing)
                         (let-others-go-first robot
                           (+ 0.5d0 cell-x (if sideways (signum dx) 0))
                           (+ 0.5d0 cell-y (if sideways 0 (signum dy)))))
                    (and crosses (let-others-leave-corner robot x y cell-x cell-y))))
           (continue-move robot dx dy (+ moved left) 0d0))
          ((and crosses (pass-corner robot x y cell-x cell-y))
           (continue-move robot dx dy left moved))
          (t (move-within-cells robot dx dy (max 0d0 (- moved +contact-gap+)) cell-x cell-y
                                (floor-to-fixnum (robot-x robot))
                                (floor-to-fixnum (robot-y robot)))
             block))))

(defun continue-move (robot dx dy distance moved)
  "Call MOVE-THROUGH-CELLS for ROBOT, which has moved MOVED metres; add these to ROBOT-MOVED."
  (prog1 (move-through-cells robot (robot-world robot) dx dy distance)
    (incf (robot-moved robot) moved)))

(defun leave-cell (robot)
  "Move ROBOT out of its cell along its heading by ROBOT-MOVED metres, backwards if negative, or to
an obstacle. Store the metres moved in ROBOT-MOVED. Return the obstacle, :WALL, :THING or NIL. A
robot outside the map does not move."
  (declare #.*hot* (type robot robot))
  (let ((world (robot-world robot)) (dx (robot-cos robot)) (dy (robot-sin robot))
        (distance (robot-moved robot)))
    (declare (type world world))
    (cond ((null (point-index (world-map world) (robot-x robot) (robot-y robot)))
           (setf (robot-moved robot) 0d0)
           :wall)
          ((minusp distance)
           (prog1 (move-through-cells robot world (- 0d0 dx) (- 0d0 dy) (- distance))
             (setf (robot-moved robot) (- (robot-moved robot)))))
          (t (move-through-cells robot world dx dy distance)))))

(declaim (inline move-along-heading))
(defun move-along-heading (robot distance)
  "Move ROBOT along its heading by DISTANCE, backwards if negative, or to an obstacle. Store the
metres moved in ROBOT-MOVED. Return the obstacle, :WALL, :THING or NIL (reading 100)."
  (declare #.*hot* (type robot robot) (type double-float distance))
  (let* ((x (robot-x robot)) (y (robot-y robot))
         (cell-x (floor-to-fixnum x)) (cell-y (floor-to-fixnum y))
         (new-x (+ x (* (robot-cos robot) distance)))
         (new-y (+ y (* (robot-sin robot) distance))))
    (declare (type double-float new-x new-y))
    (setf (robot-moved robot) distance)
    (cond ((and (= (floor-to-fixnum new-x) cell-x) (= (floor-to-fixnum new-y) cell-y))
           (setf (robot-x robot) new-x (robot-y robot) new-y)
           nil)
          (t (leave-cell robot)))))

;;; The heading, the pose and the speed.

(declaim (inline snap-heading-component))
(defun snap-heading-component (number)
  "Return NUMBER, a component of a heading, or 0 if NUMBER is as small as a rounding error. So a
robot can drive along the border of two cells and stay in one cell."
  (declare (type double-float number))
  (if (< (abs number) 1d-12) 0d0 number))

(defun set-robot-angle (robot angle)
  "Turn ROBOT to the heading ANGLE, in radians, at once; its odometers do not change."
  (let ((angle (double angle)))
    ;; Designators keep their directions in the world, but for those at the robot's own position.
    (loop for designator across (robot-designators robot)
          when (and designator (designator-bearing-p designator))
            do (decf (designator-angle designator) (- angle (robot-angle robot))))
    (setf (robot-angle robot) angle
          (robot-cos robot) (snap-heading-component (cosine angle))
          (robot-sin robot) (snap-heading-component (sine angle))))
  robot)

(defun set-robot-pose (robot x y &optional (angle (robot-angle robot)))
  "Put ROBOT at (X,Y), in metres, heading ANGLE, at once; its odometers do not change."
  (setf (robot-x robot) (double x)
        (robot-y robot) (double y)
        (robot-start-x robot) (robot-x robot)
        (robot-start-y robot) (robot-y robot)
        (robot-estimate-x robot) 0d0
        (robot-estimate-y robot) 0d0
        (robot-put-x robot) (robot-x robot)
        (robot-put-y robot) (robot-y robot))
  (incf (robot-placements robot))
  (carry-body robot)
  (set-robot-angle robot angle))

(defun robot-cell-index (robot)
  "Return the index of the cell that ROBOT is in, or NIL if ROBOT is outside the map."
  (map-index (world-map (robot-world robot)) (robot-x robot) (robot-y robot)))

(declaim (inline robot-speed-now tick-distance speed-zero-p))
(defun robot-speed-now (robot)
  "Return the speed of ROBOT, at most the current MAX-SPEED*, in metres per tick (reading 93)."
  (min (robot-speed robot) (double max-speed*)))

(defun tick-distance (robot)
  "Return the distance, in metres, that ROBOT drives in a tick at its speed, without noise."
  (* (the double-float (robot-speed-now robot)) (double tick-quantum*)))

(defun speed-zero-p (robot)
  "True if ROBOT cannot drive because its speed is 0 or almost 0."
  ;; Speeds this low are lost in the rounding of positions.
  (< (the double-float (robot-speed-now robot)) 1d-12))

(defun longest-step (robot)
  "Return the greatest distance, in metres, that ROBOT can drive in a tick."
  (* (tick-distance robot) (+ 1d0 (double motion-noise*))))

(defun robot-turn-angle-now (robot)
  "Return the turn angle of ROBOT, in radians per tick, from MIN-TURN-ANGLE* to MAX-TURN-ANGLE*."
  (max (double min-turn-angle*) (min (robot-turn-angle robot) (double max-turn-angle*))))

;;; Driving and turning.

(defun record-movement-start (robot)
  "Record that a new movement of ROBOT starts here."
  (setf (robot-start-x robot) (robot-x robot)
        (robot-start-y robot) (robot-y robot)
        (robot-estimate-x robot) 0d0
        (robot-estimate-y robot) 0d0))

(defun robot-last-move (robot)
  "Return the distances in x and in y, in metres, of the last movement of ROBOT (reading 200)."
  (values (- (robot-x robot) (robot-start-x robot))
          (- (robot-y robot) (robot-start-y robot))))

(defun robot-last-move-estimate (robot)
  "Return the robot's estimate of the distances of its last movement, in x and in y, in metres."
  (values (robot-estimate-x robot) (robot-estimate-y robot)))

(declaim (inline add-distance-to-odometers))
(defun add-distance-to-odometers (robot low high)
  "Add a distance from LOW to HIGH metres, negative if backwards, to the odometers of ROBOT."
  (declare #.*hot* (type robot robot) (type double-float low high))
  (dolist (odometer (robot-odometer-list robot))
    (add-drive-to-odometer odometer low high))
  (let ((estimate (* 0.5d0 (+ low high))))
    (incf (robot-estimate-x robot) (* estimate (robot-cos robot)))
    (incf (robot-estimate-y robot) (* estimate (robot-sin robot)))))

(defun drive-tick (robot &optional (limit +infinite-distance+))
  "Drive ROBOT for one tick at its speed, by at most LIMIT metres before noise; backwards if LIMIT
is negative. Return the obstacle, :WALL or :THING, if ROBOT was blocked, else NIL. The distance is
uniformly distributed within MOTION-NOISE* of the speed; the odometers read an interval that
contains the distance (reading 96)."
  (declare #.*hot* (type robot robot) (type double-float limit))
  (let* ((world (robot-world robot))
         (base (robot-dice-base robot))
         (step (tick-distance robot))
         (nominal (max (- step) (min limit step)))
         (noise (noise-of-step motion-noise* (abs nominal) (robot-speed-now robot)))
         (distance (* nominal (+ 1d0 (* noise (- (* 2d0 (roll (dice-at world base :motion)))
                                                 1d0)))))
         (block (move-along-heading robot distance))
         (moved (abs (robot-moved robot)))
         (expected (if block moved (abs nominal)))
         (dice (dice-at world base :odometry))
         (low (- moved (* (roll dice) (max 0d0 (- moved (* expected (- 1d0 noise)))))))
         (high (+ moved (* (roll dice) (max 0d0 (- (* expected (+ 1d0 noise)) moved))))))
    (declare (type double-float noise step nominal distance moved expected low high))
    (carry-body robot)
    (setf (robot-drove-tick robot) (world-tick world))
    (if (minusp nominal)
        (add-distance-to-odometers robot (- high) (- low))
        (add-distance-to-odometers robot low high))
    block))

(defun turn-tick (robot angle)
  "Turn ROBOT for one tick by about ANGLE, in radians; the true angle is uniformly distributed
within ROBOT-TURN-MAX-ERROR* of ANGLE. Store the bounds of the interval that the odometers read in
ROBOT-TURNED-LOW and ROBOT-TURNED-HIGH."
  (let* ((size (abs (double angle)))
         (noise (noise-of-step robot-turn-max-error* size (robot-turn-angle-now robot)))
         (turned (* size (+ 1d0 (roll-within noise (robot-dice robot :motion)))))
         (dice (robot-dice robot :odometry))
         (low (- turned (* (roll dice) (max 0d0 (- turned (* size (- 1d0 noise)))))))
         (high (+ turned (* (roll dice) (max 0d0 (- (* size (+ 1d0 noise)) turned))))))
    (when (minusp angle)
      (psetf turned (- turned) low (- high) high (- low)))
    (set-robot-angle robot (+ (robot-angle robot) turned))
    (setf (robot-turned-low robot) low
          (robot-turned-high robot) high)
    (dolist (odometer (robot-odometer-list robot))
      (add-turn-to-odometer odometer low high)))
  robot)
