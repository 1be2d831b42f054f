;;;; placing.lisp -- putting things somewhere, and keeping the index and flags right.

(in-package :ars-magna.world)

;;; Invariants: a thing on the floor is in the list of exactly the cell that holds its position;
;;; a thing in something is in exactly its contents; a cell's flags say what lies there.
;;; Everything that moves a thing goes through PLACE-THING.

(declaim (inline thing-flags))
(defun thing-flags (thing)
  "Return the flags of a cell with THING on its floor."
  (logior +occupied+
          (if (thing-obsmove-p thing) +obsmove+ 0)
          (if (thing-obsview-p thing) +obsview+ 0)))

(defun refresh-cell-flags (world index)
  "Make the flags of a cell of WORLD agree with the things on its floor."
  (declare #.*hot* (type world world) (type cell-index index))
  (let ((flags (logand +wall+ (aref (world-flags world) index))))
    (declare (type (unsigned-byte 8) flags))
    (dolist (thing (svref (world-cells world) index))
      (declare (type thing thing))
      (setf flags (logior flags (thing-flags thing))))
    (setf (aref (world-flags world) index) flags)))

(declaim (inline thing-index))
(defun thing-index (thing)
  "Return the index of the cell that THING, on the floor, lies in."
  (the cell-index (point-index (world-map (thing-world thing)) (thing-x thing) (thing-y thing))))

(declaim (inline add-link))
(defun add-link (link cells index)
  "Put LINK, a list of one thing, at the end of the list at INDEX of CELLS."
  (declare (type simple-vector cells) (type cell-index index) (type cons link))
  (let ((others (svref cells index)))
    (if others
        (setf (rest (last (the cons others))) link)
        (setf (svref cells index) link))))

(defun take-link (thing cells index)
  "Take THING out of the list at INDEX of CELLS. Return the list of one thing that it was there."
  (declare #.*hot* (type simple-vector cells) (type cell-index index))
  (let ((before nil) (link (svref cells index)))
    (declare (type list before) (type cons link))
    (loop until (eq thing (first link)) do (setf before link link (rest link)))
    (if before
        (setf (rest before) (rest link))
        (setf (svref cells index) (rest link)))
    (setf (rest link) '())
    link))

(defun take-from-floor (thing)
  (let ((world (thing-world thing)) (index (thing-index thing)))
    (take-link thing (world-cells world) index)
    (refresh-cell-flags world index)))

(defun put-on-floor (thing x y)
  (setf (thing-x thing) x (thing-y thing) y (thing-location thing) :floor)
  (let* ((world (thing-world thing)) (index (thing-index thing)) (flags (world-flags world)))
    (add-link (list thing) (world-cells world) index)
    (setf (aref flags index) (logior (aref flags index) (thing-flags thing)))))

(defun change-cell (thing world from to)
  "Take THING from the cell FROM of WORLD, an index, to the cell TO, where it comes last, without
consing."
  (declare #.*hot* (type thing thing) (type world world) (type cell-index from to))
  (let ((cells (world-cells world)) (flags (world-flags world)))
    (unless (and (= from to) (null (rest (the cons (svref cells from)))))
      (let ((link (take-link thing cells from)))
        (refresh-cell-flags world from)
        (add-link link cells to)
        (setf (aref flags to) (logior (aref flags to) (thing-flags thing)))))))

(declaim (inline move-on-floor))
(defun move-on-floor (thing x y)
  "Move THING, which is on the floor, to X, Y."
  (declare (type double-float x y))
  (let ((from (thing-index thing)))
    (setf (thing-x thing) x (thing-y thing) y)
    (change-cell thing (thing-world thing) from (thing-index thing))))

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

(defun check-inside (operator map x y)
  (unless (and (within-reason-p x) (within-reason-p y) (map-index map x y))
    (reject-value operator "position" (list x y)
                  (format nil "a point of ~A, which is ~D by ~D metres"
                          map (map-width map) (map-height map)))))

(declaim (inline note-move))
(defun note-move (thing old-location new-location)
  "Tell the watchers of THING's world."
  (dolist (watcher (world-move-watchers (thing-world thing)))
    (funcall (the function watcher) thing old-location new-location)))

;;; Moving.

(defun holder-p (object)
  "True if OBJECT can hold things."
  (and (compute-applicable-methods #'location-contents (list object)) t))

(defun check-holder (operator thing holder)
  "Signal unless HOLDER can hold THING (NIL: a new thing); return its world."
  (unless (holder-p holder)
    (reject-value operator "location" holder
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
  (unless (thing-p thing) (reject-value operator "thing" thing "a thing"))
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
matter. Signals WRONG-ARGUMENT outside the map, MISUSE for prototypes, things
destroyed, and a container put into itself. Return THING."
  (check-movable 'move-thing thing)
  (let ((position (cond (y-p (list location y))
                        ((number-pair-p location) location))))
    (if position
        (check-inside 'move-thing (world-map (thing-world thing)) (first position)
                      (second position))
        (check-holder 'move-thing thing location))
    (changing ((thing-world thing) move-thing thing (or position location))
      (if position
          (relocate thing :floor (first position) (second position))
          (relocate thing location)))))

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
