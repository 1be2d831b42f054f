;;;; testbeds-trucks.lisp -- Truckworld: the laws of its errors, its actions, and its agents.

(in-package :ars-magna.tests)

(def-suite* testbeds-trucks :in ars-magna)

(defparameter *quiet-country*
  '((base:max-speed* 2) (ars-testbeds.trucks:game-time* 4) (ars-testbeds.trucks:rain-share* 0)
    (ars-testbeds.trucks:parcel-interval* 99999) (ars-testbeds.trucks:block-interval* 99999)
    (ars-testbeds.trucks:fire-interval* 99999))
  "Nothing happens by itself.")

(defmacro in-country ((&key (seed 1) parameters (quiet t)) &body body)
  "Run BODY in a run of TRUCKWORLD whose journal and states are kept; if QUIET, after the beginning
of a game in which nothing happens."
  `(run:with-simulation ('ars-testbeds.trucks:truck
                         :seed ,seed :clean t :thinking :charged :journal t :keep t :errors :signal
                         :parameters (append ,parameters
                                             ,@(if quiet
                                                   '(*quiet-country*)
                                                   '('((base:max-speed* 2))))))
     ,@(when quiet '((ars-testbeds.trucks:play 'ars-testbeds.trucks::idle)))
     ,@body))

(defun command-end (command &rest arguments)
  "Give COMMAND with ARGUMENTS; return its error code, its result, and how many ticks it took."
  (let ((begin (run:simulation-tick)) (answer nil))
    (apply command (append arguments (list (lambda (err resource &optional result)
                                             (declare (ignore resource))
                                             (setf answer (list err result))))))
    (loop repeat 500 until answer do (run:run-ticks 1))
    (values (first answer) (second answer) (- (run:simulation-tick) begin))))

(defun drive-truck (place)
  (command-end 'ars-testbeds.trucks:move-truck ars-testbeds.trucks:truck place))

(defun truck-arm (index) (robot:robot-hand ars-testbeds.trucks:truck index))

(defun lay-parcel (weight &key (id 77) (destination 5) (at '(2.5 2.5)))
  "Put a parcel of WEIGHT at the point AT."
  (setf ars-testbeds.trucks::*parcels*
        (append ars-testbeds.trucks::*parcels*
                (list (ars-testbeds.trucks::put 'parcel at `(:parcel ,id) `(:weight ,weight)
                                                `(:destination ,destination) '(:value 8)
                                                '(:deadline 100000))))))

(defun near-rate-p (count trials probability)
  "True if COUNT of TRIALS is within four standard deviations of PROBABILITY."
  (<= (abs (- count (* trials probability)))
      (* 4 (sqrt (* trials probability (- 1 probability))))))

(defun first-road ()
  "Return a place next to place 0, and the surface of the road."
  (let ((place (first (ars-testbeds.trucks:neighbours 0))))
    (values place (third (ars-testbeds.trucks:find-road 0 place)))))

(test trucks.go-at-the-speed-and-burn-the-fuel-of-the-law
  (dolist (wetness '(0 1/2 1))
    (in-country ()
      (setf ars-testbeds.trucks::*wetness* wetness)
      (multiple-value-bind (place surface) (first-road)
        (let ((length (ars-testbeds.trucks::distance-between 0 place))
              (fuel (ars-testbeds.trucks:fuel)))
          ;; The surfaces dry while the truck drives.
          (multiple-value-bind (err result ticks)
              (drive-truck place)
            (let ((dry (ars-testbeds.trucks:wetness)))
              (is (null err))
              (is (= place result (ars-testbeds.trucks:here)))
              (is (<= (/ length (ars-testbeds.trucks:road-speed surface dry 0))
                      ticks
                      (+ 3 (/ length (ars-testbeds.trucks:road-speed surface wetness 0)))))
              (is (<= (* (- length .1) (ars-testbeds.trucks:road-fuel surface dry 0))
                      (- fuel (ars-testbeds.trucks:fuel))
                      (+ .01 (* length (ars-testbeds.trucks:road-fuel surface wetness 0))))))))))))

(test trucks.are-slower-and-thirstier-on-soft-wet-roads-and-with-load
  (flet ((speed (&rest arguments) (apply #'ars-testbeds.trucks:road-speed arguments))
         (fuel (&rest arguments) (apply #'ars-testbeds.trucks:road-fuel arguments)))
    (is (> (speed :paved 0 0) (speed :gravel 0 0) (speed :dirt 0 0) (speed :dirt 1 0)))
    (is (< (fuel :paved 0 0) (fuel :gravel 0 0) (fuel :dirt 0 0) (fuel :dirt 1 0)))
    (is (> (speed :paved 0 0) (speed :paved 0 50)))
    (is (< (fuel :paved 0 0) (fuel :paved 0 50)))
    (is (> (/ (speed :dirt 0 0) (speed :dirt 1 0)) (/ (speed :paved 0 0) (speed :paved 1 0))))))

(defun handle-parcel (times)
  "Load the parcel 77 so often, each time until it is aboard, and unload it. Return how often arms
lifted it."
  (loop repeat times
        sum (1+ (loop for err = (command-end 'ars-testbeds.trucks:load-parcel (truck-arm 0) 77 0)
                      count t
                      while err))
        do (command-end 'ars-testbeds.trucks:unload-parcel (truck-arm 1) 77)))

(test trucks.arms-drop-as-often-as-the-law-says
  (loop for (weight strength) in '((12 15) (6 15) (12 12))
        for law = (* 1/2 (expt (/ weight strength) 2))
        do (in-country (:parameters `((ars-testbeds.trucks:clumsiness* 1/2)
                                      (ars-testbeds.trucks:arm-strength* ,strength)
                                      (ars-testbeds.trucks:handling-time* 1)))
             (lay-parcel weight)
             (is (= law (ars-testbeds.trucks:drop-chance weight)))
             (let ((lifts (handle-parcel 200))
                   (drops (run:measure-value 'ars-testbeds.trucks:dropped)))
               (is (near-rate-p drops lifts law) "~D of ~D, law ~D" drops lifts law)))))

(test trucks.arms-do-not-lift-what-is-too-heavy-and-bays-are-finite
  (in-country (:parameters '((ars-testbeds.trucks:clumsiness* 0)))
    (lay-parcel 16)
    (is (eq :parcel-too-heavy (command-end 'ars-testbeds.trucks:load-parcel (truck-arm 0) 77 0)))
    (is (eq :not-here (command-end 'ars-testbeds.trucks:load-parcel (truck-arm 0) 78 0)))
    (loop for id from 101 to 105 do (lay-parcel 1 :id id))
    (is (equal '(nil nil nil nil :bay-full)
               (loop for id from 101 to 105
                     collect (command-end 'ars-testbeds.trucks:load-parcel (truck-arm 0) id 0))))
    (is (= 4 (length (ars-testbeds.trucks:cargo))))))

(test trucks.scans-miss-by-distance-and-rain
  (loop for (at distance raining) in '(((2.5 2.5) 0 nil) ((3.5 2.5) 1 nil) ((3.5 2.5) 1 t))
        for law = (* 1/5 distance (if raining 2 1))
        do (in-country (:parameters '((ars-testbeds.trucks:scan-noise* 1/5)))
             (lay-parcel 1 :at at)
             (setf ars-testbeds.trucks::*raining* raining)
             (let ((missed 0) (misread 0))
               (loop repeat 400
                     do (let ((report (find :parcel (nth-value 1 (scan-here)) :key #'first)))
                          (cond ((null report) (incf missed))
                                ((/= 5 (third report)) (incf misread)))))
               (is (near-rate-p missed 400 law))
               (is (near-rate-p misread (- 400 missed) (/ law 2)))))))

(defun scan-here ()
  (command-end 'ars-testbeds.trucks:scan-place (robot:robot-camera ars-testbeds.trucks:truck 0)))

(test trucks.slip-as-often-as-the-law-says
  (in-country (:parameters '((ars-testbeds.trucks:slip-prob* 1/4)
                             (ars-testbeds.trucks:tank-size* 100000)
                             (ars-testbeds.trucks:rain-share* 1)))
    (run:run-ticks 200)
    (multiple-value-bind (place surface) (first-road)
      (let* ((trips 60) (length (ars-testbeds.trucks::distance-between 0 place))
             (chance (ars-testbeds.trucks:slip-chance surface (ars-testbeds.trucks:wetness)))
             (slips 0))
        (loop repeat trips
              for goal = place then (- place goal)
              do (loop while (drive-truck goal)
                       do (incf slips)))
        ;; A tick in which the truck slips does not move it.
        (let ((cells (+ (* trips length)
                        (* slips (ars-testbeds.trucks:road-speed
                                  surface (ars-testbeds.trucks:wetness) 0)))))
          (is (<= (abs (- slips (* chance cells))) (* 4 (sqrt (* chance cells))))
              "~D slips in ~A cells, chance ~A" slips cells chance))))))

(test trucks.stay-without-fuel-and-turn-back-from-blocks
  (in-country (:parameters '((ars-testbeds.trucks:tank-size* 5)))
    (is (eq :no-fuel (drive-truck (first-road))))
    (is (null (ars-testbeds.trucks:here)))
    (is (eq :no-fuel (drive-truck 0))))
  (dolist (atomic '(nil t))
    (in-country (:parameters `((ars-testbeds.trucks:atomic* ,atomic)))
      (let ((place (first-road)))
        (ars-testbeds.trucks::put 'block (ars-testbeds.trucks::between 0 place 1/2) '(:obsmove t))
        (is (eq :road-closed
                (drive-truck place)))
        (is (null (ars-testbeds.trucks:here)))
        (is (null (drive-truck 0)))
        (is (eql 0 (ars-testbeds.trucks:here)))
        (is (eq :no-road (drive-truck 11)))))))

(defun ticks-of-two-arms (atomic)
  "Return how many ticks two arms take for a parcel each, and how many are aboard after three."
  (in-country (:parameters `((ars-testbeds.trucks:atomic* ,atomic)
                             (ars-testbeds.trucks:clumsiness* 0)))
    (lay-parcel 1 :id 101)
    (lay-parcel 1 :id 102)
    (let ((ended 0) (begin (run:simulation-tick)) (early nil))
      (dotimes (index 2)
        (ars-testbeds.trucks:load-parcel (truck-arm index) (+ 101 index) index
                                         (lambda (err hand)
                                           (declare (ignore err hand))
                                           (incf ended))))
      (run:run-ticks 3)
      (setf early (length (ars-testbeds.trucks:cargo)))
      (loop until (= 2 ended) do (run:run-ticks 1))
      (list early (- (run:simulation-tick) begin)))))

(test trucks.atomic-actions-come-first-and-one-by-one
  (destructuring-bind (early ticks) (ticks-of-two-arms nil)
    (destructuring-bind (atomic-early atomic-ticks) (ticks-of-two-arms t)
      (is (= 0 early))
      (is (= 1 atomic-early))
      (is (<= (+ ticks 4) atomic-ticks)))))

(test trucks.deliver-milk-and-letters
  (in-country (:parameters '((ars-testbeds.trucks:clumsiness* 0)))
    (let ((place (first-road)))
      (lay-parcel 1 :destination place)
      (command-end 'ars-testbeds.trucks:load-parcel (truck-arm 0) 77 1)
      (drive-truck place)
      (is (null (command-end 'ars-testbeds.trucks:unload-parcel (truck-arm 1) 77)))
      (is (= 8 ars-testbeds.trucks::*worth*))
      (is (null (ars-testbeds.trucks:cargo)))
      (is (eq :not-aboard (command-end 'ars-testbeds.trucks:unload-parcel (truck-arm 1) 77)))))
  (is (= 81/10 (ars-testbeds.trucks::spoilt-value 10 40))))

;;; Games.

(defun trucks-state ()
  (list (run:measure-value 'ars-testbeds.trucks:worth-delivered) (ars-testbeds.trucks:fuel)
        (run:state-digest)))

(test trucks.games-are-replayed-forked-and-rewound
  (dolist (agent '(ars-testbeds.trucks::planner ars-testbeds.trucks::rap-driver))
    (in-country (:seed 7 :quiet nil :parameters '((ars-testbeds.trucks:game-time* 250)))
      (ars-testbeds.trucks:play agent)
      (let ((journal (run:simulation-journal (time:current-simulation))) (end (trucks-state)))
        (is (plusp (first end)))
        (is (equal end (run:with-replay (journal) (trucks-state))))
        (let ((fork (run:with-fork (:continuations t) (run:run-ticks 60) (trucks-state))))
          (run:run-ticks 60)
          (is (equal fork (trucks-state))))
        (run:rewind 160)
        (is (not (equal end (trucks-state))))
        ;; Only plans go on.
        (run:run-ticks 100)
        (is (eq (eq agent 'ars-testbeds.trucks::rap-driver) (equal end (trucks-state))))))))

(test trucks.meet-the-same-world-whatever-they-do
  (flet ((world-of (agent)
           (in-country (:seed 4 :quiet nil :parameters '((ars-testbeds.trucks:game-time* 300)))
             (ars-testbeds.trucks:play agent)
             (list ars-testbeds.trucks::*roads* ars-testbeds.trucks::*offers*
                   (ars-testbeds.trucks:wetness)
                   (mapcar #'world:thing-position (world:find-things 'block))))))
    (let ((worlds (mapcar #'world-of '(ars-testbeds.trucks::idle ars-testbeds.trucks::planner
                                       ars-testbeds.trucks::random-driver))))
      (is (< 5 (length (second (first worlds)))))
      (is (equal (first worlds) (second worlds)))
      (is (equal (first worlds) (third worlds))))))

(test trucks.no-agent-exceeds-the-bound
  (dolist (atomic '(nil t))
    (let ((results (experiment:run-testbed 'truckworld
                                           :knobs `((game-time* 200) (atomic* ,atomic)
                                                    (parcel-interval* 10))
                                           :seeds 2 :tuning t :stream nil)))
      (is (= 7 (length (experiment:results-samples results))))
      (dolist (sample (experiment:results-samples results))
        (is (every (lambda (text) (string= "" text)) (experiment:sample-errors sample)))
        (is (every #'<= (experiment:sample-measure results sample "worth-delivered")
                   (experiment:sample-measure results sample "bound")))))))

(test trucks.play-games-that-are-over-before-they-begin
  (loop for ticks from 1 to 4
        for results = (experiment:run-testbed 'truckworld :agents '(rap-driver planner) :seeds 1
                                                          :knobs `((game-time* ,ticks))
                                                          :tuning t :stream nil)
        do (dolist (sample (experiment:results-samples results))
             (is (string= "" (aref (experiment:sample-errors sample) 0))))))

(test trucks.roads-connect-all-places
  (loop for seed from 1 to 5
        do (in-country (:seed seed)
             (is (= 13 (length ars-testbeds.trucks::*roads*)))
             (is (ars-testbeds.trucks::connected-p ars-testbeds.trucks::*roads*)))))

(test trucks.are-told-ways-by-length-and-by-time
  (in-country ()
    (loop for place in (ars-testbeds.trucks:neighbours 0)
          for road = (ars-testbeds.trucks:find-road 0 place)
          do (is (<= 10 (ars-testbeds.trucks:road-length road) 13))
             (is (eql place (ars-testbeds.trucks:next-place place)))
             (is (= (ars-testbeds.trucks:road-length road)
                    (ars-testbeds.trucks:cost-between
                     0 place #'ars-testbeds.trucks:road-length))))
    (is (null (ars-testbeds.trucks:next-place 0)))
    (let ((step (ars-testbeds.trucks:next-place 11)))
      (is (= (ars-testbeds.trucks:cost-between 0 11 #'ars-testbeds.trucks:time-cost)
             (+ (ars-testbeds.trucks:time-cost (ars-testbeds.trucks:find-road 0 step))
                (ars-testbeds.trucks:cost-between step 11 #'ars-testbeds.trucks:time-cost)))
          "the way by length is not the quickest for this seed"))))

(test trucks.refuse-what-is-no-place-road-or-surface
  (in-country ()
    (dolist (form '((neighbours nil) (neighbours 99) (find-road 0 nil) (cost-between 0 12 time-cost)
                    (next-place nil) (last-scan nil) (time-cost nil) (road-length (0 1))
                    (found-blocked-p 4) (road-speed :ice 0 0) (road-fuel :paved nil 0)
                    (slip-chance :dirt 2) (road-speed :dirt 0 nil) (drop-chance -1)
                    (cost-between 0 5 null) (cost-between 0 5 third)
                    (miss-chance nil)))
      (signals base:wrong-argument
        (apply (find-symbol (string (first form)) :ars-testbeds.trucks) (rest form))))))

(test trucks.say-where-games-begin
  (run:with-simulation ('ars-testbeds.trucks:truck :seed 1 :clean t)
    (dolist (form '((fuel) (depots) (pumps) (neighbours 0) (find-road 0 1) (next-place 4)))
      (is (search "(play 'agent)"
                  (text-of-error (lambda ()
                                (apply (find-symbol (string (first form)) :ars-testbeds.trucks)
                                       (rest form)))))))
    (is (search "(play 'agent)"
                (text-of-error (lambda ()
                              (ars-testbeds.trucks:move-truck ars-testbeds.trucks:truck 4
                                                              (lambda (&rest ends) ends))
                              (run:run-ticks 5)))))))

(test trucks.games-stop-in-the-middle-and-go-on
  (flet ((score-by-way (stop)
           (in-country (:seed 7 :quiet nil :parameters '((ars-testbeds.trucks:game-time* 250)))
             (is (eq (not stop)
                     (ars-testbeds.trucks:play 'ars-testbeds.trucks::planner
                                               :until (if stop 100 1000))))
             (is (= (if stop 100 250) (run:simulation-tick)))
             (run:run-ticks (- 250 (run:simulation-tick)))
             (is (some #'plusp (mapcar #'ars-testbeds.trucks:last-scan
                                       (ars-testbeds.trucks:depots))))
             (list (trucks-state) (ars-testbeds.trucks:beliefs)))))
    (is (equal (score-by-way nil) (score-by-way t)))))

(test trucks.claims-hold
  (dolist (row (experiment:check-claims 'truckworld :seeds 8 :claims '(8)))
    (is (getf row :holds) "~S" row)))

(test trucks.alone-take-their-commands
  (run:with-simulation ('ars-worlds:dot :clean t)
    (signals base:wrong-argument (ars-testbeds.trucks:refuel-truck ars-worlds:dot))
    (signals base:wrong-argument
      (ars-testbeds.trucks:load-parcel (robot:robot-hand ars-worlds:dot 0) 1 0))))

(test trucks.commands-are-in-no-other-menu
  (is (null (search "MOVE-TRUCK" (joined (type-batch "help")))))
  (is (search "Drive the truck" (joined (type-batch "help move-truck")))))

(test play.begins-a-game-in-a-new-run-only
  (in-country ()
    (let ((tick (run:simulation-tick)))
      (signals base:misuse (ars-testbeds.trucks:play 'ars-testbeds.trucks::idle))
      (is (= tick (run:simulation-tick))))))
