;;;; manual-2.lisp -- chapter 2 of the manual: world, robot and time.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-2 :in ars-magna)

;;; 2.1: the world.

(test manual-2-1.a-cell-is-a-metre-wide
  "2.1: at speed 1 the robot is one cell farther after each tick."
  (at-each-spot (:clean t)
    (let ((x (robot-x scout)))
      (robot-set-speed scout 1)
      (answer 'robot-go-forward scout 3)
      (is (near 3 (- (robot-x scout) x))))))

(test manual-2-1.positions-are-real-numbers
  "2.1, reading 54: robot and things stay exactly where they are put; the grid does not move them."
  (at-each-spot (:clean t)
    (is (equal (mapcar (lambda (x) (coerce x 'double-float)) spot)
               (multiple-value-list (robot-position scout))))
    (let ((ball (put-beside 'ball 3.25 1/8)))
      (is (= (+ (robot-x scout) 3.25) (thing-x ball)))
      (is (= (+ (robot-y scout) 1/8) (thing-y ball))))))

(test manual-2-1.coordinates-are-rounded-down-to-cells
  "2.1, reading 51: a cell has its left and upper borders, not the others."
  (loop for (x . cell) in '((30 . 30) (30.5 . 30) (30.999 . 30) (31 . 31))
        do (is (= cell (cell-x (map-cell yard x 5))))
           (is (eq (= cell 30) (wall-at-p yard x 5)) "~D" x)))

(test manual-2-1.filled-cells-are-walls
  "2.1: cells are filled or empty, and the filled ones are the walls."
  (loop for (x y filled) in '((0 0 t) (39 29 t) (30 5 t) (30 10 nil) (29 5 nil) (10 10 nil))
        do (is (eq filled (and (!_filled? (map-cell yard x y)) t)))
           (is (eq filled (and (wall-at-p yard (+ x .3) (+ y .7)) t)))))

(test manual-2-1.outside-is-solid
  "2.1, reading 53: nothing can leave the map, and a camera reads 0 beyond its edge."
  (with-own-definitions ()
    (defmap common (6 6))
    (defrobot walker (common (3 3) 0) :cameras ((1 3)))
    (with-simulation (walker :clean t)
      (declare (special walker))
      (robot-goto-wall walker)
      (run-ticks 30)
      (is (< 5.99 (robot-x walker) 6))
      (is (wall-at-p (find-map 'common) 6 3))
      (is (equal '(0d0 0d0 0d0) (first (answer 'camera-view (robot-camera walker 0))))))))

(test manual-2-1.place-types-are-of-empty-cells
  "2.1: an empty cell may have a place type by the walls around it: doorways and concave corners."
  (flet ((type-at (x y)
           (let ((place (cell-type (map-cell yard x y))))
             (and place (place-type-name (place-type place))))))
    (loop for (x y type) in '((30 10 doorway) (1 1 concave) (29 1 concave) (38 28 concave)
                              (10 10 nil) (30 5 nil) (0 0 nil))
          do (is (eq type (type-at x y)) "(~D,~D)" x y))))

(test manual-2-1.place-types-can-be-sensed
  "2.1: the robot senses the place type of its cell, wherever in the cell it stands."
  (with-scout (:clean t)
    (dolist (point '((30 10) (30.5 10.5) (30.93 10.07)))
      (place-robot scout (first point) (second point) 1)
      (is (equal '(doorway) (answer 'robot-place scout))))
    (place-robot scout 10 10 1)
    (is (equal '(nil) (answer 'robot-place scout)))))

(test manual-2-1.canonical-directions-stabilize
  "2.1, readings 73 and 103: aligning takes up the nearest of the directions through a doorway."
  (with-scout (:clean t)
    (loop for (heading aligned) in `((.4 0) (-.6 0) (1.2 0) (2 ,pi) (3.5 ,pi))
          do (place-robot scout 30.2 10.9 heading)
             (let ((turned (first (answer 'robot-align-place scout))))
               (is (near aligned (robot-angle scout)))
               (is (near (- aligned heading) turned 1d-6))))))

(test manual-2-1.local-is-nearer-than-a-metre
  "2.1, reading 108: less than a metre away is local, and so is the robot's cell."
  (at-each-spot (:clean t)
    (put-beside 'near .99 0)
    (put-beside 'nearer .6 -.5)
    (put-beside 'far 1.01 0)
    (put-beside 'farther 1.5 1.5)
    (put 'cell-mate '(10.99 10.01))
    (is (equal '(cell-mate near nearer) (seen :type :local)))
    (is (equal '(far farther) (seen)))))

(test manual-2-1.walls-have-a-substance
  "2.1: each wall cell has one substance, a symbolic type and a numeric parameter."
  (flet ((substance (x y)
           (let ((cell (map-cell yard x y)))
             (list (cell-substance-type cell) (cell-substance-parameter cell)))))
    (is (equalp '(bricks 10) (substance 0 7)))
    (is (equalp '(slate 30) (substance 30.4 5.6)))))

(test manual-2-1.objects-have-a-substance-and-attributes
  "2.1: objects have a substance, too, and a set of attributes that describe them."
  (with-scout (:clean t)
    (let ((box (put-beside 'box 4 0 :substance '(wood 7) :size 3 :weight 2 :obsview #t)))
      (is (equal '(wood 7) (get-attribute box :substance)))
      (is (= 7 (thing-substance-parameter box)))
      (loop for (key value) in '((:size 3) (:weight 2) (:obsview t))
            do (is (equal value (get-attribute box key)))))))

(test manual-2-1.attributes-can-be-sensed
  "2.1: a designator has the attributes that were asked about."
  (at-each-spot (:clean t)
    (put-beside 'box 4.5 1 :size 3 :weight 2 :color 'red)
    (let ((designator (look '((:size (0 9)) (:weight (0 9)) (:color (red blue))))))
      (loop for (key value) in '((:size 3) (:weight 2) (:color red))
            do (is (equal value (reading-of key designator)))))))

(test manual-2-1.kickers-move-objects
  "2.1: an object that has a kicker moves about now and then, others do not."
  (with-own-definitions ()
    (defkicker wander (thing) (:prob 1/4) (kick-thing thing 1/4 0 #f))
    (with-scout (:seed 1)
      (let ((mouse (put 'mouse '(5 5))) (stone (put 'stone '(5 5))))
        (set-kicker mouse 'wander)
        (run-ticks 60)
        (is (< 6 (thing-x mouse) 15))
        (is (= 5 (thing-x stone)))))))

;;; 2.2: the robot.

(test manual-2-2.turns-in-place-at-a-limited-rate
  "2.2: a turn leaves the robot where it is, and no tick turns it by more than the turn angle."
  (dolist (options '((:clean t) (:seed 2)))
    (at-each-spot (:clean (getf options :clean) :seed 2)
      (robot-turn scout 2)
      (let ((turns (loop repeat 20
                         collect (let ((before (robot-angle scout)))
                                   (run-ticks 1)
                                   (- (robot-angle scout) before)))))
        (is (near 2 (reduce #'+ turns) .03))
        (is (every (lambda (turn) (<= 0 turn .3031)) turns))
        (is (equalp spot (multiple-value-list (robot-position scout))))))))

(test manual-2-2.moves-forward-where-it-heads
  "2.2 and 3.2: the robot drives along (cos, sin) of any heading."
  (at-each-spot (:clean t)
    (dolist (heading '(0 1 2.5 -2 7))
      (place-robot scout (first spot) (second spot) heading)
      (answer 'robot-go-forward scout 5)
      (is (near (* 4 (cos heading)) (- (robot-x scout) (first spot)) 1d-6))
      (is (near (* 4 (sin heading)) (- (robot-y scout) (second spot)) 1d-6)))))

(test manual-2-2.movement-into-an-obstacle-is-an-error
  "2.2: there is no bump sensor, but the error :ROBOT-BLOCKED."
  (at-each-spot (:clean t)
    (put-beside 'crate 3 0 :obsmove #t)
    (is (eq :robot-blocked (end-code 'robot-go-forward scout 9)))
    (is (< 12.9 (robot-x scout) 13.01))))

(test manual-2-2.place-types-are-missed-sometimes
  "2.2 and 4, readings 106 and 221: of a doorway 0.05 of all readings are none."
  (with-scout (:seed 3)
    (place-robot scout 30 10 0)
    (let ((types (loop repeat 4000
                       collect (progn (robot-place scout)
                                      (run-ticks 1)
                                      (robot-last-place scout)))))
      (is (frequent-p (count nil types) 4000 .05))
      (is (= 4000 (+ (count nil types) (count 'doorway types)))))))

(test manual-2-2.place-types-are-imagined-sometimes
  "2.2 and 4: elsewhere 0.01 of all readings are some place type, any of the map's."
  (with-scout (:seed 4)
    (let ((types (loop repeat 8000
                       do (robot-place scout)
                          (run-ticks 1)
                       when (robot-last-place scout) collect it)))
      (is (frequent-p (length types) 8000 .01))
      (is (< 2 (length (remove-duplicates types)))))))

(test manual-2-2.places-are-designated-by-their-type
  "2.2: a place of the type that is asked for, if it is in the camera's field of view."
  (at-each-spot (:clean t)
    (let ((door (look-for-place 'doorway)))
      (is (eq :non-local (designator-type door)))
      (is (equal '(30.5d0 10.5d0) (multiple-value-list (designator-position door)))))
    (is (null (look-for-place 'beak)))
    (turned-to pi)
    (is (null (look-for-place 'doorway)))))

(test manual-2-2.objects-are-designated-by-a-description
  "2.2: of the objects in view, one that fits the partial description."
  (at-each-spot (:clean t)
    (put-beside 'cherry 5 0 :color 'red :size 1)
    (put-beside 'barrel 5 1 :color 'red :size 9)
    (put-beside 'plum 5 -1 :color 'blue :size 1)
    (dolist (case '((cherry (:color red) (:size 1)) (barrel (:size 9)) (plum (:color blue))))
      (is (equal (list (first case)) (names-of (list (look (rest case)))))))))

(test manual-2-2.one-of-those-that-match-is-chosen
  "2.2, reading 133: any of four balls is chosen as often as another."
  (with-scout (:clean t :seed 5)
    (let* ((balls (loop for dy in '(-2 -1 1 2) collect (put-beside 'ball 5 dy)))
           (chosen (look-often 4000 #'designator-denotation)))
      ;; 3 degrees of freedom, .001.
      (is (< (chi-square (loop for ball in balls collect (count ball chosen))
                         '(1000 1000 1000 1000))
             16.3)))))

(test manual-2-2.designators-may-denote-nothing
  "2.2, reading 135: as often as false-thing-prob* says where there is nothing to be seen."
  (with-scout (:seed 6)
    (let ((found (remove nil (look-often 8000 #'identity))))
      (is (frequent-p (length found) 8000 .01))
      (is (every #'null (mapcar #'designator-denotation found)))))
  (with-scout (:clean t)
    (is (zerop (find-count 500 '())))))

(test manual-2-2.only-local-designators-serve-to-manipulate
  "2.2: a hand grasps what is next to the robot by a local designator, nothing by another."
  (at-each-spot (:clean t)
    (put-beside 'near .5 0)
    (put-beside 'far 4 0)
    (loop for (hand type code) in '((0 :local nil) (1 :non-local :non-local-grasp))
          do (let ((designator (look '() :type type)))
               (answer 'camera-track (eye) designator)
               (is (eq code (end-code 'hand-grasp-desig (hand-of-scout hand) (eye)
                                      designator)))
               (answer 'camera-untrack (eye))))))

(test manual-2-2.only-non-local-designators-serve-to-approach
  "2.2: the robot can go to distant things; going to a local one ends with :GOTO-LOCAL."
  (dolist (case '((.5 :local :goto-local) (4 :non-local nil)))
    (destructuring-bind (dx type code) case
      (with-scout (:clean t)
        (place-robot scout 10.5 10.5 0)
        (put-beside 'ball dx 0)
        (tracking (record (look '() :type type))
          (is (eq code (end-code 'robot-goto-designator scout (eye)))))))))

(test manual-2-2.tracking-cameras-follow-what-moves
  "2.2: when an object moves, the camera that tracks it turns with it."
  (at-each-spot (:clean t)
    (let ((ball (put-beside 'ball 5 0)))
      (tracking (record (look '()))
        (loop for dy from .25 to 3 by .25
              do (move-thing ball (beside 5 dy))
                 (run-ticks 1)
                 (is (near (atan dy 5) (camera-angle (eye)) 1d-6)))
        (is (equal '(nil) (codes (record))))))))

(test manual-2-2.what-is-obscured-is-lost
  "2.2: a track ends when something that obstructs vision comes between."
  (at-each-spot (:clean t)
    (put-beside 'ball 8 0)
    (tracking (record (look '()))
      (put-beside 'glass 4 0 :obsview #f)
      (run-ticks 5)
      (is (equal '(nil) (codes (record))))
      (put-beside 'screen 4 0 :obsview #t)
      (run-ticks 1)
      (is (equal '(:lost-track) (codes (record)))))))

(test manual-2-2.tracks-are-lost-by-chance
  "2.2: of 200 tracks of an object at rest, most are lost by themselves within 200 ticks."
  (let ((lost (loop for seed below 200
                    count (with-scout (:seed seed :parameters *sure*)
                            (put-beside 'ball 5 0)
                            (tracking (record (look '()) :ticks 200)
                              (equal '(nil :lost-track) (codes (record))))))))
    ;; 4 ticks pass before a track begins, and 1 of 100 is lost in each of the others.
    (is (frequent-p lost 200 (- 1 (expt .99 196))))))

(test manual-2-2.views-sample-visible-surfaces
  "2.2: a view is a list of the substance parameters of what ends the camera's sight."
  (at-each-spot (:clean t)
    (put-beside 'screen 5 0 :obsview #t :substance 70)
    (let ((view (first (answer 'camera-view (eye 1)))))
      (is (= 3 (length view)))
      (is (= 70 (second view)))
      (is (= 30 (first view) (third view))))))

(test manual-2-2.hands-lift-as-much-as-they-are-strong
  "2.2, reading 151: weight counts, up to the strength; size does not."
  (loop for (hand weight size code) in '((0 10 99 nil) (0 10.1 1 :insufficient-strength)
                                         (1 4 1 nil) (1 5 1 :insufficient-strength))
        do (at-each-spot (:clean t)
             (put-beside 'ball .2 .1 :weight weight :size size)
             (let ((designator (look '() :type :local)))
               (answer 'camera-track (eye) designator)
               (is (eq code (end-code 'hand-grasp-desig (hand-of-scout hand) (eye)
                                      designator)))))))

(test manual-2-2.hands-get-at-what-is-inside
  "2.2: a hand in a container can grasp the things in it."
  (at-each-spot (:clean t)
    (let ((pen (put 'pen (put-beside 'box .3 0 :capacity 5) :size 1)))
      (tracking (record (look '((:capacity 5)) :type :local))
        (camera-track (eye 1) (camera-tracks (eye)))
        (run-ticks 5)
        (answer 'hand-insert (hand-of-scout) (camera-tracks (eye 1)))
        (answer 'camera-insert (eye) (camera-tracks (eye)))
        (tracking (record (look '() :type :local))
          (answer 'hand-grasp-desig (hand-of-scout) (eye) (camera-tracks (eye)))
          (is (eq pen (hand-holding (hand-of-scout)))))))))

(test manual-2-2.what-a-hand-holds-goes-along
  "2.2: objects are transported by carrying them in a hand."
  (at-each-spot (:clean t)
    (let ((ball (put 'ball (hand-of-scout) :weight 1)))
      (answer 'robot-go-forward scout 5)
      (is (equal (multiple-value-list (robot-position scout))
                 (multiple-value-list (thing-position ball)))))))

(test manual-2-2.closed-bins-keep-their-objects
  "2.2: objects kick themselves out of an open storage bin, not out of a closed one."
  (at-each-spot (:clean t)
    (let ((frog (put 'frog (bin-of-scout) :size 1)))
      (answer 'storage-bin-close (bin-of-scout))
      (is (null (kick-thing frog 1 0 #t)))
      (is (eq (bin-of-scout) (thing-location frog)))
      (answer 'storage-bin-open (bin-of-scout))
      (is-true (kick-thing frog 1 0 #t))
      (is (near (+ 1 (robot-x scout)) (thing-x frog))))))

;;; 2.3: time.

(test manual-2-3.time-is-a-sequence-of-ticks
  "2.3: ticks are numbered, and each lets a quantum of action take place."
  (with-scout (:clean t)
    (robot-go-forward scout 100)
    (run-ticks 5)
    (is (= 5 (simulation-tick)))
    (loop for tick from 6 to 20
          do (let ((x (robot-x scout)))
               (run-ticks 1)
               (is (= tick (simulation-tick)))
               (is (near .8d0 (- (robot-x scout) x)))))))

(test manual-2-3.calls-return-before-anything-happens
  "2.3: a command is only queued when it returns, without values; time does not pass meanwhile."
  (at-each-spot (:clean t)
    (recording (record)
      (is (null (multiple-value-list (robot-turn scout 1 (record :turn)))))
      (is (= 0 (simulation-tick) (robot-angle scout)))
      (is (null (record)))
      (run-ticks 20)
      (is (equal '(nil) (codes (record)))))))

(test manual-2-3.the-simulator-runs-beside-the-program
  "2.3: live, ticks pass while the program does something else; it need not ask for them."
  (simulator scout :rate :free :display nil)
  (robot-turn scout 1)
  (is-true (await-idle))
  (is (near 1 (robot-angle scout) .02))
  (is (<= 5 (simulation-tick))))
