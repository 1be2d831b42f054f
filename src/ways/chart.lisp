;;;; chart.lisp -- a map as one robot knows it, with the cells that it has found barred.

(in-package :ars-magna.ways)

;;; A chart belongs to one plan or program. It shares its terrain with other charts, and the fields
;;; of goals as long as no cell is barred. A copy of the run gets a copy of the chart.

(addition chart)
(addition chart-p)
(define-record (chart (:constructor %make-chart (terrain)))
  "A map as one robot knows it: a terrain, and the cells that are barred or cost more."
  (terrain nil terrain "the terrain of the chart, which other charts of the map share" :addition)
  (barred '() list "pairs (node . cost): the extra cost of a metre" :writable)
  (field nil (or null field) "the chart's own field, with its barred cells, or NIL" :writable)
  (changed '() list "the nodes whose cost has changed since the field was updated" :writable))
(declaim-final chart)

(addition chart-map)
(defun chart-map (chart)
  "Return the map of CHART."
  (terrain-map (chart-terrain chart)))

(defmethod print-object ((chart chart) stream)
  (print-unreadable-object (chart stream :type t)
    (format stream "of ~A, ~D cell~:P barred" (map-name (chart-map chart))
            (length (chart-barred chart)))))

;;; Making one.

(defun place-type-costs-p (costs)
  "True if COSTS is a list of (name cost) in which each name is the name of a place type."
  (and (proper-list-p costs)
       (every (lambda (entry)
                (and (proper-list-p entry) (= 2 (length entry))
                     (symbolp (first entry)) (find-place-type (first entry) nil)
                     (typep (second entry) '(real 1 1000))))
              costs)))

(addition make-chart)
(defun make-chart (map &key (clearance 3/4) (costs '((doorway 2))))
  "Return a new chart of MAP, a map or the name of a map. No cell of the chart is barred. A metre
costs 1, or 4 if it is nearer to a wall than CLEARANCE, from 0 to 10 metres. In places of the types
in COSTS, a list of (name cost), a metre costs the given cost, from 1 to 1000. Signals
WRONG-ARGUMENT and UNKNOWN-NAME."
  (check-argument make-chart clearance (and (realp clearance) (<= 0 clearance 10))
                  "a number of metres, from 0 to 10")
  (check-argument make-chart costs (place-type-costs-p costs)
                  "a list such as ((doorway 2)), of place types and costs from 1 to 1000")
  (%make-chart (terrain-for-map (find-map-argument 'make-chart map) (rational clearance)
                                (loop for (name cost) in costs collect (list name (double cost))))))

;;; Points.

(defun point-or-pair-p (point)
  (or (pt-p point) (number-pair-p point)))

(declaim (inline point-x point-y))
(defun point-x (point) (double (if (pt-p point) (pt-x point) (first point))))
(defun point-y (point) (double (if (pt-p point) (pt-y point) (second point))))

(defun node-at (chart x y)
  "Return the number of the cell of CHART with the point (X,Y), which is inside the map."
  (declare (type (double-float 0d0 32768d0) x y))
  (cell-node (chart-terrain chart) (truncate x) (truncate y)))

(defun node-of-point (operator chart point)
  "Return the number of the cell of CHART with POINT. Signals WRONG-ARGUMENT about an argument of
OPERATOR unless POINT is inside the map."
  (unless (and (point-or-pair-p point) (in-map-p (chart-map chart) (point-x point) (point-y point)))
    (reject-argument operator 'point point
                     (let ((map (chart-map chart)))
                       (format nil "a PT or a list (x y) inside ~A: x from 0 and below ~D, y ~
                                    from 0 and below ~D"
                               (map-name map) (map-width map) (map-height map)))))
  (node-at chart (point-x point) (point-y point)))

;;; Barred cells.

(defun cost-of-node (chart node)
  "Return the current cost of a metre in the cell NODE of CHART."
  (min +barred-cost+ (+ (aref (terrain-cells (chart-terrain chart)) node)
                        (or (cdr (assoc node (chart-barred chart))) 0d0))))

(defun set-extra-cost (chart node cost)
  "Set the extra cost of the cell NODE of CHART to COST; remove it if COST is NIL."
  (let ((entry (assoc node (chart-barred chart))))
    (unless (eql cost (cdr entry))
      (setf (chart-barred chart)
            (let ((others (remove entry (chart-barred chart))))
              (if cost (acons node cost others) others)))
      (pushnew node (chart-changed chart)))))

(addition bar-cell)
(defun bar-cell (chart point &optional cost)
  "Make the cell of CHART that contains POINT, a PT or a list (x y), impossible to cross. With COST,
from 0 to 1e6, the cell can be crossed, but a metre in it costs COST more. The new mark replaces
earlier marks of the cell. Return CHART. Signals WRONG-ARGUMENT."
  (check-argument bar-cell chart (chart-p chart) "a chart")
  (check-argument bar-cell cost (or (null cost) (and (realp cost) (<= 0 cost 1000000)))
                  "a cost from 0 to 1e6, or NIL for a cell that cannot be crossed")
  (set-extra-cost chart (node-of-point 'bar-cell chart point)
                  (cond ((null cost) +barred-cost+)
                        ((zerop cost) nil)
                        (t (double cost))))
  chart)

(addition free-cell)
(defun free-cell (chart point)
  "Remove what BAR-CELL has set for the cell of CHART that contains POINT, a PT or a list (x y).
Return CHART. Signals WRONG-ARGUMENT."
  (check-argument free-cell chart (chart-p chart) "a chart")
  (set-extra-cost chart (node-of-point 'free-cell chart point) nil)
  chart)

(addition free-all-cells)
(defun free-all-cells (chart)
  "Remove what BAR-CELL has set for all cells of CHART. Return CHART. Signals WRONG-ARGUMENT."
  (check-argument free-all-cells chart (chart-p chart) "a chart")
  (loop for (node) in (chart-barred chart) do (set-extra-cost chart node nil))
  chart)

(addition barred-cells)
(defun barred-cells (chart)
  "Return a list of (x y cost) for the cells that were barred on CHART, newest first. COST is the
extra cost of a metre in the cell, or NIL if the cell cannot be crossed."
  (loop with terrain = (chart-terrain chart)
        for (node . cost) in (chart-barred chart)
        collect (list (node-column terrain node) (node-row terrain node)
                      (if (< cost +barred-cost+) cost nil))))

(addition crossing-cost)
(defun crossing-cost (chart point)
  "Return the cost of a metre in the cell of CHART that contains POINT, a PT or a list (x y). The
cost is 1 or more, or NIL if the cell cannot be crossed. Signals WRONG-ARGUMENT."
  (let ((cost (cost-of-node chart (node-of-point 'crossing-cost chart point))))
    (if (< cost +barred-cost+) cost nil)))

;;; Doors that are believed to be closed.

(defun chart-with-closed-doors (operator chart doors)
  "Return CHART if DOORS is (). Else return a copy in which the cells of DOORS, points, are barred."
  (if (null doors)
      chart
      (let ((copy (%make-chart (chart-terrain chart))))
        (setf (chart-barred copy) (chart-barred chart))
        (dolist (door doors copy)
          (set-extra-cost copy (node-of-point operator copy door) +barred-cost+)))))

;;; The field of a goal. All charts of a terrain share one, until they bar a cell.

(defconstant +most-cached-nodes+ 2000000
  "The largest number of nodes in all fields that a terrain keeps; two fields are always kept.")

(defun cached-field (terrain goal)
  (find goal (terrain-fields terrain) :key #'field-goal))

(defun discard-oldest-fields (terrain)
  "Discard the oldest fields of TERRAIN, so that there is room for another field."
  (let ((fields (terrain-fields terrain))
        (most (clamp (floor +most-cached-nodes+ (length (terrain-cells terrain))) 2 50)))
    (setf (terrain-fields terrain) (subseq fields 0 (min (length fields) (1- most))))))

(defun shared-field (terrain goal)
  "Return the field of TERRAIN with its goal in the node GOAL. All threads share this field."
  (or (cached-field terrain goal)
      (with-lock ((terrain-lock terrain))
        (or (cached-field terrain goal)
            (let ((field (progn (discard-oldest-fields terrain) (make-field terrain goal))))
              (setf (field-lock field) (make-lock "field"))
              (push field (terrain-fields terrain))
              field)))))

(defun copy-shared-field (chart goal)
  "Give CHART its own copy of the field of the node GOAL, with nothing barred yet."
  (let* ((shared (shared-field (chart-terrain chart) goal))
         ;; An interrupted copy would mix two fields, so CHART has none meanwhile.
         (old (shiftf (chart-field chart) nil))
         (own (with-lock ((field-lock shared))
                (if old (copy-into-field old shared) (copy-field shared)))))
    (setf (chart-changed chart) (mapcar #'car (chart-barred chart))
          (chart-field chart) own)))

(defun field-for-goal (chart goal)
  "Return the field with its goal in the node GOAL, for the current state of CHART."
  (cond ((null (chart-barred chart)) (shared-field (chart-terrain chart) goal))
        (t (unless (and (chart-field chart) (= goal (field-goal (chart-field chart))))
             (copy-shared-field chart goal))
           (dolist (node (shiftf (chart-changed chart) '()))
             (set-cell-cost (chart-field chart) node (cost-of-node chart node)))
           (chart-field chart))))
