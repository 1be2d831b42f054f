;;;; country.lisp -- Truckworld: its knobs, the state of a game, what agents can ask, and physics.

;;; Twelve places are the crossings of a lattice of roads, three cells wide. A tick is a minute, a
;;; cell 1 km.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

(define-knob game-time* 1000 "ticks" (integer 1 1000000) "How long a game lasts.")
(define-knob parcel-interval* 25 "ticks" (integer 1 100000)
  "How much time passes between two parcels, in the mean.")
(define-knob deadline-time* 250 "ticks" (integer 1 100000)
  "How much time there is to deliver a parcel, in the mean.")
(define-knob rain-share* 1/4 "share of the time" (real 0 1) "How much of the time it rains.")
(define-knob slip-prob* 1/20 "probability per cell" (real 0 1)
  "How likely wheels slip and the truck is stuck, on a soaked surface that is all soft.")
(define-knob arm-strength* 15 "weight" (real 1 1000) "The greatest weight that an arm lifts.")
(define-knob clumsiness* 3/10 "probability" (real 0 1)
  "How likely an arm drops a parcel as heavy as its strength. Parcels weigh 1 to 12.")
(define-knob scan-noise* 1/20 "probability per cell" (real 0 1)
  "How likely a scan in dry weather misses a thing at a distance of a cell.")
(define-knob tank-size* 250 "units" (real 1 100000) "How much fuel the tank holds.")
(define-knob block-interval* 100 "ticks" (integer 1 100000)
  "How much time passes until a road is blocked, in the mean.")
(define-knob fire-interval* 300 "ticks" (integer 1 100000)
  "How much time passes until there is a fire in a depot, in the mean.")

;;; The country. Places are numbers, row by row from the north-west.

