;;;; lines.lisp -- what a straight line costs, by the cells that it crosses.

;;; A line is cut at all whole and half coordinates: a piece of it is in one cell, whose cost
;;; counts, and in one square between nodes, which must have no wall at its corners. So lines keep
;;; half a metre off walls, as steps from node to node do. But one along a row of nodes, as through
;;; a doorway, need only cross free cells; and who stands near a wall may leave his own cell at any
;;; angle at which nothing else is near.

(in-package :ars-magna.ways)

(deftype metres () '(double-float -1d5 1d5))
(deftype halves () "A whole number of half metres." '(signed-byte 20))

(declaim (inline piece-cost))
(defun piece-cost (cells columns i j narrow)
  "Return what a metre costs in the half cell (I J) of CELLS; it is half as wide and high as one.
NARROW is true of a line that only needs free cells."
  (declare (type amounts cells) (type (integer 0 40000) columns) (type halves i j))
  (flet ((cell (column row) (aref cells (the node (+ 1 column row))))
         (row (j) (* columns (1+ (ash j -1)))))
    (declare (inline cell row))
    (or (unless narrow
          (let ((left (ash (1- i) -1)) (right (ash (1+ i) -1))
                (above (row (1- j))) (below (row (1+ j))))
            (when (or (>= (cell left above) +barred+) (>= (cell left below) +barred+)
                      (>= (cell right above) +barred+) (>= (cell right below) +barred+))
              +barred+)))
        (cell (ash i -1) (row j)))))

;; It lives on the stack, and functions get it instead of floats, which would have to be boxed.
(declaim (inline make-line))
(defstruct (line (:constructor make-line (x y end-x end-y limit)) (:copier nil) (:predicate nil))
  "A straight line from (X,Y) to (END-X,END-Y), which is to cost no more than LIMIT, and what it
costs."
  (x 0d0 :type metres :read-only t)
  (y 0d0 :type metres :read-only t)
  (end-x 0d0 :type metres :read-only t)
  (end-y 0d0 :type metres :read-only t)
  (limit 0d0 :type double-float :read-only t)
  (cost 0d0 :type double-float))
(declaim-final line)

(defun measure-line (line cells columns leaving)
  "Let LINE have what it costs; +BARRED+ if it is not free, or costs more than its limit. CELLS are
those of a terrain or field, COLUMNS in a row. LEAVING is true if it may begin near a wall."
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
                      (incf sum (* piece (piece-cost cells columns i j narrow))))
                    (when (> sum limit) (return +barred+)))
                  (when (>= next 1d0) (return sum))
                  (setf part (max part next))
                  (if (<= next-u next-v)
                      (setf i (+ i step-i) next-u (+ next-u between-u))
                      (setf j (+ j step-j) next-v (+ next-v between-v))))))))))
