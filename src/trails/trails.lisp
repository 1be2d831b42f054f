;;;; trails.lisp -- where robots went, tick by tick, and what of that is worth drawing.

(in-package :ars-magna.trails)

(export '(note-places ways-along straightened))

(define-record (way (:constructor make-way (trial outcome pieces)))
  "Where a robot was in a trial."
  (trial 0 integer "the number of the trial in which the way was gone" :export)
  (outcome "" string "how that ended: \"success\", \"failure\", \"limit\" or \"error\"" :export)
  (pieces '() list "the pieces of the way, lists of points (x . y), in order" :export))

(define-record (trail (:constructor make-trail (robot)))
  "Where ROBOT has been so far."
  (robot nil robot)
  (placements nil (or null fixnum)
              "how often it had been put somewhere when it was seen last, or NIL" :writable)
  (pieces '() list
          "the pieces as those of a way, latest first, as are the points of each" :writable))

(defun note-point (trail x y)
  "Let the last piece of TRAIL go on to X, Y."
  (unless (equal (cons x y) (first (first (trail-pieces trail))))
    (push (cons x y) (first (trail-pieces trail)))))

(defun note-placement (trail)
  "Let a piece of TRAIL begin where its robot has been put: it may have driven on since."
  (let ((robot (trail-robot trail)) (begun-p (trail-placements trail)))
    (setf (trail-placements trail) (robot-placements robot))
    (push '() (trail-pieces trail))
    (when begun-p (note-point trail (robot-put-x robot) (robot-put-y robot)))))

(defun note-place (trail)
  (let ((robot (trail-robot trail)))
    (unless (eql (trail-placements trail) (robot-placements robot)) (note-placement trail))
    (note-point trail (robot-x robot) (robot-y robot))))

(defun note-places (simulation trails)
  "Add to TRAILS, a list, latest first, where the robots of SIMULATION are. Return it."
  (dolist (robot (simulation-robots simulation) trails)
    (note-place (or (find robot trails :key #'trail-robot)
                    (first (push (make-trail robot) trails))))))

(defun pieces-along (trail)
  (reverse (mapcar #'reverse (trail-pieces trail))))

(defun ways-along (trails trial outcome)
  "Return the ways that TRAILS, as NOTE-PLACES keeps them, say robots went in TRIAL, which ended
with OUTCOME. A trial that broke off before robots were seen has one way, without points: so it
counts."
  (if trails
      (loop for trail in (reverse trails) collect (make-way trial outcome (pieces-along trail)))
      (list (make-way trial outcome '()))))

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

(defun pieces-in-pixels (pieces)
  "Return PIECES of a way as lists x y ... in pixels, with the points that are worth drawing."
  (loop for piece in pieces
        collect (loop for (x . y) in (straightened piece (/ 1/2 graphics-scale*))
                      collect (to-pixels x) collect (to-pixels y))))
