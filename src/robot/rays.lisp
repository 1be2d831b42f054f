;;;; rays.lisp -- fans of rays across the grid, and what cells they meet (manual 3.4, chapter 4).

(in-package :ars-magna.robot)

;;; A ray passes from cell to cell (WALK-CELLS-ON-LINE). A fan is a number of evenly spaced rays;
;;; each is made from the one before by one rotation instead of a sine and a cosine. Only a list of
;;; the cells found is allocated. Each cell is found once: during a scan, the flags of the cells
;;; found carry +SEEN+ instead of +OCCUPIED+, so they are passed like empty ones. The cost depends
;;; on what is seen, not on the size of the map or the number of things in it.

(define-constant +seen+ 128
  :documentation "The flag of a cell that the current scan has found; clear between scans.")
(define-constant +least-component+ 1d-12
  :documentation "A component of a ray's direction that is nearer to 0 is replaced by this number.")

(deftype flag-vector () '(simple-array (unsigned-byte 8) (*)))
(deftype index-step ()
  "The difference of the indices of two neighbouring cells."
  '(signed-byte 16))

(declaim (inline nonzero-component walk-to-corner walk-ray))
(defun nonzero-component (component)
  "Return COMPONENT of a direction, or +LEAST-COMPONENT+ if almost 0, whatever its sign."
  (declare (type double-float component))
  (if (< (abs component) +least-component+) +least-component+ component))

(defun walk-to-corner (visit world x y dx dy)
  "Call VISIT as WALK-RAY does, but stop at an obstructed corner through which the ray passes.
Return the point beyond the corner, as two values, or NIL if the ray has ended."
  (declare (type function visit) (type double-float x y dx dy))
  (let* ((flags (world-flags world)) (map (world-map world))
         (beyond-x nil) (beyond-y nil))
    (walk-cells-on-line (lambda (index at column)
                          (declare (ignore column))
                          (let ((flag (aref flags index)))
                            (or (and (logtest flag +opaque+)
                                     (setf (values beyond-x beyond-y)
                                           (line-point-beyond-corner world +opaque+ (+ x (* dx at))
                                                                     (+ y (* dy at))
                                                                     dx dy)))
                                (funcall visit index flag))))
                        (map-width map) (map-height map) x y dx dy +no-limit+)
    (values beyond-x beyond-y)))

(defun walk-ray (visit world x y dx dy)
  "Call VISIT with index and flags of each cell of WORLD that the ray from (X,Y) in direction
(DX,DY) meets after its first cell, until VISIT returns true or the map ends. At a corner the ray
meets neither cell beside the corner, if one of the two cells lets it through (reading 100)."
  (declare (type function visit) (type double-float x y dx dy))
  (let ((dx (nonzero-component dx)) (dy (nonzero-component dy)) (map (world-map world)))
    (loop
      (multiple-value-bind (beyond-x beyond-y) (walk-to-corner visit world x y dx dy)
        (unless beyond-x (return))
        (let ((index (map-index map beyond-x beyond-y)))
          (when (or (null index) (funcall visit index (aref (world-flags world) index)))
            (return)))
        (setf x beyond-x y beyond-y)))))

(defun cells-past-corner (world x y dx dy)
  "If an opaque cell stops a ray in direction (DX,DY) at (X,Y), but the ray only touches a corner
there, continue the ray. Return a list of the cells with things that the continued ray meets."
  (let ((cells '()))
    (multiple-value-bind (beyond-x beyond-y) (line-point-beyond-corner world +opaque+ x y dx dy)
      (when beyond-x
        (flet ((visit (index flag)
                 (when (logtest flag +occupied+) (push index cells))
                 (logtest flag +opaque+)))
          (let ((index (map-index (world-map world) beyond-x beyond-y)))
            (unless (or (null index) (visit index (aref (world-flags world) index)))
              (walk-ray #'visit world beyond-x beyond-y dx dy))))))
    (nreverse cells)))

;;; The distance along one ray, for range sensors.

(define-constant +solid+ (logior +wall+ +obsmove+ +obsview+)
  :documentation "The flags of a cell that reflects the ray of a range sensor.")

(defun walk-to-solid-cell (world x y dx dy)
  "Return the distance from (X,Y) in direction (DX,DY), a unit vector, to the next solid cell of
WORLD and the cell's index; or to the edge of the map and NIL."
  (let ((flags (world-flags world)) (map (world-map world)) (found nil))
    (values (walk-cells-on-line (lambda (index at column)
                                  (declare (ignore at column))
                                  (when (logtest +solid+ (aref flags index)) (setf found index)))
                                (map-width map) (map-height map) x y dx dy +no-limit+)
            found)))

(defun trace-ray (world x y dx dy)
  "Do as WALK-TO-SOLID-CELL does, but pass corners as views do (reading 100)."
  (let ((length 0d0))
    (loop
      (multiple-value-bind (at index) (walk-to-solid-cell world x y dx dy)
        (incf length at)
        (multiple-value-bind (beyond-x beyond-y)
            (and index (line-point-beyond-corner world +solid+ (+ x (* dx at)) (+ y (* dy at))
                                                 dx dy))
          (cond ((null beyond-x) (return (values length index)))
                ((blocked-cell-p world beyond-x beyond-y +solid+)
                 (return (values length (map-index (world-map world) beyond-x beyond-y))))
                (t (setf x beyond-x y beyond-y))))))))

(defun solid-thing (index world)
  "Return the largest thing in the cell INDEX of WORLD that blocks the way or the view, or NIL."
  (let ((best nil))
    (do-cell-things (thing index world)
      (when (and (or (thing-obsmove-p thing) (thing-obsview-p thing))
                 (or (null best) (> (thing-size thing) (thing-size best))))
        (setf best thing)))
    best))

(addition cast-ray)
(defun cast-ray (world x y angle &optional maximum)
  "Return the true distance, in metres, from (X,Y) in the direction ANGLE, in radians, to the next
obstacle in WORLD, and the obstacle: :WALL, or the thing or body. Return NIL if the obstacle is
farther than MAXIMUM. Obstacles are the cells with a wall or with something on the floor that blocks
the way or the view, and the edge of the map, which counts as a wall. The cell of (X,Y) does not
count. No robot knows true distances: use CAST-RAY for sensors of your own, tests and displays. Call
it between ticks or inside a tick. Signals WRONG-ARGUMENT."
  (check-argument cast-ray world (world-p world) "a world, such as (robot-world ROBOT)")
  (check-inside-map 'cast-ray (world-map world) x y)
  (check-argument cast-ray angle (sane-number-p angle) (argument-type-text 'angle))
  (check-argument cast-ray maximum (or (null maximum) (and (sane-number-p maximum) (<= 0 maximum)))
                  "a number of metres, from 0 to 1e9, or NIL for no limit")
  (multiple-value-bind (distance index)
      (trace-ray world (double x) (double y) (cosine (double angle)) (sine (double angle)))
    (when (or (null maximum) (<= distance maximum))
      (values distance (or (and index
                                (not (logtest +wall+ (aref (world-flags world) index)))
                                (solid-thing index world))
                           :wall)))))

(defmacro do-rays ((dx dy &optional (per-x (gensym)) (per-y (gensym))) (angle width count)
                   &body body)
  "Run BODY for each of COUNT directions DX, DY, evenly spaced over WIDTH radians around
ANGLE (reading 146), with their reciprocals PER-X and PER-Y, finite, not 0. A direction's values are
computed before BODY runs for the previous one, so the processor can divide while BODY runs."
  (with-gensyms (spacing first cos sin next-x next-y next-per-x next-per-y)
    `(let* ((,spacing (/ ,width ,count))
            (,first (- ,angle (* 0.5d0 (- ,width ,spacing))))
            (,cos (cosine ,spacing)) (,sin (sine ,spacing))
            (,next-x (cosine ,first)) (,next-per-x (/ (nonzero-component ,next-x)))
            (,next-y (sine ,first)) (,next-per-y (/ (nonzero-component ,next-y))))
       (declare (type double-float ,spacing ,first ,cos ,sin
                      ,next-x ,next-y ,next-per-x ,next-per-y))
       (loop repeat ,count
             do (let ((,dx ,next-x) (,per-x ,next-per-x)
                      (,dy ,next-y) (,per-y ,next-per-y))
                  (declare (ignorable ,per-x ,per-y))
                  (setf ,next-x (- (* ,dx ,cos) (* ,dy ,sin))
                        ,next-y (+ (* ,dx ,sin) (* ,dy ,cos))
                        ,next-per-x (/ (nonzero-component ,next-x))
                        ,next-per-y (/ (nonzero-component ,next-y)))
                  ,@body)))))

;;; Scans are most of the cost of a robot that looks, so they have a separate walk, which meets the
;;; same cells as WALK-CELLS-ON-LINE. Values common to the rays of a fan are computed once, and
;;; cells of no interest cost one test. Without REACH, cells cost no count of borders.

(declaim (inline ray-axis-crossings walk-fan))
(defun ray-axis-crossings (back per stride behind ahead left-behind left-ahead)
  "Return the change of the cell index where a ray crosses a border of one axis, the distance of the
first crossing, and the largest number of crossings. PER is the distance from border to border along
the ray; BACK is true if the ray runs towards smaller coordinates. BEHIND and AHEAD are the
distances to the next border in both directions, LEFT-BEHIND and LEFT-AHEAD the numbers of borders."
  (declare (type double-float per behind ahead) (type grid-size stride left-behind left-ahead))
  (if back
      (values (- stride) (* per behind) left-behind)
      (values stride (* per ahead) left-ahead)))

(defun walk-fan (visit corner stops flags width height x y angle fan count reach)
  "Trace COUNT rays from (X,Y), evenly spaced over FAN radians around ANGLE. Call VISIT, which is
inline, for each cell after the first with some of the flags STOPS; its arguments are index and
flags of the cell. A ray ends when VISIT returns true, at the edge of the map, or after REACH
columns or rows. If REACH is the constant NIL, only VISIT ends rays. If a ray ends at a corner, call
CORNER, inline too, with the direction and the length of the ray."
  (declare (type function visit corner) (type flag-vector flags) (type (unsigned-byte 8) stops)
           (type double-float x y angle fan) (type grid-size width height)
           (type (or null grid-size) reach))
  (let* ((cell-x (column-or-row x)) (behind-x (- x cell-x)) (ahead-x (- (1+ cell-x) x))
         (cell-y (column-or-row y)) (behind-y (- y cell-y)) (ahead-y (- (1+ cell-y) y))
         (most (or reach 0))
         (left-behind-x (min most cell-x)) (left-ahead-x (min most (- width cell-x 1)))
         (left-behind-y (min most cell-y)) (left-ahead-y (min most (- height cell-y 1))))
    (do-rays (dx dy inverse-x inverse-y) (angle fan count)
      (let ((index (+ cell-x (* cell-y width)))
            (per-x (abs inverse-x)) (per-y (abs inverse-y)))
        (declare (type cell-index index) (type double-float per-x per-y))
        (multiple-value-bind (step-x at-x left-x)
            (ray-axis-crossings (minusp inverse-x) per-x 1 behind-x ahead-x left-behind-x
                                left-ahead-x)
          (declare (type index-step step-x) (type double-float at-x) (type grid-size left-x))
          (multiple-value-bind (step-y at-y left-y)
              (ray-axis-crossings (minusp inverse-y) per-y width behind-y ahead-y
                                  left-behind-y left-ahead-y)
            (declare (type index-step step-y) (type double-float at-y) (type grid-size left-y))
            (macrolet ((cross-border (at per step left)
                         `(progn
                            (when reach
                              (when (zerop ,left) (return))
                              (decf ,left))
                            (incf ,at ,per)
                            (setf index (the cell-index (+ index ,step))))))
              (loop
                (if (< at-x at-y)
                    (cross-border at-x per-x step-x left-x)
                    (cross-border at-y per-y step-y left-y))
                (let ((flag (aref flags index)))
                  (when (and (logtest stops flag) (funcall visit index flag)) (return)))))
            ;; Where the ray ended, it had crossed one border, and was about to cross the other.
            (flet ((look-past (crossed next per)
                     (when (<= (abs (- next crossed)) (* +contact-gap+ per))
                       (funcall corner (/ inverse-x) (/ inverse-y) crossed))))
              (declare (inline look-past))
              (look-past (- at-x per-x) at-y per-y)
              (look-past (- at-y per-y) at-x per-x))))))))
