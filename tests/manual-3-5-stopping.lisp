;;;; manual-3-5-stopping.lisp -- stopping, interruptions, and what is reported (manual 3.5).

(in-package :ars-magna.tests)

(in-suite manual-3-5)

(defun under-way (command &rest arguments)
  "Issue COMMAND to SPRINTER, under the name :MOTION, and pass 8 ticks."
  (setf *answers* '())
  (apply command sprinter (append arguments (list (recorder :motion))))
  (ars:run-ticks 8))

(defun under-way-p ()
  "True if the continuation of the command that UNDER-WAY issued has not been called yet."
  (null (answers-to :motion)))

(defun far-to-x ()
  "Return how far SPRINTER has gone from x = 5.5."
  (- (ars:robot-x sprinter) 5.5d0))

;;; Stopping.

(test manual-3-5.stop-coasts-for-braking*-ticks
  "3.5, reading 95: stopping interrupts the motion; the robot goes on at its speed for BRAKING*
ticks, 2 unless that is set, and then stands. Without braking it stands at once."
  (loop for braking in '(nil 0 1 2 5)
        for ticks = (or braking 2)
        do (with-sprinter (:clean t)
             (when braking (setf ars:braking* braking))
             (under-way 'ars:robot-go-forward 50)
             (let ((gone (far-to-x)))
               (is (equal (list (max 1 ticks) nil sprinter) (sprint 'ars:robot-stop)))
               (is (equal (list (list :interrupt sprinter)) (answers-to :motion)))
               (is (near (+ gone (* ticks .8d0)) (far-to-x)) "~A" braking)))))

(test manual-3-5.stop-coasts-at-the-current-speed
  "3.5, reading 95: that is what the robot was driving at, and noise is in it."
  (with-sprinter (:seed 8)
    (sprint 'ars:robot-set-speed .5)
    (under-way 'ars:robot-goto-wall)
    (let ((gone (far-to-x)))
      (sprint 'ars:robot-stop)
      (is (< (* 1.0 .9) (- (far-to-x) gone) (* 1.0 1.1))))))

(test manual-3-5.stop-coasts-to-a-wall-at-most
  "3.5, reading 95: a wall ends the coasting, and the stop has succeeded."
  (with-sprinter (:clean t)
    (setf ars:braking* 9)
    (place-sprinter 16 5.5 0)
    (under-way 'ars:robot-go-forward 50)
    (is (equal (list nil sprinter) (rest (sprint 'ars:robot-stop))))
    (is-true (sprinter-at-p 20 5.5 1d-5))))

(test manual-3-5.stop-has-nothing-to-do-at-rest
  "3.5, reading 95: a robot that stands, turns, or has yet to start is stopped in the next tick."
  (with-sprinter (:clean t)
    (is (equal (list 1 nil sprinter) (sprint 'ars:robot-stop)))
    (under-way 'ars:robot-turn 4)
    (let ((angle (ars:robot-angle sprinter)))
      (is (equal (list 1 nil sprinter) (sprint 'ars:robot-stop)))
      (is-true (sprinter-heads-p angle)))
    (ars:robot-go-forward sprinter 50)
    (ars:run-ticks 3)
    (is (equal (list 1 nil sprinter) (sprint 'ars:robot-stop)))
    (is-true (sprinter-at-p 5.5 5.5))))

(test manual-3-5.other-interruptions-stop-at-once
  "3.5, reading 95: any other command, or a grab of the robot, ends a motion at once."
  (with-sprinter (:clean t)
    (loop for stop in (list (lambda () (ars:robot-turn sprinter 1))
                            (lambda () (ars:robot-place sprinter))
                            (lambda () (ars:robot-set-speed sprinter .8))
                            (lambda () (ars:grab-resource sprinter)))
          do (place-sprinter 5.5 5.5 0)
             (under-way 'ars:robot-go-forward 50)
             (let ((gone (far-to-x)))
               (is (plusp gone))
               (funcall stop)
               (ars:run-ticks 20)
               (is (= gone (far-to-x)))
               (is (equal (list (list :interrupt sprinter)) (answers-to :motion)))))))

(test manual-3-5.stop-can-be-interrupted
  "3.5, reading 94: while the robot coasts, stopping is a command like others."
  (with-sprinter (:clean t)
    (setf ars:braking* 5)
    (under-way 'ars:robot-go-forward 50)
    (ars:robot-stop sprinter (recorder :stop))
    (ars:run-ticks 2)
    (let ((gone (far-to-x)))
      (sprint 'ars:robot-turn .3)
      (is (equal (list (list :interrupt sprinter)) (answers-to :stop)))
      (is (= gone (far-to-x))))))

;;; Interruptions (3.1.2).

(defparameter *sprints*
  '((ars:robot-set-speed .5) (ars:robot-set-turn-angle .2) (ars:robot-turn 1)
    (ars:robot-about-face) (ars:robot-turn-left) (ars:robot-turn-right) (ars:robot-align-place)
    (ars:robot-turn-corner) (ars:robot-go-forward 3) (ars:robot-goto-wall)
    (ars:robot-goto-designator :camera) (ars:robot-stop) (ars:robot-place)
    (ars:robot-follow-wall))
  "All commands of robot movement with their arguments; :CAMERA is a camera of the robot.")

(defun issue-sprint (sprint &rest continuation)
  "Issue SPRINT, one of *SPRINTS*, to SPRINTER with CONTINUATION."
  (apply (first sprint) sprinter
         (append (substitute (ars:robot-camera sprinter 0) :camera (rest sprint)) continuation)))

(test manual-3-5.all-of-these-take-the-robot-over
  "3.5, reading 94: the robot is the resource of each, so each ends the command in progress."
  (dolist (sprint *sprints*)
    (with-sprinter ()
      (under-way 'ars:robot-go-forward 50)
      (issue-sprint sprint)
      (ars:run-ticks 1)
      (is (equal (list (list :interrupt sprinter)) (answers-to :motion)) "~A" sprint))))

(test manual-3-5.an-interruption-tells-as-many-arguments
  "3.5, reading 85: a continuation gets NIL for each result that is not known."
  (dolist (sprint *sprints*)
    (with-sprinter ()
      (let ((calls '()))
        (issue-sprint sprint (lambda (&rest call) (push call calls)))
        (ars:grab-resource sprinter)
        (ars:run-ticks 50)
        (is (equal (list (list* :interrupt sprinter
                                (results-known (ars:find-command (first sprint)) sprinter)))
                   calls)
            "~A" sprint)))))

(test manual-3-5.commands-of-parts-do-not-disturb-the-robot
  "3.5, 3.1.2: cameras, hands and bins work while the robot moves."
  (with-sprinter (:clean t)
    (under-way 'ars:robot-go-forward 10)
    (is (null (first (reply 'ars:camera-view (ars:robot-camera sprinter 0)))))
    (is (equal (list (list nil sprinter)) (answers-to :motion)))
    (under-way 'ars:robot-turn 9)
    (ars:hand-insert-bin (ars:robot-hand sprinter 0) (ars:robot-storage-bin sprinter 0))
    (ars:storage-bin-close (ars:robot-storage-bin sprinter 0))
    (ars:run-ticks 3)
    (is-true (under-way-p))))

(test manual-3-5.a-turn-that-is-interrupted-stays-half-done
  "3.5: the turn so far remains, and the new command continues from there."
  (with-sprinter (:clean t)
    (under-way 'ars:robot-turn 9)
    (is-true (sprinter-heads-p (* 7 .3d0)))
    (sprint 'ars:robot-turn -.1d0)
    (is (equal (list (list :interrupt sprinter nil)) (answers-to :motion)))
    (is-true (sprinter-heads-p 2d0))))

;;; When, and what is said.

(test manual-3-5.errors-are-found-when-the-delay-is-over
  "3.5, reading 78: what counts is how things are when the robot starts, not when it is asked to."
  (with-sprinter (:clean t)
    (let ((*answers* '()))
      (ars:robot-go-forward sprinter 3 (recorder :go))
      (ars:run-ticks 2)
      (ars:move-thing (ars:find-thing 'barrel) 6.5 5.5)
      (ars:run-ticks 2)
      (is-false (answers-to :go))
      (ars:run-ticks 1)
      (is (equal (list (list :robot-blocked sprinter)) (answers-to :go))))
    (is-true (sprinter-at-p 6 5.5 1d-5))))

(test manual-3-5.commands-return-at-once-and-nothing
  "3.5, 2.3: a call only asks; the robot moves when ticks pass."
  (with-sprinter ()
    (dolist (sprint *sprints*)
      (is (null (multiple-value-list (issue-sprint sprint nil))) "~A" sprint)
      (is-true (sprinter-at-p 5.5 5.5)))
    (is (= 0 (ars:simulation-tick)))))

(test manual-3-5.a-continuation-can-be-left-out
  "3.5, reading 39: NIL, or none at all, means that no continuation is called."
  (with-sprinter (:clean t)
    (ars:robot-go-forward sprinter 2 nil)
    (ars:run-ticks 10)
    (ars:robot-go-forward sprinter 2)
    (ars:run-ticks 10)
    (is-true (sprinter-at-p (+ 5.5 (* 4 .8d0)) 5.5))))

(test manual-3-5.what-moved-the-robot-from-outside-is-not-in-its-odometers
  "3.5, reading 114: placing the robot elsewhere does not change its odometers."
  (with-sprinter (:clean t)
    (sprint 'ars:robot-go-forward 5)
    (place-sprinter 30 3 2)
    (let ((odometer (ars:robot-main-odometer sprinter)))
      (is (near 4 (ars:pt-x (ars:nominal (ars:get-odometer-pos odometer)))))
      (is (near 0 (ars:nominal (ars:get-odometer-ang odometer)))))))

(test manual-3-5.commands-report-by-messages
  "3.5, reading 229: each end of a command queues a message: plain, warning or error."
  (with-sprinter (:clean t)
    (flet ((said (command &rest arguments)
             (apply #'sprint command arguments)
             (string-right-trim '(#\Newline) (texts))))
      (is (string= "robot-set-speed: Speed set to 0.50" (said 'ars:robot-set-speed .5)))
      (is (string= "*ERROR* -> Speed cannot be negative. Set to 0"
                   (said 'ars:robot-set-speed -1)))
      (is (string= "*ERROR* -> Robot cannot move: its speed is 0"
                   (said 'ars:robot-go-forward 5)))
      (is (string= "*ERROR* -> Speed too high. Set to the maximum, 1.00"
                   (said 'ars:robot-set-speed 2)))
      (is (string= "robot-turn: Robot turned -1.00" (said 'ars:robot-turn -1)))
      (place-sprinter 5.5 13.5 0)
      (is (string= "robot-goto-wall: Robot is at a wall" (said 'ars:robot-goto-wall)))
      (is (string= "*ERROR* -> Robot is blocked" (said 'ars:robot-go-forward 3)))
      (ars:robot-turn sprinter 1)
      (ars:run-ticks 1)
      (is (string= (format nil "*WARNING* -> robot-turn was interrupted~@
                                robot-stop: Robot stopped")
                   (said 'ars:robot-stop))))))

(test manual-3-5.who-stops-again-and-again-does-not-drive-on
  "3.5, reading 95: the robot coasts for BRAKING* ticks in all."
  (flet ((gone-with (stops)
           (with-sprinter (:clean t)
             (under-way 'ars:robot-go-forward 50)
             (let ((x (ars:robot-x sprinter)))
               (loop repeat stops do (ars:robot-stop sprinter) (ars:run-ticks 1))
               (ars:run-ticks 20)
               (- (ars:robot-x sprinter) x)))))
    (is (plusp (gone-with 1)))
    (is (= (gone-with 1) (gone-with 2) (gone-with 15)))))
