;;;; trails.lisp -- where robots went, tick by tick, and what of that is worth drawing.

(in-package :ars-magna.trails)

(defstruct (way (:constructor make-way (trial outcome points)) (:copier nil))
  "Where a robot was in TRIAL, a number, which ended with OUTCOME: POINTS are conses (x . y), in
metres, one for each tick in which it moved, the first being where it started."
  (trial 0 :type integer :read-only t)
  (outcome "" :type string :read-only t)
  (points #() :type simple-vector :read-only t))

(defun note-places (simulation trails)
  "Add to TRAILS, an alist from robots to their points, latest first, where those of SIMULATION are.
Return it."
  (dolist (robot (simulation-robots simulation) trails)
    (let ((trail (or (assoc robot trails)
                     (first (push (list robot) trails))))
          (point (cons (robot-x robot) (robot-y robot))))
      (unless (equal point (second trail))
        (push point (rest trail))))))

(defun ways-along (trails trial outcome)
  "Return the ways that TRAILS, as NOTE-PLACES keeps them, say robots went in TRIAL, which ended
with OUTCOME. A trial that broke off before robots were seen has one way, without points: so it
counts."
  (loop for (nil . points) in (or (reverse trails) '((nil)))
        collect (make-way trial outcome (coerce (reverse points) 'simple-vector))))

(document-functions
  way-trial "Return the number of the trial in which the way was gone."
  way-outcome "Return how that ended: \"success\", \"failure\", \"limit\" or \"error\"."
  way-points "Return the points of the way, conses (x . y), in order.")

;;; A way has a point for each tick. What is nearly straight needs only its ends.

(defun off-line (point start end)
  "Return how far POINT is from the line from START to END, or from START if they are one."
  (destructuring-bind ((x . y) (x1 . y1) (x2 . y2)) (list point start end)
    (let* ((dx (- x2 x1)) (dy (- y2 y1)) (square (+ (* dx dx) (* dy dy)))
           (share (if (zerop square)
                      0
                      (clamp (/ (+ (* dx (- x x1)) (* dy (- y y1))) square) 0 1))))
      (sqrt (+ (expt (- x x1 (* share dx)) 2) (expt (- y y1 (* share dy)) 2))))))

(defun straightened (points tolerance)
  "Return those of POINTS, a list, that a line through which leaves none off by more than TOLERANCE
(Douglas and Peucker 1973)."
  (let ((points (coerce points 'simple-vector)) (kept '()))
    (labels ((visit (start end)
               (let ((place nil) (most tolerance))
                 (loop for i from (1+ start) below end
                       for off = (off-line (svref points i) (svref points start)
                                           (svref points end))
                       when (> off most) do (setf place i most off))
                 (when place
                   (visit start place)
                   (push (svref points place) kept)
                   (visit place end)))))
      (if (< (length points) 3)
          (coerce points 'list)
          (let ((last (1- (length points))))
            (visit 0 last)
            (append (list (svref points 0)) (nreverse kept) (list (svref points last))))))))
