;;;; ways.lisp -- ways from one point to another, as users ask for them.

(in-package :ars-magna.ways)

;;; Points in walls.

(defconstant +free-point-distance+ 5
  "The largest distance, in columns or rows, from a point in a wall to the free cell used instead.")

(defun crossable-cell-p (chart x y)
  (and (in-map-p (chart-map chart) x y)
       (< (cost-of-node chart (cell-node (chart-terrain chart) x y)) +barred-cost+)))

(defun nearest-free-middle (chart x y)
  "Return the middle of the nearest cell to (X,Y) that can be crossed, as two values; NIL if there
is none within +FREE-POINT-DISTANCE+ columns and rows."
  (loop with least = nil and best-x = nil and best-y = nil
        for column from (- (floor x) +free-point-distance+) to (+ (floor x) +free-point-distance+)
        do (loop for row from (- (floor y) +free-point-distance+)
                   to (+ (floor y) +free-point-distance+)
                 for square = (+ (expt (- (+ column 0.5d0) x) 2) (expt (- (+ row 0.5d0) y) 2))
                 when (and (or (null least) (< square least)) (crossable-cell-p chart column row))
                   do (setf least square best-x (+ column 0.5d0) best-y (+ row 0.5d0)))
        finally (return (and least (values best-x best-y)))))

(defun nearest-free-coordinates (chart x y)
  "Return X and Y if their cell can be crossed; otherwise return the NEAREST-FREE-MIDDLE."
  (if (crossable-cell-p chart (floor x) (floor y))
      (values x y)
      (nearest-free-middle chart x y)))

(defun ensure-chart (operator chart)
  "Return CHART, an argument of OPERATOR, if it is a chart; a new chart if it is a map or its name."
  (if (chart-p chart)
      chart
      (make-chart (find-map-argument operator chart))))

