;;;; field.lisp -- what it costs to get to one goal from each node, kept up to date.

(in-package :ars-magna.ways)

;;; The method is that of D* Lite (S. Koenig and M. Likhachev, "D* Lite", AAAI 2002), without its
;;; heuristic: each node has a TOTAL (their g), and a DRAFT (their rhs), which is what its
;;; neighbours' totals make it now. Nodes whose two differ wait in a queue, by the lesser of the
;;; two. When all that is less than a node's total has been dealt with, that total is right.
;;;
;;; Totals are decided by cells and goal alone, to the bit: a total depends on lesser ones only (see
;;; crossing.lisp), and whenever a draft might have to rise it is made anew. So neither what was
;;; asked before, nor cells that were barred once and are free again, nor the order of the queue
;;; leave a trace. And without a heuristic a field serves robots anywhere.

(defstruct (field (:constructor %make-field (goal columns cells totals drafts)) (:copier nil))
  "What it costs to get to the node GOAL. If there is a lock, threads share the field and CELLS are
the terrain's: totals are found in it, but no cell changes."
  (goal 0 :type node)
  (columns 0 :type (integer 0 40000) :read-only t)
  (cells nil :type amounts)
  (totals nil :type amounts :read-only t)
  (drafts nil :type amounts :read-only t)
  (queue (make-queue) :type queue :read-only t)
  (lock nil))
(declaim-final field)

(defun make-field (terrain goal)
  "Return a field of TERRAIN with the goal in the node GOAL; no other total is known in it."
  (ensure-room (length (terrain-cells terrain)) 16)
  (let* ((cells (terrain-cells terrain)) (size (length cells))
         (field (%make-field goal (terrain-columns terrain) cells
                             (make-amounts size +barred+) (make-amounts size +barred+))))
    (setf (aref (field-drafts field) goal) 0d0)
    (queue-push (field-queue field) goal 0d0)
    field))

(defun copy-field (field)
  "Return a copy of FIELD that nobody shares."
  (ensure-room (length (field-cells field)) 24)
  (let ((copy (%make-field (field-goal field) (field-columns field) (copy-seq (field-cells field))
                           (copy-seq (field-totals field)) (copy-seq (field-drafts field)))))
    (copy-into-queue (field-queue copy) (field-queue field))
    copy))

(defun copy-into-field (copy field)
  "Let COPY, a field of the same terrain that nobody shares, be as FIELD is. Return COPY."
  (setf (field-goal copy) (field-goal field))
  (replace (field-cells copy) (field-cells field))
  (replace (field-totals copy) (field-totals field))
  (replace (field-drafts copy) (field-drafts field))
  (copy-into-queue (field-queue copy) (field-queue field))
  copy)

(defmethod copy-plan-value ((field field) fork)
  (if (field-lock field)
      field
      (note-copy field (copy-field field) fork)))

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
                  (crossing-by (total straight) (total diagonal) edge
                               (max edge (cell diagonal) (cell (the node (+ node across))))))))
       (declare (inline cell total edge by-side)
                (ignorable #'cell #'total #'edge #'by-side))
       ,@body)))

(declaim (inline best-draft))
(defun best-draft (field node)
  "Return what the goal costs from NODE, by what it costs from its neighbours."
  (declare (type field field) (type node node))
  (with-field (field)
    (if (= node (field-goal field))
        0d0
        (min +barred+
             (by-side node 1 columns) (by-side node 1 (- columns))
             (by-side node -1 columns) (by-side node -1 (- columns))
             (by-side node columns 1) (by-side node columns -1)
             (by-side node (- columns) 1) (by-side node (- columns) -1)))))

(declaim (inline note-draft))
(defun note-draft (field node draft)
  "Let DRAFT be that of NODE, which waits if its total is another."
  (declare (type field field) (type node node) (type double-float draft))
  (let ((total (aref (field-totals field) node)))
    (setf (aref (field-drafts field) node) draft)
    (unless (= draft total)
      (queue-push (field-queue field) node (min draft total)))))

