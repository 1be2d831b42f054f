;;;; beginners-tests.lisp -- conditions in code that are never true, or always.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Error codes.

(defun told-of-code (test)
  "Return the warnings of a continuation whose first parameter, CODE, is in the form TEST."
  (warning-about `(nisp:continuation (code) (when ,test (print 1)))))

(test continuations.warn-of-codes-that-no-command-has
  (is-true (has-words-p (told-of-code '(eq code :blocked))
                        "no command ends with :blocked. Did you mean :robot-blocked?"))
  (is-true (has-words-p (told-of-code '(case code ((nil) 1) ((:interrupted :interrupt) 2)))
                        ":interrupted. Did you mean :interrupt?"))
  (is-true (has-words-p (told-of-code '(member code '(:robot-blocked :no-cornr)))
                        ":no-cornr. Did you mean :no-corner?"))
  (is-true (has-words-p (told-of-code '(eq code 'robot-blocked))
                        "robot-blocked is no error code, because error codes are keywords."))
  (is-true (has-words-p (told-of-code '(case code ((robot-blocked) 1) (t 2)))
                        "Write :robot-blocked."))
  (is-true (has-words-p (told-of-code '(equal code "robot-blocked")) "Write :robot-blocked."))
  (is-true (has-words-p (told-of-code '(equal :done code))
                        ":done: the error code of a command that succeeds is NIL"))
  (dolist (test '((eq code :robot-blocked) (case code (:interrupt 1) (t 2)) (eq other :blocked)
                  (eq code :spilt-the-milk) (eq code 'blocked) '(eq code :blocked)
                  (member code codes) (eq code . :blocked)))
    (is (not (search "no command" (princ-to-string (ignore-errors (told-of-code test))))))))

(test plans.warn-of-codes-that-no-command-has
  (flet ((told (test) (warnings-of-procedure 'robot `(if ,test (turn-once) (wait-time 1)))))
    (is-true (has-words-p (told '(eq (rpl:fluent-value driver:robot-movement-error*) :blocked))
                          "Did you mean :robot-blocked?"))
    (is-true (has-words-p (told '(eq driver:robot-movement-error* :robot-bloked))
                          "Did you mean :robot-blocked?"))
    (is-true (has-words-p (told '(eql (rpl:fluent-value (nisp:vref driver:camera-error* 0)) :ok))
                          "the error code of a command that succeeds is NIL"))
    (is-true (has-words-p (told '(case driver:robot-movement-error* (:blocked 1) (:no-cornr 2)))
                          "Did you mean :robot-blocked?" "Did you mean :no-corner?"))
    (dolist (test '((eq driver:robot-movement-error* :robot-blocked) (eq robot :blocked)
                    (eq (rpl:fluent-value (nisp:vref driver:camera-error* 0)) :not-tracking)))
      (is (not (search "no command" (told test)))))))

;;; States of tasks.

(test plans.warn-of-states-that-no-task-has
  (flet ((told (word)
           (warnings-of-procedure 'robot `(rpl:par (:tag walk (turn-once))
                                                   (rpl:wait-for (eq (rpl:task-status walk)
                                                                     ,word))))))
    (is-true (has-words-p (told :succeded) "never :succeded. Did you mean :succeeded?"))
    (is-true (has-words-p (told :done) "never :done. It is one of :created, :running"))
    (dolist (word '(:succeeded :blocked :evaporated))
      (is (not (search "never" (told word)))))))

(test deadlocks.say-how-the-tasks-are-that-are-waited-for
  (let ((text (rover-writes ()
                (driver:run-plan
                 (rpl:make-plan '(rpl:seq (:tag walk (rpl:wait-time 1))
                                  (rpl:wait-for (eq (rpl:task-status walk) :failed))))))))
    (is-true (has-words-p text "(task-status walk) is :succeeded, and stays so") "~A" text)
    (is (not (search "SET-VALUE" text)))))

;;; Fluents in Lisp.

