;;;; manual-3-4-3-tracking.lisp -- section 3.4.3 of the manual: camera-track and camera-untrack.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-4-3)

(defun bearing-of (thing)
  "Return the direction from SCOUT to THING, relative to the heading."
  (- (atan2 (- (thing-y thing) (robot-y scout)) (- (thing-x thing) (robot-x scout)))
     (robot-angle scout)))

;;; Beginning.

(test manual-3-4-3.camera-track-tells-that-it-begins
  "3.4.3, reading 83: after camera-desig-delay*, with NIL, camera and designator; no more."
  (at-each-spot (:clean t)
    (put-beside 'ball 5 1)
    (let ((designator (look '())))
      (is (equal (list (list 4 nil (eye) designator))
                 (call-times 60 'camera-track (eye) designator)))
      (is (eq designator (camera-tracks (eye)))))))

(test manual-3-4-3.camera-track-tells-again-how-it-ends
  "3.4.3, reading 83: with the code, camera and designator."
  (at-each-spot (:clean t)
    (let ((ball (put-beside 'ball 5 1)) (designator (look '())))
      (tracking (record designator)
        (destroy-thing ball)
        (run-ticks 1)
        (is (equal (list (list :track nil (eye) designator)
                         (list :track :lost-track (eye) designator))
                   (record)))
        (is (null (camera-tracks (eye))))))))

(test manual-3-4-3.camera-track-points-the-camera-at-once
  "3.4.3, reading 142: the moment it begins, without a delay for turning, as far as need be."
  (at-each-spot (:clean t)
    (let* ((ball (put-beside 'ball 5 3)) (designator (look '())))
      (answer 'camera-turn (eye) 3)
      (camera-track (eye) designator)
      (run-ticks 3)
      (is (= 3 (camera-angle (eye))))
      (run-ticks 1)
      (is (near (bearing-of ball) (camera-angle (eye)))))))

(test manual-3-4-3.camera-track-tracks-places
  "3.4.3: places are tracked as objects are."
  (at-each-spot (:clean t)
    (tracking (record (look-for-place 'doorway))
      (answer 'robot-turn scout .5)
      (is (equal '(nil) (codes (record))))
      (is (near (- (atan2 (- 10.5 (second spot)) (- 30.5 (first spot))) .5)
                (camera-angle (eye)) 1d-6)))))

(test manual-3-4-3.errors-of-camera-track
  "3.4.3, readings 5 and 140: each in its situation, and the designator comes with it."
  (with-scout (:clean t)
    (let ((ball (put-beside 'ball 5 0)) (box (put-beside 'box .5 0 :capacity 5)))
      (flet ((tracked (designator) (call-once 'camera-track (eye) designator)))
        (let ((far (look '())) (here (look '() :type :local)))
          (answer 'camera-track (eye) far)
          (is (equal (list :already-tracking (eye) here) (tracked here)))
          (answer 'camera-untrack (eye))
          (answer 'camera-track (eye) here)
          (answer 'camera-insert (eye) here)
          (let ((box-again (look '() :type :local :camera (eye 1))))
            (is (equal (list :local-not-local (eye) box-again) (tracked box-again))))
          (is (equal (list :camera-inside (eye) far) (tracked far)))
          (answer 'camera-remove (eye))
          (move-thing box (beside 3 3))
          (move-thing ball (beside 5 1))
          (is (equal (list :lost-track (eye) far) (tracked far))))))))

(test manual-3-4-3.local-not-local-after-driving
  "3.4.3: a local designator cannot be tracked when the robot has moved away."
  (at-each-spot (:clean t)
    (put-beside 'ball .3 0)
    (let ((designator (look '() :type :local)))
      (answer 'robot-go-forward scout 5)
      (is (eq :local-not-local (end-code 'camera-track (eye) designator))))))

(test manual-3-4-3.local-not-local-inside
  "3.4.3: nor by a camera outside, if it was seen inside of something."
  (at-each-spot (:clean t)
    (put 'pen (put-beside 'box .2 0 :capacity 5) :size 1)
    (tracking (record (look '() :type :local))
      (answer 'camera-insert (eye) (camera-tracks (eye)))
      (let ((pen (look '() :type :local)))
        (answer 'camera-remove (eye))
        (is (eq :local-not-local (end-code 'camera-track (eye) pen)))))))

(test manual-3-4-3.lost-track-of-what-cannot-be-seen
  "3.4.3: a thing that is hidden when its track should begin; its designator remains valid."
  (at-each-spot (:clean t)
    (put-beside 'ball 8 0)
    (let ((designator (look '())) (screen (put-beside 'screen 4 0 :obsview #t)))
      (is (equal (list :lost-track (eye) designator)
                 (call-once 'camera-track (eye) designator)))
      (is-true (designator-valid-p designator))
      (destroy-thing screen)
      (is (null (second (first (call-times 9 'camera-track (eye) designator))))))))

;;; Following.

(test manual-3-4-3.tracks-follow-the-object
  "3.4.3: the camera turns when the object moves; angle and distance are kept up to date."
  (at-each-spot (:clean t)
    (let* ((ball (put-beside 'ball 6 0)) (designator (look '())))
      (tracking (record designator)
        (loop for step from 1 to 12
              do (move-thing ball (beside (- 6 (* step 1/4)) (* step 1/4)))
                 (run-ticks 1)
                 (is (near (bearing-of ball) (camera-angle (eye)) 1d-6))
                 (is (near (bearing-of ball) !>designator.angle 1d-6)))
        (is (equal '(nil) (codes (record))))))))

(test manual-3-4-3.tracks-make-up-for-the-robot
  "3.4.3: the camera turns when the robot turns or drives."
  (at-each-spot (:clean t)
    (let ((ball (put-beside 'ball 9 4)))
      (tracking (record (look '()))
        (loop for (command amount) in '((robot-turn 2) (robot-go-forward 4) (robot-turn -5))
              do (answer command scout amount)
                 (is (near (bearing-of ball) (camera-angle (eye)) 1d-6)))
        (is (equal '(nil) (codes (record))))))))

(test manual-3-4-3.tracks-estimate-the-angle
  "3.4.3 and 4: in noise the camera is off by no more than camera-angle-max-error*."
  (with-scout (:seed 37 :parameters (cons '(prob-lose-track* 0) *sure*))
    (let* ((ball (put-beside 'ball 6 0)) (errors '()))
      (tracking (record (look '()))
        (loop for step from 1 to 300
              do (move-thing ball (beside 6 (* 3 (sin (/ step 20)))))
                 (run-ticks 1)
                 (push (- (camera-angle (eye)) (bearing-of ball)) errors))
        (is (equal '(nil) (codes (record))))
        (is (same-distribution-p errors (uniform -.02d0 .02d0)))))))

(test manual-3-4-3.local-tracks-become-non-local
  "3.4.3: when it is no longer local, a tracked local designator turns into a non-local one."
  (at-each-spot (:clean t)
    (put-beside 'ball .3 0)
    (let ((designator (look '() :type :local)))
      (tracking (record designator)
        (is (eq :local !>designator.type))
        (answer 'robot-go-forward scout 6)
        (is (eq :non-local !>designator.type))
        (is (equal '(nil) (codes (record))))))))

(test manual-3-4-3.non-local-tracks-do-not-become-local
  "3.4.3: the reverse is not true; in the object's own cell the track is lost instead."
  (with-scout (:clean t)
    (place-robot scout 10.5 10.5 0)
    (put-beside 'ball 4 0)
    (let ((designator (look '())))
      (tracking (record designator)
        (answer 'robot-go-forward scout 5)
        (is (eq :non-local !>designator.type))
        (is (equal '(nil :lost-track) (codes (record))))))))

(test manual-3-4-3.going-to-a-designator-ends-its-track
  "3.4.3, readings 108 and 112: the approach gets its success, then the track ends."
  (with-scout (:clean t)
    (place-robot scout 10.5 10.5 0)
    (put-beside 'ball 6 2)
    (tracking (record (look '()))
      (robot-goto-designator scout (eye) (record :goto))
      (run-ticks 40)
      (is (equal '((:track nil) (:goto nil) (:track :lost-track))
                 (loop for (name code) in (record) collect (list name code)))))))

(test manual-3-4-3.only-what-is-tracked-can-be-gone-to
  "3.4.3 and 3.5: robot-goto-designator answers :NOT-TRACKING otherwise."
  (at-each-spot (:clean t)
    (put-beside 'ball 6 2)
    (look '())
    (is (eq :not-tracking (end-code 'robot-goto-designator scout (eye))))))

(test manual-3-4-3.false-designators-are-tracked-too
  "3.4.3, reading 235: the camera follows the estimate, which drifts by no more than a metre in
distance and 0.2 in angle each tick."
  (with-scout (:seed 38 :parameters '((false-thing-prob* 1) (prob-lose-false-track* 0)
                                      (camera-angle-max-error* 0)))
    (let ((found (look '())))
      (tracking (record found)
        (let ((turns '()) (moves '()))
          (loop repeat 30
                do (let ((angle (camera-angle (eye))) (distance (designator-distance found)))
                     (run-ticks 1)
                     (push (- (camera-angle (eye)) angle) turns)
                     (push (- (designator-distance found) distance) moves)))
          (is (equal '(nil) (codes (record))))
          (is (every (lambda (turn) (<= -.2001 turn .2001)) turns))
          (is (every (lambda (move) (<= -1.0001 move 1.0001)) moves))
          (is (< .05 (reduce #'max turns)))
          (is (< .3 (reduce #'max moves))))))))

;;; Losing.

(defun lifetimes (trials found)
  "Return how many ticks each of TRIALS tracks lasts. FOUND is a function that returns a
designator."
  (let ((camera-desig-delay* 0))
    (loop repeat trials
          collect (let ((start nil) (end nil))
                    (camera-track (eye) (funcall found)
                                  (continuation (err camera designator)
                                    (if err
                                        (!= end (simulation-tick))
                                        (!= start (simulation-tick)))))
                    (run-until (lambda () end))
                    (- end start)))))

(test manual-3-4-3.tracks-are-lost-at-random
  "3.4.3 and 4, reading 220: prob-lose-track* in each tick, local or not."
  (loop for (distance type) in '((5 :non-local) (.3 :local))
        do (with-scout (:seed 39 :parameters (cons '(prob-lose-track* .1) *sure*))
             (put-beside 'ball distance 0)
             (let ((lives (lifetimes 800 (lambda ()
                                           (camera-align-robot (eye))
                                           (run-ticks 1)
                                           (first (look-often 1 #'identity :type type))))))
               (is (frequent-p (count 0 lives) 800 .1))
               (is (frequent-p (count-if (lambda (life) (< life 7)) lives) 800
                               (- 1 (expt .9 7))))))))

(test manual-3-4-3.false-tracks-are-lost-sooner
  "4: prob-lose-false-track*, 0.4."
  (with-scout (:seed 40 :parameters '((false-thing-prob* 1) (prob-lose-track* 0)))
    (let ((lives (lifetimes 800 (lambda () (first (look-often 1 #'identity))))))
      (is (frequent-p (count 0 lives) 800 .4))
      (is (frequent-p (count 1 lives) 800 (* .6 .4))))))

(test manual-3-4-3.tracks-are-lost-by-occlusion
  "3.4.3: behind an obstructing object, or a wall."
  (at-each-spot (:clean t)
    (let ((ball (put 'ball '(34.5 10.5))))
      (tracking (record (look '()))
        (move-thing ball '(34.5 13.5))
        (run-ticks 1)
        (is (equal '(nil :lost-track) (codes (record)))))))
  (at-each-spot (:clean t)
    (put-beside 'ball 8 0)
    (tracking (record (look '()))
      (put-beside 'screen 4 0 :obsview #t)
      (run-ticks 1)
      (is (equal '(nil :lost-track) (codes (record)))))))

(test manual-3-4-3.tracks-are-lost-by-speed
  "3.4.3, readings 6 and 141: if the direction changes in a tick by more than half the field of
view, 45 degrees for this camera and 22.5 for that."
  (loop for (camera dy lost) in '((0 3.9 nil) (0 4.1 t) (1 1.6 nil) (1 1.7 t))
        do (at-each-spot (:clean t)
             (let ((ball (put-beside 'ball 4 0)))
               (tracking (record (look '() :camera (eye camera)) :camera (eye camera))
                 (move-thing ball (beside 4 dy))
                 (run-ticks 1)
                 (is (equal (if lost '(nil :lost-track) '(nil)) (codes (record)))))))))

(test manual-3-4-3.a-fast-turn-of-the-robot-loses-nothing
  "Reading 141: the direction in the world counts, which a turn does not change."
  (at-each-spot (:clean t :parameters '((max-turn-angle* 3)))
    (put-beside 'ball 6 0)
    (answer 'robot-set-turn-angle scout 3)
    (tracking (record (look '()))
      (answer 'robot-about-face scout)
      (is (equal '(nil) (codes (record)))))))

(test manual-3-4-3.tracks-are-lost-when-the-object-is-put-away
  "3.4.3: into a container, a storage bin, or out of the world."
  (dolist (change (list (lambda (ball) (move-thing ball (bin-of-scout)))
                        (lambda (ball) (move-thing ball (put-beside 'box 3 3 :capacity 9)))
                        #'destroy-thing))
    (at-each-spot (:clean t)
      (let ((ball (put-beside 'ball 6 0)))
        (tracking (record (look '()))
          (funcall change ball)
          (run-ticks 1)
          (is (equal '(nil :lost-track) (codes (record)))))))))

(test manual-3-4-3.what-ends-a-track-is-told-first
  "Reading 87: the command that ends a track is answered, and then the track."
  (at-each-spot (:clean t)
    (put-beside 'box .2 0 :capacity 5)
    (tracking (record (look '() :type :local))
      (camera-insert (eye) (camera-tracks (eye)) (record :insert))
      (run-ticks 5)
      (is (equal '((:track nil) (:insert nil) (:track :lost-track))
                 (loop for (name code) in (record) collect (list name code)))))))

;;; camera-untrack.

(test manual-3-4-3.camera-untrack-stops-tracking
  "3.4.3, reading 84: the track gets :INTERRUPT, then untrack NIL; the designator remains."
  (at-each-spot (:clean t)
    (put-beside 'ball 6 0)
    (let ((designator (look '())))
      (tracking (record designator)
        (camera-untrack (eye) (record :untrack))
        (run-ticks 1)
        (is (equal (list (list :track nil (eye) designator)
                         (list :track :interrupt (eye) designator)
                         (list :untrack nil (eye)))
                   (record)))
        (is-true (designator-valid-p designator))
        (is (null (camera-tracks (eye))))))))

(test manual-3-4-3.camera-untrack-of-nothing
  "3.4.3: :NOT-TRACKING."
  (at-each-spot (:clean t)
    (is (equal (list :not-tracking (eye)) (call-once 'camera-untrack (eye))))))