(defun redraft (field node)
  (declare #.*hot* (type field field) (type node node))
  (when (< (aref (field-cells field) node) +barred+)
    (let ((draft (best-draft field node)))
      (unless (= draft (aref (field-drafts field) node)) (note-draft field node draft)))))

(defun offer (field node)
  "The total of NODE is known now, and was not before: let the drafts of its neighbours follow."
  (declare #.*hot* (type field field) (type node node))
  (with-field (field)
    (flet ((lower (other draft)
             (declare (type node other) (type double-float draft))
             (when (< draft (aref drafts other))
               (note-draft field other draft))))
      (declare (inline lower))
      (macrolet ((straight (side across)
                   `(let ((other (- node ,side)))
                      (declare (type node other))
                      (when (and (< (cell other) +barred+)
                                 (< (total node) (aref drafts other)))
                        (lower other (min (by-side other ,side ,across)
                                          (by-side other ,side (- ,across)))))))
                 (diagonal (side across)
                   `(let ((other (- node ,side ,across)))
                      (declare (type node other))
                      (when (and (< (cell other) +barred+)
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

(defun redraft-neighbours (field node least)
  "Make the drafts anew of those neighbours of NODE that may depend on it: that are above LEAST."
  (declare #.*hot* (type field field) (type node node) (type double-float least))
  (let ((columns (field-columns field)) (drafts (field-drafts field)))
    (flet ((look (offset)
             (declare (type (signed-byte 32) offset))
             (let ((other (+ node offset)))
               (declare (type node other))
               (when (> (aref drafts other) least) (redraft field other)))))
      (look 1) (look -1) (look columns) (look (- columns))
      (look (+ columns 1)) (look (- columns 1)) (look (- 1 columns)) (look (- -1 columns)))))

;;; Totals.

(defun settle-node (field node)
  "Bring the total of NODE, the first of the queue of FIELD, nearer to its draft."
  (declare #.*hot* (type field field) (type node node))
  (let* ((totals (field-totals field))
         (total (aref totals node)) (draft (aref (field-drafts field) node)))
    (cond ((= total draft))             ; It was dealt with when it was met before.
          ((< draft total)
           (setf (aref totals node) draft)
           (if (= total +barred+)
               (offer field node)
               (redraft-neighbours field node draft)))
          (t (setf (aref totals node) +barred+)
             (redraft-neighbours field node total)
             (note-draft field node draft)))))

(defun settle (field node)
  "Find the total of NODE, and all that are less. Return it, +BARRED+ if there is no way."
  (declare #.*hot* (type field field) (type node node))
  (let ((queue (field-queue field)) (totals (field-totals field)) (drafts (field-drafts field)))
    (loop until (zerop (queue-count queue))
          do (let ((total (aref totals node)) (draft (aref drafts node))
                   (key (aref (queue-keys queue) 0)))
               (when (and (= total draft) (>= key total) (< total +barred+)) (return))
               (let ((first (aref (queue-nodes queue) 0)))
                 (queue-drop queue)
                 (when (= key (min (aref totals first) (aref drafts first)))
                   (settle-node field first)))))
    (aref totals node)))

(defun find-total (field node)
  "Return what the goal of FIELD costs from NODE; that is found out first, if need be."
  (let ((lock (field-lock field)))
    (if lock
        (with-lock (lock) (settle field node))
        (settle field node))))

;;; Changes.

(defun change-cell (field node cost)
  "Let the cell NODE of FIELD, which nobody shares, cost COST from now on."
  (let ((columns (field-columns field)))
    (setf (aref (field-cells field) node) cost)
    (when (>= cost +barred+) (note-draft field node +barred+))
    (loop for row in (list (- columns) 0 columns)
          do (loop for offset from (1- row) to (1+ row)
                   do (redraft field (+ node offset))))))
