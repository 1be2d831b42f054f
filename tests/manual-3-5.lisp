;;;; manual-3-5.lisp -- robot movement: speeds, turning, driving and stopping (manual 3.5).

(in-package :ars-magna.tests)

(def-suite* manual-3-5 :in ars-magna)

;;; SPRINTER has a hall for itself: a wall with a doorway at (20 13), a block with four convex
;;; corners, something in the way at (35.5 5.5) and something that is not at (35.5 9.5). Speeds are
;;; 0.8 metres and 0.3 radians a tick unless a test sets others.
(ars:defmap proving-ground (40 30)
  (rect (0 0) (39 29) bricks 10)
  (wall (20 1) (20 12) slate 20)
  (wall (20 14) (20 28) slate 20)
  (rect (27 17) (31 21) stone 30)
  (obj barrel (35.5 5.5) ((:size 4) (:obsmove t) (:tag barrel)))
  (obj rug (35.5 9.5) ((:size 4) (:tag rug))))

(ars:defrobot sprinter (proving-ground (5.5 5.5) 0)
  :cameras (((/ pi 2) 5) ((/ pi 4) 3))
  :hands (10)
  :bins (20))

(defmacro with-sprinter ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh SPRINTER."
  `(ars:with-simulation (sprinter ,@options) ,@body))

(defun place-sprinter (x y heading)
  "Put SPRINTER at (X,Y) with HEADING."
  (ars:place-robot sprinter x y heading))

(defun sprint (command &rest arguments)
  "Issue COMMAND to SPRINTER. Return the tick and the arguments of its continuation, a list (tick
code robot result...). Checks that it was called once, in 150 ticks."
  (let ((calls (apply #'call-times 150 command sprinter arguments)))
    (is (= 1 (length calls)) "~S was answered ~D times" command (length calls))
    (first calls)))

(defun sprint-code (command &rest arguments)
  "Issue COMMAND to SPRINTER. Return the error code."
  (second (apply #'sprint command arguments)))

(defun sprinter-at-p (x y &optional (tolerance 1d-6))
  "True if SPRINTER is at (X,Y)."
  (and (near x (ars:robot-x sprinter) tolerance) (near y (ars:robot-y sprinter) tolerance)))

(defun cell-of-sprinter ()
  (ars:map-cell (ars:find-map 'proving-ground) (ars:robot-x sprinter) (ars:robot-y sprinter)))

(defun sprinter-heads-p (angle)
  "True if that is the heading of SPRINTER, whole turns included."
  (near angle (ars:robot-angle sprinter)))

(defun printed-names (specifications reader)
  (loop for specification in specifications
        collect (string-downcase (funcall reader specification))))

(defun command-heading (name)
  "Return the heading of the command NAME as the manual would print it: what its arguments are, the
resource first, what its continuation gets besides code and resource, and its error codes, sorted."
  (let ((command (ars:find-command name)))
    (list (printed-names (cons (ars:command-resource command) (ars:command-parameters command))
                    #'ars:spec-type)
          (printed-names (ars:command-results command) #'ars:spec-name)
          (sort (mapcar #'ars:error-code-keyword (ars:command-errors command)) #'string<))))

(test manual-3-5.commands-are-those-of-the-headings
  "3.5, readings 104, 106, 107: each command has the arguments, results and error codes that its
heading lists, and :NO-PLACE-TYPE besides."
  (loop for (name . heading)
          in '((ars:robot-set-speed ("robot" "speed") ("speed")
                (:negative-speed :too-high-speed))
               (ars:robot-set-turn-angle ("robot" "angle") ("turn-angle")
                (:too-high-turn-angle :too-low-turn-angle))
               (ars:robot-turn ("robot" "angle") ("angle") ())
               (ars:robot-about-face ("robot") ("angle") ())
               (ars:robot-turn-left ("robot") ("angle") ())
               (ars:robot-turn-right ("robot") ("angle") ())
               (ars:robot-align-place ("robot") ("angle")
                (:incorrect-place-type :no-place-type))
               (ars:robot-turn-corner ("robot") ("angle") (:no-corner))
               (ars:robot-go-forward ("robot" "ticks") () (:not-moving :robot-blocked))
               (ars:robot-goto-wall ("robot") () (:not-moving :robot-blocked))
               (ars:robot-goto-designator ("robot" "camera") ("camera" "designator")
                (:goto-local :not-moving :not-tracking :robot-blocked))
               (ars:robot-stop ("robot") () ())
               (ars:robot-place ("robot") ("place-type") ())
               (ars:robot-follow-wall ("robot") () (:not-moving :robot-blocked)))
        do (is (equal heading (command-heading name)) "~A" name)))

;;; Speeds.

(test manual-3-5.speeds-are-0.8-and-0.3-at-first
  "3.5, reading 92: by default a robot drives at 0.8 and turns by 0.3 a tick."
  (with-sprinter ()
    (is (= .8d0 (ars:robot-speed sprinter)))
    (is (= .3d0 (ars:robot-turn-angle sprinter)))))

(test manual-3-5.set-speed-truncates-and-signals
  "3.5, readings 91, 149: in the next tick the speed is what was asked for, cut off at 0 and
MAX-SPEED*; the error code says that it was cut off, and what was set is returned."
  (with-sprinter ()
    (loop for (asked code set) in '((.5 nil .5) (0 nil 0) (1 nil 1) (1/3 nil 1/3)
                                    (-.001 :negative-speed 0) (-7 :negative-speed 0)
                                    (1.001 :too-high-speed 1) (80 :too-high-speed 1))
          for (tick answered robot speed) = (sprint 'ars:robot-set-speed asked)
          do (is (equal (list 1 code sprinter) (list tick answered robot)) "~A" asked)
             (is (= speed (ars:robot-speed sprinter)) "~A" asked)
             (is (near set speed 1d-6) "~A" asked))))

(test manual-3-5.set-turn-angle-truncates-and-signals
  "3.5, reading 91: the same holds between MIN-TURN-ANGLE* and MAX-TURN-ANGLE*."
  (with-sprinter ()
    (loop for (asked code set) in `((.2 nil .2) (.05d0 nil .05) (,(/ pi 8) nil ,(/ pi 8))
                                    (.049 :too-low-turn-angle .05) (-1 :too-low-turn-angle .05)
                                    (.4 :too-high-turn-angle ,(/ pi 8)))
          for (tick answered robot angle) = (sprint 'ars:robot-set-turn-angle asked)
          do (is (equal (list 1 code sprinter) (list tick answered robot)) "~A" asked)
             (is (= angle (ars:robot-turn-angle sprinter)) "~A" asked)
             (is (near set angle 1d-6) "~A" asked))))

