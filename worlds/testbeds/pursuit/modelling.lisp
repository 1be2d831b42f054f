;;;; modelling.lisp -- predators that model what the others will do, and one that forks.

(in-package :ars-pursuit)
(in-readtable :nisp)

(deftype reals () '(simple-array double-float (*)))

;;; A predator's payoff is by how much it has come nearer to the prey, and a
;;; weight for each quadrant that is held. At level 1 it expects all moves of the others to be
;;; equally likely; at level N, that they choose at level N - 1. TIES* decides between equally
;;; good moves. The prey is always expected to move at random. A mix is five probabilities of moves.

(defun %quadrants-held (cells)
  (declare (type cells cells) (optimize speed))
  (let ((last (1- (length cells))) (held 0))
    (declare (type (integer 0 15) held))
    (dotimes (i last (logcount held))
      (multiple-value-bind (columns rows x-side y-side) (offsets (aref cells i) (aref cells last))
        (let ((both (and (= columns rows) (eq diagonal* :both))))
          (when (or both (> columns rows)) (setf held (logior held x-side)))
          (when (or both (< columns rows)) (setf held (logior held y-side))))))))

(defun quadrants-held (cells)
  "Return how many quadrants around the prey hold a predator. The diagonals bound them."
  (check-cells 'quadrants-held cells)
  (%quadrants-held cells))

(defun add-payoffs (table at share weight cells after)
  "Add SHARE of the payoff of each predator to TABLE, from the index AT on. A quadrant adds WEIGHT."
  (declare (type cells cells after) (type reals table) (type (integer 0 93750) at)
           (type double-float share weight) (optimize speed))
  (let* ((last (1- (length cells)))
         (held (* weight (the (integer 0 4) (%quadrants-held after)))))
    (dotimes (i last)
      (incf (aref table (+ at i))
            (* share (+ held (- (%distance-to (aref cells i) (aref cells last))
                                (%distance-to (aref after i) (aref after last)))))))))

(defun payoffs (cells)
  "Return the expected payoffs of the predators for all their joint moves. That of predator I is at
the index I + COUNT x J, where J has the moves as digits to the base of 5."
  (declare (type cells cells))
  (let* ((count (1- (length cells))) (first-move (if prey-stays* 0 1))
         (share (/ 1d0 (- 5 first-move))) (weight (coerce quadrant-weight* 'double-float))
         (joint-moves (reduce #'* (make-list count :initial-element 5)))
         (table (make-array (* count joint-moves) :element-type 'double-float
                                                  :initial-element 0d0))
         (goals (copy-seq cells)) (after (copy-seq cells)))
    (dotimes (joint joint-moves table)
      (loop for i below count
            for moves = joint then (floor moves 5)
            do (setf (aref goals i) (%next-cell (aref cells i) (mod moves 5))))
      (loop for move from first-move to 4
            do (setf (aref goals count) (%next-cell (aref cells count) move))
               (move-all cells goals after)
               (add-payoffs table (* count joint) share weight cells after)))))

(defun expected-payoffs (table i mixes)
  "Return what each move of predator I brings if the others play MIXES, a vector."
  (declare (type reals table) (type (integer 0 5) i) (type simple-vector mixes) (optimize speed))
  (let ((count (length mixes)) (sums (make-array 5 :element-type 'double-float)))
    (declare (type (integer 1 6) count))
    (labels ((weigh (who joint weight move)
               (declare (type (integer -1 5) who) (type (integer 0 15624) joint)
                        (type (integer 0 4) move) (type double-float weight))
               (cond ((zerop weight))
                     ((minusp who)
                      (incf (aref sums move) (* weight (aref table (+ i (* count joint)))))
                      nil)
                     (t (dotimes (its-move 5)
                          (let ((joint (+ its-move (* 5 joint))))
                            (declare (type (integer 0 15624) joint))
                            (if (= who i)
                                (weigh (1- who) joint weight its-move)
                                (weigh (1- who) joint
                                     (* weight (aref (the reals (svref mixes who)) its-move))
                                     move))))))))
      (weigh (1- count) 0 1d0 0))
    sums))

(defun best-mix (payoffs)
  "Return the mix of the moves with the largest of PAYOFFS, five numbers, by TIES*."
  (let* ((best (- (reduce #'max payoffs) 1d-9))
         (moves (loop for payoff in (coerce payoffs 'list)
                      for move from 0
                      when (< best payoff) collect move)))
    (uniform-mix (if (eq ties* :first) (list (first moves)) moves))))

(defun uniform-mix (moves)
  "Return the mix in which MOVES, numbers from 0 to 4, are equally likely."
  (let ((mix (make-array 5 :element-type 'double-float :initial-element 0d0)))
    (dolist (move moves mix)
      (setf (aref mix move) (/ 1d0 (length moves))))))

(defun all-mixes (cells level)
  (let ((table (payoffs cells))
        (mixes (map 'vector (constantly (uniform-mix '(0 1 2 3 4))) (rest (coerce cells 'list)))))
    (loop repeat level
          do (setf mixes (coerce (loop for i below (length mixes)
                                       collect (best-mix (expected-payoffs table i mixes)))
                                 'simple-vector)))
    mixes))

(defun modelled-moves (cells level)
  "Return a vector of the mixes that the predators choose at LEVEL, by number."
  (check-cells 'modelled-moves cells)
  (unless (typep level '(integer 0 100))
    (reject-argument 'modelled-moves 'level level "a level from 0 to 100"))
  (let ((key (list cells level prey-stays* metric* diagonal* quadrant-weight* ties*))
        (last *last-mixes*))
    (if (equalp key (first last))
        (rest last)
        (rest (setf *last-mixes* (cons key (all-mixes cells level)))))))

(defun random-move (robot) (draw-move robot '(1/5 1/5 1/5 1/5 1/5)))

(defun greedy-move (robot)
  (let ((cell (robot-cell robot)) (target (robot-cell prey)))
    (draw-move robot (best-mix (loop for move from 0 to 4
                                     collect (- (distance-to (next-cell cell move) target)))))))

(defun level-move (robot level)
  (draw-move robot (svref (modelled-moves (current-cells) level) (position robot (predators)))))

(defun level-1-move (robot) (level-move robot 1))
(defun level-2-move (robot) (level-move robot 2))
(defun level-3-move (robot) (level-move robot 3))
(defun level-4-move (robot) (level-move robot 4))

(defun still () (hunt (constantly 0)))
(defun random-walk () (hunt #'random-move))
(defun greedy () (hunt #'greedy-move))
(defun level-1 () (hunt #'level-1-move))
(defun level-2 () (hunt #'level-2-move))
(defun level-3 () (hunt #'level-3-move))
(defun level-4 () (hunt #'level-4-move))

;;; Looking ahead: every four rounds, forks play on with each level, and the quickest is kept up.

(define-run-variable *style* 'level-2-move "What the predators of LOOK-AHEAD play now.")

(defun style-move (robot) (funcall *style* robot))

(defun distance-left ()
  (loop for predator in (predators)
        sum (distance-to (robot-cell predator) (robot-cell prey))))

(defun time-ahead (style)
  "Return how many rounds STYLE takes in two forks, and how far the predators then are."
  (loop for number from 1 to 2
        sum (with-fork (:seed (+ number (* 10 (simulation-tick))) :continuations t)
              (let ((start (rounds-played)))
                (setf *style* style)
                (play-rounds 10)
                (+ (- (rounds-played) start) (if (captured-p) 0 (distance-left)))))))

(defun look-ahead ()
  "Play to the end of the game. Forks are made between ticks, so the agent passes them itself."
  (hunt #'style-move)
  (loop until (game-over-p)
        do (setf *style* (loop with best and least
                               for style in '(level-1-move level-2-move level-4-move)
                               for time = (time-ahead style)
                               do (when (or (null best) (< time least))
                                    (setf best style least time))
                               finally (return best)))
           (play-rounds 4)))
