;;;; descent.lisp -- down a field to its goal, from cell to cell at any angle.

(in-package :ars-magna.ways)

;;; From a point in a cell, a step leads to the best point of the ring around the cell's middle: of
;;; the eight sides between the middles of its neighbours. Only what costs less than where one is,
;;; by an eighth at least, is looked at, so that a descent ends, and depends on nothing that has not
;;; been settled.

(defconstant +least-drop+ 0.125d0 "By how much each step must come nearer to the goal.")

(defstruct (descent (:constructor make-descent (field x y value)) (:copier nil))
  "Somebody on the way down FIELD, at (X,Y), from where the goal costs VALUE."
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

(declaim (inline best-on-side))
(defun best-on-side (ahead aside drop cost)
  "Return how far along a side, from 0 to 1, the best point of it is for somebody AHEAD metres
before it and ASIDE from its start: on the way to it a metre costs COST, and the goal costs DROP
less at its end."
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
;;;        square | DIAGONAL         On the way to the start of the side one crosses two cells, this
;;;        -------+-----^---         one and STRAIGHT, along their EDGE; to any other point of it
;;;           *   | STRAIGHT         possibly all four of the SQUARE. A metre costs what it costs in
;;;                                  the dearest of the cells that may be crossed.
;;;
;;; The robot * is OFF the middle of its cell: the side is AHEAD metres away, and the robot ASIDE
;;; metres along it. PART of a side, from 0 to 1, is how far along it a point lies.

(defun step-down (descent)
  "Take a step. True if there was one."
  (declare #.*hot* (type descent descent))
  (let* ((field (descent-field descent)) (node (descent-node descent))
         (x (descent-x descent)) (y (descent-y descent))
         (limit (- (descent-value descent) +least-drop+))
         (middle-x (+ (ffloor x) 0.5d0)) (middle-y (+ (ffloor y) 0.5d0))
         (off-x (- x middle-x)) (off-y (- y middle-y))
         (least +barred+) (best-x 0d0) (best-y 0d0) (best-value 0d0))
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
                   (when (and (< square +barred+) (<= end limit))
                     (if (<= start limit)
                         (let ((part (best-on-side ahead aside (- start end) square)))
                           (propose square part (+ start (* part (- end start)))))
                         (propose square 1d0 end)))))))
        (look 1 0 0 1) (look 1 0 0 -1) (look -1 0 0 1) (look -1 0 0 -1)
        (look 0 1 1 0) (look 0 1 -1 0) (look 0 -1 1 0) (look 0 -1 -1 0)))
    (when (< least +barred+)
      (setf (descent-x descent) best-x
            (descent-y descent) best-y
            (descent-value descent) best-value
            (descent-step descent) (- least best-value))
      t)))
