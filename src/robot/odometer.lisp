;;;; odometer.lisp -- odometers, and the place that a robot senses (manual 2.2, 3.2.2).

(in-package :ars-magna.robot)

(export '(odometer-estimate robot-place-here sense-place-type canonical-directions
          nearest-direction))

;;; An odometer is dead reckoning with intervals. It starts at (0,0) with heading 0 when reset, so
;;; the x axis of its positions is the heading then. Each step adds an interval that contains the
;;; true movement, so the sum contains the true position. The bounds of the cosine and sine of the
;;; heading change only when the robot turns. Sums are widened by more than their rounding error.

(public odometer)
(addition odometer-p)
(define-kind (odometer :constructor (%make-odometer (robot name)))
    "An uncertain estimate of the robot's position and heading since the last reset (manual 3.2.2)."
  (:fixed
   (robot nil (or null robot) "the robot of the odometer" :export)
   (name nil symbol "the symbol that names the odometer" :addition))
  (:state
   (x-min 0d0 double-float "the least x, in metres") (x-max 0d0 double-float "the greatest x")
   (y-min 0d0 double-float "the least y, in metres") (y-max 0d0 double-float "the greatest y")
   (angle-min 0d0 double-float "the least angle, in radians")
   (angle-max 0d0 double-float "the greatest angle, in radians")
   (cos-min 1d0 double-float "the least cosine of the heading")
   (cos-max 1d0 double-float "the greatest cosine of the heading")
   (sin-min 0d0 double-float "the least sine of the heading")
   (sin-max 0d0 double-float "the greatest sine of the heading"))
  ;; The true position and heading at the last reset; for displays.
  (:memory
   (origin-x 0d0 double-float "the robot's true x when the position was last reset, in metres")
   (origin-y 0d0 double-float "the robot's true y when the position was last reset, in metres")
   (origin-angle 0d0 double-float
                 "the robot's true heading when the angle was last reset, in radians" :export)))

(defmethod copy-plan-value ((odometer odometer) fork)
  (copy-robot-object odometer (odometer-robot odometer) fork))

(defmethod reference ((odometer odometer))
  (list :odometer (string (robot-name (odometer-robot odometer)))
        (string (odometer-name odometer))))

(defun odometer-estimate (odometer)
  "Return the robot's position on the map according to ODOMETER, the middle of its interval: x and y
in metres, and the heading in radians. For displays and ROBOT-STEP; programs cannot know it."
  (let* ((x (* 0.5d0 (+ (odometer-x-min odometer) (odometer-x-max odometer))))
         (y (* 0.5d0 (+ (odometer-y-min odometer) (odometer-y-max odometer))))
         (axis (odometer-origin-angle odometer))
         (cos (cosine axis)) (sin (sine axis)))
    (values (+ (odometer-origin-x odometer) (- (* cos x) (* sin y)))
            (+ (odometer-origin-y odometer) (+ (* sin x) (* cos y)))
            (+ axis (* 0.5d0 (+ (odometer-angle-min odometer) (odometer-angle-max odometer)))))))

(defmethod print-object ((odometer odometer) stream)
  (print-named odometer stream (format nil "Odometer ~A" (odometer-name odometer))))

(declaim (inline includes-angle-p))
(defun includes-angle-p (angle low high)
  "True if ANGLE plus a multiple of 2 pi is between LOW and HIGH."
  (declare (type double-float angle low high))
  (let* ((gap (- low angle))
         (turns (if (< (abs gap) 1d15)
                    (ceiling (the (double-float -1d15 1d15) (/ gap 2pi)))
                    (ceiling (/ gap 2pi)))))
    (<= (+ angle (* turns 2pi)) high)))