(addition nearest-free-point)
(defun nearest-free-point (chart point)
  "Return POINT, as a PT, if its cell on CHART can be crossed. Otherwise return the middle of the
nearest such cell, up to five cells away, or NIL. POINT is a PT or a list (x y), perhaps outside the
map. CHART may be a map or a map's name. Signals WRONG-ARGUMENT."
  (check-argument nearest-free-point point (point-or-pair-p point) "a PT or a list (x y)")
  (multiple-value-bind (x y) (nearest-free-coordinates (ensure-chart 'nearest-free-point chart)
                                                       (point-x point) (point-y point))
    (and x (make-pt x y))))

(defun free-endpoint (operator chart point)
  "Return coordinates of POINT; if it is in a wall, of a free point nearby. Signals WRONG-ARGUMENT."
  (node-of-point operator chart point)
  (multiple-value-bind (x y) (nearest-free-coordinates chart (point-x point) (point-y point))
    (unless x
      (reject-argument operator 'point point
                       (format nil "a point of ~A within ~D cells of a cell that can be crossed"
                               (map-name (chart-map chart)) +free-point-distance+)))
    (values x y)))

;;; Ways between points that are free.

(defun place-test (chart name)
  "Return a function of a column and a row that is true if the cell is a place of the type NAME."
  (let* ((map (chart-map chart)) (places (map-places map)) (width (map-width map))
         (number (place-type-index map (find-place-type name))))
    (declare (type (simple-array (unsigned-byte 8) (*)) places))
    (lambda (x y)
      (declare (type (unsigned-byte 15) x y))
      (eql number (aref places (+ x (* y width)))))))

(defun points-of-way (chart x y goal-x goal-y until turns)
  "Return a list of the points after (X,Y) on the way to (GOAL-X,GOAL-Y) on CHART; () if there is no
way. Both points are free. UNTIL and TURNS are arguments of TRACE-WAY."
  (let* ((field (field-for-goal chart (node-at chart goal-x goal-y)))
         (total (cost-to-goal field (node-at chart x y))))
    (when (< total +barred-cost+)
      (let ((polyline (make-polyline x y)))
        (trace-way polyline (make-descent field x y total) goal-x goal-y until turns)
        (nreverse (polyline-points polyline))))))

;;; What users call.

(defmacro with-free-endpoints ((operator chart start goal) &body body)
  "Run BODY with the coordinates X, Y, GOAL-X and GOAL-Y of START and GOAL on CHART."
  `(multiple-value-bind (x y) (free-endpoint ',operator ,chart ,start)
     (multiple-value-bind (goal-x goal-y) (free-endpoint ',operator ,chart ,goal)
       ,@body)))

(addition find-way)
(defun find-way (chart start goal &key until closed)
  "Return the way on CHART from START to GOAL, a list of PTs: the points where the way begins, turns
and ends. Return () if there is no way. START and GOAL are PTs or lists (x y). A point in a wall
stands for the nearest free point, up to five cells away. CHART may be a map or the name of a map,
which stands for (make-chart map): a metre in a DOORWAY costs 2. With UNTIL the way ends in the
first suitable cell after the cell of START: a place of the type named UNTIL, or a cell for whose
column and row the function UNTIL returns true. CLOSED lists points, PTs or lists (x y), of doors
that you believe to be closed: the way avoids their cells. FIND-WAY does not look into any run. To
remember closed doors, use BAR-CELL, which is faster. Signals WRONG-ARGUMENT and UNKNOWN-NAME."
  (check-argument find-way until (or (functionp until) (symbolp until))
                  "the name of a place type, or a function of a column and a row")
  (check-argument find-way closed (proper-list-of-p #'point-or-pair-p closed)
                  "a list of PTs or lists (x y), points of doors")
  (let* ((chart (chart-with-closed-doors 'find-way (ensure-chart 'find-way chart) closed))
         (until (if (and until (symbolp until)) (place-test chart until) until)))
    (with-free-endpoints (find-way chart start goal)
      (let ((points (points-of-way chart x y goal-x goal-y until nil)))
        (and points (cons (make-pt x y) points))))))

(addition next-point)
(defun next-point (chart start goal)
  "Return the first point after START, a PT, on the way from START to GOAL on CHART: the point where
the way first turns, or GOAL; NIL if there is no way. Signals WRONG-ARGUMENT. See FIND-WAY."
  (let ((chart (ensure-chart 'next-point chart)))
    (with-free-endpoints (next-point chart start goal)
      (first (points-of-way chart x y goal-x goal-y nil 1)))))

(addition way-cost)
(defun way-cost (chart start goal)
  "Return the cost of the way from START to GOAL on CHART, between the middles of their cells: the
sum of the way's metres, each times the CROSSING-COST at its place. Return NIL if there is no way.
Signals WRONG-ARGUMENT. See FIND-WAY."
  (let ((chart (ensure-chart 'way-cost chart)))
    (with-free-endpoints (way-cost chart start goal)
      (let ((total (cost-to-goal (field-for-goal chart (node-at chart goal-x goal-y))
                                 (node-at chart x y))))
        (and (< total +barred-cost+) total)))))

(addition way-length)
(defun way-length (way)
  "Return the length of WAY, a list of PTs or of lists (x y), in metres. Signals WRONG-ARGUMENT."
  (check-argument way-length way (and (proper-list-p way) (every #'point-or-pair-p way))
                  "a list of PTs, or of lists (x y)")
  (loop for (point next) on way
        while next
        sum (let ((dx (- (point-x next) (point-x point))) (dy (- (point-y next) (point-y point))))
              (sqrt (+ (* dx dx) (* dy dy))))))

(addition straight-cost)
(defun straight-cost (chart start goal)
  "Return the cost of the straight line from START to GOAL on CHART: the sum of the line's metres,
each times the CROSSING-COST there. Return NIL if the line is not free: it comes nearer than half a
metre to a wall or enters a cell that cannot be crossed. Signals WRONG-ARGUMENT. See FIND-WAY."
  (let ((chart (ensure-chart 'straight-cost chart)))
    (with-free-endpoints (straight-cost chart start goal)
      (let ((cost (free-line-cost (field-for-goal chart (node-at chart goal-x goal-y))
                                  x y goal-x goal-y (/ +barred-cost+ 2) t)))
        (and (< cost +barred-cost+) cost)))))
