;;;; cli.lisp -- the prompt, typed at through string streams (manual E).

(in-package :ars-magna.tests)

(def-suite* cli :in ars-magna)

;;; The room of the manual's session, as far as it shows.
(world:defmap ars-user::parlour (20 20)
  (rect (0 0) (20 20) bricks 30)
  (obj lamp (10.5 10.5) ((:size 2) (:weight 1) (:color lightred) (:substance metal)))
  (obj small-box (10.5 10.5) ((:capacity 5) (:size 5) (:weight 2) (:substance wood))
    (pen ((:size .2) (:color green)))))

(robot:defrobot ars-user::butler (ars-user::parlour (10.5 10.5) 0)
  :cameras (((/ pi 4) 3) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(defun lines-of (text)
  "Return the lines of TEXT as a list."
  (with-input-from-string (in text)
    (loop for line = (read-line in nil) while line collect line)))

(defun joined (lines) (format nil "~{~A~%~}" lines))

(defun type-lines (lines &rest options)
  "Type LINES in a session with OPTIONS in a fresh, clean parlour. Return what it writes, as a list
of lines, and the number of errors."
  (let* ((output (make-string-output-stream))
         (session (apply #'cli:make-session :input (make-string-input-stream (joined lines))
                                            :output output options)))
    (run:call-with-simulation (lambda () (cli:run-session session)) '(ars-user::butler)
                                :clean t :journal t)
    (values (lines-of (get-output-stream-string output)) (cli:session-errors session))))

(defun type-batch (&rest lines) (type-lines lines :batch t))

(defun answers-p (expected lines)
  "True if LINES, in a batch, make the session write just the lines EXPECTED."
  (equal expected (apply #'type-batch lines)))

(defun complaint (line)
  "Return the only line that LINE makes the session write, which must be an error."
  (multiple-value-bind (written errors) (type-batch line)
    (is (= 1 errors) "~A made ~D errors" line errors)
    (is (= 1 (length written)) "~A wrote ~S" line written)
    (is (eql 0 (search "*ERROR* -> " (first written))) "~A wrote ~S" line written)
    (first written)))

(defun has-words-p (text &rest words)
  (every (lambda (word) (search word text :test #'char-equal)) words))

;;; Layout.

(defparameter *manual-session*
  '("Robot> obj-desig 0 local ((:size 5))"
    "Robot> get-designator: Camera 0 found Designator 0"
    "Robot> cam-track 0 0"
    "Robot> camera-track: Camera 0 tracking Designator 0"
    "Robot> cam-track 1 0"
    "Robot> camera-track: Camera 1 tracking Designator 0"
    "Robot> cameras"
    "CAMERA FIELD RES ANGLE"
    "-----"
    "0    0.79 3    0.00 Tracking Local Object designator @ 0.00, 0.00"
    "1    1.57 5    0.00 Tracking Local Object designator @ 0.00, 0.00"
    "Robot> cam-insert-desig 0"
    "Robot> "
    "*WARNING* -> Camera 0 moved. No longer tracking Designator 0"
    "camera-insert: Camera 0 inserted into SMALL-BOX#3"
    "Robot> obj-desig 0 local ((:size 1 2))"
    "Robot> get-designator: Camera 0 found Designator 1"
    "Robot> cam-track 0 1"
    "Robot> camera-track: Camera 0 tracking Designator 1"
    "Robot> hand-grasp 0 0"
    "Robot> "
    "*ERROR* -> Hand 0 not in same location as Camera 0"
    "Robot> hand-insert-desig 0 1"
    "Robot> hand-insert: Hand 0 inserted into SMALL-BOX#3"
    "Robot> hand-grasp 0 0"
    "Robot> hand-grasp: Hand 0 grasped PEN#2"
    "Robot> hand-remove 0"
    "Robot> "
    "*WARNING* -> PEN#2 has moved"
    "*WARNING* -> Removing Designator 1"
    "*WARNING* -> Designator 1 no longer valid. Camera 0 lost track"
    "hand-remove: Hand 0 removed from SMALL-BOX#3"
    "Robot> hand-insert-bin 0 1"
    "Robot> "
    "*WARNING* -> PEN#2 has moved"
    "hand-insert: Hand 0 inserted into Storage-bin 1"
    "Robot> hands"
    "HAND STRENGTH GRASPING"
    "-----"
    "0      10      PEN#2          Located in storage-bin."
    "1      4"
    "Robot> hand-ungrasp 0"
    "Robot> hand-ungrasp: Hand 0 dropped PEN#2 into Storage-bin 1"
    "Robot> bin-close 1"
    "Robot> "
    "*ERROR* -> Hand 0 still in Storage-bin 1"
    "Robot> hand-remove 0"
    "Robot> hand-remove: Hand 0 removed from Storage-bin 1"
    "Robot> bin-close 1"
    "Robot> storage-bin-close: Storage-bin 1 closed"
    "Robot> bins"
    "BIN STATUS TOTAL-CAP CURRENT-CAP CONTENTS"
    "-----"
    "0  Open      20      20.0"
    "1  Closed    5        4.8  PEN#2"
    "Robot> ")
  "The session of manual E, in a clean simulation and without its STATUS.")

(defun typed-in (session)
  "Return what the user typed in SESSION, a list of lines: what follows a prompt and is no message."
  (loop for line in session
        for text = (and (eql 0 (search "Robot> " line)) (subseq line 7))
        when (and text (string/= text "") (not (search ": " text)))
          collect text))

(test session.is-that-of-the-manual
  (let ((written (type-lines (typed-in *manual-session*) :echo t)))
    (loop for expected in *manual-session*
          for line in written
          do (is (string= expected line)))
    (is (= (length *manual-session*) (length written)))))

(test status.has-the-manuals-layout
  (is-true (answers-p '("Position:          (10.50,10.50)"
                        "D Position:        (0.00,0.00)"
                        "Est D Position:    (0.00,0.00)"
                        "Angle:             0.00"
                        "Speed:             0.80"
                        "Turn Angle:        0.30"
                        "View:  Camera 0: 30.00 30.00 30.00"
                        "          Camera 1: 30.00 30.00 30.00 30.00 30.00"
                        "Place:             NIL"
                        "Designators:")
                      '("status")))
  (is (equal '("Designators:" "0 Local Object @ 0.00, 0.00")
             (subseq (type-batch "(set-seed 1)" "obj-desig 0 local ((:size 5))" "status") 11 13)))
  (is (equal "          Camera 1: TRACK 30.00 30.00 30.00 30.00 30.00"
             (find "TRACK" (type-batch "obj-desig 0 local ((:size 5))" "cam-track 1 0" "status")
                   :test #'search))))

(test status.says-what-thinking-costs-unless-that-is-as-usual
  (flet ((said (form)
           (find "Thinking:" (type-batch form "status") :test #'search)))
    (is (null (said "(set-thinking :free)")))
    (is (equal "Thinking:          charged" (said "(set-thinking :charged)")))
    (is (equal "Thinking:          charged, and a tick for 30 steps"
               (said "(set-thinking '(:charged :budget 30))")))))

(test status.changes-nothing
  (flet ((state (&rest lines)
           (car (last (apply #'type-batch (append lines '("(state-digest)")))))))
    (is (string= (state "go-forward 2") (state "status" "go-forward 2" "status" "map" "things")))))

(test things.lists-all-with-places-and-attributes
  (is (equal '("LAMP#1 @ (10.50,10.50)"
               "  :SIZE 2 :WEIGHT 1 :COLOR Lightred :SUBSTANCE Metal"
               "PEN#2 in SMALL-BOX#3"
               "  :SIZE 0.2 :COLOR Green"
               "SMALL-BOX#3 @ (10.50,10.50)"
               "  :CAPACITY 5 :SIZE 5 :WEIGHT 2 :SUBSTANCE Wood")
             (type-batch "things"))))

(test messages.continue-the-prompt-or-start-a-line
  (flet ((shown (&rest reports)
           (let* ((base:*message-queue* (base:make-message-queue))
                  (time:*simulation* nil)
                  (output (make-string-output-stream))
                  (session (cli:make-session :output output)))
             (cli::show-prompt (cli::session-console session) "Robot> ")
             (mapc #'funcall reports)
             (cli::show-messages session)
             (get-output-stream-string output))))
    (is (equal (format nil "Robot> done~%Robot> ")
               (shown (lambda () (base:message-set "done")))))
    (is (equal (format nil "Robot> ~%*ERROR* -> no~%Robot> ")
               (shown (lambda () (base:error-set "no")))))
    (is (equal (format nil "Robot> ~%*WARNING* -> oh~%done~%Robot> ")
               (shown (lambda () (base:warning-set "oh")) (lambda () (base:message-set "done")))))
    (is (equal "Robot> " (shown)))
    (let ((base:flush-all-errors* t))
      (is (equal "Robot> " (shown (lambda () (base:error-set "no"))))))))

;;; Which command.

(test names.may-be-full-or-cut-short
  (let ((line (cli:find-line-command "go-forward")))
    (is (string= "GO-FORWARD" (cli:line-name line)))
    (dolist (name '("GO-F" "robot-go-forward" "Robot-Go-F"))
      (is (string= "GO-FORWARD" (cli:line-name (cli:find-line-command name))) "~A" name)))
  (is (string= "STOP" (cli:line-name (cli:find-line-command "stop"))))
  (is (string= "OBJ-DESIG" (cli:line-name (cli:find-line-command "obj"))))
  (is-true (has-words-p (complaint "goto") "GOTO-DESIG" "GOTO-WALL"))
  (is-true (has-words-p (complaint "sttus") "STATUS"))
  (is-true (has-words-p (complaint "xyzzyplugh") "HELP")))

(test names.are-those-of-the-manual
  (dolist (name '("ALIAS" "EVAL" "REPEAT" "HELP" "QUIT" "MENU-BIN" "MENU-CAMERA" "MENU-HAND" "BINS"
                  "CAMERAS" "HANDS" "THINGS" "STATUS" "POS" "ANGLE" "OBJ-DESIG" "PLACE-DESIG"
                  "CAM-INSERT-DESIG" "CAM-INSERT-BIN" "HAND-INSERT-BIN" "HAND-INSERT-DESIG"
                  "SET-SPEED" "SET-TURN-ANGLE" "TURN" "ABOUT-FACE" "TURN-LEFT" "TURN-RIGHT"
                  "TURN-CORNER" "ALIGN-PLACE" "GO-FORWARD" "GOTO-WALL" "FOLLOW-WALL" "GOTO-DESIG"
                  "STOP" "PLACE" "CAM-TRACK" "CAM-UNTRACK" "CAM-VIEW" "CAM-TURN" "CAM-ALIGN-ROBOT"
                  "CAM-ALIGN-PLACE" "CAM-REMOVE" "ALL-OBJ-DESIG" "ALL-PLACE-DESIG" "HAND-GRASP"
                  "HAND-UNGRASP" "HAND-GRASP-CHECK" "HAND-TRACK" "HAND-REMOVE" "BIN-OPEN"
                  "BIN-CLOSE"))
    (is (string= name (cli:line-name (cli:find-line-command name))))))

(test lines.that-make-no-sense-say-what-they-take
  (is-true (has-words-p (complaint "turn") "TURN angle" "radians"))
  (is-true (has-words-p (complaint "turn fast") "FAST" "TURN angle" "radians"))
  (is-true (has-words-p (complaint "turn 1 2") "2" "too much" "TURN angle"))
  (is-true (has-words-p (complaint "obj-desig 0 local ((:size 5)") "parenthesis" "OBJ-DESIG"))
  (is-true (has-words-p (complaint "turn #<no>") "cannot be read" "TURN angle"))
  (is-true (has-words-p (complaint "cam-view 2") "no camera 2" "numbered from 0"))
  (is-true (has-words-p (complaint "cam-track 0 0") "no designator 0"))
  (is-true (has-words-p (complaint "obj-desig 0 near ((:size 5))") "local or non-local"))
  (is-true (has-words-p (complaint "hand-grasp 0 0") "Camera 0" "not tracking"))
  (is-true (has-words-p (complaint "pos 100 5") "100" "20"))
  (is-true (has-words-p (complaint "params no-such-thing 1") "no-such-thing"))
  (is-true (has-words-p (complaint "help frobnicate") "frobnicate")))

(test lines.may-be-blank-or-comments
  (is-true (answers-p '("3" "Tick 1.") '("#!/bin/sh" "" "   " "; nothing" "(+ 1 2) ; three"
                                         "step 1 ; one")))
  (is-true (answers-p '("3" "Tick 1." "Tick 3." "(T #(1) #\\#)")
                      '("# note" "(+ 1 2) # three (" "step 1 # one" "step 2 #"
                        "(list #t #(1) #\\#) # syntax" "quit # bye" "(+ 4 4)")))
  (is-true (has-words-p (complaint "step 1 #no") "STEP")))

(test lines.that-begin-with-a-sharp-are-comments-words-or-lisp
  (is-true (answers-p '("#(1 2)" "3" "5" "31" "7" "2")
                      '("#" "  #  note" "#(1 2)" "#.(+ 1 2)" "#+sbcl (+ 2 3)" "#x1F"
                        "#-sbcl (oops)" "#+(or)" "(oops)" "#-sbcl" "#| |# (oops) (+ 3 4)"
                        "(length #+(or) 1 '(1 2)) #-sbcl (oops)")))
  (is-true (has-words-p (first (type-batch "#'car")) "#<" "CAR"))
  (dolist (line '("#foo" "#!foo" "#b2" "#car (+ 1 2)"))
    (is-true (has-words-p (joined (type-batch "#" line)) "There is no command #") "~A" line)))

;;; The prompt's own commands.

(test help.comes-from-the-definitions
  (let ((menu (joined (type-batch "help"))))
    (dolist (line (remove-if #'cli::other-testbeds-line-p (cli:all-line-commands)))
      (when (member (cli::line-family line) '(:general :seeing :running :moving))
        (is-true (search (cli:line-name line) menu) "~A" line))))
  (is-true (has-words-p (joined (type-batch "help go-forward")) "GO-FORWARD time" "ticks"
                       ":ROBOT-BLOCKED" "robot-go-forward" "3.5"))
  (is-true (has-words-p (joined (type-batch "menu-camera")) "CAM-TRACK camera designator"))
  (is-true (has-words-p (joined (type-batch "menu-hand")) "HAND-GRASP hand cam"))
  (is-true (has-words-p (joined (type-batch "menu-bin")) "BIN-CLOSE")))

(test alias.stands-for-a-line
  (let ((cli::*aliases* '()))
    (is-true (answers-p '("FWD = go-forward 2" "robot-go-forward: Robot stopped")
                        '("alias fwd go-forward 2" "alias" "fwd")))
    (is-true (has-words-p (complaint "alias stop go-forward 2") "STOP"))
    (is-true (has-words-p (complaint "alias nobody") "NOBODY"))
    (is-true (has-words-p (joined (type-batch "alias loop loop" "loop")) "no command LOOP"))))

(test repeat.waits-for-each
  (is-true (answers-p '("robot-turn: Robot turned 0.50" "robot-turn: Robot turned 0.50"
                        "robot-turn: Robot turned 0.50" "1.5")
                      '("repeat 3 turn .5" "(robot-angle butler)"))))

(test lisp.is-evaluated-as-users-write-it
  (is-true (answers-p '("6") '("(+ 1" "   2" "3)")))
  (is-true (answers-p '("(T NIL)" "7") '("(list #t #f)" "eval (+ 3 4)")))
  (is-true (answers-p '("1" "2") '("(values 1 2)" "(values)")))
  (is-true (answers-p '("camera-turn: Camera 0 turned 0.50" "turned 0.5")
                      (list (format nil "(camera-turn (robot-camera butler 0) 0.5~@
                                           (continuation (err cam ang) (out \"turned \" ang t)))")))
           "a program hears of what ended"))

(test lisp.that-fails-says-why-in-a-line
  (is-true (has-words-p (complaint "(car 1)") "1" "LIST"))
  (is-true (has-words-p (complaint "(no-such-function)") "NO-SUCH-FUNCTION"))
  (is-true (has-words-p (complaint "(list 1") "not complete"))
  (is-true (has-words-p (complaint "(robot-go-forward butler 'far)") "far" "ticks")))

(test params.shows-and-sets
  (is-true (has-words-p (first (type-batch "params max-speed")) "max-speed*" "1" "cells per tick"))
  (is-true (has-words-p (first (type-batch "params max-speed .5")) "0.5" "(default 1)"))
  (is (= 1 base:max-speed*) "a headless prompt sets its own parameters")
  (is-true (has-words-p (joined (type-batch "params")) "Hands" "bin-delay*")))

(test params.sets-all-at-once
  (flet ((last-of (&rest lines) (first (last (apply #'type-batch lines)))))
    (is (equal "The parameters are now: default." (last-of "params braking 3" "params default")))
    (is (equal "The parameters are now: clean." (last-of "params clean")))
    (is (equal "The parameters are now: clean, 1 other changed."
               (last-of "params motion-noise .5" "params braking 3" "params CLEAN")))
    (is-true (has-words-p (last-of "params clean" "(print motion-noise*)") "0"))
    (is-true (has-words-p (last-of "params default" "(print motion-noise*)") "0.1")))
  (is-true (has-words-p (complaint "params clean 3") "PARAMS CLEAN takes no value")))

(test pos-and-angle.put-the-robot-there
  (let ((status (type-batch "pos 3.5 4" "angle 1.25" "status")))
    (is (string= "Position:          (3.50,4.00)" (first status)))
    (is (string= "D Position:        (0.00,0.00)" (second status)))
    (is (string= "Angle:             1.25" (fourth status)))))

(test map.shows-walls-things-and-the-robot
  (let ((map (type-batch "pos 3.5 4" "angle 1.5" "map")))
    (is (string= "   0 ####################" (second map)))
    (is (char= #\v (char (nth 5 map) 8)) "the robot looks down")
    (is-true (has-words-p (joined map) "# wall" "v BUTLER (3.50,4.00)" "l LAMP" "s SMALL-BOX"))))

(test quit.ends-the-session
  (is-true (answers-p '("1") '("(+ 0 1)" "quit" "(+ 1 1)"))))

;;; Batches and journals.

(test batch.counts-errors
  (flet ((errors (&rest lines) (nth-value 1 (apply #'type-batch lines))))
    (is (= 0 (errors "go-forward 2" "status")))
    (is (= 1 (errors "go-forward 2" "frobnicate")))
    (is (= 1 (errors "bin-open 0")) "a robot that fails is an error")
    (is (= 2 (errors "(error \"no\")" "(error-set 1)")))
    (is (= 0 (errors "(warning-set 1)" "(message-set 1)")))))

(test batch.is-the-same-each-time
  (let ((lines '("seed 7" "(dirty-simulation)" "go-forward 3" "turn 1" "repeat 2 go-forward 2"
                 "status" "(state-digest)")))
    (is (equal (apply #'type-batch lines) (apply #'type-batch lines)))))

(test journals.are-saved-and-replayed
  (uiop:with-temporary-file (:pathname path :type "journal")
    (let* ((name (uiop:native-namestring path))
           (saved (first (last (type-batch "go-forward 3" "turn 1"
                                           (format nil "save-journal \"~A\"" name)))))
           (replayed (first (type-batch (format nil "replay ~A" name)))))
      (is-true (has-words-p saved "tick" "state"))
      (is (string= (subseq saved (search ": " saved)) (subseq replayed (search ": " replayed))))))
  (is-true (has-words-p (complaint "replay /no/such/file") "/no/such/file")))

;;; The arguments of the program.

(test options.are-read
  (is (equal '((:world "tiny") (:seed 3) (:rate :free) (:batch t))
             (cli::parse-options '("--world" "tiny" "--seed=3" "--rate" "free" "--batch"))))
  (dolist (arguments '(("--frob") ("--seed" "x") ("--rate" "0") ("--rate") ("--batch=1") ("tiny")))
    (signals cli::usage-error (cli::parse-options arguments))))

(test options.are-all-in-the-usage
  (let ((usage (base:read-file-into-string
                (asdf:system-relative-pathname "ars-magna" "cli/shell/usage.txt"))))
    (loop for (option) in cli::*options*
          do (is-true (search option usage) "~A" option))))

(test worlds.are-found-by-name-or-file
  (is (member 'ars-user::butler (cli::robot-names-in-world "PARLOUR")))
  (signals cli:bad-line (cli::robot-names-in-world "no-such-world"))
  (uiop:with-temporary-file (:pathname path :stream stream :type "lisp")
    (format stream "#| A #| loft |# (oops) |# ; (and) so on~%~
                    (defmap attic (5 5)) (defrobot bat (attic (2 2) 0))")
    :close-stream
    (is (equal '("BAT") (mapcar #'symbol-name
                                (cli::robot-names-in-world (uiop:native-namestring path)))))))

;;; Aliases, restarts, errors that repeat.

(test alias.leads-to-a-command
  (loop for (line . words) in '(("alias zig zig" "would stand for itself")
                                ("alias zig zork" "There is no command ZORK"))
        do (let ((cli::*aliases* '()))
             (multiple-value-bind (lines errors) (type-batch line)
               (is (= 1 errors))
               (is-true (apply #'has-words-p (first lines) words))
               (is (null cli::*aliases*))))))

(test help.knows-restarts-and-what-codes-mean
  (loop for (name . words) in '(("skip-definition" "SKIP-DEFINITION, restart" "invoke-restart")
                                ("save-without" "SAVE-WITHOUT, restart")
                                ("interrupt" "INTERRUPT, error code" "A newer request")
                                (":bin-jammed" "BIN-JAMMED, error code" "Close it again"))
        do (multiple-value-bind (lines errors) (type-batch (format nil "help ~A" name))
             (is (= 0 errors))
             (is-true (apply #'has-words-p (base:one-line (joined lines)) words) "~A" lines))))
