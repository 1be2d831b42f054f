;;;; manual-e.lisp -- The command-line interface (manual appendix E).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-e :in ars-magna)

(defmap bedroom (24 16)
  (rect (0 0) (24 16) plaster 30)
  (wall (14 1) (14 6) plaster 30)
  (wall (14 8) (14 14) plaster 30)
  (obj vase (7 7) ((:size 2) (:weight 1) (:color lightred)))
  (obj hamper (7 7) ((:capacity 5) (:size 6) (:weight 2) (:substance wood))
    (sock ((:size .4) (:color green))))
  (obj chair (11 4.5) ((:size 12) (:weight 30) (:color blue))))

(defrobot nanny (bedroom (7 7) 0)
  :cameras ((1 3) (2 5)) :hands (10 4) :bins (20 5))

(defun typed-with (options lines)
  "Type LINES at a prompt with OPTIONS and the robot NANNY. Return its output, a list of lines, and
the number of errors."
  (let* ((output (make-string-output-stream))
         (session (apply #'make-session :output output
                                        :input (make-string-input-stream (joined lines)) options)))
    (with-simulation (nanny :clean t)
      (run-session session))
    (values (lines-of (get-output-stream-string output)) (session-errors session))))

(defun typed (&rest lines)
  "Return what the prompt writes when LINES are typed, without the prompts."
  (typed-with '(:batch t) lines))

(defun errors (&rest lines)
  "Return how many errors LINES make."
  (nth-value 1 (typed-with '(:batch t) lines)))

(defun transcript (&rest lines)
  "Return what stands on the screen when LINES are typed."
  (typed-with '(:echo t) lines))

(defun last-line (&rest lines) (first (last (apply #'typed lines))))

(defun line-with (word &rest lines)
  "Return the first line with WORD of what the prompt writes when LINES are typed."
  (find word (apply #'typed lines) :test #'search))

(defun new-sock (part index)
  "Return a line that makes a sock, of size .5, in the hand or bin that PART and INDEX say."
  (format nil "(null (new-thing sock (~A (first (simulation-robots)) ~D) ((:size .5))))"
          part index))

;;; Lines.

(test manual-e.the-prompt-is-robot
  "E: the prompt Robot> shows that input is expected; after an answer there is a new one."
  (is (equal '("Robot> stop" "Robot> robot-stop: Robot stopped" "Robot> ") (transcript "stop"))))

(test manual-e.commands-are-a-name-and-arguments
  "E: a line is a command name and its arguments, separated by spaces; case does not matter."
  (let ((said '("robot-turn: Robot turned 0.50")))
    (is (equal said (typed "turn 0.5")))
    (is (equal said (typed "  TURN    0.5  ")))
    (is (equal said (typed "Turn 1/2")))))

(test manual-e.parentheses-escape-to-lisp
  "E, reading 205: a line in parentheses is a Lisp expression, and EVAL takes any."
  (is (equal '("7") (typed "(+ 3 4)")))
  (is (equal '("7") (typed "  (+ 3 4)")))
  (is (equal '("7" "(A B)") (typed "eval (+ 3 4)" "eval '(a b)")))
  (is (equal '("7.0") (typed "(values (robot-x (first (simulation-robots))))")))
  (is (equal '("robot-turn: Robot turned 1.00")
             (typed "(robot-turn (first (simulation-robots)) 1 nil)"))))

(test manual-e.parts-are-numbers-and-the-robot-is-assumed
  "E: cameras, hands, designators and bins are given by their indices, which are those displayed;
the robot is never specified."
  (is (equal '("camera-turn: Camera 1 turned 0.50") (typed "cam-turn 1 .5")))
  (is (equal '("storage-bin-close: Storage-bin 1 closed") (typed "bin-close 1")))
  (is (equal '("robot-go-forward: Robot stopped") (typed "go-forward 2")))
  (is (= 2 (errors "cam-view 2" "hand-remove -1" "turn .5"))))

(test manual-e.unknown-commands-are-errors
  "E: an unknown command or wrong arguments give a message, and the prompt continues."
  (is (equal '(1 1 1 0) (list (errors "levitate") (errors "turn") (errors "turn left 2")
                              (errors "turn 1"))))
  (is (equal "7" (last-line "levitate" "(+ 3 4)"))))

;;; Messages.

(test manual-e.messages-come-when-operations-are-over
  "E: a message is displayed after an operation is finished, and states the result."
  (is (equal '("robot-about-face: Robot turned 3.14" "robot-go-forward: Robot stopped"
               "camera-view: Camera 0 sees 30.00 30.00 30.00")
             (typed "about-face" "go-forward 1" "cam-view 0"))))

(test manual-e.errors-are-marked
  "E, reading 197: errors begin with *ERROR* ->, on a line of their own, and have no command
prefix."
  (is (equal '("Robot> hand-ungrasp 0" "Robot> " "*ERROR* -> Hand 0 is not holding anything"
               "Robot> ")
             (transcript "hand-ungrasp 0"))))

(test manual-e.warnings-are-marked-and-come-first
  "E, readings 87 and 197: warnings, of what happens as a consequence, begin with *WARNING* -> and
stand before the message of the operation."
  (is (equal '("*WARNING* -> SOCK#2 has moved" "*WARNING* -> Removing Designator 0"
               "*WARNING* -> Designator 0 no longer valid. Camera 0 lost track"
               "hand-remove: Hand 0 removed from HAMPER#3")
             (last (typed "obj-desig 0 local ((:size 6))" "cam-track 0 0"
                          "hand-insert-desig 0 0" "cam-insert-desig 0"
                          "obj-desig 0 local ((:size .4))" "cam-track 0 0" "hand-grasp 0 0"
                          "hand-remove 0")
                   4))))

(test manual-e.own-messages-are-shown-likewise
  "E, 3.7: ERROR-SET, WARNING-SET and MESSAGE-SET of one's own programs are shown in the same
forms."
  (is (equal '("*ERROR* -> no 1" "*WARNING* -> oh" "well")
             (remove "NIL" (typed "(progn (error-set \"no \" 1) nil)"
                                  "(progn (warning-set \"oh\") nil)"
                                  "(progn (message-set \"well\") nil)")
                     :test #'string=))))

(test manual-e.flush-all-errors*-discards-messages
  "3.7, reading 207: while it is true no messages are displayed."
  (is (equal '("robot-turn: Robot turned 1.00")
             (remove "T" (remove "NIL" (typed "(setf flush-all-errors* t)" "turn .5"
                                              "(setf flush-all-errors* nil)" "turn 1")
                                 :test #'string=)
                     :test #'string=))))

;;; Built-in commands.

(test manual-e.alias
  "E: ALIAS alias cmd defines an alias; ALIAS alone displays those that there are."
  (let ((lines (typed "alias spin turn .5" "alias" "spin")))
    (is-true (has-words-p (first lines) "spin" "turn .5"))
    (is (equal "robot-turn: Robot turned 0.50" (second lines)))))

(test manual-e.repeat
  "E, reading 204: REPEAT num cmd repeats the command so often, each time when the last is over."
  (is (equal '("robot-turn: Robot turned 0.50" "robot-turn: Robot turned 0.50"
               "robot-turn: Robot turned 0.50")
             (typed "repeat 3 turn .5"))))

(test manual-e.help
  "E: HELP displays the menu of built-in commands and of those that affect movement and turning;
with a command, help for that."
  (let ((menu (joined (typed "help"))))
    (dolist (name '("ALIAS" "EVAL" "REPEAT" "HELP" "QUIT" "MENU-BIN" "MENU-CAMERA" "MENU-HAND"
                    "BINS" "CAMERAS" "HANDS" "THINGS" "STATUS" "POS" "ANGLE" "TURN"
                    "GO-FORWARD" "STOP"))
      (is-true (search name menu) "~A" name)))
  (is-true (has-words-p (joined (typed "help turn-left")) "TURN-LEFT" "left")))

(test manual-e.menus
  "E: MENU-BIN, MENU-CAMERA and MENU-HAND display the commands for manipulating those."
  (loop for (menu . names) in '(("menu-bin" "BIN-OPEN" "BIN-CLOSE")
                                ("menu-camera" "OBJ-DESIG" "PLACE-DESIG" "CAM-TRACK" "CAM-TURN"
                                 "CAM-VIEW" "CAM-INSERT-DESIG" "CAM-INSERT-BIN" "CAM-REMOVE")
                                ("menu-hand" "HAND-GRASP" "HAND-UNGRASP" "HAND-INSERT-BIN"
                                 "HAND-INSERT-DESIG" "HAND-REMOVE"))
        for text = (joined (typed menu))
        do (dolist (name names) (is-true (search name text) "~A: ~A" menu name)))
  (is-false (search "BIN-OPEN" (joined (typed "menu-hand")))))

(test manual-e.quit
  "E, reading 205: QUIT exits the prompt; the simulator keeps running, with the commands in
progress."
  (is (equal '("7") (typed "(+ 3 4)" "quit" "(+ 1 1)")))
  (with-simulation (nanny :clean t)
    (run-session (make-session :output (make-broadcast-stream) :batch t :patient nil
                               :input (make-string-input-stream (joined '("quit")))))
    (robot-turn nanny 1 nil)
    (run-ticks 9)
    (is (near 1 (robot-angle nanny) 1e-6))))

(test manual-e.bins
  "E, reading 203: BINS displays status, total and current capacity, and contents."
  (is (equal '("BIN STATUS TOTAL-CAP CURRENT-CAP CONTENTS" "-----"
               "0  Open      20      20.0" "1  Closed    5        4.5  SOCK#5")
             (last (typed (new-sock "robot-storage-bin" 1)
                          "bin-close 1" "bins")
                   4))))

(test manual-e.cameras
  "E: CAMERAS displays field of view, resolution, angle, location and the designator tracked."
  (is (equal '("CAMERA FIELD RES ANGLE" "-----"
               "0    1.00 3    0.00 Tracking Local Object designator @ 0.00, 0.00"
               "1    2.00 5    0.50")
             (last (typed "obj-desig 0 local ((:size 6))" "cam-track 0 0" "cam-turn 1 .5" "cameras")
                   4)))
  (is-true (has-words-p (line-with "0    1.00" "cam-insert-bin 0 1" "cameras") "storage-bin")))

(test manual-e.hands
  "E, reading 202: HANDS displays strength, location, and what is grasped."
  (is (equal '("HAND STRENGTH GRASPING" "-----"
               "0      10      SOCK#5         Located in storage-bin." "1      4")
             (last (typed (new-sock "robot-hand" 0)
                          "hand-insert-bin 0 0" "hands")
                   4))))

(test manual-e.things
  "E: THINGS displays all objects in the world with their locations and attributes."
  (let ((lines (typed "things")))
    (is (equal '("VASE#1 @ (7.00,7.00)" "SOCK#2 in HAMPER#3" "HAMPER#3 @ (7.00,7.00)"
                 "CHAIR#4 @ (11.00,4.50)")
               (remove-if (lambda (line) (char= #\Space (char line 0))) lines)))
    (is-true (find-if (lambda (line) (has-words-p line ":SIZE 12" ":WEIGHT 30" ":COLOR Blue"))
                      lines))))

(defun status-line (label &rest lines)
  "Return what STATUS shows after LABEL when it is typed behind LINES."
  (let ((line (find label (apply #'typed (append lines '("status")))
                    :test (lambda (label line) (eql 0 (search label line))))))
    (string-left-trim " " (subseq line (length label)))))

(test manual-e.status-shows-position-and-heading
  "E, readings 17 and 203: position, heading, speed and turning speed, with two decimals."
  (is (equal "(7.00,7.00)" (status-line "Position:")))
  (is (equal "-2.50" (status-line "Angle:" "angle -2.5")))
  (is (equal "0.80" (status-line "Speed:")))
  (is (equal "0.50" (status-line "Speed:" "set-speed .5")))
  (is (equal "0.30" (status-line "Turn Angle:"))))

(test manual-e.status-shows-the-last-change
  "E, readings 199 and 200: the change of position by the last movement, and its estimate."
  (is (equal "(0.00,0.00)" (status-line "D Position:")))
  (is (equal "(0.80,0.00)" (status-line "D Position:" "go-forward 4" "go-forward 1")))
  (is (equal "(0.80,0.00)" (status-line "Est D Position:" "go-forward 1"))))

(test manual-e.status-shows-views
  "E, reading 201: the views of all cameras, computed at once; TRACK precedes those that track."
  (let ((lines (typed "obj-desig 1 local ((:size 6))" "cam-track 1 0" "status")))
    (is-true (member "View:  Camera 0: 30.00 30.00 30.00" lines :test #'string=))
    (is-true (member "          Camera 1: TRACK 30.00 30.00 30.00 30.00 30.00" lines
                     :test #'string=)))
  (is (equal "NIL" (last-line "status" (format nil "(camera-last-view (robot-camera ~
                                                    (first (simulation-robots)) 0))")))
      "the robot has not looked"))

(test manual-e.status-shows-place-and-designators
  "E, reading 106: the place last sensed, and the designators that are valid, with what is known."
  (is (equal "NIL" (status-line "Place:")))
  (is (equal "DOORWAY" (status-line "Place:" "pos 14.5 7.5" "place")))
  (let ((lines (typed "obj-desig 0 local ((:size 6))" "status")))
    (is-true (member "0 Local Object @ 0.00, 0.00" lines :test #'string=))
    (is-true (search ":SIZE 6.0" (first (last lines))))))

(test manual-e.pos-and-angle
  "E: POS x y and ANGLE ang set position and angle at once, without error, and ignoring obstacles."
  (is (equal "(3.25,9.50)" (status-line "Position:" "pos 3.25 9.5")))
  (is (equal "(14.50,3.00)" (status-line "Position:" "pos 14.5 3")) "in a wall")
  (is (equal '("0") (typed "pos 2 2" "angle 1" "(simulation-tick)"))))

;;; Robot commands.

(test manual-e.most-functions-have-a-command
  "E, reading 194: the names of the commands are those of the functions without robot-, with cam-
for camera- and bin- for storage-bin-; the function's full name will do, too."
  (dolist (name '("set-speed .5" "set-turn-angle .2" "turn 1" "about-face" "turn-left" "turn-right"
                  "go-forward 1" "goto-wall" "stop" "place" "cam-view 0" "cam-turn 0 1"
                  "cam-align-robot 0" "hand-insert-bin 0 0" "bin-close 0" "robot-turn 1"
                  "camera-turn 0 1" "storage-bin-close 0" "robot-goto-wall" "follow-wall"))
    (is (= 0 (errors name)) "~A" name))
  (dolist (name '("turn-corner" "align-place" "goto-desig 0" "cam-untrack 0"
                  "cam-align-place 0" "cam-remove 0" "hand-ungrasp 0" "hand-remove 0" "bin-open 0"))
    (is-true (line-with "*ERROR*" name) "~A" name)
    (is-false (line-with "HELP" name) "~A is no command" name)))

(test manual-e.obj-desig
  "E, reading 196: OBJ-DESIG cam type specs; type is local or non-local, specs a list of
attributes."
  (is (equal '("get-designator: Camera 0 found Designator 0")
             (typed "obj-desig 0 local ((:size 6))")))
  (is (equal '("get-designator: Camera 1 found Designator 0")
             (typed "obj-desig 1 non-local ((:color blue) (:size (10 14)))")))
  (is-true (line-with "*ERROR*" "obj-desig 0 non-local ((:size 6))")))

(test manual-e.place-desig
  "E: PLACE-DESIG cam place; the type need not be given, as it is non-local."
  (is (equal '("get-designator: Camera 1 found Designator 0")
             (typed "pos 10 7.5" "place-desig 1 doorway")))
  (is (equal '("0 Non-Local Place @ 4.50, 0.00" "  Doorway")
             (last (typed "pos 10 7.5" "place-desig 1 doorway" "status") 2))))

(test manual-e.designators-have-the-smallest-free-number
  "E, reading 198: numbers begin with 0; that of a designator that is removed is free again."
  (is (equal '("get-designator: Camera 0 found Designator 0"
               "get-designator: Camera 0 found Designator 1"
               "get-designator: Camera 0 found Designator 0")
             (remove-if-not (lambda (line) (search "found" line))
                            (typed "obj-desig 0 local ((:size 6))" "obj-desig 0 local ((:size 2))"
                                   "(progn (destroy-thing (find-thing 'hamper)) nil)"
                                   "obj-desig 0 local ((:size 2))")))))

(test manual-e.inserting-cameras
  "E: CAM-INSERT-DESIG cam inserts it into what it tracks, CAM-INSERT-BIN cam bin into the bin."
  (is (equal '("*WARNING* -> Camera 0 moved. No longer tracking Designator 0"
               "camera-insert: Camera 0 inserted into HAMPER#3")
             (last (typed "obj-desig 0 local ((:size 6))" "cam-track 0 0" "cam-track 1 0"
                          "cam-insert-desig 0")
                   2)))
  (is (equal '("camera-insert: Camera 1 inserted into Storage-bin 0") (typed "cam-insert-bin 1 0")))
  (is (= 1 (errors "cam-insert-desig 0")) "it tracks nothing"))

(test manual-e.inserting-hands
  "E: HAND-INSERT-DESIG hand cam inserts it into what the camera tracks, HAND-INSERT-BIN hand bin
into the bin."
  (is (equal "hand-insert: Hand 1 inserted into HAMPER#3"
             (last-line "obj-desig 0 local ((:size 6))" "cam-track 0 0" "hand-insert-desig 1 0")))
  (is (equal '("hand-insert: Hand 1 inserted into Storage-bin 0") (typed "hand-insert-bin 1 0"))))

(test manual-e.grasping
  "E, reading 195: HAND-GRASP hand cam grasps what the camera tracks, which must be where the hand
is."
  (is (equal "hand-grasp: Hand 1 grasped VASE#1"
             (last-line "obj-desig 0 local ((:size 2))" "cam-track 0 0" "hand-grasp 1 0")))
  (is (= 1 (errors "hand-grasp 0 0")) "it tracks nothing"))

;;; A session.

(test manual-e.a-camera-first-and-a-hand-after-it
  "E, the example: two cameras track a box, so that its designator remains when one goes inside;
that one finds what is in there; the hand follows by the other camera's track, grasps, and brings
the thing into a bin, which closes once hand and thing are apart."
  (is (equal '("get-designator: Camera 0 found Designator 0"
               "camera-track: Camera 0 tracking Designator 0"
               "camera-track: Camera 1 tracking Designator 0"
               "*WARNING* -> Camera 0 moved. No longer tracking Designator 0"
               "camera-insert: Camera 0 inserted into HAMPER#3"
               "get-designator: Camera 0 found Designator 1"
               "camera-track: Camera 0 tracking Designator 1"
               "*ERROR* -> Hand 0 not in same location as Camera 0"
               "hand-insert: Hand 0 inserted into HAMPER#3"
               "hand-grasp: Hand 0 grasped SOCK#2"
               "*WARNING* -> SOCK#2 has moved"
               "*WARNING* -> Removing Designator 1"
               "*WARNING* -> Designator 1 no longer valid. Camera 0 lost track"
               "hand-remove: Hand 0 removed from HAMPER#3"
               "*WARNING* -> SOCK#2 has moved"
               "hand-insert: Hand 0 inserted into Storage-bin 1"
               "hand-ungrasp: Hand 0 dropped SOCK#2 into Storage-bin 1"
               "*ERROR* -> Hand 0 still in Storage-bin 1"
               "hand-remove: Hand 0 removed from Storage-bin 1"
               "storage-bin-close: Storage-bin 1 closed")
             (typed "obj-desig 0 local ((:size 6))" "cam-track 0 0" "cam-track 1 0"
                    "cam-insert-desig 0" "obj-desig 0 local ((:size 0 1))" "cam-track 0 1"
                    "hand-grasp 0 0" "hand-insert-desig 0 1" "hand-grasp 0 0" "hand-remove 0"
                    "hand-insert-bin 0 1" "hand-ungrasp 0" "bin-close 1" "hand-remove 0"
                    "bin-close 1"))))

(test manual-e.a-camera-inside-sees-its-container
  "E: the view of the inserted camera is the substance value of the container, several times; wood
is 120 (reading 64)."
  (is (equal '("camera-view: Camera 0 sees 120.00 120.00 120.00")
             (last (typed "obj-desig 0 local ((:size 6))" "cam-track 0 0" "cam-insert-desig 0"
                          "cam-view 0")))))
