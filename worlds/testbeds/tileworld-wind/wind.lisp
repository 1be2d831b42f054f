;;;; wind.lisp -- NASA Tileworld: a robot carries tiles to their places, wind moves them.

;;; A tile is a polyomino of several things that move as one: a gust of wind moves all tiles that
;;; the robot does not hold the same way, a homogeneous event (manual 1.2). A step takes 2 ticks.

(in-package :ars-testbeds.wind)
(in-readtable :nisp)

(define-knob game-steps* 400 "steps" (integer 1 1000000) "How long a game lasts.")
(define-knob gust-interval* 20 "steps" (integer 1 100000)
  "How much time passes between two gusts of wind, in the mean.")
(define-knob gust-strength* 2 "cells" (integer 0 15) "How far a gust moves a tile at most.")
(define-knob tile-count* 4 "tiles" (integer 1 8) "How many tiles there are.")
(define-knob tile-cells* 3 "cells" (integer 1 6) "How many cells a tile has.")

;;; The world. A tile is a list (id target offsets cell...): TARGET is the place (x y) for its first
;;; cell, which the hand grasps; the cells are things, OFFSETS lists (dx dy), one for each.

(define-run-variable *tiles* '() "The tiles.")
(define-run-variable *readings* 0 "How many ticks the tiles have been watched.")
(define-run-variable *in-place* 0 "The sum, over these ticks, of how many tiles are in place.")
(define-run-variable *blown* 0 "By how many cells the wind has moved tiles.")
(define-run-variable *gusts* '() "The ticks of all gusts so far, since the tiles were laid out.")
(define-run-variable *laid-out* 0 "The tick in which the tiles were laid out.")
(define-run-variable *ways* '()
  "Lists (steps steps), one for each tile at the start: from the robot to it, and to its place.")

(defmap windy-floor (19 17)
  (rect (0 0) (16 16) bricks 10)
  (rect (16 0) (18 2) bricks 10)
  (obj clock (17.5 1.5) ((:size 1))))

(defrobot carrier (windy-floor (8.5 8.5) 0) :cameras ((6.28 1000)) :hands (100))

(defun tiles () "Return a new list of the tiles." (copy-list *tiles*))

(defun check-tile (operator tile)
  "Signal WRONG-ARGUMENT, about the function OPERATOR, unless TILE is a tile."
  (unless (typep tile '(cons integer (cons cons (cons cons cons))))
    (reject-argument operator 'tile tile
                     "a tile, as TILES returns them; (held-tile) is NIL if the hand is empty")))

(defun tile-thing (tile)
  "Return the first cell of TILE, a thing, which can be grasped."
  (check-tile 'tile-thing tile)
  (fourth tile))

(defun tile-target (tile)
  "Return the place of TILE, the cell (x y) of its first cell."
  (check-tile 'tile-target tile)
  (second tile))

(defun find-tile (id) "Return the tile with the number ID." (assoc id *tiles*))
(defun game-over-p () "True if the game has ended." (<= (* 2 game-steps*) (simulation-tick)))

(defun held-tile ()
  "Return the tile that the robot holds, or NIL."
  (find-if #'held-p *tiles*))

(defun held-p (tile) (eq (tile-thing tile) (hand-holding (robot-hand carrier 0))))

(defun robot-cell () (list (floor (robot-x carrier)) (floor (robot-y carrier))))

(defun anchor (tile)
  "Return the cell (x y) of the first cell of TILE; if it is held, that of the robot."
  (let ((thing (tile-thing tile)))
    (if (held-p tile)
        (robot-cell)
        (list (floor (thing-x thing)) (floor (thing-y thing))))))

(defun tile-in-place-p (tile)
  "True if TILE lies in its place."
  (check-tile 'tile-in-place-p tile)
  (and (not (held-p tile)) (equal (anchor tile) (tile-target tile))))

(defun steps-between (place other)
  (+ (abs (- (first place) (first other))) (abs (- (second place) (second other)))))

(defun cells-at (place offsets)
  (mapcar (lambda (offset) (mapcar #'+ place offset)) offsets))

(defun on-floor-p (cells)
  (every (lambda (cell) (and (<= 1 (first cell) 15) (<= 1 (second cell) 15))) cells))

;; The things of a tile lie in the middle of their cells, where the first one is. If the hand holds
;; it near a wall, things that would be behind the wall stay where they are.
(defkicker hold-together (clock) (:prob 1)
  (incf *readings*)
  (dolist (tile *tiles*)
    (when (tile-in-place-p tile) (incf *in-place*))
    (loop for (x y) in (cells-at (anchor tile) (third tile))
          for thing in (cdddr tile)
          unless (or (eq thing (hand-holding (robot-hand carrier 0)))
                     (not (on-floor-p (list (list x y))))
                     (and (= (thing-x thing) (+ x .5)) (= (thing-y thing) (+ y .5))))
            do (move-thing thing (+ x .5) (+ y .5)))))

(defun freely-moving (tiles step)
  "Return those of TILES that can move by STEP, (dx dy), all at once."
  (let ((stuck (find-if (lambda (tile)
                          (let ((cells (cells-at (mapcar #'+ (anchor tile) step) (third tile))))
                            (not (and (on-floor-p cells)
                                      (notany (lambda (other) (overlap-p cells other))
                                              (set-difference *tiles* tiles :key #'first))))))
                        tiles)))
    (if stuck
        (freely-moving (remove (first stuck) tiles :key #'first) step)
        tiles)))

(defun overlap-p (cells tile)
  (and (not (held-p tile))
       (intersection cells (cells-at (anchor tile) (third tile)) :test #'equal)))

(defun blow (step)
  "Move all loose tiles that can by STEP, (dx dy)."
  (dolist (tile (freely-moving (remove-if #'held-p *tiles*) step))
    (incf *blown*)
    (destructuring-bind (x y) (mapcar #'+ (anchor tile) step)
      (move-thing (tile-thing tile) (+ x .5) (+ y .5)))))

(defun roll-below (count) (roll-index count (world-dice *world* :user)))

(defkicker gust (clock) (:prob 0)
  (run-kicker self (+ gust-interval* (roll-below (1+ (* 2 gust-interval*)))))
  (push (- (simulation-tick) *laid-out*) *gusts*)
  (let ((side (roll-below 4)))
    (set-attribute clock :label (format nil "~A, ~A" (nth side '("west" "east" "north" "south"))
                                        (simulation-tick)))
    (loop repeat gust-strength* do (blow (nth side '((1 0) (-1 0) (0 1) (0 -1)))))))

;;; Setting up.

(defun roll-offsets ()
  "Return the offsets of a random polyomino. The first is (0 0)."
  (loop with offsets = (list (list 0 0))
        while (< (length offsets) tile-cells*)
        do (let ((new (mapcar #'+ (nth (roll-below (length offsets)) offsets)
                              (nth (roll-below 4) '((1 0) (-1 0) (0 1) (0 -1))))))
             (unless (member new offsets :test #'equal)
               (setf offsets (append offsets (list new)))))
        finally (return offsets)))

(defun roll-place (offsets taken)
  "Return a place (x y) where a tile with OFFSETS lies on no cell of TAKEN."
  (loop for place = (list (1+ (roll-below 15)) (1+ (roll-below 15)))
        for cells = (cells-at place offsets)
        when (and (on-floor-p cells) (not (intersection cells taken :test #'equal)))
          return place))

(defkicker lay-out (clock) (:prob 0)
  (let ((cells '()) (targets '()))
    (dotimes (id tile-count*)
      (let* ((offsets (roll-offsets))
             (target (roll-place offsets targets))
             (here (cells-at (roll-place offsets cells) offsets)))
        (setf cells (append here cells) targets (append (cells-at target offsets) targets))
        (make-new-thing 'place (list *world* (+ .5 (first target)) (+ .5 (second target)))
                        `((:size 20) (:color lightgreen) (:label ,(format nil "to ~D" id))))
        (push (list* id target offsets
                     (loop for (x y) in here
                           for first = t then nil
                           collect (make-new-thing
                                    'tile (list* *world* (list (+ x .5) (+ y .5)))
                                    `((:size 12) (:weight 1) (:tile ,id) (:color blue)
                                      (:label ,(if first id ""))
                                      ,@(if first '((:handle t)))))))
              *tiles*)))
    (setf *laid-out* (simulation-tick)
          *ways* (loop for tile in *tiles*
                       collect (list (steps-between (robot-cell) (anchor tile))
                                     (steps-between (anchor tile) (tile-target tile)))))))

(defmeasure in-place
  "The share of the tiles that were in their places, the mean over the game, from 0 to 1."
  (/ *in-place* (max 1 *readings*) tile-count*))

(defun steps-needed (count help)
  "Return how many steps bring COUNT tiles to their places if the wind helps by HELP cells a tile:
the way to the nearest tile, and the shortest ways of tiles to their places, one after the other."
  (let* ((ways (sort (mapcar #'second *ways*) #'<))
         (left (remove-if-not #'plusp (mapcar (lambda (way) (- way help)) (subseq ways 0 count)))))
    (if left
        (reduce #'+ left :initial-value (max 0 (- (reduce #'min *ways* :key #'first) help)))
        0)))

(defun earliest-tick (count)
  "Return the tick in which COUNT tiles may be in their places at the earliest."
  (loop for tick from 0
        for help = (* gust-strength* (count-if (lambda (gust) (<= gust tick)) *gusts*))
        when (<= (* 2 (steps-needed count help)) tick) return tick))

(defmeasure bound
  "The share if all gusts help to bring tiles to their places, and none moves a tile from there. No
agent that moves by steps has more."
  (/ (loop for count from 1 to tile-count*
           sum (max 0 (min *readings* (- *readings* (earliest-tick count) -1))))
     (max 1 *readings*) tile-count*))

(defmeasure blown "By how many cells the wind moved tiles." *blown*)

(defun play (agent)
  "Play a game with AGENT, the name of a plan or function. Return true when the game is over.
Signals MISUSE unless the run is at tick 0."
  (check-new-game)
  (robot-set-speed carrier max-speed*)
  (robot-set-turn-angle carrier max-turn-angle*)
  (run-ticks 1)
  (dolist (kicker '(lay-out hold-together gust))
    (run-kicker (set-kicker (find-thing 'clock) kicker)))
  (run-ticks 1)
  (start-agent agent)
  (run-ticks (max 0 (- (* 2 game-steps*) (simulation-tick))))
  t)

(define-testbed tileworld-wind
  "A robot carries tiles of several cells to their places, and gusts of wind move all that it does
not hold. How far must it watch the tiles?"
  (:rules "The floor has 15 x 15 cells. The robot starts in the middle and steps north, south, east
or west; it can cross tiles."
          "There are tile-count* tiles, random polyominoes of tile-cells* cells that move as one.
Each has a place of its own. The hand grasps a tile by its first cell, where the robot stands, and
carries it over others. It puts a tile down only where all of it fits on the floor."
          "The wind blows at random times, from half to one and a half times gust-interval*, from
one of four sides. It moves all tiles that are not held by up to gust-strength* cells, until a wall
or a tile that cannot move stops them."
          "The score is the mean share of the tiles that lie in their places. All agents meet the
same tiles, places and gusts.")
  (:sources "Philips, Swanson, Drummond and Bresina, A design rationale for NASA TileWorld,
NASA Ames 1991.")
  (:knobs game-steps* gust-interval* gust-strength* tile-count* tile-cells*)
  (:agents (idle "Does nothing.")
           (random-walk "Steps in random directions; grasps and puts down tiles at random.")
           (blind "Naive: goes to where the tile was when it decided, then decides again.")
           (watchful "Follows its tile.")
           (flexible "Takes, after each step, the tile that is the least effort now.")
           (blind-camera "Blind, and sees tiles by its camera when it decides.")
           (flexible-camera "Sees tiles by its camera, and decides again after 4 steps.")
           (look-ahead "Tries each tile in forks of the run in which no wind blows.")
           (clairvoyant "As look-ahead, but in its forks the wind blows as it will."))
  (:robots carrier)
  (:clean)
  (:thinking :charged)
  (:limit 10000000)
  (:parameters (max-speed* 2) (max-turn-angle* 4) (step-by-grid* t) (step-duration* 2)
               (scan-density* 1000))
  (:run (play agent))
  (:score in-place)
  (:measure blown bound)
  (:seeds :tuning 1000000 :testing 0)
  (:sweeps ((gust-interval* 5 10 20 40 80) (gust-strength* 2))
           ((gust-strength* 0 1 2 4 8) (gust-interval* 20)))
  (:claims
   ("The more often the wind blows, the less the robot achieves."
    (((gust-strength* 1)) ((gust-strength* 2)))
    (:better (watchful (gust-interval* 40)) (watchful (gust-interval* 10)) 0)
    (:better (blind (gust-interval* 40)) (blind (gust-interval* 10)) 0))
   ("The stronger the wind, the less the robot achieves."
    (((gust-interval* 10)) ((gust-interval* 20)))
    (:better (watchful (gust-strength* 1)) (watchful (gust-strength* 4)) 0)
    (:better (blind (gust-strength* 1)) (blind (gust-strength* 4)) 0))
   ("It helps to follow the tile."
    (((gust-strength* 2)) ((gust-strength* 4)))
    (:better watchful blind 0))
   ("The more often the wind blows, the more it helps."
    (((gust-strength* 2)) ((gust-strength* 4)))
    (:narrows watchful blind (gust-interval* 5 40)))))
