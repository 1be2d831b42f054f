;;;; plans-locks.lisp -- manipulations in plans: a locked container and its key.

;;; Manipulations call a continuation when they end; plans wait for fluents. So a plan gives a
;;; manipulation a continuation that sets a fluent.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun begin-manipulation (name arguments)
  "Issue the manipulation NAME with ARGUMENTS, a list without continuation. Return a fluent. The
fluent's value is NIL until the manipulation ends, then the error code, or :DONE for success."
  (let ((end (create-fluent nil)))
    (apply #'run-manipulation name
           (append arguments
                   (list (continuation (err value)
                           (setf (fluent-value end) (or err :done))))))
    end))

(def-interp-proc manipulation-outcome (name &rest arguments)
  "Do the manipulation NAME with ARGUMENTS, without continuation. Return an error code or NIL."
  (let ((end (begin-manipulation name arguments)))
    (wait-for end)
    (if (eq :done (fluent-value end)) nil (fluent-value end))))

(def-interp-proc manipulate-thing (name hand camera description &key with)
  "Do the manipulation NAME with HAND on something next to the robot that fits DESCRIPTION; WITH
describes a tool in HAND, such as a key. Look for the thing and the tool before each attempt. If the
robot stands in the doorway whose door it is to close, it drives on through the doorway and turns
round. Fails with :WILL-NOT-DO after twelve attempts."
  (let ((target nil))
    (insistently (error (let ((tool (if with (look-closely camera with)))
                              (part (robot-hand (rpl-robot) hand)))
                          (setf target (look-closely camera description))
                          (cond ((or (null target) (and with (null tool))) :not-found)
                                (with (manipulation-outcome name target tool part))
                                (t (manipulation-outcome name target part)))))
      ((:already-open :already-closed) t)
      (:doorway-occupied (leave-doorway-of target camera) nil))))

(def-interp-proc leave-doorway-of (door camera)
  "DOOR is a local designator of a door. If the robot stands in its doorway, drive on until DOOR is
.7 metres behind, within reach, turn round and turn CAMERA ahead."
  (if (< (designator-distance door) .6)
      (seq (drive-by (+ .7 (* (designator-distance door) (cosine (designator-angle door)))))
           (turn-by pi)
           (outcome (rpl-camera-align-robot camera)
                    (vref camera-moved* camera) (vref camera-movement-error* camera)))))

(def-interp-proc visit-thing (me camera description)
  "Drive the robot of the reckoning ME to something that fits DESCRIPTION; search at most eight
times. Return a local designator of the thing. Fails with :NOT-FOUND."
  (let ((found nil))
    (n-times 8 UNTIL found
      (setf found (visit-things me camera description)))
    (if (not found)
        (fail :class :not-found :description description))
    found))

(def-interp-proc open-with-key (key container &key start (camera (widest-camera)) (hand 0))
  "Find a thing that fits the description KEY and grasp it with HAND. Drive to a thing that fits
CONTAINER, unlock it, drop the key and open it. START is the robot's position, a list (x y heading);
the default is the true position. Return the estimated position at the end, a point. Fails with
:NOT-FOUND, :TOO-HEAVY or :WILL-NOT-DO."
  (with-valve ((rpl-robot-valve))
    (let ((me (begin-reckoning (or start (here (rpl-robot))))))
      (let-go hand)
      (grasp-thing hand camera key :designator (visit-thing me camera key))
      (visit-thing me camera container)
      (manipulate-thing 'unlock hand camera container :with key)
      (let-go hand)
      (manipulate-thing 'open hand camera container)
      (reckon me))))
