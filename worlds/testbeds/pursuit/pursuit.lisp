;;;; pursuit.lisp -- predators surround a prey (Vidal and Durfee 1995).

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

(declaim (inline next-cell offsets distance-to))
(defun next-cell (cell move)
  "Return the cell that MOVE, from 0 to 4, leads to from CELL, which is CELL itself at a wall."
  (declare (type cell cell) (type (integer 0 4) move))
  (multiple-value-bind (row column) (floor cell 20)
    (ecase move
      (0 cell)
      (1 (if (< column 19) (1+ cell) cell))
      (2 (if (< row 19) (+ cell 20) cell))
      (3 (if (plusp column) (1- cell) cell))
      (4 (if (plusp row) (- cell 20) cell)))))

(defun offsets (from to)
  "Return how many columns and rows the cells FROM and TO are apart, and on which sides FROM is."
  (declare (type cell from to))
  (multiple-value-bind (row column) (floor from 20)
    (multiple-value-bind (to-row to-column) (floor to 20)
      (let ((columns (- column to-column)) (rows (- row to-row)))
        (values (abs columns) (abs rows) (if (plusp columns) 1 2) (if (plusp rows) 4 8))))))

(defun distance-to (from to)
  "Return the distance of two cells by METRIC*, a double-float."
  (multiple-value-bind (dx dy) (offsets from to)
    (case metric*
      (:steps (float (+ dx dy) 1d0))
      (:king (float (max dx dy) 1d0))
      (t (sqrt (float (+ (* dx dx) (* dy dy)) 1d0))))))

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
  (move-all cells (map 'cells #'next-cell cells moves) (copy-seq cells)))

(defun captured-p (&optional (cells (current-cells)))
  "True if the prey cannot move: a predator or wall is on each side of it."
  (let* ((last (1- (length cells))) (target (aref cells last)))
    (loop for move from 1 to 4
          for beside = (next-cell target move)
          always (or (= beside target) (find beside cells :end last)))))

;;; Playing. A round takes two ticks, to turn and to drive, for each robot that has its turn. What
;;; is drawn depends on the seed, the tick and the robot only. So all agents meet the same prey
;;; until they touch it.

(defun dice-of (robot)
  (make-dice (+ (* 100003 (world-seed *world*)) (simulation-tick)) (robot-name robot)))

