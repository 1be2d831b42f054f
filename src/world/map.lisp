;;;; map.lisp -- the grid that never changes: maps, cells, and the walk along a line.

(in-package :ars-magna.world)

(export '(map-replaced map-reference-form map-index point-index +wall+ +obsmove+ +obsview+
          +occupied+ +closed-door+ +wall-or-door+ +opaque+ cell *maps* find-map-argument
          walk-cells-on-line column-or-row grid-size
          +infinite-distance+
          +no-limit+))

;;; A map is built once (see defmap.lisp) and shared, without locks, by all worlds made of it.
;;; Cell (X, Y) covers [X, X+1) x [Y, Y+1) and has the index X + Y * width. Outside the map
;;; everything is solid. Manual 2.1 and 5.1.

(setf (fdefinition 'map) #'cl:map
      (documentation 'map 'function) "Do as CL:MAP does. (As a type, MAP is a grid world.)")

(defconstant +wall+ 1 "The flag of a cell filled by a wall.")
(defconstant +obsmove+ 2 "The flag of a cell where a thing on the floor blocks movement.")
(defconstant +obsview+ 4 "The flag of a cell where a thing on the floor blocks sight.")
(defconstant +opaque+ (logior +wall+ +obsview+) "The flags of a cell where sight ends.")
(defconstant +occupied+ 8 "The flag of a cell where any thing lies on the floor.")
(defconstant +closed-door+ 16 "The flag of a cell with a closed door.")
(defconstant +wall-or-door+ (logior +wall+ +closed-door+)
  "The flags of a cell that is a wall, or is like a wall because of a closed door.")

(deftype octets () '(simple-array (unsigned-byte 8) (*)))
(deftype doubles () '(simple-array double-float (*)))
(deftype indices () '(simple-array (unsigned-byte 16) (*)))

(public map)
(addition map-p)
(define-record (map (:constructor %make-map))
  "A fixed grid of cells, with recipes of the things in a fresh world of the map (manual 5.1)."
  (name nil symbol "the symbol that names the map" :addition)
  (width 1 (integer 1 32767) "how many cells the map is wide" :addition)
  (height 1 (integer 1 32767) "how many cells the map is high" :addition)
  (flags (make-octets 0) octets
         "the flags of the map's cells by index: +WALL+ where filled" :writable :export)
  (parameters (make-double-vector 0) doubles
              "the substance parameters of the cells by index, 0 where empty" :writable :export)
  (substances (make-array 0 :element-type '(unsigned-byte 16)) indices
              "the cells' substances by index, as indices in MAP-SUBSTANCE-TYPES" :writable :export)
  (substance-types #(nil) simple-vector
                   "a vector of substance names; element 0 is NIL, for no wall" :writable :export)
  (places (make-octets 0) octets
          "the cells' place types by index, as indices in MAP-PLACE-TYPES" :writable :export)
  (directions (make-double-vector 0) doubles
              "the basic canonical directions of cells by index, in radians" :writable :export)
  (place-types #(nil) simple-vector
               "a vector of the place types known to the map; element 0 is NIL" :writable :export)
  (least-parameter 0d0 double-float
                   "the least parameter of any wall in the map, 0 without walls" :writable :export)
  (greatest-parameter 0d0 double-float "the greatest parameter of any wall in the map, 0 without
walls" :writable :export)
  (enclosed nil boolean "true if walls fill all cells at the map's edges, so that no line leads
out" :writable :export)
  (things '() list
          "the recipes of the things that a fresh world of the map starts with" :writable :export)
  (attribute-names '() list "the keywords of the attributes that the map's things start
with" :writable :export)
  (package nil (or null string)
           "the name of the package that the map's author wrote in, or NIL" :export)
  (clauses '() list "the clauses of the map's walls, after expansion" :writable)
  (clause-kinds '() list "the names of the users' kinds of clauses that the map is written
with" :writable :export)
  (cache nil (or null string pathname) "the file that caches the map's grid, or NIL" :writable)
  (frame '(1 0 0 0) list "a list (size x y yaw) that relates the map to a frame of real coordinates:
the real side of a cell, in metres, the position of the map's lower left corner in the frame, in
metres, and the counterclockwise rotation of the map's x axis in the frame, in radians. The list is
(1 0 0 0) unless DEFMAP or IMPORT-MAP has set it" :addition)
  (resident nil t "the world of the map that top-level code works in, NIL before
the first use" :writable :export))

(defun make-octets (size) (make-array size :element-type '(unsigned-byte 8) :initial-element 0))
(defun make-double-vector (size) (make-array size :element-type 'double-float :initial-element 0d0))

(defun clear-grid (map)
  (let ((size (* (map-width map) (map-height map))))
    (setf (map-flags map) (make-octets size)
          (map-parameters map) (make-double-vector size)
          (map-substances map) (make-array size :element-type '(unsigned-byte 16)))))

(defmethod print-object ((map map) stream)
  (print-named map stream (map-name map)
               (format nil "MAP ~A ~Dx~D" (map-name map) (map-width map) (map-height map))))

(defmethod reference ((map map))
  (list :map (name-string (map-name map))))

;;; The registry.

(define-registry map "map" :object-p map-p :by-symbol t)

(defun find-map-argument (operator map)
  "Return the map that MAP means: a map or the name of one, given as the argument MAP of OPERATOR.
Signals WRONG-ARGUMENT and UNKNOWN-NAME."
  (unless (and map (typep map '(or map symbol string)))
    (reject-argument operator 'map map "a map, or the name of one"))
  (find-map map))

(defgeneric map-replaced (old new)
  (:documentation "Called when the map NEW has replaced the map OLD. OLD is NIL if there was no map
of this name. NEW is NIL if OLD is no longer defined. The layer above ends the runs of OLD.")
  (:method (old new) (declare (ignore old new)) nil))

(defun register-map (map)
  "Register MAP under its name (reading 61)."
  (deferring-interrupts
    (let ((old (nth-value 1 (register *maps* (map-name map) map :variable t))))
      (map-replaced old map)))
  map)

(defun map-reference-form (form environment)
  "Return a form whose value is the map that FORM denotes in ENVIRONMENT, or the map's name. A
symbol whose value is no map, such as ROOM, is the name of a map."
  (cond ((or (null form) (not (symbolp form))) form)
        ((local-variable-p form environment) form)
        ((known-variable-p form environment) `(variable-map-or-name ',form))
        (t `',form)))

(defun variable-map-or-name (name)
  "Return the value of the variable NAME if it is, or may be, a map or the name of one; else NAME."
  (let ((value (and (boundp name) (symbol-value name))))
    (if (or (map-p value)
            (stringp value)
            (and value (symbolp value))
            (and (typep value 'structure-object) (not (find-map name nil))))
        value
        name)))

(defmethod undo-definition ((map map))
  (map-replaced map nil))

;;; Cells.

(declaim (inline cell-index-at point-index))
(defun cell-index-at (map x y)
  "Return the index of the cell of MAP with the integer coordinates X and Y, or NIL outside MAP."
  (declare (type fixnum x y))
  (let ((width (map-width map)))
    (and (< -1 x width) (< -1 y (map-height map))
         (the cell-index (+ x (the cell-index (* y width)))))))

(defun point-index (map x y)
  "Return the index of MAP's cell that holds (X, Y), or NIL outside MAP; floats only (reading 51)."
  (declare (type double-float x y))
  (let ((width (map-width map)))
    (and (<= 0d0 x) (<= 0d0 y) (< x (double width)) (< y (double (map-height map)))
         (+ (truncate (the (double-float 0d0 32768d0) x))
            (the cell-index (* width (truncate (the (double-float 0d0 32768d0) y))))))))

(defun map-index (map x y)
  "Return the index of the cell of MAP that holds the point (X, Y), in metres, or NIL outside MAP."
  (point-index map (double x) (double y)))

;; As reading 53 says.
(defun filled-cell-at-p (map x y)
  (let ((index (cell-index-at map x y)))
    (or (null index) (logtest +wall+ (aref (map-flags map) index)))))

(defun check-point (operator x y)
  "Signal WRONG-ARGUMENT for OPERATOR unless X and Y are finite numbers."
  (flet ((check (name value)
           (unless (finite-p value)
             (reject-argument operator name value "a real number, from -1.7e308 to 1.7e308"))))
    (check 'x x)
    (check 'y y)))

(addition wall-at-p)
(defun wall-at-p (map x y)
  "True if the point (X, Y), in metres, is in a wall or outside MAP. Signals WRONG-ARGUMENT."
  (check-point 'wall-at-p x y)
  (let ((index (map-index map x y)))
    (or (null index) (logtest +wall+ (aref (map-flags map) index)))))

(addition cell-p)
(define-record (cell (:constructor make-cell (map x y)))
  "A cursor on the cell of MAP with the integer coordinates X and Y, perhaps outside MAP."
  (map nil map "the map that the cell is in" :addition)
  (x 0 fixnum "the cell's column, an integer" :writable :addition)
  (y 0 fixnum "the cell's row, an integer" :writable :addition))

(defmethod print-object ((cell cell) stream)
  (print-unreadable-object (cell stream)
    (format stream "CELL ~D ~D of ~A" (cell-x cell) (cell-y cell) (map-name (cell-map cell)))))

(addition map-cell)
(defun map-cell (map x y)
  "Return the cell of MAP that holds the point (X, Y), in metres; the point may be outside the map.
Signals WRONG-ARGUMENT unless X and Y are numbers from -1e9 to 1e9."
  (check-argument map-cell map (map-p map) "a map")
  (check-argument-type 'map-cell 'x x 'number)
  (check-argument-type 'map-cell 'y y 'number)
  (make-cell map (floor x) (floor y)))

(defun cell-index-in-map (cell)
  (cell-index-at (cell-map cell) (cell-x cell) (cell-y cell)))

(addition cell-filled?)
(defun cell-filled? (cell)
  "True if CELL is a wall; all cells outside the map count as walls (manual 5.1.1)."
  (filled-cell-at-p (cell-map cell) (cell-x cell) (cell-y cell)))

(addition cell-substance-type)
(defun cell-substance-type (cell)
  "Return the name of the substance of the wall in CELL, or NIL."
  (let ((map (cell-map cell)) (index (cell-index-in-map cell)))
    (and index (aref (map-substance-types map) (aref (map-substances map) index)))))

(addition cell-substance-parameter)
(defun cell-substance-parameter (cell)
  "Return the substance parameter of the wall in CELL; 0 if CELL is empty or outside the map."
  (let ((index (cell-index-in-map cell)))
    (if index (aref (map-parameters (cell-map cell)) index) 0d0)))

(public cell-occupancy-window)
(defun cell-occupancy-window (cell width height)
  "Return a list of HEIGHT rows, each a list of WIDTH entries, centred on CELL: T for a wall,
NIL for an empty cell (manual 5.1.1). If WIDTH or HEIGHT is even, there is one entry more before
CELL than after it. WIDTH and HEIGHT are at most 1000. Signals WRONG-ARGUMENT."
  (check-argument cell-occupancy-window width (whole-p width 1 1000) "an integer from 1 to 1000")
  (check-argument cell-occupancy-window height (whole-p height 1 1000) "an integer from 1 to 1000")
  (let ((map (cell-map cell))
        (left (- (cell-x cell) (floor width 2)))
        (top (- (cell-y cell) (floor height 2))))
    (loop for y from top repeat height
          collect (loop for x from left repeat width collect (filled-cell-at-p map x y)))))

;;; Driving, sight, scans and the display all walk here (a digital differential analyser), so a
;;; line meets the same cells for each. Distances along it are in lengths of its direction. All is
;;; inline, with VISIT a known function, so that nothing is called or allocated for a cell.

(defconstant +infinite-distance+ 1d100
  "A distance that stands for infinity, even if multiplied by a rounding error.")
(defconstant +no-limit+ 32767
  "A number of columns and rows that no walk along a line exceeds.")

(deftype grid-size ()
  "A number of columns or rows of a grid."
  '(unsigned-byte 15))

(declaim (inline column-or-row border-spacing distance-to-border walk-cells-on-line))
(defun column-or-row (coordinate)
  "Return the column or row of a grid that contains COORDINATE, in metres."
  (the grid-size (truncate (the (double-float 0d0 32767d0) coordinate))))

(defun border-spacing (component)
  "Return the distance, along a line, between neighbouring cell borders of one axis. COMPONENT is
the component of the line's direction on this axis."
  (declare (type double-float component))
  (if (zerop component) +infinite-distance+ (abs (/ component))))

(defun distance-to-border (start cell back)
  "Return the distance on one axis from START, in the column or row CELL, to the lower border of
CELL if BACK, else to the upper border."
  (declare (type double-float start) (type grid-size cell))
  (if back (- start cell) (- (1+ cell) start)))

(defun walk-cells-on-line (visit width height x y dx dy reach &optional column-first)
  "Call VISIT with each cell, after the first, on the line from (X,Y) in direction (DX,DY), in a
grid of WIDTH by HEIGHT that contains (X,Y). The arguments of VISIT are the cell's index, the
distance at which the line enters the cell, and whether the line comes from another column. Stop
when VISIT returns true, at the edge of the grid, or after REACH columns or rows; return the
distance at which the walk stops. At a corner the line enters the cell in the next row first or, if
the constant COLUMN-FIRST is true, the cell in the next column."
  (declare (type function visit) (type grid-size width height reach)
           (type double-float x y dx dy))
  (let* ((cell-x (column-or-row x)) (cell-y (column-or-row y))
         (back-x (minusp dx)) (back-y (minusp dy))
         (step-x (if back-x -1 1)) (step-y (if back-y (- width) width))
         (left-x (min reach (if back-x cell-x (- width cell-x 1))))
         (left-y (min reach (if back-y cell-y (- height cell-y 1))))
         (per-x (border-spacing dx)) (at-x (* per-x (distance-to-border x cell-x back-x)))
         (per-y (border-spacing dy)) (at-y (* per-y (distance-to-border y cell-y back-y)))
         (index (+ cell-x (* cell-y width))))
    (declare (type grid-size left-x left-y) (type fixnum step-x step-y)
             (type double-float per-x per-y at-x at-y) (type cell-index index))
    (loop
      (let ((at 0d0) (column nil))
        (declare (type double-float at))
        (cond ((if column-first (<= at-x at-y) (< at-x at-y))
               (setf at at-x)
               (when (zerop left-x) (return at))
               (setf left-x (1- left-x)
                     at-x (+ at-x per-x)
                     index (the cell-index (+ index step-x))
                     column t))
              (t
               (setf at at-y)
               (when (zerop left-y) (return at))
               (setf left-y (1- left-y)
                     at-y (+ at-y per-y)
                     index (the cell-index (+ index step-y)))))
        (when (funcall visit index at column) (return at))))))
