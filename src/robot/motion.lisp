;;;; motion.lisp -- one tick of driving, coasting or turning (manual 3.5, chapter 4).

(in-package :ars-magna.robot)

(export '(set-robot-pose set-robot-angle drive-tick turn-tick robot-speed-now standing-p
          longest-step step-now robot-turn-angle-now begin-movement robot-last-move
          robot-last-move-estimate robot-cell-index))

(define-constant +straight+ 1d-12
  :documentation "A component of a heading that is nearer to 0 is rounding, and taken for 0.")

(declaim (inline component))
(defun component (number)
  "Return NUMBER, a component of a heading; 0 if it is so small that only rounding can be behind it.
So a robot can drive along the border of two cells, and stay in one of them."
  (declare (type double-float number))
  (if (< (abs number) +straight+) 0d0 number))

(defun set-robot-angle (robot angle)
  "Turn ROBOT to the heading ANGLE, in radians, at once; its odometers do not notice."
  (let ((angle (double angle)))
    (when (plusp (length (robot-designators robot)))
      (turn-designators robot (- angle (robot-angle robot))))
    (setf (robot-angle robot) angle
          (robot-cos robot) (component (cosine angle))
          (robot-sin robot) (component (sine angle))))
  robot)

(defun set-robot-pose (robot x y &optional (angle (robot-angle robot)))
  "Put ROBOT at (X,Y), in metres, heading ANGLE, at once; its odometers do not notice."
  (setf (robot-x robot) (double x)
        (robot-y robot) (double y)
        (robot-start-x robot) (robot-x robot)
        (robot-start-y robot) (robot-y robot)
        (robot-estimate-x robot) 0d0
        (robot-estimate-y robot) 0d0
        (robot-put-x robot) (robot-x robot)
        (robot-put-y robot) (robot-y robot))
  (incf (robot-placements robot))
  (set-robot-angle robot angle))

(defun robot-cell-index (robot)
  "Return the index of the cell that ROBOT is in, or NIL if it has been put outside the map."
  (map-index (world-map (robot-world robot)) (robot-x robot) (robot-y robot)))

;; Speeds this low are lost in the rounding of positions.
(define-constant +standstill+ 1d-12
  :documentation "A robot that is slower, in metres per tick, does not move.")

(declaim (inline robot-speed-now))
(defun robot-speed-now (robot)
  "Return the speed of ROBOT within MAX-SPEED* as it is now, in metres per tick (reading 93)."
  (min (robot-speed robot) (double max-speed*)))

(declaim (inline step-now))
(defun step-now (robot)
  "Return how far ROBOT means to drive in a tick at its speed, in metres."
  (* (the double-float (robot-speed-now robot)) (double tick-quantum*)))

(declaim (inline standing-p))
(defun standing-p (robot)
  "True if ROBOT cannot drive because its speed is 0, or next to it."
  (< (the double-float (robot-speed-now robot)) +standstill+))

(defun longest-step (robot)
  "Return how far ROBOT can come in a tick at most, in metres."
  (* (step-now robot) (+ 1d0 (double motion-noise*))))

(defun robot-turn-angle-now (robot)
  "Return the turn angle of ROBOT within its limits as they are now, in radians per tick."
  (max (double min-turn-angle*) (min (robot-turn-angle robot) (double max-turn-angle*))))

;;; Driving and turning.

(defun begin-movement (robot)
  "Let the last movement of ROBOT begin here."
  (setf (robot-start-x robot) (robot-x robot)
        (robot-start-y robot) (robot-y robot)
        (robot-estimate-x robot) 0d0
        (robot-estimate-y robot) 0d0))

(defun robot-last-move (robot)
  "Return how far the last movement has taken ROBOT, in x and in y, in metres (reading 200)."
  (values (- (robot-x robot) (robot-start-x robot))
          (- (robot-y robot) (robot-start-y robot))))

(defun robot-last-move-estimate (robot)
  "Return how far ROBOT believes that its last movement has taken it, in x and in y."
  (values (robot-estimate-x robot) (robot-estimate-y robot)))

(declaim (inline count-distance))
(defun count-distance (robot low high)
  "Tell the odometers of ROBOT that it drove between LOW and HIGH metres, both negative if it drove
backwards."
  (declare #.*hot* (type robot robot) (type double-float low high))
  (dolist (odometer (robot-odometer-list robot))
    (odometer-drive odometer low high))
  (let ((estimate (* 0.5d0 (+ low high))))
    (incf (robot-estimate-x robot) (* estimate (robot-cos robot)))
    (incf (robot-estimate-y robot) (* estimate (robot-sin robot)))))

(defun drive-tick (robot &optional (limit +endless+))
  "Drive ROBOT for one tick at its speed, but not much more than LIMIT metres; backwards if LIMIT is
negative. Return :WALL or :THING if that blocked it, else NIL. The distance is uniform within
MOTION-NOISE* of the speed; the odometers read an interval that contains it (reading 96)."
  (declare #.*hot* (type robot robot) (type double-float limit))
  (let* ((world (robot-world robot))
         (step (step-now robot))
         (nominal (max (- step) (min limit step)))
         (noise (noise-of-step motion-noise* (abs nominal) (robot-speed-now robot)))
         (distance (* nominal (+ 1d0 (* noise (- (* 2d0 (roll (world-dice world :motion)))
                                                 1d0)))))
         (block (sweep robot distance))
         (moved (abs (robot-moved robot)))
         (expected (if block moved (abs nominal)))
         (dice (world-dice world :odometry))
         (low (- moved (* (roll dice) (max 0d0 (- moved (* expected (- 1d0 noise)))))))
         (high (+ moved (* (roll dice) (max 0d0 (- (* expected (+ 1d0 noise)) moved))))))
    (declare (type double-float noise step nominal distance moved expected low high))
    (setf (robot-drove-tick robot) (world-tick world))
    (if (minusp nominal)
        (count-distance robot (- high) (- low))
        (count-distance robot low high))
    block))

(defun turn-tick (robot angle)
  "Turn ROBOT for one tick by about ANGLE, in radians: uniform within ROBOT-TURN-MAX-ERROR* of
it. The interval that the odometers read is left in ROBOT-TURNED-LOW and -HIGH."
  (let* ((world (robot-world robot))
         (size (abs (double angle)))
         (noise (noise-of-step robot-turn-max-error* size (robot-turn-angle-now robot)))
         (turned (* size (+ 1d0 (roll-within noise (world-dice world :motion)))))
         (dice (world-dice world :odometry))
         (low (- turned (* (roll dice) (max 0d0 (- turned (* size (- 1d0 noise)))))))
         (high (+ turned (* (roll dice) (max 0d0 (- (* size (+ 1d0 noise)) turned))))))
    (when (minusp angle)
      (psetf turned (- turned) low (- high) high (- low)))
    (set-robot-angle robot (+ (robot-angle robot) turned))
    (setf (robot-turned-low robot) low
          (robot-turned-high robot) high)
    (dolist (odometer (robot-odometer-list robot))
      (odometer-turn odometer low high)))
  robot)
