;;;; holes.lisp -- Tileworld with holes only (Kinny and Georgeff 1991).

;;; A tick is a unit of the world's clock, or half of one if DYNAMISM* is 1, since a step must last
;;; two ticks to turn and drive. So no time is rounded.

(in-package :ars-testbeds)
(in-readtable :nisp)

(define-knob dynamism* 32 "world units" (integer 1 1000)
  "How many units of the world's clock pass while the agent takes a step (gamma).")
(define-knob planning-time* 1 "steps" (real 0 100)
  "How long the agent plans, in the time of a step (p). It pays by THINK.")
(define-knob holes* 600 "holes" (integer 1 100000) "How many holes open in a game.")
(define-knob directions* 4 "" (member 4 8) "In how many directions the agent steps.")

;;; The world.

(define-run-variable *holes* '() "The open holes, things, the newest first.")
(define-run-variable *taken* '() "Lists (x y end): cells of holes, filled or not, until END.")
(define-run-variable *opened* 0 "How many holes have opened.")
(define-run-variable *possible* 0 "The sum of the scores of the holes that have opened.")
(define-run-variable *score* 0 "The sum of the scores of the holes that were filled.")
(define-run-variable *filled* 0 "How many holes were filled.")

(defun ticks-per-unit () (ceiling 2 dynamism*))
(defun step-ticks-here () (* dynamism* (ticks-per-unit)))
(defun roll-up (low high) (+ low (roll-index (- high low -1) (world-dice *world* :user))))
(defun roll-time (low high) (* (ticks-per-unit) (roll-up low high)))

(defun cell-for-hole (tick end)
  "Return a random cell (x y) that no hole has at TICK, filled or not. It is taken until END."
  (loop with taken = (remove-if (lambda (cell) (<= (third cell) tick)) *taken*)
        for x = (roll-up 1 15)
        for y = (roll-up 1 15)
        unless (find-if (lambda (cell) (and (= x (first cell)) (= y (second cell)))) taken)
          do (setf *taken* (cons (list x y end) taken))
             (return (list x y))))

(defun close-hole (hole)
  (setf *holes* (remove hole *holes*))
  (destroy-thing hole))

(defkicker close-up (hole) (:prob 0) (close-hole hole))

(defun open-hole (tick)
  "Open a hole. What opens depends on the seed only, not on what the agent does."
  (let* ((life (roll-time 240 960)) (score (roll-up 1 10)) (end (+ tick life))
         (cell (cell-for-hole tick end))
         (hole (make-new-thing 'hole (cons *world* (mapcar (lambda (it) (+ it .5)) cell))
                               `((:size 16) (:color violet) (:label ,score) (:score ,score)
                                 (:begin ,tick) (:end ,end)))))
    (push hole *holes*)
    (incf *opened*)
    (incf *possible* score)
    (run-kicker (set-kicker hole 'close-up) life)))

(defkicker open-next (clock) (:prob 0)
  (open-hole (simulation-tick))
  (when (< *opened* holes*) (run-kicker self (roll-time 60 240))))

;; The clock stands in a cell of its own.
(defmap tileworld (19 17)
  (rect (0 0) (16 16) bricks 10)
  (rect (16 0) (18 2) bricks 10)
  (obj (clock :kickers (open-next)) (17.5 1.5) ((:size 1) (:score 0))))

(defrobot tiler (tileworld (8.5 8.5) 0) :cameras ((6.28 1000)))

(defmeasure effectiveness
  "The score as a share of the scores of all holes, from 0 to 1."
  (if (zerop *possible*) 0 (/ *score* *possible*)))

(defmeasure filled "How many holes were filled." *filled*)

;;; For agents: what they can see and do.
(defun open-holes () "Return a new list of the open holes, the newest first." (copy-list *holes*))
(defun check-hole (operator hole)
  "Signal WRONG-ARGUMENT, about the function OPERATOR, unless HOLE is a thing."
  (unless (thing-p hole)
    (reject-argument operator 'hole hole "a hole, as OPEN-HOLES returns them")))

(defun check-steps (operator steps)
  "Signal WRONG-ARGUMENT, about the function OPERATOR, unless STEPS is a time in steps."
  (unless (typep steps '(real 0))
    (reject-argument operator 'steps steps "how many steps, a number that is not negative")))

(defun hole-score (hole)
  "Return the score of HOLE, from 1 to 10."
  (check-hole 'hole-score hole)
  (get-attribute hole :score))

(defun game-over-p () "True if all holes have closed." (and (<= holes* *opened*) (null *holes*)))

(defun steps-between (x y to-x to-y)
  (let ((dx (abs (round (- to-x x)))) (dy (abs (round (- to-y y)))))
    (if (= 8 directions*) (max dx dy) (+ dx dy))))

(defun steps-to (hole)
  "Return how many steps the agent is from HOLE, which may have closed."
  (check-hole 'steps-to hole)
  (steps-between (robot-x tiler) (robot-y tiler) (thing-x hole) (thing-y hole)))

(defun fill-hole-here ()
  (let ((x (robot-x tiler)) (y (robot-y tiler)))
    (dolist (hole *holes*)
      (when (and (< (abs (- (thing-x hole) x)) .5) (< (abs (- (thing-y hole) y)) .5))
        (incf *score* (hole-score hole))
        (incf *filled*)
        (close-hole hole)))))

(defun direction-to (x y)
  "Return the direction of a step from the agent towards the point X, Y."
  (let ((dx (round (- x (robot-x tiler)))) (dy (round (- y (robot-y tiler)))))
    (flet ((toward (columns rows)
             (ecase (+ (* 3 (signum rows)) (signum columns))
               (-4 :north-west) (-3 :north) (-2 :north-east) (-1 :west)
               (1 :east) (2 :south-west) (3 :south) (4 :south-east))))
      (cond ((= 8 directions*) (toward dx dy))
            ((zerop dx) (toward 0 dy))
            (t (toward dx 0))))))

(defun go-on (err then)
  "A step or thought has ended with ERR. Fill a hole here and call THEN, unless the run was left."
  (unless (eq err :interrupt)
    (fill-hole-here)
    (funcall then)))

(defun take-a-step (direction then)
  "Let the agent step in DIRECTION. At the end it fills a hole in its cell; then call THEN."
  (robot-step tiler direction (continuation (err robot) (go-on err then))))

(defun step-towards (hole then)
  "Let the agent take a step towards HOLE, which may have closed; then call the function THEN."
  (check-hole 'step-towards hole)
  (take-a-step (direction-to (thing-x hole) (thing-y hole)) then))

(defun spend-steps (steps then)
  "Let the agent spend the time of so many STEPS without moving; then call the function THEN."
  (check-steps 'spend-steps steps)
  (think tiler (* steps (step-ticks-here)) (continuation (err robot) (go-on err then))))

(defun plan-move (then)
  "Let the agent plan, for PLANNING-TIME* steps; then call the function THEN."
  (if (zerop planning-time*) (funcall then) (spend-steps planning-time* then)))

(defun play-holes (agent)
  "Play a game with AGENT, the name of a plan or function. Return true when the game is over."
  (setf step-duration* (step-ticks-here))
  (robot-set-speed tiler max-speed*)
  (robot-set-turn-angle tiler max-turn-angle*)
  (run-ticks 1)
  (run-kicker (first (thing-kickers (find-thing 'clock))))
  (start-agent agent)
  (loop until (game-over-p) do (run-ticks 100))
  t)

;;; The testbed.

(define-testbed tileworld
  "Holes open and close on a floor, and an agent scores by reaching them in time. When should it
plan again? Tileworld without tiles, as Kinny and Georgeff simplified it."
  (:rules "The floor has 15 x 15 cells. The agent starts in the middle."
          "A hole has a score from 1 to 10. It opens 60 to 240 world units after the hole before,
in a cell without a hole, and closes after 240 to 960 units. All are uniform."
          "A step takes dynamism* units. At its end, or that of a thought or a wait, the agent
fills the hole in its cell and gets the score."
          "Agents choose the hole with the highest score for its distance, plan, and go there, first
along x. Without a hole they look again after the time of a step."
          "Effectiveness is the sum of the scores of the filled holes as a share of those of all
holes. All agents meet the same holes.")
  (:sources "Kinny and Georgeff, Commitment and effectiveness of situated agents, IJCAI-91."
            "Schut and Wooldridge, Principles of intention reconsideration, Agents 2001."
            "Pollack and Ringuette, Introducing the Tileworld, AAAI-90.")
  (:knobs dynamism* planning-time* holes* directions*)
  (:agents (random-walk "Steps in random directions.")
           (naive "Goes to the nearest hole, whatever its score, and is blind on the way.")
           (cautious "Plans again after each step.")
           (normal "Plans again after 4 steps.")
           (bold "Plans again when it has arrived, and is blind on the way.")
           (cautious-target "Cautious, and plans again when its hole has gone.")
           (normal-target "Normal, and plans again when its hole has gone.")
           (bold-target "Bold, but plans again when its hole has gone.")
           (cautious-nearer "Cautious, and plans again also when a nearer hole has opened.")
           (normal-nearer "Normal, and plans again also when a nearer hole has opened.")
           (bold-nearer "Bold, but plans again also when a nearer hole has opened.")
           (cautious-any "Cautious, and plans again also when any hole has opened.")
           (normal-any "Normal, and plans again also when any hole has opened.")
           (bold-any "Bold, but plans again also when any hole has opened.")
           (adaptive "Plans again when a hole, after planning, is worth more than its own.")
           (bold-camera "Bold, but sees holes by its camera.")
           (cautious-camera "Cautious, but sees holes by its camera.")
           (look-ahead "Tries each hole in forks of the run; it pays for planning as others do.")
           (omniscient "The upper bound: it knows all holes in advance, and plans without cost."))
  (:robots tiler)
  (:clean)
  (:thinking :charged)
  (:limit 10000000)
  (:parameters (max-speed* 2) (max-turn-angle* 4) (step-by-grid* t) (camera-desig-delay* 1)
               (scan-density* 1000))
  (:run (play-holes agent))
  (:score effectiveness)
  (:measure filled)
  (:seeds :tuning 1000000 :testing 0)
  (:sweeps ((dynamism* 8 16 32 64 128) (planning-time* 1))
           ((planning-time* 0 1/2 1 2 4) (dynamism* 32)))
  (:claims
   ("If planning takes 4 steps, bold is better than normal, and normal than cautious."
    (((planning-time* 4) (dynamism* 16)) ((planning-time* 4) (dynamism* 32)))
    (:better bold normal .04) (:better normal cautious .09))
   ("The gap narrows as planning gets cheaper."
    (((dynamism* 16)) ((dynamism* 32)))
    (:narrows bold cautious (planning-time* 4 1)))
   ("If planning takes 1 step, normal is better than bold in fast worlds."
    (((planning-time* 1) (dynamism* 32)) ((planning-time* 1) (dynamism* 64)))
    (:better normal bold .005))
   ("If planning takes half a step, cautious and bold are about equal in fast worlds."
    (((planning-time* 1/2) (dynamism* 32)) ((planning-time* 1/2) (dynamism* 64)))
    (:within cautious bold .04))
   ("If planning takes no time, cautious is best."
    (((planning-time* 0) (dynamism* 32)) ((planning-time* 0) (dynamism* 64)))
    (:better cautious normal .02) (:better cautious bold .08))
   ("In fast worlds it helps to react when the hole has gone, and more to react to nearer holes."
    (((planning-time* 1) (dynamism* 24)) ((planning-time* 1) (dynamism* 64)))
    (:better bold-target bold .025) (:better bold-nearer bold-target .02))
   ("If planning takes 2 steps, it is worse to react to any hole than to be blind."
    (((planning-time* 2) (dynamism* 24)) ((planning-time* 2) (dynamism* 64)))
    (:better bold bold-any .04) (:better cautious cautious-any .02))
   ("Once agents react, bold is best if planning takes a step or more."
    (((planning-time* 1) (dynamism* 32)) ((planning-time* 2) (dynamism* 32))
     ((planning-time* 4) (dynamism* 32)))
    (:better bold-nearer normal-nearer .03) (:better bold-nearer cautious-nearer .1))
   ("If planning takes no time, the adaptive agent is not worse than cautious or bold."
    (((planning-time* 0) (dynamism* 16)) ((planning-time* 0) (dynamism* 64)))
    (:not-worse adaptive cautious .01) (:not-worse adaptive bold .01))))
