;;;; driving.lisp -- going forward, to walls and along them, and stopping (manual 3.5).

(in-package :ars-magna.command)

;;; Each movement begins after ROBOT-MOVE-DELAY*, takes at least a tick, and ends in the tick of its
;;; last step, without braking. An interruption ends it at once, too, but after ROBOT-STOP the robot
;;; coasts. What is left of a movement, in ticks or metres, is negative if it goes backwards.

(declaim (inline reduce-towards-zero drive-remaining-time drive-remaining-distance
                 drive-finished-p))
(defun reduce-towards-zero (number amount least)
  "Return NUMBER moved towards 0 by AMOUNT, or 0 if at most LEAST would remain."
  (declare (type double-float number amount least))
  (let ((rest (- (abs number) amount)))
    (if (<= rest least) 0d0 (float-sign number rest))))

(defun drive-remaining-time (operation)
  "Drive the robot of OPERATION for a tick, or for the remaining time of OPERATION if shorter.
Return the value of DRIVE-TICK."
  (let* ((robot (operation-resource operation))
         (left (operation-left operation))
         (quantum (double tick-quantum*)))
    (declare (type double-float left quantum))
    (setf (operation-left operation) (reduce-towards-zero left quantum 0d0))
    ;; A computed limit is allocated, so there is one in the last tick only.
    (cond ((< (abs left) quantum)
           (drive-tick robot (* left (the double-float (robot-speed-now robot)))))
          ((minusp left) (drive-tick robot (- +infinite-distance+)))
          (t (drive-tick robot)))))

(defun drive-remaining-distance (operation)
  "Drive the robot of OPERATION for a tick, at most OPERATION's remaining metres. See DRIVE-TICK."
  (let* ((robot (operation-resource operation))
         (left (operation-left operation)))
    ;; What rounding leaves is not driven.
    (setf (operation-left operation) (reduce-towards-zero left (tick-distance robot) 1d-9))
    (drive-tick robot left)))

(defun drive-finished-p (operation)
  (zerop (operation-left operation)))

(defmacro with-drive-tick ((block operation &optional drive) &body body)
  "Drive the robot of OPERATION for a tick: call DRIVE with OPERATION or, without DRIVE, call
DRIVE-TICK. Run BODY with BLOCK bound to the robot's obstacle, :WALL, :THING or NIL. Continue in the
next tick unless BODY has ended OPERATION. Fails with :NOT-MOVING if the speed is 0."
  `(let ((robot (operation-resource ,operation)))
     (declare #.*hot* (type operation ,operation) (type robot robot))
     (if (speed-zero-p robot)
         (fail-with ,operation :not-moving)
         (let ((,block ,(if drive `(,drive ,operation) '(drive-tick robot))))
           ,@body
           (unless (operation-finished-p ,operation) (repeat-step ,operation))))))

;; Only another robot is named: what things and walls are is for cameras to find out.
(defmethod error-cause-text ((code (eql :robot-blocked)) operation)
  (let ((other (robot-in-way (operation-resource operation))))
    (and other (format nil "~A is in the way" other))))

(define-step drive-a-while (operation (robot-p (operation-resource operation)))
  "Drive the robot for a tick, and end OPERATION when its time is over."
  (with-drive-tick (block operation drive-remaining-time)
    (cond (block (fail-with operation :robot-blocked))
          ((drive-finished-p operation) (succeed operation)))))

(define-step drive-to-wall (operation (robot-p (operation-resource operation)))
  "Drive the robot for a tick, and end OPERATION at a wall."
  (with-drive-tick (block operation)
    (case block
      (:wall (succeed operation))
      (:thing (fail-with operation :robot-blocked)))))

(define-step coast (operation (robot-p (operation-resource operation)))
  "Drive the robot for a tick. OPERATION succeeds in its last tick, at an obstacle or at speed 0."
  (if (speed-zero-p (operation-resource operation))
      (succeed operation)
      (with-drive-tick (block operation drive-remaining-time)
        (when (or block (drive-finished-p operation)) (succeed operation)))))

