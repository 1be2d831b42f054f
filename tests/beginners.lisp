;;;; beginners.lisp -- messages about frequent mistakes show what to write instead.

(in-package :ars-magna.tests)

(def-suite* beginners :in ars-magna)

(defun beginners-complaint (form)
  "Evaluate FORM. Return the text of its error, or an empty text. Warnings are muffled."
  (handler-bind ((warning #'muffle-warning))
    (handler-case (let ((*error-output* (make-broadcast-stream))) (eval form) "")
      (error (condition) (text-of condition)))))

(defun complains-p (form &rest words)
  "True if evaluating FORM signals an error that says WORDS."
  (let ((text (beginners-complaint form)))
    (or (apply #'has-words-p text words)
        (progn (format t "~&~S: ~A~%" form text) nil))))

(rpl:def-interp-proc turn-once () (driver:rpl-robot-turn 1) (rpl:wait-for driver:robot-stopped*))
(rpl:def-interp-proc take-two (a b) (list a b))

;;; Runs.

(test with-simulation.says-what-is-wrong-with-its-form
  (is-true (complains-p '(run:with-simulation (rover rovr) 1)
                        "put several robots into a list: (with-simulation ((rover rovr))"))
  (is-true (complains-p '(run:with-simulation (rover :sead 1) 1)
                        "there is no keyword :sead; did you mean :seed?"))
  (is-true (complains-p '(run:with-simulation (rover :seed) 1) ":seed has no value"))
  (is-true (complains-p '(run:with-simulation rover 1) "write (with-simulation (rover) ...)"))
  (is-true (complains-p '(run:with-simulation () 1) "name a robot")))

(test with-simulation.wants-a-quoted-list-of-parameters
  (dolist (form '((base:max-speed* 1/3) ((base:max-speed* 1/3))))
    (is-true (complains-p `(run:with-simulation (rover :parameters ,form) 1)
                          "a quote" "max-speed* 1/3))")))
  (is-true (complains-p '(run:with-simulation (rover :parameters '(base:max-speed* 1/3)) 1)
                        "parameters is" "'((max-speed* 1/2))"))
  (is (eql 2 (run:with-simulation (rover :parameters (list (list 'base:max-speed* 1))) 2))))

(test user-macros.say-which-form-is-no-list
  (is-true (complains-p '(world:defkicker sway (thing) :prob (print thing))
                        "a list of options before the body, such as (:prob 1/10)"))
  (is-true (complains-p '(rpl:def-interp-macro twice 1) "twice is no list")))

(test slots.are-warned-of-where-nisp-does-not-read
  (is-true (has-words-p (warning-about (list 'rpl:interp-lambda '()
                                             (list 'print (make-symbol "!>ROVER.CAMERAS"))))
                        "!>rover.cameras has been read as a symbol" "(in-readtable :nisp)")))

;;; Commands.

(test commands.say-how-to-have-a-robot
  (is-true (complains-p '(command:robot-turn nil 1 nil)
                        "robot is NIL" "(with-simulation (ROBOT) ...)" "(simulator 'ROBOT)"))
  (is-true (complains-p '(command:robot-turn 'rover 1 nil)
                        "rover without a quote is a robot in (with-simulation (rover) ...)"))
  (is-true (complains-p '(command:robot-turn 5 1 nil) "robot is 5; give a robot.")))

(test continuations.of-another-number-of-parameters-are-told-of
  (flet ((told (continuation)
           (error-output (eval `(run:with-simulation (rover :errors :collect)
                                  (command:robot-turn rover 1 ,continuation)
                                  (run:run-ticks 1))))))
    (is-true (has-words-p (told '(nisp:continuation (err) err))
                          "robot-turn: the continuation takes (err)"
                          "Write (continuation (err robot angle) ...)"))
    (is-true (has-words-p (told '(nisp:continuation (err robot angle more) err))
                          "takes (err robot angle more)"))
    (dolist (good '((nisp:continuation (err robot angle) err) (nisp:continuation (&rest all) all)
                    (nisp:continuation (err &optional robot angle) err) #'list 'list nil
                    'never-defined))
      (is (string= "" (told good))))))

(test commands.warn-of-data-without-a-quote
  (flet ((warnings (descriptor)
           (let ((*error-output* (make-broadcast-stream)) (texts '()))
             (handler-bind ((base:definition-warning
                              (lambda (condition) (push (text-of condition) texts))))
               (compile nil `(lambda (camera)
                               (command:camera-get-object-designator camera ,descriptor nil))))
             (format nil "~{~A~}" texts))))
    (is-true (has-words-p (warnings '((:color red))) "is no call" "quote it: '((:color"))
    (is-true (has-words-p (warnings '(:color red)) "quote it: '(:color"))
    (is (string= "" (warnings ''((:color red)))))
    (is (string= "" (warnings '(list '(:color red)))))))

;;; Plans.

(test run-plan.says-how-a-plan-is-named
  (flet ((in-run (&rest arguments)
           `(run:with-simulation (rover) (driver:run-plan ,@arguments))))
    (is-true (complains-p (in-run ''(take-two 1 2)) "Give the name, and then its arguments"
                          "(run-plan 'take-two 1 2)"))
    (is-true (complains-p (in-run '#'turn-once) "Give the plan's name instead: 'turn-once"))
    (is-true (complains-p (in-run '#'car) "A function is not a plan"))
    (is-true (complains-p (in-run ''car) "car is a function, not a plan" "(car ...)"))
    (is-true (complains-p (in-run ''command:robot-turn)
                          "(rpl-robot-turn angle) (wait-for robot-stopped*)"))
    (is-true (complains-p (in-run ''take-two ''(1 2)) "one by one"))
    (is-true (complains-p (in-run ''turn-once ''(1)) "give no argument, not 1 argument"))))

(test run-plan.says-that-a-function-took-a-plans-name
  (let ((name (gensym "PLAN")))
    (eval `(rpl:def-interp-proc ,name () 1))
    (handler-bind ((warning #'muffle-warning)) (eval `(defun ,name () 1)))
    (is-true (complains-p `(run:with-simulation (rover) (driver:run-plan ',name))
                          "It was a plan until" "was defined as a function"))
    (fmakunbound name)))

(test run-plan.warns-of-a-name-without-a-quote
  (flet ((warnings (form)
           (let ((*error-output* (make-broadcast-stream)) (texts '()))
             (handler-bind ((base:definition-warning
                              (lambda (condition) (push (text-of condition) texts))))
               (compile nil `(lambda () ,form)))
             (format nil "~{~A~}" texts))))
    (is-true (has-words-p (warnings '(driver:run-plan turn-once)) "Quote its name: 'turn-once"))
    (is-true (has-words-p (warnings '(driver:begin-plan turn-once)) "Quote its name"))
    (is (string= "" (warnings '(driver:run-plan 'turn-once))))
    (is (string= "" (warnings '(let ((turn-once 'take-two)) (driver:run-plan turn-once 1 2)))))))

(defun warnings-of-procedure (&rest body)
  "Return the text of the warnings that come when a plan procedure of BODY is defined."
  (let ((name (gensym "PLAN")))
    (prog1 (warning-about `(rpl:def-interp-proc ,name (robot) ,@body))
      (fmakunbound name))))

(test plans.warn-of-commands-that-do-not-tell-them
  (is-true (has-words-p (warnings-of-procedure '(command:robot-turn robot 1 nil))
                        "robot-turn does not notify plans of its end"
                        "write (rpl-robot-turn angle) (wait-for robot-stopped*)"))
  (is-true (has-words-p (warnings-of-procedure
                         '(when robot (command:camera-view (robot:robot-camera robot 0) nil)))
                        "(rpl-camera-view camera) (wait-for (vref camera-input* camera))"))
  (is-true (has-words-p (warnings-of-procedure
                         '(list robot (nisp:continuation (err) (list err) (sleep 3))))
                        "sleep stops all plans"))
  (is (string= "" (warnings-of-procedure '(list robot) '(driver:rpl-robot-turn 1)
                                         '(mapc (lambda (each) (command:robot-turn each 1 nil))
                                           (list robot))))))

(test deadlock.names-the-last-command-and-what-tells-of-its-end
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (driver:rpl-camera-view 0)
                                                    (rpl:wait-for driver:robot-stopped*))))
                        "rpl-camera-view; (wait-for (vref camera-input* 0)) waits for its end"))
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (driver:rpl-robot-turn 1)
                                                    (rpl:wait-for driver:robot-stopped*)
                                                    (rpl:wait-for driver:robot-stopped*))))
                        "was rpl-robot-turn, which has ended"))
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (rpl:wait-for driver:robot-stopped*))))
                        "has issued no command by a function such as rpl-robot-turn")))

(test plans.that-never-end-by-themselves-are-said-to
  (let ((words "does not end by itself. End it by (return)") (driver:*plan-limit* 10))
    (flet ((says-p (plan)
             (has-words-p (rover-writes () (driver:run-plan plan)) words)))
      (is-true (says-p (plan-of (rpl:whenever driver:robot-stopped* 1))))
      (is-true (says-p (plan-of (loop (rpl:wait-time 1)))))
      (is-true (says-p (plan-of (rpl:par (rpl:wait-time 50) (loop (rpl:wait-time 1))))))
      (is-false (says-p (plan-of (rpl:wait-time 50))))
      (is-false (says-p (plan-of (loop (rpl:wait-time 1) (when (car (list nil)) (return)))))))))

;;; Definitions.

(test maps.say-where-kickers-of-a-thing-stand
  (flet ((map-of (&rest clause) `(world:defmap meadow (9 9) (obj ,@clause))))
    (dolist (more '((:kickers (sway)) ((:kickers (sway))) (:kicker sway)))
      (is-true (complains-p (apply #'map-of 'ball '(3 3) '((:size 1)) more)
                            "options stand beside the name" "(obj (ball :kickers (sway)) ...)")))
    (is-true (complains-p (map-of '(ball :kickers sway) '(3 3) '((:size 1))) "names in a list"))))

(test descriptors.warn-of-kicker-among-attributes
  (is-true (has-words-p (warning-about '(world:defmap meadow (9 9)
                                         (obj ball (3 3) ((:size 1) (:kicker sway)))))
                        "(obj (ball :kickers (sway)) ...)")))

;;; Experiments.

(defun outcomes-of-trial (run)
  "Return outcome and error of a trial that does the form RUN."
  (eval `(experiment:defexperiment idle (:robots rover) (:vary (plan 'turn-once)) (:trials 1)
           (:run ,run) (:success t)))
  (let* ((experiment (experiment:find-experiment 'idle))
         (result (experiment:run-trial experiment
                                       (first (experiment:experiment-conditions experiment)) 0)))
    (values (experiment:result-outcome result) (experiment:result-error result))))

(test experiments.refuse-the-name-of-a-plan-for-a-run
  (is-true (complains-p '(experiment:defexperiment idle (:robots rover) (:run 'turn-once))
                        "(:run (run-plan 'turn-once ...))" "alone runs nothing"))
  (multiple-value-bind (outcome error) (outcomes-of-trial 'plan)
    (is (string= "error" outcome))
    (is-true (has-words-p error "which has not been run" "(run-plan 'turn-once ...)")))
  (is (string= "success" (outcomes-of-trial '(driver:run-plan plan))))
  (is (string= "success" (outcomes-of-trial ':done))))

(test experiments.say-that-no-ticks-have-passed
  (eval '(experiment:defexperiment idle (:robots rover) (:run (command:robot-turn rover 1 nil))))
  (let* ((experiment (experiment:find-experiment 'idle))
         (result (experiment:run-trial experiment
                                       (first (experiment:experiment-conditions experiment)) 0)))
    (is (string= "no-ticks" (experiment:result-reason result)))
    (is-true (has-words-p (experiment:result-error result)
                          "No ticks have passed in the trial, so robot-turn did nothing"))))

;;; At a REPL.

(defun greeting (&key hook file)
  "Return what is written once the system is loaded, by FILE, while HOOK is the debugger's."
  (with-output-to-string (*standard-output*)
    (let ((*debugger-hook* hook) (*load-truename* file) (*compile-file-truename* nil))
      (ars-magna.faces::greet))))

(test greeting.says-how-to-begin-if-somebody-typed-that
  (is-true (has-words-p (greeting :hook #'list) "(in-package :ars-user)" "(in-readtable :nisp)"
                        "(ars:define-user-package :mine)"))
  (is (string= "" (greeting :hook #'list :file #p"my.lisp"))))
