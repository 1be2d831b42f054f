;;;; manual-3-4-3-moving.lisp -- section 3.4.3 of the manual: turning and inserting cameras.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-4-3)

;;; Turning.

(test manual-3-4-3.camera-turn-is-relative
  "3.4.3, reading 144: it turns by the angle exactly, and says so in a clean world."
  (at-each-spot (:clean t)
    (is (equal (list nil (eye) 1d0) (call-once 'camera-turn (eye) 1)))
    (is (equal (list nil (eye) -2.5d0) (call-once 'camera-turn (eye) -2.5)))
    (is (= -1.5 (camera-angle (eye))))))

(test manual-3-4-3.camera-align-robot-looks-ahead
  "3.4.3: the camera then points where the robot does, by the shorter way."
  (loop for (before turned) in `((1 -1) (-3 3) (4 ,(- 2pi 4)) (0 0))
        do (at-each-spot (:clean t)
             (turned-to 2)
             (answer 'camera-turn (eye) before)
             (is (near turned (first (answer 'camera-align-robot (eye)))))
             (is (near 1 (cos (camera-angle (eye))))))))

(test manual-3-4-3.camera-align-place-looks-along-the-place
  "3.4.3, reading 73: in the nearest of its directions; the place type comes third."
  (loop for (heading camera aligned) in `((.4 0 0) (.4 1 0) (2 1 ,pi) (-1 -1.5 ,(- pi)))
        do (with-scout (:clean t)
             (place-robot scout 30.3 10.8 heading)
             (answer 'camera-turn (eye) camera)
             (destructuring-bind (turned type) (answer 'camera-align-place (eye))
               (is (eq 'doorway type))
               (is (near (- aligned heading camera) turned 1d-6))
               (is (near aligned (+ (robot-angle scout) (camera-angle (eye))) 1d-6))))))

(test manual-3-4-3.camera-align-place-needs-a-place
  "3.4.3: :NO-PLACE-TYPE if none is sensed, and NIL for angle and type."
  (at-each-spot (:clean t)
    (answer 'camera-turn (eye) 1)
    (is (equal (list :no-place-type (eye) nil nil) (call-once 'camera-align-place (eye))))
    (is (= 1 (camera-angle (eye))))))

(test manual-3-4-3.camera-align-place-senses-wrongly
  "3.4.3 and 4, reading 221: it fails at a doorway with type-false-neg*."
  (with-scout (:seed 41)
    (place-robot scout 30.5 10.5 0)
    (let ((codes '()))
      (loop repeat 2000
            do (camera-align-place (eye) (continuation (err camera angle type) (push err codes)))
               (run-ticks 1))
      (is (frequent-p (count :no-place-type codes) 2000 .05))
      (is (= 2000 (+ (count nil codes) (count :no-place-type codes)))))))

(test manual-3-4-3.angles-turned-are-approximate
  "3.4.3 and 4, reading 144: reports are off by up to camera-angle-max-error*, the turn is not."
  (with-scout (:seed 42)
    (let ((reports '()))
      (loop repeat 1000
            do (camera-turn (eye) 1 (continuation (err camera angle) (push angle reports)))
               (run-ticks 1))
      (is (= 1000 (camera-angle (eye))))
      (is (same-distribution-p reports (uniform .98d0 1.02d0))))))

(test manual-3-4-3.turning-has-no-errors
  "3.4.3: at any angle, wherever the camera is."
  (at-each-spot (:clean t)
    (answer 'camera-insert (eye 1) (bin-of-scout))
    (dolist (camera '(0 1))
      (dolist (angle '(0 -100 1/3 7.5))
        (is (null (end-code 'camera-turn (eye camera) angle))))
      (is (null (end-code 'camera-align-robot (eye camera)))))))

(test manual-3-4-3.camera-align-place-at-no-place
  "Readings 221 and 223: a place type that is only imagined leaves the camera at the heading."
  (at-each-spot (:seed 45 :parameters '((type-false-pos* 1)))
    (turned-to 2)
    (answer 'camera-turn (eye) 1)
    (destructuring-bind (turned type) (answer 'camera-align-place (eye))
      (is (near -1 turned .021))
      (is-true (find-place-type type))
      (is (near 0 (camera-angle (eye)))))))

;;; Inserting and removing.

(defmacro with-box ((designator &rest attributes) &body body)
  "Run BODY without noise and at each spot. Camera 0 tracks DESIGNATOR of a local BOX with
ATTRIBUTES, by default a capacity of 5."
  `(at-each-spot (:clean t)
     (put-beside 'box .2 0 ,@(or attributes '(:capacity 5)))
     (let ((,designator (look '() :type :local)))
       (answer 'camera-track (eye) ,designator)
       ,@body)))

(test manual-3-4-3.camera-insert-goes-into-what-is-tracked
  "3.4.3: into the container that a local designator denotes; it comes third."
  (with-box (designator)
    (is (equal (list nil (eye) designator) (call-once 'camera-insert (eye) designator)))
    (is (eq (find-thing 'box) (camera-location (eye))))))

(test manual-3-4-3.camera-insert-takes-a-storage-bin
  "3.4.3, reading 159: instead of a designator, and without a track."
  (at-each-spot (:clean t)
    (is (equal (list nil (eye) (bin-of-scout 1))
               (call-once 'camera-insert (eye) (bin-of-scout 1))))
    (is (eq (bin-of-scout 1) (camera-location (eye))))))

(test manual-3-4-3.camera-remove-takes-it-out
  "3.4.3: one level, of a container in a container as well (reading 160)."
  (with-box (designator)
    (put 'case (find-thing 'box) :capacity 2)
    (answer 'camera-insert (eye) designator)
    (answer 'camera-track (eye) (look '() :type :local))
    (answer 'camera-insert (eye) (camera-tracks (eye)))
    (is (eq (find-thing 'case) (camera-location (eye))))
    (is (equal (list nil (eye)) (call-once 'camera-remove (eye))))
    (is (eq (find-thing 'box) (camera-location (eye))))
    (answer 'camera-remove (eye))
    (is (null (camera-location (eye))))))

(test manual-3-4-3.not-inside
  "3.4.3: removal of a camera that is in nothing."
  (at-each-spot (:clean t)
    (is (equal (list :not-inside (eye)) (call-once 'camera-remove (eye))))))

(test manual-3-4-3.bin-closed
  "3.4.3: insertion into a closed storage bin."
  (at-each-spot (:clean t)
    (answer 'storage-bin-close (bin-of-scout))
    (is (equal (list :bin-closed (eye) (bin-of-scout))
               (call-once 'camera-insert (eye) (bin-of-scout))))
    (is (null (camera-location (eye))))))

(test manual-3-4-3.not-tracking-the-destination
  "3.4.3: :NOT-TRACKING if nothing is tracked, :NOT-TRACKING-DESTINATION if something else is."
  (with-box (designator)
    (is (eq :not-tracking (end-code 'camera-insert (eye 1) designator)))
    (put-beside 'ball 5 0)
    (answer 'camera-track (eye 1) (look '() :camera (eye 1)))
    (is (eq :not-tracking-destination (end-code 'camera-insert (eye 1) designator)))
    (is (eq designator (camera-tracks (eye 0))))))

(test manual-3-4-3.insufficient-capacity
  "3.4.3, reading 153: into a thing that is no container, or has capacity 0; a full one takes a
camera."
  (with-box (designator :capacity 0)
    (is (eq :insufficient-capacity (end-code 'camera-insert (eye) designator)))
    (is (null (camera-location (eye)))))
  (with-box (designator :size 3)
    (is (eq :insufficient-capacity (end-code 'camera-insert (eye) designator)))))

(test manual-3-4-3.non-local-designator
  "3.4.3: a camera cannot be inserted into a distant container."
  (at-each-spot (:clean t)
    (put-beside 'box 5 0 :capacity 5)
    (tracking (record (look '()))
      (is (eq :non-local-designator (end-code 'camera-insert (eye) (camera-tracks (eye))))))))

(test manual-3-4-3.camera-bump
  "3.4.3: the camera is not inside, and the designator is lost."
  (dolist (spot *spots*)
    (with-scout (:clean t)
      (place-robot scout (first spot) (second spot) 0)
      (put-beside 'box .2 0 :capacity 5)
      (tracking (record (look '() :type :local))
        (let ((designator (camera-tracks (eye))) (camera-insert-miss-prob* 1))
          (is (equal (list :camera-bump (eye) designator)
                     (call-once 'camera-insert (eye) designator)))
          (is (null (camera-location (eye))))
          (is (not (designator-valid-p designator)))
          (is (equal '(nil :lost-track) (codes (record)))))))))

(test manual-3-4-3.errors-of-insertion-come-in-this-order
  "3.4.3, reading 164: that of the manual's list, when several would do."
  (at-each-spot (:clean t)
    (let ((box (put-beside 'box 5 0 :capacity 0 :closed #t)))
      (let ((designator (look '())) (camera-insert-miss-prob* 1))
        (flet ((code () (end-code 'camera-insert (eye) designator)))
          (is (eq :bin-closed (code)))
          (set-attribute box :closed #f)
          (is (eq :not-tracking (code)))
          (answer 'camera-track (eye) (look '()))
          (is (eq :not-tracking-destination (code)))
          (answer 'camera-untrack (eye))
          (answer 'camera-track (eye) designator)
          (is (eq :insufficient-capacity (code)))
          (set-attribute box :capacity 5)
          (is (eq :non-local-designator (code))))))))

(defun insertions (trials)
  "Return for each of TRIALS insertions into a box its code, and whether the designator is valid
afterwards. The other camera tracks that designator, too."
  (put-beside 'box .2 0 :capacity 5)
  (loop repeat trials
        collect (let ((designator (first (look-often 1 #'identity :type :local))) (code :none))
                  (camera-track (eye 0) designator)
                  (camera-track (eye 1) designator)
                  (run-ticks 4)
                  (camera-insert (eye 0) designator
                                 (continuation (err camera designator) (!= code err)))
                  (run-ticks 2)
                  (prog1 (list code (and (designator-valid-p designator) t))
                    (camera-remove (eye 0))
                    (camera-untrack (eye 1))
                    (run-ticks 2)))))

(test manual-3-4-3.insertions-miss-and-lose-designators
  "3.4.3 and 4, reading 158: 0.05 miss, which loses the designator; 0.1 of the others lose it."
  (with-scout (:seed 43 :parameters (cons '(prob-lose-track* 0) *sure*))
    (let ((outcomes (insertions 2000)))
      (is (frequent-p (count '(:camera-bump nil) outcomes :test #'equal) 2000 .05))
      (is (frequent-p (count '(nil nil) outcomes :test #'equal) 2000 (* .95 .1)))
      (is (frequent-p (count '(nil t) outcomes :test #'equal) 2000 (* .95 .9))))))

(test manual-3-4-3.bins-can-be-missed-too
  "Reading 159: camera-insert-miss-prob* is for any destination."
  (with-scout (:seed 44 :parameters '((camera-move-delay* 0)))
    (let ((codes '()))
      (loop repeat 2000
            do (camera-insert (eye) (bin-of-scout) (continuation (err camera bin)
                                                     (push err codes)))
               (run-ticks 1)
               (camera-remove (eye))
               (run-ticks 1))
      (is (frequent-p (count :camera-bump codes) 2000 .05))
      (is (= 2000 (+ (count nil codes) (count :camera-bump codes)))))))

(test manual-3-4-3.insertion-ends-the-track-of-its-camera
  "Reading 158: the designator lives on if another camera tracks it."
  (with-box (designator)
    (answer 'camera-track (eye 1) designator)
    (answer 'camera-insert (eye) designator)
    (is (null (camera-tracks (eye))))
    (is-true (designator-valid-p designator))
    (is (eq designator (camera-tracks (eye 1))))))

(test manual-3-4-3.what-is-elsewhere-is-not-reached-from-inside
  "Reading 230: a camera in one thing must be taken out before it enters another."
  (with-box (designator)
    (answer 'camera-insert (eye) designator)
    (is (eq :local-not-local (end-code 'camera-insert (eye) (bin-of-scout))))
    (answer 'camera-remove (eye))
    (is (null (end-code 'camera-insert (eye) (bin-of-scout))))))

(test manual-3-4-3.insertion-happens-after-its-delay
  "3.4.3 and 4: the world may change between-times; what counts is how it is by then (78)."
  (with-box (designator)
    (recording (record)
      (camera-insert (eye) designator (record :insert))
      (set-attribute (find-thing 'box) :closed #t)
      (run-ticks 5)
      (is (equal '(:bin-closed) (codes (record)))))))
