;;;; country.lisp -- Truckworld: places, roads, weather, parcels, and what happens by itself.

;;; Twelve places are the crossings of a lattice of roads, three cells wide. The seed chooses which
;;; roads exist, their surfaces, the depots where parcels appear, pumps and drums. All that happens
;;; by itself is drawn by kickers, so all agents meet the same. A tick is a minute, a cell 1 km.

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

(defun depots () "Return a new list of the places where parcels appear." (copy-list *depots*))
(defun pumps () "Return a new list of the places with a pump." (copy-list *pumps*))
(defun raining-p () "True if it rains." *raining*)
(defun wetness () "Return how wet all surfaces are, from 0 to 1." *wetness*)
(defun here () "Return the place where the truck is; NIL on a road." *place*)
(defun fuel () "Return how much fuel is in the tank." *fuel*)
(defun game-over-p () "True if the game has ended." (<= game-time* (simulation-tick)))

(defun find-road (place other)
  "Return the road between two places, a list (place place surface), or NIL."
  (find-if (lambda (road) (and (member place (subseq road 0 2)) (member other (subseq road 0 2))
                               (/= place other)))
           *roads*))

(defun neighbours (place)
  "Return a list of the places that a road joins to PLACE."
  (loop for (a b) in *roads*
        when (= a place) collect b
        when (= b place) collect a))

;;; Surfaces. A wet surface is as much slower as it is soft: dirt becomes mud.

(defparameter *surfaces* '((:paved 1 1/10) (:gravel 4/5 3/10) (:dirt 3/5 4/5))
  "Lists (surface smoothness softness).")

