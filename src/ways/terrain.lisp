;;;; terrain.lisp -- what it costs to cross each cell of a map: computed once, shared by all.

(in-package :ars-magna.ways)

(export '(terrain))

;;; A metre costs 1 in the open, four times as much nearer to a wall than the clearance, and what
;;; the caller says in the cells of named place types. Costs are numbers from 1 up, and
;;; +BARRED-COST+ for walls. Cells have numbers, row by row, with a margin of walls, one cell wide,
;;; around them: so each cell of the map has neighbours on all sides. The number of a cell stands
;;; for its middle too, and is called a node then.

(defconstant +barred-cost+ 1d100
  "A cost above that of any way, for uncrossable cells and for nodes without a known way.")

(defconstant +near-wall-cost+ 4d0
  "The cost of a metre in cells nearer to a wall than the clearance.")

(deftype node () '(unsigned-byte 31))
(deftype amounts () '(simple-array double-float (*)))

(declaim (inline make-cost-vector))
(defun make-cost-vector (size amount)
  (make-array size :element-type 'double-float :initial-element amount))

(addition terrain-p)
(define-record (terrain (:constructor %make-terrain (map places clearance costs columns cells)))
  "A map and the cost of a metre in each of its cells, for one clearance and one table of costs of
places. A terrain does not change, so all threads and copies of runs share it."
  (map nil map "the map whose costs the terrain has" :addition)
  (places nil simple-array "the vector of the map's places when the terrain was made")
  (clearance 0 real "the distance from walls, in metres, within which cells cost more" :addition)
  (costs '() list "the costs of places")
  (columns 0 (integer 0 40000) "how many cells a row has, with its margin")
  (cells nil amounts)
  (fields '() list "a list of the fields of requested goals, newest first; the list is replaced,
never modified" :writable)
  (lock (make-lock "terrain") t))
(declaim-final terrain)

(defmethod print-object ((terrain terrain) stream)
  (print-unreadable-object (terrain stream :type t)
    (format stream "of ~A" (map-name (terrain-map terrain)))))

(define-shared-types terrain)

;;; Keeping them.

(define-global **terrains** (make-hash-table :test 'eq :weakness :key :synchronized t)
  "A table from maps to lists of their terrains, newest first. All threads share the table.")

(define-global **terrains-lock** (make-lock "terrains")
  "A lock that is held while a terrain is made, so that no other thread makes the same terrain.")

(defconstant +most-cached-terrains+ 8
  "The number of terrains that are kept for one map, with different clearances and costs.")

(defun discard-all-fields ()
  (dolist (terrains (hash-table-values **terrains**))
    (dolist (terrain terrains) (setf (terrain-fields terrain) '()))))

(defun ensure-memory (cells octets)
  "Signal MISUSE unless CELLS times OCTETS bytes are free. First discard all fields if necessary."
  (let ((all (* cells octets)))
    (unless (or (heap-room-p all)
                (progn (discard-all-fields) (heap-room-p all)))
      (reject-use "Ways on a map of ~D cells need ~D MB, more memory than this Lisp has; start ~
                   SBCL with a larger --dynamic-space-size."
                  cells (ceiling all 1000000)))))

;;; Cells.

(declaim (inline cell-node node-column node-row))
(defun cell-node (terrain x y)
  (declare (type (integer -1 32767) x y))
  (+ (1+ x) (* (1+ y) (terrain-columns terrain))))

(defun node-column (terrain node)
  (declare (type node node))
  (1- (mod node (terrain-columns terrain))))

(defun node-row (terrain node)
  (declare (type node node))
  (1- (floor node (terrain-columns terrain))))

(defun in-map-p (map x y)
  (and (<= 0 x) (< x (map-width map)) (<= 0 y) (< y (map-height map))))

;;; Making one.

(defun free-cell-costs (map columns)
  "Return costs of MAP's cells and a margin, a vector: 1, or +BARRED-COST+ in walls and margin."
  (let ((cells (make-cost-vector (* columns (+ 2 (map-height map))) +barred-cost+)) (index 0))
    (dotimes (y (map-height map) cells)
      (dotimes (x (map-width map))
        (unless (logtest +wall+ (aref (map-flags map) index))
          (setf (aref cells (+ 1 x (* columns (1+ y)))) 1d0))
        (incf index)))))

(defun clearance-offsets (clearance columns)
  "Return a list of (dx offset) for the cells whose middles are less than CLEARANCE from a wall's
cell. OFFSET is the number of such a cell minus the number of the wall's cell."
  (flet ((gap (d) (max 0 (- (abs d) 1/2))))
    (loop with radius = (ceiling clearance)
          for dy from (- radius) to radius
          append (loop for dx from (- radius) to radius
                       when (< (+ (expt (gap dx) 2) (expt (gap dy) 2)) (expt clearance 2))
                         collect (list dx (+ dx (* dy columns)))))))

(defun next-to-free-cell-p (cells columns node)
  "True if any of the eight cells around NODE is free."
  (declare (type amounts cells))
  (loop for row in (list (- columns) 0 columns)
        thereis (loop for offset from (1- row) to (1+ row)
                      for other = (+ node offset)
                      thereis (and (< -1 other (length cells))
                                   (< (aref cells other) +barred-cost+)))))

(defun raise-costs-near-walls (cells columns clearance)
  (declare (type amounts cells))
  (let ((offsets (clearance-offsets clearance columns)))
    (dotimes (node (length cells))
      (when (and (= +barred-cost+ (aref cells node)) (next-to-free-cell-p cells columns node))
        (loop for (dx offset) in offsets
              for other = (+ node offset)
              when (and (< -1 other (length cells))
                        (< -1 (+ dx (mod node columns)) columns)
                        (= 1d0 (aref cells other)))
                do (setf (aref cells other) +near-wall-cost+))))
    cells))

(defun set-place-costs (cells columns map costs)
  "Set the cost of CELLS that are places of a type in COSTS, a list of (name cost)."
  (let ((factors (cl:map 'vector
                         (lambda (type)
                           (second (and type (assoc (place-type-name type) costs
                                                    :test #'same-name-p))))
                         (map-place-types map)))
        (index 0))
    (dotimes (y (map-height map) cells)
      (dotimes (x (map-width map))
        (let ((cost (aref factors (aref (map-places map) index))))
          (when cost (setf (aref cells (+ 1 x (* columns (1+ y)))) cost)))
        (incf index)))))

(defun make-terrain (map clearance costs)
  (ensure-memory (* (map-width map) (map-height map)) 8)
  (let* ((columns (+ 2 (map-width map)))
         (cells (free-cell-costs map columns)))
    (raise-costs-near-walls cells columns clearance)
    (set-place-costs cells columns map costs)
    (%make-terrain map (map-places map) clearance costs columns cells)))

(defun cached-terrain (map clearance costs)
  (find-if (lambda (terrain)
             (and (eq (terrain-places terrain) (map-places map))
                  (= clearance (terrain-clearance terrain))
                  (equal costs (terrain-costs terrain))))
           (gethash map **terrains**)))

(defun cache-terrain (terrain)
  (let* ((map (terrain-map terrain))
         (others (remove (map-places map) (gethash map **terrains**)
                         :key #'terrain-places :test-not #'eq)))
    (setf (gethash map **terrains**)
          (cons terrain (subseq others 0 (min (length others) (1- +most-cached-terrains+)))))
    terrain))

(defun terrain-for-map (map clearance costs)
  "Return the terrain of the current state of MAP, for CLEARANCE in metres and COSTS, a list of
(name cost) with double-float costs. Equal arguments return the same terrain while it is kept."
  (or (cached-terrain map clearance costs)
      (with-lock (**terrains-lock**)
        (or (cached-terrain map clearance costs)
            (cache-terrain (make-terrain map clearance costs))))))
