;;;; placing.lisp -- putting things somewhere, and keeping the index and flags right.

(in-package :ars-magna.world)

(export '(place-thing tell-if-in-wall))

;;; Invariants: a thing on the floor is in the list of exactly the cell that holds its position;
;;; a thing in something is in exactly its contents; a cell's flags say what lies there.
;;; Everything that moves a thing goes through PLACE-THING.

(declaim (inline thing-flags))
(defun thing-flags (thing)
  "Return the flags of a cell with THING on its floor."
  (logior +occupied+
          (if (thing-obsmove-p thing) +obsmove+ 0)
          (if (thing-obsview-p thing) +obsview+ 0)))

(declaim (inline refresh-cell-flags set-mark))
(defun refresh-cell-flags (world index)
  "Make the flags of a cell of WORLD agree with the things on its floor."
  (declare (type world world) (type cell-index index))
  (let ((flags (world-flags world)))
    (setf (aref flags index) (logior (logand +wall+ (aref flags index))
                                     (marks-of-cell index (world-stock world))))))

(defun set-mark (thing stock)
  "Let STOCK know the flags of a cell with THING on its floor."
  (setf (aref (stock-marks stock) (thing-rank thing)) (thing-flags thing)))

(defun take-from-floor (thing)
  (declare #.*hot* (type thing thing))
  (let ((world (thing-world thing)) (index (thing-index thing)))
    (take-from-cell (thing-rank thing) index (world-stock world))
    (refresh-cell-flags world index)))

(declaim (inline add-flags))
(defun add-flags (rank index world)
  "Let the cell INDEX of WORLD have the flags that come of the thing with RANK."
  (let ((flags (world-flags world)))
    (setf (aref flags index)
          (logior (aref flags index) (aref (stock-marks (world-stock world)) rank)))))

(defun put-on-floor (thing x y)
  (declare #.*hot* (type thing thing) (type double-float x y))
  (setf (thing-x thing) x (thing-y thing) y (thing-location thing) :floor)
  (let* ((world (thing-world thing)) (stock (world-stock world)) (index (thing-index thing)))
    (set-mark thing stock)
    (append-to-cell (thing-rank thing) index stock)
    (add-flags (thing-rank thing) index world)))

(defun change-cell (rank world from to)
  "Take the thing with RANK from the cell FROM of WORLD, an index, to the cell TO, where it comes
last, without consing."
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
  (let ((from (thing-index thing)))
    (setf (thing-x thing) x (thing-y thing) y)
    (change-cell (thing-rank thing) (thing-world thing) from (thing-index thing))))

(defun take-away (thing)
  "Take THING from where it is, leaving it nowhere."
  (let ((location (thing-location thing)))
    (case location
      ((nil))
      (:floor (take-from-floor thing))
      (t (setf (location-contents location) (remove thing (location-contents location)))))
    (setf (thing-location thing) nil)))

(declaim (inline lay-down))
(defun lay-down (thing x y)
  "Take THING from wherever it is to the floor at X, Y, a point inside the map."
  (declare (type double-float x y))
  (cond ((eq :floor (thing-location thing)) (move-on-floor thing x y))
        (t (take-away thing)
           (put-on-floor thing x y))))

(defun place-thing (thing location &optional x y)
  "Put THING into LOCATION: NIL, what holds things, or :FLOOR at X, Y (metres, inside the map).
The primitive: it checks and tells nothing. Return THING."
  (if (eq location :floor)
      (let ((x (double x)) (y (double y)))
        (check-inside 'place-thing (world-map (thing-world thing)) x y)
        (lay-down thing x y))
      (progn
        (take-away thing)
        (setf (thing-location thing) location)
        (when location
          (setf (location-contents location)
                (append (location-contents location) (list thing))))))
  thing)

;; Whoever puts something by hand may put it anywhere on the map; but where that is of no use to
;; anybody it is said, in the same words whoever does so and how.
(defun tell-if-in-wall (what world x y)
  "Queue a warning if WHAT, a string, has been put into a wall of WORLD at (X,Y). The first one of
WHAT in a run is shown if nobody reads it."
  (when (wall-at-p (world-map world) x y)
    (queue-message (make-message :warning
                                 (list (phrase "~A is inside a wall now, at ~,2F, ~,2F" what x y))
                                 :notable-p (first-time-p (list :in-wall what) world))
                   *message-queue*)))

(defun check-inside (operator map x y)
  (unless (and (within-reason-p x) (within-reason-p y) (map-index map x y))
    (reject-argument operator "position" (list x y)
                     (format nil "a point of ~A, which is ~D by ~D metres"
                             map (map-width map) (map-height map)))))

(declaim (inline note-move))
(defun note-move (thing old-location new-location)
  (dolist (watcher (world-move-watchers (thing-world thing)))
    (funcall (the function watcher) thing old-location new-location)))

;;; Moving.

(defun holder-p (object)
  (and (compute-applicable-methods #'location-contents (list object)) t))

(defun check-holder (operator thing holder)
  "Signal unless HOLDER can hold THING (NIL: a new thing); return its world."
  (unless (holder-p holder)
    (reject-argument operator "location" holder
                     "a container, hand or storage bin, or a position"))
  (when (and (thing-p holder) (not (thing-alive-p holder)))
    (reject-use "~A has been destroyed." holder))
  (when thing
    (unless (eq (location-world holder) (thing-world thing))
      (reject-use "~A cannot go into ~A, which is in another world." thing (location-name holder)))
    (loop for outer = holder then (thing-location outer)
          while (thing-p outer)
          when (eq outer thing)
            do (reject-use "~A cannot go into itself." thing)))
  (location-world holder))

(defun check-movable (operator thing)
  (check-of-type operator "thing" thing 'thing)
  (unless (thing-world thing)
    (reject-use "~A is a prototype; make things from it with (new-thing ... :prototype)." thing))
  (unless (thing-alive-p thing) (reject-use "~A has been destroyed." thing)))

(defun relocate (thing location &optional x y)
  "Place THING and tell the watchers."
  (let ((old (thing-location thing)))
    (place-thing thing location x y)
    (note-move thing old location)
    thing))

(addition move-thing)
(defun move-thing (thing location &optional (y nil y-p))
  "Move THING to LOCATION: a container, hand or storage bin, or a position, either a list (x y)
or, as two arguments, its coordinates in metres. Walls, lids and capacities do not
matter; that it ends inside a wall is a warning among the messages. Signals WRONG-ARGUMENT outside
the map, MISUSE for prototypes, things destroyed, and a container put into itself. Return THING."
  (check-movable 'move-thing thing)
  (let ((position (cond (y-p (list location y))
                        ((number-pair-p location) location))))
    (if position
        (check-inside 'move-thing (world-map (thing-world thing)) (first position)
                      (second position))
        (check-holder 'move-thing thing location))
    (changing ((thing-world thing) move-thing thing (or position location))
      (if position
          (apply #'put-by-hand thing position)
          (relocate thing location)))))

(defun put-by-hand (thing x y)
  (relocate thing :floor x y)
  (tell-if-in-wall (princ-to-string thing) (thing-world thing) x y)
  thing)

(defun %destroy-thing (thing)
  (let ((old (thing-location thing)) (x (thing-x thing)) (y (thing-y thing)))
    (dolist (inside (copy-list (thing-contents thing)))
      (relocate inside old x y))
    (take-away thing)
    (detach-all-kickers thing)
    (setf (thing-alive-p thing) nil)
    (remove-thing thing (thing-world thing))
    (note-move thing old nil)))

(define-operator 'move-thing '(thing datum) #'move-thing)

(addition destroy-thing)
(defun destroy-thing (thing)
  "Destroy THING; what it contains stays where it was. Destroying it again does nothing.
Signals MISUSE for prototypes. Return nothing. See reading 168."
  (unless (and (thing-p thing) (not (thing-alive-p thing)))
    (check-movable 'destroy-thing thing)
    (changing ((thing-world thing) destroy-thing thing)
      (when (thing-alive-p thing) (%destroy-thing thing))))
  (values))

(define-operator 'destroy-thing '(thing) #'destroy-thing)
