;;;; plans-errands.lisp -- whole errands: fetching things, tidying rooms.

;;; Good for a first look at what plans can do, and as parts of others:
;;;
;;;   (with-simulation (ars-worlds:marvin :seed 1)
;;;     (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((108.5 24.5))))
;;;
;;; A robot knows its map, where it starts, and where to look; not where things are. One errand at a
;;; time has the robot; the next waits until that is over, and has cleaned up if it was ended.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-proc find-and-take (me places description &key (camera (widest-camera)) (hand 0) (bin 0)
                                                           (rounds 12))
  "Let the robot of the reckoning ME look at PLACES, points of its map, in turn, ROUNDS times at
most, for a thing that fits DESCRIPTION, and stow the first it finds in BIN. Fails with :NOT-FOUND."
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
  "Fetch a thing as FETCH-THING does, once. Fails with :NOTHING-INSIDE if it got lost on the way."
  (if (not (stowed-p camera bin description))
      (find-and-take me places description :camera camera :hand hand :bin bin))
  (travel-to me home :tolerance .7 :patience 100)
  (put-thing-down hand camera bin))

(def-interp-proc fetch-thing (description places
                              &key start (camera (widest-camera)) (hand 0) (bin 0))
  "Let the robot look at PLACES, points of its map, for a thing that fits DESCRIPTION, stow it in
BIN, come back to START and put it on the floor. START is where the robot is, a list (x y heading);
by default it finds that out. Such a thing that it has in its hand or BIN already, as when an
errand was ended and is started again, it brings at once. Return the point where it believes to be
then. Fails with :NOT-FOUND, :TOO-HEAVY, :BIN-FULL or :CANNOT-GET-THERE."
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
  "Stow one thing that fits DESCRIPTION and is near one of PLACES in BIN. True if there was any."
  (handle-failure ((:not-found () (return nil)))
    (find-and-take me places description :camera camera :hand hand :bin bin :rounds 5)))

(def-interp-proc tidy-room (descriptions places
                            &key start (camera (widest-camera)) (hand 0) (limit 20))
  "Let the robot collect what lies about near PLACES, points of its map: things that fit the first
of DESCRIPTIONS into its first storage bin, and so on. START is where the robot is, a list (x y
heading); by default it finds that out. What it has in its hand it drops. It goes on, up to LIMIT
things, until it has seen none for a whole round; what is kicked about meanwhile is looked for anew.
Return how many things it has stowed."
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
