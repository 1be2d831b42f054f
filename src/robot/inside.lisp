;;;; inside.lisp -- parts inside containers, and things inside parts (manual 3.4.3, 3.6).

(in-package :ars-magna.robot)

(export '(outer-location part-in-bin part-reaches-p part-reaches-bin-p set-down
          move-part location-after-removal enforce-containment))

;;; A hand or camera is in the open with its robot (location NIL), inside a thing, or inside one of
;;; the robot's storage bins. What a hand holds is where the hand is. Invariants:
;;; - Nothing is inside itself by way of a hand.
;;; - After each tick, a part is only inside things within the robot's reach, and not in a closed
;;;   bin or another robot's bin.
;;; - A hand holds at most one thing.
;;; Parts take up no room: they do not reduce the remaining capacity.

(public in-location)
(defun in-location (thing location)
  "True if THING is directly in LOCATION: a hand, bin, another thing or :FLOOR (manual 5.5.1)."
  (check-argument in-location thing (thing-p thing) "a thing")
  (eq (thing-location thing) location))

(defun outer-location (location)
  "Return what LOCATION, a thing or part, is directly in, or NIL if LOCATION is in the open."
  (etypecase location
    (thing (let ((outer (thing-location location))) (if (eq outer :floor) nil outer)))
    (part (part-location location))))

(defun outer-locations (part)
  "Return a list of all locations that PART is in, directly or not, innermost first."
  (loop for outer = (part-location part) then (outer-location outer)
        while outer collect outer))

(defun part-in-bin (bin)
  "Return the first camera or hand that is in the storage BIN, directly or not, or NIL."
  (let ((robot (storage-bin-robot bin)))
    (flet ((there-p (part) (member bin (outer-locations part))))
      (or (find-if #'there-p (robot-cameras robot))
          (find-if #'there-p (robot-hands robot))))))

(defun part-reaches-p (part thing)
  "True if PART can reach THING: in the same container or in the open, within the robot's reach."
  (and (eq (thing-enclosure thing) (part-location part))
       (multiple-value-bind (x y) (thing-position thing)
         (and x (within-reach-p (part-robot part) x y)))))

(defun part-reaches-bin-p (part bin)
  "True if PART can reach BIN: PART is in the open and belongs to BIN's robot (reading 230)."
  (and (eq (part-robot part) (storage-bin-robot bin))
       (null (part-location part))))

;; See reading 154.
(defmethod remaining-capacity ((bin storage-bin))
  (max 0d0 (- (storage-bin-capacity bin)
              (loop for thing in (storage-bin-contents bin) sum (thing-size thing)))))

;;; What a hand in a closed container holds cannot get out.

(defmethod location-closed-p :around ((hand hand))
  (or (call-next-method)
      (some #'location-closed-p (outer-locations hand))))

(defun set-down (hand thing)
  "Leave THING, held by HAND, in HAND's container or on the floor where the robot is (reading 152)."
  (let ((robot (hand-robot hand)))
    (if (hand-location hand)
        (move-thing thing (hand-location hand))
        (move-thing thing (robot-x robot) (robot-y robot)))))

;;; Parts into and out of containers.

(defun move-part (part location)
  "Move PART, a camera or hand, into LOCATION: a thing, a storage bin, or NIL for the open. What
PART holds moves along, and a track of PART is lost. Warnings are queued."
  (let ((old (part-location part)))
    (when (thing-p location)
      (pushnew #'watch-container (world-move-watchers (location-world part))))
    (mark-world-unsettled (part-robot part))
    (setf (part-location part) location)
    (update-after-part-move part old)))

(defun location-after-removal (part)
  "Return the location of PART after it is taken out of its container."
  (let* ((location (part-location part))
         (space (and (thing-p location) (thing-enclosure location))))
    (if (eq space :nowhere) nil space)))

(defun pull-out-part (part)
  (warning-set (format nil "~A was pulled out of ~A" part (location-name (part-location part))))
  (move-part part nil))

(defun must-pull-out-p (part)
  "True if PART is inside a thing that is out of reach, in a closed bin or in another robot's bin."
  (let ((location (part-location part)))
    (and (thing-p location)
         (or (multiple-value-bind (x y) (thing-position location)
               (not (and x (within-reach-p (part-robot part) x y))))
             (let ((bin (find-if #'storage-bin-p (outer-locations part))))
               (and bin (or (storage-bin-closed-p bin)
                            (not (eq (part-robot part) (storage-bin-robot bin))))))))))

;; See reading 113.
(defun pull-out-if-necessary (part)
  (when (must-pull-out-p part) (pull-out-part part)))

(defun enforce-robot-containment (robot)
  "Pull the parts of ROBOT out of things beyond its reach; let each hand drop all but one thing."
  (declare #.*hot* (type robot robot))  ; in each tick
  (loop for hand across (robot-hands robot)
        do (when (hand-location hand) (pull-out-if-necessary hand))
           (loop while (rest (hand-contents hand))
                 do (set-down hand (first (last (hand-contents hand))))))
  (loop for camera across (robot-cameras robot)
        do (when (camera-location camera) (pull-out-if-necessary camera))))

(defun break-containment-circle (thing location)
  "If THING, now in LOCATION, is inside itself because a hand in THING holds it, pull the hand out."
  (let ((hand nil))
    (loop for outer = (if (eq location :floor) nil location) then (outer-location outer)
          until (or (null outer) (eq outer thing))
          when (and (hand-p outer) (thing-p (hand-location outer)))
            do (setf hand outer)
          finally (when outer (pull-out-part hand)))))

(defun watch-container (thing old-location new-location)
  "Pull parts of robots out of THING if THING has moved out of reach. A move watcher of a world."
  (declare (ignore old-location))
  (break-containment-circle thing new-location)
  (when (or (null new-location) (thing-contents thing) (plusp (thing-capacity thing)))
    (mapc #'enforce-robot-containment (robots-in-order (thing-world thing)))))

(note-savable-function 'watch-container)

(defun enforce-containment (world)
  "Enforce the rules of containment in WORLD: pull robots' parts out of things beyond reach."
  (dolist (robot (robots-in-order world))
    (enforce-robot-containment robot)))
