;;;; world.lisp -- what changes during a run: one world per simulation.

(in-package :ars-magna.world)

(export '(world do-cell world-rank-count thing-of-rank do-things))

;;; A world is made fresh from its map's recipe. Nothing in it depends on anything but the map
;;; and the seed. Serial numbers count from 1 in order of creation, so that things in order of
;;; creation are things in order of serial number.

(addition world-p)
(define-kind (world :constructor (%make-world (map)))
    "Things, dice and kickers on a map, in the state that they have now."
  (:fixed
   (map nil map "the map that the world is of" :addition)
   (robots '() list "the list of the world's robots; the layer above keeps it" :part :addition)
   (kicker-generation 0 fixnum "which definitions of kickers its groups were made by" :export)
   (timeline nil t "the timeline of the world, once there is one; the layer above keeps it" :export)
   (move-watchers '() list
                  "the list of functions (thing old-location new-location) called after a thing has
moved, been made or been destroyed" :export))
  (:state
   (seed 0 integer "the integer that all chance in the world comes from" :addition)
   (flags (make-octets 0) octets
          "the flags of the world's cells by index: walls, and things on the floor" :export)
   (stock (make-stock) stock "its things, and which of them lie where on the floor" :part)
   (live-count 0 fixnum "how many things are alive in the world" :export)
   (next-serial 1 fixnum "the serial number of the next thing to be made")
   (dice-set #() simple-vector "a vector of the world's dice, one for each purpose" :part :export)
   (kicker-groups '() list "the groups of equal kickers" :part)
   (kicker-tick 0 tick-count "how many ticks kickers were run in")
   (due-kickers '() list "the kickers to run in the next tick because somebody asked for it" :part))
  (:scratch
   (noted-names '() list "the names of attributes that somebody has been warned of")
   (writer nil t "the thread that is changing the world, or NIL" :export))
  ;; As long as it is NIL, each tick looks.
  (:link
   (settled-p nil boolean "a tick has nothing to settle in the world: no robot has a designator, an
ended track, a part inside of something, a hand with two things in it or with a watched
grip" :export)))

(defmethod print-object ((world world) stream)
  (print-unreadable-object (world stream :identity t)
    (format stream "WORLD of ~A, ~D things" (map-name (world-map world))
            (world-live-count world))))

;;; Dice.

(define-constant +dice-purposes+
    '(:motion :odometry :place :looking :tracking :handling :kickers :manipulations :user)
  :test #'equal :documentation "What chance decides; each has dice of its own.")

(defmethod digest-state ((dice dice) digest)
  (digest-add digest (dice-state dice)))

(declaim (inline world-dice))
(addition world-dice)
(defun world-dice (world purpose)
  "Return the dice of WORLD for PURPOSE: :motion, :odometry, :place, :looking, :tracking,
:handling, :kickers, :manipulations or :user. Users roll those for :user, and only in what runs
within ticks: kickers, manipulations and events. What is rolled outside, as in continuations and
plans, is not repeated when a journal is replayed."
  (the dice (svref (world-dice-set world)
                   (ecase purpose
                     (:motion 0) (:odometry 1) (:place 2) (:looking 3) (:tracking 4)
                     (:handling 5) (:kickers 6) (:manipulations 7) (:user 8)))))

(addition *world*)
(defvar *world* nil
  "The world that code runs in: that of the current simulation, headless or live. NIL as long as
there is none; then each map's resident world counts.")

;;; Things.

(defmacro do-things ((thing world) &body body)
  "Run BODY with THING bound to each thing alive in WORLD, in order of creation. Things made
meanwhile are left out."
  `(call-with-things (lambda (,thing) ,@body) ,world))

(defun call-with-things (function world)
  (declare (type function function))
  (let* ((stock (world-stock world)) (things (stock-things stock)))
    (dotimes (rank (stock-count stock))
      (let ((thing (svref things rank)))
        (when (and thing (thing-alive-p thing)) (funcall function thing))))))

(defun world-rank-count (world)
  "Return how many ranks the things of WORLD have, those of some that were destroyed among them."
  (stock-count (world-stock world)))

(defun thing-of-rank (rank world)
  "Return the thing of WORLD that has RANK, or NIL if it has been destroyed."
  (svref (stock-things (world-stock world)) rank))

(addition world-thing-list)
(defun world-thing-list (world)
  "Return a fresh list of the things alive in WORLD, in order of creation."
  (loop for rank below (world-rank-count world)
        for thing = (thing-of-rank rank world)
        when thing collect thing))

(declaim (inline thing-index))
(defun thing-index (thing)
  "Return the index of the cell that THING, on the floor, lies in."
  (the cell-index (point-index (world-map (thing-world thing)) (thing-x thing) (thing-y thing))))

(defun remove-thing (thing world)
  "Forget THING; now and then, close the gaps that the destroyed have left."
  (let ((stock (world-stock world)))
    (setf (svref (stock-things stock) (thing-rank thing)) nil)
    (decf (world-live-count world))
    (when (> (stock-count stock) (+ 64 (* 2 (world-live-count world))))
      (close-gaps stock (lambda (other)
                          (and (eq :floor (thing-location other)) (thing-index other)))))))

(defmacro do-cell ((thing index world) &body body)
  "Run BODY with THING bound to each thing on the floor of the cell INDEX of WORLD, in order of
arrival. BODY moves none."
  (with-gensyms (visit)
    `(flet ((,visit (,thing) ,@body))
       (declare (inline ,visit))
       (call-with-cell #',visit ,index (world-stock ,world)))))

(addition things-at)
(defun things-at (world x y)
  "Return a fresh list of the things on the floor of the cell of WORLD that holds the point (X, Y),
in order of arrival. NIL outside the map. Signals WRONG-ARGUMENT."
  (check-argument things-at world (world-p world) "a world, as (robot-world ROBOT) returns")
  (check-point 'things-at x y)
  (let ((index (map-index (world-map world) x y)) (things '()))
    (when index
      (do-cell (thing index world) (push thing things)))
    (nreverse things)))
