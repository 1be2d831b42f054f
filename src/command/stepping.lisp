;;;; stepping.lisp -- going to a neighbouring cell, for programs that treat the map as a grid.

(in-package :ars-magna.command)

;;; ROBOT-STEP turns the robot, and then drives it to the middle of a neighbouring cell. Every step
;;; that succeeds takes STEP-DURATION* ticks: if the movement takes less, the robot stands still for
;;; the rest. Noise is that of turns and drives. The direction is aimed from where the robot is
;;; according to its main odometer or, if STEP-BY-GRID* is true, from where it is.

(defparameter *step-directions*
  '((:north 0 -1) (:north-east 1 -1) (:east 1 0) (:south-east 1 1)
    (:south 0 1) (:south-west -1 1) (:west -1 0) (:north-west -1 -1))
  "Lists (direction columns rows). North is up in pictures, where y is less.")

(defun find-step-direction (name)
  "Return the list in *STEP-DIRECTIONS* for NAME, a symbol or string, or NIL."
  (or (assoc name *step-directions* :test #'eq)
      (and (typep name '(or symbol string))
           (find name *step-directions* :key #'first :test #'same-name-p))))

(define-argument-type 'direction #'find-step-direction
  (one-line "a direction: north, north-east, east, south-east, south, south-west, west or
north-west"))

(defun keyword-of-direction (robot direction)
  "Return the arguments of ROBOT-STEP to keep: DIRECTION as a keyword."
  (declare (ignore robot))
  (list (first (find-step-direction direction))))

(deftype step-subject ()
  "The subject of a step: the radians left to turn, and the tick in which the step is to end."
  '(cons double-float (cons tick-count null)))

(defun aim-step (robot direction)
  "Return the angle, in radians, and then the distance, in metres, by which ROBOT must turn and
drive to the middle of the next cell in DIRECTION."
  (multiple-value-bind (x y heading)
      (if step-by-grid*
          (values (robot-x robot) (robot-y robot) (robot-angle robot))
          (odometer-estimate (robot-main-odometer robot)))
    (declare (type (double-float -1d15 1d15) x y))
    (destructuring-bind (columns rows) (rest (find-step-direction direction))
      (declare (type (integer -1 1) columns rows))
      (let* ((dx (- (+ (floor x) columns 0.5d0) x))
             (dy (- (+ (floor y) rows 0.5d0) y))
             (angle (angle-difference (atan2 dy dx) heading)))
        (declare (type double-float angle))
        (values (if (< (abs angle) +facing+) 0d0 angle)
                (sqrt (the (double-float 0d0) (+ (* dx dx) (* dy dy)))))))))

(defun ticks-to-cover (size step)
  "Return how many ticks a movement of SIZE takes, if it covers at most STEP in a tick."
  (declare (type double-float size step))
  (cond ((zerop size) 0)
        ((<= size step) 1)
        (t (values (ceiling size step)))))

(defun time-to-move (robot angle distance)
  "Return how many ticks, without noise, ROBOT needs to turn by ANGLE and then to drive DISTANCE."
  (+ (ticks-to-cover (abs angle) (* (robot-turn-angle-now robot) (double tick-quantum*)))
     (ticks-to-cover distance (tick-distance robot))))

(defun end-step (operation tick)
  "End OPERATION, whose robot has arrived, in TICK."
  (let ((rest (- tick (agenda-tick (operation-agenda operation)))))
    (if (plusp rest)
        (go-on operation 'succeed rest)
        (succeed operation))))

(defun turn-for-step (operation robot angle end)
  (let ((left (turn-step robot angle)))
    (setf (operation-subject operation) (list (if (< (abs left) +facing+) 0d0 left) end))
    (repeat-step operation)))

(defun drive-for-step (operation end)
  (let ((block (drive-remaining-distance operation)))
    (cond (block (fail-with operation :robot-blocked))
          ((drive-finished-p operation) (end-step operation end))
          (t (repeat-step operation)))))

(define-step step-on (operation (and (robot-p (operation-resource operation))
                                     (typep (operation-subject operation) 'step-subject)))
  "Turn the robot for a tick or, if no angle is left, drive it for a tick."
  (let ((robot (operation-resource operation)))
    (destructuring-bind (angle end) (operation-subject operation)
      (cond ((/= 0 angle) (turn-for-step operation robot angle end))
            ((speed-zero-p robot) (fail-with operation :not-moving))
            (t (drive-for-step operation end))))))

(defun begin-step (operation robot direction step)
  "Let OPERATION, of ROBOT, begin a step in DIRECTION with the function named STEP."
  (record-movement-start robot)
  (if (speed-zero-p robot)
      (fail-with operation :not-moving)
      (multiple-value-bind (angle distance) (aim-step robot direction)
        (cond ((> (time-to-move robot angle distance) (ticks-for step-duration*))
               (fail-with operation :too-slow))
              (t (setf (operation-left operation) distance
                       (operation-subject operation)
                       (list angle (+ (agenda-tick (operation-agenda operation))
                                      (ticks-for step-duration*)
                                      -1)))
                 (go-on-now operation step))))))

(define-command robot-step (operation (robot robot)
                            (direction direction "where to go; north is up in pictures"))
    ()
    ((:family :moving) (:prompt "STEP-TO") (:delay 1) (:traits :drives)
     (:arguments keyword-of-direction)
     (:errors (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0")
              (:too-slow "Robot cannot turn and drive a cell in the time of a step"))
     (:report () (phrase "Robot stepped ~(~A~)" (first (operation-arguments operation)))))
    "Turn ROBOT and drive it to the middle of the next cell in DIRECTION. A step takes
STEP-DURATION* ticks, whatever its direction. The robot aims by its main odometer or, if
STEP-BY-GRID* is true, by where it is."
  (begin-step operation robot direction 'step-on))

;; The manual has none.
(addition (robot-step :ars :nisp))
