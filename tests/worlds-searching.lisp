;;;; worlds-searching.lisp -- three ways of searching, and hiding the thing to search for.

(in-package :ars-magna.tests)

(def-suite* searching :in ars-magna)

(defparameter *ways-of-searching*
  '(ars-worlds:search-by-chance ars-worlds:search-nearest ars-worlds:search-watchfully))

(defparameter *vase* '((:color world:violet) (:substance glass))
  "What nothing else in WATSON looks like.")

(defun hide-vase ()
  (ars-worlds:hide-thing 'vase (append '((:size 1) (:weight 1)) *vase*)))

(defun search-in-watson (way seed &key clean)
  "Let ROBBIE search for a hidden vase. Return whether it really stands beside it and its plan has
succeeded, the ticks that took, the plan's value, and a digest."
  (run:with-simulation (ars-worlds:robbie :seed seed :clean clean)
    (let ((vase (hide-vase)))
      (multiple-value-bind (value state)
          (driver:run-plan way *vase* ars-worlds:watson-lookouts*)
        (values (and (eq :succeeded state) (ars-worlds:beside-p ars-worlds:robbie vase))
                (run:simulation-tick) value (run:state-digest))))))

(defvar *searches* (make-hash-table :test #'equal) "What SEARCH-IN-WATSON has returned, as lists.")

(defun known-search (way seed clean)
  "Return what SEARCH-IN-WATSON returns, of which several tests ask."
  (let ((key (list way seed clean)))
    (values-list (or (gethash key *searches*)
                     (setf (gethash key *searches*)
                           (multiple-value-list (search-in-watson way seed :clean clean)))))))

(defun times-found (way seeds &key clean)
  "Return for how many SEEDS, from 0, WAY finds the vase, and the ticks of all together."
  (loop with ticks = 0
        for seed below seeds
        count (multiple-value-bind (found took) (known-search way seed clean)
                (incf ticks took)
                found)
          into found
        finally (return (values found ticks))))

;;; Hiding.

(defun hidden-at (seed &key (name 'vase))
  (run:with-simulation (ars-worlds:robbie :seed seed)
    (multiple-value-list (world:thing-position (ars-worlds:hide-thing name '((:size 1)))))))

(test hide-thing.depends-on-seed-and-name
  (is (equal (hidden-at 5) (hidden-at 5)))
  (is (not (equal (hidden-at 5) (hidden-at 6))))
  (is (not (equal (hidden-at 5) (hidden-at 5 :name 'marble))))
  (is (< 150 (length (remove-duplicates (loop for seed below 200 collect (hidden-at seed))
                                        :test #'equal)))))

(test hide-thing.rolls-no-dice-of-the-world
  (run:with-simulation (ars-worlds:robbie :seed 5)
    (flet ((states ()
             (cl:map 'list #'base:dice-state (world:world-dice-set world:*world*))))
      (let ((before (states)))
        (hide-vase)
        (is (equal before (states)))))))

(defun floor-in-the-open (map)
  "Return the middles of the cells of MAP in which things may be hidden."
  (loop for x from .5d0 below (world:map-width map)
        append (loop for y from .5d0 below (world:map-height map)
                     when (ars-worlds::clear-of-obstacles-p map x y)
                       collect (list x y))))

(test hide-thing.keeps-away-from-walls-and-furniture
  (run:with-simulation (ars-worlds:robbie)
    (let ((open (floor-in-the-open ars-worlds:watson)))
      (flet ((beside-a-barrier-p (point)
               (loop for (dx dy) in '((-1 0) (1 0) (0 -1) (0 1))
                     thereis (barred-p world:*world*
                                       (world:map-index ars-worlds:watson
                                                        (floor (+ (first point) dx))
                                                        (floor (+ (second point) dy)))))))
        (is (< 300 (length open)))
        (is (null (remove-if-not #'beside-a-barrier-p open)))))))

;;; Three cells each way, walls and all.
(world:defmap closet (3 3)
  (rect (0 0) (2 2) stone 1))
(robot:defrobot recluse (closet (1.5 1.5) 0))

(test hide-thing.says-where-there-is-no-room
  (run:with-simulation (recluse)
    (signals error (hide-vase))))

(test watson-lookouts.overlook-the-floor
  (run:with-simulation (ars-worlds:robbie)
    (flet ((overlooked-p (point)
             (loop for (x y) in ars-worlds:watson-lookouts*
                   thereis (robot:in-sight-p world:*world* (base:double x) (base:double y)
                                             (first point) (second point)))))
      (is (null (remove-if #'overlooked-p (floor-in-the-open ars-worlds:watson)))))))

;;; Searching.

(test searching.finds-the-thing-wherever-it-is
  (dolist (way *ways-of-searching*)
    (is (= 20 (times-found way 20 :clean t)) "~A" way)))

(test searching.finds-it-in-spite-of-noise
  (dolist (way *ways-of-searching*)
    (is (<= 19 (times-found way 20)) "~A" way)))

(defun ticks-by-way (&key clean)
  "Return the ticks that the ways of searching take for 30 seeds, one after the other."
  (loop for way in *ways-of-searching*
        collect (nth-value 1 (times-found way 30 :clean clean))))

(test searching.is-sooner-over-with-memory-and-open-eyes
  "Who sees well gains by remembering; who sees badly, by looking more often."
  (destructuring-bind (by-chance nearest watchfully) (ticks-by-way :clean t)
    (is (> by-chance (* 1.8 nearest)))
    (is (> nearest watchfully)))
  (destructuring-bind (by-chance nearest watchfully) (ticks-by-way)
    (is (> by-chance (* 1.1 nearest)))
    (is (> nearest (* 1.6 watchfully)))))

(test searching.says-how-far-it-drove
  (multiple-value-bind (found ticks driven) (search-in-watson 'ars-worlds:search-nearest 3 :clean t)
    (is-true found)
    (is (< 10 driven ticks))))

(test searching.is-decided-by-the-seed
  (dolist (way *ways-of-searching*)
    (flet ((digest (seed) (nth-value 3 (search-in-watson way seed))))
      (is (= (digest 21) (digest 21)) "~A" way)
      (is (/= (digest 21) (digest 22)) "~A" way))))

(test searching.gives-up-where-there-is-nothing
  (loop for way in '(ars-worlds:search-by-chance ars-worlds:search-nearest)
        do (run:with-simulation (ars-worlds:dot :clean t)
             (is (eq :not-found (failure-class-of way *vase* '((3 4) (8 4)) :rounds 2)))
             (is (< 50 (run:simulation-tick) 500)))))

(test searching.watchfully-takes-two-cameras
  (run:with-simulation (ars-worlds:dot :clean t)
    (is (eq :only-one-camera (failure-class-of 'ars-worlds:search-watchfully *vase* '((3 4)))))))

;;; What else trials need.

(test make-restless.lets-a-thing-be-pushed-until-it-is-told-not-to
  (run:with-simulation (ars-worlds:dot :seed 1)
    (let ((vase (hide-vase)))
      (flet ((moved-p ()
               (let ((before (multiple-value-list (world:thing-position vase))))
                 (run:run-ticks 100)
                 (not (equal before (multiple-value-list (world:thing-position vase)))))))
        (is (not (moved-p)))
        (ars-worlds:make-restless vase .5)
        (is (moved-p))
        (ars-worlds:make-restless vase 0)
        (is (not (moved-p)))))))

(test near-p.asks-for-the-floor-and-the-distance
  (run:with-simulation (ars-worlds:dot)
    (let ((vase (world:make-new-thing 'vase '(ars-worlds:tiny 5 5) '((:size 1)))))
      (is-true (ars-worlds:near-p vase '(5 7)))
      (is-false (ars-worlds:near-p vase '(5 8)))
      (is-true (ars-worlds:near-p vase '(5 8) 4))
      (world:move-thing vase (world:find-thing 'box))
      (is-false (ars-worlds:near-p vase '(5 5))))))

;;; Sharing a robot.

(test patrol.parts-of-an-owner-have-the-robot-one-after-the-other
  "Two patrols side by side, of a plan that owns the robot itself."
  (let ((base:*message-queue* (base:make-message-queue)))
    (run:with-simulation (ars-worlds:dot :seed 1 :clean t)
      (let ((way '((5.5 5.5) (3.5 6.5))))
        (is (eql 2 (driver:run-plan
                    (rpl:interp-lambda ()
                      (rpl:with-valve ((driver:rpl-robot-valve))
                        (rpl:par (ars-worlds:patrol-places way :start '(3.5 6.5 0))
                                 (ars-worlds:patrol-places way :start '(3.5 6.5 0)))))))))
      (is (null (remove :message (base:take-messages) :key #'base:message-kind))))))
