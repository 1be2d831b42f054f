;;;; runs.lisp -- the longest lines of cells, along rows and along columns, that a grid has.

(in-package :ars-magna.floors)

;;; A run is a line of cells that may be walls, with an end on either side. Each such cell is in
;;; one run along its row and in one along its column. Runs have numbers, from 0 for either kind.

(deftype numbers () '(simple-array (signed-byte 32) (*)))

(defun make-numbers (size &optional (initial -1))
  (make-array size :element-type '(signed-byte 32) :initial-element initial))

(defstruct (runs (:constructor make-runs (step cells of)) (:copier nil))
  "The runs of a grid in which STEP leads from a cell to the next: OF has the run of each cell, by
index, -1 for none; COUNT of them begin at the STARTS and have so many cells as LENGTHS say."
  (step 1 :type fixnum :read-only t)
  (cells (make-octets 0) :type octets :read-only t)
  (of (make-numbers 0) :type numbers :read-only t)
  (count 0 :type fixnum)
  (starts (make-numbers 0) :type numbers)
  (lengths (make-numbers 0) :type numbers))

(defun number-runs (runs lines per-line line-step allowed)
  "Give numbers to the cells of RUNS that are in a state ALLOWED, a bit for each state, in all LINES
of PER-LINE cells; LINE-STEP leads from a line to the next."
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
  (let ((starts (make-numbers (runs-count runs))) (lengths (make-numbers (runs-count runs) 0)))
    (loop for run across (runs-of runs) for index from 0
          unless (minusp run)
            do (when (minusp (aref starts run)) (setf (aref starts run) index))
               (incf (aref lengths run)))
    (setf (runs-starts runs) starts
          (runs-lengths runs) lengths)
    runs))

(defun states-mask (states)
  "Return a bit for each of the list STATES."
  (reduce #'logior states :key (lambda (state) (ash 1 state))))

(defun find-runs (grid allowed along)
  "Return the runs of GRID ALONG its :ROWS or :COLUMNS through cells in states ALLOWED, a list."
  (let* ((width (grid-width grid)) (height (grid-height grid)) (rows (eq along :rows))
         (runs (make-runs (if rows 1 width) (grid-cells grid) (make-numbers (* width height)))))
    (number-runs runs (if rows height width) (if rows width height) (if rows width 1)
                 (states-mask allowed))
    (measure-runs runs)))

(defun run-ends (runs run width)
  "Return the columns and rows of the first and the last cell of RUN, a number, in a grid of WIDTH:
two lists (x y)."
  (flet ((place (index) (nreverse (multiple-value-list (floor index width)))))
    (let ((start (aref (runs-starts runs) run)))
      (values (place start)
              (place (+ start (* (runs-step runs) (1- (aref (runs-lengths runs) run)))))))))
