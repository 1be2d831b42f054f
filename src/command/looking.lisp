;;;; looking.lisp -- the commands of cameras: views, searches, tracks, turns (3.4.2, 3.4.3).

(in-package :ars-magna.command)

;;; A search only needs a camera that does not track. A track continues in the background of views
;;; and insertions; other commands that turn the camera interrupt it.

(defun already-tracking-text (operation)
  (let ((camera (operation-resource operation)))
    (format nil "~A is already tracking~@[ ~A~]" camera (camera-tracks camera))))

(define-command camera-view (operation (camera camera))
    ((view "a list of numbers, one for each pixel from left to right"))
    ((:family :looking) (:section "3.4.3") (:traits :asks)
     (:report (view) (format nil "~A sees ~{~,2F~^ ~}" (operation-resource operation) view)))
    "Take a view with CAMERA."
  (succeed operation (take-view camera)))

;;; A rangefinder is a part of its own.

(define-command rangefinder-read (operation (rangefinder rangefinder))
    ((ranges "a list of distances in metres, one for each beam from left to right"))
    ((:family :looking) (:prompt "RANGES") (:delay range-delay*) (:traits :asks)
     (:report (ranges)
      (format nil "~A reads ~{~,2F~^ ~}" (operation-resource operation) ranges)))
    "Measure the distances to the next obstacles with RANGEFINDER: walls, closed doors, and things
and robots that block the way or the view. A beam that meets none reads the maximum."
  (succeed operation (measure-ranges rangefinder)))

(addition (rangefinder-read :ars :nisp))

;;; After its delay the search itself takes no time. Making designators takes a tick for each thing
;;; found after the first; things that have moved away by then are left out.