(test lisp.warns-of-fluents-as-tests
  (is-true (has-words-p (warning-about '(lambda () (nisp:if driver:robot-stopped* 1 2)))
                        "robot-stopped* is a fluent, which is true in Lisp"))
  (is-true (has-words-p (warning-about '(lambda () (nisp:loop until (not driver:robot-place*)
                                                              do (run:run-ticks 1))))
                        "(fluent-value robot-place*)"))
  (is (string= "" (warning-about '(lambda ()
                                   (nisp:if (rpl:fluent-value driver:robot-place*) 1 2)))))
  (is (string= "" (warnings-of-plan (if driver:robot-place* 1 2)))))

(test lisp.warns-of-loops-that-wait-for-pulses
  (is-true (has-words-p (warning-about '(lambda ()
                                         (nisp:loop until (rpl:fluent-value driver:robot-stopped*)
                                                    do (run:run-ticks 1))))
                        "never true: the fluent is pulsed" "(await-idle)"))
  (is-true (has-words-p (warning-about '(lambda ()
                                         (nisp:loop while (not (rpl:fluent-value
                                                                (nisp:vref driver:hand-moved* 0)))
                                                    do (run:run-ticks 1))))
                        "never true")))

(test experiments.warn-of-fluents-as-success
  (is-true (has-words-p (warning-about '(experiment:defexperiment never-so (:robots rover) (:run t)
                                         (:success (not driver:robot-stopped*))))
                        ":success: robot-stopped* is a fluent")))

