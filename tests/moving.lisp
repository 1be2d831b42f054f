;;;; moving.lisp -- the commands of manual 3.5: outcomes, errors, delays, continuations.

(in-package :ars-magna.tests)

(def-suite* moving :in ars-magna)

(defmacro outcome ((&key (ticks 200)) command &rest arguments)
  "Issue COMMAND on the rover with ARGUMENTS, let TICKS pass and return what its continuation got,
after the number of ticks that had passed: (tick code robot result...). Claims that it was called
exactly once."
  `(let ((calls '()) (start (run:simulation-tick)))
     (,command rover ,@arguments
               (lambda (&rest results)
                 (push (cons (- (run:simulation-tick) start) results) calls)))
     (run:run-ticks ,ticks)
     (is (= 1 (length calls)) "~S was answered ~D times" ',command (length calls))
     (first calls)))

(defun code (outcome) (second outcome))
(defun took (outcome) (first outcome))
(defun result (outcome) (fourth outcome))

(defun own-commands ()
  "Return a list of the simulator's own commands, without those that tests have added."
  (remove (find-package :ars-magna.command) (command:all-commands)
          :key (lambda (command) (symbol-package (command:command-name command)))
          :test-not #'eq))

(defun place-rover (x y angle rover) (robot:set-robot-pose rover x y angle))

;;; Speeds.

(test set-speed.cuts-off-and-says-so
  (with-rover ()
    (loop for (speed code set) in '((0.5 nil 0.5d0) (0 nil 0d0) (-1 :negative-speed 0d0)
                                    (2 :too-high-speed 1d0))
          do (let ((outcome (outcome (:ticks 3) command:robot-set-speed speed)))
               (is (eq code (code outcome)))
               (is (= set (result outcome) (robot:robot-speed rover)))
               (is (= 1 (took outcome)))))))

(test set-turn-angle.cuts-off-and-says-so
  (with-rover ()
    (loop for (angle code set) in `((0.2 nil 0.2d0) (0.01 :too-low-turn-angle 0.05d0)
                                    (1 :too-high-turn-angle ,(/ pi 8)))
          do (let ((outcome (outcome (:ticks 3) command:robot-set-turn-angle angle)))
               (is (eq code (code outcome)))
               (is (< (abs (- set (result outcome))) 1d-6))))))

;;; Turning.

(test turn.takes-its-delay-and-a-tick-for-each-step
  "Delay 2, then ceil(1 / 0.3) steps, the first in the tick when the delay has passed."
  (with-rover (:clean t)
    (let ((outcome (outcome () command:robot-turn 1)))
      (is (null (code outcome)))
      (is (= (+ 2 3) (took outcome)))
      (is (< (abs (- 1 (result outcome))) 1d-9))
      (is (< (abs (- 1 (robot:robot-angle rover))) 1d-9)))))

(test turn.reads-its-odometry-not-the-truth
  (with-rover (:seed 3)
    (let* ((outcome (outcome () command:robot-turn 3))
           (error (- (result outcome) (robot:robot-angle rover))))
      (is (/= 0 error))
      (is (< (abs error) 0.03)))))

(test turns.by-name
  (with-rover (:clean t)
    (flet ((turned (outcome) (is (null (code outcome))) (result outcome)))
      (is (< (abs (- (turned (outcome () command:robot-about-face)) pi)) 1d-9))
      (is (< (abs (- (turned (outcome () command:robot-turn-left)) (/ pi -2))) 1d-9))
      (is (< (abs (- (turned (outcome () command:robot-turn-right)) (/ pi 2))) 1d-9))
      (is (= 0 (turned (outcome () command:robot-turn 0)))))))

;;; Driving.

(test go-forward.drives-for-its-ticks
  "Delay 5, the first step in the tick when it has passed."
  (with-rover (:clean t)
    (let ((outcome (outcome () command:robot-go-forward 4)))
      (is (null (code outcome)))
      (is (= (+ 5 3) (took outcome)))
      (is (< (abs (- (robot:robot-x rover) (+ 5.5 (* 4 0.8d0)))) 1d-9)))
    (is (null (code (outcome () command:robot-go-forward 0))))))

(test go-forward.says-that-it-is-not-for-going-back
  (with-rover (:clean t)
    (is (null (code (outcome () command:robot-go-forward -3))))
    (is-true (has-words-p (displayed) "-3 ticks do nothing" "To drive back, turn by pi"))))

(test go-forward.is-blocked-by-walls-and-things
  (with-rover (:clean t)
    (place-rover 5.5 5.5 0 rover)
    (is (eq :robot-blocked (code (outcome () command:robot-go-forward 50))))
    (is (< 9.99999 (robot:robot-x rover) 10))
    (place-rover 12.5 5.5 0 rover)
    (is (eq :robot-blocked (code (outcome () command:robot-go-forward 50))))))