(defun draw-move (robot mix)
  "Return a move for ROBOT, from 0 to 4, drawn from MIX, five probabilities."
  (let ((draw (roll (dice-of robot))))
    (or (position-if (lambda (share) (minusp (decf draw share))) mix)
        (position-if #'plusp mix :from-end t))))

(defun ticks-off ()
  "Return how many ticks of a round a robot waits while others have their turns."
  (if (eq order* :turns) (* 2 predators*) 0))

(defun rewound-p (err) (eq err :interrupt))

(defun rest-ticks (robot ticks then)
  (if (zerop ticks)
      (funcall then)
      (think robot ticks (continuation (err robot) (unless (rewound-p err) (funcall then))))))

(defun contested-p (goal) (and (eq contested* :none) (< 1 (count goal (rest *goals*)))))

(defun move-robot (robot move then)
  "Let ROBOT make MOVE, from 0 to 4; call THEN at the end of the round."
  (let* ((cell (robot-cell robot)) (goal (next-cell cell move))
         (turn (- (nth move '(0 0 1 2 3)) (round (robot-angle robot) (/ pi 2)))))
    (setf *goals* (list* (simulation-tick) goal
                         (and (eql (first *goals*) (simulation-tick)) (rest *goals*))))
    (flet ((drive (robot)
             (if (or (= cell goal) (contested-p goal))
                 (rest-ticks robot 1 then)
                 (robot-step robot (nth move '(nil :east :south :west :north))
                             (continuation (err robot)
                               (unless (rewound-p err)
                                 (when err (move-back robot))
                                 (funcall then)))))))
      (if (or (= cell goal) (zerop (mod turn 4)))
          (rest-ticks robot 1 (lambda () (drive robot)))
          (robot-turn robot (* (/ pi 2) (- (mod (+ turn 1) 4) 1))
                      (continuation (err robot angle) (unless (rewound-p err) (drive robot))))))))

(defun move-back (robot)
  "Put ROBOT, which another one has barred, back into the middle of its cell."
  (place-robot robot (+ .5 (floor (robot-x robot))) (+ .5 (floor (robot-y robot)))
               (robot-angle robot)))

(defun keep-moving (robot choose)
  (move-robot robot (funcall choose robot)
              (lambda ()
                (rest-ticks robot (ticks-off) (lambda () (keep-moving robot choose))))))

(defun start-moving (robot choose)
  "Let ROBOT make, round by round, the move that the function CHOOSE returns for it."
  (rest-ticks robot (if (eq order* :turns) (* 2 (position robot (players))) 0)
              (lambda () (keep-moving robot choose))))

(defun hunt (choose)
  "Let each predator make, round by round, the move that the function CHOOSE returns for it."
  (dolist (predator (predators)) (start-moving predator choose)))

(defun rounds-played () (ceiling (- (simulation-tick) *start*) (+ 2 (ticks-off))))

(defun game-over-p ()
  "True if the prey is captured or has escaped."
  (or (captured-p) (<= time-limit* (rounds-played))))

(defun play-rounds (rounds)
  (loop repeat (* rounds (1+ (floor (ticks-off) 2)))
        until (game-over-p)
        do (run-ticks 2)))

(defmeasure capture-time "How many rounds until capture or escape." (rounds-played))

(defmeasure captured "Whether the prey was captured." (and (plusp *start*) (captured-p)))

(defmeasure least-time "A lower bound on the time to capture, by the distances at the start."
  *least-time*)

(defun least-time-from (cells)
  "Return after how many rounds enough predators may be beside the prey: four, or fewer at a wall,
which it may reach in 9 moves, or in a corner, in 18."
  (let* ((last (1- (length cells))) (target (aref cells last)))
    (flet ((steps (cell) (multiple-value-bind (dx dy) (offsets cell target) (+ dx dy))))
      (loop for time from 0 below time-limit*
            until (<= (cond ((< time 9) 4) ((< time 18) 3) (t 2))
                      (loop for i below last
                            count (<= (steps (aref cells i)) (+ 1 (* 2 time)))))
            finally (return time)))))

(defun place-at (robot cell)
  (multiple-value-bind (row column) (floor cell 20)
    (place-robot robot (+ 1.5 column) (+ 1.5 row) 0)
    (robot-set-speed robot 1)
    (robot-set-turn-angle robot 4)
    cell))

(defun place-players ()
  "Put the prey into the middle of the field, and the predators into other random cells."
  (let ((taken (list (place-at prey 210))))
    (dolist (predator (predators))
      (let ((dice (dice-of predator)))
        (push (place-at predator (loop for cell = (roll-index 400 dice)
                                       unless (member cell taken) return cell))
              taken)))))

(defun prey-move (robot)
  (draw-move robot (if prey-stays* '(1/5 1/5 1/5 1/5 1/5) '(0 1/4 1/4 1/4 1/4))))

(defun play-pursuit (agent)
  "Play a game with AGENT, the name of a plan or function. Return true when the game is over."
  (place-players)
  (run-ticks 2)
  (setf *start* (simulation-tick) *least-time* (least-time-from (current-cells)))
  (start-moving prey #'prey-move)
  (start-agent agent)
  (play-rounds time-limit*)
  t)

;;; The testbed.

(define-testbed pursuit
  "Predators surround a prey that moves at random. How far should each model what the others do?"
  (:rules "The floor has 20 x 20 cells with walls around it. The prey starts in the middle, the
predators in random cells."
          "In a round each robot steps to a neighbouring cell or stays. The prey steps at random in
one of four directions, and stays if that is barred."
          "Robots have bodies. They follow one another, but do not change places. By default nobody
enters a cell that several want."
          "The game ends when the prey cannot move: predators or walls are on its four sides. After
time-limit* rounds the prey escapes."
          "A predator's payoff for a joint move is by how much it comes nearer to the prey, and
quadrant-weight* for each of the four quadrants around the prey that holds a predator.")
  (:sources "Vidal and Durfee, Recursive agent modeling using limited rationality, ICMAS-95."
            "Vidal and Durfee, Using recursive agent models effectively, Intelligent Agents II,
1996.")
  (:knobs predators* order* contested* prey-stays* metric* diagonal* quadrant-weight* ties*
          time-limit*)
  (:agents (still "Stands. The prey escapes.")
           (random-walk "Moves at random.")
           (greedy "Minimizes each predator's distance to the prey, whatever the others do.")
           (level-1 "Maximizes the expected payoff if the others move at random.")
           (level-2 "Maximizes the expected payoff if the others choose by level-1.")
           (level-3 "Maximizes the expected payoff if the others choose by level-2.")
           (level-4 "Maximizes the expected payoff if the others choose by level-3.")
           (look-ahead "Tries levels 1, 2 and 4 in forks of the run, and plays the quickest."))
  (:robots prey predator-1 predator-2 predator-3 predator-4 predator-5 predator-6)
  (:clean)
  (:thinking :charged)
  (:limit 1000000)
  (:parameters (max-speed* 1) (max-turn-angle* 4) (robot-turn-delay* 0) (step-duration* 1)
               (step-by-grid* t))
  (:run (let ((*last-mixes* '(nil))) (play-pursuit agent)))
  (:score capture-time :less)
  (:measure captured least-time)
  (:seeds :tuning 1000000 :testing 0)
  (:sweeps ((predators* 4 5)))
  (:claims
   ("Level 1 never captures the prey." (()) (:measure captured) (:within level-1 still 0))
   ("Greedy predators take longer than level 2."
    (() ((ties* :first) (prey-stays* t) (metric* :straight)))
    (:better level-2 greedy 1))
   ("Level 2 takes longer than level 4."
    (() ((ties* :first) (prey-stays* t) (metric* :straight)))
    (:better level-4 level-2 1))))