(defun refresh-direction-bounds (odometer)
  (declare #.*hot* (type odometer odometer))
  (let ((low (odometer-angle-min odometer))
        (high (odometer-angle-max odometer))
        (slack 1d-15))
    (flet ((bounds (a b top bottom)
             (values (if (includes-angle-p bottom low high) -1d0 (max -1d0 (- (min a b) slack)))
                     (if (includes-angle-p top low high) 1d0 (min 1d0 (+ (max a b) slack))))))
      (declare (inline bounds))
      (setf (values (odometer-cos-min odometer) (odometer-cos-max odometer))
            (bounds (cosine low) (cosine high) 0d0 pi)
            (values (odometer-sin-min odometer) (odometer-sin-max odometer))
            (bounds (sine low) (sine high) (/ pi 2) (/ pi -2))))))

(declaim (inline rounding-bound add-drive-to-odometer))
(defun rounding-bound (value)
  "Return an upper bound for the rounding error in a sum whose result is VALUE."
  (declare (type double-float value))
  (+ 1d-14 (* 1d-15 (abs value))))

(defmacro widen-interval (low-place low high-place high)
  "Add the interval from LOW to HIGH to that from LOW-PLACE to HIGH-PLACE, rounding outwards."
  `(progn
     (let ((sum (+ ,low-place ,low))) (setf ,low-place (- sum (rounding-bound sum))))
     (let ((sum (+ ,high-place ,high))) (setf ,high-place (+ sum (rounding-bound sum))))))

(defun add-drive-to-odometer (odometer low high)
  "Add a drive of LOW to HIGH metres along the heading to ODOMETER. For a drive backwards, LOW and
HIGH are negative (reading 97)."
  (declare (type odometer odometer) (type double-float low high))
  (labels ((least (factor) (* factor (if (minusp factor) high low)))
           (most (factor) (* factor (if (minusp factor) low high)))
           (count-by (least-cos most-cos least-sin most-sin)
             (widen-interval (odometer-x-min odometer) (least least-cos)
                             (odometer-x-max odometer) (most most-cos))
             (widen-interval (odometer-y-min odometer) (least least-sin)
                             (odometer-y-max odometer) (most most-sin))))
    (declare (inline least most count-by))
    (let ((cos-min (odometer-cos-min odometer)) (cos-max (odometer-cos-max odometer))
          (sin-min (odometer-sin-min odometer)) (sin-max (odometer-sin-max odometer)))
      (if (minusp low)
          (count-by cos-max cos-min sin-max sin-min)
          (count-by cos-min cos-max sin-min sin-max)))))

(defun add-turn-to-odometer (odometer low high)
  (declare (type double-float low high))
  (widen-interval (odometer-angle-min odometer) low (odometer-angle-max odometer) high)
  (refresh-direction-bounds odometer))

;;; Functions for programs.

(defun check-odometer (odometer operator)
  (unless (odometer-p odometer)
    (reject-argument operator "odometer" odometer
                     "an odometer, as (robot-main-odometer ROBOT) returns")))

(defun reset-reading (odometer part)
  "Reset PART of ODOMETER, :POS or :ANG (reading 98)."
  (let ((robot (odometer-robot odometer)))
    (ecase part
      (:pos (setf (odometer-x-min odometer) 0d0 (odometer-x-max odometer) 0d0
                  (odometer-y-min odometer) 0d0 (odometer-y-max odometer) 0d0
                  (odometer-origin-x odometer) (robot-x robot)
                  (odometer-origin-y odometer) (robot-y robot)))
      (:ang (setf (odometer-angle-min odometer) 0d0 (odometer-angle-max odometer) 0d0
                  (odometer-origin-angle odometer) (robot-angle robot))
       (refresh-direction-bounds odometer)))))

(public get-odometer-pos)
(defun get-odometer-pos (odometer &optional interval)
  "Return a PT-INTERVAL that contains the robot's position, in metres, relative to the point where
ODOMETER was last reset. The x axis is the robot's heading at that reset. INTERVAL, a PT-INTERVAL,
is modified and returned if given (manual 3.2.2)."
  (check-odometer odometer 'get-odometer-pos)
  (check-argument get-odometer-pos interval (typep interval '(or null pt-interval))
                  "a PT-INTERVAL to modify")
  (set-pt-interval! (or interval (make-pt-interval (make-interval 0 0) (make-interval 0 0)))
                    (odometer-x-min odometer) (odometer-x-max odometer)
                    (odometer-y-min odometer) (odometer-y-max odometer)))

(public get-odometer-ang)
(defun get-odometer-ang (odometer &optional interval)
  "Return an INTERVAL that contains the angle turned, in radians, since ODOMETER was last reset.
INTERVAL, if given, is modified and returned (manual 3.2.2)."
  (check-odometer odometer 'get-odometer-ang)
  (check-argument get-odometer-ang interval (typep interval '(or null interval))
                  "an INTERVAL to modify")
  (set-interval! (or interval (make-interval 0 0))
                 (odometer-angle-min odometer) (odometer-angle-max odometer)))

(defun add-odometer (robot name)
  (let ((odometer (%make-odometer robot name)))
    (reset-reading odometer :pos)
    (reset-reading odometer :ang)
    (setf (robot-odometer-list robot)
          (append (remove name (robot-odometer-list robot)
                          :key #'odometer-name :test #'same-name-p)
                  (list odometer)))
    odometer))

(public robot-odometers)
(defun robot-odometers (robot)
  "Return a list of the odometers of ROBOT, oldest first (manual 3.2.2)."
  (check-argument robot-odometers robot (robot-p robot) (argument-type-text 'robot robot))
  (copy-list (robot-odometer-list robot)))

(public robot-odometer)
(defun robot-odometer (robot name)
  "Return the odometer of ROBOT named NAME, or NIL (manual 3.2.2). Signals WRONG-ARGUMENT unless
NAME is a symbol or a string."
  (check-argument robot-odometer name (typep name '(or symbol string)) "an odometer's name")
  (find name (robot-odometers robot) :key #'odometer-name :test #'same-name-p))

(public robot-main-odometer)
(defun robot-main-odometer (robot)
  "Return the odometer that ROBOT started with, which is named MAIN (manual 3.2.2; reading 232)."
  (robot-odometer robot 'main))

;;; The place that a robot senses (manual 3.4.3, 3.5).

(defun robot-place-here (robot)
  "Return the PLACE that ROBOT is really in, or NIL. A cell with a closed door is no place."
  (let* ((world (robot-world robot)) (map (world-map world))
         (index (map-index map (robot-x robot) (robot-y robot))))
    (unless (and index (logtest +closed-door+ (aref (world-flags world) index)))
      (cell-type (map-cell map (robot-x robot) (robot-y robot))))))

(defun sense-place-type (robot)
  "Return the place type that ROBOT senses where it is, or NIL. The true type is missed with the
probability TYPE-FALSE-NEG*. Where there is no place, a random type is sensed with the probability
TYPE-FALSE-POS* (reading 221)."
  (let ((place (robot-place-here robot))
        (dice (robot-dice robot :place)))
    (cond (no-sensor-error* (and place (place-type place)))
          (place (unless (chance type-false-neg* dice) (place-type place)))
          ((chance type-false-pos* dice)
           (let ((types (remove nil (map-place-types (world-map (robot-world robot))))))
             (and (plusp (length types)) (roll-element types dice)))))))

(defun canonical-directions (robot type)
  "Return a list of the two canonical directions, in radians, that ROBOT's cell has as a place of
TYPE. In a cell without a place, both directions are the robot's heading (reading 223)."
  (let ((place (robot-place-here robot)))
    (if place
        (multiple-value-list
         (place-directions (make-place type (place-canonical-dir place) (place-cell place))))
        (list (robot-angle robot) (robot-angle robot)))))

(defun nearest-direction (directions heading)
  "Return the angle in the list DIRECTIONS that differs least from HEADING (reading 73)."
  (flet ((turn-to (direction) (abs (angle-difference direction heading))))
    (first (stable-sort (copy-list directions) #'< :key #'turn-to))))
