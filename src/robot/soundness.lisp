;;;; soundness.lisp -- checks of robots that were read from a file.

(in-package :ars-magna.robot)

(export '(check-robot))

(defun check-parts (robot parts type)
  (loop for part across parts
        for position from 0
        do (must-hold (and (typep part type)
                           (eq robot (part-robot part))
                           (or (eq type 'part) (= position (part-index part))))
                      "part number ~D of ~A is invalid" position robot)
           (must-hold (typep (part-location part) '(or null thing storage-bin))
                      "the location of ~A is invalid" part)
           (check-pending-event part)))

(defun check-contents (holder contents most)
  (must-hold (and (proper-list-of-p #'thing-p contents)
                  (<= (length contents) most)
                  (every (lambda (thing) (eq holder (thing-location thing))) contents))
             "the contents of ~A are not inside it" holder))

(defun check-track (track)
  (when (track-operation track) (check-request (track-operation track))))

(defun check-camera (camera)
  (let ((track (camera-tracking camera)))
    (when track
      (must-hold (and (track-p track)
                      (designator-p (track-designator track))
                      (eq (camera-robot camera)
                          (designator-robot (track-designator track)))
                      (designator-valid-p (track-designator track)))
                 "the track of ~A is invalid" camera)
      (check-track track))))

(defun check-designator (robot number designator)
  (must-hold (or (null designator)
                 (and (designator-p designator)
                      (eq robot (designator-robot designator))
                      (= number (designator-number designator))
                      (designator-valid-p designator)
                      (< -1 (designator-serial designator) (robot-designators-made robot))
                      (typep (designator-location designator) '(or null thing storage-bin))
                      (proper-list-p (designator-data designator))))
             "designator ~D of ~A is invalid" number robot))

(defun check-designators (robot)
  (let ((designators (robot-designators robot)))
    (must-hold (and (arrayp designators) (array-has-fill-pointer-p designators))
               "the vector of designators of ~A cannot grow" robot)
    (loop for designator across designators
          for number from 0
          do (check-designator robot number designator))
    (must-hold (proper-list-of-p (lambda (end) (typep end '(cons track keyword)))
                                 (robot-ended-tracks robot))
               "the ended tracks of ~A are invalid" robot)
    (loop for (track) in (robot-ended-tracks robot) do (check-track track))))

(defun check-odometers (robot)
  (must-hold (and (proper-list-of-p (lambda (odometer)
                                      (and (odometer-p odometer)
                                           (eq robot (odometer-robot odometer))))
                                    (robot-odometer-list robot))
                  (robot-main-odometer robot))
             "the odometers of ~A do not belong to it" robot))

(defun check-pose (robot)
  "Signal CONTRADICTION unless the position, heading and speeds of ROBOT are valid in its map."
  (must-hold (every #'sane-number-p
                    (list (robot-x robot) (robot-y robot) (robot-angle robot)
                          (robot-speed robot) (robot-turn-angle robot)))
             "a coordinate, angle or speed of ~A is too large" robot)
  (must-hold (robot-cell-index robot) "~A is outside of its map" robot)
  ;; On another machine the last bit may differ.
  (must-hold (and (< (abs (- (robot-cos robot) (cosine (robot-angle robot)))) 1d-9)
                  (< (abs (- (robot-sin robot) (sine (robot-angle robot)))) 1d-9))
             "the heading of ~A does not fit its cosine and sine" robot))

(defun check-body (robot)
  "Signal CONTRADICTION unless ROBOT has a body where it is and its own dice, or neither."
  (let ((body (robot-body robot)) (world (robot-world robot)))
    (must-hold (or (null body)
                   (and (body-p body)
                        (eq robot (body-robot body))
                        (eq :floor (thing-location body))
                        (= (robot-x robot) (thing-x body))
                        (= (robot-y robot) (thing-y body))))
               "the body of ~A is not where the robot is" robot)
    (must-hold (and (eq (and body t)
                        (and (rest (world-robots world)) (not (world-ghosts-p world))))
                    (= (robot-dice-base robot)
                       (if (rest (world-robots world))
                           (position-of-dice (robot-full-name robot) (world-dice-names world))
                           0)))
               "~A has a body or dice although it is alone, or has none although it is not" robot)))

;; Files of earlier versions have no radios.
(defun check-radio (robot)
  (unless (robot-radio robot) (setf (robot-radio robot) (make-radio :robot robot)))
  (let ((radio (robot-radio robot)))
    (must-hold (eq robot (inner-resource-robot radio)) "the radio of ~A is another robot's" robot)
    (must-hold (proper-list-of-p (lambda (entry)
                                   (and (typep entry '(cons t (cons symbol (cons tick-count null))))
                                        (message-datum-p (first entry))))
                                 (radio-mailbox radio))
               "the mailbox of ~A is invalid" robot)
    (must-hold (proper-list-of-p #'identity (radio-last-arrivals radio))
               "the last messages of ~A are invalid" robot)
    (check-pending-event radio)))

(defun check-start-pose (robot world)
  (let ((start (robot-start robot)))
    (must-hold (or (null start)
                   (and (proper-list-of-p #'sane-number-p start)
                        (= 3 (length start))
                        (map-index (world-map world) (first start) (second start))))
               "the start of ~A is invalid" robot)))

(defun check-robot (robot world)
  "ROBOT and WORLD were read from a file. Signal an error, usually CONTRADICTION, unless ROBOT is a
robot of WORLD in a state that a run can reach."
  (must-hold (and (robot-p robot)
                  (eq world (robot-world robot))
                  (robot-blueprint robot)
                  (or (eq (robot-name robot) (blueprint-name (robot-blueprint robot)))
                      (robot-start robot)))
             "a robot does not belong to its world")
  (check-start-pose robot world)
  (check-pending-event robot)
  (check-pose robot)
  (loop for (nil reader type) in *part-vectors*
        do (check-parts robot (funcall reader robot) type))
  (loop for camera across (robot-cameras robot)
        do (check-camera camera))
  (loop for hand across (robot-hands robot)
        do (check-contents hand (hand-contents hand) 1))
  (loop for bin across (robot-bins robot)
        do (check-contents bin (storage-bin-contents bin) (world-live-count world)))
  (check-body robot)
  (check-radio robot)
  (check-designators robot)
  (check-odometers robot))
