;;;; plans-searching.lisp -- three ways of searching for a thing whose position is unknown.

;;; For comparing plans: does it help to remember where the robot has looked, and to look while
;;; driving? The plans use the map, and points of it from which together the robot sees the whole
;;; floor. HIDE-THING puts the thing anywhere on it:
;;;
;;;   (with-simulation (robbie :seed 1)
;;;     (hide-thing 'vase '((:size 1) (:color violet) (:substance glass)))
;;;     (run-plan 'search-nearest '((:color violet) (:substance glass)) watson-lookouts*))
;;;
;;; All three draw their random choices from the same separate dice: see trials.lisp.

(in-package :ars-worlds)
(in-readtable :nisp)

(defvar watson-lookouts*
  '((12.5 5.5) (20.5 6) (26 9.5) (34 7) (10 14.5) (29 14.5) (6 22.5) (16 22.5) (25.5 22.5)
    (35.5 22.5))
  "Points (x y) of WATSON; from all of them together a robot sees the whole floor.")

;;; Where to go next. LEFT are those of PLACES that were not visited in this round.

(defun random-place (me places left dice)
  (declare (ignore me left))
  (roll-element places dice))

(defun cost-of-way-to (me place)
  "Return the cost of the way from the robot of the reckoning ME to PLACE, about its length in
metres; NIL if there is no way."
  (let* ((chart (current-chart me))
         (start (nearest-free-point chart (reckon me))))
    (and start (way-cost chart start place))))

(defun nearest-place (me places left dice)
  "Return the one of LEFT that the robot of ME reaches most cheaply; the first if there is no way."
  (declare (ignore places dice))
  (flet ((straight (place) (distance-left me place)))
    (let ((nearest (first left)) (least nil))
      ;; Finding ways takes long, and none is shorter than the straight line: skip places too far.
      (dolist (place (sort (copy-list left) #'< :key #'straight) nearest)
        (let ((way (if (or (null least) (< (- (straight place) 2) least))
                       (cost-of-way-to me place))))
          (if (and way (or (null least) (< way least)))
              (setf nearest place least way)))))))

;;; Looking round, and checking.

(def-interp-proc look-near-and-far (camera description)
  "Return a designator of a thing, near or far, that CAMERA sees and that fits DESCRIPTION; or NIL."
  (or (first (look-for-things camera :local description))
      (first (look-for-things camera :non-local description))))

(def-interp-proc look-round (camera description)
  "Turn CAMERA, at most once round, until a designator fits DESCRIPTION. Return it or NIL."
  (let ((seen nil))
    (n-times (ceiling 2pi (rpl-camera-field-of-view camera)) UNTIL seen
      (setf seen (look-near-and-far camera description))
      (if (null seen)
          (turn-camera camera (rpl-camera-field-of-view camera))))
    seen))

(def-interp-proc make-out (me camera seen description)
  "Drive the robot of ME to the designator SEEN. Return true if the thing there fits DESCRIPTION."
  (handle-failure ((:not-reached () (return nil)))
    (approach-thing me camera seen description)
    (if (confirm-thing camera description) t nil)))

(def-interp-proc find-from-here (me camera description &key (candidates 3))
  "Look round for something that fits DESCRIPTION, and drive the robot of the reckoning ME to it. If
it does not fit, try another, at most CANDIDATES in all. Return true if a thing was found."
  (let ((found nil))
    (n-times candidates UNTIL found
      (let ((seen (look-round camera description)))
        (if (null seen) (return nil))
        (setf found (make-out me camera seen description))))
    found))

;;; Visits to a place.

(def-interp-proc go-and-look (me place camera description)
  "Drive the robot of the reckoning ME to PLACE, and look from there for something that fits
DESCRIPTION. Return true if such a thing was found."
  (travel-to me place)
  (find-from-here me camera description))

(defun other-camera (camera)
  "Return the index of a camera of the plan's robot other than CAMERA, or NIL if there is none."
  (if (> (rpl-robot-num-cameras) 1)
      (if (zerop camera) 1 0)
      nil))

(def-interp-proc travel-watching (me place camera description)
  "Drive the robot of the reckoning ME to PLACE, guided by another camera, while CAMERA looks ahead
for something that fits DESCRIPTION. Stop as soon as CAMERA sees such a thing, and return its
designator; on arrival, return NIL. Fails with :ONLY-ONE-CAMERA if there is no other camera."
  (let ((seen nil)
        (guide (or (other-camera camera) (fail :class :only-one-camera))))
    (outcome (rpl-camera-align-robot camera)
             (vref camera-moved* camera) (vref camera-movement-error* camera))
    (pursue (travel-to me place :camera guide)
            (loop UNTIL seen
              (setf seen (first (look-for-things camera :non-local description)))))
    (if seen (stand-still))
    (reckon me)
    seen))

(def-interp-proc look-on-the-way (me place camera description)
  "Do GO-AND-LOOK, and also look ahead while driving. If a thing seen on the way does not fit after
all, or cannot be reached, drive on without looking. Return true if the thing was found."
  (let ((seen (travel-watching me place camera description)))
    (cond ((null seen) (find-from-here me camera description))
          ((make-out me camera seen description) t)
          (t (go-and-look me place camera description)))))

;;; Searching.

(def-interp-proc search-places (description places choose visit rounds start camera)
  "Call VISIT, the name of a plan, for one of PLACES after another until VISIT finds something that
fits DESCRIPTION. The function CHOOSE returns the next place. There are at most ROUNDS visits
for each of PLACES. Return the estimated metres driven. Fails with :NOT-FOUND."
  (check-points 'search-places 'places places)
  (with-valve ((rpl-robot-valve))
    (let ((me (begin-reckoning (or start (here (rpl-robot)))))
          (dice (dice-for 'searching))
          (left places)
          (found nil))
      (n-times (* rounds (length places)) UNTIL found
        (let ((place (funcall choose me places left dice)))
          (setf left (or (remove place left) places))
          (handle-failure ((:cannot-get-there () (return nil)))
            (setf found (call-plan visit me place camera description)))))
      (if (not found)
          (fail :class :not-found :description description :places places
                :driven (reckoning-driven me)))
      (reckoning-driven me))))

(def-interp-proc search-by-chance (description places
                                   &key (rounds 10) start (camera (widest-camera)))
  "Visit random PLACES, points of the map, and look round from each with CAMERA for something that
fits DESCRIPTION. Stop next to the thing. There are at most ROUNDS visits for each of PLACES. START
is the robot's position, a list (x y heading); the default is the true position. Return the
estimated metres driven. Fails with :NOT-FOUND."
  (search-places description places #'random-place 'go-and-look rounds start camera))

(def-interp-proc search-nearest (description places
                                 &key (rounds 10) start (camera (widest-camera)))
  "Search as SEARCH-BY-CHANCE does, but always visit the nearest of PLACES that was not visited in
this round. A round visits all PLACES; there are ROUNDS rounds."
  (search-places description places #'nearest-place 'go-and-look rounds start camera))

(def-interp-proc search-watchfully (description places
                                    &key (rounds 10) start (camera (widest-camera)))
  "Search as SEARCH-NEAREST does, but also look with CAMERA while driving, and drive at once to what
CAMERA sees. Fails with :ONLY-ONE-CAMERA if no other camera can guide the robot."
  (search-places description places #'nearest-place 'look-on-the-way rounds start camera))
