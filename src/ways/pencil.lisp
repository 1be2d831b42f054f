;;;; pencil.lisp -- a descent drawn as a way: in straight pieces, with as few turns as may be.

(in-package :ars-magna.ways)

(defconstant +dearer-if-straight+ 1.02d0
  "How many times as much a straight piece may cost as the steps that it stands for: it saves
turns.")

(defstruct (pencil (:constructor make-pencil (x y)) (:copier nil))
  "The way drawn so far: it turns at (X,Y), and steps that cost SINCE have led on to (END-X,END-Y)."
  (x 0d0 :type double-float)
  (y 0d0 :type double-float)
  (end-x x :type double-float)
  (end-y y :type double-float)
  (since 0d0 :type double-float)
  (points '() :type list))
(declaim-final pencil)

(defun turn-here (pencil)
  "Let the way of PENCIL have a point where it has come to."
  (push (make-pt (pencil-end-x pencil) (pencil-end-y pencil)) (pencil-points pencil))
  (setf (pencil-x pencil) (pencil-end-x pencil)
        (pencil-y pencil) (pencil-end-y pencil)
        (pencil-since pencil) 0d0))

(declaim (inline free-line-cost))
(defun free-line-cost (field x y end-x end-y limit leaving)
  "Return what the straight line from (X,Y) to (END-X,END-Y) costs on the cells of FIELD; +BARRED+
if it is not free, or costs more than LIMIT. LEAVING is true if it may begin near a wall."
  (let ((line (make-line x y end-x end-y limit)))
    (declare (dynamic-extent line))
    (measure-line line (field-cells field) (field-columns field) leaving)
    (line-cost line)))

(declaim (inline first-line-p))
(defun first-line-p (pencil)
  (null (pencil-points pencil)))

(declaim (inline go-straight-p draw-on))
(defun go-straight-p (pencil field x y limit last)
  "True if the line from the last turn of PENCIL to (X,Y) is free and costs no more than LIMIT. The
LAST line of a way may end as near to a wall as the first may begin."
  (declare (type pencil pencil) (type metres x y) (type double-float limit))
  (let ((from-x (pencil-x pencil)) (from-y (pencil-y pencil)))
    (or (< (free-line-cost field from-x from-y x y limit (first-line-p pencil)) +barred+)
        (and last (< (free-line-cost field x y from-x from-y limit t) +barred+)))))

(defun draw-on (pencil field x y cost last)
  "Let the way of PENCIL go on to (X,Y), by a free step that costs COST: straight, if that is as
good."
  (declare #.*hot* (type pencil pencil) (type metres x y) (type double-float cost))
  (let ((since (+ (pencil-since pencil) cost)))
    (unless (or (zerop (pencil-since pencil))
                (go-straight-p pencil field x y (* since +dearer-if-straight+) last))
      (turn-here pencil)
      (setf since cost))
    (setf (pencil-since pencil) since
          (pencil-end-x pencil) x
          (pencil-end-y pencil) y)
    nil))

(defun draw-to (pencil field x y cost &optional last)
  "Let the way of PENCIL go on to (X,Y), by a step that costs COST at most. LAST is true of its
last."
  (declare #.*hot* (type pencil pencil) (type metres x y) (type double-float cost))
  (let* ((from-x (pencil-end-x pencil)) (from-y (pencil-end-y pencil))
         (true-cost (free-line-cost field from-x from-y x y cost (first-line-p pencil))))
    (declare (type metres from-x from-y))
    (when (and (>= true-cost +barred+) (not last) (plusp (pencil-since pencil)))
      ;; By way of the cell's middle one comes near to no wall.
      (let ((middle-x (+ (ffloor from-x) 0.5d0)) (middle-y (+ (ffloor from-y) 0.5d0)))
        (draw-on pencil field middle-x middle-y
                 (free-line-cost field from-x from-y middle-x middle-y (/ +barred+ 2)
                                 nil)
                 nil)))
    (draw-on pencil field x y (min cost true-cost) last)))

(defun draw-way (pencil descent goal-x goal-y until turns)
  "Draw the way down DESCENT to (GOAL-X,GOAL-Y), or into a cell for which UNTIL is true, or to its
turn number TURNS."
  (let* ((field (descent-field descent)) (goal (field-goal field))
         (node (descent-node descent)))
    (loop until (or (= node goal)
                    (and turns (nthcdr (1- turns) (pencil-points pencil)))
                    (not (step-down descent)))
          do (draw-to pencil field (descent-x descent) (descent-y descent) (descent-step descent))
             (let ((next (descent-node descent)))
               (when (and until (/= node next))
                 (multiple-value-bind (row column) (floor (the node next) (field-columns field))
                   (when (funcall (the function until) (1- column) (1- row)) (return))))
               (setf node next))
          finally (when (= node goal) (draw-to-goal pencil descent goal-x goal-y)))
    (turn-here pencil)))

(defun draw-to-goal (pencil descent x y)
  "Draw the last step, within the cell of the goal, which is at (X,Y)."
  (let ((field (descent-field descent))
        (dx (- x (descent-x descent))) (dy (- y (descent-y descent))))
    (draw-to pencil field x y
             (* (sqrt (+ (* dx dx) (* dy dy))) (aref (field-cells field) (field-goal field)))
             t)))
