;;;; looking-approach.lisp -- going to what a camera tracks (manual 3.5).

(in-package :ars-magna.tests)

(in-suite looking)

;;; A hall as large as the things of the manual's own maps need.
(world:defmap wide-hall (50 40)
  (rect (0 0) (49 39) bricks 10))

(robot:defrobot walker (wide-hall (5.5 10.5) 0) :cameras (((/ pi 2) 5)))

(defun track-at-once (designator &optional (camera (eye)))
  "Let CAMERA track DESIGNATOR, from before the next tick. Return DESIGNATOR."
  (robot:start-track camera designator nil)
  designator)

(defun tracked-ball (x y &rest attributes)
  "Return a new thing at (X,Y) and a designator on it that camera 0 tracks."
  (multiple-value-bind (ball designator) (apply #'ball-at x y attributes)
    (values ball (track-at-once designator))))

(defun go-there (&optional (ticks 60) (camera (eye)))
  "Let WATCHER go to what CAMERA tracks. Return what the continuation was called with, each time as
(tick code robot camera designator)."
  (call-times ticks 'command:robot-goto-designator watcher camera))

(test goto.arrives-in-the-same-cell
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (tracked-ball 9.7 14.3)
      (declare (ignore ball))
      (base:take-messages)
      (destructuring-bind ((tick code robot camera found)) (go-there)
        ;; Delay 5, turns of .3 for an angle of .73, with the third of which it drives 5 m at .8.
        (is (= (+ 5 2 6) tick))
        (is (null code))
        (is (eq robot watcher))
        (is (eq camera (eye)))
        (is (eq designator found)))
      (is (= 9 (floor (robot:robot-x watcher))))
      (is (= 14 (floor (robot:robot-y watcher))))
      (is (equal '("robot-goto-designator: Robot is at Designator 0"
                   "Camera 0 lost track of Designator 0" "Removing Designator 0")
                 (queued-texts))))))

