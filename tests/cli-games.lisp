;;;; cli-games.lisp -- the prompt in games of testbeds: opened, rewound and forked.

(in-package :ars-magna.tests)

(in-suite cli-trials)

(defun game-text (line &rest lines)
  "Type LINE, which opens a game, and LINES in a batch without messages from programs."
  (joined (apply #'type-batch "echo off" line lines)))

(test game.is-opened-by-agent-knobs-and-seeds
  (let ((text (game-text "trial tileworld cautious,holes=3 2" "resume"
                         "trial tileworld \"agent=cautious holes*=3\" 2" "resume"
                         "trial tileworld-wind agent=watchful,tuning,game-steps=9 1" "resume")))
    (is-true (has-words-p text "Trial 2 of tileworld, agent=cautious holes*=3: seed 2,"
                          "over at tick 1301: success. effectiveness 0.4, filled 1."
                          "over at tick 1301: success."
                          "Trial 1 of tileworld-wind, agent=watchful game-steps*=9: seed 1000001,"
                          "over at tick 18: success."))))

(test game.is-the-trial-that-the-testbed-runs
  (experiment::call-with-temporary-directory
   (lambda (directory)
     (let ((path (uiop:native-namestring directory)))
       (experiment:run-testbed 'ars-testbeds:tileworld
                               :agents '(ars-testbeds::cautious) :knobs '((ars-testbeds:holes* 3))
                               :seeds 2 :stream nil :directory path)
       (is-true (has-words-p (game-text (format nil "trial tileworld cautious,holes=3 2 ~A" path)
                                        "step 500" "map" "status" "rewind 300" "resume")
                             "Tick 500." "Tick 200." "The result equals its row."))))))

(test game.that-makes-no-sense-is-refused
  (loop for (line . words) in '(("trial tileworld bolt 1" "no agent bolt" "mean BOLD?")
                                ("trial tileworld holes=3 1" "names no agent")
                                ("trial tileworld cautious,bold-any 1" "several agents")
                                ("trial tileworld cautious,hole=3 1" "no knob hole")
                                ("trial tileworld cautious,holes=0 1" "from 1 to 100000")
                                ("trial tileworld cautious 0" "1 to 1000000, not 0" "seed, 1.")
                                ("trial tileworld cautious,tuning 1000001"
                                 "not 1000001" "not its seed" "seed, 1000001.")
                                ("trial tileworld cautious,tuning 0" "first seed, 1000001.")
                                ("trial tileworl" "could be" "TILEWORLD-WIND")
                                ("failures pursuit" "was not run here"))
        do (is-true (apply #'has-words-p (complaint line) words) "~A" line)))

(test game.echo-off-hides-what-comes-of-commands-of-agents
  "Designators that agents have found are removed when robots leave: manual 3.4.1."
  (flet ((text (&rest lines)
           (joined (apply #'type-batch "trial tileworld-wind flexible 1"
                          (append lines '("step 60"))))))
    (is-true (search "Removing Designator" (text)))
    (is-false (search "Removing Designator" (text "echo off")))))

(test game.agents-are-listed
  (let ((text (joined (type-batch "trial" "trial tileworld-wind"))))
    (is-true (has-words-p text "  tileworld " "  pursuit " "  watchful " "gust-strength*"
                          "TRIAL tileworld-wind AGENT 1"))))

(test game.is-rewound-with-its-programs
  "All of the four testbeds have agents that are chains of continuations."
  (dolist (game '("tileworld cautious" "tileworld-tiles by-utility" "tileworld-wind watchful"
                  "pursuit level-1"))
    (let ((values (type-batch "echo off" (format nil "trial ~A 1" game) "step 9"
                              "(state-digest)" "step 10" "(state-digest)" "rewind 10"
                              "(state-digest)" "step 10" "(state-digest)" "rewind-to 0"
                              "step 9" "(state-digest)")))
      (let ((digests (remove-if-not (lambda (line) (every #'digit-char-p line)) values)))
        (is (= 5 (length digests)) "~A: ~S" game values)
        (destructuring-bind (at-9 at-19 rewound again from-start) digests
          (is (string/= at-9 at-19))
          (is (equal (list at-9 at-19 at-9) (list rewound again from-start)) "~A" game))))))

(test game.that-lines-have-changed-is-rewound-to-that-tick
  (let ((text (game-text "trial tileworld cautious,holes=3 2" "step 100" "turn 1" "step 5"
                         "rewind 4" "rewind 200" "rewind 5" "resume" "rewind 1" "resume")))
    (is-true (has-words-p text "not the experiment's run" "Tick 105."
                          "The run was changed at tick 100. Go back to that tick, or before it."
                          "This trial is at tick 105." "Tick 100."
                          "over at tick 1301: success. effectiveness 0.4"
                          "Tick 1300." "over at tick 1301: success. effectiveness 0.4"))
    (is-false (search "robot-step" text) "the agent's messages are not repeated")))

(test game.messages-are-shown-after-a-rewind-and-not-repeated-by-it
  (let ((lines (type-batch "trial tileworld cautious,holes=3 2" "rewind 0" "step 90" "rewind 50"
                           "step 40" "echo")))
    (flet ((shown (words) (count-if (lambda (line) (search words line)) lines)))
      (is (equal '(1 1 1) (list (shown "robot-set-speed") (shown "Tick 40.") (shown "Tick 80.")))
          "~S" lines)
      (is (plusp (shown "programs are shown"))))))

(test game.measures-come-before-those-of-other-testbeds
  "TILEWORLD-TILES has a measure FILLED, too."
  (let ((lines (type-batch "echo off" "trial tileworld cautious,holes=3 2" "resume" "measure"
                           "measure filled")))
    (is (equal '("effectiveness        2/5" "filled               1" "filled               1")
               (last lines 3)))))

(test game.is-forked-with-its-programs
  (let ((text (game-text "trial tileworld cautious,holes=3 2" "step 200" "fork" "(+ 40 2)"
                         "step 1101" "measure filled" "trial off" "rewind 700" "step 300" "fork off"
                         "(simulation-tick)" "resume")))
    (is-true (has-words-p text "In a fork, at tick 200." "Tick 1301." "filled               1"
                          "The prompt is not in a trial."
                          "TILER: the program that issued" "ends here"
                          "Back from the fork. Tick 200, paused." "200"
                          "over at tick 1301: success. effectiveness 0.4"))))

;;; Errors, plots and measures.

(defun in-small-game (&rest lines)
  "Type LINES in a batch in which games of Truckworld are short."
  (apply #'game-text "trial truckworld idle,tuning,game-time=60 1" "step 9" lines))

(test game.tells-errors-with-the-line-that-runs-then
  (let ((text (joined (run-script
                       (joined '("(defun stumble ()"
                                 " (ars-testbeds:spend-steps 1 (lambda () (error \"fell\"))))"
                                 "trial tileworld cautious,holes=3 1"
                                 "trial tileworld stumble,holes=3 1"
                                 "step 100"))))))
    (is (search "SCRIPT, line 5: Error in" text) "~A" text)))

(test game.plots-the-variables-that-status-shows
  (dolist (name '("*worth*" "ars-testbeds.trucks::*worth*"))
    (let ((text (in-small-game (format nil "plot ~A" name) "step 1" "plot")))
      (is (search "Plotting *worth*" text) "~A" text)
      (is (search "0 at tick 10" text) "~A" text)
      (is (not (search "no run variable" text))))))

(test game.measures-of-testbeds-are-shown-to-their-robots-only
  (let ((names (mapcar (lambda (line) (subseq line 0 (position #\Space line)))
                       (type-batch "measure"))))
    (dolist (name '("bound" "worth-delivered" "effectiveness" "captured"))
      (is (not (find name names :test #'string=)) "~A" name)))
  (is (search "worth-delivered" (in-small-game "measure"))))

;;; The page of the testbeds.

(defun lines-for-watching ()
  "Return the lines that the section Watch a game types at the prompt."
  (let* ((page (base:file-text (asdf:system-relative-pathname :ars-magna
                                                              "worlds/testbeds/README.md")))
         (start (search "## Watch a game" page)))
    (loop for line in (uiop:split-string (subseq page start (search "## " page :start2 (+ start 4)))
                                         :separator '(#\Newline))
          when (eql 0 (search "    Robot> " line)) collect (subseq line 11))))

(test game.is-watched-as-the-page-says
  (experiment::call-with-temporary-directory
   (lambda (directory)
     (let ((film (uiop:native-namestring (uiop:subpathname directory "game.html"))))
       (multiple-value-bind (lines errors)
           (apply #'type-batch (substitute (format nil "film ~A" film) "film game.html"
                                           (lines-for-watching) :test #'string=))
         (is (eql 0 errors) "~S" lines)
         (is-true (probe-file film))
         (is-true (has-words-p (joined lines) "agent=bold-nearer" "Tick 3000." "effectiveness"
                               "Tick 2800." "Back from the fork.")))))))
