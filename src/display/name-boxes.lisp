;;;; name-boxes.lisp -- where a name may stand beside its owner, and what it would hide there.

(in-package :ars-magna.display)

;;; A box index finds boxes that overlap a given one without a test of each. It divides the map into
;;; squares, and lists for each square the entries whose box meets it.

(defconstant +square-side+ 32 "The width of a square of a box index, in pixels.")
(defconstant +most-squares+ 1000
  "A box that overlaps more squares than this is listed as a large box.")

(defstruct (box-index (:constructor make-box-index (&optional base)) (:copier nil))
  "An index of boxes. SQUARES is a table from the number of a square to the entries (box . item)
whose box overlaps the square. LARGE lists the entries of large boxes. The entries of the index BASE
are found as well."
  (squares (make-hash-table) :type hash-table :read-only t)
  (large '() :type list)
  (base nil :type (or null box-index) :read-only t))

(defun some-overlapped-square (function box)
  "Call FUNCTION with the number of each square that BOX overlaps, until FUNCTION returns true.
Return the last value of FUNCTION."
  (destructuring-bind (first-column first-row last-column last-row)
      (mapcar (lambda (pixels) (values (floor pixels +square-side+))) box)
    ;; Two squares may have the same number: callers check for overlaps.
    (loop for row from first-row to last-row
            thereis (loop for column from first-column to last-column
                            thereis (funcall function (+ column (* row 65536)))))))

(defun large-box-p (box)
  (destructuring-bind (left top right bottom) box
    (< (* +most-squares+ (expt +square-side+ 2)) (* (- right left) (- bottom top)))))

(defun add-box (box item index)
  (let ((entry (cons box item)))
    (if (large-box-p box)
        (push entry (box-index-large index))
        (some-overlapped-square (lambda (square)
                                  (push entry (gethash square (box-index-squares index)))
                                  nil)
                                box))))

(defun index-boxes (boxes &optional (items boxes) base)
  "Return an index of BOXES with ITEMS, one for each box, in which the entries of the index BASE are
found as well."
  (let ((index (make-box-index base)))
    (mapc (lambda (box item) (add-box box item index)) boxes items)
    index))

(defun find-overlapping-item (box index &optional (test (constantly t)))
  (flet ((among (entries)
           (loop for (other . item) in entries
                 when (and (overlap-p box other) (funcall test item)) return item)))
    (or (among (box-index-large index))
        (some-overlapped-square (lambda (square) (among (gethash square (box-index-squares index))))
                                box)
        (and (box-index-base index)
             (find-overlapping-item box (box-index-base index) test)))))

(defun overlapping-items (box index)
  (let ((items '()))
    (find-overlapping-item box index (lambda (item) (pushnew item items) nil))
    items))

;;; Names.

;; Coordinates are floats, because arithmetic with ratios is slow.
(defstruct (label-target (:constructor %make-label-target (name x y half robot thing))
                         (:copier nil))
  "A thing or robot on the map whose name, NAME, is to be written. It is drawn up to HALF pixels
around X, Y. ROBOT is the image of a robot, or NIL for a thing. THING is the image of a thing or
NIL."
  (name "" :type string :read-only t)
  (x 0d0 :type double-float :read-only t) (y 0d0 :type double-float :read-only t)
  (half 0d0 :type double-float :read-only t)
  (robot nil :read-only t) (thing nil :read-only t))

(defun make-label-target (name x y half &optional robot thing)
  (flet ((double (number) (coerce number 'double-float)))
    (%make-label-target name (double x) (double y) (double half) robot thing)))

(defun label-target-box (spot)
  (box-around (label-target-x spot) (label-target-y spot) (label-target-half spot)))

(defconstant +name-size+ 10 "The height of the font of names, in pixels.")
(defconstant +name-height+ 11 "The height of the box of a name, in pixels.")

(defun candidate-name-boxes (x y half width)
  "Return boxes, best first, for a name WIDTH pixels wide beside a target, HALF pixels around X, Y."
  (let ((gap (+ half 2)) (high +name-height+))
    (loop for (left top) in (list (list (+ x gap) (- y (* 0.5d0 high)))
                                  (list (- x gap width) (- y (* 0.5d0 high)))
                                  (list (- x (* 0.5d0 width)) (- y gap high))
                                  (list (- x (* 0.5d0 width)) (+ y gap))
                                  (list (+ x (/ gap 2)) (- y gap high))
                                  (list (+ x (/ gap 2)) (+ y gap))
                                  (list (- x (/ gap 2) width) (- y gap high))
                                  (list (- x (/ gap 2) width) (+ y gap))
                                  ;; In a corner of walls: along a side.
                                  (list (- x half) (- y gap high))
                                  (list (- x half) (+ y gap))
                                  (list (- (+ x half) width) (- y gap high))
                                  (list (- (+ x half) width) (+ y gap))
                                  (list (+ x gap) (- y half))
                                  (list (+ x gap) (- (+ y half) high))
                                  (list (- x gap width) (- y half))
                                  (list (- x gap width) (- (+ y half) high)))
          collect (list left top (+ left width) (+ top high)))))

(defun boxes-beside-marks (x y half width marks)
  "Return boxes like CANDIDATE-NAME-BOXES. If a box of the index MARKS, such as a track's ring,
overlaps the target, add boxes beside that box. Without it, names as far away would be ambiguous."
  (append (candidate-name-boxes x y half width)
          (and (find-overlapping-item (box-around x y half) marks)
               (candidate-name-boxes x y (max half (+ 2 (track-radius))) width))))

(defun box-within-shown-part-p (snapshot box)
  (destructuring-bind ((left top right bottom) (first-x first-y last-x last-y))
      (list box (points-to-pixels (shown-part snapshot)))
    (and (<= first-x left) (<= first-y top) (<= right last-x) (<= bottom last-y))))

(defun some-cell-under-box-p (map box function)
  "FUNCTION is a function of a cell's index. True if it returns true for a cell of MAP that BOX
overlaps. BOX must be within MAP."
  (destructuring-bind (left top right bottom) box
    (flet ((cell (pixels limit) (min (floor pixels graphics-scale*) (1- limit))))
      (let ((width (map-width map)) (height (map-height map)))
        (loop for row from (cell top height) to (cell (- bottom 0.01d0) height)
                thereis (loop for column from (cell left width) to (cell (- right 0.01d0) width)
                                thereis (funcall function (+ column (* row width)))))))))

(defun on-wall-p (map box)
  (some-cell-under-box-p map box (lambda (index) (logtest +wall+ (aref (map-flags map) index)))))

(defun on-place-mark-p (map box)
  (some-cell-under-box-p map box (lambda (index)
                                   (drawn-place-type-p (svref (map-place-types map)
                                                              (aref (map-places map) index))))))

(defun on-trail-p (snapshot box)
  (destructuring-bind (left top right bottom) box
    (loop for robot in (snapshot-robots snapshot)
          thereis (do-trail ((robot-image-trail robot) x y)
                        thereis (and (< left (to-pixels x) right) (< top (to-pixels y) bottom))))))

(defconstant +least-wall-covering-scale+ 4
  "The least scale, in pixels per cell, at which names may hide parts of walls.")

(defun box-cost (snapshot layers box anywhere-p)
  "Return a cost for what a name in BOX would hide on the map of SNAPSHOT with LAYERS: 0 for
nothing, 1 for a trail, 2 for marks of places, 3 for a trail and marks, 4 for a part of a wall.
Return NIL if BOX is on a thin wall and ANYWHERE-P is false: then no name may be in BOX."
  (let ((map (snapshot-map snapshot)))
    (cond ((not (on-wall-p map box))
           (+ (if (and (member :places layers) (on-place-mark-p map box)) 2 0)
              (if (and (member :trail layers) (on-trail-p snapshot box)) 1 0)))
          ((or anywhere-p (<= +least-wall-covering-scale+ graphics-scale*)) 4))))

(defconstant +cost-of-covered-name+ 5
  "The cost of a box in which a name hides another name; see BOX-COST.")

(defun cost-with-covered-names (cost box covered)
  "Return COST, that of BOX or NIL. Add a cost if BOX overlaps a box of COVERED, an index or NIL."
  (if (and cost covered (find-overlapping-item box covered))
      (+ cost +cost-of-covered-name+)
      cost))

(defun best-box (snapshot layers boxes taken &key anywhere-p (own-p (constantly t)) covered)
  "Return the box in BOXES that hides least (see BOX-COST), or NIL if no box is possible. The box
must be in the part of the map that SNAPSHOT shows, and must overlap no box of the index TAKEN. If
possible, it overlaps no box of the index COVERED. OWN-P must return true for the box."
  (loop with best = nil and least = nil
        for box in boxes
        for cost = (and (box-within-shown-part-p snapshot box)
                        (not (find-overlapping-item box taken))
                        (funcall own-p box)
                        (cost-with-covered-names (box-cost snapshot layers box anywhere-p)
                                                 box covered))
        when (and cost (or (null least) (< cost least)))
          do (setf best box least cost)
        ;; No box hides less. Films spend most of their time here.
        until (eql 0 least)
        finally (return best)))
