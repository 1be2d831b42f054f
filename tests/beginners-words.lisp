;;;; beginners-words.lisp -- what beginners write instead: tests, waits, keywords, lines.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Keywords and tests.

(test simulator.refuses-keywords-that-it-does-not-know
  (is-true (complains-p '(run:simulator 'rover :sead 3 :display nil)
                        "simulator: there is no keyword :sead; did you mean :seed?"))
  (is-true (complains-p '(run:simulator 'rover :rat 3) "did you mean :rate?")))

(test tests.that-are-functions-or-quoted-are-warned-of
  (dolist (form '('(> 1 2) (lambda () nil) #'(lambda () nil) #'car))
    (is-true (has-words-p (warning-about `(lambda () (time:schedule (:r :when ,form) (print 1))))
                          "schedule, :when:" "which always counts as true"))
    (is-true (has-words-p (warnings-of-procedure 'robot `(rpl:wait-until ,form))
                          "wait-until:" "which always counts as true. Write only the form")))
  (is-true (has-words-p (warning-about '(world:defkicker idly (thing)
                                         (:test (lambda () (list thing)))))
                        "defkicker idly, :test:" "(list thing)"))
  (dolist (form '((list 1) t nil (funcall #'list) robot))
    (is (string= "" (warnings-of-procedure 'robot `(rpl:wait-until ,form))))
    (is (string= "" (warning-about `(lambda (robot)
                                      (time:schedule (robot :when ,form) (print 1))))))))

;;; Plans.

(test calls.of-fluents-are-not-calls
  (handler-case (ars-magna.rpl.language::reject-unknown-call 'driver:robot-stopped*)
    (base:misuse (condition)
      (is-true (has-words-p (princ-to-string condition) "robot-stopped*" "It is a fluent")))
    (:no-error (&rest values) (fail "~S" values))))

(test wait-until.warns-of-numbers
  (is-true (has-words-p (warnings-of-procedure 'robot '(rpl:wait-until 5)) "(wait-time 5)")))

(test plans.warn-of-what-lets-time-pass-for-programs
  (flet ((told (form) (warnings-of-procedure 'robot form)))
    (is-true (has-words-p (told '(sleep 3)) "stops all plans" "(wait-time 3 :unit :seconds)"))
    (is-true (has-words-p (told '(when robot (run:run-ticks 5))) "for programs" "(wait-time 5)"))
    (is-true (has-words-p (told '(run:run-until (lambda () t))) "(wait-until condition)"))
    (dolist (form '((mapc (lambda (x) (sleep x)) robot) '(sleep 3)))
      (is (string= "" (told form))))))

(test plans.warn-of-values-in-the-place-of-fluents
  (flet ((told (form) (warnings-of-procedure 'robot form)))
    (is-true (has-words-p (told '(setq driver:robot-stopped* nil))
                          "puts nil in the place of the fluent" "set-value "))
    (is-true (has-words-p (told '(setf driver:robot-stopped* (not t))) "set-value "))
    (dolist (form '((setq robot nil) (setq driver:robot-stopped* (rpl:create-fluent nil))
                    (setf (rpl:fluent-value driver:robot-stopped*) nil)))
      (is (string= "" (told form))))))

(test policies.that-wait-for-nothing-are-warned-of
  (flet ((told (policy)
           (warnings-of-procedure 'robot `(rpl:with-policy ,policy (rpl:wait-time 3)))))
    (is-true (has-words-p (told '(print robot)) "waits for nothing" "(whenever test form...)"))
    (is-true (has-words-p (told '(when (listp robot) (rpl:fail)))
                          "wait-until (listp robot)"))
    (dolist (policy '((rpl:whenever driver:robot-stopped* (print 1))
                      (rpl:seq (rpl:wait-for driver:robot-stopped*) (rpl:fail))
                      (when robot (rpl:wait-for driver:robot-stopped*) (rpl:fail))
                      (loop (rpl:wait-time 1))))
      (is (string= "" (told policy))))))

(test fail.warns-of-a-class-without-a-colon
  (flet ((told (form) (warnings-of-procedure 'robot form)))
    (is-true (has-words-p (told '(rpl:fail :class lost)) "the class of a failure is a keyword"
                          "(fail :class :lost)"))
    (dolist (form '((rpl:fail :class :lost) (rpl:fail :class robot) (rpl:fail :class 'lost)
                    (let ((lost :class)) (rpl:fail :class lost))))
      (is (string= "" (told form))))))

(test names.of-plans-and-manipulations-are-warned-of-without-a-quote
  (dolist (form '((rpl:call-plan turn-once) (ars-magna.rpl-projecting:project turn-once)))
    (is-true (has-words-p (warnings-of-procedure 'robot form) "Quote its name: 'turn-once")))
  (is (string= "" (warnings-of-procedure 'robot '(rpl:call-plan 'turn-once)
                                         '(rpl:call-plan robot))))
  (is-true (has-words-p (warning-about '(lambda (robot) (command:run-manipulation open robot nil)))
                        "Quote its name: 'open"))
  (is-true (complains-p '(command:manipulate 'open 1 nil)
                        "the name without the quote: (manipulate open ...)")))

(test tags.without-a-colon-are-warned-of
  (flet ((told (form)
           (with-output-to-string (*error-output*)
             (with-compilation-unit (:override t) (warnings-of-procedure 'robot form)))))
    (is-true (has-words-p (told '(tag walk (rpl:wait-time 1))) "(:tag name form...)"))
    (is (string= "" (told '(:tag walk (rpl:wait-time 1)))))))

;;; Calls.

(test continuations.without-parameters-are-refused-or-warned-of
  (is-true (complains-p '(nisp:continuation (print "turned" t))
                        "parameters before the body"
                        "(continuation (err &rest results) (print \"turned\" t))"))
  (is-true (has-words-p (warning-about '(nisp:continuation (print err))) "the body is empty"
                        "(continuation (err &rest results) (print"))
  (dolist (form '((nisp:continuation (err) err) (nisp:continuation (err &optional (a 1)))
                  (nisp:continuation ()) (nisp:continuation (err - t robot) err)))
    (is (string= "" (warning-about form)))))

(test things-and-robots.by-name-are-told-of-how-to-have-them
  (flet ((in-run (form) `(run:with-simulation (rover) ,form)))
    (is-true (complains-p (in-run '(world:move-thing 'ball 3 3)) "(find-thing 'ball)"))
    (is-true (complains-p (in-run '(world:kick-thing 'ball 1 0 nil)) "(find-thing 'ball)"))
    (is-true (complains-p (in-run '(robot:place-robot 'rover 3 3 0)) "rover without a quote"))
    (is-true (complains-p (in-run '(robot:robot-camera 'rover 0)) "rover without a quote"))
    (is-true (complains-p (in-run '(world:new-thing cup (3 3) ((:size 1))))
                          "a map before the coordinates" "3 3)"))
    (is-true (complains-p (in-run '(run:run-until nil)) "such as (lambda () ("))))

(test designators.remedy-is-right-as-typed
  (is-true (complains-p '(run:with-simulation (rover)
                          (command:camera-track (robot:robot-camera rover 0) nil))
                        "CAMERA :non-local '((:color red)) (continuation (err camera designator)"
                        "(vref camera-designators* 0)")))

;;; The prompt.

(test prompt.tells-at-once-of-parameters-that-cannot-be-so
  (let ((text (joined (type-batch "(setq motion-noise* 5)" "(+ 1 2)" "(setq motion-noise* 0)"))))
    (is-true (has-words-p text "motion-noise* is 5; give a number from 0 to 1"))
    (is (= 1 (count-if (lambda (line) (search "give a number" line)) (lines-of text))))))

(test prompt.says-that-lines-have-no-parentheses
  (dolist (line '("(step 5)" "(go 5)" "(turn 90)" "(turn 90 deg)" "turn(90)"))
    (is-true (has-words-p (complaint line) "typed without parentheses") "~A" line))
  (is (not (search "without parentheses" (joined (type-batch "(step (+ 1 2))"))))))

(test prompt.says-how-parameters-are-set
  (is-true (has-words-p (complaint "motion-noise* 0") "(setq motion-noise* VALUE)" "PARAMS"))
  (is-true (has-words-p (complaint "motion-noise* = 0") "(setq motion-noise* VALUE)"))
  (is-true (has-words-p (complaint "set motion-noise* 0") "(setq motion-noise* 0)"))
  (loop for (line . words) in '(("run-ticks 5" "STEP") ("simulator rover" "WORLD")
                                ("journal" "SAVE-JOURNAL") ("ungrasp" "HAND-UNGRASP")
                                ("experiment" "TRIAL"))
        do (is-true (apply #'has-words-p (complaint line) words) "~A" line)))

;;; Manipulations.

(command:defmanipulation hum (:by robot) () nil)

(test manipulations.tell-of-continuations-of-another-number-of-parameters
  (flet ((told (continuation)
           (rover-writes ()
             (command:run-manipulation 'hum rover continuation)
             (run:run-ticks 3))))
    (is-true (has-words-p (told (lambda (err robot value) (list err robot value)))
                          "hum: the continuation takes (err robot value)"
                          "Write (continuation (err value) ...)"))
    (is (string= "" (told (lambda (err value) (list err value)))))))

(test run-plan-alone.has-no-robot
  (with-messages
    (let ((failure (rpl:run-plan-alone (rpl:interp-lambda () (driver:rpl-robot-turn 1)))))
      (is-true (has-words-p (princ-to-string failure) "No robot to drive" "RUN-PLAN runs them")
               "~A" failure))))
