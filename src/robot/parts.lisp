;;;; parts.lisp -- the robot and the parts mounted on it (manual 2.2, 5.2).

(in-package :ars-magna.robot)

;;; The robot and each part is a resource: it does one thing at a time. A part's LOCATION is NIL
;;; (with the robot), a container among the things, or a storage bin.

(public robot)
(defstruct (robot (:include resource) (:constructor %make-robot) (:copier nil))
  "A point robot: it turns in place, drives straight ahead, and carries its parts along (manual
2.2)."
  (name nil :type symbol)
  (body nil)
  (world nil :type (or null world))
  ;; Why its run is over, a string; NIL as long as it is not.
  (retired nil :type (or null string))
  ;; Functions of no arguments to call then.
  (enders '() :type list)
  (x 0d0 :type double-float)
  (y 0d0 :type double-float)
  (angle 0d0 :type double-float)
  ;; The cosine and sine of the angle.
  (cos 1d0 :type double-float)
  (sin 0d0 :type double-float)
  (speed 0.8d0 :type double-float)
  (turn-angle 0.3d0 :type double-float)
  (cameras #() :type simple-vector)
  (hands #() :type simple-vector)
  (bins #() :type simple-vector)
  (odometer-list (list) :type list)
  ;; Designators by number; NIL where a number is free.
  (designators (make-array 4 :adjustable t :fill-pointer 0) :type vector)
  ;; How many designators it ever had, and the tracks that ended in this tick, newest first.
  (designators-made 0 :type fixnum)
  (ended-tracks '() :type list)
  (last-place nil)
  ;; The tick in which the robot last drove, for braking.
  (drove-tick -1 :type fixnum)
  ;; What the last step measured: metres driven, and the interval that the odometers read.
  (moved 0d0 :type double-float)
  (turned-low 0d0 :type double-float)
  (turned-high 0d0 :type double-float)
  ;; Where the last movement began, and what the robot believes it did since.
  (start-x 0d0 :type double-float)
  (start-y 0d0 :type double-float)
  (estimate-x 0d0 :type double-float)
  (estimate-y 0d0 :type double-float))

(defstruct (part (:include resource) (:constructor nil) (:copier nil))
  "A camera, hand or storage bin of a robot."
  (robot nil :type (or null robot))
  (index 0 :type fixnum)
  (location nil))

(public camera)
(defstruct (camera (:include part) (:copier nil))
  "A camera: it sees a wedge FIELD-OF-VIEW radians wide around its ANGLE, which is relative to
the robot, and its views have RESOLUTION pixels (manual 3.4)."
  (field-of-view 1d0 :type double-float)
  (resolution 1 :type (integer 1))
  (angle 0d0 :type double-float)
  (last-view '() :type list)
  ;; What it does in the background of its commands, see tracks.lisp.
  (tracking nil))

(public hand)
(defstruct (hand (:include part) (:copier nil))
  "A hand: an arm with a gripper that lifts up to STRENGTH weight units (manual 3.6)."
  (strength 0d0 :type double-float)
  (contents '() :type list))

(public storage-bin)
(defstruct (storage-bin (:include part) (:copier nil))
  "A storage bin on the robot, with room for things of CAPACITY size units (manual 3.6)."
  (capacity 0d0 :type double-float)
  (closed-p nil :type boolean)
  (contents '() :type list))

(addition robot-p part-p camera-p hand-p storage-bin-p camera-robot camera-index camera-location
          hand-robot hand-index hand-location storage-bin-robot storage-bin-index robot-name
          robot-world robot-x robot-y robot-angle robot-speed robot-turn-angle robot-cameras
          robot-hands robot-bins robot-last-place part-robot part-index part-location
          camera-field-of-view camera-resolution camera-angle camera-last-view camera-tracking
          hand-strength hand-contents storage-bin-capacity storage-bin-closed-p
          storage-bin-contents)
(document-functions
  robot-p "True of robots."
  part-p "True of cameras, hands and storage bins."
  camera-p "True of cameras."
  hand-p "True of hands."
  storage-bin-p "True of storage bins."
  camera-robot "Return the robot that the camera is mounted on."
  camera-index "Return the camera's index, from 0."
  camera-location "Return the container or bin that the camera is inside of, or NIL."
  hand-robot "Return the robot that the hand is mounted on."
  hand-index "Return the hand's index, from 0."
  hand-location "Return the container or bin that the hand is inside of, or NIL."
  storage-bin-robot "Return the robot that the bin is mounted on."
  storage-bin-index "Return the bin's index, from 0."
  robot-name "Return the symbol that the robot was defined by."
  robot-body "Return the definition from which the robot was made."
  robot-world "Return the world that the robot is in."
  robot-retired "Return why the robot's run is over, a string, or NIL as long as it is not."
  robot-enders "Return the functions that are called when the robot's run is over. Can be set."
  robot-x "Return the robot's true x coordinate, in metres."
  robot-y "Return the robot's true y coordinate, in metres."
  robot-angle "Return the robot's true heading, in radians, never normalised."
  robot-cos "Return the cosine of the robot's heading."
  robot-sin "Return the sine of the robot's heading."
  robot-speed "Return the speed that was set, in metres per tick."
  robot-turn-angle "Return the turning speed that was set, in radians per tick."
  robot-cameras "Return the vector of the robot's cameras."
  robot-hands "Return the vector of the robot's hands."
  robot-bins "Return the vector of the robot's storage bins."
  robot-last-place "Return the name of the place type that the robot last sensed, or NIL."
  robot-drove-tick "Return the tick in which the robot last drove."
  robot-designators "Return the vector of the robot's designators by number; NIL: none."
  robot-moved "Return the metres that the last step of driving really took the robot."
  robot-turned-low "Return the lower bound read for the last step of turning, in radians."
  robot-turned-high "Return the upper bound read for the last step of turning, in radians."
  part-robot "Return the robot that the part is mounted on."
  part-index "Return the part's index among its kind, from 0."
  part-location "Return the container or storage bin that the part is inside of, or NIL."
  camera-field-of-view "Return the width of what the camera sees, in radians."
  camera-resolution "Return the number of pixels of the camera's views."
  camera-angle "Return the camera's angle relative to the robot, in radians."
  camera-last-view "Return the last view, a list of numbers; () before the first."
  camera-tracking "Return the camera's TRACK, or NIL if it tracks nothing; see CAMERA-TRACKS."
  hand-strength "Return the largest weight that the hand can lift."
  hand-contents "Return a list of the thing that the hand holds, or ()."
  storage-bin-capacity "Return the size of all that fits into the bin."
  storage-bin-closed-p "True if the bin is closed."
  storage-bin-contents "Return the things in the bin, newest first.")

(addition robot-position)
(defun robot-position (robot)
  "Return the true position of ROBOT, x and y as two values, in metres."
  (values (robot-x robot) (robot-y robot)))

(addition robot-parts)
(defun robot-parts (robot)
  "Return a list of ROBOT's cameras, hands and storage bins."
  (concatenate 'list (robot-cameras robot) (robot-hands robot) (robot-bins robot)))

(addition hand-holding)
(defun hand-holding (hand)
  "Return the thing that HAND holds, or NIL."
  (first (hand-contents hand)))

(defun part-of (robot reader index operator)
  "Return the part of ROBOT with INDEX among those that READER returns."
  (unless (robot-p robot)
    (error 'wrong-argument :operator operator :name "robot" :value robot :expected "a robot"))
  (let ((parts (funcall reader robot)))
    (unless (and (integerp index) (< -1 index (length parts)))
      (error 'wrong-argument :operator operator :name "index" :value index
                             :expected (format nil "an index from 0 and below ~D, the number ~
                                                    of such parts of ~A"
                                               (length parts) (robot-name robot))))
    (svref parts index)))

(public robot-camera)
(defun robot-camera (robot index)
  "Return the camera of ROBOT with INDEX, from 0. Signals WRONG-ARGUMENT (manual 3.4)."
  (part-of robot #'robot-cameras index 'robot-camera))

(public robot-hand)
(defun robot-hand (robot index)
  "Return the hand of ROBOT with INDEX, from 0. Signals WRONG-ARGUMENT (manual 3.6)."
  (part-of robot #'robot-hands index 'robot-hand))

(public robot-storage-bin)
(defun robot-storage-bin (robot index)
  "Return the storage bin of ROBOT with INDEX, from 0. Signals WRONG-ARGUMENT (manual 3.6)."
  (part-of robot #'robot-bins index 'robot-storage-bin))

;;; Parts are called by their numbers (manual E).

(defun print-named (object stream name)
  (if (or *print-escape* *print-readably*)
      (print-unreadable-object (object stream) (write-string name stream))
      (write-string name stream)))

(defmethod print-object ((robot robot) stream)
  (print-named robot stream (symbol-name (robot-name robot))))

(defmethod print-object ((camera camera) stream)
  (print-named camera stream (format nil "Camera ~D" (camera-index camera))))

(defmethod print-object ((hand hand) stream)
  (print-named hand stream (format nil "Hand ~D" (hand-index hand))))

(defmethod print-object ((bin storage-bin) stream)
  (print-named bin stream (format nil "Storage-bin ~D" (storage-bin-index bin))))

;;; Hands and bins are places where things can be (see the world layer).

(defmethod location-contents ((hand hand)) (hand-contents hand))
(defmethod (setf location-contents) (contents (hand hand)) (setf (hand-contents hand) contents))
(defmethod location-contents ((bin storage-bin)) (storage-bin-contents bin))
(defmethod (setf location-contents) (contents (bin storage-bin))
  (setf (storage-bin-contents bin) contents))

(defmethod location-position ((part part))
  (if (part-location part)
      (location-position (part-location part))
      (robot-position (part-robot part))))

(defmethod location-world ((part part)) (robot-world (part-robot part)))
(defmethod location-closed-p ((hand hand)) nil)
(defmethod location-closed-p ((bin storage-bin)) (storage-bin-closed-p bin))
(defmethod location-name ((part part)) (princ-to-string part))