(defun mud (surface wetness)
  "Return how deep wheels sink into SURFACE, from 0 to 1."
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

(defun road-speed (surface wetness weight)
  "Return the cells that the truck goes in a tick on SURFACE with cargo of WEIGHT, without noise."
  (* max-speed* (/ (ease surface wetness) (+ 1 (/ weight 100d0)))))

(defun road-fuel (surface wetness weight)
  "Return the fuel that the truck burns for a cell of SURFACE with cargo of WEIGHT."
  (/ (* (+ 1 (/ weight 50d0)) (+ 1 (mud surface wetness)))
     (second (assoc surface *surfaces*))))

(defun slip-chance (surface wetness)
  "Return the probability that the truck is stuck in a cell of SURFACE."
  (* slip-prob* (mud surface wetness)))

(defun drop-chance (weight)
  "Return the probability that an arm drops a parcel of WEIGHT: it grows with the square of
the share of the arm's strength."
  (min 1 (* clumsiness* (expt (/ weight arm-strength*) 2))))

(defun miss-chance (distance)
  "Return the probability that a scan misses what is at DISTANCE, in cells; it is doubled in rain."
  (min 1 (* scan-noise* distance (if *raining* 2 1))))

;;; Laying out.

(defun dice () (world-dice *world* :user))

(defun roll-ticks (mean)
  "Return ticks, from half to one and a half times MEAN."
  (+ (ceiling mean 2) (roll-index (1+ mean) (dice))))

(defun shuffled (list)
  (loop with rest = list
        while rest
        collect (let ((element (roll-element rest (dice))))
                  (setf rest (remove element rest :test #'equal))
                  element)))

(defun connected-p (roads)
  "True if all places can be reached from the first by ROADS."
  (let ((reached (list 0)))
    (loop for new = (loop for (a b) in roads
                          when (and (member a reached) (not (member b reached))) return b
                          when (and (member b reached) (not (member a reached))) return a)
          while new do (push new reached))
    (= 12 (length reached))))

(defun choose-roads ()
  "Return the lattice without four random roads, if possible: all places stay connected."
  (let ((roads (lattice)) (removed 0))
    (dolist (road (shuffled (lattice)) roads)
      (let ((rest (remove road roads :test #'equal)))
        (when (and (< removed 4) (connected-p rest))
          (setf roads rest removed (1+ removed)))))))

(defun put (name point &rest attributes)
  (make-new-thing name (list* *world* point) (append attributes '((:size 1)))))

(defun between (place other share)
  "Return the point on the way from PLACE to OTHER after SHARE of it."
  (mapcar (lambda (a b) (+ (* a (- 1 share)) (* b share))) (place-point place)
          (place-point other)))

(defun fence-off (place other)
  "Close the road between two places, which does not exist."
  (dolist (share '(1/5 1/2 4/5))
    (put 'fence (between place other share) '(:color red) '(:obsmove t))))

(defkicker lay-roads (clock) (:prob 0)
  (let ((roads (choose-roads)) (places (shuffled (loop for place below 12 collect place))))
    (setf *roads* (loop for (a b) in roads
                        collect (list a b (roll-element '(:paved :paved :gravel :gravel :dirt :dirt)
                                                        (dice))))
          *depots* (subseq places 0 4)
          *pumps* (list (nth 3 places) (nth 4 places))
          *fuel* tank-size*
          ;; CHANGE-WEATHER begins with a change.
          *raining* (not (chance rain-share* (dice))))
    (loop for (a b) in (lattice)
          unless (find-road a b) do (fence-off a b))
    (loop for (a b surface) in *roads*
          do (put 'sign (mapcar #'+ (between a b .5) (if (= 1 (- b a)) '(0 1) '(1 0)))
                  (list :surface surface) (list :color (sign-color surface))))
    (dolist (place *depots*) (put 'depot (mapcar #'+ (place-point place) '(-1 -1)) '(:color blue)))
    (dolist (place *pumps*) (put 'pump (mapcar #'+ (place-point place) '(1 -1)) '(:color green)))
    (loop for place in (subseq places 5 8)
          do (run-kicker (set-kicker (put 'drum (mapcar #'+ (place-point place) '(1 1))
                                          '(:color lightred) '(:fuel 60))
                                     'leak)
                         (roll-ticks 20)))))

;;; What happens by itself.

(defkicker leak (drum) (:prob 0)
  (let ((left (1- (get-attribute drum :fuel))))
    (set-attribute drum :fuel (max 0 left))
    (when (plusp left) (run-kicker self 20))))

(defkicker change-weather (clock) (:prob 0)
  ;; Rain lasts 100 ticks in the mean.
  (setf *raining* (if *raining* (<= 1 rain-share*) (plusp rain-share*)))
  (run-kicker self (if *raining*
                       (roll-ticks 100)
                       (roll-ticks (ceiling (* 100 (- 1 rain-share*)) (max 1/100 rain-share*))))))

(defkicker wet (clock) (:prob 0)
  (setf *wetness* (if *raining*
                      (+ *wetness* (* .15d0 (- 1 *wetness*)))
                      (* .93d0 *wetness*)))
  (dolist (sign (find-things 'sign))
    (let ((color (sign-color (get-attribute sign :surface))))
      (unless (eq color (get-attribute sign :color)) (set-attribute sign :color color))))
  (run-kicker self 5))

(defun parcel-id (parcel) "Return the number of PARCEL, a thing." (get-attribute parcel :parcel))

(defun find-parcel (id) (find id *parcels* :key #'parcel-id))

(defun remove-parcel (parcel)
  (setf *parcels* (remove parcel *parcels*))
  (destroy-thing parcel))

(defkicker expire (parcel) (:prob 0)
  (set-attribute parcel :value 0)
  (when (eq :floor (thing-location parcel)) (remove-parcel parcel)))

(defun spoilt-value (value ticks)
  "Return what milk of VALUE is worth after so many TICKS: it loses a tenth in 20."
  (loop repeat (floor ticks 20) do (setf value (* 9/10 value)))
  value)

(defkicker spoil (parcel) (:prob 0)
  (set-attribute parcel :value (* 9/10 (get-attribute parcel :value)))
  (run-kicker self 20))

(defkicker next-parcel (clock) (:prob 0)
  (run-kicker self (roll-ticks parcel-interval*))
  (let* ((depot (roll-element *depots* (dice)))
         (destination (roll-element (remove depot '(0 1 2 3 4 5 6 7 8 9 10 11)) (dice)))
         (value (1+ (roll-index 10 (dice))))
         (now (simulation-tick)) (deadline (+ now (roll-ticks deadline-time*)))
         (milk (zerop (roll-index 4 (dice)))) (id (1+ (length *offers*)))
         (weight (1+ (roll-index 12 (dice))))
         (point (mapcar (lambda (x) (+ x (roll-index 3 (dice)) -1)) (place-point depot)))
         (parcel (put 'parcel point (list :parcel id) (list :destination destination)
                      (list :value value) (list :deadline deadline)
                      (list :weight weight)
                      (list :color (if milk 'lightblue 'red)))))
    (push (list id depot destination value weight now deadline milk) *offers*)
    (setf *parcels* (append *parcels* (list parcel)))
    (run-kicker (set-kicker parcel 'expire) (- deadline now))
    (when milk (run-kicker (set-kicker parcel 'spoil) 20))))

(defkicker clear-away (thing) (:prob 0) (destroy-thing thing))

(defkicker block-road (clock) (:prob 0)
  (run-kicker self (roll-ticks block-interval*))
  (destructuring-bind (a b surface) (roll-element *roads* (dice))
    (declare (ignore surface))
    (run-kicker (set-kicker (put 'block (between a b .5) '(:color red) '(:obsmove t)) 'clear-away)
                (roll-ticks 100))))

(defkicker ignite (clock) (:prob 0)
  (run-kicker self (roll-ticks fire-interval*))
  (let ((depot (roll-element *depots* (dice))))
    (run-kicker (set-kicker (put 'fire (place-point depot) '(:color red)) 'clear-away) 20)
    (dolist (parcel *parcels*)
      (when (lies-at-p parcel depot) (remove-parcel parcel)))))

(defun lies-at-p (thing place)
  "True if THING lies at PLACE."
  (destructuring-bind (x y) (place-point place)
    (and (eq :floor (thing-location thing))
         (<= (max (abs (- (thing-x thing) x)) (abs (- (thing-y thing) y))) 1.5))))
