;;;; testbeds-agents.lisp -- agents of Tileworld with tiles and wind: bounds, forks and cameras.

(in-package :ars-magna.tests)

(def-suite* testbeds-agents :in ars-magna)

(defmacro in-wind ((&key (seed 1) (interval 20) (strength 2) (count 4)) &body body)
  "Run BODY in a game of the testbed TILEWORLD-WIND that begins, and whose states are kept."
  `(run:with-simulation ('ars-testbeds.wind:carrier
                         :seed ,seed :clean t :thinking :charged :journal t :keep t :errors :signal
                         :parameters (list* '(ars-testbeds.wind:game-steps* 200)
                                            '(base:scan-density* 1000)
                                            (list 'ars-testbeds.wind:gust-interval* ,interval)
                                            (list 'ars-testbeds.wind:gust-strength* ,strength)
                                            (list 'ars-testbeds.wind:tile-count* ,count)
                                            *grid-parameters*))
     (begin-wind)
     ,@body))

(defun begin-wind ()
  "Lay out the tiles, as at the start of a game."
  (command:robot-set-speed ars-testbeds.wind:carrier 2)
  (command:robot-set-turn-angle ars-testbeds.wind:carrier 4)
  (run:run-ticks 1)
  (dolist (kicker '(ars-testbeds.wind::lay-out ars-testbeds.wind::hold-together
                    ars-testbeds.wind::gust))
    (world:run-kicker (world:set-kicker (world:find-thing 'clock) kicker)))
  (run:run-ticks 2))

(defun wind-measures (agents knobs &rest names)
  "Return for each of AGENTS the values of the measures NAMES in two tuning games, lists."
  (let ((results (experiment:run-testbed 'tileworld-wind :agents agents :knobs knobs :seeds 2
                                                         :tuning t :stream nil)))
    (loop for sample in (experiment:results-samples results)
          do (is (every (lambda (text) (string= "" text)) (experiment:sample-errors sample)))
          collect (loop for name in names
                        collect (coerce (experiment:sample-measure results sample name) 'list)))))

(test wind.no-agent-beats-the-bound
  (dolist (strength '(0 8))
    (loop for (shares bounds)
            in (wind-measures '(random-walk watchful blind-camera flexible-camera clairvoyant)
                              `((gust-strength* ,strength) (gust-interval* 10) (game-steps* 120))
                              "in-place" "bound")
          do (is (every #'<= shares bounds) "~A ~A" shares bounds)
             (is (every (lambda (bound) (< bound 1)) bounds)))))

(test wind.bound-of-a-single-tile-is-short-of-the-time-to-grasp-it
  "Without wind the bound is reached, but for the 16 ticks to grasp the tile and put it down."
  (destructuring-bind ((shares bounds))
      (wind-measures '(watchful) '((gust-strength* 0) (tile-count* 1) (game-steps* 200))
                     "in-place" "bound")
    (loop for share in shares
          for bound in bounds
          do (is (<= 0 (- bound share) 20/400)))))

(defun times-ahead (wind)
  (loop for tile in (ars-testbeds.wind:tiles)
        collect (ars-testbeds.wind::time-in-place-ahead (first tile) 60 wind)))

