;;;; grid.lisp -- from pixels to cells, and to as few straight walls as possible.

(in-package :ars-magna.floors)

;;; The darker a pixel, the higher the probability that it is occupied; :negate reverses that. Above
;;; one threshold it is occupied, below the other free, between them unknown. In the mode raw the
;;; value is the probability in percent, and unknown above 100. In the mode scale ROS has shades
;;; between the thresholds. Our cells are walls or not, so shades are unknown, too.

(defconstant +free+ 0 "The state of a free cell.")
(defconstant +occupied+ 1 "The state of an occupied cell.")
(defconstant +unknown+ 2 "The state of an unknown cell.")

(defstruct (grid (:constructor make-grid
                     (width height &optional (cells (make-octets (* width height)))))
                 (:copier nil))
  "A grid of WIDTH by HEIGHT cells, row by row from the top: +FREE+, +OCCUPIED+ or +UNKNOWN+."
  (width 1 :type (integer 1) :read-only t)
  (height 1 :type (integer 1) :read-only t)
  (cells (make-array 0 :element-type '(unsigned-byte 8)) :type octets :read-only t))

(defun count-cells (state grid)
  (count state (grid-cells grid)))

(defun occupied-probability (description sample white)
  "Return the probability that a pixel with value SAMPLE is occupied, or NIL for an unknown pixel."
  (let ((brightness (/ sample white)))
    (cond ((eq :raw (description-mode description))
           (let ((percent (round (* 255 brightness))))
             (and (<= percent 100) (/ percent 100))))
          ((description-negated-p description) brightness)
          (t (- 1 brightness)))))

(defun pixel-state (description sample white)
  (let ((chance (occupied-probability description sample white)))
    (cond ((null chance) +unknown+)
          ((< (description-occupied description) chance) +occupied+)
          ((< chance (description-free description)) +free+)
          (t +unknown+))))

(defun pixel-state-table (description white)
  "Return a vector of the states of pixels, indexed by the pixel's value from 0 to WHITE. The value
WHITE + 1 stands for unknown."
  (let ((table (make-octets (+ 2 white))))
    (setf (aref table (1+ white)) +unknown+)
    (dotimes (sample (1+ white) table)
      (setf (aref table sample) (pixel-state description sample white)))))

;;; Cells of several pixels. They start at the lower left corner, where the origin is. So the top
;;; row and the last column may have fewer pixels.

(defun block-state (free occupied unknown share)
  "Return the state of a cell with these numbers of FREE, OCCUPIED and UNKNOWN pixels. The cell is
occupied if at least one pixel and at least the share SHARE of all pixels are occupied, else unknown
if more pixels are unknown than free."
  (cond ((and (plusp occupied) (<= (* share (+ free occupied unknown)) occupied)) +occupied+)
        ((< free unknown) +unknown+)
        (t +free+)))

(defun count-states (image table left top right bottom)
  "Count free, occupied and unknown pixels of IMAGE in a rectangle. TABLE maps values to states."
  (let ((samples (image-samples image)) (width (image-width image))
        (counts (make-array 3 :initial-element 0)))
    (declare (type samples samples) (type octets table) (dynamic-extent counts))
    (loop for y from top below bottom
          do (loop for x from left below right
                   do (incf (aref counts (aref table (aref samples (+ x (* y width))))))))
    (values (aref counts +free+) (aref counts +occupied+) (aref counts +unknown+))))

(defun block-grid (image table side share)
  (let* ((width (ceiling (image-width image) side))
         (height (ceiling (image-height image) side))
         (missing (- (* side height) (image-height image)))
         (grid (make-grid width height)))
    (dotimes (y height grid)
      (let* ((top (- (* y side) missing)) (bottom (+ top side)))
        (dotimes (x width)
          (setf (aref (grid-cells grid) (+ x (* y width)))
                (multiple-value-call #'block-state
                  (count-states image table (* x side) (max 0 top)
                                (min (image-width image) (* (1+ x) side)) bottom)
                  share)))))))

(defun pixel-grid (image table)
  (let ((samples (image-samples image))
        (grid (make-grid (image-width image) (image-height image))))
    (declare (type samples samples) (type octets table))
    (let ((cells (grid-cells grid)))
      (dotimes (index (length cells) grid)
        (setf (aref cells index) (aref table (aref samples index)))))))

(defun image-grid (image description side share)
  (let ((table (pixel-state-table description (image-white image))))
    (if (= 1 side)
        (pixel-grid image table)
        (block-grid image table side share))))

;;;; The longest lines of cells, along rows and along columns

;;; A run is a line of cells that may be walls, as long as possible. Each such cell is in one run
;;; along its row and in one along its column. The runs of either kind are numbered from 0.

(deftype numbers () '(simple-array (signed-byte 32) (*)))

(defun make-number-vector (size &optional (initial -1))
  (make-array size :element-type '(signed-byte 32) :initial-element initial))

(defstruct (runs (:constructor make-runs (step cells of)) (:copier nil))
  "The COUNT runs of a grid along its rows or columns. STEP is the difference of the indices of two
neighbouring cells of a run. OF has the number of each cell's run, or -1. STARTS and LENGTHS have
the first cell and the length of each run."
  (step 1 :type fixnum :read-only t)
  (cells (make-octets 0) :type octets :read-only t)
  (of (make-number-vector 0) :type numbers :read-only t)
  (count 0 :type fixnum)
  (starts (make-number-vector 0) :type numbers)
  (lengths (make-number-vector 0) :type numbers))

(defun number-runs (runs lines per-line line-step allowed)
  "Number the runs of cells whose state has its bit set in ALLOWED, and store the numbers in RUNS.
The grid has LINES lines of PER-LINE cells; LINE-STEP is the index step to the next line."
  (declare #.*hot* (type fixnum lines per-line line-step allowed))
  (let ((cells (runs-cells runs)) (of (runs-of runs)) (step (runs-step runs)) (count 0))
    (declare (type octets cells) (type numbers of) (type fixnum step count))
    (dotimes (line lines)
      (let ((inside nil) (index (* line line-step)))
        (declare (type cell-index index))
        (dotimes (place per-line)
          (let ((wall (logbitp (aref cells index) allowed)))
            (when (and wall (not inside)) (incf count))
            (when wall (setf (aref of index) (1- count)))
            (setf inside wall)
            (incf index step)))))
    (setf (runs-count runs) count)
    runs))

(defun measure-runs (runs)
  (let ((starts (make-number-vector (runs-count runs)))
        (lengths (make-number-vector (runs-count runs) 0)))
    (loop for run across (runs-of runs) for index from 0
          unless (minusp run)
            do (when (minusp (aref starts run)) (setf (aref starts run) index))
               (incf (aref lengths run)))
    (setf (runs-starts runs) starts
          (runs-lengths runs) lengths)
    runs))

(defun states-mask (states)
  (reduce #'logior states :key (lambda (state) (ash 1 state))))

(defun find-runs (grid allowed along)
  "Return GRID's runs of cells with states in the list ALLOWED. ALONG is :ROWS or :COLUMNS."
  (let* ((width (grid-width grid)) (height (grid-height grid)) (rows (eq along :rows))
         (runs (make-runs (if rows 1 width) (grid-cells grid)
                          (make-number-vector (* width height)))))
    (number-runs runs (if rows height width) (if rows width height) (if rows width 1)
                 (states-mask allowed))
    (measure-runs runs)))

(defun run-ends (runs run width)
  "Return a list of the first and last cell (x y) of run number RUN in a grid WIDTH cells wide."
  (flet ((place (index) (nreverse (multiple-value-list (floor index width)))))
    (let ((start (aref (runs-starts runs) run)))
      (list (place start)
            (place (+ start (* (runs-step runs) (1- (aref (runs-lengths runs) run)))))))))

;;;; As few lines as possible

;;; Each cell that has to be a wall must be in a wall along its row or along its column. Whole runs
;;; are never worse than parts of them. So the cells are the edges of a bipartite graph of runs, and
;;; we want a minimum vertex cover. By Koenig's theorem it follows from a maximum matching: pairs of
;;; runs (mates) that share a cell, each run in one pair at most. Hopcroft and Karp find a matching
;;; in rounds: from rows without a mate, layer by layer, along alternating paths of edges and pairs.

(defstruct (cover (:constructor %make-cover
                      (rows columns needed row-mate column-mate layer reached))
                  (:copier nil))
  "The current matching of the runs ROWS and COLUMNS: the ROW-MATE of each row is a column or -1,
the COLUMN-MATE of each column a row or -1. Cells whose state has its bit set in NEEDED are edges.
In a round, LAYER has for each row the number of pairs on the path to a row without a mate, or -1
without a path. REACHED has for each row how many of its cells were tried."
  (rows nil :type runs :read-only t)
  (columns nil :type runs :read-only t)
  (needed 0 :type (unsigned-byte 8) :read-only t)
  (row-mate (make-number-vector 0) :type numbers :read-only t)
  (column-mate (make-number-vector 0) :type numbers :read-only t)
  (layer (make-number-vector 0) :type numbers :read-only t)
  (reached (make-number-vector 0) :type numbers :read-only t))

(defun make-cover (rows columns needed)
  (%make-cover rows columns needed
               (make-number-vector (runs-count rows)) (make-number-vector (runs-count columns))
               (make-number-vector (runs-count rows)) (make-number-vector (runs-count rows) 0)))

(declaim (inline edge-column-at))
(defun edge-column-at (cover row place)
  "Return the column that shares the cell at PLACE of ROW, or -1 if the cell is not needed."
  (declare (type fixnum row place))
  (let* ((rows (cover-rows cover))
         (index (+ (aref (runs-starts rows) row) place)))
    (declare (type cell-index index))
    (if (logbitp (aref (runs-cells rows) index) (cover-needed cover))
        (aref (runs-of (cover-columns cover)) index)
        -1)))

(defmacro do-edge-columns ((column cover row) &body body)
  "Run BODY with COLUMN bound to each column that shares a needed cell with ROW."
  (with-gensyms (place)
    `(dotimes (,place (aref (runs-lengths (cover-rows ,cover)) ,row))
       (let ((,column (edge-column-at ,cover ,row ,place)))
         (unless (minusp ,column) ,@body)))))

(defun find-layers (cover)
  "Compute the layers of all rows of COVER. Return true if a path leads to a column without a mate."
  (declare #.*hot*)
  (let* ((count (runs-count (cover-rows cover))) (layer (cover-layer cover))
         (queue (make-number-vector count)) (end 0) (found nil))
    (declare (type fixnum count end) (type numbers layer queue))
    (fill layer -1)
    (fill (cover-reached cover) 0)
    (flet ((enqueue (row number)
             (setf (aref layer row) number
                   (aref queue end) row)
             (incf end)))
      (dotimes (row count)
        (when (minusp (aref (cover-row-mate cover) row)) (enqueue row 0)))
      (loop for next of-type fixnum from 0
            while (< next end)
            do (let ((row (aref queue next)))
                 (do-edge-columns (column cover row)
                   (let ((mate (aref (cover-column-mate cover) column)))
                     (cond ((minusp mate) (setf found t))
                           ((minusp (aref layer mate))
                            (enqueue mate (1+ (aref layer row))))))))))
    found))

(defun next-edge-column (cover row)
  "Return the next column that ROW has not tried in this round. The column must have no mate, or a
mate in the next layer. Return NIL if there is no such column."
  (declare #.*hot* (type fixnum row))
  (let ((reached (cover-reached cover)) (layer (cover-layer cover))
        (length (aref (runs-lengths (cover-rows cover)) row)))
    (declare (type numbers reached layer))
    (loop while (< (aref reached row) length)
          do (let ((column (edge-column-at cover row (aref reached row))))
               (incf (aref reached row))
               (unless (minusp column)
                 (let ((mate (aref (cover-column-mate cover) column)))
                   (when (or (minusp mate) (= (aref layer mate) (1+ (aref layer row))))
                     (return column))))))))

(defun find-mate (cover row)
  "If possible, find a mate for ROW, which has none, on a path through the layers of this round.
Pair each row of the path with its column on the path, so that some rows change their mates."
  (let ((way (list (cons row nil))) (column-mate (cover-column-mate cover)) (done nil))
    (loop until (or done (null way))
          do (let ((column (next-edge-column cover (car (first way)))))
               (cond ((null column) (pop way))
                     (t (setf (cdr (first way)) column)
                        (if (minusp (aref column-mate column))
                            (setf done t)
                            (push (cons (aref column-mate column) nil) way))))))
    (loop for (row . column) in way
          do (setf (aref (cover-row-mate cover) row) column
                   (aref column-mate column) row))))

(defun find-maximum-matching (cover)
  "Find a maximum matching for COVER. Keep the layers of the last round, which found no path."
  (loop while (find-layers cover)
        do (dotimes (row (runs-count (cover-rows cover)))
             (when (minusp (aref (cover-row-mate cover) row))
               (find-mate cover row))))
  cover)

(defun covering-columns (cover)
  "Return a bit vector, 1 for columns that share a needed cell with a row that has a layer."
  (let ((taken (make-array (runs-count (cover-columns cover))
                           :element-type 'bit :initial-element 0)))
    (dotimes (row (runs-count (cover-rows cover)) taken)
      (unless (minusp (aref (cover-layer cover) row))
        (do-edge-columns (column cover row)
          (setf (sbit taken column) 1))))))

(defun fewest-lines (grid needed allowed)
  "Return a list of as few straight lines as possible. They cover all cells of GRID with a state in
the list NEEDED, and no cell with a state outside the list ALLOWED. A line is a list of its two ends
(x y). Lines along rows come first, from the top, then lines along columns."
  (let* ((rows (find-runs grid allowed :rows)) (columns (find-runs grid allowed :columns))
         (cover (find-maximum-matching (make-cover rows columns (states-mask needed))))
         (taken (covering-columns cover)) (width (grid-width grid)))
    (append (loop for row below (runs-count rows)
                  when (minusp (aref (cover-layer cover) row)) collect (run-ends rows row width))
            (loop for column below (runs-count columns)
                  when (= 1 (sbit taken column)) collect (run-ends columns column width)))))