(test lisp.says-what-a-task-or-fluent-is-good-for
  (flet ((told (datum) (base:text-of-condition
                        (make-condition 'type-error :datum datum :expected-type 'number))))
    (run:with-simulation (rover)
      (is-true (has-words-p (told (driver:begin-plan (rpl:make-plan '(rpl:wait-time 1))))
                            "RUN-PLAN returns the values of a plan")))
    (is-true (has-words-p (told *level*) "FLUENT-VALUE returns the value"))))

;;; What plans use, and never get.

(defmacro told-of-plan (&body body)
  "Return the warnings of a plan whose text is BODY."
  `(warning-about '(rpl:interp-lambda () ,@body)))

(test plans.warn-of-tests-of-pulses
  (dolist (warning (list (told-of-plan (if driver:robot-stopped* 1 2))
                         (told-of-plan (unless (and t (not (rpl:fluent-value
                                                            driver:robot-stopped*)))
                                         1))
                         (told-of-plan (cond (driver:robot-stopped* 1)))
                         (told-of-plan (loop UNTIL driver:robot-stopped* (rpl:wait-time 1)))
                         (told-of-plan (rpl:wait-until
                                        (rpl:fluent-value driver:robot-stopped*)))))
    (is-true (has-words-p warning "robot-stopped* is never true" "(wait-for robot-stopped*)")))
  (is-true (has-words-p (told-of-plan (when (nisp:vref driver:camera-moved* 0) 1))
                        "(wait-for (vref camera-moved* 0))"))
  (is (string= "" (told-of-plan (rpl:wait-until driver:robot-stopped*)
                                (rpl:wait-for (or driver:robot-stopped* *level*))
                                (loop UNTIL (rpl:fl-pulsed driver:robot-stopped*)
                                      (rpl:wait-time 1))
                                (if driver:robot-movement-error* '(if driver:robot-stopped* 1))))))

(test plans.warn-of-waits-for-several-pulses-at-once
  (dolist (warning (list (told-of-plan (rpl:wait-for (and (nisp:vref driver:camera-moved* 0)
                                                          driver:robot-stopped*)))
                         (told-of-plan (rpl:wait-until (or *level*
                                                           (and (nisp:vref driver:camera-moved* 0)
                                                                driver:robot-stopped*))))
                         (told-of-plan (rpl:whenever (and (nisp:vref driver:camera-moved* 0)
                                                          *level* driver:robot-stopped*)
                                         (return)))))
    (is-true (has-words-p warning "is never true" "no two pulses come at the same instant"
                          "(par (wait-for (vref camera-moved* 0)) (wait-for robot-stopped*))")))
  (is (string= "" (told-of-plan (rpl:wait-for (and driver:robot-stopped* *level*))
                                (rpl:wait-for (or driver:robot-stopped*
                                                  (nisp:vref driver:camera-moved* 0)))
                                (rpl:wait-for (and (rpl:fl-pulsed driver:robot-stopped*)
                                                   (rpl:fl-pulsed
                                                    (nisp:vref driver:camera-moved* 0))))))))

(test plans.warn-of-fluents-sought-in-constants
  (dolist (warning (list (told-of-plan (if (member driver:robot-movement-error* '(:robot-blocked))
                                           1 2))
                         (told-of-plan (let ((code driver:robot-movement-error*))
                                         (print (find code '(:robot-blocked) :test #'eq))))
                         (told-of-plan (cdr (assoc driver:robot-movement-error*
                                                   '((:robot-blocked . 1)))))))
    (is-true (has-words-p warning "never finds" "which is a fluent" "Write (fluent-value ")))
  (is (string= "" (told-of-plan
                   (print (member driver:robot-movement-error* (list *level*)))
                   (print (member (rpl:fluent-value driver:robot-movement-error*)
                                  '(:robot-blocked)))
                   (print (find driver:robot-movement-error* '(:robot-blocked)
                                :key #'symbol-value))))))

(test plans.warn-of-values-of-commands
  (dolist (warning (list (told-of-plan (let ((view (driver:rpl-camera-view 0))) (print view)))
                         (told-of-plan (print (driver:rpl-camera-view 0)))
                         (told-of-plan (let (view) (setf view (driver:rpl-camera-view 0)) view))
                         (told-of-plan (when (driver:rpl-camera-view 0) 1))))
    (is-true (has-words-p warning "rpl-camera-view returns nothing" "(vref camera-input* 0)"
                          "in (vref camera-views* 0)")))
  (is (string= "" (told-of-plan (rpl:seq (driver:rpl-robot-turn 1) (driver:rpl-camera-view 0))
                                (if driver:robot-movement-error* (driver:rpl-robot-turn 1))
                                (let ((n 1)) (driver:rpl-robot-turn n))
                                (rpl:par (driver:rpl-robot-turn 1) (driver:rpl-robot-stop))))))

;;; What policies keep.

(test policies.warn-of-what-no-clause-keeps
  (flet ((told (&rest clauses) (warning-about `(rpl:make-policy () ,@clauses))))
    (is-true (has-words-p (told '(:init (rpl:policy-setf 'start 1) t)
                                '(:recover (print (rpl:policy-get 'strat))))
                          "(policy-get 'strat) returns NIL, because no clause stores it."
                          "Stored: 'start"))
    (is-true (has-words-p (told '(:recover (rpl:policy-get 'start))) "no clause stores it"))
    (is (string= "" (told '(:init (rpl:policy-setf 'start 1) t)
                          '(:recover (rpl:policy-get 'start)))))
    (is (string= "" (told '(:init (dolist (name '(a b) t) (rpl:policy-setf name 1)))
                          '(:recover (rpl:policy-get 'a)))))))

;;; Waits for what does not end.

