;;;; lines.lisp -- as few straight walls as possible for the cells of a grid.

(in-package :ars-magna.floors)

;;; Each cell that has to be a wall must be in a wall along its row or one along its column, and it
;;; is never worse to let these be whole runs. So a cell is a tie between two runs, and what we look
;;; for are fewest runs that have an end of every tie: a least vertex cover. Between two sorts of
;;; runs that is found by way of a greatest matching, pairs of runs that share a cell, none of them
;;; twice (Koenig's theorem). The matching is that of Hopcroft and Karp: in rounds, from the rows
;;; that have no mate yet, layer by layer, along ways on which ties and pairs take turns.

(defstruct (cover (:constructor %make-cover
                      (rows columns needed row-mate column-mate layer reached))
                  (:copier nil))
  "The matching so far of the runs ROWS and COLUMNS: the ROW-MATE of each row is a column, the
COLUMN-MATE of each column a row, or -1. Cells in states NEEDED, a bit for each, are ties. In a
round, LAYER says how many pairs lie between a row and one without a mate, -1 if there is no way;
REACHED how many of its cells each row has tried."
  (rows nil :type runs :read-only t)
  (columns nil :type runs :read-only t)
  (needed 0 :type (unsigned-byte 8) :read-only t)
  (row-mate (make-numbers 0) :type numbers :read-only t)
  (column-mate (make-numbers 0) :type numbers :read-only t)
  (layer (make-numbers 0) :type numbers :read-only t)
  (reached (make-numbers 0) :type numbers :read-only t))

(defun make-cover (rows columns needed)
  (%make-cover rows columns needed
               (make-numbers (runs-count rows)) (make-numbers (runs-count columns))
               (make-numbers (runs-count rows)) (make-numbers (runs-count rows) 0)))

(declaim (inline tie-at))
(defun tie-at (cover row place)
  "Return the column that the cell at PLACE of ROW ties that to, or -1 if the cell is not needed."
  (declare (type fixnum row place))
  (let* ((rows (cover-rows cover))
         (index (+ (aref (runs-starts rows) row) place)))
    (declare (type cell-index index))
    (if (logbitp (aref (runs-cells rows) index) (cover-needed cover))
        (aref (runs-of (cover-columns cover)) index)
        -1)))

(defmacro do-ties ((column cover row) &body body)
  "Run BODY with each COLUMN that needed cells tie ROW to."
  (with-gensyms (place)
    `(dotimes (,place (aref (runs-lengths (cover-rows ,cover)) ,row))
       (let ((,column (tie-at ,cover ,row ,place)))
         (unless (minusp ,column) ,@body)))))

(defun find-layers (cover)
  "Note the layers of all rows. True if a way leads to a column that has no mate."
  (declare #.*hot*)
  (let* ((count (runs-count (cover-rows cover))) (layer (cover-layer cover))
         (queue (make-numbers count)) (end 0) (found nil))
    (declare (type fixnum count end) (type numbers layer queue))
    (fill layer -1)
    (fill (cover-reached cover) 0)
    (flet ((enqueue (row number)
             (setf (aref layer row) number
                   (aref queue end) row)
             (incf end)))
      (dotimes (row count)
        (when (minusp (aref (cover-row-mate cover) row)) (enqueue row 0)))
      (loop for next of-type fixnum from 0
            while (< next end)
            do (let ((row (aref queue next)))
                 (do-ties (column cover row)
                   (let ((mate (aref (cover-column-mate cover) column)))
                     (cond ((minusp mate) (setf found t))
                           ((minusp (aref layer mate))
                            (enqueue mate (1+ (aref layer row))))))))))
    found))

(defun next-tie (cover row)
  "Return the next column, of those that ROW has not tried in this round, that leads on: one without
a mate, or whose mate is in the next layer. NIL if there is none."
  (declare #.*hot* (type fixnum row))
  (let ((reached (cover-reached cover)) (layer (cover-layer cover))
        (length (aref (runs-lengths (cover-rows cover)) row)))
    (declare (type numbers reached layer))
    (loop while (< (aref reached row) length)
          do (let ((column (tie-at cover row (aref reached row))))
               (incf (aref reached row))
               (unless (minusp column)
                 (let ((mate (aref (cover-column-mate cover) column)))
                   (when (or (minusp mate) (= (aref layer mate) (1+ (aref layer row))))
                     (return column))))))))

(defun pair-along (cover way)
  "Let each row of WAY, conses (row . column), have its column for a mate."
  (loop for (row . column) in way
        do (setf (aref (cover-row-mate cover) row) column
                 (aref (cover-column-mate cover) column) row)))

(defun find-mate (cover row)
  "Find a mate for ROW, which has none, perhaps by giving other mates to others. If there is a way
in this round's layers, take it."
  (let ((way (list (cons row nil))))
    (loop while way
          do (let* ((row (car (first way))) (column (next-tie cover row)))
               (cond ((null column) (pop way))
                     (t (setf (cdr (first way)) column)
                        (let ((mate (aref (cover-column-mate cover) column)))
                          (cond ((minusp mate) (return (pair-along cover way)))
                                (t (push (cons mate nil) way))))))))))

(defun match-runs (cover)
  "Find a greatest matching for COVER. Its layers are then those of a round that finds no way."
  (loop while (find-layers cover)
        do (dotimes (row (runs-count (cover-rows cover)))
             (when (minusp (aref (cover-row-mate cover) row))
               (find-mate cover row))))
  cover)

(defun columns-to-take (cover)
  "Return a bit for each column of COVER: 1 if a row that the last round reached is tied to it."
  (let ((taken (make-array (runs-count (cover-columns cover))
                           :element-type 'bit :initial-element 0)))
    (dotimes (row (runs-count (cover-rows cover)) taken)
      (unless (minusp (aref (cover-layer cover) row))
        (do-ties (column cover row)
          (setf (sbit taken column) 1))))))

(defun fewest-lines (grid needed allowed)
  "Return as few straight lines as there can be, along rows and columns, that go through all cells
of GRID in a state of the list NEEDED and only through such in a state of the list ALLOWED: lists of
two ends (x y), those along rows first, from the top."
  (let* ((rows (find-runs grid allowed :rows)) (columns (find-runs grid allowed :columns))
         (cover (match-runs (make-cover rows columns (states-mask needed))))
         (taken (columns-to-take cover)))
    (flet ((ends (runs run)
             (multiple-value-list (run-ends runs run (grid-width grid)))))
      (append (loop for row below (runs-count rows)
                    when (minusp (aref (cover-layer cover) row)) collect (ends rows row))
              (loop for column below (runs-count columns)
                    when (= 1 (sbit taken column)) collect (ends columns column))))))
