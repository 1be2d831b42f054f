;;;; parts.lisp -- the robot and the parts mounted on it (manual 2.2, 5.2).

(in-package :ars-magna.robot)

(export '(all-blueprints blueprint *robots* find-blueprint robot-resources
          inner-resource-p inner-resource-robot inner-resources radio-p mind
          *part-vectors* parts-of-kind part mark-world-unsettled ensure-timeline))

;;; A blueprint does not change after DEFROBOT has registered it. Any number of robots can be made
;;; from it, each in its own world.

(define-record blueprint
  "The definition of a robot by DEFROBOT, from which robots are made."
  (name nil symbol "the name of the robot" :export)
  (map nil symbol "the name of the map that the robot starts in" :export)
  (x 0d0 double-float "the x coordinate where the robot starts, in metres" :export)
  (y 0d0 double-float "the y coordinate where the robot starts, in metres" :export)
  (angle 0d0 double-float "the robot's heading at its start, in radians" :export)
  (attributes '() list "the attributes of the robot's body, an object descriptor" :export)
  (parts '() list "a list (kind initarg value ...) for each of its parts" :export)
  (entry nil t "the entry of the definition in the registry, or NIL" :writable))

(defmethod print-object ((blueprint blueprint) stream)
  (print-unreadable-object (blueprint stream :type t) (princ (blueprint-name blueprint) stream)))

(defmethod reference ((blueprint blueprint))
  (list :blueprint (name-string (blueprint-name blueprint))))

(define-registry robot "robot" :object-p blueprint-p :by-symbol t
  :finder find-blueprint :lister all-blueprints :internal t)

(define-shared-types blueprint)

;;; The robot and each part is a resource: it does one thing at a time. A part's LOCATION is NIL
;;; (with the robot), a container among the things, or a storage bin.

(define-kind (inner-resource :include resource :constructor nil)
    "A resource of a robot that is not one of its parts."
  (:fixed
   (robot nil t "the robot that the resource belongs to" :export)))

(define-kind (mind :include inner-resource)
    "The resource that THINK occupies, so that body and parts continue while a robot thinks."
  (:memory
   (plan-times 0 (unsigned-byte 60) "how many times a plan of the robot has begun while the robot
had no other, since the seed of the run was set" :export)
   (unpaid 0 (rational 0 (1)) "the fraction of a tick that the robot has yet to be charged for its
thinking" :export)))

(define-kind (radio :include inner-resource)
    "The resource that ROBOT-SEND occupies, with the mailbox of the robot; see messages.lisp."
  (:state
   (sent 0 (unsigned-byte 60) "how many messages the robot has sent" :export)
   (mailbox '() list "the messages that have arrived and were not taken, the oldest first: lists
(message sender tick)" :shared :export)
   (dropped 0 (unsigned-byte 60) "how many messages the full mailbox has dropped" :export))
  (:memory
   (last-arrivals '() list "the last tick in which messages arrived, followed by these messages, the
newest first" :shared :export)))

(public robot)
;; See reading 92.
(addition robot-p)
(define-kind (robot :include resource :constructor %make-robot)
    "A point robot: it turns in place, drives straight ahead, and carries its parts (manual 2.2)."
  (:fixed
   (name nil symbol "the symbol that names the robot" :addition)
   (blueprint nil (or null blueprint) "the blueprint that the robot was made from" :export)
   (world nil (or null world) "the world that the robot is in" :addition)
   (cameras #() simple-vector "the vector of the robot's cameras" :part :addition)
   (hands #() simple-vector "the vector of the robot's hands" :part :addition)
   (bins #() simple-vector "the vector of the robot's storage bins" :part :addition)
   (sensors #() simple-vector "the vector of the robot's parts of other kinds" :part :addition)
   (mind nil (or null mind) "the resource that THINK occupies" :part :export)
   (radio nil (or null radio) "the resource that ROBOT-SEND occupies" :part :export)
   (body nil (or null body)
         "the robot's body in a world with several robots; NIL if the robot is alone or a ghost"
         :addition)
   (dice-base 0 (unsigned-byte 32) "the position of the robot's first dice in its world's dice set")
   (key 0 (unsigned-byte 62) "the hash of the robot's full name")
   (start '() list "where the robot starts, a list (x y angle); () if it has the name and the start
that its blueprint says" :export))
  (:state
   (x 0d0 double-float "the robot's true x coordinate, in metres" :addition)
   (y 0d0 double-float "the robot's true y coordinate, in metres" :addition)
   (angle 0d0 double-float "the robot's true heading, in radians, never normalised" :addition)
   (cos 1d0 double-float "the cosine of the robot's heading")
   (sin 0d0 double-float "the sine of the robot's heading")
   (speed 0.8d0 double-float "the speed that was set, in metres per tick" :addition)
   (turn-angle 0.3d0 double-float "the turning speed that was set, in radians per tick" :addition)
   (odometer-list '() list "the robot's odometers, oldest first" :part)
   (designators (make-array 4 :adjustable t :fill-pointer 0) vector
                "the robot's designators by number, with NIL for free numbers" :part :export)
   (designators-made 0 fixnum "how many designators the robot has had so far")
   (ended-tracks '() list
                 "a list of (track . code) for the tracks ended in this tick, newest first" :export)
   (last-place nil symbol "the name of the place type that the robot last sensed, or NIL" :addition)
   (drove-tick -1 fixnum "the tick in which the robot last drove" :export))
  (:memory
   (start-x 0d0 double-float "where the last movement began, the x coordinate in metres")
   (start-y 0d0 double-float "where the last movement began, the y coordinate in metres")
   (estimate-x 0d0 double-float "the estimate of the robot's movement since then, in x, in metres")
   (estimate-y 0d0 double-float "the estimate of the robot's movement since then, in y, in metres")
   (placements 0 fixnum
               "how many times the robot has been put at a position without driving there" :export)
   (put-x 0d0 double-float "where the robot was last put, the x coordinate in metres" :export)
   (put-y 0d0 double-float "where the robot was last put, the y coordinate in metres" :export)
   (failure nil t
            "a record of the last failed command of the robot or of a part, or NIL" :export)
   (published-way '() list "the way that PUBLISH-WAY was last given, see there" :shared))
  (:scratch
   (moved 0d0 double-float "the true length of the last step of driving, in metres" :export)
   (turned-low 0d0 double-float
               "the odometers' least reading of the last turning step, in radians" :export)
   (turned-high 0d0 double-float
                "the odometers' greatest reading of the last turning step, in radians" :export))
  (:link
   (retired nil (or null string) "why the robot's run is over, or NIL while it is not" :export)
   (enders '() list "the functions to call when the robot's run is over" :export)))

;; Parts of another run are not copied.
(defun copy-robot-object (object robot copier)
  "OBJECT is or belongs to ROBOT. Return COPIER's copy, or OBJECT if ROBOT is in another run."
  (if (eq (robot-world robot) (copier-option copier :world))
      (copy-slots object copier)
      object))

(defmethod copy-plan-value ((robot robot) fork)
  (copy-robot-object robot robot fork))

(addition part-p)
(define-kind (part :include resource :constructor nil)
    "A camera, hand or storage bin of a robot, or a part of a kind that you have defined."
  (:fixed
   (robot nil (or null robot) "the robot that the part is mounted on" :addition)
   (index 0 fixnum "the part's index among its kind, from 0" :addition))
  (:state
   (location nil t "the container or storage bin that the part is inside of, or NIL" :addition)))

(defmethod copy-plan-value ((part part) fork)
  (copy-robot-object part (part-robot part) fork))

(public camera)
(addition camera-p)
(define-kind (camera :include part)
    "A camera: it sees a wedge FIELD-OF-VIEW radians wide around its ANGLE, which is relative to
the robot, and its views have RESOLUTION pixels (manual 3.4)."
  (:fixed
   (field-of-view 1d0 double-float "the width of what the camera sees, in radians" :addition)
   (resolution 1 (integer 1) "the number of pixels of the camera's views" :addition))
  (:state
   (angle 0d0 double-float "the camera's angle relative to the robot, in radians" :addition)
   (tracking nil t
             "the camera's TRACK, or NIL if it tracks nothing; see CAMERA-TRACKS" :part :export))
  (:memory
   (last-view '() list "the last view, a list of numbers; () before the first" :shared :addition)
   (last-view-tick 0 tick-count "the tick in which the last view was taken" :export)))

(public hand)
(addition hand-p)
(define-kind (hand :include part)
    "A hand: an arm with a gripper that lifts up to STRENGTH weight units (manual 3.6)."
  (:fixed
   (strength 0d0 double-float "the largest weight that the hand can lift" :addition))
  (:state
   (contents '() list "a list of the thing that the hand holds, or ()" :addition))
  (:memory
   (way-in '() list
           "the containers into which plans have put the hand, innermost first" :export)))

(public storage-bin)
(addition storage-bin-p)
(define-kind (storage-bin :include part)
    "A storage bin of a robot, with room for things of a total size of CAPACITY units (manual 3.6)."
  (:fixed
   (capacity 0d0 double-float "the total size of the things that fit into the bin" :addition))
  (:state
   (closed-p nil boolean "the bin is closed" :addition)
   (contents '() list "the things in the bin, newest first" :addition)))

(addition camera-robot camera-index camera-location hand-robot hand-index hand-location
          storage-bin-robot storage-bin-index)

(defun not-a-robot-text (value)
  "Return a text that says how to get a robot if VALUE is NIL or a robot's name; else NIL."
  (let ((name (and value (typep value '(or symbol string)) (find-blueprint value nil)
                   (string-downcase value))))
    (when (or name (null value))
      (format nil "~:[a robot's name is a variable whose value is the robot~;~:*~A without a quote ~
                   is a robot~] in (with-simulation (~A) ...) or after (simulator '~:*~A)"
              name (or name "ROBOT")))))

(define-argument-type 'robot #'robot-p "a robot" #'not-a-robot-text)
(define-argument-type 'camera #'camera-p "a camera, as (robot-camera ROBOT 0) returns")
(define-argument-type 'hand #'hand-p "a hand, as (robot-hand ROBOT 0) returns")
(define-argument-type 'storage-bin #'storage-bin-p
  "a storage bin, as (robot-storage-bin ROBOT 0) returns")

(defmethod reference ((robot robot))
  (list :robot (robot-label robot)))

(defmethod reference ((part part))
  (list (make-keyword (type-of part)) (robot-label (part-robot part)) (part-index part)))

(defmethod timeline-of ((world world))
  (world-timeline world))

(defun ensure-timeline (world)
  "Return the timeline of WORLD. Make it if WORLD has no timeline."
  (or (world-timeline world)
      (progn (compare-and-swap (world-timeline world)
                               nil (make-timeline (map-name (world-map world))))
             ;; Another thread may have been first.
             (world-timeline world))))

(addition world-tick)
(declaim (inline world-tick))
(defun world-tick (world)
  "Return how many ticks have passed in WORLD or, inside a tick, the number of this tick."
  (let ((timeline (world-timeline world)))
    (declare (type (or null timeline) timeline))
    (if timeline (timeline-tick timeline) 0)))

(defmethod timeline-of ((robot robot))
  (world-timeline (robot-world robot)))

(defmethod timeline-of ((part part))
  (timeline-of (part-robot part)))

(defmethod timeline-of ((resource inner-resource))
  (timeline-of (inner-resource-robot resource)))

(addition robot-position)
(defun robot-position (robot)
  "Return the true position of ROBOT, x and y as two values, in metres."
  (values (robot-x robot) (robot-y robot)))

(defparameter *part-vectors*
  '((:cameras robot-cameras camera)
    (:hands robot-hands hand)
    (:bins robot-bins storage-bin)
    (:sensors robot-sensors part))
  "The vectors that hold a robot's parts: name, reader, and type of the elements. A part belongs to
the first vector whose element type fits.")

(addition robot-parts)
(defun robot-parts (robot)
  "Return a list of ROBOT's cameras, hands, storage bins, and parts of other kinds."
  (loop for (nil reader) in *part-vectors*
        append (coerce (the simple-vector (funcall reader robot)) 'list)))

(defun (setf robot-parts) (parts robot)
  "Set the parts of ROBOT to the list PARTS, while ROBOT is being made."
  (dolist (row *part-vectors* parts)
    (destructuring-bind (key reader type) row
      (declare (ignore key))
      (flet ((here-p (part) (typep part type)))
        (funcall (fdefinition `(setf ,reader))
                 (coerce (remove-if-not #'here-p parts) 'simple-vector)
                 robot)
        (setf parts (remove-if #'here-p parts))))))

(defun inner-resources (resource)
  "Return a list of the mind and the radio of RESOURCE if RESOURCE is a robot; or NIL."
  (and (robot-p resource) (list (robot-mind resource) (robot-radio resource))))

(defun robot-resources (robot)
  "Return a list of ROBOT's resources: robot, parts, mind and radio. Each does one thing at a time."
  (append (list robot) (robot-parts robot) (inner-resources robot)))

(defun mark-world-unsettled (robot)
  "Make the next tick check the world of ROBOT. Call MARK-WORLD-UNSETTLED before creating anything
that WORLD-SETTLED-P excludes."
  (setf (world-settled-p (robot-world robot)) nil))

(addition hand-holding)
(defun hand-holding (hand)
  "Return the thing that HAND holds, or NIL."
  (first (hand-contents hand)))

(defun indexed-part (robot reader index operator)
  (unless (robot-p robot)
    (reject-argument operator "robot" robot (argument-type-text 'robot robot)))
  (let ((parts (funcall reader robot)))
    (unless (and (integerp index) (< -1 index (length parts)))
      (reject-argument operator "index" index
                       (format nil "an index from 0 to below ~D, the number of such parts of ~A"
                               (length parts) (robot-name robot))))
    (svref parts index)))

(public robot-camera)
(defun robot-camera (robot index)
  "Return the camera of ROBOT with INDEX, from 0. Signals WRONG-ARGUMENT (manual 3.4)."
  (indexed-part robot #'robot-cameras index 'robot-camera))

(public robot-hand)
(defun robot-hand (robot index)
  "Return the hand of ROBOT with INDEX, from 0. Signals WRONG-ARGUMENT (manual 3.6)."
  (indexed-part robot #'robot-hands index 'robot-hand))

(public robot-storage-bin)
(defun robot-storage-bin (robot index)
  "Return the storage bin of ROBOT with INDEX, from 0. Signals WRONG-ARGUMENT (manual 3.6)."
  (indexed-part robot #'robot-bins index 'robot-storage-bin))

(addition robot-part)
(defun robot-part (robot kind index)
  "Return the part of ROBOT of KIND, a symbol such as CAMERA or a kind of your own, with INDEX among
the parts of this kind, from 0. Signals WRONG-ARGUMENT and UNKNOWN-NAME."
  (check-argument robot-part kind (typep kind '(or symbol string)) "the name of a kind of part")
  (unless (find-kind-name kind 'part)
    (reject-name "kind of part" kind (mapcar #'kind-name (all-kinds 'part))))
  (indexed-part robot (lambda (robot) (parts-of-kind robot kind)) index 'robot-part))

(defun parts-of-kind (robot kind)
  "Return a vector of the parts of ROBOT whose kind is named KIND."
  (coerce (remove kind (robot-parts robot) :key #'type-of :test-not #'same-name-p) 'simple-vector))

;;; Parts are printed with their numbers (manual E).

(defmethod print-object ((robot robot) stream)
  (print-named robot stream (robot-label robot)))

(defmethod print-object ((resource inner-resource) stream)
  (print-named resource stream
               (format nil "~@(~A~) of ~A" (type-of resource) (inner-resource-robot resource))))

(defmethod print-object ((part part) stream)
  (print-named part stream (format nil "~@(~A~) ~D" (type-of part) (part-index part))))

;;; Things can be in hands and bins (see the world layer).

(defmethod location-contents ((hand hand)) (hand-contents hand))
(defmethod (setf location-contents) (contents (hand hand))
  (mark-world-unsettled (hand-robot hand))
  (setf (hand-contents hand) contents))
(defmethod location-contents ((bin storage-bin)) (storage-bin-contents bin))
(defmethod (setf location-contents) (contents (bin storage-bin))
  (setf (storage-bin-contents bin) contents))

(define-argument-type 'part #'part-p "a part of a robot")

(defmethod location-position ((part part))
  (if (part-location part)
      (location-position (part-location part))
      (robot-position (part-robot part))))

(defmethod location-world ((part part)) (robot-world (part-robot part)))
(defmethod location-closed-p ((hand hand)) nil)
(defmethod location-full-p ((hand hand)) (hand-contents hand))
(defmethod location-closed-p ((bin storage-bin)) (storage-bin-closed-p bin))
(defmethod location-name ((part part)) (princ-to-string part))
(defmethod location-phrase ((part part))
  (format nil "~(~A~) of ~A" part (part-robot part)))