(test movements.need-speed
  (with-rover ()
    (outcome () command:robot-set-speed 0)
    (is (eq :not-moving (code (outcome () command:robot-go-forward 5))))
    (is (eq :not-moving (code (outcome () command:robot-goto-wall))))
    (place-rover 5.5 1.5 0 rover)
    (is (eq :not-moving (code (outcome () command:robot-follow-wall))))))

(test goto-wall.succeeds-at-walls-only
  (with-rover (:clean t)
    (place-rover 5.5 5.5 0 rover)
    (is (null (code (outcome () command:robot-goto-wall))))
    (place-rover 12.5 5.5 0 rover)
    (is (eq :robot-blocked (code (outcome () command:robot-goto-wall))))))

(test stop.coasts-for-braking-ticks
  (with-rover (:clean t)
    (let ((interrupted '()))
      (command:robot-go-forward rover 100 (lambda (&rest results) (push results interrupted)))
      (run:run-ticks 7)
      (let* ((before (robot:robot-x rover))
             (outcome (outcome (:ticks 10) command:robot-stop)))
        (is (null (code outcome)))
        (is (< (abs (- (robot:robot-x rover) (+ before (* 2 0.8d0)))) 1d-9))
        (is (equal (list (list :interrupt rover)) interrupted)))
      (let ((before (robot:robot-x rover)))
        (outcome () command:robot-stop)
        (is (= before (robot:robot-x rover)) "a robot at rest does not coast")))))

;; The simulator has no command that drives back; one that you add can use these steps.
(test movements.go-backwards-where-what-is-left-is-negative
  (flet ((turn-back (left)
           (setf (command::operation-left
                  (time:pending-event (run:simulation-agenda time:*simulation*) rover))
                 left)))
    (with-rover (:clean t)
      (command:robot-go-forward rover 100)
      (run:run-ticks 7)
      (let ((start (robot:robot-x rover)))
        (turn-back -2.5d0)
        (run:run-ticks 10)
        (is (< (abs (- (robot:robot-x rover) (- start (* 2.5 0.8d0)))) 1d-9))))
    (with-rover (:clean t)
      (command:robot-go-distance rover 100)
      (run:run-ticks 7)
      (let ((start (robot:robot-x rover)))
        (turn-back -1.3d0)
        (run:run-ticks 10)
        (is (< (abs (- (robot:robot-x rover) (- start 1.3d0))) 1d-9))))
    (with-rover (:clean t)
      (command:robot-go-forward rover 100)
      (run:run-ticks 7)
      (turn-back -100d0)
      (run:run-ticks 1)
      (let ((start (robot:robot-x rover)))
        (is (null (code (outcome (:ticks 10) command:robot-stop))))
        (is (< (abs (- (robot:robot-x rover) (- start (* 2 0.8d0)))) 1d-9) "it coasts on")))))

(test stop.after-a-natural-end-does-not-coast
  (with-rover (:clean t)
    (command:robot-go-forward rover 3 (lambda (err robot)
                                        (declare (ignore err))
                                        (command:robot-stop robot)))
    (run:run-ticks 20)
    (is (< (abs (- (robot:robot-x rover) (+ 5.5 (* 3 0.8d0)))) 1d-9))))

(test stop.after-another-interruption-does-not-coast
  (dolist (interrupt (list (lambda () (command:robot-turn rover 1))
                           (lambda () (command:robot-set-speed rover 1))
                           (lambda () (time:grab-resource rover))))
    (with-rover (:clean t)
      (command:robot-go-forward rover 100)
      (run:run-ticks 7)
      (let ((before (robot:robot-x rover)))
        (funcall interrupt)
        (outcome (:ticks 10) command:robot-stop)
        (is (= before (robot:robot-x rover)))))))

(test other-commands.stop-at-once
  (with-rover (:clean t)
    (command:robot-go-forward rover 100)
    (run:run-ticks 7)
    (let ((before (robot:robot-x rover)))
      (outcome () command:robot-turn 0.1)
      (is (= before (robot:robot-x rover))))))

(test follow-wall.ends-with-the-wall-or-at-a-corner
  (with-rover (:clean t)
    (place-rover 9.5 3.5 (/ pi 2) rover)
    (is (null (code (outcome () command:robot-follow-wall))))
    (is (< 9 (robot:robot-y rover) 10) "the wall ends at the doorway")
    (place-rover 9.5 5.5 (/ pi -2) rover)
    (is (null (code (outcome () command:robot-follow-wall))))
    (is (< 1 (robot:robot-y rover) 1.1) "into the corner")
    (place-rover 5.5 5.5 0 rover)
    (is (null (code (outcome () command:robot-follow-wall))) "no wall, no way to go")
    (world:move-thing (world:find-thing 'pillar) (list 9.5 5.5))
    (place-rover 9.5 3.5 (/ pi 2) rover)
    (is (eq :robot-blocked (code (outcome () command:robot-follow-wall))))))

;;; Places.

(test place.reports-and-remembers
  (with-rover (:clean t)
    (place-rover 10.5 9.5 0 rover)
    (let ((outcome (outcome () command:robot-place)))
      (is (null (code outcome)))
      (is (base:same-name-p 'doorway (result outcome)))
      (is (base:same-name-p 'doorway (robot:robot-last-place rover))))
    (place-rover 5.5 5.5 0 rover)
    (is (null (result (outcome () command:robot-place))))))

(test align-place.turns-to-the-nearest-direction
  (with-rover (:clean t)
    (place-rover 10.5 9.5 0.4 rover)
    (let ((outcome (outcome () command:robot-align-place)))
      (is (null (code outcome)))
      (is (< (abs (- -0.4 (result outcome))) 1d-6))
      (is (= (took outcome) (+ 2 4 1))))
    (place-rover 5.5 5.5 0 rover)
    (is (eq :no-place-type (code (outcome () command:robot-align-place))))))

(test align-place.judges-wrong-readings
  "With nothing to sense but a false reading, it is judged wrong unless by mistake."
  (with-rover (:seed 5 :parameters '((type-false-pos* 1) (robot-align-error-prob* 0)))
    (place-rover 5.5 5.5 0 rover)
    (is (eq :incorrect-place-type (code (outcome () command:robot-align-place)))))
  (with-rover (:seed 5 :parameters '((type-false-pos* 1) (robot-align-error-prob* 1)))
    (place-rover 5.5 5.5 0 rover)
    (is (null (code (outcome () command:robot-align-place))))))

(test turn-corner.goes-round
  (with-rover (:clean t)
    (place-rover 1.5 1.5 pi rover)
    (is-true (robot:robot-place-here rover) "a concave corner")
    (let ((outcome (outcome () command:robot-turn-corner)))
      (is (null (code outcome)))
      (is (< (abs (- (abs (result outcome)) (/ pi 2))) 1d-6))
      (is (> (sin (robot:robot-angle rover)) 0.999) "along the other wall, away from the corner"))
    (place-rover 10.5 9.5 0 rover)
    (is (eq :no-corner (code (outcome () command:robot-turn-corner))))))

;;; So far.

(test go-distance.drives-so-far-at-the-speed-there-is
  (with-rover (:clean t)
    (place-rover 4.5 4.5 0 rover)
    (let ((outcome (outcome () command:robot-go-distance 2)))
      (is (null (code outcome)))
      (is (= (+ 4 3) (took outcome)))
      (is (near 6.5 (robot:robot-x rover) 1d-6))
      (is (= 0.8d0 (robot:robot-speed rover))))
    (place-rover 4.5 4.5 0 rover)
    (command:robot-set-speed rover 0.1)
    (run:run-ticks 2)
    (is (= (+ 4 7) (took (outcome () command:robot-go-distance 0.7d0)))
        "what rounding leaves takes no tick")))

(test go-distance.interrupted-leaves-the-speed-as-it-was
  (loop for tick from 1 to 6
        do (with-rover ()
             (place-rover 4.5 4.5 0 rover)
             (command:robot-go-distance rover 4.1)
             (run:run-ticks tick)
             (command:robot-stop rover)
             (run:run-ticks 5)
             (is (= 0.8d0 (robot:robot-speed rover))))))

(test go-distance.fails-as-other-driving-does
  (with-rover (:clean t)
    (signals base:wrong-argument (command:robot-go-distance rover -1))
    (is (eq :robot-blocked (code (outcome () command:robot-go-distance 100))))
    (command:robot-set-speed rover 0)
    (run:run-ticks 2)
    (is (eq :not-moving (code (outcome () command:robot-go-distance 1))))))

;;; What holds for every command.

(defun moving-commands ()
  "Return the commands that move a robot, without those of testbeds."
  (remove-if (lambda (command) (host:users-symbol-p (command:command-name command)))
             (remove :moving (command:all-commands) :key #'command:command-family :test-not #'eq)))

(defun answers-when (command &rest then)
  "Issue COMMAND, then call THEN; return what the continuation got, and what :INTERRUPT gives."
  (with-rover ()
    (let ((calls '())
          (arguments (loop for spec in (command:command-parameters command)
                           collect (case (intern (string (command:spec-type spec)) :keyword)
                                     (:camera (robot:robot-camera rover 0))
                                     (:direction :east)
                                     (t 2)))))
      (apply (command:command-name command) rover
             (append arguments (list (lambda (&rest results) (push results calls)))))
      (apply (first then) rover (rest then))
      (run:run-ticks 100)
      (values calls (list (list* :interrupt rover (results-known command rover)))))))

(defun results-known (command robot)
  "Return what the continuation of COMMAND gets if ROBOT is interrupted before that begins: its
camera, if it is a result, and NIL for all else."
  (loop for result in (command:command-results command)
        collect (and (base:same-name-p 'camera (command:spec-name result))
                     (robot:robot-camera robot 0))))

(test commands.are-interrupted-on-their-resource
  "By a grab all of them, by another command those that take time."
  (dolist (command (moving-commands))
    (multiple-value-bind (calls interrupt) (answers-when command #'time:grab-resource)
      (is (equal interrupt calls) "~A, grabbed" command))
    (multiple-value-bind (calls interrupt) (answers-when command #'command:robot-turn 1)
      (if (command::command-instant-p command)
          (is (and (= 1 (length calls)) (not (eq :interrupt (first (first calls)))))
              "~A takes no time" command)
          (is (equal interrupt calls) "~A, followed" command)))))

(test set-speed.holds-for-the-command-that-follows
  (with-rover (:clean t)
    (command:robot-set-speed rover 0.5d0)
    (command:robot-go-forward rover 4)
    (run:run-ticks 20)
    (is (< (abs (- (robot:robot-x rover) 7.5)) 1d-9))))

(test commands.check-their-arguments-at-once
  (with-rover ()
    (signals base:wrong-argument (command:robot-turn rover "far"))
    (signals base:wrong-argument (command:robot-turn 'rover 1))
    (signals base:wrong-argument (command:robot-go-forward rover nil))
    (signals base:wrong-argument (command:robot-turn rover 1 17))
    (finishes (command:robot-turn rover 1 nil))
    (finishes (command:robot-turn rover 1))))

(test commands.refuse-senseless-numbers
  (with-rover ()
    (dolist (value (list 1d30 (- (expt 10 400)) sb-ext:double-float-positive-infinity))
      (signals base:wrong-argument (command:robot-turn rover value))
      (signals base:wrong-argument (command:robot-go-forward rover value))
      (signals base:wrong-argument (robot:place-robot rover 3 3 value)))))

(test commands.put-bad-parameters-back
  "A delay set to nonsense is put back, with a message, before a command reads it."
  (with-rover ()
    (setf base:robot-turn-delay* -3)
    (is (null (code (outcome () command:robot-turn 0.1))))
    (is (= 2 base:robot-turn-delay*))
    (is (search "robot-turn-delay*" (displayed)))
    (setf base:robot-turn-delay* 1.5)
    (is (null (code (outcome () command:robot-turn 0.1))))))

(test commands.take-continuations-from-continuations
  (with-rover (:clean t)
    (is (equal '(:turned :driven :stopped)
               (recording (record)
                 (command:robot-turn
                  rover 0.3
                  (lambda (err robot angle)
                    (declare (ignore err angle))
                    (record :turned)
                    (command:robot-go-forward
                     robot 2
                     (lambda (err robot)
                       (declare (ignore err))
                       (record :driven)
                       (command:robot-stop robot (lambda (err robot)
                                                   (declare (ignore err robot))
                                                   (record :stopped)))))))
                 (run:run-ticks 100))))))

(test commands.survive-bad-continuations
  (with-rover ()
    (command:robot-turn rover 0.1 (lambda (err) (declare (ignore err)) nil))
    (command:robot-turn rover 0.1 (lambda (&rest r) (declare (ignore r)) (error "oops")))
    (run:run-ticks 50)
    (let ((text (displayed)))
      (is (search "continuation of robot-turn" text))
      (is (search "oops" text)))
    (is (null (code (outcome () command:robot-turn 0.1))))))

(test commands.are-grabbed-away
  (with-rover ()
    (let ((calls '()))
      (command:robot-go-forward rover 100 (lambda (&rest r) (push r calls)))
      (run:run-ticks 10)
      (time:grab-resource rover)
      (run:run-ticks 1)
      (is (equal (list (list :interrupt rover)) calls))
      (let ((x (robot:robot-x rover)))
        (run:run-ticks 10)
        (is (= x (robot:robot-x rover)))))))

(test commands.report-by-messages
  (with-rover (:clean t)
    (outcome () command:robot-turn 0.5)
    (outcome () command:robot-set-speed 9)
    (is (string= (format nil "robot-turn: Robot turned 0.50~%~
                              *ERROR* -> Speed too high. Set to the maximum, 1.00~%")
                 (displayed)))))