;; See reading 233.
(define-command robot-go-forward (operation (robot robot)
                                  (time ticks "for how many ticks"))
    ()
    ((:family :moving) (:section "3.5") (:delay robot-move-delay*)
     (:traits :drives) (:expected :robot-blocked)
     (:errors (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot stopped"))
    "Drive ROBOT straight ahead for TIME ticks. With TIME 0 or less, the command succeeds at once."
  (setf (operation-left operation) (double (ceiling time)))
  (cond ((plusp (operation-left operation))
         (record-movement-start robot)
         (go-on-now operation 'drive-a-while))
        (t (succeed operation))))

;;; A distance instead of a time: the last step is shorter; the robot's speed setting is unchanged.

(define-argument-type 'distance
  (lambda (value) (and (realp value) (< 0 value) (<= value 1000000)))
  "a number of metres, more than 0, at most a million")

(define-step drive-the-rest (operation (robot-p (operation-resource operation)))
  "Drive the robot for a tick, and end OPERATION when no metres are left."
  (with-drive-tick (block operation drive-remaining-distance)
    (cond (block (fail-with operation :robot-blocked))
          ((drive-finished-p operation) (succeed operation)))))

(define-command robot-go-distance (operation (robot robot)
                                   (metres distance "how far"))
    ()
    ((:family :moving) (:section "3.5") (:prompt "GO") (:delay robot-move-delay*)
     (:traits :drives)
     (:errors (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot stopped"))
    "Drive ROBOT straight ahead for METRES at its current speed. ROBOT-GO-FORWARD drives for ticks."
  (setf (operation-left operation) (double metres))
  (record-movement-start robot)
  (go-on-now operation 'drive-the-rest))

;; The manual has none.
(addition (robot-go-distance :ars :nisp))

;; See reading 102.
(define-command robot-goto-wall (operation (robot robot))
    ()
    ((:family :moving) (:section "3.5") (:delay robot-move-delay*)
     (:traits :drives) (:expected :robot-blocked)
     (:errors (:robot-blocked "Robot is blocked by something that is no wall")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot is at a wall"))
    "Drive ROBOT straight ahead until it meets a wall or the edge of the map."
  (record-movement-start robot)
  (go-on-now operation 'drive-to-wall))

;; A stop that interrupts another continues it. The robot coasts backwards if it went so.
(defmethod record-interrupted-operation ((name (eql 'robot-stop)) operation rival)
  (call-next-method)
  (let ((command (operation-command rival)) (left (operation-left rival)))
    (cond ((eq name (command-name command))
           (setf (operation-subject operation) (operation-subject rival)
                 (operation-left operation) left))
          ((and (trait-p :drives command) (minusp left))
           (setf (operation-left operation) (- (double braking*)))))))

(defun driving-p (robot)
  "True if ROBOT has driven in the previous or the current tick."
  (>= (robot-drove-tick robot) (1- (world-tick (robot-world robot)))))

;; A robot that stops may coast.
(defmethod drives-robot-p ((operation operation))
  (let ((command (operation-command operation)))
    (or (trait-p :drives command)
        (trait-p :stops command)
        (eq 'robot-goto-designator (command-name command)))))

;; See reading 95.
(define-command robot-stop (operation (robot robot))
    ()
    ((:family :moving) (:section "3.5") (:delay 1) (:traits :stops)
     (:report () "Robot stopped"))
    "Stop ROBOT. A driving robot coasts for BRAKING* ticks first; another ROBOT-STOP adds none."
  (when (zerop (operation-left operation))
    (setf (operation-left operation) (double braking*)))
  (cond ((and (operation-subject operation) (driving-p robot) (plusp braking*))
         (record-movement-start robot)
         (go-on-now operation 'coast))
        (t (succeed operation))))

;;; The manual only mentions this command (appendix C); its meaning is ours. The wall is the nearest
;;; of the four neighbouring cells of the robot that are walls; those at the side take precedence
;;; over the one ahead. The robot keeps it on the side where it was.

(defun nearest-axis (angle)
  "Return the axis of the grid nearest to ANGLE, as a number of quarter turns from 0 to 3."
  (mod (round (/ angle (/ pi 2))) 4))

(defun neighbour-wall-p (robot quarter)
  "True if a wall or a closed door is next to ROBOT's cell in direction QUARTER, in quarter turns
from the x axis."
  (destructuring-bind (dx . dy) (svref #((1 . 0) (0 . 1) (-1 . 0) (0 . -1)) (mod quarter 4))
    (blocked-cell-p (robot-world robot) (+ (robot-x robot) dx) (+ (robot-y robot) dy)
                    +wall-or-door+)))

(defun distance-to-side (robot quarter)
  "Return ROBOT's distance from the side of its cell in direction QUARTER, as in NEIGHBOUR-WALL-P."
  (let ((x (mod (robot-x robot) 1d0)) (y (mod (robot-y robot) 1d0)))
    (ecase (mod quarter 4) (0 (- 1 x)) (1 (- 1 y)) (2 x) (3 y))))

(defun wall-to-follow (robot)
  "Return the direction of a wall next to ROBOT and the heading along this wall, both in quarter
turns; or NIL if there is no wall."
  (let* ((heading (nearest-axis (robot-angle robot)))
         (sides (remove-if-not (lambda (quarter) (neighbour-wall-p robot quarter))
                               (list (1+ heading) (1- heading))))
         (side (first (sort sides #'< :key (lambda (quarter) (distance-to-side robot quarter))))))
    (cond (side (values side heading))
          ;; Ahead of the robot: turn right, so that the wall is at the left.
          ((neighbour-wall-p robot heading) (values heading (1+ heading))))))

(defun drive-along-wall (operation robot side)
  (ecase (drive-tick robot)
    (:wall (succeed operation))
    (:thing (fail-with operation :robot-blocked))
    ((nil) (if (neighbour-wall-p robot side)
               (repeat-step operation)
               (succeed operation)))))

(define-step follow-on (operation (and (robot-p (operation-resource operation))
                                       (typep (operation-subject operation)
                                              '(cons integer (cons integer null)))))
  "Follow a wall for a tick. The subject of OPERATION lists the direction of the wall and the
heading along it, in quarter turns."
  (let ((robot (operation-resource operation)))
    (destructuring-bind (side heading) (operation-subject operation)
      (cond ((not (turn-towards robot
                                (angle-difference (* heading (/ pi 2)) (robot-angle robot)) 1d-3))
             (repeat-step operation))
            ((speed-zero-p robot) (fail-with operation :not-moving))
            (t (drive-along-wall operation robot side))))))

;; See reading 107.
(define-command robot-follow-wall (operation (robot robot))
    ()
    ((:family :moving) (:section "C") (:delay robot-move-delay*)
     (:traits :drives) (:expected :robot-blocked)
     (:errors (:robot-blocked "Robot is blocked by something that is no wall")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report () "Robot is at the end of the wall"))
    "Drive ROBOT along the nearest wall next to it until the wall ends or a corner is reached.
Without a wall next to ROBOT, the command succeeds at once."
  (record-movement-start robot)
  (let ((way (multiple-value-list (wall-to-follow robot))))
    (setf (operation-subject operation) way)
    (if (first way)
        (go-on-now operation 'follow-on)
        (succeed operation))))