(test manual-3-5.limits-of-speeds-are-parameters
  "3.5: the limits are world parameters, so others hold where these are set."
  (with-sprinter (:parameters '((ars:max-speed* 3) (ars:max-turn-angle* 2)
                                (ars:min-turn-angle* .5d0)))
    (is (equal '(nil 3d0) (cdr (remove sprinter (sprint 'ars:robot-set-speed 3)))))
    (is (eq :too-high-speed (sprint-code 'ars:robot-set-speed 3.5)))
    (is (equal '(nil 2d0) (cdr (remove sprinter (sprint 'ars:robot-set-turn-angle 2)))))
    (is (equal '(:too-low-turn-angle .5d0)
               (cdr (remove sprinter (sprint 'ars:robot-set-turn-angle .4)))))))

(test manual-3-5.limits-hold-when-they-change-later
  "3.5, reading 93: the robot keeps to the limits as they are when it moves, and to what was set
once they allow it again."
  (with-sprinter (:clean t)
    (setf ars:max-speed* .25d0 ars:max-turn-angle* .1d0)
    (sprint 'ars:robot-go-forward 4)
    (is-true (sprinter-at-p 6.5 5.5))
    (is (= (+ 2 9) (first (sprint 'ars:robot-turn 1))))
    (setf ars:max-speed* 1 ars:min-turn-angle* .5d0 ars:max-turn-angle* 1)
    (place-sprinter 5.5 5.5 0)
    (sprint 'ars:robot-go-forward 4)
    (is-true (sprinter-at-p 8.7 5.5))
    (is (= (+ 2 1) (first (sprint 'ars:robot-turn 1))))))

(test manual-3-5.set-speed-holds-for-what-is-asked-next
  "3.5, readings 77, 94: setting the speed ends a motion, and is done even if a motion is asked
for in the same breath."
  (with-sprinter (:clean t)
    (let ((*answers* '()))
      (ars:robot-go-forward sprinter 50 (recorder 'first))
      (ars:run-ticks 10)
      (ars:robot-set-speed sprinter .5 (recorder 'speed))
      (ars:robot-go-forward sprinter 4 (recorder 'second))
      (place-sprinter 5.5 5.5 0)
      (ars:run-ticks 20)
      (is (equal (list (list :interrupt sprinter)) (answers-to 'first)))
      (is (equal (list (list nil sprinter .5d0)) (answers-to 'speed)))
      (is-true (sprinter-at-p 7.5 5.5)))))

;;; Turning.

(test manual-3-5.turn-turns-by-the-angle
  "3.5, reading 49: angles are in radians, and positive ones turn to the right, as y grows down.
The reading of the turn is returned."
  (with-sprinter (:clean t)
    (place-sprinter 5.3 7.9 0)
    (loop for angle in `(1 -1 1/4 2.5d0 ,pi -7)
          for heading = angle then (+ heading angle)
          for (nil code robot reading) = (sprint 'ars:robot-turn angle)
          do (is (equal (list nil sprinter) (list code robot)) "~A" angle)
             (is (near angle reading) "~A" angle)
             (is-true (sprinter-heads-p heading) "~A" angle))
    (is-true (sprinter-at-p 5.3 7.9) "it has turned in place")))

(test manual-3-5.turns-by-name
  "3.5: about-face turns by pi, left by -pi/2 and right by pi/2; to the right of x is y, down."
  (with-sprinter (:clean t)
    (loop for (command angle) in `((ars:robot-about-face ,pi) (ars:robot-turn-left ,(/ pi -2))
                                   (ars:robot-turn-right ,(/ pi 2)))
          for (nil code robot reading) = (sprint command)
          do (is (equal (list nil sprinter) (list code robot)) "~A" command)
             (is (near angle reading) "~A" command))
    (place-sprinter 5.5 5.5 0)
    (sprint 'ars:robot-turn-right)
    (sprint 'ars:robot-go-forward 5)
    (is-true (sprinter-at-p 5.5 9.5))))

(test manual-3-5.turning-takes-its-delay-and-a-tick-for-each-turn-angle
  "3.5, readings 79, 99: after ROBOT-TURN-DELAY*, of 2 ticks, as many ticks as the turn angle goes
into the angle; the first is that in which the delay is over."
  (with-sprinter (:clean t)
    (loop for (angle ticks) in `((0 1) (.3d0 1) (-.3d0 1) (.31 2) (.9d0 3) (1 4) (-1 4) (,pi 11))
          do (is (= (+ 2 ticks -1) (first (sprint 'ars:robot-turn angle))) "~A" angle))
    (sprint 'ars:robot-set-turn-angle .1)
    (is (= (+ 2 10 -1) (first (sprint 'ars:robot-turn 1))))
    (setf ars:robot-turn-delay* 7)
    (is (= (+ 7 10 -1) (first (sprint 'ars:robot-turn 1))))))

(test manual-3-5.angles-are-never-reduced
  "3.5, reading 50: the angle counts whole turns, to either side."
  (with-sprinter (:clean t)
    (loop repeat 5 do (sprint 'ars:robot-about-face))
    (is-true (sprinter-heads-p (* 5 pi)))
    (loop repeat 14 do (sprint 'ars:robot-turn-left))
    (is-true (sprinter-heads-p (* -2 pi)))))

(test manual-3-5.turns-return-a-reading-not-the-truth
  "3.5, reading 99: with noise the reading is the middle of what the odometer read, which is not
how far the robot has turned, but near."
  (with-sprinter (:seed 4)
    (loop for angle in '(1 -1 3 .2 -2.5)
          for before = (ars:robot-angle sprinter)
          for (nil nil nil reading) = (progn (ars:reset-odometer
                                              (ars:robot-main-odometer sprinter))
                                             (sprint 'ars:robot-turn angle))
          for turned = (- (ars:robot-angle sprinter) before)
          do (is (near reading (ars:nominal (ars:get-odometer-ang
                                             (ars:robot-main-odometer sprinter)))))
             (is (/= reading turned))
             (is (<= (abs (- reading turned)) (* ars:robot-turn-max-error* (abs angle))))
             (is (<= (abs (- turned angle)) (* ars:robot-turn-max-error* (abs angle)))))))

;;; Driving.

(test manual-3-5.go-forward-drives-for-its-ticks
  "3.5, reading 233: the time is in ticks and does not count ROBOT-MOVE-DELAY*, of 5 ticks. The
robot drives straight ahead, at its speed."
  (with-sprinter (:clean t)
    (loop for (time heading x y) in '((1 0 5.8 7.25) (5 0 9 7.25) (3 .7 6.8356 8.7961))
          do (place-sprinter 5 7.25 heading)
             (is (equal (list (+ 5 time -1) nil sprinter) (sprint 'ars:robot-go-forward time)))
             (is-true (sprinter-at-p x y 1d-4) "~A" (list time heading)))
    (setf ars:robot-move-delay* 9)
    (is (= (+ 9 2 -1) (first (sprint 'ars:robot-go-forward 2))))))

(test manual-3-5.go-forward-for-no-time-succeeds
  "3.5, reading 233: for 0 ticks or fewer the robot does not move, at any speed."
  (with-sprinter ()
    (loop for time in '(0 -3 -1/2)
          do (is (equal (list 5 nil sprinter) (sprint 'ars:robot-go-forward time))))
    (sprint 'ars:robot-set-speed 0)
    (is (null (sprint-code 'ars:robot-go-forward 0)))
    (is-true (sprinter-at-p 5.5 5.5))))

(test manual-3-5.driving-keeps-its-line-amid-noise
  "3.5, reading 96: noise changes how far the robot gets in a tick, not where it heads."
  (with-sprinter (:seed 3)
    (loop for heading in '(0 .3 1 -2.2 3)
          do (place-sprinter 12.3 14.6 heading)
             (sprint 'ars:robot-go-forward 9)
             (let ((dx (- (ars:robot-x sprinter) 12.3)) (dy (- (ars:robot-y sprinter) 14.6)))
               (is (near 0 (- (* dx (sin heading)) (* dy (cos heading))) 1d-5))
               (is (< (* 7.2 .9) (+ (* dx (cos heading)) (* dy (sin heading))) (* 7.2 1.1)))
               (is-true (sprinter-heads-p heading))))))

(test manual-3-5.walls-block-the-robot-short-of-their-cells
  "3.5, readings 53, 100: a robot that hits a wall gets :ROBOT-BLOCKED and stands just short of the
border of its cell, from any side, with noise and without."
  (dolist (clean '(t nil))
    (with-sprinter (:clean clean)
      (loop for (x y heading at-x at-y) in `((5 5 0 20 5) (5 5 ,pi 1 5) (5 5 ,(/ pi 2) 5 29)
                                             (5 5 ,(/ pi -2) 5 1) (5.5 5.5 0 20 5.5)
                                             (5.37 7.81 ,(/ pi -2) 5.37 1)
                                             (25 19 0 27 19) (38.25 19 ,pi 32 19))
            do (place-sprinter x y heading)
               (is (equal (list :robot-blocked sprinter) (rest (sprint 'ars:robot-go-forward 90))))
               (is-true (sprinter-at-p at-x at-y 1d-5) "~A" (list x y heading))
               (is-false (ars:cell-filled? (cell-of-sprinter)))))))

(test manual-3-5.obstacles-block-by-their-cells
  "3.5, reading 101: what has :OBSMOVE blocks its cell, from all sides; other things block
nothing."
  (with-sprinter (:clean t)
    (loop for (x y heading at-x at-y) in `((30 5 0 35 5) (38.9 5.9 ,pi 36 5.9)
                                           (35.1 1.5 ,(/ pi 2) 35.1 5) (35.9 12 ,(/ pi -2) 35.9 6))
          do (place-sprinter x y heading)
             (is (eq :robot-blocked (sprint-code 'ars:robot-go-forward 60)))
             (is-true (sprinter-at-p at-x at-y 1d-5) "~A" (list x y heading)))
    (place-sprinter 33 9.5 0)
    (is (null (sprint-code 'ars:robot-go-forward 6)))
    (is-true (sprinter-at-p 37.8 9.5) "over the rug")))

(test manual-3-5.the-robots-own-cell-never-blocks-it
  "3.5, reading 101: what gets in the way where the robot stands does not trap it."
  (with-sprinter (:clean t)
    (ars:move-thing (ars:find-thing 'barrel) 5.9 5.1)
    (is (null (sprint-code 'ars:robot-go-forward 5)))
    (is-true (sprinter-at-p 9.5 5.5))))

(test manual-3-5.high-speed-skips-no-walls
  "3.5, readings 100, 217: motion passes through each cell on its way, however fast it is."
  (with-sprinter (:parameters '((ars:max-speed* 9)) :seed 2)
    (sprint 'ars:robot-set-speed 9)
    (is (eq :robot-blocked (sprint-code 'ars:robot-go-forward 5)))
    (is-true (sprinter-at-p 20 5.5 1d-5) "the wall is one cell thick")
    (place-sprinter 34.5 5.5 0)
    (is (eq :robot-blocked (sprint-code 'ars:robot-go-forward 5)))
    (is-true (sprinter-at-p 35 5.5 1d-5))))

(test manual-3-5.driving-needs-speed
  "3.5: translation signals :NOT-MOVING if the speed is 0, or cannot be anything else."
  (with-sprinter ()
    (sprint 'ars:robot-set-speed 0)
    (is (equal (list 5 :not-moving sprinter) (sprint 'ars:robot-go-forward 5)))
    (is (equal (list 5 :not-moving sprinter) (sprint 'ars:robot-goto-wall)))
    (sprint 'ars:robot-set-speed .8)
    (setf ars:max-speed* 0)
    (is (eq :not-moving (sprint-code 'ars:robot-go-forward 5)))
    (is (eq :not-moving (sprint-code 'ars:robot-goto-wall)))
    (is (null (sprint-code 'ars:robot-turn 1)) "turning does not")))

(test manual-3-5.goto-wall-succeeds-at-a-wall
  "3.5, readings 53, 102: at a wall, or the edge of the map, the robot has arrived. It takes the
delay and a tick for each step, one at least."
  (with-sprinter (:clean t)
    (loop for (x y heading at-x ticks) in `((5 5 0 20 19) (5.5 13.5 0 39 42) (1.25 1.25 ,pi 1 1))
          do (place-sprinter x y heading)
             (is (equal (list (+ 5 ticks -1) nil sprinter) (sprint 'ars:robot-goto-wall)))
             (is-true (sprinter-at-p at-x y 1d-5)))
    (is (equal (list 5 nil sprinter) (sprint 'ars:robot-goto-wall)) "it is there already")))

(ars:defmap clearing (9 9))
(ars:defrobot stroller (clearing (4.5 4.5) 0))

(test manual-3-5.the-edge-of-the-map-is-a-wall
  "3.5, readings 53, 102: also at an edge of the map without a wall."
  (ars:with-simulation (stroller)
    (is (eq :robot-blocked (end-code 'ars:robot-go-forward stroller 20)))
    (is (near 9 (ars:robot-x stroller) 1d-5))
    (ars:place-robot stroller 4 4 pi)
    (is (null (end-code 'ars:robot-goto-wall stroller)))
    (is (near 0 (ars:robot-x stroller) 1d-5))))

(test manual-3-5.goto-wall-is-blocked-by-things
  "3.5, reading 102: an obstacle is no wall, even if a wall is right behind it."
  (with-sprinter ()
    (place-sprinter 33.5 5.5 0)
    (is (equal (list :robot-blocked sprinter) (rest (sprint 'ars:robot-goto-wall))))
    (ars:move-thing (ars:find-thing 'barrel) 38.5 5.5)
    (place-sprinter 35 5.5 0)
    (is (eq :robot-blocked (sprint-code 'ars:robot-goto-wall)))
    (place-sprinter 5.5 13.5 0)
    (is (null (sprint-code 'ars:robot-goto-wall)) "through the doorway")))
