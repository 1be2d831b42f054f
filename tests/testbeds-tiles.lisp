;;;; testbeds-tiles.lisp -- Tileworld with tiles to push, and with wind: their laws and claims.

(in-package :ars-magna.tests)

(def-suite* testbeds-tiles :in ars-magna)

(defparameter *grid-parameters*
  '((base:max-speed* 2) (base:max-turn-angle* 4) (base:step-by-grid* t) (base:step-duration* 2)))

(defmacro in-tiles ((&key (seed 1) parameters) &body body)
  "Run BODY in a run of the testbed TILEWORLD-TILES whose journal and states are kept."
  `(run:with-simulation ('ars-testbeds.tiles:pusher
                         :seed ,seed :clean t :thinking :charged :journal t :keep t :errors :signal
                         :parameters (append ,parameters *grid-parameters*))
     ,@body))

(defun lay-tile (x y)
  "Put a tile into the cell X, Y of the current run."
  (setf ars-testbeds.tiles::*tiles*
        (append (ars-testbeds.tiles::put-things 'tile (list (list x y)) 900
                                                '((:obsmove t) (:weight 10)))
                ars-testbeds.tiles::*tiles*)))

(defun lay-hole (&rest cells)
  "Open a hole of CELLS that scores 100."
  (push (list* 1 100 0 900 (ars-testbeds.tiles::put-things 'hole cells 900 '((:hole 1))))
        ars-testbeds.tiles::*holes*))

(defun push-east (count)
  "Push so often to the east. Return the last error code."
  (run:run-ticks 1)
  (world:set-kicker (world:find-thing 'clock) 'ars-testbeds.tiles::settle)
  (let ((code nil))
    (loop repeat count
          do (ars-testbeds.tiles:push-to :east (lambda (err) (setf code err)))
             (run:run-ticks 3))
    code))

(test tiles.fill-a-hole-that-scores-when-it-is-full
  "Pollack and Ringuette: a row of tiles slides, each tile fills a cell, the hole scores when full."
  (in-tiles ()
    (lay-hole '(11 8) '(12 8))
    (lay-tile 9 8)
    (lay-tile 10 8)
    (push-east 1)
    (is (= 1 (length (ars-testbeds.tiles:tiles))))
    (is (zerop ars-testbeds.tiles::*score*))
    (is (null (push-east 2)))
    (is (null (ars-testbeds.tiles:tiles)))
    (is (null (ars-testbeds.tiles:holes)))
    (is (= 100 ars-testbeds.tiles::*score*))))

(test tiles.slide-in-rows-if-the-robot-is-strong
  (dolist (strength '(10 20))
    (in-tiles (:parameters `((base:push-strength* ,strength)))
      (lay-tile 9 8)
      (lay-tile 10 8)
      (is (eq (if (= 10 strength) :too-heavy nil) (push-east 1))))))

