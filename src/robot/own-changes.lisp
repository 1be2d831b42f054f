;;;; own-changes.lisp -- what programs change on a robot without a command (3.2.2, E).

(in-package :ars-magna.robot)

(export '(robot-remaining-way))

;;; The simulator sees single commands; only the program knows where they lead. The planned way
;;; affects nothing: it is not in a run's digest or journal. It belongs to the run; forks and saved
;;; runs have it. It is a list (INTERRUPTION (x y)...): INTERRUPTION is the robot's last
;;; interruption when the way was published. After another interruption the way is no longer valid.

(defun point-coordinates (point)
  (if (pt-p point)
      (list (pt-x point) (pt-y point))
      (list (double (first point)) (double (second point)))))

(addition publish-way)
(defun publish-way (robot points)
  "Show ROBOT's way through POINTS in pictures, in the layer :PLANNED-WAY. POINTS is a list of PTs
or lists (x y), as from FIND-WAY; () removes the way. The way is shown until you publish another or
a command of the robot is interrupted. ROBOT-GO-TO and TRAVEL-TO call PUBLISH-WAY. ROBOT does not
move; digests and journals do not change. Return ROBOT. Signals WRONG-ARGUMENT."
  (check-argument publish-way robot (robot-p robot) (argument-type-text 'robot robot))
  (check-argument publish-way points
                  (proper-list-of-p (lambda (point) (or (pt-p point) (number-pair-p point))) points)
                  "a list of PTs, or of lists (x y)")
  (setf (robot-published-way robot)
        (and points
             (cons (resource-interruption robot) (mapcar #'point-coordinates points))))
  robot)

(addition robot-planned-way)
(defun robot-planned-way (robot)
  "Return the points, lists (x y), of the way that PUBLISH-WAY has set for ROBOT; () if there is no
way, or if a command of ROBOT has been interrupted since."
  (let ((way (robot-published-way robot)))
    (and way
         (eq (first way) (resource-interruption robot))
         (rest way))))

;;; The remaining way.

(defun nearest-point-on-segment (from to x y)
  "Return the point (x y) nearest to X, Y on the line from FROM to TO, and its distance from X, Y."
  (destructuring-bind (x1 y1 x2 y2) (append from to)
    (let* ((dx (- x2 x1)) (dy (- y2 y1))
           (square (+ (* dx dx) (* dy dy)))
           (part (if (zerop square)
                     0
                     (clamp (/ (+ (* (- x x1) dx) (* (- y y1) dy)) square) 0 1)))
           (foot (list (+ x1 (* part dx)) (+ y1 (* part dy)))))
      (values foot (abs (complex (- x (first foot)) (- y (second foot))))))))

(defun remaining-points (points x y)
  (let ((least nil) (left points))
    (loop for (from . after) on points
          while after
          do (multiple-value-bind (foot distance) (nearest-point-on-segment from (first after) x y)
               (when (or (null least) (<= distance least))
                 (setf least distance
                       left (cons foot after)))))
    left))

(defun robot-remaining-way (robot)
  "Return the remaining points, lists (x y), of the planned way of ROBOT, from its position on."
  (remaining-points (robot-planned-way robot) (robot-x robot) (robot-y robot)))

;;; Odometers and positions of robots belong to their world. Programs change them by way of the
;;; world's owner, which records the changes in its journal.

(addition make-odometer)
(defun make-odometer (robot name)
  "Return a new odometer of ROBOT named NAME, a symbol. An older odometer of the same name is
destroyed: it no longer changes (manual 3.2.2)."
  (check-argument make-odometer robot (robot-p robot) (argument-type-text 'robot robot))
  (check-argument make-odometer name (and name (symbolp name)) "a symbol")
  (changing ((robot-world robot) make-odometer robot name)
    (add-odometer robot name)))

(define-operator 'make-odometer '(robot name) #'make-odometer)

(defun reset-odometer-for-program (odometer part)
  "Reset PART of ODOMETER and return ODOMETER. Journal the reset unless ODOMETER is destroyed."
  (let ((robot (odometer-robot odometer)) (name (odometer-name odometer)))
    (if (eq odometer (robot-odometer robot name))
        (changing ((robot-world robot) reset-odometer robot name part)
          (reset-reading odometer part))
        (reset-reading odometer part)))
  odometer)

(define-argument-type 'odometer-part (lambda (value) (member value '(:pos :ang))) ":pos or :ang")
(define-operator 'reset-odometer '(robot name odometer-part)
  (lambda (robot name part)
    (let ((odometer (robot-odometer robot name)))
      (when odometer (reset-odometer-for-program odometer part)))))

(public reset-odometer-pos)
(defun reset-odometer-pos (odometer)
  "Reset the position of ODOMETER to (0,0). Return ODOMETER (manual 3.2.2)."
  (check-odometer odometer 'reset-odometer-pos)
  (reset-odometer-for-program odometer :pos))

(public reset-odometer-ang)
(defun reset-odometer-ang (odometer)
  "Reset the angle of ODOMETER to 0 at the present heading. Return ODOMETER (manual 3.2.2)."
  (check-odometer odometer 'reset-odometer-ang)
  (reset-odometer-for-program odometer :ang))

(public reset-odometer)
(defun reset-odometer (odometer)
  "Reset position and angle of ODOMETER. Return ODOMETER (manual 3.2.2)."
  (check-odometer odometer 'reset-odometer)
  (reset-odometer-ang (reset-odometer-pos odometer)))

(defun check-not-occupied (robot x y)
  "Signal WRONG-ARGUMENT if another robot than ROBOT has its body at (X,Y), in another cell."
  (let* ((world (robot-world robot)) (map (world-map world)) (text (occupant-text world x y robot)))
    (when (and text
               (/= (map-index map x y) (map-index map (robot-x robot) (robot-y robot))))
      (reject-argument 'place-robot 'position (list x y)
                       (format nil "a point in a cell without a robot; ~A" text)))))

(addition place-robot)
(defun place-robot (robot x y angle)
  "Put ROBOT at (X,Y) heading ANGLE at once, exactly and without regard to obstacles, as the lines
POS and ANGLE of the prompt do. A warning is queued if the position is inside a wall. Signals
WRONG-ARGUMENT, also if another robot is in that cell and robots have bodies (manual E). See
reading 114."
  (check-argument place-robot robot (robot-p robot) (argument-type-text 'robot robot))
  (check-argument-type 'place-robot 'x x 'number)
  (check-argument-type 'place-robot 'y y 'number)
  (check-argument-type 'place-robot 'angle angle 'angle)
  (warn-of-angle-in-degrees 'place-robot (robot-world robot) angle)
  (let ((map (world-map (robot-world robot))))
    (unless (map-index map x y)
      (reject-argument 'place-robot 'position (list x y)
                       (format nil "a point of the map: 0 <= x < ~D, 0 <= y < ~D"
                               (map-width map) (map-height map)))))
  (check-not-occupied robot x y)
  (changing ((robot-world robot) place-robot robot x y angle)
    (set-robot-pose robot x y angle)
    (warn-if-in-wall (robot-label robot) (robot-world robot) x y))
  robot)

(define-operator 'place-robot '(robot number number angle) #'place-robot)
