;;;; steps.lisp -- steps to neighbouring cells, and thoughts of fractions of a tick.

(in-package :ars-magna.tests)

(def-suite* steps :in ars-magna)

(world:defmap paved (12 12) (rect (0 0) (11 11) bricks 10))
(robot:defrobot paver (paved (5.5 5.5) 0) :cameras ((2 3)))
(robot:defrobot paviour (paved (7.5 5.5) pi))

(defparameter *step-moves*
  '((north 0 -1) (north-east 1 -1) (east 1 0) (south-east 1 1)
    (south 0 1) (south-west -1 1) (west -1 0) (north-west -1 -1)))

(defun step-code (robot direction)
  "Let ROBOT step in DIRECTION. Return the error code, and how many ticks it took."
  (let ((code :none) (start (run:simulation-tick)))
    (command:robot-step robot direction (lambda (err robot) (declare (ignore robot))
                                          (setf code err)))
    (run:run-until (lambda () (not (eq code :none))) :limit 100)
    (values code (- (run:simulation-tick) start))))

(defun within-p (a b &optional (tolerance 1d-9)) (< (abs (- a b)) tolerance))

(test step.takes-the-same-time-to-each-neighbour
  (loop for (direction columns rows) in *step-moves*
        do (loop for heading in '(0 1 -2.5d0 3.1d0)
                 do (run:with-simulation (paver :clean t)
                      (robot:place-robot paver 5.5 5.5 heading)
                      (robot:reset-odometer (robot:robot-main-odometer paver))
                      (is (equal '(nil 15) (multiple-value-list (step-code paver direction))))
                      (is (within-p (+ 5.5 columns) (robot:robot-x paver)) "~A" direction)
                      (is (within-p (+ 5.5 rows) (robot:robot-y paver)) "~A" direction)))))

(test step.goes-to-the-middle-from-anywhere-in-a-cell
  (run:with-simulation (paver :clean t)
    (robot:place-robot paver 5.1 5.9 1)
    (robot:reset-odometer (robot:robot-main-odometer paver))
    (is (eq nil (step-code paver :north-east)))
    (is (within-p 6.5 (robot:robot-x paver)))
    (is (within-p 4.5 (robot:robot-y paver)))))

(test step.lasts-as-long-as-the-parameter-says
  (dolist (duration '(13 20 50))
    (run:with-simulation (paver :clean t :parameters `((base:step-duration* ,duration)))
      (is (equal (list nil duration) (multiple-value-list (step-code paver 'west)))))))

(test step.fails-before-it-moves-if-there-is-too-little-time
  (run:with-simulation (paver :clean t :parameters '((base:step-duration* 12)))
    (is (eq :too-slow (step-code paver 'west)))
    (is (= 5.5 (robot:robot-x paver)))
    (is (= 0 (robot:robot-angle paver)))
    (is (eq nil (step-code paver 'east)))
    (command:robot-set-speed paver 1/20)
    (run:run-ticks 1)
    (is (eq :too-slow (step-code paver 'east)))
    (command:robot-set-speed paver 0)
    (run:run-ticks 1)
    (is (eq :not-moving (step-code paver 'east)))))

(test step.has-its-duration-for-each-length-of-ticks
  (dolist (quantum '(1 2 3 5 7 8 20))
    (run:with-simulation (paver :clean t :parameters `((base:tick-quantum* ,quantum)))
      (dolist (direction '(east west north-west south))
        (multiple-value-bind (code ticks) (step-code paver direction)
          (is (or (eq :too-slow code)
                  (and (null code) (= ticks (ceiling 15 quantum))))
              "~A with ~D: ~A in ~D" direction quantum code ticks))))))

(test step.is-blocked-as-drives-are
  (run:with-simulation (paver :clean t)
    (loop repeat 5 do (step-code paver 'east))
    (is (eq :robot-blocked (step-code paver 'east)))
    (is (< 10.9 (robot:robot-x paver) 11)))
  (run:with-simulation ((paver paviour) :clean t)
    (robot:place-robot paviour 6.5 5.5 0)
    (is (eq :robot-blocked (step-code paver 'east)))
    (is (search "paviour is in the way"
                (string-downcase (getf (command:last-failure paver) :text))))))

(test step.has-the-noise-of-drives
  "One drive of less than MAX-SPEED* errs by at most MOTION-NOISE*; so does a step of two ticks."
  (let ((errors (loop for seed from 1 to 60
                      collect (run:with-simulation (paver :seed seed)
                                (step-code paver 'east)
                                (- (robot:robot-x paver) 6.5)))))
    (is (every (lambda (error) (<= (abs error) 0.1000001)) errors))
    (is (some (lambda (error) (> error 0.05)) errors))
    (is (some (lambda (error) (< error -0.05)) errors))))

(defun distance-after-steps (seed grid-p)
  "Return how far a robot is from where it began after 40 steps to and fro."
  (run:with-simulation (paver :seed seed :parameters `((base:step-by-grid* ,grid-p)
                                                       (base:robot-turn-max-error* 1/20)))
    (loop repeat 10
          do (dolist (direction '(east south west north)) (step-code paver direction)))
    (max (abs (- (robot:robot-x paver) 5.5)) (abs (- (robot:robot-y paver) 5.5)))))

(test step.by-the-grid-does-not-drift
  (flet ((worst (grid-p)
           (loop for seed from 1 to 10 maximize (distance-after-steps seed grid-p))))
    (is (< (worst t) 0.25))
    (is (> (worst nil) 0.5))))

(test step.takes-names-of-any-package-and-refuses-others
  (run:with-simulation (paver :clean t :journal t)
    (dolist (direction '(:east "East" east)) (is (eq nil (step-code paver direction))))
    (is (equal '(:east :east :east)
               (mapcar #'fourth (run:journal-entries (end-journal time:*simulation*)))))
    (dolist (direction '(nil up 1 (east) "eastward"))
      (is (search "south-west, west or north-west"
                  (wrong-argument-text (lambda () (command:robot-step paver direction))))))))

(test step.is-forked-rewound-saved-and-replayed-on-its-way
  (loop for tick in '(1 4 8 11 14)
        do (run:with-simulation (paver :seed 5 :journal t :keep t)
             (command:robot-step paver 'north-west)
             (run:run-ticks tick)
             (let ((fork (run:fork-simulation)))
               (run:run-ticks (- 20 tick))
               (run:run-ticks (- 20 tick) fork)
               (is (= (run:state-digest) (run:state-digest fork)))
               (is (= (run:state-digest) (replayed-digest)))
               (run:rewind (- 20 tick))
               (uiop:with-temporary-file (:pathname file)
                 (run:save-simulation file)
                 (run:with-loaded-simulation (file)
                   (run:run-ticks (- 20 tick))
                   (is (= (run:state-digest) (run:state-digest fork)))))))))

(test step.gives-way-to-a-stop
  (run:with-simulation (paver :clean t)
    (command:robot-step paver 'west)
    (run:run-ticks 5)
    (command:robot-stop paver)
    (run:run-ticks 20)
    (is (= 5.5 (robot:robot-x paver)) "a robot that turned does not coast")))

;;; A blocked robot stops before the obstacle, and in no cell that it has not reached: a clean
;;; odometer agrees with the truth also after a line through a corner of cells.

(world:defmap pillared (12 12) (rect (0 0) (11 11) bricks 10)
  (wall (6 4) (6 6) bricks 10) (wall (3 8) (5 8) bricks 10)
  (wall (8 8) (8 8) bricks 10) (wall (9 3) (9 3) bricks 10))
(robot:defrobot pillar-walker (pillared (5.5 5.5) 0))

(defun step-of-a-walk (move)
  "Let PILLAR-WALKER make MOVE. Return the code, whether it reached the cell, and its error."
  (destructuring-bind (direction columns rows) move
    (let* ((robot pillar-walker)
           (column (+ columns (floor (robot:robot-x robot))))
           (row (+ rows (floor (robot:robot-y robot))))
           (code (step-code robot direction)))
      (multiple-value-bind (x y) (robot:odometer-estimate (robot:robot-main-odometer robot))
        (is (within-p x (robot:robot-x robot)) "~A to ~A,~A" direction column row)
        (is (within-p y (robot:robot-y robot)) "~A to ~A,~A" direction column row))
      (is (eq (null code) (and (= column (floor (robot:robot-x robot)))
                               (= row (floor (robot:robot-y robot)))))))))

(test step.keeps-a-clean-odometer-true-at-corners
  (let ((random (sb-ext:seed-random-state 7)))
    (run:with-simulation (pillar-walker :clean t)
      (loop repeat 200 do (step-of-a-walk (elt *step-moves* (random 8 random)))))))

(test step.stops-short-of-a-corner
  (run:with-simulation (pillar-walker :clean t)
    (robot:place-robot pillar-walker 4.5 7.5 0)
    (is (eq :robot-blocked (step-code pillar-walker :south-east)))
    (is (= 4 (floor (robot:robot-x pillar-walker))))
    (is (= 7 (floor (robot:robot-y pillar-walker))))))

;;; Fractions of ticks.

(robot:defrobot ponderer (paved (2.5 2.5) 0))

(defun ends-of-thoughts (mode &rest spans)
  (run:with-simulation (ponderer :thinking mode)
    (values (driver:run-plan (rpl:interp-lambda (spans)
                               (let ((times '()))
                                 (dolist (span spans)
                                   (rpl:think span)
                                   (push (rpl:plan-time) times))
                                 (reverse times)))
                             spans))))

(test fractions.add-up-exactly
  (is (equal '(0 0 0 1 1 1 1 2)
             (ends-of-thoughts :charged 1/4 1/4 1/4 1/4 1/4 1/4 1/4 1/4)))
  (is (equal '(0 0 1 1 1 2) (ends-of-thoughts :charged 1/3 1/3 1/3 1/3 1/3 1/3)))
  (is (equal '(2 5 5 6) (ends-of-thoughts :charged 5/2 5/2 1/2 1/2)))
  (is (= 7 (first (last (apply #'ends-of-thoughts :charged
                               (make-list 10 :initial-element 0.7))))))
  (is (equal '(0 0 1) (ends-of-thoughts '(:charged :budget 1000) 0.5d0 1/4 1/4)))
  (is (equal '(0 0) (ends-of-thoughts :free 3/2 3/2)))
  (is (equal '(0 0) (ends-of-thoughts :real 3/2 3/2))))

(test fractions.of-all-charges-add-up
  (run:with-simulation (ponderer :thinking :charged)
    (is (equal '(0 0 1 1 3)
               (values (driver:run-plan
                        (rpl:interp-lambda ()
                          (let ((times '()))
                            (rpl:think 1/4)
                            (push (rpl:plan-time) times)
                            (rpl:with-charge (1/4) nil)
                            (push (rpl:plan-time) times)
                            (rpl:charge-ticks 1/2)
                            (rpl:wait-time 0)
                            (push (rpl:plan-time) times)
                            (rpl:with-charge (3/4) nil)
                            (push (rpl:plan-time) times)
                            (rpl:with-charge (5/4) nil)
                            (push (rpl:plan-time) times)
                            (reverse times)))))))
    (is (= 0 (robot:robot-unpaid-thinking ponderer)))))

(test fractions.of-seconds-add-up
  (run:with-simulation (ponderer :thinking :charged)
    (is (equal '(0 0 0 1)
               (driver:run-plan (rpl:interp-lambda ()
                                  (let ((times '()))
                                    (dotimes (i 4)
                                      (rpl:think 1/80 :unit :seconds)
                                      (push (rpl:plan-time) times))
                                    (reverse times))))))))

(test fractions.belong-to-the-robot
  "Plans that end hand them on, programs share them, and free thoughts add none."
  (run:with-simulation (ponderer :thinking :charged)
    (driver:run-plan (rpl:interp-lambda () (rpl:think 1/2)))
    (is (= 1/2 (robot:robot-unpaid-thinking ponderer)))
    (is (= 1/2 (getf (run:status ponderer) :unpaid-thinking)))
    (command:think ponderer 3/2)
    (run:run-ticks 2)
    (is (= 0 (robot:robot-unpaid-thinking ponderer)))
    (is (null (getf (run:status ponderer) :unpaid-thinking)))
    (run:set-thinking :free)
    (driver:run-plan (rpl:interp-lambda () (rpl:think 1/2)))
    (is (= 0 (robot:robot-unpaid-thinking ponderer)))))

(test fractions.are-kept-in-forks-files-and-replays
  (run:with-simulation (ponderer :thinking :charged :journal t :keep t)
    (let ((none (run:state-digest)))
      (driver:run-plan (rpl:interp-lambda () (rpl:think 1/4) (rpl:think 1/2)))
      (is (/= none (run:state-digest)))
      (run:run-ticks 3)
      (is (= (run:state-digest) (replayed-digest)))
      (is (= 3/4 (run:with-fork () (robot:robot-unpaid-thinking ponderer))))
      (uiop:with-temporary-file (:pathname file)
        (run:save-journal file)
        (run:with-replay (file) (is (= 3/4 (robot:robot-unpaid-thinking ponderer)))))
      (uiop:with-temporary-file (:pathname file)
        (run:save-simulation file)
        (run:with-loaded-simulation (file)
          (is (= 3/4 (robot:robot-unpaid-thinking ponderer))))))))

(test fractions.of-none-leave-digests-as-they-were
  (flet ((digest (&rest spans)
           (run:with-simulation (ponderer :thinking :charged)
             (dolist (span spans)
               (command:think ponderer span)
               (run:run-ticks 3))
             (run:run-ticks (- 12 (run:simulation-tick)))
             (run:state-digest))))
    (is (= (digest) (digest 2) (digest 1/2 1/2) (digest 1/4 3/4 1 1)))
    (is (/= (digest) (digest 1/2)))))