(test tiles.stop-at-obstacles-and-walls
  (in-tiles ()
    (lay-tile 9 8)
    (ars-testbeds.tiles::put-things 'obstacle '((10 8)) 900 '((:obsmove t) (:weight 1000000)))
    (is (eq :too-heavy (push-east 1))))
  (in-tiles ()
    (lay-tile 14 8)
    (is (eq :push-stuck (push-east 8)))))

(test tiles.plans-go-round-tiles-and-push-from-behind
  (in-tiles ()
    (lay-tile 7 8)
    (lay-hole '(10 8))
    (run:run-ticks 1)
    (multiple-value-bind (way tile)
        (ars-testbeds.tiles:way-to-fill (first (ars-testbeds.tiles:holes)))
      (is (eq tile (first (ars-testbeds.tiles:tiles))))
      (is (= 7 (length way)))
      (is (equal '(:east :east :east) (last way 3))))))

(test tiles.utility-is-that-of-the-paper
  "The score by the distance of the agent plus twice those of the tiles needed."
  (in-tiles ()
    (lay-hole '(10 8) '(11 8))
    (lay-tile 10 10)
    (is (zerop (ars-testbeds.tiles:utility (first (ars-testbeds.tiles:holes)))))
    (lay-tile 11 11)
    (is (= (/ 100 (+ 2 (* 2 (+ 2 3))))
           (ars-testbeds.tiles:utility (first (ars-testbeds.tiles:holes)))))))

(defun tiles-state ()
  (list (run:measure-value 'ars-testbeds.tiles:share) (run:state-digest)))

(test tiles.games-are-replayed-forked-and-rewound
  (in-tiles (:seed 5 :parameters '((ars-testbeds.tiles:steps* 120)))
    (ars-testbeds.tiles:play 'ars-testbeds.tiles::by-utility)
    (let ((journal (run:simulation-journal (time:current-simulation))) (end (tiles-state)))
      (is (plusp (first end)))
      (is (equal end (run:with-replay (journal) (tiles-state))))
      (let ((fork (run:with-fork (:continuations t) (run:run-ticks 30) (tiles-state))))
        (run:run-ticks 30)
        (is (equal fork (tiles-state))))
      (run:rewind 100)
      (is (not (equal end (tiles-state)))))))

(test tiles.holes-do-not-depend-on-the-agent
  (flet ((offered (agent)
           (in-tiles (:seed 4 :parameters '((ars-testbeds.tiles:steps* 200)))
             (ars-testbeds.tiles:play agent)
             ars-testbeds.tiles::*offered*)))
    (is (equal (offered 'ars-testbeds.tiles::bold) (offered 'ars-testbeds.tiles::random-walk)))))

(test tiles.no-agent-beats-the-bound
  (let ((results (experiment:run-testbed 'tileworld-tiles
                                         :agents '(by-score bold look-ahead)
                                         :knobs '((tile-interval* 60) (steps* 150))
                                         :seeds 2 :stream nil)))
    (dolist (sample (experiment:results-samples results))
      (is (every (lambda (text) (string= "" text)) (experiment:sample-errors sample)))
      (is (every #'<= (experiment:sample-measure results sample "share")
                 (experiment:sample-measure results sample "bound"))))))

(test tiles.claims-hold
  (dolist (row (experiment:check-claims 'tileworld-tiles :seeds 16 :claims '(2)))
    (is (getf row :holds) "~S" row)))

;;; Wind.

(test wind.moves-all-loose-tiles-alike
  "Manual 1.2: a homogeneous event. Nothing leaves the floor, and no two tiles overlap."
  (run:with-simulation ('ars-testbeds.wind:carrier
                        :seed 2 :clean t :errors :signal
                        :parameters (append '((ars-testbeds.wind:gust-interval* 3)
                                              (ars-testbeds.wind:game-steps* 100))
                                            *grid-parameters*))
    (ars-testbeds.wind:play 'ars-testbeds.wind::idle)
    (is (plusp (run:measure-value 'ars-testbeds.wind:blown)))
    (let ((cells (loop for tile in (ars-testbeds.wind:tiles)
                       append (ars-testbeds.wind::cells-at (ars-testbeds.wind::anchor tile)
                                                           (third tile)))))
      (is (= 12 (length (remove-duplicates cells :test #'equal))))
      (is (ars-testbeds.wind::on-floor-p cells)))))

(test wind.games-are-replayed-and-forked
  (flet ((state () (list (run:measure-value 'ars-testbeds.wind:in-place) (run:state-digest))))
    (run:with-simulation ('ars-testbeds.wind:carrier
                          :seed 3 :clean t :thinking :charged :journal t :errors :signal
                          :parameters (append '((ars-testbeds.wind:game-steps* 100))
                                              *grid-parameters*))
      (ars-testbeds.wind:play 'ars-testbeds.wind::watchful)
      (let ((journal (run:simulation-journal (time:current-simulation))) (end (state)))
        (is (plusp (first end)))
        (is (equal end (run:with-replay (journal) (state))))
        (let ((fork (run:with-fork (:continuations t) (run:run-ticks 20) (state))))
          (run:run-ticks 20)
          (is (equal fork (state))))))))

(test wind.without-it-all-tiles-get-to-their-places
  (let ((results (experiment:run-testbed 'tileworld-wind
                                         :agents '(watchful) :seeds 4 :stream nil
                                         :knobs '((gust-strength* 0) (game-steps* 1500)))))
    (is (every (lambda (share) (< 0.9 share 1))
               (experiment:sample-measure results (first (experiment:results-samples results))
                                          "in-place")))))

(test wind.claims-hold
  (dolist (row (experiment:check-claims 'tileworld-wind :seeds 12 :claims '(1)))
    (is (getf row :holds) "~S" row)))
