;;;; descent.lisp -- from a start down a field to its goal, as a way at any angle with few turns.

(in-package :ars-magna.ways)

;;;; What a straight line costs

;;; A line is cut at all whole and half coordinates: a piece of it is in one cell, whose cost
;;; counts, and in one square between nodes, which must have no wall at its corners. So lines keep
;;; half a metre off walls, as steps from node to node do. But one along a row of nodes, as through
;;; a doorway, need only cross free cells; and from near a wall a line may leave its first cell at
;;; any angle at which nothing else is near.

(deftype metres () '(double-float -1d5 1d5))
(deftype halves () "A whole number of half metres." '(signed-byte 20))

(declaim (inline cost-per-metre))
(defun cost-per-metre (cells columns i j narrow)
  "Return the cost of a metre in (I J), a square half as wide and high as a cell of CELLS. NARROW is
true for a line that needs only free cells, and no distance from walls."
  (declare (type amounts cells) (type (integer 0 40000) columns) (type halves i j))
  (flet ((cell (column row) (aref cells (the node (+ 1 column row))))
         (row (j) (* columns (1+ (ash j -1)))))
    (declare (inline cell row))
    (or (unless narrow
          (let ((left (ash (1- i) -1)) (right (ash (1+ i) -1))
                (above (row (1- j))) (below (row (1+ j))))
            (when (or (>= (cell left above) +barred-cost+) (>= (cell left below) +barred-cost+)
                      (>= (cell right above) +barred-cost+) (>= (cell right below) +barred-cost+))
              +barred-cost+)))
        (cell (ash i -1) (row j)))))

;; Allocated on the stack and passed to functions instead of floats, which would have to be boxed.
(declaim (inline make-line))
(defstruct (line (:constructor make-line (x y end-x end-y limit)) (:copier nil) (:predicate nil))
  "A straight line from (X,Y) to (END-X,END-Y), the largest cost LIMIT allowed, and its COST."
  (x 0d0 :type metres :read-only t)
  (y 0d0 :type metres :read-only t)
  (end-x 0d0 :type metres :read-only t)
  (end-y 0d0 :type metres :read-only t)
  (limit 0d0 :type double-float :read-only t)
  (cost 0d0 :type double-float))
(declaim-final line)

(defun measure-line (line cells columns leaving)
  "Store LINE's cost; it is +BARRED-COST+ if LINE is not free or costs more than its limit. CELLS
belong to a terrain or field of COLUMNS columns. LEAVING is true if LINE may begin near a wall."
  (declare #.*hot* (type line line) (type amounts cells) (type (integer 0 40000) columns))
  (let* ((u (* 2 (line-x line))) (v (* 2 (line-y line)))
         (du (- (* 2 (line-end-x line)) u)) (dv (- (* 2 (line-end-y line)) v))
         (limit (line-limit line))
         (length (* 0.5d0 (sqrt (+ (* du du) (* dv dv)))))
         (i (if (minusp du) (1- (ceiling u)) (floor u)))
         (j (if (minusp dv) (1- (ceiling v)) (floor v)))
         (along (or (and (zerop dv) (oddp j) (= v (double j)))
                    (and (zerop du) (oddp i) (= u (double i)))))
         (start-i (ash i -1)) (start-j (ash j -1))
         (part 0d0) (sum 0d0))
    (declare (type halves i j) (type double-float part sum length))
    (flet ((first-crossing (start change half)
             (declare (type double-float start change) (type halves half))
             (cond ((plusp change) (/ (- (double (1+ half)) start) change))
                   ((minusp change) (/ (- (double half) start) change))
                   (t 2d0)))
           (between (change) (if (zerop change) 0d0 (/ (abs change)))))
      (declare (inline first-crossing between))
      (let ((next-u (first-crossing u du i)) (next-v (first-crossing v dv j))
            (between-u (between du)) (between-v (between dv))
            (step-i (if (plusp du) 1 -1)) (step-j (if (plusp dv) 1 -1)))
        (declare (type double-float next-u next-v between-u between-v))
        (setf (line-cost line)
              (loop
                (let* ((next (min next-u next-v 1d0)) (piece (* length (- next part))))
                  ;; A line through a corner touches what it does not cross.
                  (when (> piece 1d-9)
                    (let ((narrow (or along
                                      (and leaving (= (ash i -1) start-i) (= (ash j -1) start-j)))))
                      (incf sum (* piece (cost-per-metre cells columns i j narrow))))
                    (when (> sum limit) (return +barred-cost+)))
                  (when (>= next 1d0) (return sum))
                  (setf part (max part next))
                  (if (<= next-u next-v)
                      (setf i (+ i step-i) next-u (+ next-u between-u))
                      (setf j (+ j step-j) next-v (+ next-v between-v))))))))))

;;;; Steps

;;; From a point in a cell, a step leads to the best point of the ring around the cell's middle: of
;;; the eight sides between the middles of its neighbours. Only points whose cost is less by at
;;; least an eighth count. So a descent ends, and depends only on settled nodes.

(defconstant +least-drop+ 0.125d0 "By how much each step must lower the cost to the goal.")

(defstruct (descent (:constructor make-descent (field x y value)) (:copier nil))
  "A position (X,Y) on the way down FIELD to its goal. VALUE is the cost from there to the goal."
  (field nil :type field :read-only t)
  (x 0d0 :type double-float)
  (y 0d0 :type double-float)
  (value 0d0 :type double-float)
  ;; What the last step cost.
  (step 0d0 :type double-float))
(declaim-final descent)

(declaim (inline descent-node))
(defun descent-node (descent)
  (+ 1 (truncate (the (double-float 0d0 32768d0) (descent-x descent)))
     (* (field-columns (descent-field descent))
        (1+ (truncate (the (double-float 0d0 32768d0) (descent-y descent)))))))

(declaim (inline best-point-on-side))
(defun best-point-on-side (ahead aside drop cost)
  "Return where the cheapest way crosses a side of a square, as a position from 0 to 1. The way
starts AHEAD metres in front of the side and ASIDE metres along it. A metre on the way to the side
costs COST. The cost to the goal is lower by DROP at the end of the side than at its beginning."
  (declare (type double-float ahead aside drop cost))
  (cond ((<= drop 0d0) (clamp aside 0d0 1d0))
        ((>= drop cost) 1d0)
        (t (clamp (+ aside (/ (* drop ahead)
                              (sqrt (the (double-float 0d0) (- (* cost cost) (* drop drop))))))
                  0d0 1d0))))

;;; The eight sides of the ring are the same but for turns and mirrors. A side lies in the direction
;;; SIDE and runs from the middle of the neighbour there, STRAIGHT, in the direction ACROSS to that
;;; of the one at the corner, DIAGONAL:
;;;
;;;        square | DIAGONAL         The way to the start of the side crosses two cells, this one
;;;        -------+-----^---         and STRAIGHT, along their EDGE; that to any other point of it
;;;           *   | STRAIGHT         possibly all four of the SQUARE. A metre costs what it costs in
;;;                                  the most expensive cell that may be crossed.
;;;
;;; The robot * is OFF the middle of its cell: the side is AHEAD metres away, and the robot ASIDE
;;; metres along it. PART of a side, from 0 to 1, is how far along it a point lies.

(defun step-down (descent)
  "Move DESCENT one step down to lower costs. Return true if there was such a step."
  (declare #.*hot* (type descent descent))
  (let* ((field (descent-field descent)) (node (descent-node descent))
         (x (descent-x descent)) (y (descent-y descent))
         (limit (- (descent-value descent) +least-drop+))
         (middle-x (+ (ffloor x) 0.5d0)) (middle-y (+ (ffloor y) 0.5d0))
         (off-x (- x middle-x)) (off-y (- y middle-y))
         (least +barred-cost+) (best-x 0d0) (best-y 0d0) (best-value 0d0))
    (declare (type double-float limit least best-x best-y best-value middle-x middle-y))
    (with-field (field)
      (flet ((look (side-x side-y across-x across-y)
               (declare (type (integer -1 1) side-x side-y across-x across-y))
               (let* ((side (+ side-x (* columns side-y)))
                      (across (+ across-x (* columns across-y)))
                      (straight (+ node side)) (diagonal (+ straight across))
                      (start (total straight)) (end (total diagonal))
                      (edge (max (cell node) (cell straight)))
                      (square (max edge (cell diagonal) (cell (the node (+ node across)))))
                      (ahead (- 1d0 (+ (* side-x off-x) (* side-y off-y))))
                      (aside (+ (* across-x off-x) (* across-y off-y))))
                 (declare (type node straight diagonal) (type double-float ahead aside))
                 (flet ((propose (cost part value)
                          (declare (type double-float cost part value))
                          (let* ((left (- part aside))
                                 (sum (+ value (* cost (sqrt (+ (* ahead ahead) (* left left)))))))
                            (when (< sum least)
                              (setf least sum best-value value
                                    best-x (+ middle-x side-x (* across-x part))
                                    best-y (+ middle-y side-y (* across-y part)))))))
                   (declare (inline propose))
                   (when (<= start limit) (propose edge 0d0 start))
                   ;; If only the corner is low enough, nothing is known of the points before it.
                   (when (and (< square +barred-cost+) (<= end limit))
                     (if (<= start limit)
                         (let ((part (best-point-on-side ahead aside (- start end) square)))
                           (propose square part (+ start (* part (- end start)))))
                         (propose square 1d0 end)))))))
        (look 1 0 0 1) (look 1 0 0 -1) (look -1 0 0 1) (look -1 0 0 -1)
        (look 0 1 1 0) (look 0 1 -1 0) (look 0 -1 1 0) (look 0 -1 -1 0)))
    (when (< least +barred-cost+)
      (setf (descent-x descent) best-x
            (descent-y descent) best-y
            (descent-value descent) best-value
            (descent-step descent) (- least best-value))
      t)))

;;;; Drawing a way

(defconstant +straight-cost-ratio+ 1.02d0
  "The most that a straight line, which saves turns, may cost relative to the steps it replaces.")

(defstruct (polyline (:constructor make-polyline (x y)) (:copier nil))
  "A way under construction. POINTS are its vertices, the latest first. (X,Y) is the start or the
latest vertex; from there the way leads to (END-X,END-Y), at the cost SINCE."
  (x 0d0 :type double-float)
  (y 0d0 :type double-float)
  (end-x x :type double-float)
  (end-y y :type double-float)
  (since 0d0 :type double-float)
  (points '() :type list))
(declaim-final polyline)

(defun add-vertex (polyline)
  (push (make-pt (polyline-end-x polyline) (polyline-end-y polyline)) (polyline-points polyline))
  (setf (polyline-x polyline) (polyline-end-x polyline)
        (polyline-y polyline) (polyline-end-y polyline)
        (polyline-since polyline) 0d0))

(declaim (inline free-line-cost))
(defun free-line-cost (field x y end-x end-y limit leaving)
  "Return the cost of the straight line from (X,Y) to (END-X,END-Y) on the cells of FIELD;
+BARRED-COST+ if the line is not free, or costs more than LIMIT. If LEAVING, the line may begin near
a wall."
  (let ((line (make-line x y end-x end-y limit)))
    (declare (dynamic-extent line))
    (measure-line line (field-cells field) (field-columns field) leaving)
    (line-cost line)))

(declaim (inline on-first-line-p))
(defun on-first-line-p (polyline)
  (null (polyline-points polyline)))

(declaim (inline straight-line-allowed-p extend-polyline))
(defun straight-line-allowed-p (polyline field x y limit last)
  "True if the line from the last vertex of POLYLINE to (X,Y) is free and costs no more than LIMIT.
If LAST, this line ends the way, and may end as near to a wall as a first line may begin."
  (declare (type polyline polyline) (type metres x y) (type double-float limit))
  (let ((from-x (polyline-x polyline)) (from-y (polyline-y polyline)))
    (or (< (free-line-cost field from-x from-y x y limit (on-first-line-p polyline)) +barred-cost+)
        (and last (< (free-line-cost field x y from-x from-y limit t) +barred-cost+)))))

(defun extend-polyline (polyline field x y cost last)
  "Extend POLYLINE to (X,Y) by a free step of COST, without a turn if a straight line is as good."
  (declare #.*hot* (type polyline polyline) (type metres x y) (type double-float cost))
  (let ((since (+ (polyline-since polyline) cost)))
    (unless (or (zerop (polyline-since polyline))
                (straight-line-allowed-p polyline field x y (* since +straight-cost-ratio+) last))
      (add-vertex polyline)
      (setf since cost))
    (setf (polyline-since polyline) since
          (polyline-end-x polyline) x
          (polyline-end-y polyline) y)
    nil))

(defun extend-by-step (polyline field x y cost &optional last)
  "Extend POLYLINE to (X,Y) by a step that costs COST at most. LAST is true for the last step."
  (declare #.*hot* (type polyline polyline) (type metres x y) (type double-float cost))
  (let* ((from-x (polyline-end-x polyline)) (from-y (polyline-end-y polyline))
         (true-cost (free-line-cost field from-x from-y x y cost (on-first-line-p polyline))))
    (declare (type metres from-x from-y))
    (when (and (>= true-cost +barred-cost+) (not last) (plusp (polyline-since polyline)))
      ;; By way of the cell's middle it keeps off all walls.
      (let ((middle-x (+ (ffloor from-x) 0.5d0)) (middle-y (+ (ffloor from-y) 0.5d0)))
        (extend-polyline polyline field middle-x middle-y
                         (free-line-cost field from-x from-y middle-x middle-y (/ +barred-cost+ 2)
                                         nil)
                         nil)))
    (extend-polyline polyline field x y (min cost true-cost) last)))

(defun trace-way (polyline descent goal-x goal-y until turns)
  "Extend POLYLINE along DESCENT to (GOAL-X,GOAL-Y), to a cell for which the function UNTIL returns
true, or until POLYLINE has TURNS vertices."
  (let* ((field (descent-field descent)) (goal (field-goal field))
         (node (descent-node descent)))
    (loop until (or (= node goal)
                    (and turns (nthcdr (1- turns) (polyline-points polyline)))
                    (not (step-down descent)))
          do (extend-by-step polyline field
                             (descent-x descent) (descent-y descent) (descent-step descent))
             (let ((next (descent-node descent)))
               (when (and until (/= node next))
                 (multiple-value-bind (row column) (floor (the node next) (field-columns field))
                   (when (funcall (the function until) (1- column) (1- row)) (return))))
               (setf node next))
          finally (when (= node goal) (extend-to-goal polyline descent goal-x goal-y)))
    (add-vertex polyline)))

(defun extend-to-goal (polyline descent x y)
  "Extend POLYLINE by the last step, within the cell of the goal, to (X,Y)."
  (let ((field (descent-field descent))
        (dx (- x (descent-x descent))) (dy (- y (descent-y descent))))
    (extend-by-step polyline field x y
                    (* (sqrt (+ (* dx dx) (* dy dy))) (aref (field-cells field) (field-goal field)))
                    t)))
