;;;; check.lisp -- what must always hold of a world.

(in-package :ars-magna.world)

(defun thing-violation (world thing)
  "Return what is wrong with where THING is, a string, or NIL."
  (let ((location (thing-location thing)))
    (cond ((not (thing-alive-p thing)) (format nil "~A is dead but listed" thing))
          ((not (eq world (thing-world thing))) (format nil "~A is in another world" thing))
          ((null location) (format nil "~A is nowhere" thing))
          ((eq location :floor)
           (unless (= 1 (count thing (things-at world (thing-x thing) (thing-y thing))))
             (format nil "~A is not once in the list of its cell" thing)))
          ((/= 1 (count thing (location-contents location)))
           (format nil "~A is not once in ~A" thing (location-name location)))
          ((loop for outer = location then (thing-location outer)
                 repeat (1+ (world-live-count world))
                 always (thing-p outer))
           (format nil "~A contains itself" thing)))))

(defun cell-violations (world index)
  "Return what is wrong with the cell INDEX of WORLD, a list of strings."
  (let* ((things (cell-things index world))
         (flags (reduce #'logior (mapcar #'thing-flags things)
                        :initial-value (aref (map-flags (world-map world)) index))))
    (append (unless (= flags (aref (world-flags world) index))
              (list (format nil "cell ~D has flags ~D, not ~D"
                            index (aref (world-flags world) index) flags)))
            (loop for thing in things
                  unless (and (eq :floor (thing-location thing)) (= index (thing-index thing)))
                    collect (format nil "~A is in the list of cell ~D" thing index)))))

(defun world-invariant-violations (world)
  "Return a list of strings, one for each way in which WORLD contradicts itself: things in no
place or in several, in themselves, or missing from the index by cell, or flags that are wrong.
The answer should be NIL."
  (append (loop for thing in (world-thing-list world)
                for violation = (thing-violation world thing)
                when violation collect violation)
          (loop for thing in (world-thing-list world)
                append (loop for inside in (thing-contents thing)
                             unless (eq thing (thing-location inside))
                               collect (format nil "~A is listed in ~A" inside thing)))
          (unless (= (world-live-count world) (length (world-thing-list world)))
            (list "the count of things is wrong"))
          (loop for index below (length (world-flags world))
                append (cell-violations world index))))
