;;;; trials.lisp -- for trials of plans: change the world before, check its true state afterwards.

;;; For experiments. Before a plan runs, a trial hides a thing or makes it move; afterwards it
;;; checks the true state. Plans use only DICE-FOR of this file. These dice depend on the world's
;;; seed, but are separate from the world's own. So the rolls of a plan change neither where things
;;; are hidden nor how they move, and all plans tried with the same seed have the same conditions.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun dice-for (purpose)
  "Return new dice, which depend only on PURPOSE, a symbol, and the seed of the current world."
  (ars-magna.base:make-dice (world-seed *world*) purpose))

;;; Before.

(defun clear-of-obstacles-p (map x y)
  "True if the cell of MAP at (X,Y) and its neighbours have no wall and nothing that blocks robots."
  (loop for dx from -1 to 1
        always (loop for dy from -1 to 1
                     always (and (no-wall-at-p map (+ x dx) (+ y dy))
                                 (notany #'thing-obsmove-p
                                         (things-at *world* (+ x dx) (+ y dy)))))))

(defun random-clear-point (dice)
  "Return the middle (x y) of a random cell of the current world that has no walls or obstacles
around. DICE choose the cell; all such cells are equally likely."
  (let ((map (ars-magna.world:world-map *world*)))
    (loop repeat 10000
          for x = (+ .5 (roll-index (map-width map) dice))
          for y = (+ .5 (roll-index (map-height map) dice))
          when (clear-of-obstacles-p map x y)
            return (list x y)
          finally (error "~A has hardly any cell without walls or obstacles around. Use a ~
                          wider map." map))))

(defun hide-thing (name descriptor)
  "Put a new thing NAME with the attributes of DESCRIPTOR on the floor of the current world,
away from walls and obstacles, and return it. NAME and the world's seed decide where the thing is."
  (make-new-thing name (cons *world* (random-clear-point (dice-for name))) descriptor))

(defun make-restless (thing probability)
  "Push THING .9 metres in a random direction, with PROBABILITY in each tick from now on. A
PROBABILITY of 0 ends the pushes."
  (if (plusp probability)
      (put-kicker be-pushed (it thing) (:prob probability) (take-step it (random-step .9)))
      (put-kicker be-pushed (it thing))))

;;; After. Plans must not use these.

(defun near-p (thing point &optional (distance 3))
  "True if THING is on the floor, less than DISTANCE metres from POINT, a list (x y)."
  (multiple-value-bind (x y) (thing-position thing)
    (and (eq :floor (thing-location thing))
         (< (apply #'vector-length (mapcar #'- point (list x y))) distance))))

(defun beside-p (robot thing)
  "True if THING is on the floor and local to ROBOT, so that ROBOT could grasp it."
  (multiple-value-bind (x y) (thing-position thing)
    (and (eq :floor (thing-location thing))
         (ars-magna.robot:within-reach-p robot x y))))
