;;;; sweeping.lisp -- how far a robot comes on its way, and what blocks it (manual 3.5).

(in-package :ars-magna.robot)

;;; Motion is swept: the robot passes through each cell between where it is and where it would
;;; be, and stops just short of the first that blocks. The cell it stands in never does, so that it
;;; is never trapped by a thing that comes to it. What cells block is in the world's flags. What it
;;; would enter by less than the contact gap it only brushes, and goes on.

(declaim (inline what-blocks))
(defun what-blocks (flag)
  "Return what keeps a robot out of a cell with FLAG: :WALL, :THING or NIL (reading 101)."
  (declare (type (unsigned-byte 8) flag))
  (cond ((logtest flag +wall+) :wall)
        ((logtest flag +obsmove+) :thing)))

;; Inline, so that no float has to be boxed on the way. A border belongs to the cell behind it for
;; those who go to the right or down, and to the cell before it for those who go back.
(declaim (inline free-way))
(defun free-way (world x y dx dy distance)
  "Return how far one can go from (X,Y), in the map, in direction (DX,DY), at most DISTANCE; column
and row of the cell where that is; what blocks the way: :WALL, :THING or NIL; and whether that is in
another column."
  (declare (type world world) (type double-float x y dx dy distance))
  (let* ((map (world-map world)) (flags (world-flags world))
         (cell-x (cell-number x)) (cell-y (cell-number y))
         (back-x (minusp dx)) (back-y (minusp dy))
         (step-x (if back-x -1 1)) (step-y (if back-y -1 1))
         (done nil) (block nil) (sideways nil)
         (at (walk-grid (lambda (index at column)
                          (cond ((and (>= at distance)
                                      (or (> at distance) (if column back-x back-y)))
                                 (setf done t))
                                ((setf block (what-blocks (aref flags index)))
                                 (setf sideways column)
                                 t)
                                (t (if column
                                       (incf cell-x step-x)
                                       (incf cell-y step-y))
                                   nil)))
                        (map-width map) (map-height map) x y dx dy +no-limit+ t)))
    (declare (type fixnum cell-x cell-y) (type double-float at))
    (if (or done (< distance at))
        (values distance cell-x cell-y nil nil)
        (values at cell-x cell-y (or block :wall)
                (if block
                    sideways
                    (<= (abs (- (+ x (* dx at)) (if back-x 0 (map-width map))))
                        (abs (- (+ y (* dy at)) (if back-y 0 (map-height map))))))))))

(defun pass-corner (robot x y column row)
  "Put ROBOT, which has come to (X,Y) in the cell at COLUMN and ROW and is blocked, into the cell
opposite if only a corner is in its way. True if so."
  (let ((world (robot-world robot)))
    (multiple-value-bind (beyond-x beyond-y) (beyond-corner world +blocking+ x y column row)
      (unless (or (null beyond-x)
                  (closed-cell-p world beyond-x beyond-y +blocking+))
        (setf (robot-x robot) beyond-x
              (robot-y robot) beyond-y)))))

(defun brushes-p (direction left)
  "True if a robot that moves LEFT metres comes no farther than the contact gap in DIRECTION."
  (<= (* left (abs direction)) +contact-gap+))

(defun over-border-p (position cell direction left)
  "True if a robot at POSITION on an axis, in the column or row CELL, that has LEFT metres to go may
be taken over the nearest border: it goes there anyway, or it goes along."
  (cond ((zerop direction) (/= position (fround position)))
        ((brushes-p direction left) t)
        ((= cell (round position)) (minusp direction))
        (t (plusp direction))))

(declaim (inline stand))
(defun stand (robot dx dy moved cell-x cell-y)
  "Move ROBOT by MOVED metres in direction (DX,DY), into the cell at CELL-X and CELL-Y."
  (declare (type robot robot) (type double-float dx dy moved))
  (setf (robot-x robot) (within-cell (+ (robot-x robot) (* dx moved)) cell-x)
        (robot-y robot) (within-cell (+ (robot-y robot) (* dy moved)) cell-y)
        (robot-moved robot) moved))

