;;;; designator.lisp -- handles on what the robot has seen (manual 3.4.1).

(in-package :ars-magna.robot)

(export '(*default-robot-function* designators-of-thing *designator-limit* thing-enclosure
          designator-truly-local-p designator-with-serial make-designator add-designator
          denotes-place-type-p))

;;; A designator denotes a thing, a PLACE, or nothing: then it is false, and X, Y is where the robot
;;; seems to have seen something. Programs may read type, angle and data; the rest is for the
;;; simulator. It is valid until it is dropped (see tracks.lisp). Then its number may be used again,
;;; its serial number never. Its LOCATION is where the camera was that saw it: a container, a
;;; storage bin, or NIL in the open.

(public designator)
;; See reading 138.
(addition designator-p)
(define-kind (designator)
    "A handle for a thing or place that a camera has seen, or seems to have seen (manual 3.4.1)."
  (:fixed
   (robot nil (or null robot) "the robot that the designator is a handle for" :addition)
   (number 0 fixnum "the designator's number, which another designator may get after this one was
dropped" :addition)
   (serial 0 fixnum "the serial number: how many designators the robot had before" :export))
  (:state
   (type :non-local (member :local :non-local) ":LOCAL or :NON-LOCAL (manual 3.4.1)" :addition)
   (angle 0d0 double-float "the estimated angle of what the designator denotes relative to the
robot's heading, in radians, not normalised (manual 3.4.1)" :addition)
   (data '() list "what was seen: a list of lists (attribute value), or of the name of a place type
(manual 3.4.1)" :shared :addition)
   (denotation nil (or null thing place)
               "the THING or PLACE that the designator denotes, or NIL if it is false" :addition)
   (distance 0d0 double-float
             "the distance at which the denotation was last seen, in metres" :addition)
   (valid-p t boolean "the designator has not been dropped" :addition)
   (x 0d0 double-float "the x coordinate where the denotation was last seen, in metres" :addition)
   (y 0d0 double-float "the y coordinate where the denotation was last seen, in metres" :addition)
   (location nil t "the container or bin where the denotation was seen, or NIL" :addition)
   (bearing 0d0 double-float "the true direction in which the denotation was last seen, in radians")
   (bearing-p nil boolean "the denotation was seen from far enough to have a direction")
   (relative-bearing 0d0 double-float "the true direction from the robot's heading, in radians")
   (swing 0d0 double-float "by how much the direction changed in the tick REFRESHED, in radians")
   (refreshed -1 fixnum "the tick in which the designator was last updated"))
  (:memory
   (origin *request-origin* t "the origin of the request that found it, for messages")))

(setf (documentation 'make-designator 'function)
      "Return a new designator, which no robot has numbered yet.")

(define-argument-type 'designator #'designator-p "a designator"
  (constantly (format nil "cameras' searches pass designators to their continuations, as in ~
                           (camera-get-object-designator CAMERA :non-local '((:color red)) ~
                           (continuation (err camera designator) ...)); in plans, (vref ~
                           camera-designators* 0) has a list of them")))

(defmethod print-object ((designator designator) stream)
  (print-named designator stream (format nil "Designator ~D" (designator-number designator))))

(defun denotes-place-type-p (designator)
  "True if DESIGNATOR was found in a search for a place type, even if it is false."
  (let ((data (designator-data designator)))
    (and data (atom (first data)))))

;;; A robot's designators by number.

(defparameter *designator-limit* 1000
  "The number of designators that a robot keeps. When a robot exceeds this number, its oldest
designator that no camera tracks is removed.")

(addition find-designator)
(defun find-designator (robot number)
  "Return ROBOT's designator NUMBER, or NIL. Signals WRONG-ARGUMENT unless ROBOT is a robot."
  (check-argument find-designator robot (robot-p robot) (argument-type-text 'robot robot))
  (let ((designators (robot-designators robot)))
    (and (integerp number)
         (< -1 number (length designators))
         (aref designators number))))

;; The prompt sets it: its lines command one of the robots.
(defvar *default-robot-function* (lambda () (and *world* (first (world-robots *world*))))
  "A function that returns the robot to use if no robot is given.")

(defun designator (number &optional (robot (funcall *default-robot-function*)))
  "Return the designator of ROBOT with NUMBER. By default ROBOT is the robot that the prompt
commands, or else the first robot of the world. An addition to manual 3.4.1, for use at the prompt
and REPL. Signals WRONG-ARGUMENT if there is no such designator."
  (or (find-designator robot number)
      (reject-argument 'designator "number" number
                       (format nil "~:[the number of a designator; ~A has none~;one of ~
                                    ~:*~{~D~^, ~}, the designators of ~A~]"
                               (mapcar #'designator-number (live-designators robot)) robot))))

(addition live-designators)
(defun live-designators (robot)
  "Return a list of the valid designators of ROBOT, sorted by number."
  (coerce (remove nil (robot-designators robot)) 'list))

(defun designators-of-thing (robot thing)
  "Return a list of the valid designators of ROBOT that denote THING, sorted by number."
  (loop for designator across (robot-designators robot)
        when (and designator (eq (designator-denotation designator) thing))
          collect designator))

(defun assign-number (robot designator)
  "Give DESIGNATOR the smallest number unused in ROBOT, and a serial number (reading 198)."
  (mark-world-unsettled robot)
  (let* ((designators (robot-designators robot))
         (number (or (position nil designators)
                     (vector-push-extend nil designators))))
    (setf (designator-number designator) number
          (designator-serial designator) (robot-designators-made robot)
          (aref designators number) designator)
    (incf (robot-designators-made robot))
    designator))

(defun release-number (designator)
  (let ((designators (robot-designators (designator-robot designator))))
    (setf (designator-valid-p designator) nil
          (aref designators (designator-number designator)) nil)
    (loop while (and (plusp (length designators))
                     (null (aref designators (1- (length designators)))))
          do (vector-pop designators))))

;;; Where things are, as a robot sees it.

(defun thing-enclosure (thing)
  "Return the container or storage bin that THING is in, NIL if THING is in the open, or :NOWHERE. A
thing in a hand is where the hand is."
  (let ((location (thing-location thing)))
    (cond ((eq location :floor) nil)
          ((null location) :nowhere)
          ((hand-p location) (part-location location))
          (t location))))

(defun denotation-enclosure (designator)
  "Return the THING-ENCLOSURE of DESIGNATOR's thing, or the hand if another robot holds it."
  (let* ((thing (designator-denotation designator)) (location (thing-location thing)))
    (if (and (hand-p location)
             (not (eq (part-robot location) (designator-robot designator))))
        location
        (thing-enclosure thing))))

(addition designator-position)
(defun designator-position (designator)
  "Return, as two values, the true position of what DESIGNATOR denotes, in metres; for a false
designator, the position where the robot seems to have seen something. Return NIL and NIL for a
thing that is nowhere (reading 54)."
  (let ((denotation (designator-denotation designator)))
    (etypecase denotation
      (thing (thing-position denotation))
      (place (let ((cell (place-cell denotation)))
               (values (+ 0.5d0 (cell-x cell)) (+ 0.5d0 (cell-y cell)))))
      (null (values (designator-x designator) (designator-y designator))))))

(defun designator-truly-local-p (designator)
  "True if what DESIGNATOR denotes is truly local now: within reach, and still in the container, the
bin or the open space where it was seen. False for places."
  (let ((denotation (designator-denotation designator)))
    (and (designator-valid-p designator)
         (not (place-p denotation))
         (or (null denotation)
             (eq (denotation-enclosure designator) (designator-location designator)))
         (multiple-value-bind (x y) (designator-position designator)
           (and x (within-reach-p (designator-robot designator) x y))))))

;;; A journal can also name a designator that has been dropped, perhaps in an earlier run. Its
;;; serial number may be in use again, so it is written as -1.

(defmethod copy-plan-value ((designator designator) fork)
  (copy-robot-object designator (designator-robot designator) fork))

(defmethod reference ((designator designator))
  (list :designator (robot-label (designator-robot designator))
        (if (designator-valid-p designator) (designator-serial designator) -1)
        (designator-number designator)
        (designator-type designator)))

(defun designator-with-serial (robot serial)
  "Return the valid designator of ROBOT with the serial number SERIAL, or NIL."
  (find serial (live-designators robot) :key #'designator-serial))

;;; Giving a robot a designator, and making room for it.

(defun drop-oldest-designator (robot)
  (let ((untracked (remove-if #'tracked-p (live-designators robot))))
    (when untracked
      (drop-designator (first (sort untracked #'< :key #'designator-serial))))))

(defun add-designator (robot &key (type :non-local) (angle 0d0) (distance 0d0) data denotation
                                  x y location)
  "Add a new designator to ROBOT and return it. DENOTATION is a THING or a PLACE, or NIL for a false
designator at X, Y. The denotation was seen at DISTANCE metres and at ANGLE to the heading, in
LOCATION, which is a container or NIL. DATA describes the denotation."
  (when (>= (length (robot-designators robot)) *designator-limit*) (drop-oldest-designator robot))
  (let ((designator (make-designator :type type :robot robot :data data :location location
                                     :denotation denotation
                                     :angle (double angle) :distance (double distance)
                                     :x (double (or x 0)) :y (double (or y 0)))))
    (unless x
      (multiple-value-bind (x y) (designator-position designator)
        (setf (designator-x designator) (double x)
              (designator-y designator) (double y))))
    (pushnew #'watch-thing (world-move-watchers (robot-world robot)))
    (assign-number robot designator)))
