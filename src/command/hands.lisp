;;;; hands.lisp -- grasping, letting go, feeling, and watching the grip (manual 3.6).

(in-package :ars-magna.command)

(export '(end-lost-grips grip-watched-p))

;;; Common to the commands of hands, cameras and bins. Preconditions are checked in the order in
;;; which the manual lists the error codes.

(define-argument-type 'destination
  (lambda (value) (or (storage-bin-p value) (designator-p value)))
  "a designator or a storage bin")

(defun handling-dice (part)
  (robot-dice (part-robot part) :handling))

(defun destination-name (destination)
  (cond ((storage-bin-p destination) (location-name destination))
        ((designator-denotation destination) (location-name (designator-denotation destination)))
        (t (princ-to-string destination))))

(defun succeed-with-message (operation text &rest results)
  (queue-operation-message operation text)
  (apply #'succeed operation results))

;;; Designators.

(defun own-designator-p (resource designator)
  (and (designator-valid-p designator)
       (eq (designator-robot designator) (resource-robot resource))))

(defun designator-thing (designator)
  "Return the thing that DESIGNATOR denotes, or NIL if DESIGNATOR is false or denotes a place."
  (let ((denotation (designator-denotation designator)))
    (and (thing-p denotation) denotation)))

(defun drop-designators-by-chance (designator probability dice &key silently)
  "Drop each designator of DESIGNATOR's thing with PROBABILITY. If DESIGNATOR denotes no thing, drop
only DESIGNATOR, with PROBABILITY."
  (let ((thing (designator-thing designator)))
    (dolist (other (if thing
                       (designators-of-thing (designator-robot designator) thing)
                       (list designator)))
      (when (chance probability dice)
        (drop-designator other :silently silently)))))

;;; Destinations.

(defun destination-container (destination)
  "Return the bin or thing that DESTINATION stands for; NIL for a false or invalid designator."
  (cond ((storage-bin-p destination) destination)
        ((designator-valid-p destination) (designator-thing destination))))

(defun reaches-container-p (part container)
  (if (storage-bin-p container)
      (part-reaches-bin-p part container)
      (part-reaches-p part container)))

(defun has-room-p (container size)
  "True if CONTAINER has room for a thing of SIZE, apart from rounding (readings 153 and 237)."
  (and (plusp (if (storage-bin-p container)
                  (storage-bin-capacity container)
                  (thing-capacity container)))
       (<= size (+ (remaining-capacity container) 1d-9))))

;;; A grip is only lost by changes of the thing: kickers, manipulations, another hand, destruction.

;;; Grasping.

(defun grasp-error-code (hand camera designator)
  "Return the error code for what keeps HAND from grasping, or NIL if nothing does (reading 164)."
  (cond ((hand-holding hand) :hand-grasping)
        ((not (and (eq (hand-robot hand) (camera-robot camera))
                   (eq (hand-location hand) (camera-location camera))))
         :different-location)
        ((not (own-designator-p hand designator)) :bad-designator)
        ((eq (designator-type designator) :non-local) :non-local-grasp)
        ((not (tracking-p camera designator)) :not-tracked)))

(defun grasp (hand thing dice)
  "Let HAND grasp THING (NIL: a false sighting). Return an error code or NIL (readings 151, 231)."
  (cond ((or (null thing) (chance prob-miss-grasp* dice)) :missed-grasp)
        ((or (body-p thing) (> (thing-total-weight thing) (hand-strength hand)))
         :insufficient-strength)
        (t (move-thing thing hand)
           nil)))

(defun try-grasp (hand designator dice)
  "Make HAND grasp what DESIGNATOR denotes. Return an error code or NIL. See reading 165."
  (let ((thing (designator-thing designator)))
    (if (and thing (not (part-reaches-p hand thing)))
        :missed-grasp
        (prog1 (grasp hand thing dice)
          (drop-designators-by-chance designator prob-grasp-lose-desig* dice :silently t)))))

(define-command hand-grasp-desig (operation (hand hand)
                                  (camera camera "a camera that tracks the designator")
                                  (designator designator "a local designator"))
    ((designator "the designator"))
    ((:family :handling) (:section "3.6") (:prompt "HAND-GRASP") (:prefix "hand-grasp")
     (:delay (+ hand-move-delay* hand-grasp-delay*))
     (:errors (:hand-grasping (operation-formatter "~A is already holding something"))
              (:different-location (operation-formatter "~A not in same location as ~A"))
              (:bad-designator "Designator is not valid")
              (:non-local-grasp "Designator is not local")
              (:not-tracked (operation-formatter "~*~A is not tracking ~A"))
              (:missed-grasp (operation-formatter "~A missed"))
              (:insufficient-strength (operation-formatter "~A is not strong enough")))
     (:report (designator)
              (format nil "~A grasped ~A" (operation-resource operation)
                      (hand-holding (operation-resource operation)))))
    "Grasp with HAND what a local designator denotes. Whether or not the hand misses, it may bump
the thing, which silently makes designators of the thing invalid."
  (let ((obstacle (grasp-error-code hand camera designator)))
    (end-operation operation
                   (or obstacle (try-grasp hand designator (handling-dice hand)))
                   designator)))

(defun drop-message (hand thing)
  (format nil "~A dropped ~A~@[ into ~A~]" hand thing
          (and (hand-location hand) (location-name (hand-location hand)))))

(define-command hand-ungrasp (operation (hand hand))
    ()
    ((:family :handling) (:section "3.6")
     (:errors (:not-grasping (operation-formatter "~A is not holding anything"))))
    "Drop what HAND holds: into the container the hand is in, or where the robot stands."
  (let ((thing (hand-holding hand)))
    (cond (thing (set-down hand thing)
                 (succeed-with-message operation (drop-message hand thing)))
          (t (fail-with operation :not-grasping)))))

;;; Feeling.

(defun end-without-failure (operation code)
  "End OPERATION with the error code CODE, which is an answer and does not count as a failure."
  (queue-operation-message operation (error-text operation code))
  (setf (operation-finished-p operation) t)
  (notify-caller operation code '()))

;; See reading 150.
(define-command hand-grasp-check (operation (hand hand))
    ()
    ((:family :handling) (:section "3.6") (:traits :asks)
     (:errors (:grasping (operation-formatter "~A is holding something"))
              (:not-grasping (operation-formatter "~A is not holding anything"))))
    "Feel whether HAND holds something. The answer is the error code :GRASPING or :NOT-GRASPING."
  (end-without-failure operation (if (hand-holding hand) :grasping :not-grasping)))

(defconstant +watch-period+ 1000
  "The number of ticks after which the event that watches a grip is queued again.")

(define-step watch-grip (operation (hand-p (operation-resource operation)))
  "Occupy the hand of OPERATION as long as the hand holds OPERATION's subject (reading 162)."
  (let ((hand (operation-resource operation)))
    (cond ((not (eq (operation-subject operation) (hand-holding hand)))
           (fail-with operation :grasp-lost))
          ((not (event-pending-p operation))
           (mark-world-unsettled (hand-robot hand))
           (go-on operation 'watch-grip +watch-period+)))))

;; See readings 222 and 239.
(define-command hand-track (operation (hand hand))
    ()
    ((:family :handling) (:section "3.6") (:delay 1)
     (:errors (:grasp-lost (operation-formatter "~A lost its grip"))
              (:not-grasping (operation-formatter "~A is not holding anything"))))
    "Watch the grip of HAND until the hand loses it, or until another command to HAND interrupts."
  (setf (operation-subject operation) (hand-holding hand))
  (if (hand-holding hand)
      (watch-grip operation)
      (fail-with operation :not-grasping)))

(defun grip-watched-p (resource)
  "True if RESOURCE carries out a HAND-TRACK that has begun."
  (let ((operation (resource-event resource)))
    (and (operation-p operation)
         (eq 'watch-grip (operation-step operation)))))

(defun end-lost-grips (world)
  "Check all watched grips in WORLD, and end the HAND-TRACK of each hand that has lost its grip."
  (declare #.*hot*)                     ; in each tick
  (dolist (robot (robots-in-order world))
    (loop for hand across (robot-hands robot)
          do (when (and (resource-event (the hand hand)) (grip-watched-p hand))
               (run-operation (resource-event hand))))))
