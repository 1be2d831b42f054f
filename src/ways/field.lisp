;;;; field.lisp -- the cost to get to one goal from each node, kept up to date.

(in-package :ars-magna.ways)

;;;; The queue: waiting nodes by their keys, a binary heap in two arrays

;;; A node may be in it more than once; when it is taken out, check whether it still counts.

(deftype nodes () '(simple-array (unsigned-byte 31) (*)))

(defstruct (queue (:constructor make-queue ()) (:copier nil))
  "A priority queue of nodes with their keys, double-floats. The least key comes first."
  (keys (make-cost-vector 64 0d0) :type amounts)
  (nodes (make-array 64 :element-type '(unsigned-byte 31)) :type nodes)
  (count 0 :type (unsigned-byte 40)))
(declaim-final queue)

(defun enlarge-queue (queue)
  (flet ((enlarged (array)
           (replace (make-array (* 2 (length array)) :element-type (array-element-type array))
                    array)))
    (setf (queue-keys queue) (enlarged (queue-keys queue))
          (queue-nodes queue) (enlarged (queue-nodes queue)))))

(declaim (inline store-in-heap))
(defun store-in-heap (keys nodes place key node)
  (declare (type amounts keys) (type nodes nodes))
  (setf (aref keys place) key
        (aref nodes place) node))

(declaim (inline queue-push))
(defun queue-push (queue node key)
  (declare (type node node) (type double-float key))
  (when (= (queue-count queue) (length (queue-keys queue))) (enlarge-queue queue))
  (let ((keys (queue-keys queue)) (nodes (queue-nodes queue)) (place (queue-count queue)))
    (setf (queue-count queue) (1+ place))
    (loop while (plusp place)
          do (let ((parent (ash (1- place) -1)))
               (when (<= (aref keys parent) key) (return))
               (store-in-heap keys nodes place (aref keys parent) (aref nodes parent))
               (setf place parent)))
    (store-in-heap keys nodes place key node)
    nil))

(defun queue-pop (queue)
  (declare #.*hot*)
  (let* ((keys (queue-keys queue)) (nodes (queue-nodes queue))
         (count (1- (queue-count queue)))
         (key (aref keys count)) (node (aref nodes count)) (place 0))
    (declare (type (unsigned-byte 40) count place))
    (setf (queue-count queue) count)
    (loop
      (let ((child (1+ (* 2 place))))
        (declare (type (unsigned-byte 41) child))
        (when (>= child count) (return))
        (when (and (< (1+ child) count) (< (aref keys (1+ child)) (aref keys child)))
          (incf child))
        (when (>= (aref keys child) key) (return))
        (store-in-heap keys nodes place (aref keys child) (aref nodes child))
        (setf place child)))
    (store-in-heap keys nodes place key node)
    nil))

(defun copy-into-queue (queue other)
  (setf (queue-keys queue) (copy-seq (queue-keys other))
        (queue-nodes queue) (copy-seq (queue-nodes other))
        (queue-count queue) (queue-count other))
  queue)

;;;; Crossing the square between the middles of four cells

;;; Ways run between the middles of cells, the nodes. Four of them are the corners of a square. A
;;; metre in it costs what it does in the most expensive of the four cells; a metre between two
;;; neighbouring nodes, in the more expensive one. So no way enters a square with a wall at a
;;; corner: ways keep half a metre off all walls, and go through the middle of a one-cell doorway.
;;;
;;; From a node a way may cross a square to any point of the two sides opposite. The cost
;;; to the goal is known for the corners, and interpolated linearly between them. That is
;;; Field D*: D. Ferguson and A. Stentz, "Using interpolation to improve path planning: the Field
;;; D* algorithm", Journal of Field Robotics 23(2), 2006.

(defconstant +diagonal+ (sqrt 2d0) "The length of a square's diagonal, in metres.")

(declaim (inline cost-through-side))
(defun cost-through-side (straight diagonal edge square)
  "Return the cost to the goal from a node through the opposite side of a square. STRAIGHT and
DIAGONAL are the costs to the goal from the first and the second end of that side. EDGE is the cost
of a metre on the line to the first end, SQUARE the cost of a metre in the square. The result
exceeds each cost that it depends on by at least a third."
  (declare (type double-float straight diagonal edge square))
  (let ((drop (- straight diagonal)) (along (+ edge straight)))
    (if (or (<= drop 0d0) (>= square +barred-cost+))
        along
        (let ((slope (min drop edge)))
          (min along
               (if (< (* slope +diagonal+) square)
                   ;; The best point is on the side.
                   (+ diagonal slope (sqrt (the (double-float 0d0) (- (* square square)
                                                                      (* slope slope)))))
                   (+ diagonal (* square +diagonal+))))))))

;;;; Fields

;;; The method is that of D* Lite (S. Koenig and M. Likhachev, "D* Lite", AAAI 2002), without its
;;; heuristic: each node has a TOTAL (their g), and a DRAFT (their rhs), which is what its
;;; neighbours' totals make it now. Nodes whose two values differ wait in a queue, by the lesser
;;; value. When all that is less than a node's total has been processed, that total is final.
;;;
;;; Totals depend on cells and goal alone, to the bit: a total depends on lesser totals only (see
;;; COST-THROUGH-SIDE), and a draft that might have to rise is computed anew. So earlier queries,
;;; cells that were barred before, and the order of the queue have no influence. Without a heuristic
;;; a field serves all starts.

(defstruct (field (:constructor %make-field (goal columns cells totals drafts)) (:copier nil))
  "A field: the costs from all nodes to the node GOAL. If there is a LOCK, threads share the field,
and CELLS are the cells of the terrain, which must not change."
  (goal 0 :type node)
  (columns 0 :type (integer 0 40000) :read-only t)
  (cells nil :type amounts)
  (totals nil :type amounts :read-only t)
  (drafts nil :type amounts :read-only t)
  (queue (make-queue) :type queue :read-only t)
  (lock nil))
(declaim-final field)

(defun make-field (terrain goal)
  "Return a new field of TERRAIN with its goal in the node GOAL. Only GOAL's total is known yet."
  (ensure-memory (length (terrain-cells terrain)) 16)
  (let* ((cells (terrain-cells terrain)) (size (length cells))
         (field (%make-field goal (terrain-columns terrain) cells
                             (make-cost-vector size +barred-cost+)
                             (make-cost-vector size +barred-cost+))))
    (setf (aref (field-drafts field) goal) 0d0)
    (queue-push (field-queue field) goal 0d0)
    field))

(defun copy-field (field)
  (ensure-memory (length (field-cells field)) 24)
  (let ((copy (%make-field (field-goal field) (field-columns field) (copy-seq (field-cells field))
                           (copy-seq (field-totals field)) (copy-seq (field-drafts field)))))
    (copy-into-queue (field-queue copy) (field-queue field))
    copy))

(defun copy-into-field (copy field)
  "Copy FIELD into COPY, an unshared field of the same terrain. Return COPY."
  (setf (field-goal copy) (field-goal field))
  (replace (field-cells copy) (field-cells field))
  (replace (field-totals copy) (field-totals field))
  (replace (field-drafts copy) (field-drafts field))
  (copy-into-queue (field-queue copy) (field-queue field))
  copy)

(defmethod copy-plan-value ((field field) fork)
  (if (field-lock field)
      field
      (record-copy field (copy-field field) fork)))

;;; Drafts.

(defmacro with-field ((field) &body body)
  "Run BODY with the contents of FIELD in variables, and local functions of nodes and offsets."
  `(let ((cells (field-cells ,field)) (totals (field-totals ,field))
         (drafts (field-drafts ,field)) (queue (field-queue ,field))
         (columns (field-columns ,field)))
     (declare (ignorable cells totals drafts queue))
     (labels ((cell (node) (aref cells node))
              (total (node) (aref totals node))
              (edge (node side) (max (cell node) (cell (the node (+ node side)))))
              (by-side (node side across)
                ;; By way of the side from NODE + SIDE to NODE + SIDE + ACROSS.
                (let* ((straight (+ node side)) (diagonal (+ straight across))
                       (edge (max (cell node) (cell straight))))
                  (declare (type node straight diagonal))
                  (cost-through-side (total straight) (total diagonal) edge
                                     (max edge (cell diagonal)
                                          (cell (the node (+ node across))))))))
       (declare (inline cell total edge by-side)
                (ignorable #'cell #'total #'edge #'by-side))
       ,@body)))

(declaim (inline compute-draft-cost))
(defun compute-draft-cost (field node)
  "Return the cost to the goal from NODE, computed from the costs of its neighbours."
  (declare (type field field) (type node node))
  (with-field (field)
    (if (= node (field-goal field))
        0d0
        (min +barred-cost+
             (by-side node 1 columns) (by-side node 1 (- columns))
             (by-side node -1 columns) (by-side node -1 (- columns))
             (by-side node columns 1) (by-side node columns -1)
             (by-side node (- columns) 1) (by-side node (- columns) -1)))))

(declaim (inline set-draft-cost))
(defun set-draft-cost (field node draft)
  "Set the draft of NODE to DRAFT, and queue NODE if its total differs."
  (declare (type field field) (type node node) (type double-float draft))
  (let ((total (aref (field-totals field) node)))
    (setf (aref (field-drafts field) node) draft)
    (unless (= draft total)
      (queue-push (field-queue field) node (min draft total)))))

(defun update-draft-cost (field node)
  (declare #.*hot* (type field field) (type node node))
  (when (< (aref (field-cells field) node) +barred-cost+)
    (let ((draft (compute-draft-cost field node)))
      (unless (= draft (aref (field-drafts field) node)) (set-draft-cost field node draft)))))

(defun lower-neighbours (field node)
  "Update the drafts of the neighbours of NODE, after the total of NODE has become known."
  (declare #.*hot* (type field field) (type node node))
  (with-field (field)
    (flet ((lower (other draft)
             (declare (type node other) (type double-float draft))
             (when (< draft (aref drafts other))
               (set-draft-cost field other draft))))
      (declare (inline lower))
      (macrolet ((straight (side across)
                   `(let ((other (- node ,side)))
                      (declare (type node other))
                      (when (and (< (cell other) +barred-cost+)
                                 (< (total node) (aref drafts other)))
                        (lower other (min (by-side other ,side ,across)
                                          (by-side other ,side (- ,across)))))))
                 (diagonal (side across)
                   `(let ((other (- node ,side ,across)))
                      (declare (type node other))
                      (when (and (< (cell other) +barred-cost+)
                                 (< (total node) (aref drafts other)))
                        (lower other (min (by-side other ,side ,across)
                                          (by-side other ,across ,side)))))))
        (straight 1 columns)
        (straight -1 columns)
        (straight columns 1)
        (straight (- columns) 1)
        (diagonal 1 columns)
        (diagonal 1 (- columns))
        (diagonal -1 columns)
        (diagonal -1 (- columns))))))

(defun update-neighbours (field node least)
  "Recompute the drafts of the neighbours of NODE that may depend on NODE: the drafts above LEAST."
  (declare #.*hot* (type field field) (type node node) (type double-float least))
  (let ((columns (field-columns field)) (drafts (field-drafts field)))
    (flet ((look (offset)
             (declare (type (signed-byte 32) offset))
             (let ((other (+ node offset)))
               (declare (type node other))
               (when (> (aref drafts other) least) (update-draft-cost field other)))))
      (look 1) (look -1) (look columns) (look (- columns))
      (look (+ columns 1)) (look (- columns 1)) (look (- 1 columns)) (look (- -1 columns)))))

;;; Totals.

(defun process-node (field node)
  "Update the total of NODE, the first node in the queue of FIELD, by its draft."
  (declare #.*hot* (type field field) (type node node))
  (let* ((totals (field-totals field))
         (total (aref totals node)) (draft (aref (field-drafts field) node)))
    (cond ((= total draft))             ; It has been processed before.
          ((< draft total)
           (setf (aref totals node) draft)
           (if (= total +barred-cost+)
               (lower-neighbours field node)
               (update-neighbours field node draft)))
          (t (setf (aref totals node) +barred-cost+)
             (update-neighbours field node total)
             (set-draft-cost field node draft)))))

(defun compute-total (field node)
  "Compute FIELD's totals up to NODE's. Return NODE's total, or +BARRED-COST+ without a way."
  (declare #.*hot* (type field field) (type node node))
  (let ((queue (field-queue field)) (totals (field-totals field)) (drafts (field-drafts field)))
    (loop until (zerop (queue-count queue))
          do (let ((total (aref totals node)) (draft (aref drafts node))
                   (key (aref (queue-keys queue) 0)))
               (when (and (= total draft) (>= key total) (< total +barred-cost+)) (return))
               (let ((first (aref (queue-nodes queue) 0)))
                 (queue-pop queue)
                 (when (= key (min (aref totals first) (aref drafts first)))
                   (process-node field first)))))
    (aref totals node)))

(defun cost-to-goal (field node)
  "Return the cost to the goal of FIELD from NODE, computing it if necessary."
  (let ((lock (field-lock field)))
    (if lock
        (with-lock (lock) (compute-total field node))
        (compute-total field node))))

;;; Changes.

(defun set-cell-cost (field node cost)
  (let ((columns (field-columns field)))
    (setf (aref (field-cells field) node) cost)
    (when (>= cost +barred-cost+) (set-draft-cost field node +barred-cost+))
    (loop for row in (list (- columns) 0 columns)
          do (loop for offset from (1- row) to (1+ row)
                   do (update-draft-cost field (+ node offset))))))
