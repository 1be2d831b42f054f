;;;; walls.lisp -- the wall, rect and circle clauses of a map, and how they are drawn.

(in-package :ars-magna.world)

;;; Coordinates are those of points: a corner lies in the cell that holds it, or, beyond the
;;; map's edge, in the last cell on that side, so that a room as wide as the map is closed.
;;; Later clauses overwrite earlier ones. Manual 5.1.

;; As reading 52 says.
(defun column-in (map x) (clamp (floor x) 0 (1- (map-width map))))
(defun row-in (map y) (clamp (floor y) 0 (1- (map-height map))))

(defun substance-number (map type)
  (position type (map-substance-types map) :start 1 :test #'same-name-p))

(defun fill-cell (map x y substance parameter)
  "Fill the cell nearest to X, Y (integers) in MAP with a wall."
  (let ((index (+ (column-in map x) (* (row-in map y) (map-width map)))))
    (setf (aref (map-flags map) index) +wall+
          (aref (map-substances map) index) substance
          (aref (map-parameters map) index) parameter)))

(defun build-line (map x0 y0 x1 y1 substance from to)
  "Fill a line by Bresenham's algorithm; the parameter changes evenly from FROM to TO (reading 57)."
  (let* ((dx (abs (- x1 x0))) (dy (- (abs (- y1 y0))))
         (step-x (signum (- x1 x0))) (step-y (signum (- y1 y0)))
         (steps (max dx (- dy) 1))
         (slack (+ dx dy)))
    (loop for step from 0
          do (fill-cell map x0 y0 substance (+ from (* (- to from) (/ step steps))))
          until (and (= x0 x1) (= y0 y1))
          do (let ((twice (* 2 slack)))
               (when (>= twice dy) (incf slack dy) (incf x0 step-x))
               (when (<= twice dx) (incf slack dx) (incf y0 step-y))))))

(defun draw-wall (map start end type from &optional (to from))
  (build-line map (column-in map (first start)) (row-in map (second start))
              (column-in map (first end)) (row-in map (second end))
              (substance-number map type) (double from) (double to)))

(defun draw-rect (map corner opposite type p0 &optional (p1 p0) (p2 p0) (p3 p0))
  "Draw the outline of a rectangle. P0 to P3 are the parameters at CORNER, at the corner beside it,
at OPPOSITE, and at the last corner (readings 55, 56)."
  (let ((beside (list (first opposite) (second corner)))
        (last (list (first corner) (second opposite))))
    (draw-wall map corner beside type p0 p1)
    (draw-wall map beside opposite type p1 p2)
    (draw-wall map opposite last type p2 p3)
    (draw-wall map last corner type p3 p0)))

(defun build-circle (map center radius type parameter)
  "Draw a circle by the midpoint algorithm. Points outside MAP move to its edge (reading 22)."
  (let ((cx (floor (first center))) (cy (floor (second center))))
    (if (encloses-map-p map cx cy radius)
        (draw-rect map '(0 0) (list (map-width map) (map-height map)) type parameter)
        (draw-octants map cx cy (round radius)
                      (substance-number map type) (double parameter)))))

(defun encloses-map-p (map cx cy radius)
  "True if all of MAP is well inside the circle, so that only walls along the map's edges remain."
  (let ((dx (max (abs cx) (abs (- (map-width map) cx))))
        (dy (max (abs cy) (abs (- (map-height map) cy)))))
    (< (+ dx dy 2) radius)))

(defun draw-octants (map cx cy radius substance parameter)
  (loop with x = radius and y = 0
        with slack = (- 1 x)
        while (<= y x)
        do (loop for (dx dy) in `((,x ,y) (,y ,x))
                 do (loop for (sx sy) in '((1 1) (1 -1) (-1 1) (-1 -1))
                          do (fill-cell map (+ cx (* sx dx)) (+ cy (* sy dy))
                                        substance parameter)))
           (incf y)
           (cond ((minusp slack) (incf slack (+ 1 (* 2 y))))
                 (t (decf x) (incf slack (+ 1 (* 2 (- y x))))))))

;;; The clauses.

(defun valid-material-p (type parameters counts)
  "True if TYPE can be a substance, and PARAMETERS are numbers. COUNTS lists how many are allowed."
  (and type (symbolp type) (member (length parameters) counts)
       (every #'bounded-number-p parameters)))

(define-map-clause wall (map start end type &rest parameters)
    "(wall (x0 y0) (x1 y1) substance parameter [parameter1]), with numbers from -1e15 to 1e15"
  :check (and (number-pair-p start) (number-pair-p end) (valid-material-p type parameters '(1 2)))
  :corners (list start end)
  :substance type
  :cells (apply #'draw-wall map start end type parameters))

(define-map-clause rect (map start end type &rest parameters)
    "(rect (x0 y0) (x1 y1) substance parameter [three more]), with numbers from -1e15 to 1e15"
  :check (and (number-pair-p start) (number-pair-p end) (valid-material-p type parameters '(1 4)))
  :corners (list start end)
  :substance type
  :cells (apply #'draw-rect map start end type parameters))

(define-map-clause circle (map center radius type parameter)
    "(circle (x y) radius substance parameter), numbers, radius not below 0"
  :check (and (number-pair-p center) (finite-p radius) (<= 0 radius)
              (valid-material-p type (list parameter) '(1)))
  :corners (destructuring-bind (x y) center
             (list (list (- x radius) (- y radius)) (list (+ x radius) (+ y radius))))
  :substance type
  :cells (build-circle map center radius type parameter))

;;; Building.

;; A cell takes 20 bytes in its map, 2 while it is built, and 9 in a world. Other data need room.
(defconstant +cell-bytes+ 40 "How many bytes of the heap there must be for each cell of a map.")

(defun check-map-memory (definition width height)
  "Signal MALFORMED-DEFINITION if the heap is too small for a map of WIDTH by HEIGHT cells."
  (let ((possible (floor (heap-bytes) +cell-bytes+)))
    (when (< possible (* width height))
      (reject-clause definition (list width height)
                     (format nil "a size of at most ~D cells in all, such as (~D ~:*~D): this Lisp ~
                                  has room for no more; start it with a larger ~
                                  --dynamic-space-size"
                             possible (min 32767 (isqrt possible)))))))

(defun substances-of (map clauses)
  (remove-duplicates (loop for clause in clauses collect (clause-value :substance map clause))
                     :test #'same-name-p :from-end t))

(defun clear-walls (map)
  "Empty all cells of MAP and number the substances of its clauses."
  (clear-grid map)
  (setf (map-substance-types map)
        (coerce (cons nil (substances-of map (map-clauses map))) 'simple-vector)))

(defun record-parameter-range (map)
  (loop for flag across (map-flags map)
        for parameter across (map-parameters map)
        when (logtest +wall+ flag)
          minimize parameter into least and maximize parameter into greatest and count t into walls
        finally (when (plusp walls)
                  (setf (map-least-parameter map) least
                        (map-greatest-parameter map) greatest))))

(defun record-wall-facts (map)
  "Record the range of the parameters of MAP's walls, and whether walls enclose MAP. Return MAP."
  (record-parameter-range map)
  (let ((right (1- (map-width map))) (bottom (1- (map-height map))))
    (setf (map-enclosed map)
          (and (loop for x from 0 to right
                     always (and (filled-cell-at-p map x 0) (filled-cell-at-p map x bottom)))
               (loop for y from 0 to bottom
                     always (and (filled-cell-at-p map 0 y) (filled-cell-at-p map right y)))))
    map))
