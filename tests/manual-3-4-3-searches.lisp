;;;; manual-3-4-3-searches.lisp -- section 3.4.3 of the manual: looking for places and objects.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-4-3)

(defparameter *searches*
  '((camera-get-place-designator doorway) (camera-get-all-place-designators doorway)
    (camera-get-object-designator :non-local ()) (camera-get-all-object-designators :non-local ()))
  "The four searches, with arguments by which they find something if it is there.")

(defun search-code (search)
  (apply #'end-code (first search) (eye) (rest search)))

(defmacro with-place-types (() &body body)
  "Run BODY where there are place types BURROW, which cannot be recognized at a distance, and NEST."
  `(with-own-definitions ()
     (def-place-type burrow (cell) :invisible t :checker (values #f 0 0 0))
     (def-place-type nest (cell) :checker (values #f 0 0 0))
     ,@body))

;;; Errors.

(test manual-3-4-3.already-tracking
  "3.4.3: each search of a camera that tracks something answers :ALREADY-TRACKING."
  (dolist (search *searches*)
    (at-each-spot (:clean t)
      (put-beside 'ball 5 0)
      (let ((ball (look '())))
        (answer 'camera-track (eye) ball)
        (is (eq :already-tracking (search-code search)))
        (is (eq ball (camera-tracks (eye))))
        (answer 'camera-untrack (eye))
        (is (null (search-code search)))))))

(test manual-3-4-3.place-searches-know-which-places-there-are
  "3.4.3: :INVALID-PLACE-TYPE is no type's name, :INVISIBLE-PLACE-TYPE not for the distance."
  (with-place-types ()
    (at-each-spot (:clean t)
      (loop for (type code) in '((door :invalid-place-type) (burrow :invisible-place-type)
                                 (nest :designator-not-found) (doorway nil))
            do (dolist (command '(camera-get-place-designator camera-get-all-place-designators))
                 (is (eq code (end-code command (eye) type)) "~A" type))))))

(test manual-3-4-3.camera-enclosed
  "3.4.3: from inside of something no places can be looked for."
  (dolist (search (subseq *searches* 0 2))
    (at-each-spot (:clean t)
      (answer 'camera-insert (eye) (bin-of-scout))
      (is (eq :camera-enclosed (search-code search))))))

(test manual-3-4-3.designator-not-found
  "3.4.3: if nothing is in view, each search ends with an error code and NIL."
  (dolist (search *searches*)
    (at-each-spot (:clean t)
      (turned-to (/ pi 2))
      (is (equal (list :designator-not-found (eye) nil)
                 (apply #'call-once (first search) (eye) (rest search)))))))

(test manual-3-4-3.errors-of-searches-come-in-this-order
  "3.4.3: the printed one, if several would do (reading 164)."
  (with-place-types ()
    (with-scout (:clean t)
      (let ((box (put-beside 'box 0 0 :capacity 5)))
        (put 'pen box)
        (answer 'camera-track (eye) (look '() :type :local))
        (answer 'camera-insert (eye) (camera-tracks (eye)))
        (flet ((code (type) (end-code 'camera-get-place-designator (eye) type)))
          (is (eq :invalid-place-type (code 'door)))
          (is (eq :invisible-place-type (code 'burrow)))
          (is (eq :camera-enclosed (code 'doorway)))
          (answer 'camera-track (eye) (look '() :type :local))
          (is (eq :already-tracking (code 'door))))))))

;;; Answers.

(test manual-3-4-3.one-designator-or-a-list
  "3.4.3: one search answers with a designator, the other with the list of all found."
  (at-each-spot (:clean t)
    (put-beside 'ball 5 1)
    (put-beside 'cube 5 -1)
    (is (typep (look '()) 'designator))
    (is (equal '(ball cube) (names-of (look-for-all '()))))
    (is (typep (look-for-place 'concave) 'designator))
    (let ((corners (first (answer 'camera-get-all-place-designators (eye) 'concave))))
      (is (= 2 (length corners)))
      (is (every #'designator-p corners)))))

(test manual-3-4-3.places-are-non-local
  "3.4.3: place designators always are; the robot's own place is not found (reading 131)."
  (with-scout (:clean t)
    (loop for x in '(10.5 29.5 29.98)
          do (place-robot scout x 10.5 0)
             (is (eq :non-local (designator-type (look-for-place 'doorway)))))
    (place-robot scout 30.5 10.5 0)
    (is (null (look-for-place 'doorway)))))

(test manual-3-4-3.desig-type-says-where
  "3.4.3, reading 131: :local finds only local things, :non-local only the others."
  (at-each-spot (:clean t)
    (put-beside 'here 0 0)
    (put-beside 'near .4 .02)
    (put-beside 'far 3 1)
    (is (equal '(here near) (seen :type :local)))
    (is (equal '(far) (seen :type :non-local)))
    (signals wrong-argument (camera-get-object-designator (eye) :remote '()))))

(test manual-3-4-3.all-matching-objects-take-longer
  "3.4.3, reading 134: a tick more for each designator after the first."
  (loop for count in '(1 2 5)
        do (at-each-spot (:clean t)
             (loop for dy from -2 repeat count do (put-beside 'ball 5 dy))
             (is (= (+ 3 count)
                    (first (first (call-times 20 'camera-get-all-object-designators
                                              (eye) :non-local '()))))))))

(test manual-3-4-3.what-moves-meanwhile-is-left-out
  "3.4.3: only findings that are still there get a designator."
  (at-each-spot (:clean t)
    (let ((mouse (put-beside 'mouse 5 0)))
      (put-beside 'ball 5 1)
      (recording (record)
        (camera-get-all-object-designators (eye) :non-local '() (record :all))
        (run-ticks 4)
        (move-thing mouse (beside 5 -1))
        (run-ticks 9)
        (is (equal '(ball) (names-of (fourth (first (record))))))))))

;;; What is seen: reading 130.

(test manual-3-4-3.sight-ends-at-walls
  "Reading 130: nothing behind a wall is found, but what stands in the gap of it is."
  (with-scout (:clean t)
    (place-robot scout 26.5 10.5 0)
    (put 'behind '(34.5 14.5))
    (put 'through '(34.5 10.5))
    (is (equal '(through) (seen)))))

(test manual-3-4-3.what-obstructs-is-seen-with-its-cell
  "Reading 130: sight goes up to and with the first cell that blocks it."
  (at-each-spot (:clean t)
    (put '|screen| '(15.2 10.2) :obsview #t)
    (put 'cell-mate '(15.9 10.9))
    (put 'hidden '(17.5 10.5))
    (is (equal '(cell-mate |screen|) (seen :camera (eye 1))))))

(test manual-3-4-3.what-is-where-the-camera-is-hides-nothing
  "Reading 130: it is always in view, also behind the camera, and obstructs nothing."
  (at-each-spot (:clean t)
    (put-beside 'ball 5 0)
    (put '|screen| '(10.01 10.99) :obsview #t)
    (is (equal '(ball) (seen)))
    (is (equal '(|screen|) (seen :type :local)))
    (turned-to pi)
    (is (equal '(|screen|) (seen :type :local)))))

(test manual-3-4-3.scan-density-says-how-many-rays
  "4, reading 130: with one ray, in the middle of the field of view, only what that meets is seen."
  (with-scout (:clean t :parameters '((scan-density* 1)))
    (place-robot scout 10.5 10.5 0)
    (put-beside 'ball 6 0)
    (put-beside 'cube 6 3)
    (is (equal '(ball) (seen)))
    (setf scan-density* 50)
    (is (equal '(ball cube) (seen)))))

(test manual-3-4-3.contents-are-invisible-from-outside
  "Reading 132: and a thing in a hand is where the hand is."
  (at-each-spot (:clean t)
    (let ((box (put-beside 'box .2 0 :capacity 5)))
      (put 'pen box)
      (put 'ball (hand-of-scout) :size 1)
      (is (equal '(ball box) (seen :type :local)))
      (let ((designator (look '((:capacity 5)) :type :local)))
        (answer 'hand-insert (hand-of-scout) designator)
        (is (equal '(box) (seen :type :local)))
        (answer 'camera-track (eye) designator)
        (answer 'camera-insert (eye) designator)
        (is (equal '(ball pen) (seen :type :local)))))))

;;; Misses and hallucinations.

(test manual-3-4-3.things-are-missed
  "3.4.3 and 4, reading 129: miss-thing-prob*, 0.05, for each thing and search."
  (with-scout (:seed 28 :parameters '((false-thing-prob* 0)))
    (put-beside 'ball 5 0)
    (is (frequent-p (find-count 2000 '()) 2000 .95))))

(test manual-3-4-3.lists-miss-each-thing-by-itself
  "3.4.3: two things are missed independently; so both are seen in 0.95 squared of searches."
  (with-scout (:seed 29 :parameters '((false-thing-prob* 0) (camera-desig-delay* 0)))
    (put-beside 'ball 5 1)
    (put-beside 'cube 5 -1)
    (let ((counts (loop repeat 1500
                        collect (let ((count 0))
                                  (camera-get-all-object-designators
                                   (eye) :non-local '()
                                   (continuation (err camera found)
                                     (setf count (length found))))
                                  (run-ticks 2)
                                  count))))
      (is (frequent-p (count 2 counts) 1500 (* .95 .95)))
      (is (frequent-p (count 1 counts) 1500 (* 2 .95 .05))))))

(defun place-finds (trials type)
  "Return what TRIALS searches for a place of TYPE find: designators and NIL."
  (let ((camera-desig-delay* 0) (found '()))
    (loop repeat trials
          do (camera-get-place-designator (eye) type
               (continuation (err camera designator) (push designator found)))
             (run-ticks 1))
    found))

(test manual-3-4-3.places-are-missed
  "3.4.3 and 4: miss-place-prob*, 0.1; the doorway is imagined, too, in 0.05 of all searches."
  (with-scout (:seed 30)
    (let ((missing (count nil (place-finds 3000 'doorway))))
      (is (frequent-p missing 3000 (* .1 .95))))))

(test manual-3-4-3.places-are-imagined-by-their-confusion
  "3.4.3 and 5.1.1, reading 74: where there is no such place, as often as :confusion says."
  (with-own-definitions ()
    (def-place-type mirage (cell) :confusion 1/4 :checker (values #f 0 0 0))
    (with-scout (:seed 31)
      (turned-to pi)
      (loop for (type probability) in '((mirage .25) (doorway .05) (convex .03))
            for found = (remove nil (place-finds 2000 type))
            do (is (frequent-p (length found) 2000 probability) "~A" type)
               (is (every #'null (mapcar #'designator-denotation found)))
               (is (every (lambda (found) (equal (list type) !>found.data)) found))))))

(test manual-3-4-3.objects-are-imagined
  "3.4.3, reading 135: false-thing-prob*, 0.01, for local and non-local ones."
  (dolist (type '(:local :non-local))
    (with-scout (:seed 32)
      (is (frequent-p (find-count 4000 '((:size 4)) :type type) 4000 .01)))))

(test manual-3-4-3.lists-may-have-bogus-designators
  "3.4.3: among real ones; after each success of false-thing-prob* it is tried again."
  (with-scout (:seed 33 :parameters '((miss-thing-prob* 0) (false-thing-prob* 1/2)))
    (put-beside 'ball 5 0)
    (let ((lists (loop repeat 200 collect (look-for-all '()))))
      (is (every (lambda (found) (= 1 (count 'ball (remove nil (mapcar #'designator-denotation
                                                                       found))
                                             :key #'thing-name)))
                 lists))
      (is (frequent-p (count 1 lists :key #'length) 200 .5))
      (is (frequent-p (count 2 lists :key #'length) 200 .25)))))

(test manual-3-4-3.lists-may-have-several-false-places
  "3.4.3, reading 74: after each success of :confusion it is tried again."
  (with-own-definitions ()
    (def-place-type mirage (cell) :confusion 1/2 :checker (values #f 0 0 0))
    (with-scout (:seed 46)
      (let ((counts (loop repeat 400
                          collect (length (third (call-once 'camera-get-all-place-designators
                                                            (eye) 'mirage))))))
        (loop for count from 0 to 3
              do (is (frequent-p (count count counts) 400 (expt .5 (1+ count)))))))))

(defun imagined-points (trials &optional (x 10.5) (y 10.5))
  "Return where TRIALS false designators lie, as (dx dy) from (X,Y), where SCOUT stands."
  (place-robot scout x y 0)
  (look-often trials (lambda (found)
                       (multiple-value-bind (at-x at-y) (designator-position found)
                         (list (- at-x x) (- at-y y))))))

(test manual-3-4-3.false-designators-lie-anywhere-in-the-field-of-view
  "4: a random angle in the field of view is chosen."
  (with-scout (:seed 34 :parameters '((false-thing-prob* 1)))
    (is (same-distribution-p (loop for (dx dy) in (imagined-points 2000) collect (atan dy dx))
                             (uniform (/ pi -4) (/ pi 4))))))

(test manual-3-4-3.false-designators-lie-where-a-walk-stops
  "4, reading 136: with prob-stop*, 0.07, after each metre, whatever walls there are, or at the
edge of the map, which is at least 10 metres away here."
  (with-scout (:seed 35 :parameters '((false-thing-prob* 1)))
    (let ((metres (loop for (dx dy) in (imagined-points 2000) collect (norm (make PT dx dy)))))
      (loop for metre from 1 to 9
            do (is (frequent-p (count-if (lambda (m) (near m metre 1d-6)) metres)
                               2000 (* .07 (expt .93 (1- metre))))))
      (is (find-if (lambda (m) (< 20 m)) metres)))))

(test manual-3-4-3.false-local-designators-lie-where-the-robot-is
  "Reading 137: and they are good for nothing."
  (at-each-spot (:seed 36 :parameters '((false-thing-prob* 1) (prob-lose-false-track* 0)))
    (let ((found (look '() :type :local)))
      (is (equal (multiple-value-list (robot-position scout))
                 (multiple-value-list (designator-position found))))
      (answer 'camera-track (eye) found)
      (is (eq :missed-grasp (end-code 'hand-grasp-desig (hand-of-scout) (eye) found)))
      (is (eq :camera-bump (end-code 'camera-insert (eye) found))))))