(test goto.tells-before-the-track-is-lost
  (with-watcher (:clean t)
    (let ((designator (nth-value 1 (ball-at 9.7 12.3))) (order '()))
      (flet ((recorder (name)
               (lambda (err &rest more) (declare (ignore more)) (push (list name err) order))))
        (command:camera-track (eye) designator (recorder :track))
        ;; As in the manual's figure D.3: the track begins in time.
        (command:robot-goto-designator watcher (eye) (recorder :goto))
        (run:run-ticks 60)
        (is (equal '((:track nil) (:goto nil) (:track :lost-track)) (reverse order)))))))

(test goto.a-place
  (with-watcher (:clean t)
    (robot:set-robot-pose watcher 7.5 6.5 0.2)
    (let ((door (third (call-once 'command:camera-get-place-designator (eye) 'world:doorway))))
      (track-at-once door)
      (is (equal (list nil watcher (eye) door) (rest (first (go-there)))))
      (is (eq 'world:doorway
              (world:place-type-name (world:place-type (robot:robot-place-here watcher))))))))

(test goto.follows-what-moves
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (tracked-ball 9.5 12.5)
      (let ((calls '()))
        (command:robot-goto-designator watcher (eye) (lambda (&rest call) (push call calls)))
        (loop repeat 8
              for y downfrom 12.3 by .3 for x from 9.7 by .3
              do (world:move-thing ball (list x y))
                 (run:run-ticks 2))
        (run:run-ticks 30)
        (is (equal (list (list nil watcher (eye) designator)) calls))
        (is (near (floor (robot:robot-x watcher)) (floor (world:thing-x ball))))))))

(test goto.succeeds-when-the-thing-comes
  (with-watcher (:clean t)
    (let ((ball (tracked-ball 9.5 10.5)) (calls '()))
      (command:robot-goto-designator watcher (eye) (lambda (&rest call) (push call calls)))
      (run:run-ticks 6)
      (world:move-thing ball (list (robot:robot-x watcher) (robot:robot-y watcher)))
      (run:run-ticks 2)
      (is (equal '(nil) (mapcar #'first calls))))))

(test goto.errors-at-the-start
  (with-watcher (:clean t)
    (base:take-messages)
    (is (equal (list :not-tracking watcher (eye) nil) (rest (first (go-there 10)))))
    (let ((here (track-at-once (nth-value 1 (ball-at 5.8 10.5)))))
      (is (equal (list :goto-local watcher (eye) here) (rest (first (go-there 10)))))
      (robot:end-track (eye) :interrupt))
    (let ((far (nth-value 1 (tracked-ball 9.5 10.5))))
      (call-once 'command:robot-set-speed watcher 0)
      (is (equal (list :not-moving watcher (eye) far) (rest (first (go-there 10)))))
      (is (= 5.5 (robot:robot-x watcher))))
    (is (equal '("Camera 0 is not tracking anything"
                 "The designator is local: the robot is there already"
                 "robot-set-speed: Speed set to 0.00"
                 "Robot cannot move: its speed is 0")
               (queued-texts)))))

(test goto.with-another-robots-camera
  (with-watcher (:clean t)
    (tracked-ball 9.5 10.5)
    (let ((other (robot::make-robot (robot:robot-blueprint watcher) world:*world*)))
      (signals base:misuse (command:robot-goto-designator other (eye))))))

(test goto.arrives-at-what-blocks-it
  "Wherever in its cell a thing is, what stands at the cell is next to it."
  (dolist (start '((35.5 15.5) (45.5 15) (40 20) (40 10) (40.9 18.9) (41 16) (37 12)))
    (run:with-simulation (walker :clean t)
      (robot:set-robot-pose walker (first start) (second start))
      (let* ((table (put 'table '(40 15) :obsmove t :size 14))
             (camera (robot:robot-camera walker 0))
             (designator (track-at-once (robot:add-designator walker :denotation table) camera)))
        (is (equal (list nil walker camera designator)
                   (rest (first (call-times 80 'command:robot-goto-designator walker camera)))))
        (is-true (robot:within-reach-p walker 40 15))
        (is (eq table (robot:designator-denotation
                       (third (call-once 'command:camera-get-object-designator camera :local
                                         '())))))))))

(test goto.is-blocked
  (with-watcher (:clean t)
    (let ((designator (nth-value 1 (tracked-ball 15.5 10.5))))
      (put 'glass-door '(9.5 10.5) :obsmove t)
      (is (equal (list :robot-blocked watcher (eye) designator) (rest (first (go-there)))))
      (is (< 8.99999 (robot:robot-x watcher) 9))
      (is (robot:tracking-p (eye) designator)))))

(test goto.along-an-axis-to-whole-coordinates
  (loop for (x y angle) in `((5 20 0) (35 20 ,pi) (20 5 ,(/ pi 2)) (20 35 ,(/ pi -2)) (8 8 0))
        do (run:with-simulation (walker :clean t)
             (robot:set-robot-pose walker x y angle)
             (let* ((lamp (put 'lamp '(20 20))) (camera (robot:robot-camera walker 0)) (codes '())
                    (designator (robot:add-designator walker :denotation lamp)))
               (track-at-once designator camera)
               (command:robot-goto-designator walker camera
                                              (lambda (code &rest more)
                                                (declare (ignore more))
                                                (push code codes)))
               (run:run-ticks 50)
               (is (equal '(nil) codes) "from ~D ~D" x y)
               (is-false (robot:designator-valid-p designator))))))

(test goto.ends-its-own-track-only
  (with-watcher (:clean t)
    (let ((designator (nth-value 1 (tracked-ball 10 10.5 :obsmove t))))
      (track-at-once designator (eye 1))
      (is (equal '(nil) (codes (go-there))))
      (is (null (robot:camera-tracks (eye 0))))
      (is (eq designator (robot:camera-tracks (eye 1)))))))

(test goto.success-is-told-first-when-the-thing-comes
  (with-watcher (:clean t)
    (let ((heard '()) (ball (put 'ball '(15.5 10.5))))
      (flet ((listener (name)
               (lambda (code &rest more) (declare (ignore more)) (push (list name code) heard))))
        (command:camera-track (eye) (find-object '()) (listener :track))
        (run:run-ticks 5)
        (command:robot-goto-designator watcher (eye) (listener :goto))
        (run:run-ticks 7)
        (world:put-kicker jump-in (thing ball) (:prob 1)
          (world:move-thing thing (list (robot:robot-x watcher) (robot:robot-y watcher))))
        (run:run-ticks 3)
        (is (equal '((:track nil) (:goto nil) (:track :lost-track)) (reverse heard)))))))

(test goto.does-not-creep
  "A speed that is lost in rounding is none."
  (with-watcher (:clean t)
    (tracked-ball 15.5 10.5)
    (command:robot-set-speed watcher 1d-300)
    (is (equal '(:not-moving) (codes (go-there 20))))))

(test goto.ends-when-the-track-does
  (with-watcher (:clean t)
    (let ((designator (nth-value 1 (tracked-ball 15.5 10.5))) (calls '()))
      (command:robot-goto-designator watcher (eye) (lambda (&rest call) (push call calls)))
      (run:run-ticks 8)
      (put 'screen '(12.5 10.5) :obsview t)
      (run:run-ticks 5)
      (is (equal (list (list :not-tracking watcher (eye) designator)) calls))
      (is (< 5.5 (robot:robot-x watcher) 12)))))

(test goto.is-interrupted
  (with-watcher (:clean t)
    (let ((calls '()) (ball (tracked-ball 15.5 10.5)))
      (command:robot-goto-designator watcher (eye) (lambda (&rest call) (push call calls)))
      (run:run-ticks 8)
      (call-once 'command:robot-stop watcher)
      (is (equal (list (list :interrupt watcher (eye) (robot:camera-tracks (eye)))) calls))
      (is-true ball)
      (is (robot:camera-tracks (eye))))))

(test goto.arrives-in-spite-of-noise
  (let ((codes '()))
    (loop for seed below 40
          do (with-watcher (:seed seed :parameters '((prob-lose-track* 0) (miss-thing-prob* 0)))
               (tracked-ball 15.5 13.5)
               (push (second (first (go-there 100))) codes)))
    (is (every #'null codes))))

;;; False designators.

(defun phantom (x y &key (type :non-local))
  (robot:add-designator watcher :type type :x x :y y
                                :distance (robot::distance-to watcher x y)))

(test goto.a-false-designator-leads-astray
  "Whatever happens, the robot never arrives."
  (let ((codes '()))
    (loop for seed below 30
          do (with-watcher (:seed seed :parameters '((prob-lose-false-track* 0)))
               (track-at-once (phantom 12.5 10.5))
               (push (second (first (go-there 300))) codes)))
    (is (every (lambda (code) (member code '(:not-tracking :robot-blocked))) codes))
    (is (find :not-tracking codes))))

(test goto.a-false-designator-in-a-clean-world
  "It does not drift; where it is, the track is lost, also at whole coordinates."
  (loop for (x y) in '((10.5 10.5) (10 10.5) (11 11) (3 9))
        do (with-watcher (:clean t)
             (let ((designator (track-at-once (phantom x y))))
               (is (equal (list :not-tracking watcher (eye) designator) (rest (first (go-there)))))
               (is-true (robot:within-reach-p watcher x y))))))

(test false-designator.local-is-grasped-in-vain
  (with-watcher (:clean t)
    (let ((designator (track-at-once (phantom 5.5 10.5 :type :local))))
      (is (robot:designator-truly-local-p designator))
      (is (eq :missed-grasp (end-code 'command:hand-grasp-desig
                                      (robot:robot-hand watcher 0) (eye) designator)))
      (is (eq :camera-bump (end-code 'command:camera-insert (eye) designator))))))
