;;;; plans-moving.lisp -- plans that drive: turns, doorways, whole ways, patrols.

;;; For any robot with an odometer and a camera. The plans do not use the positions of things. They
;;; recover from walls met, from people in the way and from doorways not seen, and fail only if
;;; there is no remedy. Only one plan at a time may drive a robot.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-macro (outcome ?command ?pulse ?result)
  "Issue COMMAND, wait for the fluent PULSE, and return the value of the fluent RESULT."
  `(seq ,command
        (wait-for ,pulse)
        (fluent-value ,result)))

(defvar driving-speed* .9
  "The speed at which the shipped plans drive, in metres per tick.")

;;; Single movements. They return an error code, or NIL for success.

(def-interp-proc turn-by (angle)
  "Turn the robot by ANGLE, in radians. Return an error code or NIL."
  (if (> (abs angle) .005)
      (outcome (rpl-robot-turn angle) robot-stopped* robot-movement-error*)
      nil))

(def-interp-proc drive-by (distance)
  "Drive DISTANCE metres ahead in whole ticks, up to DRIVING-SPEED*. Return an error code or NIL."
  (let ((ticks (max 1 (ceiling distance driving-speed*))))
    (rpl-robot-set-speed (/ distance ticks))
    (outcome (rpl-robot-go-forward ticks) robot-stopped* robot-movement-error*)))

(def-interp-proc turn-towards (me point)
  "Turn the robot of the reckoning ME to face POINT, a list (x y). Return an error code or NIL."
  (turn-by (angle-towards me point)))

(def-interp-proc stand-still ()
  "Stop the robot at once, whatever it is doing."
  (rpl-grab-robot)
  (wait-time 1))

;;; Looking at things. Checking: a thing that fits is found in more looks than one that does not.
;;; Each look adds to a score or subtracts from it, until the score decides.

(def-interp-proc look-for-things (camera type description)
  "Return a list of the designators of things that CAMERA sees in one look and that fit DESCRIPTION.
TYPE is :LOCAL or :NON-LOCAL."
  (outcome (rpl-camera-get-all-object-designators camera type description)
           (vref camera-input* camera) (vref camera-designators* camera)))

(def-interp-proc confirm-thing (camera description)
  "Look with CAMERA at local things until enough looks agree whether one of them fits DESCRIPTION.
Return a local designator of this thing, or NIL."
  (let ((score 0) (found nil))
    (loop UNTIL (or (>= score 5) (<= score -5))
      (let ((designators (look-for-things camera :local description)))
        (cond (designators (incf score 2) (setf found (first designators)))
              (t (decf score .5)))))
    (if (plusp score) found nil)))

;;; Obstacles. A closed door feels like a wall. In a world with doors, a camera looks which it is.

(defun doors-in-world-p (robot)
  "True if the world of ROBOT has doors: only that, not where they are, or whether they are closed."
  (some (lambda (thing) (get-attribute thing :door)) (world-thing-list (robot-world robot))))

(def-interp-proc notice-closed-door (me camera)
  "A wall has stopped the robot of the reckoning ME. If CAMERA sees a closed door beside the robot,
let ME believe that the nearest doorway, or the cell ahead, is closed. Return true if so."
  (reckon me)
  (let ((cell (or (doorway-nearby me) (cell-of-point (point-ahead me .6)))))
    (if (and (doors-in-world-p (rpl-robot))
             (confirm-thing camera '((:door #t) (:closed #t))))
        (seq (believe-closed me (adjoin (middle-of cell) (reckoning-closed me) :test #'equal))
             t)
        nil)))

(def-interp-proc feel-ahead (me &optional camera)
  "Drive slowly ahead to find what stopped the robot of the reckoning ME. If a wall did, correct ME;
if a thing did, remember it as an obstacle. Return :WALL, :THING, or NIL if nothing is ahead. With
CAMERA, return :DOOR if a closed door did, and remember the door."
  (rpl-robot-set-speed .1)
  (rpl-robot-goto-wall)
  (if (wait-for robot-stopped* :timeout 12)
      (cond ((fluent-value robot-movement-error*) (bar-cell-ahead me) :thing)
            ((and camera (notice-closed-door me camera)) :door)
            (t (reckon me) (correct-by-wall me) :wall))
      (seq (stand-still)
           (reckon me)
           nil)))

(def-interp-proc drive-towards (me point &optional camera)
  "Drive the robot of the reckoning ME straight to POINT. Return NIL, or what stopped the robot, as
FEEL-AHEAD does: :WALL, :THING or, with CAMERA, :DOOR."
  (turn-towards me point)
  (if (and (> (distance-left me point) .05)
           (drive-by (distance-left me point)))
      (feel-ahead me camera)
      nil))

;;; Doorways. A camera guides the robot into them, because the error of dead reckoning may be larger
;;; than a doorway is wide. Inside a doorway the robot corrects its position and heading.

(def-interp-proc look-for-places (camera type)
  "Return a list of the designators of the places of TYPE that CAMERA sees in one look."
  (outcome (rpl-camera-get-all-place-designators camera type)
           (vref camera-input* camera) (vref camera-designators* camera)))

(defun nearest-designator-ahead (designators)
  "Return the one of DESIGNATORS nearest to the robot's heading, within .7 radians, or NIL."
  (flet ((off (designator) (abs (angle-difference (!_angle designator) 0))))
    (let ((best (first (sort (copy-list designators) #'< :key #'off))))
      (and best (< (off best) .7) best))))

(def-interp-proc begin-track (camera designator)
  "Track DESIGNATOR with CAMERA. Return an error code, or NIL once the track has begun."
  (set-value (vref camera-tracking-error* camera) nil)
  (rpl-camera-track camera designator)
  (wait-for (or (vref camera-tracking* camera) (vref camera-tracking-error* camera)))
  (fluent-value (vref camera-tracking-error* camera)))

(def-interp-proc go-to-designated (camera designator &optional patience)
  "Drive the robot to DESIGNATOR, guided by CAMERA, for at most PATIENCE ticks, if given. Return an
error code, or NIL when the robot is there."
  (rpl-robot-set-speed driving-speed*)
  (or (begin-track camera designator)
      (seq (rpl-robot-goto-designator camera)
           (if (not (wait-for robot-stopped* :timeout patience))
               (stand-still))
           (let ((error (fluent-value robot-movement-error*)))
             (stop-track camera)
             error))))

(def-interp-proc stop-track (camera)
  "Stop the track of CAMERA, if any."
  (rpl-grab-camera camera)
  (wait-time 1))

(def-interp-proc find-doorway (camera)
  "Turn CAMERA ahead. Return a designator of the doorway that the robot faces, or NIL."
  (let ((found nil))
    (outcome (rpl-camera-align-robot camera)
             (vref camera-moved* camera) (vref camera-movement-error* camera))
    (n-times 3 UNTIL found
      (setf found (nearest-designator-ahead (look-for-places camera 'doorway))))
    found))

(def-interp-proc in-doorway-p ()
  "True if the robot's place sense reports a doorway, in one of two attempts."
  (let ((found nil))
    (n-times 2 UNTIL found
      (setf found (eq 'doorway (outcome (rpl-robot-place) robot-place-input* robot-place*))))
    found))

(def-interp-proc take-bearings (me)
  "Correct the reckoning ME if the robot senses a doorway and its map has one nearby. True if so."
  (let ((cell (doorway-nearby me)))
    (if (and cell (in-doorway-p))
        (seq (correct-by-cell me cell)
             (if (null (outcome (rpl-robot-align-place) robot-stopped* robot-movement-error*))
                 (correct-by-direction me cell))
             t)
        nil)))

(def-interp-proc pass-doorway (me camera cell beyond)
  "Drive the robot of the reckoning ME through the nearby doorway CELL to the point BEYOND. Return
NIL, or what stopped the robot, as FEEL-AHEAD does: :WALL, :THING or :DOOR."
  (turn-towards me (middle-of cell))
  (let ((doorway (find-doorway camera))
        (stopped nil))
    (if doorway
        (case (go-to-designated camera doorway
                                ;; There may be another doorway behind this one.
                                (+ 14 (* 1.3 (distance-left me (middle-of cell)))))
          (:robot-blocked (setf stopped (feel-ahead me camera))))
        (setf stopped (drive-towards me (middle-of cell) camera)))
    (if (null stopped)
        (seq (take-bearings me)
             (drive-towards me beyond camera))
        stopped)))

;;; Whole ways.

(defun camera-with-widest-view (robot)
  "Return ROBOT's camera with the widest field of view, or NIL if ROBOT has no camera."
  (let ((cameras (coerce (robot-cameras robot) 'list)))
    (and cameras
         (reduce (lambda (a b) (if (> (camera-field-of-view b) (camera-field-of-view a)) b a))
                 cameras))))

(defun widest-camera ()
  "Return the index of the camera that has the widest field of view on the plan's robot."
  (camera-index (camera-with-widest-view (rpl-robot))))

(def-interp-proc take-step-of-way (me camera step)
  "Do STEP, a step that NEXT-STEP has returned, with the robot of the reckoning ME. Return NIL, or
what stopped the robot, as FEEL-AHEAD does: :WALL, :THING or :DOOR."
  (if (eq :door (first step))
      (pass-doorway me camera (second step) (third step))
      (drive-towards me (second step) camera)))

(def-interp-proc turn-away (trouble)
  "Turn the robot and drive off, in another direction for each number TROUBLE."
  (turn-by (angle-difference (+ pi (* 2.4 trouble)) 0))
  (drive-by (+ 1 (mod trouble 3))))

(def-interp-proc get-free (me stopped)
  "Get the robot of the reckoning ME away from an obstacle. STOPPED is its kind: :WALL, :THING or
:DOOR. Wait for a thing to move away; every third time turn and drive off. In a world with several
robots, do what GIVE-WAY decides about a thing. The next way avoids a closed door."
  (let ((trouble (incf (reckoning-trouble me))))
    (cond ((eq stopped :door))
          ((and (eq stopped :thing) (meets-robots-p me))
           (wait-time (give-way me)))
          (t (if (eq stopped :thing)
                 (wait-time (* 3 (mod trouble 3))))
             (if (zerop (mod trouble 3))
                 (turn-away trouble))))
    (reckon me)))

(defun number-list-p (value count)
  (and (listp value) (eql count (list-length value)) (every #'realp value)))

(defun check-arguments (operator &rest arguments)
  "Signal WRONG-ARGUMENT for the first wrong one of ARGUMENTS, lists (fine-p name value expected)."
  (loop for (fine-p name value expected) in arguments
        unless fine-p do (ars-magna.base:reject-argument operator name value expected)))

(defun check-points (plan name points)
  (check-arguments plan (list (and (listp points) (list-length points)
                                   (every (lambda (point) (number-list-p point 2)) points))
                              name points "a list of points (x y), such as ((3 4) (5 6))")))

(defun check-tolerance-and-patience (operator tolerance patience)
  (check-arguments operator
                   (list (and (realp tolerance) (<= 0 tolerance)) ":tolerance" tolerance
                         "a number of metres, from 0")
                   (list (and (integerp patience) (plusp patience)) ":patience" patience
                         "a whole number, from 1")))

(def-interp-proc travel-to (me point &key (tolerance 1) (patience 40) (camera (widest-camera))
                               (closed '()))
  "Drive the robot of the reckoning ME to POINT, a list (x y), to within TOLERANCE metres, through
doorways and round obstacles, but not through the doors at CLOSED, a list of points. If a door turns
out to be closed, the robot goes another way. Return the estimated position. Fails with
:CANNOT-GET-THERE after PATIENCE obstacles or 300 steps, or at once if there is no way; its data
have as :CLOSED the points of all doors believed to be closed. Or fails with WRONG-ARGUMENT. If
other robots are in the way, the robot waits, plans another way or gives way to them."
  (check-arguments 'travel-to
                   (list (typep me 'reckoning) "me" me "a reckoning: see BEGIN-RECKONING")
                   (list (number-list-p point 2) "point" point "a list (x y) of numbers of metres"))
  (check-points 'travel-to ":closed" closed)
  (check-tolerance-and-patience 'travel-to tolerance patience)
  (believe-closed me closed)
  (evap-protect (travel-step-by-step me point tolerance patience camera)
                (show-way me '())))

(def-interp-proc travel-step-by-step (me point tolerance patience camera)
  "Do TRAVEL-TO, but still show the way in pictures afterwards."
  (let ((limit (+ patience (reckoning-trouble me)))
        (steps 0))
    (forget-passing-place me)
    (loop UNTIL (<= (distance-left me point) tolerance)
      (let ((step (next-step-of me (present-goal me point))))
        (incf steps)
        (if (or (null step) (> (reckoning-trouble me) limit) (> steps 300))
            (fail :class :cannot-get-there :point point :believed (reckon me)
                  :closed (reckoning-closed me)))
        (let ((stopped (take-step-of-way me camera step)))
          (if stopped (get-free me stopped)))
        (let ((ticks (ticks-at-passing-place me)))
          (if ticks (wait-time ticks)))))
    (reckon me)))

(def-interp-proc patrol-places (points &key (rounds 1) start)
  "Visit POINTS of the map in turn, ROUNDS times. START is the robot's position, a list (x y
heading), by default the true one. Unreachable points are left out. Return the number of visits."
  (check-points 'patrol-places 'points points)
  (with-valve ((rpl-robot-valve))
    (let ((me (begin-reckoning (or start (here (rpl-robot)))))
          (visits 0))
      (n-times rounds
        (dolist (point points)
          (handle-failure ((:cannot-get-there () (return nil)))
            (travel-to me point)
            (incf visits))))
      visits)))
