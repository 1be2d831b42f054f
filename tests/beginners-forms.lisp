;;;; beginners-forms.lisp -- forms, names and types that are almost right.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Commands in plans.

(test plans.warn-of-commands-with-another-number-of-arguments
  (is-true (has-words-p (warnings-of-procedure '(driver:rpl-robot-turn robot 1))
                        "rpl-robot-turn takes (angle), not 2 arguments"
                        "the robot and the continuation are left out"
                        "(rpl-robot-turn angle) (wait-for robot-stopped*)"))
  (is-true (has-words-p (warnings-of-procedure '(list robot) '(driver:rpl-robot-turn))
                        "rpl-robot-turn takes (angle), not 0 arguments."))
  (is-true (has-words-p (warnings-of-procedure '(driver:rpl-robot-stop robot))
                        "rpl-robot-stop takes no argument, not 1 argument."))
  (is (string= "" (warnings-of-procedure '(driver:rpl-robot-turn robot) '(driver:rpl-robot-stop)
                                         '(driver:rpl-camera-view 0)))))

;;; One simulation inside of another.

(test with-simulation.says-that-a-command-was-given-inside-of-another
  (flet ((told (ticks &rest more)
           (error-output
             (run:with-simulation (rover)
               (run:run-ticks ticks)
               (run:with-simulation (rover-in-kitchen)
                 (command:robot-turn rover 1)
                 (run:run-ticks 10))
               (mapc #'funcall more)))))
    (dolist (ticks '(0 5))
      (is-true (has-words-p (told ticks) "robot-turn did nothing"
                            "made inside another with-simulation")))
    (is (string= "" (told 1 (lambda () (run:run-ticks 30)))))
    (is-true (has-words-p (told 1 (lambda () (run:run-ticks 30))
                                (lambda () (command:robot-turn rover 1)))
                          "Call (run-ticks N)"))))

;;; Types and tests in definitions.

(test defmanipulation.warns-of-types-that-are-slips
  (flet ((told (&rest types)
           (with-own-definitions
             (warning-about `(command:defmanipulation rub-down (ball - () :by ,@types) () nil)))))
    (is-true (has-words-p (told 'hand '- 'hnd) "no type is called hnd" "Did you mean hand?"))
    (is-true (has-words-p (told 'hand '- 'hand 'n '- 'integr) "Did you mean integer?"))
    (dolist (types '((hand - hand) (hand) (hand - hand n - colour) (hand - hand n - fixnum)))
      (is (string= "" (apply #'told types))))))

(test defkicker.with-a-test-of-nil-never-runs
  (with-own-definitions
    (eval '(world:defkicker sit-still (thing) (:test nil) (world:kick-thing thing 1 0 t)))
    (run:with-simulation (rover)
      (let* ((thing (world:find-thing 'crate)) (x (world:thing-x thing)))
        (world:set-kicker thing (world:find-kicker 'sit-still))
        (run:run-ticks 5)
        (is (= x (world:thing-x thing)))))))

;;; Clauses for failures.

(defmacro failure-told (&body plan)
  "Return the output of a run of PLAN."
  `(rover-writes () (driver:run-plan (plan-of ,@plan))))

(test failures.tell-of-clauses-for-classes-like-theirs
  (is-true (has-words-p (failure-told (rpl:handle-failure ((:robot-blockd () 1))
                                        (rpl:fail :class :robot-blocked)))
                        "a clause is for :robot-blockd, but the class of the failure is"
                        ":robot-blocked"))
  (is-true (has-words-p (failure-told (rpl:handle-failure (((or :late :deadline-mised) () 1))
                                        (rpl:with-deadline (2) (rpl:wait-time 5))))
                        "a clause is for :deadline-mised, but the class of the failure is"))
  (is (not (search "a clause is for"
                   (failure-told (rpl:handle-failure ((:door-1 () 1) (:lost () 2))
                                   (rpl:fail :class :door-2))))))
  (is-true (has-words-p (princ-to-string
                         (list (rpl:run-plan-alone
                                (plan-of (rpl:handle-failure ((:robot-blockd () 1))
                                           (rpl:fail :robot-blocked))))))
                        "Plan failure :ROBOT-BLOCKED")))

(test par-at-least.says-how-many-of-the-attempts-failed
  (flet ((text (plan) (princ-to-string (rpl:run-plan-alone plan))))
    (is (string= "1 of 2 attempts failed: Plan failure :A"
                 (text (plan-of (rpl:par-at-least 2 (rpl:fail :class :a) (rpl:wait-time 1))))))
    (is (string= "All 2 attempts failed: Plan failure :A; Plan failure :B"
                 (text (plan-of (rpl:par-at-least 1 (rpl:fail :class :a)
                                  (rpl:fail :class :b))))))))

;;; Policies.

(test with-named-policy.says-that-init-returned-nil
  (is (search "its :init returned NIL"
              (princ-to-string
               (rpl:run-plan-alone
                (plan-of (rpl:with-named-policy (rpl:make-policy () (:init nil)) ()
                           (rpl:wait-time 1))))))))

(test with-named-policy.says-that-the-list-of-arguments-is-missing
  (dolist (form '((rpl:with-named-policy told-policy (rpl:wait-time 1))
                  (rpl:with-named-policy told-policy (print 1) (rpl:wait-time 1))
                  (rpl:with-named-policy told-policy (turn-once))))
    (is-true (complains-p `(rpl:interp-lambda () ,form)
                          "the list of the policy's arguments before the body"
                          "(with-named-policy told-policy () (")))
  (is (string= "" (warnings-of-plan (rpl:with-named-policy 'told-policy (given) 1))))
  (is (string= "" (warning-about '(rpl:interp-lambda (list)
                                   (let ((print 1))
                                     (rpl:with-named-policy 'told-policy (list :ready print)
                                       (rpl:with-named-policy 'told-policy (print) 1))))))))

;;; Times in the place of keywords.

(test constructs.say-where-a-time-stands
  (flet ((check (form words) (is-true (complains-p `(rpl:interp-lambda () ,form) words))))
    (check '(rpl:with-deadline 5 (rpl:wait-time 1)) "not 5: write (5)")
    (check '(rpl:wait-for driver:robot-stopped* 20) "not 20: write :timeout 20")
    (check '(rpl:wait-for driver:robot-stopped* (+ 1 20)) "write :timeout (+ 1 20)")))

(test run-until.says-that-its-limit-has-a-keyword
  (is-true (has-words-p (warning-about '(lambda () (run:run-until #'identity 40)))
                        "40 stands in the place of a keyword" ":limit"))
  (is (string= "" (warning-about '(lambda () (run:run-until #'identity :limit 40)))))
  (is (string= "" (warning-about '(lambda (keyword) (run:run-until #'identity keyword 40))))))

;;; Plans that run away.

(test plans.that-run-away-are-told-how-to-wait
  (flet ((told (plan)
           (let ((rpl:*runaway-limit* 1000))
             (rover-writes () (driver:begin-plan plan) (run:run-ticks 1)))))
    (is-true (has-words-p (told (let ((f (rpl:create-fluent 'f t)))
                                  (plan-of (loop (rpl:wait-for f)))))
                          "(wait-for f) does not wait if its condition is true already"))
    (is-true (has-words-p (told (plan-of (rpl:handle-failure ((:a () (rpl:retry)))
                                           (rpl:fail :class :a))))
                          "fails again at once" "(do-retry tries (retry))"))
    (is-true (has-words-p (told (plan-of (rpl:handle-failure ((:a () (rpl:retry)))
                                           (loop (identity 1)))))
                          "If the plan is to wait, write (wait-time 1) there;"
                          "if the loop is to end, write (return)"
                          "Ctrl-C interrupts RUN-PLAN"))))

(rpl:def-interp-proc only-waits () (rpl:wait-time 1))

(test plans.typed-as-lisp-name-run-plan
  (flet ((told (form)
           (handler-case (macroexpand form)
             (base:misuse (misuse) (princ-to-string misuse)))))
    (is-true (has-words-p (told '(rpl:plan only-waits))
                          "To run the plan, write (run-plan 'only-waits)"))
    (is-true (has-words-p (told '(rpl:plan nothing-yet)) "in a def-interp-proc" "(run-plan 'NAME)"))
    (is-true (has-words-p (told '(rpl:wait-time 2)) "in a def-interp-proc" "(run-plan 'NAME)"))))

;;; Runs that are over, goals, pulses.

(test run-plan.says-that-its-run-is-over
  (run:with-simulation (rover)
    (run:end-simulation time:*simulation* "it is enough")
    (dolist (function '(driver:run-plan driver:begin-plan))
      (is-true (has-words-p (handler-case (funcall function (plan-of 1))
                              (base:run-is-over-error (condition) (princ-to-string condition))
                              (:no-error (&rest values) (princ-to-string values)))
                            "is over" "it is enough" "(simulator ROBOT) starts another")))))

(test plans.say-that-goals-are-quoted
  (with-own-definitions
    (eval '(rpl:def-goal (rpl:achieve (brought-in ?what)) what))
    (is-true (has-words-p (princ-to-string
                           (list (with-messages
                                   (rpl:run-plan-alone
                                    (eval '(plan-of (rpl:achieve (brought-in 1))))))))
                          "it is the first word of a goal. Quote the goal: (achieve '"
                          "(brought-in ...))"))))

(test deadlock.says-when-the-pulse-came
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (driver:rpl-camera-turn 0 1/10)
                                                    (driver:rpl-robot-turn 3)
                                                    (rpl:wait-for driver:robot-stopped*)
                                                    (rpl:wait-for
                                                     (nisp:vref driver:camera-moved* 0)))))
                        "camera-moved* 0 was pulsed at tick" "before this wait began"
                        "(par (wait-for fluent) (wait-for fluent))"))
  (is (not (search "was pulsed" (rover-writes ()
                                  (driver:run-plan (plan-of (driver:rpl-robot-turn 1)
                                                            (rpl:wait-for driver:robot-stopped*)))
                                  (driver:run-plan (plan-of
                                                    (rpl:wait-for driver:robot-stopped*))))))))

;;; Other objects than those that are wanted.

(test manipulations.say-that-a-designator-is-not-local
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand) '(nil done))
    (outcome-of 'poke (designate 'crate :type :non-local) (hand 0))
    (is-true (has-words-p (texts) "poke failed: Designator 0 is not local"
                          "search again with the type :local"))))

(test lisp.says-which-part-of-a-robot-is-wanted
  (flet ((told (function)
           (handler-case (funcall function rover)
             (type-error (condition) (base:text-of-condition condition)))))
    (is-true (has-words-p (told 'robot:hand-contents)
                          "Give a hand, as (robot-hand ROBOT 0) returns."))
    (is-true (has-words-p (told 'robot:storage-bin-capacity)
                          "Give a storage bin, as (robot-storage-bin ROBOT 0) returns."))))

(test definitions.warn-of-bodies-that-are-functions
  (flet ((told (&rest body)
           (with-own-definitions
             (list (warning-about `(world:defkicker hop-up (thing) (:prob 1) ,@body))
                   (warning-about `(command:defmanipulation hop-on (it - () :by hand) ()
                                     ,@body))))))
    (dolist (text (told '(lambda () (setf *level* 1))))
      (is-true (has-words-p text "which is never called"
                            "Write only the body of the function: (setf *level* 1)")))
    (is (equal '("" "") (told '(mapc (lambda (each) each) '()) nil)))))
