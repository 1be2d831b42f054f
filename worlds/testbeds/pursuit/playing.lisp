;;;; playing.lisp -- rounds, measures and claims of pursuit.

(in-package :ars-pursuit)
(in-readtable :nisp)

;;; Playing. A round takes two ticks, to turn and to drive, for each robot that has its turn. What
;;; is drawn depends on the seed, the tick and the robot only. So all agents meet the same prey
;;; until they touch it.

(defun dice-of (robot)
  (make-dice (+ (* 100003 (world-seed *world*)) (simulation-tick)) (robot-name robot)))

(defun mix-p (thing)
  (and (typep thing '(or vector list))
       (= 5 (length thing))
       (every (lambda (share) (typep share '(real 0 1))) thing)
       (some #'plusp thing)))

(defun draw-move (robot mix)
  "Return a move for ROBOT, from 0 to 4, drawn from MIX, five probabilities."
  (unless (robot-p robot)
    (reject-argument 'draw-move 'robot robot "a robot, such as PREY"))
  (unless (mix-p mix)
    (reject-argument 'draw-move 'mix mix "a sequence of five probabilities, of moves 0 to 4"))
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
  (unless (or (functionp choose) (and choose (symbolp choose) (fboundp choose)))
    (reject-argument 'hunt 'choose choose "a function of a robot that returns a move, from 0 to 4"))
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
