;;;; plans-searching.lisp -- three ways of searching for a thing when nobody knows where it is.

;;; Good for comparing plans: what is it worth to remember where one has looked, and what to keep
;;; one's eyes open on the way? A robot knows its map, and points of it from which, together, it
;;; overlooks the floor. HIDE-THING puts the thing anywhere there:
;;;
;;;   (with-simulation (robbie :seed 1)
;;;     (hide-thing 'vase '((:size 1) (:color violet) (:substance glass)))
;;;     (run-plan 'search-nearest '((:color violet) (:substance glass)) watson-lookouts*))
;;;
;;; Where chance decides, all ways have the same dice, of their own: trials.lisp says why.

(in-package :ars-worlds)
(in-readtable :nisp)

(defvar watson-lookouts*
  '((12.5 5.5) (20.5 6) (26 9.5) (34 7) (10 14.5) (29 14.5) (6 22.5) (16 22.5) (25.5 22.5)
    (35.5 22.5))
  "Points of WATSON, a list of lists (x y), from which, together, all its floor is overlooked.")

;;; Where to go next: of PLACES, those LEFT have not been looked at in this round.

(defun draw-place (me places left dice)
  "Return any of PLACES, as DICE say."
  (declare (ignore me left))
  (roll-element places dice))

(defun way-to (me place)
  "Return what the way of the robot of ME to PLACE costs, about its length in metres; NIL if there
is none."
  (let* ((chart (chart-now me))
         (start (nearest-free-point chart (reckon me))))
    (and start (way-cost chart start place))))

(defun nearest-place (me places left dice)
  "Return that of LEFT to which the way of the robot of ME costs least; any if it gets to none."
  (declare (ignore places dice))
  (flet ((straight (place) (distance-left me place)))
    (let ((nearest (first left)) (least nil))
      ;; No way is shorter than the straight one; finding ways is what takes long.
      (dolist (place (sort (copy-list left) #'< :key #'straight) nearest)
        (let ((way (if (or (null least) (< (- (straight place) 2) least))
                       (way-to me place))))
          (if (and way (or (null least) (< way least)))
              (setf nearest place least way)))))))

;;; Looking round, and making sure.

(def-interp-proc look-near-and-far (camera description)
  "Return a designator of what CAMERA sees that fits DESCRIPTION, next to the robot or not, or NIL."
  (or (first (look-for-things camera :local description))
      (first (look-for-things camera :non-local description))))

(def-interp-proc look-round (camera description)
  "Turn CAMERA all round, once, until it sees what fits DESCRIPTION. Return a designator or NIL."
  (let ((seen nil))
    (n-times (ceiling 2pi (rpl-camera-field-of-view camera)) UNTIL seen
      (setf seen (look-near-and-far camera description))
      (if (null seen)
          (turn-camera camera (rpl-camera-field-of-view camera))))
    seen))

(def-interp-proc make-out (me camera seen description)
  "Let the robot of ME go to what the designator SEEN denotes. True if that fits DESCRIPTION."
  (handle-failure ((:not-reached () (return nil)))
    (approach-thing me camera seen description)
    (if (confirm-thing camera description) t nil)))

(def-interp-proc find-from-here (me camera description &key (candidates 3))
  "Look round for what fits DESCRIPTION from where the robot of ME is, and go to it; if it turns out
to be something else, to another, up to CANDIDATES. True if it was found."
  (let ((found nil))
    (n-times candidates UNTIL found
      (let ((seen (look-round camera description)))
        (if (null seen) (return nil))
        (setf found (make-out me camera seen description))))
    found))

;;; What to do about a place.

(def-interp-proc go-and-look (me place camera description)
  "Bring the robot of ME to PLACE, and find what fits DESCRIPTION from there. True if it did."
  (travel-to me place)
  (find-from-here me camera description))

(defun other-camera (camera)
  "Return the index of a camera of the plans' robot that is not CAMERA, or NIL."
  (if (> (rpl-robot-num-cameras) 1)
      (if (zerop camera) 1 0)
      nil))

(def-interp-proc travel-watching (me place camera description)
  "Let the robot of ME travel to PLACE, led by another camera, while CAMERA looks ahead for what
fits DESCRIPTION. Where it sees such a thing the robot stops: return a designator of that, or NIL.
Fails with :ONLY-ONE-CAMERA if there is no other."
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
  "Do as GO-AND-LOOK does, and look ahead on the way as well, until it turns out that the robot does
not get to what it sees. True if it found the thing."
  (let ((seen (travel-watching me place camera description)))
    (cond ((null seen) (find-from-here me camera description))
          ((make-out me camera seen description) t)
          (t (go-and-look me place camera description)))))

;;; Searching.

(def-interp-proc search-places (description places choose visit rounds start camera)
  "Let the robot do VISIT, the name of a plan, to one of PLACES after the other, as the function
CHOOSE says, until that finds what fits DESCRIPTION: ROUNDS times as often as there are PLACES.
Return how far it drove, in metres, as it believes. Fails with :NOT-FOUND."
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
  "Let the robot look round for what fits DESCRIPTION from any of PLACES, points of its map, then
from any again, as chance will have it, and go to what it sees. It visits ROUNDS times as many as
there are. START is where it is, a list (x y heading); by default it finds that out. Return how far
it drove, in metres, as it believes; it stands next to the thing then. Fails with :NOT-FOUND."
  (search-places description places #'draw-place 'go-and-look rounds start camera))

(def-interp-proc search-nearest (description places
                                 &key (rounds 10) start (camera (widest-camera)))
  "Do as SEARCH-BY-CHANCE does, but go to the nearest of PLACES from which the robot has not looked
yet; when it has been at all, it begins anew, ROUNDS times in all."
  (search-places description places #'nearest-place 'go-and-look rounds start camera))

(def-interp-proc search-watchfully (description places
                                    &key (rounds 10) start (camera (widest-camera)))
  "Do as SEARCH-NEAREST does, but look with CAMERA on the way as well, and go to what is seen there
at once. Fails with :ONLY-ONE-CAMERA if there is no other to lead the robot through doorways."
  (search-places description places #'nearest-place 'look-on-the-way rounds start camera))
