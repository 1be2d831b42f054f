;;;; plans-reckoning.lisp -- dead reckoning: a robot's estimate of its position, and corrections.

;;; For plans that use a map. A RECKONING begins at a given position and has its own odometer. Walls
;;; met and doorways sensed correct it. Only HERE reads the true position, to start a plan.

(in-package :ars-worlds)
(in-readtable :nisp)

(defstruct (reckoning (:constructor make-reckoning (chart odometer x y heading)) (:copier nil))
  "A robot's estimated position on its map, metres driven, obstacles found. HEADING is in radians."
  (chart nil :type chart :read-only t)
  (odometer nil :read-only t)
  (x 0d0 :type real)
  (y 0d0 :type real)
  (heading 0d0 :type real)
  (driven 0d0 :type real)
  ;; A list of (cell cost until): the extra cost of the cell until that tick.
  (barred '() :type list)
  ;; The points of the doors that are believed to be closed.
  (closed '() :type list)
  (trouble 0 :type fixnum)
  ;; For meetings with other robots: see traffic.lisp.
  (passing-place nil :type list)
  (meetings 0 :type fixnum)
  (met-at 0d0 :type real)
  (dice nil))

(defun here (robot)
  "Return the true position and heading of ROBOT: a list (x y heading), the START of many plans."
  (append (multiple-value-list (robot-position robot)) (list (robot-angle robot))))

;;; Nothing marks the end of a reckoning. So a new reckoning takes the oldest of eight odometers.

(defparameter *reckoning-names* '(reckoning reckoning-2 reckoning-3 reckoning-4 reckoning-5
                                  reckoning-6 reckoning-7 reckoning-8)
  "The names of the odometers of reckonings.")

(defun next-odometer-name (robot)
  (let ((taken (remove-if-not (lambda (name) (member name *reckoning-names*))
                              (mapcar #'odometer-name (robot-odometers robot)))))
    (or (find-if-not (lambda (name) (member name taken)) *reckoning-names*)
        (first taken))))

(defun begin-reckoning (start &optional (robot (rpl-robot)))
  "Return a reckoning of ROBOT (default: the plan's robot) that begins at START, a list (x y
heading). The last eight reckonings of a robot are valid together; older reckonings are not."
  (destructuring-bind (x y heading) start
    (make-reckoning (make-chart (ars-magna.world:world-map (robot-world robot)))
                    (ars-magna.robot:make-odometer robot (next-odometer-name robot))
                    x y heading)))

(defun check-reckoning (me)
  "Signal MISUSE if a newer reckoning uses the odometer of the reckoning ME."
  (let ((odometer (reckoning-odometer me)))
    (unless (eq odometer (robot-odometer (ars-magna.robot:odometer-robot odometer)
                                         (odometer-name odometer)))
      (ars-magna.base:reject-use
       "This reckoning is no longer valid: the robot has begun ~D others since. Begin ~
        a new reckoning."
       (length *reckoning-names*)))))

(defun reckon (me)
  "Update the reckoning ME by its odometer; the robot must stand still. Return the estimated
position, a point. Signals MISUSE if ME is no longer valid: see BEGIN-RECKONING."
  (check-reckoning me)
  (let* ((odometer (reckoning-odometer me))
         (moved (nominal (get-odometer-pos odometer)))
         (turned (nominal (get-odometer-ang odometer)))
         (cos (cosine (reckoning-heading me))) (sin (sine (reckoning-heading me))))
    (reset-odometer odometer)
    (incf (reckoning-x me) (- (* cos (pt-x moved)) (* sin (pt-y moved))))
    (incf (reckoning-y me) (+ (* sin (pt-x moved)) (* cos (pt-y moved))))
    (incf (reckoning-heading me) turned)
    (incf (reckoning-driven me) (vector-length (pt-x moved) (pt-y moved)))
    (list (reckoning-x me) (reckoning-y me))))

(defun distance-left (me point)
  "Return the estimated distance of the robot of the reckoning ME from POINT, in metres."
  (apply #'vector-length (mapcar #'- point (reckon me))))

(defun angle-towards (me point)
  "Return the angle by which the robot of the reckoning ME has to turn to face POINT, in radians."
  (destructuring-bind (dx dy) (mapcar #'- point (reckon me))
    (angle-difference (atan2 dy dx) (reckoning-heading me))))

(defun point-ahead (me distance)
  "Return the point DISTANCE metres ahead of the robot of the reckoning ME."
  (destructuring-bind (x y) (reckon me)
    (list (+ x (* distance (cosine (reckoning-heading me))))
          (+ y (* distance (sine (reckoning-heading me)))))))

;;; The way shown in pictures.

(defun robot-of-reckoning (me)
  (ars-magna.robot:odometer-robot (reckoning-odometer me)))

(defun show-way (me points)
  "Show POINTS in pictures as the planned way of the robot of the reckoning ME; () shows none."
  (publish-way (robot-of-reckoning me) points))

;;; Obstacles. The chart has the cells that are barred now, the reckoning has the tick until when.

(defun update-barred-cells (me)
  "Bar on the chart of ME exactly the cells that ME has noted as barred, each at a cost of at most
90, and the doors that ME believes to be closed. Remove the shown way, because it may no longer be
the best."
  (show-way me '())
  (let ((chart (reckoning-chart me)) (sums '()))
    (loop for (cell cost) in (reckoning-barred me)
          for sum = (assoc cell sums :test #'equal)
          do (if sum
                 (setf (second sum) (min 90 (+ cost (second sum))))
                 (push (list cell cost) sums)))
    (free-all-cells chart)
    (loop for (cell cost) in sums
          when (apply #'no-wall-at-p (chart-map chart) cell)
            do (bar-cell chart cell cost))
    (dolist (door (reckoning-closed me))
      (when (apply #'no-wall-at-p (chart-map chart) door) (bar-cell chart door)))))

(defun believe-closed (me doors)
  "Let the reckoning ME believe that DOORS, a list of points (x y), are closed, and no others."
  (unless (equal doors (reckoning-closed me))
    (setf (reckoning-closed me) doors)
    (update-barred-cells me)))

(defun bar-cells-around (me point cost until)
  "Add COST to the cell at POINT, and an eighth of COST to the cells around, until the tick UNTIL."
  (loop for dx from -1 to 1
        do (loop for dy from -1 to 1
                 do (push (list (mapcar #'+ (cell-of-point point) (list dx dy))
                                (if (= 0 dx dy) cost (floor cost 8))
                                until)
                          (reckoning-barred me))))
  (update-barred-cells me))

(defun bar-cell-ahead (me)
  "Remember for 200 ticks that something stands directly ahead of the robot of the reckoning ME."
  (bar-cells-around me (point-ahead me .6) 40 (+ 200 (simulation-tick))))

(defun current-chart (me)
  "Return the chart of ME. Cells that were barred until a past tick are free again."
  (flet ((must-end-p (entry) (< (third entry) (simulation-tick))))
    (when (some #'must-end-p (reckoning-barred me))
      (setf (reckoning-barred me) (remove-if #'must-end-p (reckoning-barred me)))
      (update-barred-cells me)))
  (reckoning-chart me))

(defun way-shown-to-p (me end)
  "True if pictures show a way of the robot of the reckoning ME that leads to the point END."
  (let ((point (first (last (robot-planned-way (robot-of-reckoning me))))))
    (and point (= (first point) (pt-x end)) (= (second point) (pt-y end)))))

(defun show-way-to (me chart goal)
  "Show in pictures the way on CHART to GOAL for the robot of ME, unless it is shown already."
  (let ((end (nearest-free-point chart goal)))
    (when (and end (not (way-shown-to-p me end)))
      (let ((start (nearest-free-point chart (reckon me))))
        (show-way me (and start (find-way chart start end)))))))

(defun next-step-of (me goal)
  "Return the NEXT-STEP of the robot of the reckoning ME to GOAL, and show the way in pictures."
  (let ((chart (current-chart me)))
    (show-way-to me chart goal)
    (next-step chart (reckon me) goal)))

;;; Corrections.

(defun wall-crossed (map from to)
  "FROM and TO are points close together. If the face of a wall is between them, return two values:
the face's axis (0 for x, 1 for y) and its coordinate. Else return NIL."
  (when (and (apply #'no-wall-at-p map from) (not (apply #'no-wall-at-p map to)))
    (loop for axis in '(0 1)
          for a = (floor (nth axis from)) and b = (floor (nth axis to))
          when (/= a b) do (return (values axis (max a b))))))

(defun correct-by-wall (me)
  "Correct ME, whose robot has met a wall: move the estimate to the nearest wall ahead or behind.
Return T. If no wall is within two metres, change nothing and return NIL."
  (flet ((crossing (distance)
           (multiple-value-list
            (wall-crossed (chart-map (reckoning-chart me))
                          (point-ahead me distance) (point-ahead me (+ distance .05))))))
    (loop for distance from 0 to 2 by .05
          do (loop for (axis face) in (list (crossing distance) (crossing (- distance)))
                   when axis
                     do (if (zerop axis)
                            (setf (reckoning-x me) face)
                            (setf (reckoning-y me) face))
                        ;; Keep the estimate on the free side of the face.
                        (setf (values (reckoning-x me) (reckoning-y me))
                              (values-list (point-ahead me -1d-3)))
                        (return-from correct-by-wall t)))))

(defun doorway-nearby (me)
  "Return the cell of the doorway nearest to the estimate of ME, within 2.5 metres, or NIL."
  (destructuring-bind (x y) (reckon me)
    (let ((best nil) (least 2.5))
      (loop for dx from -3 to 3
            do (loop for dy from -3 to 3
                     for cell = (cell-of-point (list (+ x dx) (+ y dy)))
                     for distance = (apply #'vector-length (mapcar #'- (middle-of cell) (list x y)))
                     when (and (< distance least)
                               (doorway-at (chart-map (reckoning-chart me))
                                           (first cell) (second cell)))
                       do (setf best cell least distance)))
      best)))

(defun correct-by-cell (me cell)
  "Move the estimate of ME into CELL, as little as possible."
  (reckon me)
  (flet ((within (value low) (max (+ low .05) (min value (+ low .95)))))
    (setf (reckoning-x me) (within (reckoning-x me) (first cell))
          (reckoning-y me) (within (reckoning-y me) (second cell)))))

(defun correct-by-direction (me cell)
  "Set the estimated heading of ME to the nearest of the directions that the place at CELL has."
  (reckon me)
  (let ((place (doorway-at (chart-map (reckoning-chart me)) (first cell) (second cell))))
    (when place
      (setf (reckoning-heading me)
            (ars-magna.robot:nearest-direction
             (multiple-value-list (ars-magna.world:place-directions place))
             (reckoning-heading me))))))
