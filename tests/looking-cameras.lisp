;;;; looking-cameras.lisp -- how long designators last; cameras that turn; journals (manual 3.4).

(in-package :ars-magna.tests)

(in-suite looking)

;;; Designators that nobody tracks.

(test designator.untracked-lasts-until-its-thing-moves
  (with-watcher (:clean t)
    (multiple-value-bind (ball far) (ball-at 9.5 10.5)
      (robot:set-robot-pose watcher 3.5 5.5)
      (run:run-ticks 100)
      (is (robot:designator-valid-p far))
      (base:take-messages)
      (world:move-thing ball '(9.6 10.5))
      (is (equal '("Removing Designator 0") (queued-texts)))
      (is (equal '() (robot:live-designators watcher))))))

(test designator.local-lasts-within-reach
  (with-watcher (:clean t)
    (multiple-value-bind (ball here) (ball-at 5.9 10.5 :size 1)
      ;; By hand: its trajectory can be followed.
      (world:move-thing ball (robot:robot-hand watcher 0))
      (is (robot:designator-truly-local-p here))
      (robot:set-down (robot:robot-hand watcher 0) ball)
      (run:run-ticks 1)
      (is (robot:designator-valid-p here))
      (robot:set-robot-pose watcher 3.5 10.5)
      (is (not (robot:designator-truly-local-p here)))
      (run:run-ticks 1)
      (is (not (robot:designator-valid-p here))))
    (multiple-value-bind (ball here) (ball-at 3.9 10.5)
      (world:move-thing ball '(3.8 10.5))
      (is (not (robot:designator-valid-p here))))))

(test designator.untracked-keeps-its-direction-when-the-robot-turns
  "Manual 3.4.1: the angle is relative to the robot's current heading."
  (with-watcher (:seed 4)
    (multiple-value-bind (ball far) (ball-at 9.5 12.5)
      (declare (ignore ball))
      (let ((before (+ (robot:designator-angle far) (robot:robot-angle watcher))))
        (call-once 'command:robot-turn watcher 2)
        (is (near before (+ (robot:designator-angle far) (robot:robot-angle watcher))))
        (robot:place-robot watcher 5 10 -3)
        (is (near before (- (robot:designator-angle far) 3)))))))

(test designator.of-a-place-stays
  (with-watcher (:clean t)
    (let ((door (third (call-once 'command:camera-get-place-designator (eye) 'world:doorway))))
      (robot:set-robot-pose watcher 20.5 10.5)
      (run:run-ticks 5)
      (is (robot:designator-valid-p door))
      (is (not (robot:designator-truly-local-p door))))))

(test designators.past-the-limit-push-out-the-oldest-untracked
  (with-watcher (:clean t)
    (let ((robot:*designator-limit* 5))
      (put 'ball '(9.5 10.5))
      (let ((first (find-object '())))
        (robot:start-track (eye 0) first nil)
        (dotimes (index 6) (find-object '() :camera (eye 1)))
        (is (= 5 (length (robot:live-designators watcher))))
        (is (robot:designator-valid-p first))))))

(test designators.past-the-limit-are-not-returned
  (with-watcher (:clean t)
    (let ((robot:*designator-limit* 5))
      (dotimes (index 9) (put 'ball '(9.5 10.5)))
      (let ((found (third (call-once 'command:camera-get-all-object-designators
                                     (eye) :non-local '()))))
        (is (= 5 (length found)))
        (is (every #'robot:designator-valid-p found))))))

;;; Turning cameras.

(test camera-turn.is-exact-and-clean
  (with-watcher (:clean t)
    (destructuring-bind ((tick code camera angle)) (call-times 5 'command:camera-turn (eye) 7)
      (is (= 1 tick))
      (is (null code))
      (is (eq camera (eye)))
      (is (= 7 angle (robot:camera-angle (eye)))))
    (destructuring-bind (code camera angle) (call-once 'command:camera-align-robot (eye))
      (declare (ignore camera))
      (is (null code))
      (is (near (- (* 2 pi) 7) angle))
      (is (near (* 2 pi) (robot:camera-angle (eye)))))
    (destructuring-bind (doubt . texts) (queued-texts)
      (is-true (has-words-p doubt "7 radians are 1.1 full turns"))
      (is (equal '("camera-turn: Camera 0 turned 7.00"
                   "camera-align-robot: Camera 0 turned -0.72")
                 texts)))))

(test camera-align-place.points-along-the-place
  (with-watcher (:clean t)
    (is (equal (list :no-place-type (eye) nil nil)
               (call-once 'command:camera-align-place (eye))))
    (robot:set-robot-pose watcher 20.5 10.5 0.4)
    (call-once 'command:camera-turn (eye) 1)
    (destructuring-bind (code camera angle type) (call-once 'command:camera-align-place (eye))
      (declare (ignore camera))
      (is (null code))
      (is (near -1.4 angle 1d-6))
      (is (eq 'world:doorway type))
      (is (near -0.4 (robot:camera-angle (eye)) 1d-6)))
    (is (string= "camera-align-place: Camera 0 turned -1.40, at a DOORWAY"
                 (first (last (queued-texts)))))))

(test camera.turns-inside-a-container
  (with-watcher (:clean t)
    (robot:move-part (eye) (robot:robot-storage-bin watcher 0))
    (is (null (end-code 'command:camera-turn (eye) 1)))
    (is (= 1 (robot:camera-angle (eye))))))

;;; Journals.

(world:defmap mouse-hole (30 21)
  (rect (0 0) (29 20) bricks 10)
  (wall (20 1) (20 9) slate 30)
  (wall (20 11) (20 19) slate 30)
  (obj mouse (9.5 10.5) ((:color red))))

(robot:defrobot cat (mouse-hole (5.5 10.5) 0) :cameras (((/ pi 2) 5) ((/ pi 4) 3)))

(defun cats-run ()
  "Do what makes, tracks and loses designators; return a digest of every tenth tick."
  (let ((mouse (world:find-thing 'mouse)) (found '())
        (eyes (robot:robot-cameras cat)))
    (flet ((note (err camera &rest more)
             (declare (ignore err camera))
             (when (robot:designator-p (first more)) (push (first more) found))))
      (loop for round from 0 below 12
            do (command:camera-get-object-designator (svref eyes 0) :non-local
                                                     '((:color (red violet))) #'note)
               (command:camera-get-all-place-designators (svref eyes 1) 'world:doorway #'note)
               (run:run-ticks 6)
               (dolist (designator found) (command:camera-track (svref eyes 0) designator #'note))
               (command:robot-turn cat (* .1 (- round 5)))
               (run:run-ticks 4)
               (world:move-thing mouse (list (+ 9.5 (* .1 round)) 10.5))
               (command:camera-untrack (svref eyes 0))
            collect (run:state-digest)))))

(test journal.repeats-designators-and-tracks
  (multiple-value-bind (journal digest)
      (run:with-simulation (cat :seed 9 :journal t)
        (is (< 2 (length (remove-duplicates (cats-run)))))
        (let ((file (format nil "/tmp/~A" (gensym "looking-journal"))))
          (unwind-protect (progn (run:save-journal file)
                                 (values (run:load-journal file) (run:state-digest)))
            (when (probe-file file) (delete-file file)))))
    (is (find 'command:camera-track (run:journal-entries journal) :key #'second))
    (is (= digest (nth-value 1 (run:replay journal))))))

(test seed.decides-what-is-seen
  (flet ((digests (seed) (run:with-simulation (cat :seed seed) (cats-run))))
    (is (equal (digests 1) (digests 1)))
    (is (not (equal (digests 1) (digests 2))))))
