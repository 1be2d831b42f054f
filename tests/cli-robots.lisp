;;;; cli-robots.lisp -- the prompt finds robots by name, wherever they were defined.

(in-package :ars-magna.tests)

(def-suite* cli-robots :in ars-magna)

;;; Users see the names in ARS-USER, so these tests remove theirs from it.

(defun known-as (name)
  "Return the symbol called NAME in ARS-USER, or NIL."
  (find-symbol name :ars-user))

(defun forget-name (name)
  (let ((symbol (known-as name)))
    (when symbol (unintern symbol :ars-user))))

(defmacro with-names ((&rest names) &body body)
  "Run BODY while ARS-USER knows none of the strings NAMES, and forget them again."
  `(progn
     (mapc #'forget-name ',names)
     (unwind-protect (progn ,@body)
       (mapc #'forget-name ',names))))

(defun type-to (robot &rest lines)
  "Type LINES to ROBOT, a name, in a headless batch as ./cli/ars-magna begins one."
  (let* ((output (make-string-output-stream))
         (session (cli:make-session :batch t :output output
                                    :input (make-string-input-stream (joined lines)))))
    (base:call-with-parameters
     '()
     (lambda ()
       (base:clean-simulation)
       (cli::run-batch session robot 0)))
    (lines-of (get-output-stream-string output))))

(test robots.of-shipped-worlds-are-known-by-name
  (with-names ("DOT" "PORTER")
    (is (equal '("robot-turn: Robot turned 1.00")
               (type-to 'ars-worlds:dot "(robot-turn dot 1 nil)")))
    (is (eq 'ars-worlds:dot (known-as "DOT")))
    (is (equal '("robot-turn: Robot turned 1.00")
               (type-to 'ars-worlds:dot "world hall" "(robot-turn porter 1 nil)")))))

(test robots.of-a-world-are-all-known
  (with-names ("MARVIN" "GOFER")
    (is (equal '("15") (type-to 'ars-worlds:marvin "(values (round (robot-position gofer)))")))))

(test robots.that-others-command-are-named-in-messages
  (with-names ("MARVIN" "GOFER")
    (is (equal '("robot-turn: Robot turned 1.00" "gofer: robot-turn: Robot turned 1.00"
                 "*ERROR* -> gofer: Robot cannot move: its speed is 0")
               (remove-if (lambda (line) (search "set-speed" line))
                          (type-to 'ars-worlds:marvin "turn 1" "(robot-turn gofer 1 nil)"
                                   "(robot-set-speed gofer 0 nil)"
                                   "(robot-go-forward gofer 1 nil)"))))))

(test robots.that-are-commanded-are-driven-by-plans-that-lisp-begins
  "Also after plans of another; but what RPL-INIT-ROBOT has said since holds."
  (with-names ("MARVIN" "GOFER")
    (let ((turn "(car (list (run-plan (interp-lambda ()
  (rpl-robot-turn 1) (wait-for robot-stopped*)))))"))
      (is (equal '("robot-turn: Robot turned 1.00" "T" "robot-turn: Robot turned 1.00" "T"
                   "#<MARVIN>" "marvin: robot-turn: Robot turned 1.00" "T")
                 (type-to 'ars-worlds:marvin turn "robot gofer" turn "(rpl-init-robot marvin)"
                          turn)))
      (is (equal '("robot-turn: Robot turned 1.00" "T")
                 (last (type-to 'ars-worlds:marvin
                                "(car (list (begin-plan (interp-lambda ()
  (wait-time 5)))))"
                                "robot gofer" turn)
                       2))))))

(test robots.that-are-commanded-again-are-driven-by-plans-again
  "Whatever RPL-INIT-ROBOT has said before, also of the robot that was commanded meanwhile."
  (with-names ("MARVIN" "GOFER")
    (is (equal '("#<GOFER>" "#<MARVIN>" ":SUCCEEDED")
               (type-to 'ars-worlds:marvin "(rpl-init-robot gofer)" "robot gofer" "robot marvin"
                        "(run-plan (interp-lambda () (rpl-robot)))")))
    (is (equal '("#<GOFER>" "#<MARVIN>" ":SUCCEEDED")
               (type-to 'ars-worlds:marvin "(rpl-init-robot gofer)" "robot marvin"
                        "(run-plan (interp-lambda () (rpl-robot)))")))))

(test robots.that-rpl-init-robot-has-named-are-driven-by-the-line-plan
  "As by RUN-PLAN, until ROBOT says which one is commanded."
  (with-names ("MARVIN" "GOFER")
    (is (equal '("#<GOFER>" "gofer: driven succeeded: GOFER" "GOFER" ":SUCCEEDED"
                 "driven succeeded: MARVIN")
               (rest (type-to 'ars-worlds:marvin
                              "(def-interp-proc driven () (robot-name (rpl-robot)))"
                              "(rpl-init-robot gofer)" "plan driven" "(run-plan 'driven)"
                              "robot marvin" "plan driven"))))))

(test robots.that-run-live-are-known
  (with-names ("DOT")
    (unwind-protect (run:simulator 'ars-worlds:dot :rate :free :display nil)
      (run:stop-simulator))
    (is (eq 'ars-worlds:dot (known-as "DOT")))))

(test robots.displace-what-was-merely-read
  (with-names ("DOT")
    (let ((read (intern "DOT" :ars-user)))
      (cli::import-robot-names '(ars-worlds:dot))
      (is (eq 'ars-worlds:dot (known-as "DOT")))
      (is (null (symbol-package read))))))

(test robots.of-the-users-own-take-the-name
  "The shipped one of that name stays as it is, and can be gone back to."
  (with-names ("DOT")
    (let ((dot (robot:find-robot 'ars-worlds:dot)))
      (is (equal '("robot-turn: Robot turned 1.00" "9")
                 (last (type-to 'ars-worlds:dot
                                "(defmap ars-test-den (30 30))"
                                "(defrobot dot (ars-test-den (9 9) 0))"
                                "world tiny"
                                "(robot-turn ars-worlds:dot 1 nil)"
                                "(values (round (robot-x dot)))")
                       2)))
      (is (not (eq 'ars-worlds:dot (known-as "DOT"))))
      (is (eq dot (robot:find-robot 'ars-worlds:dot))))))

(test robots.leave-alone-what-the-user-has-defined
  (dolist (define (list (lambda (symbol) (setf (symbol-value symbol) 1))
                        (lambda (symbol) (setf (fdefinition symbol) #'list))))
    (with-names ("DOT")
      (let ((own (intern "DOT" :ars-user)))
        (funcall define own)
        (cli::import-robot-names '(ars-worlds:dot))
        (is (eq own (known-as "DOT"))))))
  (cli::import-robot-names '(loop robot))
  (is (eq 'ars-magna.nisp:loop (known-as "LOOP")))
  (is (eq 'robot:robot (known-as "ROBOT"))))

(defun type-with-world (definition robot &rest lines)
  "Type LINES to ROBOT, a string, after loading the world's file that DEFINITION is the text of."
  (uiop:with-temporary-file (:pathname path :stream stream :type "lisp")
    (write-string definition stream)
    :close-stream
    (apply #'type-to (find robot (cli::load-world path) :test #'string=) lines)))

(test robots.of-users-worlds-are-known
  (with-names ("BEETLE" "CELLAR")
    (is (equal '("robot-turn: Robot turned 1.00")
               (type-with-world "(defmap cellar (5 5)) (defrobot beetle (cellar (2 2) 0))"
                                "BEETLE" "(robot-turn beetle 1 nil)")))
    (base:undefine 'robot "BEETLE")))

(test robots.of-users-packages-are-known
  (with-names ("BEETLE")
    (is (equal '("robot-turn: Robot turned 1.00")
               (type-with-world "(define-user-package :ars-test-house)
                                 (in-package :ars-test-house)
                                 (defmap cellar (5 5)) (defrobot beetle (cellar (2 2) 0))"
                                "BEETLE" "(robot-turn beetle 1 nil)")))
    (base:undefine 'robot "BEETLE"))
  (delete-package :ars-test-house))

;;; Plans of one of several robots.

(rpl:def-interp-proc look-aside ()
  (driver:rpl-robot-turn 1)
  (rpl:wait-for driver:robot-stopped*))

(test robots.that-the-prompt-commands-are-those-of-plans
  "PROJECT, RUN-PLAN and BEGIN-PLAN typed as Lisp need no RPL-INIT-ROBOT, unless nobody is meant."
  (with-names ("MARVIN" "GOFER")
    (dolist (robot '(ars-worlds:gofer ars-worlds:marvin))
      (is (equal (list "2" (format nil "#<~A>" (symbol-name robot)))
                 (type-to robot
                          "(projection-successes (project 'ars-magna.tests::look-aside :trials 2))"
                          "(rpl-robot)"))))
    (is (search "(rpl-init-robot marvin) before"
                (joined (type-to 'ars-worlds:marvin
                                 "(setf ars-magna.cli::*prompt-robot* nil)"
                                 "(run-plan 'ars-magna.tests::look-aside)"))))))

;;; A run that is over.

(defun type-live-to (robot &rest lines)
  "Type LINES at a live prompt that commands ROBOT, a name. Return what it writes."
  (let ((output (make-string-output-stream)) (*standard-output* (make-broadcast-stream)))
    (unwind-protect
         (progn (run:simulator robot :rate :free :display nil)
                (cli:run-session
                 (cli:make-session :input (make-string-input-stream (joined lines))
                                   :output output :batch t :patient nil)))
      (unless (run:simulation-over time:*simulation*) (run:stop-simulator)))
    (get-output-stream-string output)))

(test run.that-is-over-is-told-at-the-prompt
  "Its commands are interrupted, nothing goes on in it, and WORLD starts the new one."
  (with-own-definitions
    (eval '(world:defmap shed (30 9)))
    (eval '(robot:defrobot mole (shed (6 6) 0)))
    (let ((text (type-live-to 'mole
                              "pause" "go-forward 1000" "(defmap ars-magna.tests::shed (20 9))"
                              "status" "step 3" "go-forward 1" "resume")))
      (dolist (words '("has ended at tick" "robot-go-forward was interrupted"))
        (is (search words text) "~A~%~A" words text))
      (is (= 4 (loop with start = 0
                     for found = (search "The run in shed is over" text :start2 start)
                     while found count t
                     do (setf start (1+ found))))
          "~A" text))))

(test world.left-interrupts-what-was-asked-there
  (with-own-definitions
    (eval '(world:defmap shed (30 9)))
    (eval '(robot:defrobot mole (shed (6 6) 0)))
    (let ((text (type-live-to 'mole "pause" "go-forward 1000" "world tiny" "step 2")))
      (is (search "robot-go-forward was interrupted" text))
      (is (search "Tick 2" text) "~A" text))))
