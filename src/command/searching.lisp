;;;; searching.lisp -- looking for things and places to designate (manual 3.4.2, 3.4.3).

(in-package :ars-magna.command)

;;; The search itself takes no time once its delay is over, but naming all that was found takes a
;;; tick for each after the first. What has moved away by then is left out.

(define-argument-type 'designator-type
  (lambda (value) (member value '(:local :non-local)))
  ":local or :non-local")

(define-argument-type 'specification #'specification-p
  "a descriptor specification: a list such as ((:color (red blue)) (:size (3 5) .5)), with values
that the attributes can have, and of a range the lower end first"
  #'specification-trouble)

(define-argument-type 'place-type
  (lambda (value) (and value (typep value '(or symbol string place-type))))
  "the name of a place type")

(defun found-text (operation designators)
  (phrase "~A found ~{~A~^, ~}" (operation-resource operation) (copy-list designators)))

(defun name-sightings (camera sightings)
  "Return designators for those of SIGHTINGS that CAMERA still has. Of more than a robot keeps, the
first are pushed out by the last."
  (let ((designators (loop for sighting in sightings
                           for designator = (designate sighting camera)
                           when designator collect designator)))
    (remove-if-not #'designator-valid-p designators)))

(defun designate-first (operation sightings)
  (let ((designator (first (name-sightings (operation-resource operation) sightings))))
    (if designator
        (succeed operation designator)
        (fail-with operation :designator-not-found))))

(define-step designate-found (operation (and (camera-p (operation-resource operation))
                                             (proper-list-of-p #'sighting-p
                                                               (operation-subject operation))))
  "End OPERATION with designators for all sightings that are its subject."
  (let ((designators (name-sightings (operation-resource operation) (operation-subject operation))))
    (if designators
        (succeed operation designators)
        (fail-with operation :designator-not-found))))

(defun designate-all (operation sightings)
  "End OPERATION with designators for all of SIGHTINGS, when it has had the time to name
them (reading 134)."
  (setf (operation-subject operation) sightings)
  (if (rest sightings)
      (go-on operation 'designate-found (length (rest sightings)))
      (designate-found operation)))

;;; Places.

(defun place-search-obstacle (camera place-type)
  "Return the error code that keeps CAMERA from a search for places of PLACE-TYPE, or
NIL (reading 69)."
  (let ((type (find-place-type place-type nil)))
    (cond ((camera-tracking camera) :already-tracking)
          ((null type) :invalid-place-type)
          ((place-type-invisible-p type) :invisible-place-type)
          ((camera-location camera) :camera-enclosed))))

(defun asked-name (place-type)
  "Return the symbol for PLACE-TYPE, a name or a place type: the very one that was asked for."
  (if (symbolp place-type)
      place-type
      (place-type-name (find-place-type place-type))))

(defun search-for-places (operation camera place-type all)
  (let ((obstacle (place-search-obstacle camera place-type)))
    (if obstacle
        (fail-with operation obstacle)
        (funcall (if all #'designate-all #'designate-first)
                 operation
                 (look-for-places camera (find-place-type place-type) :all all
                                  :name (asked-name place-type))))))

(define-command camera-get-place-designator (operation (camera camera)
                                             (place-type place-type "the name of a place type"))
    ((designator "a designator of a place of that type, non-local"))
    ((:family :looking) (:section "3.4.3") (:prompt "PLACE-DESIG") (:prefix "get-designator")
     (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:invalid-place-type (text-of "~*~A is not a place type"))
              (:invisible-place-type (text-of "~*~A cannot be recognized at a distance"))
              (:camera-enclosed (text-of "~A is inside a container"))
              (:designator-not-found (text-of "~A found no ~A")))
     (:report (designator) (found-text operation (list designator))))
    "Look with CAMERA for a place of a type; of several, find any one. That it found none is an
answer, not a fault of the robot: :DESIGNATOR-NOT-FOUND."
  (search-for-places operation camera place-type nil))

(define-command camera-get-all-place-designators (operation (camera camera)
                                                  (place-type place-type
                                                   "the name of a place type"))
    ((designators "a list of designators of places of that type, non-local"))
    ((:family :looking) (:section "3.4.3") (:prompt "ALL-PLACE-DESIGS")
     (:prefix "get-all-designators") (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:invalid-place-type (text-of "~*~A is not a place type"))
              (:invisible-place-type (text-of "~*~A cannot be recognized at a distance"))
              (:camera-enclosed (text-of "~A is inside a container"))
              (:designator-not-found (text-of "~A found no ~A")))
     (:report (designators) (found-text operation designators)))
    "Look with CAMERA for all places of a type. Takes a tick more for each after the first. That it
found none is an answer: :DESIGNATOR-NOT-FOUND."
  (search-for-places operation camera place-type t))

;;; Things.

(defun note-unknown-substances (specification)
  "Tell of substances that are wanted in SPECIFICATION and that there are not."
  (loop for (key value) in specification
        when (eq key :substance)
          do (dolist (choice (ensure-list value))
               (when (and choice (symbolp choice)) (note-unknown-substance choice)))))

(defun search-for-things (operation camera type specification all)
  (note-unknown-substances specification)
  (if (camera-tracking camera)
      (fail-with operation :already-tracking)
      (funcall (if all #'designate-all #'designate-first)
               operation
               (look-for-things camera type specification :all all))))

(define-command camera-get-object-designator
    (operation (camera camera)
               (type designator-type "whether next to the robot")
               (specification specification "what the object is like"))
    ((designator "a designator of such an object"))
    ((:family :looking) (:section "3.4.3") (:prompt "OBJ-DESIG") (:prefix "get-designator")
     (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:designator-not-found (text-of "~A found no such object")))
     (:report (designator) (found-text operation (list designator))))
    "Look with CAMERA for an object that fits a description; of several, find any one. That it found
no such object is an answer, not a fault of the robot: :DESIGNATOR-NOT-FOUND."
  (search-for-things operation camera type specification nil))

(define-command camera-get-all-object-designators
    (operation (camera camera)
               (type designator-type "whether next to the robot")
               (specification specification "what the objects are like"))
    ((designators "a list of designators of such objects"))
    ((:family :looking) (:section "3.4.3") (:prompt "ALL-OBJ-DESIGS")
     (:prefix "get-all-designators") (:delay camera-desig-delay*)
     (:errors (:already-tracking #'already-tracking-text)
              (:designator-not-found (text-of "~A found no such object")))
     (:report (designators) (found-text operation designators)))
    "Look with CAMERA for all objects that fit a description. Takes a tick more for each after
the first. That it found no such object is an answer: :DESIGNATOR-NOT-FOUND."
  (search-for-things operation camera type specification t))