(test await-idle.says-what-did-not-end
  (rover-writes ()
    (driver:begin-plan (rpl:make-plan '(loop (rpl:wait-time 1))))
    (run:run-ticks 2)
    (is-false (run::warn-of-await-timeout (time:current-simulation) 60))
    (is-true (has-words-p (displayed) "await-idle has waited for 60 s and stops waiting"
                          "the plan (loop (wait-time 1)) did not end"))))

(test valves.a-circle-that-a-deadline-ends-is-no-error
  (let ((text (rover-writes ()
                (let ((a (rpl:make-valve 'a)) (b (rpl:make-valve 'b)))
                  (is (equal 2 (driver:run-plan
                                (plan-of
                                  (rpl:par
                                   (rpl:handle-failure ((rpl:deadline-missed () (return 1)))
                                     (rpl:with-deadline (5)
                                       (rpl:with-valve (a)
                                         (rpl:wait-time 1)
                                         (rpl:with-valve (b) 1))))
                                   (rpl:with-valve (b)
                                     (rpl:wait-time 1)
                                     (rpl:with-valve (a) 2)))))))))))
    (is-true (has-words-p text "*WARNING* -> Deadlock at tick" "only if one of them is ended")
             "~A" text)))

(test plans.are-told-that-they-do-not-hear-of-others-commands
  (flet ((told (plan give)
           (rover-writes ()
             (driver:begin-plan (rpl:make-plan plan))
             (funcall give)
             (run:run-ticks 30))))
    (is-true (has-words-p (told '(rpl:whenever driver:robot-stopped* (print :heard))
                                (lambda () (command:robot-turn rover 1 nil)))
                          "robot-turn has ended. No plan has issued it" "waits for robot-stopped*"
                          "(rpl-robot-turn angle) (wait-for robot-stopped*)"))
    (dolist (heard (list (told '(rpl:whenever driver:robot-place-input* (print :heard))
                               (lambda () (command:robot-turn rover 1 nil)))
                         (told '(rpl:pursue (rpl:whenever driver:robot-stopped* (print :heard))
                                 (rpl:seq (driver:rpl-robot-turn 1) (rpl:wait-time 20)))
                               (lambda ()))))
      (is (not (search "No plan has issued it" heard))))))

(test continuations.with-names-in-another-order-are-told-of
  (flet ((told (continuation)
           (rover-writes ()
             (command:robot-turn rover 1 continuation)
             (run:run-ticks 30))))
    (is-true (has-words-p (told (lambda (robot angle err) (list robot angle err)))
                          "takes (robot angle err), but is called with (err robot angle)"))
    (is (string= "" (told (lambda (code who angle) (list code who angle)))))
    (is (string= "" (told (lambda (err robot turned) (list err robot turned)))))))

(test commands.given-again-before-a-tick-has-passed-are-told-of
  (flet ((told (&rest angles)
           (rover-writes ()
             (dolist (angle angles) (command:robot-turn rover angle))
             (run:run-ticks 20))))
    (is-true (has-words-p (told 1/2 1/2)
                          "robot-turn does nothing: robot-turn was issued before a tick"))
    (is (string= "" (told 1/2 1/4)))
    (is (string= "" (told 1/2)))))

(test experiments.warn-of-tests-that-are-always-true
  (flet ((told (&rest clauses)
           (warning-about `(experiment:defexperiment always-so (:robots rover) (:run t)
                             ,@clauses))))
    (is-true (has-words-p (told '(:success '(> (robot:robot-x rover) 5)))
                          ":success" "is data, which always counts as true"))
    (is-true (has-words-p (told '(:until '(> (robot:robot-x rover) 5))) ":until" "is data"))
    (is-true (has-words-p (told '(:success (lambda () (> (robot:robot-x rover) 5))))
                          "is a function, which always counts as true"))
    (is-true (has-words-p (told '(:success (length (robot:robot-hands rover))))
                          "is a number" "(< 0 (length"))
    (is-true (has-words-p (told '(:success (driver:run-plan 'turn-once)))
                          "a failed plan returns its failure, which is true"))
    (is-true (has-words-p (told '(:measure (x '(robot:robot-x rover)))) "measure x is quoted"))
    (dolist (clause '((:success (> (robot:robot-x rover) 5)) (:success t)
                      (:measure (x (robot:robot-x rover)) (kind ':fast))))
      (is (string= "" (told clause))))))

(test experiments.warn-of-the-value-of-a-plan-as-success
  (flet ((told (run) (warning-about `(experiment:defexperiment taken-for-true
                                       (:robots rover) (:run ,run)))))
    (is-true (has-words-p (told '(if (driver:run-plan 'turn-once) t nil))
                          "a failed plan returns its failure" "Write only"))
    (is (string= "" (told '(driver:run-plan 'turn-once))))
    (is (string= "" (told '(if (driver:run-plan 'turn-once) :hit :missed))))))

