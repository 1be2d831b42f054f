;;;; tiles.lisp -- Tileworld: tiles to push into holes (Pollack and Ringuette 1990).

;;; Tiles, holes and obstacles appear and disappear on a floor of 15 x 15 cells. A hole has several
;;; cells; each is filled by a tile. The agent steps and pushes by ROBOT-PUSH; a step takes 2 ticks.

(in-package :ars-testbeds.tiles)
(in-readtable :nisp)

(define-knob steps* 500 "steps" (integer 1 1000000) "How long a game lasts.")
(define-knob hole-interval* 20 "steps" (integer 1 100000)
  "How much time passes between two holes, in the mean (dynamism).")
(define-knob hole-life* 100 "steps" (integer 1 100000) "How long a hole stays, in the mean.")
(define-knob hole-cells* 3 "cells" (integer 1 9)
  "How many cells a hole has at most (variability of difficulty).")
(define-knob score-spread* 1/2 "" (real 0 1)
  "How scores vary: from 100 times 1 less this to 100 times 1 plus this (variability of utility).")
(define-knob soft-bounds* nil "" boolean
  "True if the worth of a hole falls, from its score to 0 when it closes; else it stays.")
(define-knob tile-interval* 10 "steps" (integer 1 100000)
  "How much time passes between two tiles, in the mean.")
(define-knob tile-life* 200 "steps" (integer 1 100000) "How long a tile stays, in the mean.")
(define-knob obstacle-interval* 40 "steps" (integer 1 100000)
  "How much time passes between two obstacles, in the mean (hostility).")
(define-knob obstacle-life* 200 "steps" (integer 1 100000)
  "How long an obstacle stays, in the mean.")
(define-knob deliberation-time* 1/2 "steps" (real 0 100)
  "How long the agent thinks about each hole that it considers. It pays by THINK.")

;;; The world. A hole is a list (id score begin end cell...), whose cells are things.

