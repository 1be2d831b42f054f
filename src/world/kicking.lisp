;;;; kicking.lisp -- moving a thing by a kick.

(in-package :ars-magna.world)

;;; Manual 5.3.1. The path is not checked, only where it ends. From an open container or from
;;; a hand a thing is kicked onto the floor. Off the map is as in a wall.

(defun enclosed-p (thing)
  "True if THING is in anything closed, directly or not."
  (loop for location = (thing-location thing) then (thing-location location)
        until (eq location :floor)
        thereis (and location (location-closed-p location))
        while (thing-p location)))

(declaim (inline kickable-p))
(defun kickable-p (thing)
  "True if THING lies on the floor, or where nothing closed keeps it from getting there."
  (or (eq :floor (thing-location thing))
      (and (thing-location (thing-outermost thing))
           (not (enclosed-p thing)))))

(declaim (inline open-at-p))
(defun open-at-p (world x y)
  (declare (type double-float x y))
  (let ((index (point-index (world-map world) x y)))
    (and index (not (logtest +wall+ (aref (world-flags world) index))))))

;; It lives on the stack, and functions get it instead of floats, which would have to be boxed.
(declaim (inline make-kick))
(defstruct (kick (:constructor make-kick (dx dy)) (:copier nil) (:predicate nil))
  "A kick by DX and DY, from where the thing is to where it comes, all in metres."
  (dx 0d0 :type double-float :read-only t)
  (dy 0d0 :type double-float :read-only t)
  (from-x 0d0 :type double-float)
  (from-y 0d0 :type double-float)
  (x 0d0 :type double-float)
  (y 0d0 :type double-float))
(declaim-final kick)

(declaim (inline start-kick))
(defun start-kick (kick thing)
  "Let KICK begin where THING is. Return KICK."
  (declare (type kick kick) (type thing thing))
  (if (eq :floor (thing-location thing))
      (setf (kick-from-x kick) (thing-x thing)
            (kick-from-y kick) (thing-y thing))
      (setf (values (kick-from-x kick) (kick-from-y kick)) (thing-position thing)))
  (setf (kick-x kick) (+ (kick-from-x kick) (kick-dx kick))
        (kick-y kick) (+ (kick-from-y kick) (kick-dy kick)))
  kick)

(defun deflect-kick (kick world)
  "Let KICK end in the middle of the empty cell beside the one where it would, the nearest to where
it begins. NIL if there is none, as all eight are filled."
  (declare #.*hot* (type kick kick) (type world world))
  (let ((column (floor (the (double-float -2d9 2d9) (kick-x kick))))
        (row (floor (the (double-float -2d9 2d9) (kick-y kick))))
        (least 0d0) (found nil))
    (declare (type double-float least))
    (loop for (dx dy) of-type (fixnum fixnum)
            in '((0 -1) (1 0) (0 1) (-1 0) (1 -1) (1 1) (-1 1) (-1 -1))
          for x of-type double-float = (+ (the fixnum (+ column dx)) 0.5d0)
          for y of-type double-float = (+ (the fixnum (+ row dy)) 0.5d0)
          for away of-type double-float = (+ (expt (- x (kick-from-x kick)) 2)
                                             (expt (- y (kick-from-y kick)) 2))
          do (when (and (open-at-p world x y) (or (not found) (< away least)))
               (setf (kick-x kick) x (kick-y kick) y least away found t)))
    found))

(defun %kick-thing (thing kick kick-if-wall)
  "Move THING, in a world that may be changed here, by KICK. True if it moved."
  (declare #.*hot* (type thing thing) (type kick kick))
  (when (kickable-p thing)
    (let ((world (thing-world thing)))
      (declare (type world world))
      (start-kick kick thing)
      (when (or (open-at-p world (kick-x kick) (kick-y kick))
                (and kick-if-wall (deflect-kick kick world)))
        (let ((old (thing-location thing)))
          (lay-down thing (kick-x kick) (kick-y kick))
          (note-move thing old :floor)
          t)))))

(defun kick-by-numbers (thing dx dy kick-if-wall)
  (check-argument kick-thing thing (thing-p thing) (argument-type-text 'thing thing))
  (check-argument kick-thing dx (within-reason-p dx) (argument-type-text 'number dx))
  (check-argument kick-thing dy (within-reason-p dy) (argument-type-text 'number dy))
  (changing ((thing-world thing) kick-thing thing dx dy kick-if-wall)
    (let ((kick (make-kick (double dx) (double dy))))
      (declare (dynamic-extent kick))
      (%kick-thing thing kick kick-if-wall))))

(defun kick-by (thing kick kick-if-wall)
  "Do what KICK-THING says, by KICK; but return :OTHERWISE if it cannot be done so."
  (declare #.*hot* (type kick kick))
  (if (and (thing-p thing)
           (within-reason-p (kick-dx kick))
           (within-reason-p (kick-dy kick))
           (writing-p (thing-world thing)))
      (%kick-thing thing kick kick-if-wall)
      :otherwise))

(deftype common-number ()
  "A number that the caller of KICK-THING makes a double-float of. Ratios may be too large."
  '(or double-float single-float fixnum))

;; Inline, so that what a kicker reckons in floats is not boxed.
(declaim (inline kick-thing))
(public kick-thing)
(defun kick-thing (thing dx dy kick-if-wall)
  "Move THING by DX, DY metres (manual 5.3.1). If that ends in a wall, move it to an empty cell
beside that one (the nearest to where it was) if KICK-IF-WALL is true, or else not at all. True
if it was put into a cell, which may be its own; NIL also if it is inside something closed or has
been destroyed (reading 172)."
  (let ((moved (if (and (typep dx 'common-number) (typep dy 'common-number))
                   (let ((kick (make-kick (double dx) (double dy))))
                     (declare (dynamic-extent kick))
                     (kick-by thing kick kick-if-wall))
                   :otherwise)))
    (if (eq moved :otherwise)
        (kick-by-numbers thing dx dy kick-if-wall)
        moved)))

(define-operator 'kick-thing '(thing number number truth) #'kick-thing)
