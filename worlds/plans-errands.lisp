;;;; plans-errands.lisp -- whole errands: fetching things, tidying rooms.

;;; Run them as they are, or call them in plans of your own:
;;;
;;;   (with-simulation (ars-worlds:marvin :seed 1)
;;;     (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((108.5 24.5))))
;;;
;;; The plans use the map, the robot's start and the places to look at, but not the positions of
;;; things. One errand at a time uses the robot. The next waits until that one has cleaned up.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-proc find-and-take (me places description &key (camera (widest-camera)) (hand 0) (bin 0)
                                                           (rounds 12))
  "Visit PLACES, points of the map, in turn, at most ROUNDS times. Stow in BIN the first thing found
that fits DESCRIPTION. ME is the robot's reckoning. Return true. Fails with :NOT-FOUND."
  (let ((taken nil))
    (n-times rounds UNTIL taken
      (dolist (place places)
        (handle-failure (((or :cannot-get-there :not-found :lost-grip :will-not-do) ()
                          (return nil)))
          (travel-to me place)
          (let ((designator (visit-things me camera description)))
            (if designator
                (seq (take-thing hand camera bin description :designator designator)
                     (setf taken t)))))
        (if taken (return nil))))
    (if (not taken)
        (fail :class :not-found :description description :places places))
    taken))

(def-interp-proc bring-thing (me places description home camera hand bin)
  "Do one attempt of FETCH-THING. Fails with :NOTHING-INSIDE if the thing got lost on the way."
  (if (not (stowed-p camera bin description))
      (find-and-take me places description :camera camera :hand hand :bin bin))
  (travel-to me home :tolerance .7 :patience 100)
  (put-thing-down hand camera bin))

(def-interp-proc fetch-thing (description places
                              &key start (camera (widest-camera)) (hand 0) (bin 0))
  "Find a thing that fits DESCRIPTION at PLACES, points of the map, stow it in BIN, return to START
and put the thing on the floor there. START is the robot's position, a list (x y heading); the
default is the true position. If the thing is in the hand or in BIN already, because an earlier
errand was interrupted, the robot brings that thing. Return the estimated position at the end, a
point. Fails with :NOT-FOUND, :TOO-HEAVY, :BIN-FULL or :CANNOT-GET-THERE."
  (check-points 'fetch-thing 'places places)
  (with-valve ((rpl-robot-valve))
    (let* ((start (or start (here (rpl-robot))))
           (me (begin-reckoning start))
           (home (list (first start) (second start))))
      (free-hand hand bin)
      (with-retry-counters ((losses 2))
        (handle-failure ((:nothing-inside () (do-retry losses (retry))))
          (bring-thing me places description home camera hand bin)))
      (reckon me))))

;;; Tidying.

(def-interp-proc tidy-once (me places description camera hand bin)
  "Find a thing near PLACES that fits DESCRIPTION and stow it in BIN. Return true if it was found."
  (handle-failure ((:not-found () (return nil)))
    (find-and-take me places description :camera camera :hand hand :bin bin :rounds 5)))

(def-interp-proc tidy-room (descriptions places
                            &key start (camera (widest-camera)) (hand 0) (limit 20))
  "Collect things near PLACES, points of the map. Things that fit the first of DESCRIPTIONS go into
the first storage bin, and so on. START is the robot's position, a list (x y heading); the default
is the true position. The robot first drops what it holds. It stops after LIMIT things, or after a
whole round without a thing. The robot searches again for things kicked about meanwhile. Return how
many things were stowed."
  (check-points 'tidy-room 'places places)
  (with-valve ((rpl-robot-valve))
    (let ((me (begin-reckoning (or start (here (rpl-robot)))))
          (count 0)
          (found t))
      (free-hand hand nil)
      (loop WHILE (and found (< count limit))
        (setf found nil)
        (let ((bin 0))
          (dolist (description descriptions)
            (handle-failure (((or :bin-full :too-heavy) () (return nil)))
              (if (tidy-once me places description camera hand bin)
                  (seq (incf count)
                       (setf found t))))
            (incf bin))))
      count)))
