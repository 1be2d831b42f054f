;;;; cli-plans.lisp -- plans started, shown and stopped at the prompt, and its pictures.

(in-package :ars-magna.tests)

(def-suite* cli-plans :in ars-magna)

(rpl:def-interp-proc ars-user::dawdle (ticks &optional (answer :dawdled))
  "Wait for TICKS. Return ANSWER."
  (rpl:wait-time ticks)
  answer)

(rpl:def-interp-proc ars-user::stumble (reason &key (ticks 1) &aux (data '(1 2)))
  "Wait for TICKS; then fail with REASON."
  (rpl:wait-time ticks)
  (rpl:fail :class reason :data data))

(rpl:def-interp-proc ars-user::blunder ()
  (rpl:wait-time 1)
  (car (ars-magna.rpl-robot:rpl-robot)))

(rpl:def-interp-proc ars-user::struggle ()
  "Try in vain to open a bin, and go on."
  (ars-magna.rpl-robot:rpl-storage-bin-open 0)
  (rpl:wait-for (svref ars-magna.rpl-robot:storage-bin-moved* 0))
  (rpl:fluent-value (svref ars-magna.rpl-robot:storage-bin-error* 0)))

(rpl:def-interp-proc ars-user::mope ()
  "Wait for what never comes."
  (rpl:wait-for (rpl:create-fluent 'ars-user::godot)))

(rpl:def-interp-proc ars-user::stroll (angle)
  "Turn by ANGLE."
  (ars-magna.rpl-robot:rpl-robot-turn angle)
  (rpl:wait-for ars-magna.rpl-robot:robot-stopped*)
  (rpl:fluent-value ars-magna.rpl-robot:robot-angle-diff*))

;;; Headless.

(test plan.is-over-before-the-next-line
  (is-true (answers-p '("dawdle succeeded: :DAWDLED" "5" "dawdle succeeded: (A \"b\")")
                      '("plan dawdle 4" "(simulation-tick *simulation*)"
                        "plan dawdle 1 (a \"b\") ; unevaluated")))
  (is-true (answers-p '("robot-turn: Robot turned 0.50" "stroll succeeded: 0.5" "0.5")
                      '("plan stroll .5" "(robot-angle butler)")))
  (is-true (answers-p '("dawdle succeeded: 1" "dawdle succeeded: 1")
                      '("repeat 2 plan dawdle 3 1"))))

(test plan.a-failure-is-an-error-in-a-line
  (is-true (has-words-p (complaint "plan stumble :thin-ice") "stumble failed" ":THIN-ICE"
                        ":DATA (1 2)" "PLANS"))
  (is-true (has-words-p (complaint "plan blunder") "blunder failed" "BUTLER" "LIST"))
  (is (= 0 (nth-value 1 (type-batch "plan dawdle 1")))))

(test plan.errors-that-it-recovers-from-do-not-count
  (multiple-value-bind (lines errors) (type-batch "plan struggle")
    (is (= 0 errors))
    (is (eql 0 (search "*ERROR*" (first lines))))
    (is-true (has-words-p (second lines) "struggle succeeded: :BIN-OPEN")))
  (is (= 1 (nth-value 1 (type-batch "plan struggle" "bin-open 0")))))

(test plan.a-deadlock-is-an-error-in-a-line
  (is-true (has-words-p (complaint "plan mope") "Deadlock" "mope" "godot" "stopped"))
  (is (equal "No plan is under way. PLAN lists all plans."
             (first (last (type-batch "plan mope" "plans"))))))

(test plan.a-deadlock-in-a-line-has-advice
  "As that of RUN-PLAN has."
  (type-batch "(def-interp-proc linger () (rpl-robot-turn 1) (wait-for robot-stopped*)
                 (wait-for robot-stopped*))"
              "(defvar *sluice* (make-valve 'sluice))"
              "(def-interp-proc keep () (with-valve (*sluice*) (wait-for (create-fluent 'f nil))))"
              "(def-interp-proc want () (with-valve (*sluice*) 1))")
  (is-true (has-words-p (joined (type-batch "plan linger")) "is in a deadlock"
                        "changes when a command" "The last command of linger was rpl-robot-turn"))
  (is-true (has-words-p (joined (type-batch "(begin-plan 'keep)" "plan want")) "sluice" "keep has"))
  (is-true (has-words-p (complaint "plan mope") "Only SET-VALUE and PULSE change godot")))

(defun type-batch-in-hex (&rest lines)
  (let ((*print-base* 16)) (apply #'type-batch lines)))

(test plan.messages-have-ticks-in-decimal
  "Whatever *PRINT-BASE* is."
  (let ((told (joined (type-batch-in-hex "step 20" "plan stumble :ice :ticks 20" "plans"
                                         "(run-plan 'mope)"))))
    (is (search "at tick 41" told) "~A" told)
    (is (search "since tick 41" told) "~A" told)
    (is-false (search "tick 29" told) "~A" told)))

(test plan.what-makes-no-sense-is-an-error-in-a-line
  (is-true (has-words-p (complaint "plan dwadle 3") "no plan DWADLE" "mean DAWDLE?"))
  (is-true (has-words-p (complaint "plan dawdle") "DAWDLE ticks [answer]" "arguments"))
  (is-true (has-words-p (complaint "plan dawdle 1 2 3") "DAWDLE ticks [answer]"))
  (is-true (has-words-p (complaint "plan dawdle (1") "not complete"))
  (is-true (has-words-p (complaint "stop-plan") "No plan"))
  (let ((cli::*wait-limit* 10))
    (is-true (has-words-p (complaint "plan dawdle 50") "dawdle" "10 ticks" "continues"))))

(test plan.nothing-stays-behind
  (type-batch "plan dawdle 1" "plan stumble x" "plan mope" "plan dawdle")
  (is (null cli::*plan-jobs*)))

(test plan.names-may-be-cut-short
  (is-true (answers-p '("dawdle succeeded: :DAWDLED") '("plan daw 1")))
  (is (string= "PLAN" (cli:line-name (cli:find-line-command "plan"))))
  (is (string= "PLANS" (cli:line-name (cli:find-line-command "plans"))))
  (is (string= "STOP" (cli:line-name (cli:find-line-command "sto"))))
  (is (string= "STOP-PLAN" (cli:line-name (cli:find-line-command "stop-")))))

(test plan.alone-lists-what-one-would-start
  "Whole sentences, and no plan that is only a part of others of its package."
  (let ((lines (type-batch "plan")))
    (is (find "  DAWDLE                   Wait for TICKS." lines
              :test #'string=))
    (flet ((listed-p (name)
             (find (format nil "  ~A " name) lines
                   :test (lambda (name line) (eql 0 (search name line))))))
      (is-true (listed-p "FETCH-THING"))
      (is-true (listed-p "PATROL-PLACES"))
      (is-true (listed-p "TIDY-ROOM"))
      (is-false (listed-p "TURN-BY"))
      (is-false (listed-p "FIND-AND-TAKE")))
    (is (notany (lambda (line) (> (length line) 79)) lines)))
  (is-true (has-words-p (joined (type-batch "help stumble")) "PLAN STUMBLE reason [:ticks]"
                        "then fail"))
  (is-false (has-words-p (joined (type-batch "help stumble")) "data")))

(test plans.shows-trees-and-the-last-failure
  (let ((shown (joined (type-batch "(begin-plan 'mope)" "step" "plans" "stop-plan" "plans"))))
    (is-true (has-words-p shown "waiting" "mope" "godot" "No plan is under way")))
  (is-true (has-words-p (joined (type-batch "plan stumble :thin-ice" "plans"))
                        "The last plan failed" "at tick" "(fail :class"))
  (is-false (has-words-p (joined (type-batch "plan stumble :thin-ice" "plan dawdle 1" "plans"))
                         "last plan")))

(test plans.that-lisp-has-begun-are-not-waited-for
  "Not even while they keep commanding the robot; what Lisp itself commands is."
  (let ((lines (type-batch "(begin-plan (interp-lambda () (loop (rpl-robot-turn 1)
                                                                (wait-for robot-stopped*))))"
                           "(simulation-tick)" "step 4" "(+ 1 1)" "(simulation-tick)"
                           "fork" "(simulation-tick)" "step 2" "(simulation-tick)"
                           "(camera-turn (robot-camera butler 0) 1)" "(< 6 (simulation-tick) 99)"
                           "fork off" "(simulation-tick)")))
    (is (equal '("0" "2" "4" "4" "6" "4")
               (remove-if-not (lambda (line) (every #'digit-char-p line)) lines)))
    (is (member "T" lines :test #'string=))
    (is-true (has-words-p (joined lines) "Plans under way: (loop (rpl-robot-turn 1)"))))

(test stop-plan.ends-one-or-all
  (let ((lines (type-batch "(begin-plan 'mope)" "(begin-plan 'mope)" "step"
                           "stop-plan 99" "stop-plan 1" "(length (plans))")))
    (is-true (has-words-p (joined lines) "No plan 99"))
    (is (string= "1" (first (last lines)))))
  (is (equal "0" (first (last (type-batch "(begin-plan 'mope)" "(begin-plan 'mope)" "step"
                                          "stop-plan" "(length (plans))"))))))

(test lines.given-come-first
  (flet ((typed (&rest options)
           (apply #'type-lines '("(+ 1 1)") :lines '("plan dawdle 2" "(+ 1 0)") options)))
    (is (equal '("dawdle succeeded: :DAWDLED" "1" "2") (typed :batch t)))
    (is (equal '("Robot> plan dawdle 2" "Robot> dawdle succeeded: :DAWDLED" "Robot> (+ 1 0)" "1"
                 "Robot> (+ 1 1)" "2" "Robot> ")
               (typed :echo t))))
  (is (equal '("plan fetch 1" "plan b")
             (cli::lines-for-plan-options (cli::parse-options '("--plan" "fetch 1" "--plan=b"))))))

(rpl:def-interp-proc ars-user::mumble (fail-p)
  "Fail, or return, with an object that cannot be printed."
  (if fail-p
      (rpl:fail :class :mumbled :words (make-speechless))
      (make-speechless)))

(rpl:def-interp-proc ars-user::careful (x)
  (rpl:handle-failure ((error () (return :handled)))
    (rpl:wait-time 1)
    (car x)
    (rpl:wait-time 1)))

(test plan.what-cannot-be-printed-is-no-trouble
  (is-true (has-words-p (complaint "plan mumble t") "mumble failed" ":MUMBLED :WORDS an object"))
  (is (equal '("mumble succeeded: an object that cannot be printed")
             (type-batch "plan mumble nil"))))

(test plan.handles-its-own-errors-where-nobody-answers-a-debugger
  (let ((base:*break-on-user-error* t))
    (is (equal '("careful succeeded: :HANDLED") (type-batch "plan careful 5")))))

(test plan.what-it-takes-may-have-the-quote-that-lisp-would-want
  (is (equal '("dawdle succeeded: (A B)") (type-batch "plan dawdle '4 '(a b)")))
  (is (equal '("robot-turn: Robot turned 1.00") (type-batch "turn '1"))))

;;; Live. The prompt in these tests is in this thread; it waits for facts.

(defun type-live (lines &rest options)
  "Type LINES, after LINES of OPTIONS, in a session in a live parlour. Return what it writes."
  (let* ((output (make-string-output-stream))
         (session (apply #'cli:make-session :input (make-string-input-stream (joined lines))
                                            :output output options))
         (written (make-string-output-stream)))
    (unwind-protect
         (let ((*standard-output* written))
           (run:simulator ars-user::butler :rate :free :display nil)
           (cli:run-session session))
      (run:stop-simulator))
    (values (lines-of (get-output-stream-string output)) (cli:session-errors session))))

(test live.a-patient-prompt-waits
  (multiple-value-bind (lines errors)
      (type-live '("plan dawdle 4 1.5" "plan stumble :thin-ice" "plan mope" "plans") :batch t)
    (is (= 2 errors))
    (is (string= "dawdle succeeded: 1.5" (first lines)))
    (is-true (has-words-p (second lines) "stumble failed" ":THIN-ICE"))
    (is-true (has-words-p (third lines) "Deadlock" "mope" "godot" "was stopped"))
    (is (equal '("No plan is under way. PLAN lists all plans.") (nthcdr 3 lines)))))

(test live.another-is-back-at-once
  (let ((text (joined (type-live '("plan dawdle 1000000000" "plans" "stop-plan" "quit")))))
    (is-true (has-words-p text "Plan 1 is under way: dawdle" "Robot> 1 ")))
  (awaiting (null cli::*plan-jobs*)))

;;; Pausing. A tick that passes in a hundred seconds is one that does not pass.

(defun resume-for-a-tick ()
  "Let the paused live run go on, and wait until a tick has passed and the next one is waited for."
  (let ((passed (base:make-semaphore "passed")))
    (time:schedule-call (lambda () (base:signal-semaphore passed)) nil)
    (time:resume)
    (base:wait-on-semaphore passed 60)
    (awaiting (time::custody-asleep-p
               (time::timeline-custody (time:timeline-of time:*simulation*))))))

(test live.pause-at-the-prompt-holds-the-tick-that-is-due
  "At a finite rate: the tick that is waited for does not pass, neither at once nor later."
  (let ((text (joined (type-live '("pause" "go-forward 1000" "rate 0.01"
                                   "(ars-magna.tests::resume-for-a-tick)" "rate"
                                   "pause" "rate free" "pause" "pause" "step 2" "quit")))))
    (is (search "Tick 1, 0.01 ticks a second." text) "~A" text)
    (is (= 4 (occurrences "Tick 1, paused." text)) "~A" text)
    (is (search "Tick 3." text) "~A" text)))

;;; Pictures.

(test picture.goes-into-a-file
  (uiop:with-temporary-file (:pathname path :type "svg")
    (let ((name (uiop:native-namestring path)))
      (is (equal (list (uiop:native-namestring (truename path)))
                 (type-batch (format nil "picture \"~A\" 4" name))))
      (is (eql 0 (search "<" (base:read-file-into-string path))))))
  (is-true (has-words-p (complaint "picture") "FILE" "missing"))
  (is-true (has-words-p (complaint "picture world.gif") ".svg or .png"))
  (is-true (has-words-p (complaint "picture world.svg -1") "scale"))
  (is-true (has-words-p (complaint "picture world.svg 8 9") "one number"))
  (is-true (has-words-p (complaint "film run.html 8 9") "FILM takes one number"))
  (is-true (has-words-p (complaint "film run.html gird") "FILM does not take" "GRID"))
  (is-true (has-words-p (complaint "plan-timeline plan.svg") "No plans have run here" "begin-plan"))
  (is-true (has-words-p (complaint "picture world.svg nmaes") "nmaes" "NAMES" "BARE"))
  (is-true (has-words-p (complaint "picture /no/such/directory/world.svg") "/no/such/directory")))

(test picture.shows-the-layers-that-are-named
  (flet ((mentions-p (line &rest words)
           (uiop:with-temporary-file (:pathname path :type "svg")
             (type-batch (format nil line (uiop:native-namestring path)))
             (let ((text (base:read-file-into-string path)))
               (mapcar (lambda (word) (and (search word text) t)) words)))))
    (is (equal '(t nil) (mentions-p "picture \"~A\"" ", tick" "#8a8a8a")))
    (is (equal '(t t) (mentions-p "picture \"~A\" grid" ", tick" "#8a8a8a")))
    (is (equal '(nil t) (mentions-p "picture \"~A\" 12 bare gr" ", tick" "#8a8a8a")))))

(test picture.help-lists-all-layers
  (let ((help (joined (type-batch "help picture"))))
    (dolist (layer (ars-magna.display:picture-layers))
      (is (search (symbol-name layer) help)))
    (is-true (has-words-p help "from 1 to 256" "from 4 to 40"))
    (is (< (search "replacing it." help) (search "file:" help)
           (search "PICTURE world.svg is usually" help) (search "shown by default" help)
           (search "shown if you name them" help))
        "the common call does not come first")))

(test display.says-why-there-is-none
  (let ((display:*display-opener* nil))
    (is-true (has-words-p (complaint "display") "No display" "PICTURE"))))
