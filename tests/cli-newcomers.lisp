;;;; cli-newcomers.lisp -- hints for users who have read nothing, and help on every name.

(in-package :ars-magna.tests)

(def-suite* cli-newcomers :in ars-magna)

;;; Words of other programs.

(test hints.lead-from-what-newcomers-type
  (loop for (line . words) in '(("left" "TURN-LEFT" "deg") ("forward 5" "GO 5 m" "GO-FORWARD")
                                ("backwards" "ABOUT-FACE") ("grab" "HAND-GRASP") ("undo" "REWIND")
                                ("wait 5" "STEP") ("ls" "THINGS"))
        do (is-true (apply #'has-words-p (complaint line) words) "~A" line)))

(test hints.name-lines-that-there-are
  (loop for (nil hint) in cli::*newcomer-hints*
        do (loop for word in (uiop:split-string hint :separator " ,.:()\"")
                 when (and (< 2 (length word)) (string= word (string-upcase word))
                           (every #'alpha-char-p word) (string/= word "FILE"))
                   do (is (member word (mapcar #'cli:line-name (cli:all-line-commands))
                                  :test (lambda (word name) (eql 0 (search word name))))
                          "~A in ~A" word hint))))

(test words.of-other-programs-will-do
  (is-true (answers-p '("3") '("(+ 1 2)" "exit" "(+ 3 4)")))
  (is (equal (type-batch "help") (type-batch "?")))
  (is (equal (type-batch "help turn") (type-batch "? turn"))))

;;; Whatever has a name.

(test help.knows-all-that-has-a-name
  (loop for (name . words) in '(("max-speed" "max-speed*" "cells per tick")
                                ("max-speed*" "The fastest")
                                ("doorway" "place type" "PLACE-DESIG")
                                ("red" ":color" "OBJ-DESIG")
                                (":size" "attribute" "A number")
                                ("wait-for" "construct" "(wait-for fluent" "Wait in a plan")
                                ("robot-turn" "function" "(robot-turn robot angle")
                                ("robot-blocked" "error code" "robot-go-forward")
                                ("wood" "substance" "120")
                                ("circle" "clause of maps" "(circle (x y) radius")
                                ("switch-on" "manipulation" "switch-on lamp [hand]")
                                ("parlour" "map" "20 by 20")
                                ("butler" "robot" "parlour")
                                ("robot-stopped*" "variable" "Pulsed"))
        do (is-true (apply #'has-words-p (joined (type-batch (format nil "help ~A" name))) words)
                    "~A" name))
  (is-true (has-words-p (complaint "help frobnicate") "APROPOS frobnicate")))

(test apropos.searches-names-and-texts
  (let ((text (joined (type-batch "apropos blocked"))))
    (is-true (has-words-p text "ROBOT-BLOCKED" "Also in the description" "ROBOT-GO-FORWARD"))
    (is (< (search "ROBOT-BLOCKED" text) (search "Also in the description" text))))
  (is-true (every (lambda (line) (<= (length line) 79)) (type-batch "apropos robot")))
  (is-true (has-words-p (complaint "apropos xyzzyplugh") "xyzzyplugh")))

(test params.are-found-by-a-part
  (is-true (has-words-p (joined (type-batch "params noise")) "motion-noise*"
                        "discrete-noise-factor*"))
  (is-true (has-words-p (complaint "params noise 1") "several")))

;;; Slips.

(test parentheses.too-many-are-told-in-a-sentence
  (is-true (has-words-p (complaint ")") "parenthesis too many"))
  (let ((lines (type-batch "(list 1 2))" "(list 3)) (list 4)")))
    (is (equal '("(1 2)" "(3)") (list (first lines) (third lines))))
    (is-true (has-words-p (second lines) "too many: )" "were evaluated"))
    (is-true (has-words-p (fourth lines) "too many: ) (list 4)"))))

(test readtables.print-as-their-names
  (is-true (answers-p '(":NISP") '("(in-readtable :nisp)"))))

;;; Without Lisp.

(test manipulate.goes-by-numbers
  (let ((lines (type-batch "(null (set-attribute (find-thing 'lamp) :type :lamp))"
                           "obj-desig 0 local ((:size 2))" "manipulate switch-on 0"
                           "(get-attribute (find-thing 'lamp) :lit)"
                           "manipulate switch-off 0 1" "(get-attribute (find-thing 'lamp) :lit)")))
    (is (equal '("T" "NIL") (list (nth 3 lines) (nth 5 lines))) "~A" lines))
  (is-true (member "  switch-on lamp [hand]" (type-batch "manipulate") :test #'string=))
  (is-true (has-words-p (complaint "manipulate switch-on 0") "no designator 0"))
  (is-true (has-words-p (complaint "manipulate switch-on") "MANIPULATE switch-on lamp [hand]"))
  (is-true (has-words-p (complaint "manipulate swich-on 0") "SWITCH-ON")))

(test designators.go-by-numbers-in-lisp
  (is (equal '("#<Designator 0>" "(#<Designator 0>)" "T")
             (rest (type-batch "obj-desig 0 local ((:size 2))" "(designator 0)"
                               "!>butler.designators"
                               "(eq (designator 0) (first !>butler.designators))"))))
  (is-true (has-words-p (complaint "(designator 0)") "has none")))

;;; Forks.

(test fork.leaves-the-run-as-it-was
  (let ((lines (type-batch "go 2.4" "(state-digest)" "fork" "go 3.2" "(robot-x butler)" "step 9"
                           "fork off" "(state-digest)" "(robot-x butler)")))
    (flet ((after-last (line)
             (nth (1+ (position line lines :test #'string= :from-end t)) lines)))
      (is (= 2 (count (nth 3 lines) lines :test #'string=)) "the digest is the same: ~A" lines)
      (is (string= "Tick 7, headless." (subseq (find "Back" lines :test #'search) 20)))
      (is (string/= (after-last "robot-go-distance: Robot stopped") (car (last lines)))))
    (is-true (has-words-p (joined lines) "In a fork" "FORK OFF" "Back from the fork. Tick"))))

(test fork.goes-back-too
  (let ((lines (type-batch "go 2.4" "fork" "step 9" "rewind 4" "fork off")))
    (is (equal '("Tick 12, in a fork: STEP lets time pass." "Back from the fork. Tick 7, headless.")
               (remove-if-not (lambda (line)
                                (or (search "headless" line) (search "in a fork:" line)))
                              lines)))))

(test fork.goes-into-another-and-as-chance-will-have-it
  (flet ((states (&rest forks)
           (remove-if-not (lambda (line) (every #'digit-char-p line))
                          (apply #'type-batch
                                 (append '("(dirty-simulation)" "go 2")
                                         (loop for fork in forks
                                               append (list fork "go 3" "(state-digest)"
                                                            "fork off")))))))
    (destructuring-bind (one two three four) (states "fork 7" "fork 7" "fork" "fork 8")
      (is (string= one two))
      (is (string/= one three))
      (is (string/= one four))))
  (is (equal '("Tick 1." "Tick 3.")
             (remove-if-not (lambda (line) (eql 0 (search "Tick" line)))
                            (type-batch "fork" "step 1" "fork" "step 2" "fork off" "fork off")))))

(test fork.takes-the-plans-along
  "They go on as time passes there, and in the run itself only afterwards."
  (let ((text (joined (type-live '("pause" "plan dawdle 1000000" "step 5" "fork" "plans" "stop-plan"
                                   "step 9" "plans" "world tiny" "fork off" "plans" "quit")))))
    (is-true (has-words-p text "In a fork, at tick 5." "Plans under way: dawdle." "Tick 14."
                          "No plan is under way" "A fork has one world"
                          "Back from the fork. Tick 5"))
    (is (search "dawdle" text :start2 (search "Back from the fork" text))))
  (awaiting (null cli::*plan-jobs*)))

(test fork.can-be-left-with-the-prompt
  (is-true (answers-p '("In a fork, at tick 0. STEP lets time pass, FORK OFF leaves it." "3")
                      '("fork" "(+ 1 2)" "quit" "(+ 2 2)"))))

(test fork.says-what-it-takes
  (is-true (has-words-p (complaint "fork off") "not in a fork"))
  (is-true (has-words-p (complaint "fork soon") "integer")))

;;; Worlds.

(test import.makes-a-map-and-says-what-next
  (base:with-own-definitions ()
    (let ((lines (type-batch (format nil "import ~S"
                                     (uiop:native-namestring
                                      (project-file "worlds/floors/ward.yaml"))))))
      (is-true (has-words-p (first lines) "ward: 130 by 100 cells" "166 walls"))
      (is-true (has-words-p (second lines) "(defrobot NAME (ward (" "WORLD ward"))))
  (is-true (has-words-p (complaint "import nowhere.yaml") "nowhere.yaml" "no such file")))

(test lines.export-what-import-reads
  (call-where-files-go
   (lambda ()
     (base:with-own-definitions ()
       (let ((lines (type-batch "export own.yaml" "import own.yaml")))
         (is-true (has-words-p (first lines) "own.yaml"))
         (is-true (has-words-p (second lines) "own.pgm"))
         (is-true (has-words-p (third lines) "own: " "walls"))))))
  (is-true (has-words-p (complaint "export own.txt") "ends in .yaml"))
  (is-true (has-words-p (complaint "export /no/where/own.yaml") "no such directory")))

(test help.fits-where-there-is-less-room
  (flet ((widest (width)
           (let ((cli::*text-width* width))
             (reduce #'max (lines-of (with-output-to-string (*standard-output*)
                                       (cli::write-help-about "rewind")))
                     :key #'length))))
    (is (<= 41 (widest 79) 79))
    (is (<= (widest 40) 40))))

(test robot.never-leaves-the-world
  (is-true (has-words-p (complaint "robot dot") "another world" "WORLD tiny dot" "ends this run"))
  (let ((text (joined (type-live '("pause" "step 3" "robot dot" "status" "rate" "quit")))))
    (is-true (has-words-p text "another world" "Tick 3"))))

;;; What is asked for and has no name in the simulator.

(test help.tells-of-keys-units-and-scripts
  (loop for (subject . words) in '(("keys" "control-R" "Tab") ("history" "XDG_STATE_HOME")
                                   ("units" "90 deg") ("scripts" "--json")
                                   ("numeric" "DEFATTRIBUTE"))
        do (is-true (apply #'has-words-p (joined (type-batch (format nil "help ~A" subject))) words)
                    "~A" subject)))

(test help.says-how-a-name-is-typed
  (is-true (has-words-p (joined (type-batch "help robot-go-to")) "(ars-worlds:robot-go-to robot"))
  (is-true (has-words-p (joined (type-batch "help robot-turn")) "(robot-turn robot"))
  (is-true (has-words-p (complaint "(robot-go-to 1 2 3 nil)") "ARS-WORLDS:ROBOT-GO-TO"))
  (is-true (has-words-p (complaint "(no-such-function)") "NO-SUCH-FUNCTION is undefined")))

(test help.knows-what-other-systems-bring
  (dolist (name '("is-success-rate" "repeat-trial" "pass-probability"))
    (is-true (has-words-p (joined (type-batch (format nil "help ~A" name))) name "rate")
             "~A" name)))

(test help.knows-the-names-of-packages-that-are-used
  (is-true (has-words-p (joined (type-batch "help install-goal")) "INSTALL-GOAL" "priority"))
  (is-true (has-words-p (joined (type-batch "apropos agenda")) "DUMP-AGENDA" "WORK-ON-AGENDA")))

;;; What is pasted from a page.

(test pasted.prompts-are-passed-over
  (is (equal (type-batch "angle 1" "turn 1")
             (type-batch "Robot> angle 1" "  Robot> Robot> turn 1")))
  (is-true (answers-p '("3") '("Robot> (+ 1" "     > 2)"))))

(test pasted.messages-are-passed-over
  (is (null (type-batch "Robot> robot-turn: Robot turned 1.57" "Robot>" "Break> ")))
  (is (null (type-batch "*WARNING* -> Removing Designator 0" "*ERROR* -> (x, line 1: turn): no.")))
  (is-true (has-words-p (complaint "robot-turn: Robot turned 1.57") "There is no command"))
  (is-true (has-words-p (complaint "Robot> frobnicate") "There is no command FROBNICATE")))

;;; Mistakes.

(test exits.do-not-end-the-session
  (dolist (form '("(sb-ext:exit)" "(sb-ext:quit)" "(sb-ext:exit :abort t)"))
    (is (equal '("3") (rest (type-batch form "(+ 1 2)"))) "~A" form)
    (is-true (has-words-p (complaint form) "QUIT leaves") "~A" form)))

(test mistakes.name-what-would-do
  (is-true (has-words-p (complaint "step 0") "from 1 to 1e9"))
  (is-true (has-words-p (complaint "step 2e9") "from 1 to 1e9"))
  (is-true (has-words-p (complaint "step 1.5") "from 1 to 1e9"))
  (is-true (answers-p '("Tick 10." "Tick 12.") '("step 1e1" "step 2.0 ticks")))
  (is-true (has-words-p (complaint "plan travel-to") "given no arguments" "PLAN TRAVEL-TO me"))
  (is-true (has-words-p (first (type-batch "obj-desig 0 non-local ((:substance banana))"))
                        "No substance is called banana"))
  (is-true (has-words-p (joined (type-batch "help set-speed")) "from 0 to max-speed*"))
  (is-true (has-words-p (joined (type-batch "help clean-simulation")) "DISCRETE-NOISE-FACTOR*")))

(test mistakes.show-a-text-that-is-there-twice
  "Those who show a report may have asked Lisp to mark what is the same."
  (let ((known (list "looks=1" "looks=2")))
    (is (string= "There is no level called looks=4. Did you mean looks=1? Known: looks=1, looks=2."
                 (handler-case (base:reject-name "level" 'looks=4 known)
                   (base:unknown-name (condition)
                     (let ((*print-circle* t)) (princ-to-string condition))))))))

(test points.are-written-as-they-are-typed
  (is (equal "go-to: Robot is near 8 8.5, by its odometer"
             (car (last (type-batch "go-to 8 8.5"))))))

(test echo.hides-what-go-to-does-on-the-way
  (is (equal '("go-to: Robot is near 8 8.5, by its odometer")
             (rest (type-batch "echo off" "go-to 8 8.5")))))

;;; Time that stands still.

(test time.is-idle-while-nothing-can-happen
  (let ((lines (type-live '("(clean-simulation)" "rate" "status" "watch 5" "quit"))))
    (is (= 3 (count-if (lambda (line) (search "idle, else" line)) lines)) "~A" lines)))
