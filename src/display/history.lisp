;;;; history.lisp -- where robots went, and what cameras last saw, for pictures.

(in-package :ars-magna.display)

(export '(history))

;;; An observer of a simulation records its history from the first call of KEEP-HISTORY. Trails are
;;; part of the simulation, by the names of robots. A trail is never modified, only replaced: so
;;; forks have the trails of the moment of the fork, and rewinding cuts them.

(defstruct (trail (:constructor make-trail (points count)) (:copier nil))
  "The trail of a robot. POINTS is a list x y tick placements x y ... of COUNT points, the newest
first. The number of placements counts how often the robot was put somewhere. If it differs between
two points, the robot was put elsewhere between them."
  (points '() :type list :read-only t)
  (count 0 :type fixnum :read-only t))

(defstruct (look (:constructor make-look (view x y ends)) (:copier nil))
  "The rays of a camera's last view. They lead from X, Y to ENDS, a list x y x y ...."
  (view '() :type list :read-only t)
  (x 0d0 :type double-float :read-only t)
  (y 0d0 :type double-float :read-only t)
  (ends '() :type list :read-only t))

(defstruct (history (:copier nil))
  "The camera views in a simulation, recorded for pictures. The simulation itself records trails."
  ;; An association list by camera: there are few cameras.
  (looks '() :type list))

(defconstant +trail-length+ 4000 "The largest number of points of a trail that are drawn.")
(defconstant +trail-step+ 0.1d0 "The least distance between the points of a trail, in metres.")

(defun trail-of-robot-named (name simulation)
  (cdr (assoc name (simulation-trails simulation) :test #'eq)))

(defmacro do-trail ((points &rest variables) &body body)
  "Run BODY, clauses of LOOP, for those POINTS of a trail that pictures show, the newest first.
VARIABLES are bound to the x, y, tick and placements of the point."
  `(loop for (,@variables) on ,points by #'cddddr
         repeat +trail-length+
         ,@body))

(defun moved-p (points x y)
  "True if X, Y is at least +TRAIL-STEP+ from the first point of POINTS, or if POINTS is empty."
  (declare #.*hot* (type double-float x y))
  (or (null points)
      (>= (+ (abs (- x (the double-float (first points))))
             (abs (- y (the double-float (second points)))))
          +trail-step+)))

(defun add-position-of-placement (robot tick points)
  "Return POINTS, the points of a trail. If ROBOT was placed elsewhere since the newest point, add
the position where ROBOT was placed, because ROBOT may have moved away by TICK."
  (if (and points
           (/= (the fixnum (robot-placements robot)) (the fixnum (fourth points)))
           (moved-p (list (robot-x robot) (robot-y robot)) (robot-put-x robot) (robot-put-y robot)))
      (list* (robot-put-x robot) (robot-put-y robot) tick (robot-placements robot) points)
      points))

(defun add-present-position (robot tick points)
  (list* (robot-x robot) (robot-y robot) tick (robot-placements robot)
         (add-position-of-placement robot tick points)))

(defun count-new-points (points before)
  "BEFORE is a tail of POINTS, a trail. Return the number of points before this tail."
  (loop for rest on points by #'cddddr until (eq rest before) count t))

(defun extended-trail (trail robot tick)
  "Return a copy of TRAIL, a trail or NIL, with a new point for the position of ROBOT at TICK."
  (let* ((before (and trail (trail-points trail)))
         (points (add-present-position robot tick before))
         (count (+ (if trail (trail-count trail) 0) (count-new-points points before))))
    (if (> count (* 2 +trail-length+))
        (make-trail (subseq points 0 (* 4 +trail-length+)) +trail-length+)
        (make-trail points count))))

(defun record-position (simulation robot)
  "Add the position of ROBOT to its trail in SIMULATION, if ROBOT has moved. Called in every tick."
  (declare #.*hot* (type robot robot))
  (let* ((name (robot-name robot)) (trail (trail-of-robot-named name simulation)))
    (when (moved-p (and trail (trail-points trail)) (robot-x robot) (robot-y robot))
      (setf (simulation-trails simulation)
            (acons name (extended-trail trail robot (simulation-tick simulation))
                   (remove name (simulation-trails simulation) :key #'car :test #'eq))))))

(defun robot-trail-points (robot)
  "Return the points of the trail of ROBOT, as a list x y tick placements ..., the newest first.
Return NIL if no trail is recorded. Forks do not record trails, so the last part of their trails is
a straight line to the present position of ROBOT."
  (let* ((simulation (robot-simulation robot))
         (trail (trail-of-robot-named (robot-name robot) simulation)))
    (cond ((null trail) '())
          ((moved-p (trail-points trail) (robot-x robot) (robot-y robot))
           (add-present-position robot (simulation-tick simulation) (trail-points trail)))
          (t (trail-points trail)))))

(defun trail-until (tick trail)
  (loop for points on (trail-points trail) by #'cddddr
        for count downfrom (trail-count trail)
        while (> (the fixnum (third points)) tick)
        finally (return (make-trail points count))))

;;; Looks.

(defun ray-ends (map opaque-p x y first step count)
  "Return the end points of COUNT rays of sight from X, Y in MAP, as a list x y .... The first ray
has the direction FIRST, and each next ray is STEP radians further. OPAQUE-P, a function of a cell's
index, returns true if the cell ends a ray."
  (loop for ray below count
        for angle = (+ first (* ray step))
        for dx = (cosine angle) and dy = (sine angle)
        for end = (walk-cells-on-line (lambda (index at column)
                                        (declare (ignore at column))
                                        (funcall opaque-p index))
                                      (map-width map) (map-height map) x y dx dy +no-limit+)
        collect (+ x (* end dx)) collect (+ y (* end dy))))

(defun rays-of-last-view (camera)
  "Return the rays of CAMERA's last view, on the assumption that CAMERA has not moved since."
  (let* ((robot (camera-robot camera))
         (x (robot-x robot)) (y (robot-y robot))
         (count (min 60 (camera-resolution camera)))
         (width (camera-field-of-view camera)) (step (/ width count))
         (first (- (+ (robot-angle robot) (camera-angle camera)) (* 0.5d0 (- width step))))
         (flags (world-flags (robot-world robot))))
    (make-look (camera-last-view camera) x y
               (ray-ends (world-map (robot-world robot))
                         (lambda (index) (logtest +opaque+ (aref flags index)))
                         x y first step count))))

(defun record-last-view (history camera)
  (declare #.*hot* (type history history) (type camera camera))
  (let ((entry (assoc camera (history-looks history) :test #'eq)))
    (unless (or (eq (camera-last-view camera) (and entry (look-view (cdr entry))))
                (null (robot-cell-index (camera-robot camera))))
      (let ((look (rays-of-last-view camera)))
        (if entry
            (setf (cdr entry) look)
            (push (cons camera look) (history-looks history)))))))

;;; Keeping.

(defun record-present-state (history simulation)
  (declare #.*hot* (type history history))
  (dolist (robot (simulation-robots simulation))
    (declare (type robot robot))
    (record-position simulation robot)
    (loop for camera across (robot-cameras robot) do (record-last-view history camera))))

(defvar *histories* (make-hash-table :test #'eq :weakness :key :synchronized t)
  "A table from simulations to pairs of the history and the observer that records this history.")

(defun history-of (simulation)
  (car (gethash simulation *histories*)))

(addition keep-history)
(defun keep-history (&optional (simulation (current-simulation)))
  "Record a history of SIMULATION from now on. Pictures can then show the trails of robots and the
rays of the cameras' last views. Return the history."
  (or (history-of simulation)
      (let* ((history (make-history))
             (observer (lambda (simulation) (record-present-state history simulation))))
        (setf (gethash simulation *histories*) (cons history observer))
        (asking (simulation)
          (record-present-state history simulation)
          (add-observer observer simulation))
        history)))

(defun copy-history-after-rewind (old new)
  "NEW is the simulation that replaces the simulation OLD after a rewind. Copy the trails of OLD to
NEW, up to the present tick of NEW. If a history of OLD is recorded, record that of NEW instead."
  (setf (simulation-trails new)
        (loop for (name . trail) in (simulation-trails old)
              collect (cons name (trail-until (simulation-tick new) trail))))
  (let ((entry (gethash old *histories*)))
    (when entry
      (remhash old *histories*)
      (remove-observer (cdr entry) new)
      (keep-history new))))

(add-listener *rewind-hooks* copy-history-after-rewind)
