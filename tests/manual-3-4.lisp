;;;; manual-3-4.lisp -- sections 3.4 and 3.4.1 of the manual: cameras and designators.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-3-4-1 :in ars-magna)

;;; 3.4: cameras.

(test manual-3-4.cameras-are-ordered
  "3.4: robot-camera returns them by an index from 0, in the order of the definition."
  (with-scout ()
    (is (near (/ pi 2) (camera-field-of-view (robot-camera scout 0))))
    (is (near (/ pi 4) (camera-field-of-view (robot-camera scout 1))))
    (is (= 1 (camera-index (robot-camera scout 1))))
    (dolist (index '(2 -1 1/2 nil))
      (signals wrong-argument (robot-camera scout index)))))

(test manual-3-4.the-field-of-view-is-a-wedge
  "3.4: around the direction of the camera; things to the side of it are not seen."
  (flet ((seen-at (angle camera)
           (put-beside 'ball (* 8 (cos angle)) (* 8 (sin angle)))
           (prog1 (and (look '() :camera camera) t)
             (destroy-thing (find-thing 'ball)))))
    (at-each-spot (:clean t)
      ;; Things are seen by their cells, which are up to 10 degrees wide here.
      (loop for (degrees wide narrow) in '((0 t t) (14 t t) (-14 t t) (33 t nil) (-33 t nil)
                                           (57 nil nil) (-57 nil nil) (180 nil nil))
            for angle = (* degrees (/ pi 180))
            do (is (eq wide (seen-at angle (eye 0))) "~D" degrees)
               (is (eq narrow (seen-at angle (eye 1))) "~D" degrees)))))

(test manual-3-4.the-wedge-turns-with-camera-and-robot
  "3.4, reading 145: a camera's direction is relative to the robot's."
  (at-each-spot (:clean t)
    (put-beside 'ahead 6 0)
    (put-beside 'right 0 6)
    (is (equal '(ahead) (seen)))
    (answer 'camera-turn (eye) (/ pi 2))
    (is (equal '(right) (seen)))
    (answer 'robot-turn scout (/ pi -2))
    (is (equal '(ahead) (seen)))))

(test manual-3-4.the-resolution-is-the-number-of-pixels
  "3.4: of any view."
  (at-each-spot (:seed 1)
    (loop for (camera pixels) in '((0 5) (1 3))
          do (is (= pixels (camera-resolution (eye camera))
                    (length (first (answer 'camera-view (eye camera)))))))))

(test manual-3-4.cameras-move-independently
  "3.4: turning or inserting one camera does not affect the other."
  (at-each-spot (:clean t)
    (answer 'camera-turn (eye 0) 1)
    (answer 'camera-insert (eye 0) (bin-of-scout))
    (is (= 0 (camera-angle (eye 1))))
    (is (null (camera-location (eye 1))))
    (is (= 1 (camera-angle (eye 0))))
    (is (eq (bin-of-scout) (camera-location (eye 0))))))

(test manual-3-4.cameras-look-inside-objects
  "3.4: a camera in a container sees only its direct contents."
  (at-each-spot (:clean t)
    (let ((box (put-beside 'box .2 0 :capacity 9)))
      (put 'pen box)
      (put 'nib (put 'case box :capacity 3))
      (put-beside 'ball .1 .1)
      (is (equal '(ball box) (seen :type :local)))
      (tracking (record (look '((:capacity 9)) :type :local))
        (answer 'camera-insert (eye) (camera-tracks (eye)))
        (is (equal '(case pen) (seen :type :local)))
        (is (equal '() (seen)))))))

(test manual-3-4.cameras-may-turn-inside
  "Reading 145: also one that is in a storage bin."
  (at-each-spot (:clean t)
    (answer 'camera-insert (eye) (bin-of-scout))
    (is (= 2 (first (answer 'camera-turn (eye) 2)) (camera-angle (eye))))))

;;; 3.4.1: designators.

(test manual-3-4-1.there-are-two-types
  "3.4.1, reading 227: the slot type is the keyword :local or :non-local."
  (at-each-spot (:clean t)
    (put-beside 'near .4 0)
    (put-beside 'far 4 0)
    (loop for (type name) in '((:local near) (:non-local far))
          for designator = (look '() :type type)
          do (is (eq type !>designator.type))
             (is (typep designator 'designator))
             (is (eq name (thing-name (designator-denotation designator)))))))

(test manual-3-4-1.the-angle-is-relative-to-the-heading
  "3.4.1, reading 138: the direction, counted from where the robot heads and not the camera."
  (dolist (heading '(0 .5 -3))
    (dolist (camera-angle '(0 .3 -.4))
      (at-each-spot (:clean t)
        (turned-to heading)
        (let ((bearing (+ heading .2d0)))
          (put-beside 'ball (* 6 (cos bearing)) (* 6 (sin bearing)))
          (answer 'camera-turn (eye) camera-angle)
          (let ((designator (look '())))
            (is (near .2d0 !>designator.angle 1d-6))))))))

(test manual-3-4-1.the-angle-is-an-estimate
  "3.4.1 and 4: off by up to camera-angle-max-error*, 0.02, as far one way as the other."
  (with-scout (:seed 10 :parameters *sure*)
    (put-beside 'ball 5 5/2)
    (let ((errors (look-often 2000 (lambda (found) (- !>found.angle (atan 1/2))))))
      (is (same-distribution-p errors (uniform -.02d0 .02d0))))))

(test manual-3-4-1.angles-count-turns-as-the-camera-does
  "3.4.1 and E, reading 50: seen by a camera at -5.75, things are at about that; what is right
where the robot stands has the camera's own angle."
  (at-each-spot (:clean t)
    (answer 'camera-turn (eye) -5.75)
    (put-beside 'ball 0 0)
    (put-beside 'far (* 6 (cos -5.5)) (* 6 (sin -5.5)))
    (is (= -5.75 (designator-angle (look '() :type :local))))
    (is (near -5.5 (designator-angle (look '())) 1d-6))))

(test manual-3-4-1.data-of-a-place-begin-with-its-type
  "3.4.1: the car is the place type."
  (at-each-spot (:clean t)
    (loop for type in '(doorway concave)
          for designator = (look-for-place type)
          do (is (eq type (first !>designator.data))))))

(test manual-3-4-1.data-of-an-object-are-a-descriptor
  "3.4.1: a list of attributes and estimated values; it need not be complete."
  (dolist (options '((:clean t) (:seed 11)))
    (with-scout (:clean (getf options :clean) :seed 11 :parameters *sure*)
      (put-beside 'ball 5 0 :size 3 :weight 2 :color 'red :capacity 1)
      (let ((data (look-often 100 #'designator-data :specification '((:size (-99 99))))))
        (is (every (lambda (data) (every (lambda (entry) (= 2 (length entry))) data)) data))
        (is (every (lambda (data) (assoc :size data)) data))
        (is (< 1 (length (remove-duplicates (mapcar #'length data)))))
        (is (loop for entries in data
                  always (loop for (key value) in entries
                               always (or (not (member key '(:size :weight :capacity)))
                                          (realp value)))))))))

(test manual-3-4-1.descriptors-of-false-designators-are-random
  "3.4.1, reading 136: false designators fit the specification, and differ from each other."
  (with-scout (:seed 12 :parameters '((false-thing-prob* 1)))
    (let* ((specification '((:size (3 5)) (:color (red blue))))
           (data (look-often 200 #'designator-data :specification specification))
           (sizes (loop for entry in data collect (second (assoc :size entry)))))
      (is (same-distribution-p sizes (uniform 2.5 5.5)))
      (is (frequent-p (loop for entry in data
                            count (eq 'red (second (assoc :color entry))))
                      200 .5)))))

(test manual-3-4-1.local-designators-are-of-objects-next-to-the-robot
  "3.4.1: they have all data that are needed to pick an object up."
  (at-each-spot (:clean t)
    (let ((ball (put-beside 'ball .3 .1)))
      (tracking (record (look '() :type :local))
        (answer 'hand-grasp-desig (hand-of-scout) (eye) (camera-tracks (eye)))
        (is (eq ball (hand-holding (hand-of-scout))))))))

(test manual-3-4-1.non-local-designators-lead-to-what-they-denote
  "3.4.1: to objects and places; nothing can be picked up by them."
  (dolist (find (list (lambda () (put-beside 'ball 5 1) (look '()))
                      (lambda () (look-for-place 'doorway))))
    (with-scout (:clean t)
      (place-robot scout 10.5 10.5 0)
      (let ((designator (funcall find)))
        (multiple-value-bind (x y) (designator-position designator)
          (tracking (record designator)
            (is (eq :non-local-grasp (end-code 'hand-grasp-desig (hand-of-scout) (eye)
                                               designator)))
            (is (equal (list nil scout (eye) designator)
                       (rest (first (call-times 60 'robot-goto-designator scout (eye))))))
            (is (= (floor x) (floor (robot-x scout))))
            (is (= (floor y) (floor (robot-y scout))))))))))

(test manual-3-4-1.untracked-ones-last-until-their-object-moves
  "Reading 139: whatever the robot does meanwhile; then they are dropped, with a message."
  (at-each-spot (:clean t)
    (let* ((ball (put-beside 'ball 6 0)) (designator (look '())))
      (turned-to 2)
      (answer 'robot-go-forward scout 5)
      (is-true (designator-valid-p designator))
      (said)
      (move-thing ball (beside 3 3))
      (run-ticks 1)
      (is (not (designator-valid-p designator)))
      (is (equal '("*WARNING* -> Removing Designator 0") (said))))))

(test manual-3-4-1.untracked-local-ones-last-within-reach
  "Reading 139: one that no camera tracks is lost when its object is out of reach."
  (at-each-spot (:clean t)
    (put-beside 'ball .3 0)
    (let ((designator (look '() :type :local)))
      (run-ticks 20)
      (is-true (designator-valid-p designator))
      (answer 'robot-go-forward scout 5)
      (is (not (designator-valid-p designator))))))

(test manual-3-4-1.stale-ones-fail-when-tracked
  "Reading 139: tracking a non-local designator of a thing that has moved ends with :LOST-TRACK."
  (at-each-spot (:clean t)
    (let* ((ball (put-beside 'ball 6 0)) (designator (look '())))
      (move-thing ball (beside 6 1))
      (is (eq :lost-track (end-code 'camera-track (eye) designator))))))

(test manual-3-4-1.tracked-ones-go-with-their-last-track
  "Reading 139: when one camera loses it the other keeps it; after that it is gone."
  (at-each-spot (:clean t)
    (let ((ball (put-beside 'ball 6 0)) (designator (look '())))
      (answer 'camera-track (eye 0) designator)
      (answer 'camera-track (eye 1) designator)
      (answer 'camera-insert (eye 0) (bin-of-scout))
      (is-true (designator-valid-p designator))
      (is (equal (list (eye 1)) (tracking-cameras designator)))
      (destroy-thing ball)
      (run-ticks 1)
      (is (not (designator-valid-p designator))))))