(define-argument-type 'designator-type
  (lambda (value) (member value '(:local :non-local)))
  ":local or :non-local")

(define-argument-type 'specification #'specification-p
  "a descriptor specification: a list such as ((:color (red blue)) (:size (3 5) .5)), with values
that the attributes can have; a range begins with its lower end"
  #'specification-problem-text)

(define-argument-type 'place-type
  (lambda (value) (and value (typep value '(or symbol string place-type))))
  "the name of a place type")

(defun found-message (operation designators)
  (phrase "~A found ~{~A~^, ~}" (operation-resource operation) (copy-list designators)))

(defun designate-sightings (operation sightings)
  "Return designators for those SIGHTINGS of OPERATION's camera that are still true."
  (let* ((camera (operation-resource operation))
         (*request-origin* (request-asker operation))
         (designators (loop for sighting in sightings collect (designate sighting camera))))
    (remove-if-not #'designator-valid-p (remove nil designators))))

(defun designate-first (operation sightings)
  (let ((designator (first (designate-sightings operation sightings))))
    (if designator
        (succeed operation designator)
        (fail-with operation :designator-not-found))))

(define-step designate-found (operation (and (camera-p (operation-resource operation))
                                             (proper-list-of-p #'sighting-p
                                                               (operation-subject operation))))
  "End OPERATION with designators for all sightings in its subject, a list."
  (let ((designators (designate-sightings operation (operation-subject operation))))
    (if designators
        (succeed operation designators)
        (fail-with operation :designator-not-found))))

(defun designate-all (operation sightings)
  "End OPERATION with designators for SIGHTINGS. Each but the first takes one tick (reading 134)."
  (setf (operation-subject operation) sightings)
  (if (rest sightings)
      (go-on operation 'designate-found (length (rest sightings)))
      (designate-found operation)))

;;; Places.

(defun place-search-error-code (camera type)
  "Return the error code for what keeps CAMERA from searching for TYPE, or NIL (reading 69)."
  (cond ((camera-tracking camera) :already-tracking)
        ((null type) :invalid-place-type)
        ((place-type-invisible-p type) :invisible-place-type)
        ((camera-location camera) :camera-enclosed)))

(defun search-for-places (operation camera place-type all)
  (let* ((type (find-place-type place-type nil))
         (obstacle (place-search-error-code camera type)))
    (if obstacle
        (fail-with operation obstacle)
        (funcall (if all #'designate-all #'designate-first)
                 operation
                 (look-for-places camera type :all all
                                  :name (if (symbolp place-type)
                                            place-type
                                            (place-type-name type)))))))

(define-command camera-get-place-designator (operation (camera camera)
                                             (place-type place-type "the name of a place type"))
    ((designator "a designator of a place of that type, non-local"))
    ((:family :looking) (:section "3.4.3") (:prompt "PLACE-DESIG") (:prefix "get-designator")
     (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:invalid-place-type (operation-formatter "~*~A is not a place type"))
              (:invisible-place-type
               (operation-formatter "~*~A cannot be recognized at a distance"))
              (:camera-enclosed (operation-formatter "~A is inside a container"))
              (:designator-not-found (operation-formatter "~A found no ~A")))
     (:report (designator) (found-message operation (list designator))))
    "Look with CAMERA for a place of a type. Of several places, one is chosen at random. The error
code :DESIGNATOR-NOT-FOUND means that the camera found no place; this is no failure."
  (search-for-places operation camera place-type nil))

(define-command camera-get-all-place-designators (operation (camera camera)
                                                  (place-type place-type
                                                   "the name of a place type"))
    ((designators "a list of designators of places of that type, non-local"))
    ((:family :looking) (:section "3.4.3") (:prompt "ALL-PLACE-DESIGS")
     (:prefix "get-all-designators") (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:invalid-place-type (operation-formatter "~*~A is not a place type"))
              (:invisible-place-type
               (operation-formatter "~*~A cannot be recognized at a distance"))
              (:camera-enclosed (operation-formatter "~A is inside a container"))
              (:designator-not-found (operation-formatter "~A found no ~A")))
     (:report (designators) (found-message operation designators)))
    "Look with CAMERA for all places of a type. Each place after the first takes a tick more. The
error code :DESIGNATOR-NOT-FOUND means that the camera found no place."
  (search-for-places operation camera place-type t))

;;; Things.

(defun warn-of-unknown-substances (specification)
  "Warn of each substance in SPECIFICATION that does not exist."
  (loop for (key value) in specification
        when (eq key :substance)
          do (dolist (choice (ensure-list value))
               (when (and choice (symbolp choice)) (warn-of-unknown-substance choice)))))

(defun search-for-things (operation camera type specification all)
  (warn-of-unknown-substances specification)
  (if (camera-tracking camera)
      (fail-with operation :already-tracking)
      (funcall (if all #'designate-all #'designate-first)
               operation
               (look-for-things camera type specification :all all))))

(define-command camera-get-object-designator
    (operation (camera camera)
               (type designator-type ":local for an object next to the robot, else :non-local")
               (specification specification "what the object is like"))
    ((designator "a designator of such an object"))
    ((:family :looking) (:section "3.4.3") (:prompt "OBJ-DESIG") (:prefix "get-designator")
     (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:designator-not-found (operation-formatter "~A found no such object")))
     (:report (designator) (found-message operation (list designator))))
    "Look with CAMERA for an object that fits a description. Of several, one is chosen at random.
The error code :DESIGNATOR-NOT-FOUND means that the camera found no object; this is no failure."
  (search-for-things operation camera type specification nil))

(define-command camera-get-all-object-designators
    (operation (camera camera)
               (type designator-type ":local for objects next to the robot, else :non-local")
               (specification specification "what the objects are like"))
    ((designators "a list of designators of such objects"))
    ((:family :looking) (:section "3.4.3") (:prompt "ALL-OBJ-DESIGS")
     (:prefix "get-all-designators") (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:designator-not-found (operation-formatter "~A found no such object")))
     (:report (designators) (found-message operation designators)))
    "Look with CAMERA for all objects that fit a description. Each object after the first takes a
tick more. The error code :DESIGNATOR-NOT-FOUND means that the camera found no object."
  (search-for-things operation camera type specification t))

;;; CAMERA-TRACK calls its continuation twice: with NIL when the track begins, and with a code when
;;; it ends; only once if it cannot begin.

(defun track-error-code (camera designator)
  "Return the error code for what keeps CAMERA from tracking DESIGNATOR, or NIL if nothing does."
  (let ((local (eq (designator-type designator) :local)))
    (cond ((camera-tracking camera) :already-tracking)
          ((and local (not (local-to-camera-p camera designator))) :local-not-local)
          ((and (not local) (camera-location camera)) :camera-inside)
          ((not (own-designator-p camera designator)) :lost-track)
          ((if local (out-of-sight-p designator camera) (not (trackable-p designator camera)))
           :lost-track))))

(defun local-to-camera-p (camera designator)
  "True if what DESIGNATOR denotes is next to the robot, and CAMERA is where the thing was seen: in
the same container or in the open (reading 140)."
  (and (own-designator-p camera designator)
       (eq (designator-location designator) (camera-location camera))
       (designator-truly-local-p designator)))

;; Warnings have been queued already, unless it was interrupted.
(defmethod notify-track-end ((operation operation) code designator)
  (setf (operation-finished-p operation) t)
  (if (eq code :interrupt)
      (report operation code '())
      (record-failure operation code (error-text operation code)))
  (notify-caller operation code (list designator)))

(defun interrupt-track (operation camera)
  (let ((track (camera-tracking camera)))
    (when (and track (track-operation track))
      (note-interruption (track-operation track) operation
                         (timeline-tick (operation-timeline operation))))
    (end-track camera :interrupt)))

(defmethod notify-track-match ((operation operation) designator)
  (notify-caller operation nil (list designator)))

;; See reading 83.
(defun begin-track (operation camera designator &rest track)
  "Make CAMERA track DESIGNATOR for OPERATION, or end OPERATION with the code of what prevents this.
TRACK may contain the track, an argument of START-TRACK."
  (let ((obstacle (track-error-code camera designator)))
    (cond (obstacle (fail-with operation obstacle designator))
          (t (report operation nil (list designator))
             (notify-caller operation nil (list designator))
             (apply #'start-track camera designator operation track)))))

;; See reading 5.
(define-command camera-track (operation (camera camera)
                              (designator designator "what to track"))
    ((designator "the designator"))
    ((:family :looking) (:section "3.4.3") (:delay camera-desig-delay*) (:echo designator)
     (:traits :begins)
     (:errors (:already-tracking #'already-tracking-text)
              (:local-not-local (operation-formatter "~*~A is not local any more"))
              (:camera-inside (operation-formatter "~A is inside a container and cannot track ~A"))
              (:lost-track (operation-formatter "~A lost track of ~A")))
     (:report (designator)
              (format nil "~A tracking ~A" (operation-resource operation) designator)))
    "Turn CAMERA to what DESIGNATOR denotes and keep CAMERA pointed there. The continuation is
called with NIL when the track begins, and with an error code when the track ends."
  (begin-track operation camera designator))

(defun check-matching-arguments (camera designator specification)
  "Return the arguments of CAMERA-TRACK-MATCHING to keep: DESIGNATOR and SPECIFICATION."
  (declare (ignore camera))
  (when (denotes-place-type-p designator)
    (reject-argument 'camera-track-matching 'designator designator
                     "a designator of an object; a place is tracked by camera-track"))
  (list designator specification))

;; See reading 246.
(define-command camera-track-matching
    (operation (camera camera)
               (designator designator "what to track")
               (specification specification "what the object must be like"))
    ((designator "the designator"))
    ((:family :looking) (:section "3.4.2") (:delay camera-desig-delay*) (:echo designator)
     (:traits :begins) (:arguments check-matching-arguments)
     (:errors (:already-tracking #'already-tracking-text)
              (:local-not-local (operation-formatter "~*~A is not local any more"))
              (:camera-inside (operation-formatter "~A is inside a container and cannot track ~A"))
              (:lost-track (operation-formatter "~A lost track of ~A")))
     (:report (designator)
              (format nil "~A tracking ~A" (operation-resource operation) designator)))
    "Track DESIGNATOR with CAMERA as CAMERA-TRACK does, and look every TRACK-MATCH-INTERVAL* ticks
whether the object still fits SPECIFICATION. If it does, update the designator's data. The camera
may take another object that fits for the tracked one, within TRACK-MATCH-GATE*; DESIGNATOR then
denotes that object. After TRACK-MATCH-MISSES* looks in succession without an object that fits, the
track is lost. The continuation is called with NIL when the track begins and at each update of the
data, and with an error code when the track ends."
  (warn-of-unknown-substances specification)
  (warn-of-unknown-attributes specification (operation-world operation))
  (begin-track operation camera designator
               (make-matching-track designator operation specification)))

(addition (camera-track-matching :ars :nisp))

;; See reading 84.
(define-command camera-untrack (operation (camera camera))
    ()
    ((:family :looking) (:section "3.4.3") (:traits :stops) (:expected :not-tracking)
     (:errors (:not-tracking (operation-formatter "~A is not tracking anything")))
     (:report () (format nil "~A stopped tracking" (operation-resource operation))))
    "Stop CAMERA from tracking. The designator remains; the track's continuation gets :INTERRUPT."
  (cond ((camera-tracking camera)
         (interrupt-track operation camera)
         (succeed operation))
        (t (fail-with operation :not-tracking))))

;;; A camera turns exactly by its argument, at once after its delay; the result is an estimate. Its
;;; angle is relative to the robot and never normalised. Turning a camera interrupts its track.

(defun turn-camera (operation camera angle)
  "Turn CAMERA by ANGLE, in radians, for OPERATION; return the estimated angle (reading 144)."
  (interrupt-track operation camera)
  (incf (camera-angle camera) (double angle))
  (+ (double angle) (angle-error (robot-dice (camera-robot camera) :looking))))

(defun turn-camera-to (operation camera direction)
  "Turn CAMERA the shorter way to DIRECTION, relative to the robot; return the estimated angle."
  (turn-camera operation camera (angle-difference direction (camera-angle camera))))

(defun camera-turn-message (operation angle)
  (phrase "~A turned ~,2F" (operation-resource operation) angle))

(define-command camera-turn (operation (camera camera)
                             (angle angle "how far in radians, to the right if positive"))
    ((angle "an estimate of the angle turned"))
    ((:family :looking) (:section "3.4.3") (:delay camera-align-delay*)
     (:report (angle) (camera-turn-message operation angle)))
    "Turn CAMERA by ANGLE, relative to where it points."
  (succeed operation (turn-camera operation camera angle)))

(define-command camera-align-robot (operation (camera camera))
    ((angle "an estimate of the angle turned"))
    ((:family :looking) (:section "3.4.3") (:delay camera-align-delay*)
     (:report (angle) (camera-turn-message operation angle)))
    "Point CAMERA where the robot is heading."
  (succeed operation (turn-camera-to operation camera 0)))

(define-command camera-align-place (operation (camera camera))
    ((angle "an estimate of the angle turned")
     (place-type "the name of the place type that was sensed"))
    ((:family :looking) (:section "3.4.3") (:delay camera-align-delay*)
     (:errors (:no-place-type "No place type here to align with"))
     (:report (angle place-type)
              (format nil "~A, at a ~A" (camera-turn-message operation angle) place-type)))
    "Point CAMERA in the nearest canonical direction of the place that the robot senses."
  (let* ((robot (camera-robot camera)) (type (sense-place-type robot)))
    (if type
        (let ((direction (nearest-direction (canonical-directions robot type)
                                            (camera-heading camera))))
          (succeed operation
                   (turn-camera-to operation camera (- direction (robot-angle robot)))
                   (place-type-name type)))
        (fail-with operation :no-place-type))))
