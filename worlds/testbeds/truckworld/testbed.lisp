;;;; testbed.lisp -- Truckworld as a testbed: how it is scored, and what is claimed.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

(defun offered () (reduce #'+ *offers* :key #'fourth))

(defmeasure worth-delivered
  "What the delivered parcels were worth, as a share of the values of all parcels, from 0 to 1."
  (/ *worth* (max 1 (offered))))

(defmeasure delivered "How many parcels were delivered in time." *delivered*)
(defmeasure dropped "How often an arm dropped a parcel." *drops*)
(defmeasure fuel-used "How much fuel the truck burnt." *fuel-used*)

;;; The bound. No truck can be faster than an empty one that knows of a parcel when it appears, is
;;; there already, goes the shortest way on dry roads, and has the best of luck with its speed.

(defun best-value (offer)
  "Return what a parcel is worth at the earliest time at which it can be delivered, or 0."
  (destructuring-bind (id depot destination value weight tick deadline milk) offer
    (declare (ignore id))
    (let* ((driving (/ (cost-between depot destination
                                     (lambda (road) (/ (road-length road)
                                                       (ease (third road) 0))))
                       (* max-speed* (+ 1 motion-noise*))))
           (time (max 0 (- (+ handling-time* driving) 3))))
      (cond ((< arm-strength* weight) 0)
            ((< (min deadline game-time*) (+ tick time)) 0)
            (milk (spoilt-value value time))
            (t value)))))

(defmeasure bound
  "The share if each parcel were the only one: no agent has more."
  (/ (reduce #'+ *offers* :key #'best-value) (max 1 (offered))))

(defun play (agent &key (until game-time*))
  "Play a game with AGENT, the name of a plan or function, up to the tick UNTIL, by default to its
end. Return true if the game is over. If it is not, run more ticks, fork or rewind as in any run.
Signals MISUSE unless the run is at tick 0."
  (check-new-game)
  (robot-set-speed truck max-speed*)
  (run-ticks 1)
  (let ((clock (find-thing 'clock)))
    (run-kicker (set-kicker clock 'lay-roads))
    (run-ticks 1)
    (dolist (kicker '(change-weather wet next-parcel block-road ignite))
      (run-kicker (set-kicker clock kicker))))
  (run-ticks 1)
  ;; A plan that begins when no tick is left would act after the run.
  (unless (game-over-p) (start-agent agent))
  (run-ticks (max 0 (- (min until game-time*) (simulation-tick))))
  (game-over-p))

(define-testbed truckworld
  "A truck delivers parcels along roads before their deadlines. Rain makes mud, wheels slip, arms
drop what is heavy, scans miss things, and roads are blocked. How well can it be planned?"
  (:rules "Twelve places are joined by 13 roads, paved, of gravel or dirt. Parcels appear at four
depots, each with a destination, a value from 1 to 10, a weight from 1 to 12 and a deadline. A
quarter is milk, which loses a tenth of its value in 20 ticks."
          "The truck scans the place where it is, loads parcels by two arms into two bays with room
for four each, drives and unloads. A parcel that is unloaded at its destination in time is
delivered."
          "Mud is the wetness of the land times the softness of a surface. The speed is the top
speed times the smoothness of the surface times 1 less mud, divided by 1 plus weight / 100. A cell
takes 1 plus weight / 50 units of fuel, times 1 plus mud, divided by the smoothness."
          "Fuel is at two pumps, and in drums that leak. With an empty tank the truck stays."
          "The score is what the delivered parcels were worth, as a share of all values. All agents
meet the same country, weather, parcels, blocks and fires.")
  (:sources "Firby and Hanks, The simulator manual, Yale 1987, as the 1992 manual describes it.")
  (:knobs game-time* parcel-interval* deadline-time* rain-share* slip-prob* arm-strength*
          clumsiness* scan-noise* motion-noise* tank-size* block-interval* fire-interval*
          handling-time* scan-time* atomic*)
  (:agents (idle "Does nothing.")
           (random-driver "Drives random roads; loads all and delivers what it happens to.")
           (nearest-first "Goes to the nearest destination by length, else to the depot not seen
for longest.")
           (valuable-first "Goes to the destination of the most valuable parcel first.")
           (planner "Goes where it gains most by the time in the present weather, and loads only
what it can deliver in time.")
           (rap-driver "As planner, made of RAPs: tries again what fails, and scans twice in rain.")
           (look-ahead "As planner, but tries its three best targets in forks of the run."))
  (:robots truck)
  (:clean)
  (:limit 10000000)
  (:parameters (max-speed* 2) (motion-noise* 1/10))
  (:run (play agent))
  (:score worth-delivered)
  (:measure delivered dropped fuel-used bound)
  (:seeds :tuning 1000000 :testing 0)
  (:sweeps ((rain-share* 0 1/4 1/2 1))
           ((clumsiness* 0 3/10 1))
           ((parcel-interval* 10 25 40)))
  (:claims
   ("To plan by time is better than to go to the nearest destination, and this than random roads."
    (())
    (:better planner nearest-first .02) (:better nearest-first random-driver .1))
   ("The more it rains, the less is delivered."
    (())
    (:narrows planner idle (rain-share* 0 1/2)) (:narrows nearest-first idle (rain-share* 0 1/2)))
   ("The more it rains, the more it helps to plan by time."
    (())
    (:narrows planner nearest-first (rain-share* 1/2 0)))
   ("The more wheels slip in mud, the less is delivered."
    (((rain-share* 1/2)))
    (:narrows planner idle (slip-prob* 0 1/5)) (:narrows nearest-first idle (slip-prob* 0 1/5)))
   ("The clumsier the arms are, the less is delivered."
    (())
    (:narrows planner idle (clumsiness* 0 1)) (:narrows nearest-first idle (clumsiness* 0 1)))
   ("The weaker the arms are, the less is delivered."
    (())
    (:narrows planner idle (arm-strength* 30 8)) (:narrows nearest-first idle (arm-strength* 30 8)))
   ("The more often scans miss and misread things, the less is delivered."
    (())
    (:narrows planner idle (scan-noise* 0 1/4)) (:narrows nearest-first idle (scan-noise* 0 1/4)))
   ("The smaller the tank is, the less is delivered."
    (())
    (:narrows planner idle (tank-size* 400 150)) (:narrows nearest-first idle (tank-size* 400 150)))
   ("The more often roads are blocked, the less is delivered."
    (())
    (:narrows planner idle (block-interval* 400 40))
    (:narrows nearest-first idle (block-interval* 400 40)))
   ("The more often depots burn, the less is delivered."
    (())
    (:narrows planner idle (fire-interval* 2000 50))
    (:narrows nearest-first idle (fire-interval* 2000 50)))
   ("The less time there is for a parcel, the less is delivered."
    (())
    (:narrows planner idle (deadline-time* 400 120))
    (:narrows nearest-first idle (deadline-time* 400 120)))
   ("The more parcels there are, the smaller is the share that is delivered."
    (())
    (:narrows planner idle (parcel-interval* 40 15))
    (:narrows nearest-first idle (parcel-interval* 40 15)))
   ("The longer arms take, the less is delivered."
    (())
    (:narrows planner idle (handling-time* 1 12))
    (:narrows nearest-first idle (handling-time* 1 12)))
   ("Atomic actions cost, since arms do not work at the same time."
    (())
    (:narrows planner idle (atomic* nil t)) (:narrows nearest-first idle (atomic* nil t)))
   ("RAPs, which try again and scan twice in rain, beat going to the nearest destination."
    (())
    (:better rap-driver nearest-first 0))
   ("It helps to look ahead."
    (())
    (:better look-ahead planner 0))))