(define-run-variable *holes* '() "The open holes, the newest first.")
(define-run-variable *tiles* '() "The tiles, things, the newest first.")
(define-run-variable *obstacles* '() "The cells of obstacles, things.")
(define-run-variable *offered* '() "Lists (score cells) of all holes so far.")
(define-run-variable *supply* 0 "How many tiles have appeared.")
(define-run-variable *score* 0 "The sum of what the filled holes were worth.")
(define-run-variable *filled* 0 "How many holes were filled.")

(defun holes () "Return a new list of the open holes, the newest first." (copy-list *holes*))
(defun obstacles () "Return a new list of the cells of obstacles, things." (copy-list *obstacles*))
(defun tiles () "Return a new list of the tiles, things, the newest first." (copy-list *tiles*))

(defun check-hole (operator hole)
  "Signal WRONG-ARGUMENT, about the function OPERATOR, unless HOLE is a hole, open or not."
  (unless (typep hole '(cons integer (cons real (cons integer (cons integer list)))))
    (reject-argument operator 'hole hole
                     "a hole, as HOLES returns them; (find-hole id) is NIL once it is closed")))

(defun hole-id (hole)
  "Return the number of HOLE; a newer hole has a larger one."
  (check-hole 'hole-id hole)
  (first hole))

(defun hole-cells (hole)
  "Return a new list of the cells of HOLE to fill, things."
  (check-hole 'hole-cells hole)
  (copy-list (cddddr hole)))

(defun find-hole (id) "Return the open hole ID, or NIL." (assoc id *holes*))
(defun game-over-p () "True if the game has ended." (<= (* 2 steps*) (simulation-tick)))

(defun hole-worth (hole)
  "Return what HOLE scores if it is filled now."
  (check-hole 'hole-worth hole)
  (destructuring-bind (score begin end &rest cells) (rest hole)
    (declare (ignore cells))
    (if soft-bounds*
        (* score (/ (- end (simulation-tick)) (- end begin)))
        score)))

;; The clock stands in a cell of its own.
(defmap tile-floor (19 17)
  (rect (0 0) (16 16) bricks 10)
  (rect (16 0) (18 2) bricks 10)
  (obj clock (17.5 1.5) ((:size 1) (:hole 0) (:score 0))))

(defrobot pusher (tile-floor (8.5 8.5) 0) :cameras ((6.28 1000)))

(defun new-dice ()
  "Return dice for something that appears. All agents meet the same, at the same times."
  (make-dice (roll-index 1000000000 (world-dice *world* :user)) "appear"))

(defun roll-ticks (steps dice)
  "Return ticks, from half to one and a half times STEPS."
  (+ steps (roll-index (1+ (* 2 steps)) dice)))

(defun free-cell-p (cell)
  (destructuring-bind (x y) cell
    (and (<= 1 x 15) (<= 1 y 15)
         (not (and (= x (floor (robot-x pusher))) (= y (floor (robot-y pusher)))))
         (null (things-at *world* x y)))))

(defun roll-cells (count dice)
  "Return COUNT free cells (x y) that are connected, or NIL if chance finds none."
  (loop repeat 50
        for cells = (list (list (1+ (roll-index 15 dice)) (1+ (roll-index 15 dice))))
        do (loop while (< (length cells) count)
                 do (destructuring-bind (x y) (roll-element cells dice)
                      (destructuring-bind (dx dy) (roll-element '((1 0) (-1 0) (0 1) (0 -1)) dice)
                        (pushnew (list (+ x dx) (+ y dy)) cells :test #'equal))))
        when (every #'free-cell-p cells) return cells))

(defkicker vanish (thing) (:prob 0)
  (setf *holes* (remove (get-attribute thing :hole) *holes* :key #'first)
        *tiles* (remove thing *tiles*)
        *obstacles* (remove thing *obstacles*))
  (destroy-thing thing))

(defun put-things (name cells life attributes &optional (label ""))
  (loop for (x y) in cells
        for thing = (make-new-thing name (list* *world* (list (+ x .5) (+ y .5)))
                                    `((:size 16) (:label ,(shiftf label "")) ,@attributes))
        do (run-kicker (set-kicker thing 'vanish) life)
        collect thing))

(defun open-hole (dice)
  (let* ((size (1+ (roll-index hole-cells* dice)))
         (score (round (* 100 (+ 1 (* score-spread* (- (/ (roll-index 1001 dice) 500) 1))))))
         (life (roll-ticks hole-life* dice))
         (cells (roll-cells size dice))
         (id (length (push (list score size) *offered*)))
         (now (simulation-tick)))
    (when cells
      (push (list* id score now (+ now life)
                   (put-things 'hole cells life
                               `((:hole ,id) (:score ,score) (:color lightviolet)) score))
            *holes*))))

(defun drop-tile (dice)
  (incf *supply*)
  (setf *tiles* (append (put-things 'tile (roll-cells 1 dice) (roll-ticks tile-life* dice)
                                    '((:obsmove t) (:weight 10) (:color blue)))
                        *tiles*)))

(defun raise-obstacle (dice)
  (setf *obstacles* (append (put-things 'obstacle (roll-cells (1+ (roll-index 3 dice)) dice)
                                        (roll-ticks obstacle-life* dice)
                                        '((:obsmove t) (:weight 1000000) (:color red)))
                            *obstacles*)))

(defkicker begin (clock) (:prob 0)
  (flet ((some-of (life interval make)
           (loop repeat (round life interval) do (funcall make (new-dice)))))
    (some-of obstacle-life* obstacle-interval* #'raise-obstacle)
    (some-of hole-life* hole-interval* #'open-hole)
    (some-of tile-life* tile-interval* #'drop-tile)))

(defkicker next-hole (clock) (:prob 0)
  (let ((dice (new-dice)))
    (run-kicker self (roll-ticks hole-interval* dice))
    (open-hole dice)))

(defkicker next-tile (clock) (:prob 0)
  (let ((dice (new-dice)))
    (run-kicker self (roll-ticks tile-interval* dice))
    (drop-tile dice)))

(defkicker next-obstacle (clock) (:prob 0)
  (let ((dice (new-dice)))
    (run-kicker self (roll-ticks obstacle-interval* dice))
    (raise-obstacle dice)))

(defun fill-cell (cell tile)
  "Let TILE fill CELL of a hole."
  (let* ((hole (find-hole (get-attribute cell :hole)))
         (rest (remove cell (hole-cells hole))))
    (cond (rest (set-attribute (first rest) :label (second hole)))
          (t (incf *score* (hole-worth hole))
             (incf *filled*)))
    (setf *holes* (if rest
                      (substitute (append (subseq hole 0 4) rest) (hole-id hole) *holes*
                                  :key #'hole-id)
                      (remove (hole-id hole) *holes* :key #'hole-id))
          *tiles* (remove tile *tiles*))
    (destroy-thing cell)
    (destroy-thing tile)))

(defkicker settle (clock) (:prob 1)
  (dolist (tile *tiles*)
    (let ((cell (find-if (lambda (thing) (get-attribute thing :hole))
                         (things-at *world* (thing-x tile) (thing-y tile)))))
      (when cell (fill-cell cell tile)))))

(defun score-of-all () (max 1 (reduce #'+ *offered* :key #'first)))

(defmeasure share
  "The score as a share of the scores of all holes, from 0 to 1."
  (/ *score* (score-of-all)))

(defmeasure filled "How many holes were filled." *filled*)

(defmeasure bound
  "The share that fills the best holes with all tiles that have appeared: no agent has more."
  (let ((tiles *supply*) (score 0))
    (loop for (worth size) in (sort (copy-list *offered*) #'>
                                    :key (lambda (hole) (/ (first hole) (second hole))))
          for used = (min size tiles)
          do (incf score (* worth (/ used size)))
             (decf tiles used))
    (/ score (score-of-all))))

;;; For agents.

(defun spend-steps (steps then)
  "Let the agent spend the time of so many STEPS without moving; then call the function THEN."
  (unless (typep steps '(real 0))
    (reject-argument 'spend-steps 'steps steps "how many steps, a number that is not negative"))
  (if (zerop steps)
      (funcall then)
      (think pusher (* 2 steps)
             (continuation (err robot) (unless (eq err :interrupt) (funcall then))))))

(defun push-to (direction then)
  "Let the agent step in DIRECTION and push what is there. Then call the function THEN with an error
code, or NIL."
  (robot-push pusher direction
              (continuation (err robot) (unless (eq err :interrupt) (funcall then err)))))

(defun play (agent)
  "Play a game with AGENT, the name of a plan or function. Return true when the game is over.
Signals MISUSE unless the run is at tick 0."
  (check-new-game)
  (robot-set-speed pusher max-speed*)
  (robot-set-turn-angle pusher max-turn-angle*)
  (run-ticks 1)
  (dolist (kicker '(settle begin next-hole next-tile next-obstacle))
    (run-kicker (set-kicker (find-thing 'clock) kicker)))
  (start-agent agent)
  (run-ticks (max 0 (- (* 2 steps*) (simulation-tick))))
  t)

(define-testbed tileworld-tiles
  "Tiles, holes and obstacles appear and disappear on a floor. An agent pushes tiles into holes, and
scores when all cells of a hole are filled. Which hole, and how long to think about it?"
  (:rules "The floor has 15 x 15 cells. The agent starts in the middle and steps north, south, east
or west. It pushes the tile before it, with the row of tiles behind that if they weigh at most
push-strength*; a tile weighs 10. Obstacles and walls stop it."
          "A tile that is pushed onto a cell of a hole fills it: both disappear. If all cells of a
hole are filled, the agent gets its score. The agent may walk over holes."
          "Holes, tiles and obstacles appear on free cells, connected and of random shape; times are
uniform from half to one and a half times the mean. A game begins with as many of each as there are
in the mean if nothing is filled."
          "An agent pays deliberation-time* for each hole that it considers. Planning pushes is
free."
          "The share is the score divided by the scores of all holes. All agents meet the same
holes, tiles and obstacles at the same times; those that find their cells occupied appear
elsewhere.")
  (:sources "Pollack and Ringuette, Introducing the Tileworld: experimentally evaluating agent
architectures, AAAI-90.")
  (:knobs steps* hole-interval* hole-life* hole-cells* score-spread* soft-bounds*
          tile-interval* tile-life* obstacle-interval* obstacle-life* deliberation-time*
          push-strength*)
  (:agents (random-walk "Steps and pushes in random directions.")
           (naive "Fills the nearest hole, and considers new holes only then.")
           (by-score "Fills the hole with the highest score; deliberates whenever a hole appears.")
           (by-utility "As by-score, by utility: the score for each step that the agent must go.")
           (filtered "By utility, but a new hole is considered only if it scores at least as much as
its own.")
           (bold "By utility, but a new hole is considered only if it scores 100 more.")
           (by-utility-camera "By utility, but sees by its camera, before each hole that it fills.")
           (look-ahead "By utility, but tries the three best holes in forks of the run."))
  (:robots pusher)
  (:clean)
  (:thinking :charged)
  (:limit 10000000)
  (:parameters (max-speed* 2) (max-turn-angle* 4) (step-by-grid* t) (step-duration* 2)
               (camera-desig-delay* 1) (scan-density* 1000))
  (:run (play agent))
  (:score share)
  (:measure filled bound)
  (:seeds :tuning 1000000 :testing 0)
  (:sweeps ((hole-interval* 10 20 40 80))
           ((deliberation-time* 0 1/2 2 4))
           ((tile-interval* 5 10 30)))
  (:claims
   ("The published utility beats the score alone, and going to the nearest hole."
    (((deliberation-time* 0)) ((tile-interval* 30)))
    (:better by-utility by-score .04) (:better by-utility naive .04))
   ("If deliberation takes long, it helps to filter new holes, and more to be bold."
    (((deliberation-time* 2)) ((deliberation-time* 2) (hole-interval* 10)))
    (:better filtered by-utility .01) (:better bold by-utility .02))
   ("If deliberation takes no time, filtering neither helps nor harms."
    (((deliberation-time* 0)))
    (:within filtered by-utility .03) (:within bold by-utility .03))
   ("The dearer deliberation is, the more boldness pays."
    (((hole-interval* 20)))
    (:narrows bold by-utility (deliberation-time* 4 1/2)))))