(defparameter *columns* '(2 13 24 37))
(defparameter *rows* '(2 12 23))

(defmap country (40 26)
  (rect (0 0) (39 25) stone 10)
  (rect (4 4) (11 10) wood 10) (rect (15 4) (22 10) wood 10) (rect (26 4) (35 10) wood 10)
  (rect (4 14) (11 21) wood 10) (rect (15 14) (22 21) wood 10) (rect (26 14) (35 21) wood 10)
  (obj clock (8.5 7.5) ((:size 1))))

(defrobot truck (country (2.5 2.5) 0)
  :cameras (((/ pi 2) 12)) :hands (1000 1000) :bins (4 4))

(defun place-point (place)
  "Return the middle of PLACE, a list (x y)."
  (multiple-value-bind (row column) (floor place 4)
    (list (+ (nth column *columns*) .5) (+ (nth row *rows*) .5))))

(defun distance-between (place other)
  "Return how many cells the places are apart, along the lattice."
  (reduce #'+ (mapcar (lambda (a b) (abs (- a b))) (place-point place) (place-point other))))

(defun lattice ()
  "Return all roads that there can be, lists of two places."
  (loop for place below 12
        unless (= 3 (mod place 4)) collect (list place (1+ place))
        when (< place 8) collect (list place (+ place 4))))

(define-run-variable *roads* '() "The roads, lists (place place surface).")
(define-run-variable *depots* '() "The places where parcels appear.")
(define-run-variable *pumps* '() "The places with a pump.")
(define-run-variable *wetness* 0 "How wet all surfaces are, from 0 to 1.")
(define-run-variable *raining* nil "True while it rains.")
(define-run-variable *parcels* '() "The parcels that are not delivered, lost or expired, things.")
(define-run-variable *offers* '() "Lists (id depot destination value weight tick deadline milk).")
(define-run-variable *worth* 0 "The sum of what the delivered parcels were worth.")
(define-run-variable *delivered* 0 "How many parcels were delivered in time.")
(define-run-variable *drops* 0 "How often an arm dropped a parcel.")
(define-run-variable *fuel* nil "How much fuel is in the tank; NIL before the game.")
(define-run-variable *fuel-used* 0 "How much fuel was burnt.")
(define-run-variable *busy* 0 "The tick until which the truck acts, if actions are atomic.")

(define-run-variable *place* 0 "The place where the truck is; NIL on a road.")
(define-run-variable *leg* '() "The places at both ends of the road that the truck is on.")

(defun check-begun ()
  "Signal MISUSE unless a game has begun."
  (unless *fuel*
    (reject-use "The game has not begun: there are no roads yet. Begin it by (play 'agent) instead ~
                 of starting the agent.")))

(defun depots () "Return a new list of the places where parcels appear."
  (check-begun)
  (copy-list *depots*))
(defun pumps () "Return a new list of the places with a pump."
  (check-begun)
  (copy-list *pumps*))
(defun raining-p () "True if it rains." *raining*)
(defun wetness () "Return how wet all surfaces are, from 0 to 1." *wetness*)
(defun here () "Return the place where the truck is; NIL on a road." *place*)
(defun fuel () "Return how much fuel is in the tank."
  (check-begun)
  *fuel*)
(defun game-over-p () "True if the game has ended." (<= game-time* (simulation-tick)))

(defparameter *place-text* "the number of a place, from 0 to 11; (here) is NIL on a road")

(defun place-number-p (thing) (typep thing '(integer 0 11)))

(defun road-list-p (thing)
  (typep thing '(cons (integer 0 11) (cons (integer 0 11) (cons (member :paved :gravel :dirt))))))

(defun check-road (road)
  (check-argument truckworld road (road-list-p road)
                  "a list (place place surface), as FIND-ROAD returns it"))

(defun find-road (place other)
  "Return the road between two places, a list (place place surface), or NIL."
  (check-argument find-road place (place-number-p place) *place-text*)
  (check-argument find-road other (place-number-p other) *place-text*)
  (check-begun)
  (find-if (lambda (road) (and (member place (subseq road 0 2)) (member other (subseq road 0 2))
                               (/= place other)))
           *roads*))

(defun neighbours (place)
  "Return a list of the places that a road joins to PLACE."
  (check-argument neighbours place (place-number-p place) *place-text*)
  (check-begun)
  (loop for (a b) in *roads*
        when (= a place) collect b
        when (= b place) collect a))

(defun road-length (road)
  "Return how many cells ROAD is long, a list (place place surface)."
  (check-road road)
  (distance-between (first road) (second road)))

;;; Surfaces. A wet surface is as much slower as it is soft: dirt becomes mud.

(defparameter *surfaces* '((:paved 1 1/10) (:gravel 4/5 3/10) (:dirt 3/5 4/5))
  "Lists (surface smoothness softness).")

(defun mud (surface wetness)
  "Return how deep wheels sink into SURFACE, from 0 to 1."
  (check-argument truckworld surface (assoc surface *surfaces*) ":paved, :gravel or :dirt")
  (check-argument truckworld wetness (typep wetness '(real 0 1)) "a number from 0 to 1")
  (* wetness (third (assoc surface *surfaces*))))

(defun ease (surface wetness)
  "Return how easy it is to drive on SURFACE, from 0 to 1: the share of the top speed."
  (* (second (assoc surface *surfaces*)) (- 1 (mud surface wetness))))

(defun sign-color (surface)
  (ecase surface
    (:paved 'lightblue)
    (:gravel 'lightgreen)
    (:dirt (if (< .5 *wetness*) 'violet 'lightviolet))))

;;; Physics.

(defun cargo ()
  "Return a new list of the parcels in the bays, things."
  (loop for bin across (robot-bins truck) append (copy-list (storage-bin-contents bin))))

(defun cargo-weight () (loop for parcel in (cargo) sum (get-attribute parcel :weight)))

(defun check-weight (weight)
  (check-argument truckworld weight (typep weight '(real 0)) "a number that is not negative"))

(defun road-speed (surface wetness weight)
  "Return the cells that the truck goes in a tick on SURFACE with cargo of WEIGHT, without noise."
  (check-weight weight)
  (* max-speed* (/ (ease surface wetness) (+ 1 (/ weight 100d0)))))

(defun road-fuel (surface wetness weight)
  "Return the fuel that the truck burns for a cell of SURFACE with cargo of WEIGHT."
  (check-weight weight)
  (/ (* (+ 1 (/ weight 50d0)) (+ 1 (mud surface wetness)))
     (second (assoc surface *surfaces*))))

(defun slip-chance (surface wetness)
  "Return the probability that the truck is stuck in a cell of SURFACE."
  (* slip-prob* (mud surface wetness)))

(defun drop-chance (weight)
  "Return the probability that an arm drops a parcel of WEIGHT: it grows with the square of
the share of the arm's strength."
  (check-weight weight)
  (min 1 (* clumsiness* (expt (/ weight arm-strength*) 2))))

(defun miss-chance (distance)
  "Return the probability that a scan misses what is at DISTANCE, in cells; it is doubled in rain."
  (check-argument miss-chance distance (typep distance '(real 0)) "a number that is not negative")
  (min 1 (* scan-noise* distance (if *raining* 2 1))))
