;;;; plans-looking.lisp -- plans that look for things and go to them.

;;; For any robot with a camera. A description is a descriptor specification of manual 3.4.2, such
;;; as ((:color blue) (:substance plastic)). Cameras often misread colours, overlook things and see
;;; things that are not there. So plans look several times. Next to a thing that seems to fit, they
;;; check it again, by CONFIRM-THING, before a hand grasps it.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-proc turn-camera (camera angle)
  "Turn CAMERA by ANGLE, in radians. Return an error code or NIL."
  (outcome (rpl-camera-turn camera angle)
           (vref camera-moved* camera) (vref camera-movement-error* camera)))

(def-interp-proc scan-for-thing (camera description &key (type :non-local) (rounds 2))
  "Turn CAMERA, at most ROUNDS times round, until a designator fits DESCRIPTION. Return it or NIL."
  (let ((found nil)
        (views (* rounds (ceiling 2pi (rpl-camera-field-of-view camera)))))
    (n-times views UNTIL found
      (setf found (first (look-for-things camera type description)))
      (if (null found)
          (turn-camera camera (rpl-camera-field-of-view camera))))
    found))

(def-interp-proc look-again (camera description)
  "Look where CAMERA points, at most four times. Return a designator that fits DESCRIPTION, or NIL."
  (let ((found nil))
    (n-times 4 UNTIL found
      (setf found (first (look-for-things camera :non-local description))))
    found))

;;; Approaching.

(def-interp-proc go-round (me attempt)
  "Drive the robot of the reckoning ME 1.5 metres aside: right if ATTEMPT is even, else left."
  (turn-by (if (evenp attempt) 1.2 -1.2))
  (drive-by 1.5)
  (reckon me))

(def-interp-proc approach-thing (me camera designator description &key (attempts 6))
  "Drive the robot of the reckoning ME to DESIGNATOR, which fits DESCRIPTION, guided by CAMERA. If
the track is lost, search again. Return the estimated position. Fails with :NOT-REACHED after
ATTEMPTS attempts, or if the search finds nothing."
  (let ((target designator) (there nil) (attempt 0))
    (loop UNTIL there
      (if (or (null target) (>= attempt attempts))
          (fail :class :not-reached :description description))
      (incf attempt)
      (case (go-to-designated camera target 200)
        ((nil :goto-local) (setf there t))
        (:robot-blocked
         (if (look-for-things camera :local description)
             (setf there t)
             (seq (feel-ahead me)
                  (go-round me attempt)
                  (setf target (scan-for-thing camera description)))))
        (t (setf target (look-again camera description)))))
    (reckon me)))

(def-interp-proc visit-things (me camera description &key (candidates 3))
  "Look round for something that fits DESCRIPTION, drive the robot of the reckoning ME to it and
check it from there. If the thing does not fit, try another thing, at most CANDIDATES in all. Return
a local designator of a thing that fits, or NIL."
  (let ((found (if (look-for-things camera :local description)
                   (confirm-thing camera description)
                   nil)))
    (n-times candidates UNTIL found
      (let ((seen (scan-for-thing camera description)))
        (if (null seen) (return nil))
        (handle-failure ((:not-reached () (return nil)))
          (approach-thing me camera seen description)
          (setf found (confirm-thing camera description)))))
    found))