(declaim (inline pass-cells))
(defun pass-cells (robot world dx dy distance)
  "Move ROBOT, in the map of WORLD, by DISTANCE in direction (DX,DY), or to what blocks it. Leave
the metres in ROBOT-MOVED; return :WALL, :THING or NIL."
  (declare (type robot robot) (type world world) (type double-float dx dy distance))
  (multiple-value-bind (moved cell-x cell-y block sideways)
      (free-way world (robot-x robot) (robot-y robot) dx dy distance)
    (declare (type double-float moved))
    (cond (block
           (meet robot block dx dy moved (- distance moved) cell-x cell-y sideways))
          (t (stand robot dx dy moved cell-x cell-y)
             nil))))

(defun meet (robot block dx dy moved left cell-x cell-y sideways)
  "Let ROBOT come to BLOCK, in the next column if SIDEWAYS, else in the next row, after MOVED metres
with LEFT to go; and go on if that only touches its way. Return what blocks it, or NIL."
  (let ((x (+ (robot-x robot) (* dx moved))) (y (+ (robot-y robot) (* dy moved))))
    (cond ((brushes-p (if sideways dx dy) left)
           (stand robot dx dy moved cell-x cell-y)
           (if sideways
               (pass-on robot 0d0 dy left moved)
               (pass-on robot dx 0d0 left moved)))
          ((and (if sideways
                    (over-border-p y cell-y dy left)
                    (over-border-p x cell-x dx left))
                (pass-corner robot x y cell-x cell-y))
           (pass-on robot dx dy left moved))
          (t (stand robot dx dy (max 0d0 (- moved +contact-gap+)) cell-x cell-y)
             block))))

(defun pass-on (robot dx dy distance moved)
  "Do as PASS-CELLS does, for a ROBOT that has come MOVED metres already."
  (prog1 (pass-cells robot (robot-world robot) dx dy distance)
    (incf (robot-moved robot) moved)))

(defun leave-cell (robot)
  "Move ROBOT out of its cell along its heading by ROBOT-MOVED metres, backwards if those are
negative, or to what blocks it. Leave the metres in ROBOT-MOVED; return :WALL, :THING or NIL. From
outside the map there is no way."
  (declare #.*hot* (type robot robot))
  (let ((world (robot-world robot)) (dx (robot-cos robot)) (dy (robot-sin robot))
        (distance (robot-moved robot)))
    (declare (type world world))
    (cond ((null (point-index (world-map world) (robot-x robot) (robot-y robot)))
           (setf (robot-moved robot) 0d0)
           :wall)
          ((minusp distance)
           (prog1 (pass-cells robot world (- 0d0 dx) (- 0d0 dy) (- distance))
             (setf (robot-moved robot) (- (robot-moved robot)))))
          (t (pass-cells robot world dx dy distance)))))

(declaim (inline sweep))
(defun sweep (robot distance)
  "Move ROBOT along its heading by DISTANCE, backwards if that is negative, or to what blocks it.
Leave the metres in ROBOT-MOVED; return :WALL, :THING or NIL (reading 100)."
  (declare #.*hot* (type robot robot) (type double-float distance))
  (let* ((x (robot-x robot)) (y (robot-y robot))
         (cell-x (whole-part x)) (cell-y (whole-part y))
         (new-x (+ x (* (robot-cos robot) distance)))
         (new-y (+ y (* (robot-sin robot) distance))))
    (declare (type double-float new-x new-y))
    (setf (robot-moved robot) distance)
    (cond ((and (= (whole-part new-x) cell-x) (= (whole-part new-y) cell-y))
           (setf (robot-x robot) new-x (robot-y robot) new-y)
           nil)
          (t (leave-cell robot)))))
