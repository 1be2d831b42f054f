;;;; trials.lisp -- what trials of plans begin and end with: a thing is hidden; the truth about it.

;;; Good for experiments: a trial makes its world other or harder before it runs a plan, and asks
;;; afterwards what has really become of things. Plans use none of this but DICE-FOR: dice that
;;; depend on the world's seed, yet are not the world's. What one plan draws changes neither where
;;; things are hidden nor how they move: plans that are tried with the same seed have the same luck.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun dice-for (purpose)
  "Return new dice for PURPOSE, a symbol, which depend on it and on the seed of the world that is
being run, and on nothing else."
  (ars-magna.base:make-dice (world-seed *world*) purpose))

;;; Before.

(defun in-the-open-p (map x y)
  "True if no wall of MAP, and nothing that blocks robots, is in the cell at (X,Y) or next to it."
  (loop for dx from -1 to 1
        always (loop for dy from -1 to 1
                     always (and (free-p map (+ x dx) (+ y dy))
                                 (notany #'thing-obsmove-p
                                         (things-at *world* (+ x dx) (+ y dy)))))))

(defun point-in-the-open (dice)
  "Return the middle of a cell of the world that is being run, a list (x y): one in the open, as
DICE say, each as likely as another."
  (let ((map (ars-magna.world:world-map *world*)))
    (loop repeat 10000
          for x = (+ .5 (roll-index (map-width map) dice))
          for y = (+ .5 (roll-index (map-height map) dice))
          when (in-the-open-p map x y)
            return (list x y)
          finally (error "~A has hardly a cell in the open. Take a wider map." map))))

(defun hide-thing (name descriptor)
  "Put a new thing NAME with the attributes of DESCRIPTOR on the floor of the world that is being
run, anywhere in the open, and return it. NAME and the world's seed decide where."
  (make-new-thing name (cons *world* (point-in-the-open (dice-for name))) descriptor))

(defun make-restless (thing probability)
  "Let THING be pushed about from now on: nearly a metre in any direction, with PROBABILITY in each
tick; with 0 no longer."
  (if (plusp probability)
      (put-kicker be-pushed (it thing) (:prob probability) (take-step it (random-step .9)))
      (put-kicker be-pushed (it thing))))

;;; After. No plan may know this.

(defun near-p (thing point &optional (distance 3))
  "True if THING lies on the floor, less than DISTANCE metres from POINT, a list (x y)."
  (multiple-value-bind (x y) (thing-position thing)
    (and (eq :floor (thing-location thing))
         (< (apply #'length-of (mapcar #'- point (list x y))) distance))))

(defun beside-p (robot thing)
  "True if THING lies on the floor and is local to ROBOT, which could grasp it."
  (multiple-value-bind (x y) (thing-position thing)
    (and (eq :floor (thing-location thing))
         (ars-magna.robot:within-reach-p robot x y))))
