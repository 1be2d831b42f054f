;;;; cli-quantities.lisp -- numbers typed at the prompt with their units.

(in-package :ars-magna.tests)

(def-suite* cli-quantities :in ars-magna)

(test quantities.are-angles-as-people-say-them
  (dolist (line '("turn 90 deg" "turn 90deg" "turn 90 degrees" "turn pi/2" "turn 0.5*pi"
                  "turn 2pi/4" "turn 1/4 turn" "turn PI/2 ; a right angle" "turn 1.5707963 rad"))
    (is-true (answers-p '("robot-turn: Robot turned 1.57") (list line)) "~A" line))
  (is-true (answers-p '("robot-turn: Robot turned -3.14") '("turn -pi")))
  (is-true (answers-p '("camera-turn: Camera 0 turned 0.79") '("cam-turn 0 45 deg")))
  (is-true (answers-p '("robot-turn: Robot turned 0.79" "robot-turn: Robot turned 0.79")
                      '("repeat 2 turn 45 deg"))))

(test quantities.are-lengths-and-times
  (is (string= "Position:          (3.50,4.00)" (first (type-batch "pos 350 cm 4 m" "status"))))
  (is-true (answers-p '("Tick 3." "Tick 4.") '("step 3 ticks" "step 1")))
  (is-true (answers-p '("robot-set-speed: Speed set to 0.50") '("set-speed 0.5 m/tick"))))

(test quantities.of-another-kind-say-what-is-wanted
  (is-true (has-words-p (complaint "go-forward 5 m") "5 m is a length" "GO 5 m" "ticks"))
  (is-true (has-words-p (complaint "turn 5m") "length" "angle" "90 deg"))
  (is-true (has-words-p (complaint "go 90 deg") "an angle" "a length"))
  (is-true (has-words-p (complaint "go-forward 5 s") "RATE"))
  (is-true (has-words-p (complaint "set-speed 1 m/s") "clock"))
  (is-true (has-words-p (complaint "turn 90 degs") "degs is not a unit" "Known units"))
  (is-true (has-words-p (complaint "turn pi/0") "PI/0")))

(test quantities.units-are-in-the-help
  (is-true (has-words-p (joined (type-batch "help turn")) "radians" "90 deg"))
  (is-true (has-words-p (joined (type-batch "help go-forward")) "20 ticks")))

(test go.drives-so-far-and-keeps-the-speed
  (let ((lines (type-batch "set-speed 0.8" "go 5 m" "status")))
    (is-true (member "Position:          (15.50,10.50)" lines :test #'string=))
    (is-true (member "Speed:             0.80" lines :test #'string=))))

(test go.says-when-it-cannot
  (is-true (has-words-p (complaint "go -1") "more than 0"))
  (let ((lines (type-batch "go 500 m" "status")))
    (is-true (find "blocked" lines :test #'search))
    (is-true (member "Speed:             0.80" lines :test #'string=))))

(test go.needs-a-speed
  (let ((lines (type-batch "set-speed 0" "go 3" "status")))
    (is-true (find "its speed is 0" lines :test #'search))
    (is-true (member "Speed:             0.00" lines :test #'string=))))

(test quantities.have-pi-as-a-unit
  (is (equal (type-batch "angle 2 pi" "status") (type-batch "angle 1 turn" "status"))))
