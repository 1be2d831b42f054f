;;;; plans-moving.lisp -- plans that drive: turns, doorways, whole ways, patrols.

;;; Good for any robot with an odometer and a camera; nothing here needs to know where things are.
;;; What goes wrong on the way -- a wall met, somebody in the way, a doorway not seen -- is
;;; recovered from; only what cannot be helped fails. One plan at a time may drive a robot.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-macro (outcome ?command ?pulse ?result)
  "Give COMMAND, wait for the fluent PULSE, and return the value of the fluent RESULT."
  `(seq ,command
        (wait-for ,pulse)
        (fluent-value ,result)))

(defvar driving-speed* .9
  "How fast the shipped plans drive, in metres per tick.")

;;; Single movements. They return an error code, or NIL for success.

(def-interp-proc turn-by (angle)
  "Turn the robot by ANGLE, in radians. Return an error code or NIL."
  (if (> (abs angle) .005)
      (outcome (rpl-robot-turn angle) robot-stopped* robot-movement-error*)
      nil))

(def-interp-proc drive-by (distance)
  "Drive DISTANCE metres straight ahead. Return an error code or NIL."
  (let ((ticks (max 1 (ceiling distance driving-speed*))))
    (rpl-robot-set-speed (/ distance ticks))
    (outcome (rpl-robot-go-forward ticks) robot-stopped* robot-movement-error*)))

(def-interp-proc turn-towards (me point)
  "Turn the robot of the reckoning ME to face POINT, a list (x y). Return an error code or NIL."
  (turn-by (angle-towards me point)))

(def-interp-proc stand-still ()
  "Let the robot stand at once, whatever it is doing."
  (rpl-grab-robot)
  (wait-time 1))

;;; Trouble.

(def-interp-proc feel-ahead (me)
  "Find out, slowly, what stopped the robot of ME, and remember it: return :WALL, :THING, or NIL if
nothing is there any more."
  (rpl-robot-set-speed .1)
  (rpl-robot-goto-wall)
  (if (wait-for robot-stopped* :timeout 12)
      (cond ((null (fluent-value robot-movement-error*)) (reckon me) (correct-by-wall me) :wall)
            (t (bar-ahead me) :thing))
      (seq (stand-still)
           (reckon me)
           nil)))

(def-interp-proc drive-towards (me point)
  "Drive the robot of ME straight to POINT. Return :WALL or :THING if that stopped it, or NIL."
  (turn-towards me point)
  (if (and (> (distance-left me point) .05)
           (drive-by (distance-left me point)))
      (feel-ahead me)
      nil))

;;; Doorways. A camera leads the robot into them: dead reckoning may be off by more than they are
;;; wide. Inside one, the robot knows again where it is and how it is turned.

(def-interp-proc look-for-places (camera type)
  "Return the designators of places of TYPE that CAMERA sees at once, a list."
  (outcome (rpl-camera-get-all-place-designators camera type)
           (vref camera-input* camera) (vref camera-designators* camera)))

(defun nearest-ahead (designators)
  "Return the one of DESIGNATORS nearest to the robot's heading, within a wide angle, or NIL."
  (flet ((off (designator) (abs (angle-difference (!_angle designator) 0))))
    (let ((best (first (sort (copy-list designators) #'< :key #'off))))
      (and best (< (off best) .7) best))))

(def-interp-proc begin-track (camera designator)
  "Let CAMERA track DESIGNATOR. Return an error code, or NIL once it does."
  (set-value (vref camera-tracking-error* camera) nil)
  (rpl-camera-track camera designator)
  (wait-for (or (vref camera-tracking* camera) (vref camera-tracking-error* camera)))
  (fluent-value (vref camera-tracking-error* camera)))

(def-interp-proc go-to-designated (camera designator &optional patience)
  "Let the robot go to what DESIGNATOR denotes, led by CAMERA, for PATIENCE ticks at most if that is
given. Return an error code, or NIL when it is there."
  (rpl-robot-set-speed driving-speed*)
  (or (begin-track camera designator)
      (seq (rpl-robot-goto-designator camera)
           (if (not (wait-for robot-stopped* :timeout patience))
               (stand-still))
           (let ((error (fluent-value robot-movement-error*)))
             (stop-track camera)
             error))))

(def-interp-proc stop-track (camera)
  "Let CAMERA track nothing."
  (rpl-grab-camera camera)
  (wait-time 1))

(def-interp-proc find-doorway (camera)
  "Return a designator of the doorway that the robot faces, or NIL."
  (let ((found nil))
    (outcome (rpl-camera-align-robot camera)
             (vref camera-moved* camera) (vref camera-movement-error* camera))
    (n-times 3 UNTIL found
      (setf found (nearest-ahead (look-for-places camera 'doorway))))
    found))

(def-interp-proc in-doorway-p ()
  "True if the robot senses that it is in a doorway, in one of two attempts."
  (let ((found nil))
    (n-times 2 UNTIL found
      (setf found (eq 'doorway (outcome (rpl-robot-place) robot-place-input* robot-place*))))
    found))

(def-interp-proc take-bearings (me)
  "Correct the reckoning ME of the robot, if that finds itself in a doorway near where one is on its
map. True if so."
  (let ((cell (doorway-nearby me)))
    (if (and cell (in-doorway-p))
        (seq (correct-by-cell me cell)
             (if (null (outcome (rpl-robot-align-place) robot-stopped* robot-movement-error*))
                 (correct-by-direction me cell))
             t)
        nil)))

(def-interp-proc pass-doorway (me camera cell beyond)
  "Drive the robot of ME, which is near it, through the doorway CELL to the point BEYOND. Return
:WALL or :THING if that stopped it, or NIL."
  (turn-towards me (middle-of cell))
  (let ((doorway (find-doorway camera))
        (stopped nil))
    (if doorway
        (case (go-to-designated camera doorway
                                ;; There may be another doorway behind this one.
                                (+ 14 (* 1.3 (distance-left me (middle-of cell)))))
          (:robot-blocked (setf stopped (feel-ahead me))))
        (setf stopped (drive-towards me (middle-of cell))))
    (if (null stopped)
        (seq (take-bearings me)
             (drive-towards me beyond))
        stopped)))

;;; Whole ways.

(defun widest-camera ()
  "Return the index of the camera of the plans' robot that sees widest."
  (let ((cameras (loop for camera below (rpl-robot-num-cameras) collect camera)))
    (reduce (lambda (a b)
              (if (> (rpl-camera-field-of-view b) (rpl-camera-field-of-view a)) b a))
            cameras)))

(def-interp-proc take-step-of-way (me camera step)
  "Let the robot of ME take STEP of its way. Return :WALL or :THING if that stopped it, or NIL."
  (if (eq :door (first step))
      (pass-doorway me camera (second step) (third step))
      (drive-towards me (second step))))

(def-interp-proc get-free (me stopped)
  "Get the robot of ME away from what STOPPED it: a wall, or a thing that may go away by itself."
  (let ((trouble (incf (reckoning-trouble me))))
    (if (eq stopped :thing)
        (wait-time (* 3 (mod trouble 3))))
    (if (zerop (mod trouble 3))
        ;; Never twice the same way.
        (seq (turn-by (angle-difference (+ pi (* 2.4 trouble)) 0))
             (drive-by (+ 1 (mod trouble 3)))))
    (reckon me)))

(defun coordinates-p (point)
  "True if POINT is a list (x y) of numbers."
  (and (listp point) (eql 2 (list-length point)) (every #'realp point)))

(defun check-points (plan name points)
  "Signal WRONG-ARGUMENT unless POINTS, what PLAN takes as NAME, is a list of points."
  (unless (and (listp points) (list-length points) (every #'coordinates-p points))
    (ars-magna.base:reject-argument plan name points
                                    "a list of points (x y), such as ((3 4) (5 6))")))

(defun check-travel (me point tolerance patience)
  "Signal WRONG-ARGUMENT about the first of these that TRAVEL-TO cannot use."
  (loop for (fine-p name value expected)
          in (list (list (typep me 'reckoning) "me" me "a reckoning: see BEGIN-RECKONING")
                   (list (coordinates-p point) "point" point "a list (x y) of numbers of metres")
                   (list (and (realp tolerance) (<= 0 tolerance)) ":tolerance" tolerance
                         "a number of metres, from 0")
                   (list (and (integerp patience) (plusp patience)) ":patience" patience
                         "a whole number, from 1"))
        unless fine-p
          do (ars-magna.base:reject-argument 'travel-to name value expected)))

(def-interp-proc travel-to (me point &key (tolerance 1) (patience 40) (camera (widest-camera)))
  "Bring the robot of the reckoning ME to POINT, a list (x y) on its map, as near as TOLERANCE
metres, through doorways and round obstacles. Fails with :CANNOT-GET-THERE after PATIENCE
troubles, or at once if there is no way, with a WRONG-ARGUMENT if an argument is none."
  (check-travel me point tolerance patience)
  (evap-protect (travel-step-by-step me point tolerance patience camera)
                (show-way me '())))

(def-interp-proc travel-step-by-step (me point tolerance patience camera)
  "Do as TRAVEL-TO does, and leave the way to be seen."
  (let ((limit (+ patience (reckoning-trouble me)))
        (steps 0))
    (loop UNTIL (<= (distance-left me point) tolerance)
      (let ((step (next-step-of me point)))
        (incf steps)
        (if (or (null step) (> (reckoning-trouble me) limit) (> steps 300))
            (fail :class :cannot-get-there :point point :believed (reckon me)))
        (let ((stopped (take-step-of-way me camera step)))
          (if stopped (get-free me stopped)))))
    (reckon me)))

(def-interp-proc patrol-places (points &key (rounds 1) start)
  "Let the robot visit POINTS of its map in turn, ROUNDS times. START is where it is, a list (x y
heading); by default it finds that out. What cannot be reached is left out. Return how many visits
it made."
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
