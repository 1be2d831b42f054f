;;;; pursuit.lisp -- predators surround a prey (Vidal and Durfee 1995): the world, cells and moves.

(in-package :ars-pursuit)
(in-readtable :nisp)

(define-knob predators* 4 "predators" (integer 1 6) "How many predators hunt the prey.")
(define-knob order* :simultaneous "" (member :simultaneous :turns)
  "Whether all robots move at once, or in turns: the predators by number, then the prey.")
(define-knob contested* :none "" (member :none :one)
  "Who enters a cell that several robots want: nobody, or the one whose turn the simulator draws.")
(define-knob prey-stays* nil "" boolean "Whether the prey may stand still, as one of five moves.")
(define-knob metric* :steps "" (member :steps :straight :king)
  "How distances are measured: along the grid, as the crow flies, or as a king walks.")
(define-knob diagonal* :both "" (member :both :none)
  "To which quadrants a cell on a diagonal belongs: to both beside it, or to none.")
(define-knob quadrant-weight* 1 "cells" (real 0 100)
  "What a quadrant that is held adds to a payoff, as if the predator came so much nearer.")
(define-knob ties* :random "" (member :random :first)
  "Whether a predator draws among equally good moves, or takes the first: to stay, then east, south,
west, north.")
(define-knob time-limit* 500 "rounds" (integer 1 10000) "After how many rounds the prey escapes.")

;;; The world. A predator that does not take part stands in the lane below the field.

(defmap pursuit-field (22 24)
  (rect (0 0) (21 21) bricks 10)
  (rect (0 21) (21 23) bricks 10))

(defrobot prey (pursuit-field (20.5 22.5) 0) :attributes ((:color red)))
(defrobot predator-1 (pursuit-field (1.5 22.5) 0))
(defrobot predator-2 (pursuit-field (2.5 22.5) 0))
(defrobot predator-3 (pursuit-field (3.5 22.5) 0))
(defrobot predator-4 (pursuit-field (4.5 22.5) 0))
(defrobot predator-5 (pursuit-field (5.5 22.5) 0))
(defrobot predator-6 (pursuit-field (6.5 22.5) 0))

(define-run-variable *start* 0 "The tick in which the game began.")
(define-run-variable *goals* '(0) "The tick in which a round began, and the goals in it, cells.")
(define-run-variable *least-time* 0 "The least time to capture by the distances at the start.")

;; All predators model the same. This is no part of a run: it depends on its key only.
(defvar *last-mixes* '(nil) "The key and the result of the last call of MODELLED-MOVES.")

(defun predators ()
  "Return a list of the predators that take part, by number."
  (subseq (list predator-1 predator-2 predator-3 predator-4 predator-5 predator-6) 0 predators*))

(defun players () (append (predators) (list prey)))

;;; Cells are numbers, 20 a row from the north-west. Moves are 0, to stay, and 1 to 4 for east,
;;; south, west and north. A vector of cells has those of the predators, then that of the prey.

(deftype cell () '(integer 0 399))
(deftype cells () '(simple-array fixnum (*)))

(defun robot-cell (robot)
  (+ (floor (- (robot-x robot) 1)) (* 20 (floor (- (robot-y robot) 1)))))

(defun current-cells ()
  "Return the cells of the predators and, last, of the prey, a vector."
  (map 'cells #'robot-cell (players)))

(deftype move-number () '(integer 0 4))

(defun check-cell (operator name cell)
  (unless (typep cell 'cell)
    (reject-argument operator name cell "a cell, a number from 0 to 399, as in (current-cells)")))

(defun check-move (operator move)
  (unless (typep move 'move-number)
    (reject-argument operator 'move move
                     "0, to stay, or a number from 1 to 4, for east, south, west and north")))

(defun check-cells (operator cells)
  (unless (and (typep cells 'cells)
               (<= 2 (length cells) 7)
               (every (lambda (cell) (typep cell 'cell)) cells))
    (reject-argument operator 'cells cells
                     "a vector of cells, as (current-cells) returns it once a game has begun")))

;; Planning calls those without checks.
(declaim (inline %next-cell offsets %distance-to))
(defun %next-cell (cell move)
  (declare (type cell cell) (type move-number move))
  (multiple-value-bind (row column) (floor cell 20)
    (ecase move
      (0 cell)
      (1 (if (< column 19) (1+ cell) cell))
      (2 (if (< row 19) (+ cell 20) cell))
      (3 (if (plusp column) (1- cell) cell))
      (4 (if (plusp row) (- cell 20) cell)))))

(defun next-cell (cell move)
  "Return the cell that MOVE, from 0 to 4, leads to from CELL, which is CELL itself at a wall."
  (check-cell 'next-cell 'cell cell)
  (check-move 'next-cell move)
  (%next-cell cell move))

(defun offsets (from to)
  "Return how many columns and rows the cells FROM and TO are apart, and on which sides FROM is."
  (declare (type cell from to))
  (multiple-value-bind (row column) (floor from 20)
    (multiple-value-bind (to-row to-column) (floor to 20)
      (let ((columns (- column to-column)) (rows (- row to-row)))
        (values (abs columns) (abs rows) (if (plusp columns) 1 2) (if (plusp rows) 4 8))))))

(defun %distance-to (from to)
  (multiple-value-bind (dx dy) (offsets from to)
    (case metric*
      (:steps (float (+ dx dy) 1d0))
      (:king (float (max dx dy) 1d0))
      (t (sqrt (float (+ (* dx dx) (* dy dy)) 1d0))))))

(defun distance-to (from to)
  "Return the distance of two cells by METRIC*, a double-float."
  (check-cell 'distance-to 'from from)
  (check-cell 'distance-to 'to to)
  (%distance-to from to))

(defun move-all (cells goals after)
  "Write the cells into AFTER in which robots from CELLS are that all move at once to GOALS. A robot
enters a cell if no other wants it and who is there leaves it. So robots follow one another, but do
not change places."
  (declare (type cells cells goals after) (optimize speed))
  (replace after cells)
  (loop with count of-type (integer 0 7) = (length cells)
        while (loop with moved = nil
                    for i below count
                    for goal of-type fixnum = (aref goals i)
                    do (when (and (/= goal (aref after i))
                                  (loop for j below count
                                        always (or (= i j) (/= goal (aref goals j)))
                                        always (or (= i j) (/= goal (aref after j)))))
                         (setf (aref after i) goal moved t))
                    finally (return moved)))
  after)

(defun cells-after (cells moves)
  "Return the cells in which robots from CELLS are that all make their MOVES at once."
  (check-cells 'cells-after cells)
  (unless (and (typep moves '(or vector list))
               (= (length moves) (length cells))
               (every (lambda (move) (typep move 'move-number)) moves))
    (reject-argument 'cells-after 'moves moves
                     "a sequence of moves, from 0 to 4, one for each cell"))
  (move-all cells (map 'cells #'next-cell cells moves) (copy-seq cells)))

(defun captured-p (&optional (cells (current-cells)))
  "True if the prey cannot move: a predator or wall is on each side of it."
  (check-cells 'captured-p cells)
  (let* ((last (1- (length cells))) (target (aref cells last)))
    (loop for move from 1 to 4
          for beside = (%next-cell target move)
          always (or (= beside target) (find beside cells :end last)))))