(test wind.looking-ahead-does-not-learn-of-gusts
  "The same tiles, other gusts: the same values, if the agent is fair."
  (flet ((times (interval wind) (in-wind (:interval interval) (times-ahead wind))))
    (is (some #'plusp (times 20 nil)))
    (is (equal (times 20 nil) (times 4 nil)))
    (is (not (equal (times 20 t) (times 4 t))))))

(test wind.looking-ahead-leaves-the-run-alone-and-is-exact-after-rewinding
  (in-wind ()
    (let ((before (run:state-digest)) (times (times-ahead nil)))
      (is (equal before (run:state-digest)))
      (run:run-ticks 60)
      (is (not (equal before (run:state-digest))))
      (run:rewind 60)
      (is (equal times (times-ahead nil))))))

(test wind.clairvoyance-helps
  (destructuring-bind ((fair) (clairvoyant))
      (wind-measures '(look-ahead clairvoyant) '((game-steps* 200)) "in-place")
    (is (< (reduce #'+ fair) (reduce #'+ clairvoyant)))))

(test wind.tiles-are-put-down-only-where-they-fit
  "The robot carries a tile into the corner, and holds it there. Nothing gets behind the walls."
  (in-wind (:strength 0)
    (let ((tile (first (ars-testbeds.wind:tiles))))
      (labels ((hold () (ars-testbeds.wind:put-down #'hold))
               (leave (cell)
                 (if (equal cell (ars-testbeds.wind::robot-cell))
                     (hold)
                     (ars-testbeds.wind:step-to cell (lambda () (leave cell)))))
               (take ()
                 (if (equal (ars-testbeds.wind::anchor tile) (ars-testbeds.wind::robot-cell))
                     (ars-testbeds.wind:grasp-tile tile (lambda () (leave '(1 1))))
                     (ars-testbeds.wind:step-to (ars-testbeds.wind::anchor tile) #'take))))
        (take)
        (run:run-ticks 150)
        (is (equal '(1 1) (ars-testbeds.wind::robot-cell)))
        (is (eq (first tile) (first (ars-testbeds.wind:held-tile))))
        (is (every (lambda (thing) (and (<= 1 (world:thing-x thing)) (<= 1 (world:thing-y thing))))
                   (cdddr tile)))))))

;;; Cameras.

(defun wind-sightings ()
  "Return lists (id x y) of the tiles that the camera of the carrier sees."
  (let ((found :none))
    (ars-testbeds.wind::look-round (lambda (sightings) (setf found sightings)))
    (run:run-ticks 30)
    (sort (loop for (tile place) in found collect (cons (first tile) place)) #'< :key #'first)))

(test wind.camera-sees-all-tiles-where-they-are
  (dolist (seed '(1 2 3))
    (in-wind (:seed seed :strength 0 :count 8)
      (is (equal (sort (loop for tile in (ars-testbeds.wind:tiles)
                             collect (cons (first tile) (ars-testbeds.wind::anchor tile)))
                       #'< :key #'first)
                 (wind-sightings))))))

(test wind.agent-with-a-camera-leaves-alone-what-it-does-not-see
  (in-wind (:strength 0)
    (let ((hidden (first (ars-testbeds.wind:tiles))))
      (flet ((place () (ars-testbeds.wind::anchor hidden)))
        (let ((place (place)))
          (world:set-attribute (ars-testbeds.wind:tile-thing hidden) :handle nil)
          (ars-testbeds.wind::blind-camera)
          (run:run-ticks 390)
          (is (equal place (place)))
          (is (equal (list hidden)
                     (remove-if #'ars-testbeds.wind:tile-in-place-p
                                (ars-testbeds.wind:tiles)))))))))

(defun lay-blue-tile (x y color)
  (setf ars-testbeds.tiles::*tiles*
        (append (ars-testbeds.tiles::put-things 'tile (list (list x y)) 900
                                                `((:obsmove t) (:weight 10) (:color ,color)))
                ars-testbeds.tiles::*tiles*)))

(defun play-tiles-by-camera ()
  "Let the agent with a camera fill a hole with a near and a far tile. Return the cells of tiles."
  (push (list* 1 100 0 900 (ars-testbeds.tiles::put-things 'hole '((12 8)) 900
                                                           '((:hole 1) (:score 100))))
        ars-testbeds.tiles::*holes*)
  (command:robot-set-speed ars-testbeds.tiles:pusher 2)
  (command:robot-set-turn-angle ars-testbeds.tiles:pusher 4)
  (run:run-ticks 1)
  (world:set-kicker (world:find-thing 'clock) 'ars-testbeds.tiles::settle)
  (ars-testbeds.tiles::by-utility-camera)
  (run:run-ticks 100)
  (loop for tile in (ars-testbeds.tiles:tiles)
        collect (list (floor (world:thing-x tile)) (floor (world:thing-y tile)))))

(test tiles.agent-with-a-camera-pushes-what-it-sees
  "It takes the near tile, unless this is not seen: then it goes round it for the far one."
  (loop for (near left) in '((:blue ((12 14))) (:green ((11 7))))
        do (in-tiles (:parameters '((base:scan-density* 1000) (base:camera-desig-delay* 1)))
             (lay-blue-tile 11 7 near)
             (lay-blue-tile 12 14 :blue)
             (is (equal left (play-tiles-by-camera))))))

(test tiles.agent-with-a-camera-scores
  (let* ((results (experiment:run-testbed 'tileworld-tiles :agents '(by-utility-camera random-walk)
                                          :knobs '((steps* 150)) :seeds 3 :stream nil))
         (samples (experiment:results-samples results)))
    (flet ((total (sample)
             (is (every (lambda (text) (string= "" text)) (experiment:sample-errors sample)))
             (reduce #'+ (experiment:sample-measure results sample "share"))))
      (is (< (total (second samples)) (total (first samples)))))))

(defmacro check-new-lists (&rest pairs)
  "Check, for each pair (run-variable function), that FUNCTION returns a new list of its items."
  `(progn ,@(loop for (variable function) in pairs
                  collect `(progn (setf ,variable (list 1 2 3))
                                  (is (equal '(3 2 1) (sort (,function) #'>)))
                                  (is (equal '(1 2 3) ,variable) "~A" ',function)))))

(test testbeds.give-agents-lists-that-they-may-sort
  (run:with-simulation ('ars-testbeds:tiler)
    (setf ars-testbeds.trucks::*fuel* 1)    ; a game has begun
    (check-new-lists (ars-testbeds::*holes* ars-testbeds:open-holes)
                     (ars-testbeds.tiles::*holes* ars-testbeds.tiles:holes)
                     (ars-testbeds.tiles::*tiles* ars-testbeds.tiles:tiles)
                     (ars-testbeds.tiles::*obstacles* ars-testbeds.tiles:obstacles)
                     (ars-testbeds.wind::*tiles* ars-testbeds.wind:tiles)
                     (ars-testbeds.trucks::*depots* ars-testbeds.trucks:depots)
                     (ars-testbeds.trucks::*pumps* ars-testbeds.trucks:pumps))))

(test testbeds.give-agents-the-cargo-and-cells-to-sort
  (let ((hole (list 1 100 0 900 1 2)))
    (is (equal '(2 1) (nreverse (ars-testbeds.tiles:hole-cells hole))))
    (is (equal '(1 100 0 900 1 2) hole)))
  (run:with-simulation ('ars-testbeds.trucks:truck)
    (let ((bin (robot:robot-storage-bin ars-testbeds.trucks:truck 1)))
      (setf (robot::location-contents bin) (list 1 2 3))
      (is (equal '(3 2 1) (nreverse (ars-testbeds.trucks:cargo))))
      (is (equal '(1 2 3) (robot:storage-bin-contents bin)))
      (setf (robot::location-contents bin) '()))))

;;; Arguments that make no sense.

(defun check-wrong-arguments (package calls)
  "Check that CALLS, lists (name argument...) of functions in PACKAGE, signal WRONG-ARGUMENT."
  (loop for (name . arguments) in calls
        do (signals base:wrong-argument (apply (find-symbol (string name) package) arguments)
             "~A ~S" name arguments)))

(test testbeds.functions-for-agents-refuse-wrong-arguments
  (run:with-simulation ('ars-testbeds:tiler)
    (check-wrong-arguments :ars-testbeds
                           '((hole-score nil) (steps-to 3) (step-towards nil list)
                             (spend-steps nil list) (spend-steps -1 list)))
    (check-wrong-arguments :ars-testbeds.tiles
                           '((hole-id nil) (hole-cells 3) (hole-worth (1)) (utility nil)
                             (way-to-fill nil) (plan-push nil (1 100 0 900)) (push-to :up list)
                             (spend-steps :few list)))
    (check-wrong-arguments :ars-testbeds.wind
                           '((tile-thing nil) (tile-target 0) (tile-in-place-p nil) (step-to 3 list)
                             (grasp-tile nil list)))))
