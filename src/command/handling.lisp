;;;; handling.lisp -- what the commands of hands, cameras and bins have in common (manual 3.6).

(in-package :ars-magna.command)

;;; Preconditions are tested in the order in which the manual lists the error codes.

(defun destination-p (object)
  (or (storage-bin-p object) (designator-p object)))

(define-argument-type 'destination #'destination-p "a designator or a storage bin")

(defun handling-dice (part)
  (world-dice (robot-world (part-robot part)) :handling))

(defun destination-name (destination)
  "Return what the bin, or the container that a designator denotes, is called."
  (cond ((storage-bin-p destination) (location-name destination))
        ((designator-denotation destination) (location-name (designator-denotation destination)))
        (t (princ-to-string destination))))

(defun succeed-saying (operation text &rest results)
  "End OPERATION successfully with RESULTS; TEXT is what its message says."
  (tell-of operation text)
  (apply #'succeed operation results))

;;; Designators.

(defun own-designator-p (resource designator)
  "True if DESIGNATOR is valid and of the robot that RESOURCE, perhaps as a part, belongs to."
  (and (designator-valid-p designator)
       (eq (designator-robot designator) (resource-robot resource))))

(defun designator-thing (designator)
  "Return the thing that DESIGNATOR denotes, or NIL if it is false or on a place."
  (let ((denotation (designator-denotation designator)))
    (and (thing-p denotation) denotation)))

(defun touched-designators (designator)
  "Return the designators on the thing that DESIGNATOR denotes; that one alone if it is false."
  (let ((thing (designator-thing designator)))
    (if thing
        (designators-on (designator-robot designator) thing)
        (list designator))))

(defun perhaps-lose-designators (designator probability dice &key silently)
  "Lose each designator on what DESIGNATOR denotes with PROBABILITY."
  (dolist (other (touched-designators designator))
    (when (chance probability dice)
      (drop-designator other :silently silently))))

;;; Destinations.

(defun destination-container (destination)
  "Return the bin or thing that DESTINATION stands for; NIL for a false or invalid designator."
  (cond ((storage-bin-p destination) destination)
        ((designator-valid-p destination) (designator-thing destination))))

(defun reaches-container-p (part container)
  (if (storage-bin-p container)
      (part-reaches-bin-p part container)
      (part-reaches-p part container)))

(defun container-capacity (container)
  (if (storage-bin-p container)
      (storage-bin-capacity container)
      (thing-capacity container)))

(defun has-room-p (container size)
  "True if CONTAINER can hold anything, and SIZE more than is in it; rounding is
forgiven (readings 153 and 237)."
  (and (plusp (container-capacity container))
       (<= size (+ (remaining-capacity container) 1d-9))))