;;; Experiments.

(defun told-of-experiment (success &optional (run '(driver:run-plan 'only-waits)))
  "Return the warnings of an experiment with the forms RUN and SUCCESS."
  (warning-about `(experiment:defexperiment idle (:robots rover) (:run ,run) (:success ,success))))

(test experiments.warn-of-states-compared-with-the-first-value
  (is-true (has-words-p (told-of-experiment '(eq (first (experiment:trial-values)) :succeeded))
                        "RUN-PLAN returns :succeeded as its second value"
                        "(eq (second (trial-values)) :succeeded)"))
  (is (string= "" (told-of-experiment '(eq (second (experiment:trial-values)) :succeeded))))
  (is (string= "" (told-of-experiment '(eq (first (experiment:trial-values)) :there)))))

(test experiments.warn-of-quoted-runs
  (is-true (has-words-p (told-of-experiment t ''(driver:run-plan 'only-waits 5))
                        ":run" "is data" "Write only the form")))

(test experiments.tell-of-plans-that-failed-on-the-way
  (flet ((told (run)
           (with-own-definitions
             (eval `(experiment:defexperiment idle (:robots rover) (:run ,@run)))
             (with-output-to-string (*standard-output*)
               (experiment:print-results (experiment:run-experiment 'idle :trials 1))))))
    (let ((fails '(driver:run-plan (plan-of (rpl:fail :class :bad)))))
      (is-true (has-words-p (told `(,fails (run:run-ticks 5))) "failed (Plan failure :BAD)"
                            ":run went on"))
      (is-true (has-words-p (told `((if ,fails :ok nil))) ":run went on"))
      (is (not (search "went on" (told `(,fails)))))
      (is (not (search "went on" (told '((driver:run-plan 'only-waits) t))))))))

(test experiments.tell-of-successes-without-ticks
  (with-own-definitions
    (eval '(experiment:defexperiment idle (:robots rover) (:run (command:robot-turn rover 1 nil))
            (:success (zerop (run:simulation-tick)))))
    (is-true (has-words-p (with-output-to-string (*standard-output*)
                            (experiment:print-results
                             (experiment:run-experiment 'idle :trials 1)))
                          "No ticks have passed in the trial" "robot-turn"))))

(test experiments.warn-of-quoted-functions
  (is-true (has-words-p (told-of-experiment ''turn-it) "Write only the form: (turn-it)"))
  (is-true (has-words-p (warning-about '(experiment:defexperiment idle (:robots rover) (:run t)
                                         (:measure (x 'robot:robot-x))))
                        "measure x is quoted" "robot-x ...)")))

(defun turn-it () t)

(test experiments.take-no-failure-for-a-success
  (with-own-definitions
    (eval '(experiment:defexperiment idle (:robots rover)
            (:run (driver:run-plan (plan-of (rpl:fail :class :hit))))
            (:success (first (experiment:trial-values)))))
    (let ((text (with-output-to-string (*standard-output*)
                  (experiment:print-results (experiment:run-experiment 'idle :trials 1)))))
      (is-true (has-words-p text "the failure of a plan, which is true"
                            "(eq (second (trial-values)) :succeeded)")))
    (eval '(experiment:defexperiment idle (:robots rover)
            (:run (driver:run-plan 'only-waits))
            (:success (eq :there (first (experiment:trial-values))))))
    (is-true (has-words-p (with-output-to-string (*standard-output*)
                            (experiment:print-results
                             (experiment:run-experiment 'idle :trials 1)))
                          "only-believed (a success by the values of :run, but not by :success)"))))
