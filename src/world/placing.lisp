;;;; placing.lisp -- putting things somewhere and kicking them there; the index and flags.

(in-package :ars-magna.world)

(export '(place-thing warn-if-in-wall check-inside-map))

;;; Invariants: a thing on the floor is in the list of exactly the cell that holds its position;
;;; a thing in something is in exactly its contents; a cell's flags say what lies there.
;;; Everything that moves a thing goes through PLACE-THING.

(declaim (inline thing-flags refresh-cell-flags record-thing-flags add-flags))
(defun thing-flags (thing)
  (logior +occupied+
          (if (thing-obsmove-p thing) +obsmove+ 0)
          (if (thing-obsview-p thing) +obsview+ 0)
          (if (and (thing-closed-p thing) (closed-door-p thing)) +closed-door+ 0)))

(defun refresh-cell-flags (world index)
  "Set the flags of the cell INDEX of WORLD from the map and the things on the cell's floor."
  (declare (type world world) (type cell-index index))
  (let ((flags (world-flags world)))
    (setf (aref flags index) (logior (logand +wall+ (aref flags index))
                                     (cell-thing-flags index (world-stock world))))))

(defun record-thing-flags (thing stock)
  (setf (aref (stock-marks stock) (thing-rank thing)) (thing-flags thing)))

(defun take-from-floor (thing)
  (declare #.*hot* (type thing thing))
  (let ((world (thing-world thing)) (index (thing-cell-index thing)))
    (take-from-cell (thing-rank thing) index (world-stock world))
    (refresh-cell-flags world index)))

(defun add-flags (rank index world)
  (let ((flags (world-flags world)))
    (setf (aref flags index)
          (logior (aref flags index) (aref (stock-marks (world-stock world)) rank)))))

(defun put-on-floor (thing x y)
  (declare #.*hot* (type thing thing) (type double-float x y))
  (setf (thing-x thing) x (thing-y thing) y (thing-location thing) :floor)
  (let* ((world (thing-world thing)) (stock (world-stock world)) (index (thing-cell-index thing)))
    (record-thing-flags thing stock)
    (append-to-cell (thing-rank thing) index stock)
    (add-flags (thing-rank thing) index world)))

(defun move-between-cells (rank world from to)
  "Move the thing with RANK from the cell FROM to the end of the cell TO of WORLD. Conses nothing."
  (declare #.*hot* (type cell-index rank from to) (type world world))
  (let ((stock (world-stock world)))
    (unless (and (= from to) (alone-in-cell-p rank from stock))
      (take-from-cell rank from stock)
      (refresh-cell-flags world from)
      (append-to-cell rank to stock)
      (add-flags rank to world))))

(declaim (inline move-on-floor))
(defun move-on-floor (thing x y)
  (declare (type double-float x y))
  (let ((from (thing-cell-index thing)))
    (setf (thing-x thing) x (thing-y thing) y)
    (move-between-cells (thing-rank thing) (thing-world thing) from (thing-cell-index thing))))

(defun remove-from-location (thing)
  (let ((location (thing-location thing)))
    (case location
      ((nil))
      (:floor (take-from-floor thing))
      (t (setf (location-contents location) (remove thing (location-contents location)))))
    (setf (thing-location thing) nil)))

(declaim (inline move-to-floor))
(defun move-to-floor (thing x y)
  "Move THING from any location to the floor at X, Y, a point inside the map."
  (declare (type double-float x y))
  (cond ((eq :floor (thing-location thing)) (move-on-floor thing x y))
        (t (remove-from-location thing)
           (put-on-floor thing x y))))

(defun place-thing (thing location &optional x y)
  "Put THING into LOCATION: NIL, a holder of things, or :FLOOR at X, Y (metres, inside the map).
Check only the position, and do not call the move watchers. Return THING."
  (if (eq location :floor)
      (let ((x (double x)) (y (double y)))
        (check-inside-map 'place-thing (world-map (thing-world thing)) x y)
        (move-to-floor thing x y))
      (progn
        (remove-from-location thing)
        (setf (thing-location thing) location)
        (when location
          (setf (location-contents location)
                (append (location-contents location) (list thing))))))
  thing)

;; You may put a thing or robot anywhere on the map by hand. A warning, in the same words
;; everywhere, says so if the position is most likely a mistake.
(defun warn-if-in-wall (what world x y)
  "If (X,Y) is in a wall of WORLD, queue a warning that WHAT, printed as by PRINC, is inside a wall.
The first such warning about WHAT in a run is also printed if no program reads it."
  (when (wall-at-p (world-map world) x y)
    (let ((what (princ-to-string what)))
      (queue-message-items :warning
                           (list (phrase "~A is inside a wall now, at ~,2F, ~,2F" what x y))
                           :notable-p (first-warning-for-key-p (list :in-wall what) world)))))

(defun check-inside-map (operator map x y)
  "Signal WRONG-ARGUMENT about OPERATOR unless (X,Y) is a point of MAP."
  (unless (and (sane-number-p x) (sane-number-p y) (map-index map x y))
    (reject-argument operator "position" (list x y)
                     (format nil "a point of ~A, which is ~D by ~D metres"
                             map (map-width map) (map-height map)))))

(declaim (inline call-move-watchers))
(defun call-move-watchers (thing old-location new-location)
  (dolist (watcher (world-move-watchers (thing-world thing)))
    (funcall (the function watcher) thing old-location new-location)))

;;; Moving.

(defun holder-p (object)
  (and (compute-applicable-methods #'location-contents (list object)) t))

(defun check-holder (operator thing holder)
  "Signal WRONG-ARGUMENT or MISUSE unless HOLDER can hold THING, or a new thing if THING is NIL.
Return the world of HOLDER."
  (unless (holder-p holder)
    (reject-argument operator "location" holder
                     "a container, hand or storage bin, or a position"))
  (when (and (thing-p holder) (not (thing-alive-p holder)))
    (reject-use "~A has been destroyed." holder))
  (when (body-p holder)
    (reject-use "~A is a robot. Things can be in its hands and bins, not in its body." holder))
  (when thing
    (unless (eq (location-world holder) (thing-world thing))
      (reject-use "~A cannot go into ~A, which is in another world." thing (location-name holder)))
    (loop for outer = holder then (thing-location outer)
          while (thing-p outer)
          when (eq outer thing)
            do (reject-use "~A cannot go into itself." thing)))
  (location-world holder))

(defun check-movable (operator thing)
  (unless (thing-p thing) (check-argument-type operator "thing" thing 'thing))
  (unless (thing-world thing)
    (reject-use "~A is a prototype; make things from it with (new-thing ... :prototype)." thing))
  (unless (thing-alive-p thing) (reject-use "~A has been destroyed." thing))
  (when (body-p thing)
    (reject-use "~A is a robot; its body moves only with it. PLACE-ROBOT puts a robot elsewhere."
                thing)))

(defun relocate (thing location &optional x y)
  "Put THING into LOCATION as PLACE-THING does, and call the move watchers."
  (let ((old (thing-location thing)))
    (place-thing thing location x y)
    (call-move-watchers thing old location)
    thing))

(addition move-thing)
(defun move-thing (thing location &optional (y nil y-p))
  "Move THING to LOCATION: a container, hand or storage bin, or a position in metres. A position is
a list (x y), or two arguments. Walls, lids and capacities do not matter, but a position inside a
wall queues a warning. Signals WRONG-ARGUMENT outside the map, MISUSE for prototypes, destroyed
things, and a container put into itself. Return THING."
  (check-movable 'move-thing thing)
  (let ((position (cond (y-p (list location y))
                        ((number-pair-p location) location))))
    (if position
        (check-inside-map 'move-thing (world-map (thing-world thing)) (first position)
                          (second position))
        (check-holder 'move-thing thing location))
    (changing ((thing-world thing) move-thing thing (or position location))
      (if position
          (apply #'put-on-floor-with-warning thing position)
          (relocate thing location)))))

(defun put-on-floor-with-warning (thing x y)
  (relocate thing :floor x y)
  (warn-if-in-wall thing (thing-world thing) x y)
  thing)

(defun %destroy-thing (thing)
  (let ((old (thing-location thing)) (x (thing-x thing)) (y (thing-y thing)))
    (dolist (inside (copy-list (thing-contents thing)))
      (relocate inside old x y))
    (remove-from-location thing)
    (detach-all-kickers thing)
    (setf (thing-alive-p thing) nil)
    (remove-thing thing (thing-world thing))
    (call-move-watchers thing old nil)))

(define-operator 'move-thing '(thing datum) #'move-thing)

(addition destroy-thing)
(defun destroy-thing (thing)
  "Destroy THING; its contents stay at its location. Destroying a destroyed thing has no effect.
Signals MISUSE for prototypes. Return nothing. See reading 168."
  (unless (and (thing-p thing) (not (thing-alive-p thing)))
    (check-movable 'destroy-thing thing)
    (changing ((thing-world thing) destroy-thing thing)
      (when (thing-alive-p thing) (%destroy-thing thing))))
  (values))

(define-operator 'destroy-thing '(thing) #'destroy-thing)

;;; Kicks. Manual 5.3.1. The path is not checked, only where it ends. From an open container or from
;;; a hand a thing is kicked onto the floor. Off the map is as in a wall, and so is a closed door.

(defun in-closed-holder-p (thing)
  (loop for location = (thing-location thing) then (thing-location location)
        until (eq location :floor)
        thereis (and location (location-closed-p location))
        while (thing-p location)))

(declaim (inline kickable-p free-point-p start-kick))
(defun kickable-p (thing)
  "True if THING is on the floor, or can get there because nothing around it is closed. False for
the body of a robot."
  (or (and (eq :floor (thing-location thing)) (not (robot-body-p thing)))
      (and (thing-location (thing-outermost thing))
           (not (eq :floor (thing-location thing)))
           (not (in-closed-holder-p thing)))))

(defun free-point-p (world x y)
  (declare (type double-float x y))
  (let ((index (point-index (world-map world) x y)))
    (and index (not (logtest +wall-or-door+ (aref (world-flags world) index))))))

;; It is on the stack, and is passed to functions instead of floats, which would be boxed.
(declaim (inline make-kick))
(defstruct (kick (:constructor make-kick (dx dy)) (:copier nil) (:predicate nil))
  "A kick by DX and DY metres, with the thing's position before (FROM-X, FROM-Y) and after (X, Y)."
  (dx 0d0 :type double-float :read-only t)
  (dy 0d0 :type double-float :read-only t)
  (from-x 0d0 :type double-float)
  (from-y 0d0 :type double-float)
  (x 0d0 :type double-float)
  (y 0d0 :type double-float))
(declaim-final kick)

(defun start-kick (kick thing)
  (declare (type kick kick) (type thing thing))
  (if (eq :floor (thing-location thing))
      (setf (kick-from-x kick) (thing-x thing)
            (kick-from-y kick) (thing-y thing))
      (setf (values (kick-from-x kick) (kick-from-y kick)) (thing-position thing)))
  (setf (kick-x kick) (+ (kick-from-x kick) (kick-dx kick))
        (kick-y kick) (+ (kick-from-y kick) (kick-dy kick)))
  kick)

(defun deflect-kick (kick world)
  "Let KICK end in another cell: of the eight cells around its end, the empty cell that is nearest
to its start. Return NIL if no cell is empty."
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
          do (when (and (free-point-p world x y) (or (not found) (< away least)))
               (setf (kick-x kick) x (kick-y kick) y least away found t)))
    found))

(defun %kick-thing (thing kick kick-if-wall)
  "Move THING by KICK, in a world that the calling thread may change. Return true if THING moved."
  (declare #.*hot* (type thing thing) (type kick kick))
  (when (kickable-p thing)
    (let ((world (thing-world thing)))
      (declare (type world world))
      (start-kick kick thing)
      (when (or (free-point-p world (kick-x kick) (kick-y kick))
                (and kick-if-wall (deflect-kick kick world)))
        (let ((old (thing-location thing)))
          (move-to-floor thing (kick-x kick) (kick-y kick))
          (call-move-watchers thing old :floor)
          t)))))

(defun check-and-kick-thing (thing dx dy kick-if-wall)
  (check-argument kick-thing thing (thing-p thing) (argument-type-text 'thing thing))
  (check-argument kick-thing dx (sane-number-p dx) (argument-type-text 'number dx))
  (check-argument kick-thing dy (sane-number-p dy) (argument-type-text 'number dy))
  (changing ((thing-world thing) kick-thing thing dx dy kick-if-wall)
    (let ((kick (make-kick (double dx) (double dy))))
      (declare (dynamic-extent kick))
      (%kick-thing thing kick kick-if-wall))))

(defun apply-kick-if-allowed (thing kick kick-if-wall)
  "Move THING by KICK, as KICK-THING does. Return :OTHERWISE if the arguments are invalid or this
thread may not change the world."
  (declare #.*hot* (type kick kick))
  (if (and (thing-p thing)
           (sane-number-p (kick-dx kick))
           (sane-number-p (kick-dy kick))
           (changing-thread-p (thing-world thing)))
      (%kick-thing thing kick kick-if-wall)
      :otherwise))

(deftype common-number ()
  "A number that inlined code converts to a double-float. Ratios may be too large for one."
  '(or double-float single-float fixnum))

;; Inline, so that floats computed by a kicker are not boxed.
(declaim (inline kick-thing))
(public kick-thing)
(defun kick-thing (thing dx dy kick-if-wall)
  "Move THING by DX, DY metres (manual 5.3.1). If the end is in a wall and KICK-IF-WALL is true,
move THING to one of the eight cells around the end: the empty cell nearest to its old position. If
KICK-IF-WALL is false, do not move THING. Return true if THING was put into a cell, perhaps its own.
Return NIL if THING is inside something closed, or is destroyed (reading 172)."
  (let ((moved (if (and (typep dx 'common-number) (typep dy 'common-number))
                   (let ((kick (make-kick (double dx) (double dy))))
                     (declare (dynamic-extent kick))
                     (apply-kick-if-allowed thing kick kick-if-wall))
                   :otherwise)))
    (if (eq moved :otherwise)
        (check-and-kick-thing thing dx dy kick-if-wall)
        moved)))

(define-operator 'kick-thing '(thing number number truth) #'kick-thing)
