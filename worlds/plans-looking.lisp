;;;; plans-looking.lisp -- plans that look for things and go to them.

;;; Good for any robot with a camera. A description is a descriptor specification of manual 3.4.2,
;;; such as ((:color blue) (:substance plastic)). Cameras often misread colours, overlook things
;;; and see some that are not there; so plans look several times, and once they are at what they
;;; take for the thing they make sure before a hand touches it.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-proc look-for-things (camera type description)
  "Return designators of the things of TYPE, :LOCAL or :NON-LOCAL, that CAMERA sees at once and that
fit DESCRIPTION; a list."
  (outcome (rpl-camera-get-all-object-designators camera type description)
           (vref camera-input* camera) (vref camera-designators* camera)))

(def-interp-proc turn-camera (camera angle)
  "Turn CAMERA by ANGLE. Return an error code or NIL."
  (outcome (rpl-camera-turn camera angle)
           (vref camera-moved* camera) (vref camera-movement-error* camera)))

(def-interp-proc scan-for-thing (camera description &key (type :non-local) (rounds 2))
  "Turn CAMERA, all round ROUNDS times at most, until it sees something that fits DESCRIPTION.
Return a designator of that, or NIL."
  (let ((found nil)
        (views (* rounds (ceiling 2pi (rpl-camera-field-of-view camera)))))
    (n-times views UNTIL found
      (setf found (first (look-for-things camera type description)))
      (if (null found)
          (turn-camera camera (rpl-camera-field-of-view camera))))
    found))

(def-interp-proc look-again (camera description)
  "Look with CAMERA, in the direction in which it points, a few times for what fits DESCRIPTION.
Return a designator or NIL."
  (let ((found nil))
    (n-times 4 UNTIL found
      (setf found (first (look-for-things camera :non-local description))))
    found))

;;; Making sure. A thing that fits is seen to fit more often than one that does not; each look
;;; counts for or against it until that is enough.

(def-interp-proc confirm-thing (camera description)
  "Look with CAMERA at what is next to the robot until it is plain whether something there fits
DESCRIPTION. Return a local designator of that, or NIL."
  (let ((score 0) (found nil))
    (loop UNTIL (or (>= score 5) (<= score -5))
      (let ((designators (look-for-things camera :local description)))
        (cond (designators (incf score 2) (setf found (first designators)))
              (t (decf score .5)))))
    (if (plusp score) found nil)))

;;; Approaching.

(def-interp-proc go-round (me attempt)
  "Take the robot of ME a little to the left or right, by the number ATTEMPT, of what is before it."
  (turn-by (if (evenp attempt) 1.2 -1.2))
  (drive-by 1.5)
  (reckon me))

(def-interp-proc approach-thing (me camera designator description &key (attempts 6))
  "Bring the robot of ME, led by CAMERA, to what DESIGNATOR denotes, which fits DESCRIPTION; when it
is lost, look for it again. Fails with :NOT-REACHED after ATTEMPTS."
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
  "Look round for what fits DESCRIPTION, from where the robot of ME is, and go to it; if it turns
out to be something else, to another, up to CANDIDATES. Return a local designator of it, or NIL."
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
