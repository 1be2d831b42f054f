;;;; beginners-ends.lisp -- things that end early or are missing, unexpectedly for beginners.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Plans and runs.

(rpl:def-interp-proc turn-for-long ()
  (driver:rpl-robot-turn 3)
  (rpl:wait-for driver:robot-stopped*))

(test begin-plan.tells-of-plans-that-the-end-of-the-run-cuts-off
  (is-true (has-words-p (rover-writes () (driver:begin-plan 'turn-for-long) (run:run-ticks 2))
                        "At the end of with-simulation, at tick 2, the plan turn-for-long had not"
                        "(run-ticks N)" "(run-plan ...)"))
  (is (string= "" (rover-writes () (driver:begin-plan 'turn-for-long) (run:run-ticks 99)))))

(test begin-plan.is-quiet-of-plans-that-go-on-for-ever-or-long-enough
  (flet ((told (plan) (rover-writes () (driver:begin-plan plan) (run:run-ticks 2))))
    (is (string= "" (told (plan-of (loop (rpl:wait-time 5))))))
    (is (string= "" (told (plan-of (rpl:par (rpl:wait-time 5) (loop (rpl:wait-time 5)))))))
    (is (string= "" (told (plan-of (rpl:with-policy (rpl:whenever driver:robot-stopped* 1)
                                     (rpl:wait-time 50)))))))
  (is (string= "" (rover-writes ()
                    (driver:begin-plan 'turn-for-long)
                    (run:run-until (lambda () (< 2 (run:simulation-tick)))))))
  (is (string= "" (rover-writes ()
                    (driver:begin-plan 'turn-for-long)
                    (run:run-ticks 2)
                    (driver:end-plan :all))))
  (is (string= "" (rover-writes ()
                    (driver:begin-plan 'turn-for-long)
                    (run:run-ticks 2)
                    (is (string= "" (displayed))))))
  (is (string= "" (rover-writes ()
                    (driver:begin-plan 'turn-for-long)
                    (run:run-ticks 2)
                    (driver:print-plans (make-broadcast-stream)))))
  (is (string= "" (rover-writes (:errors :collect)
                    (driver:begin-plan 'turn-for-long)
                    (run:run-ticks 2)))))

(test run-until.tells-once-of-a-limit-that-nobody-gave
  (let ((text (rover-writes ()
                (dotimes (i 2) (run:run-until (constantly nil))))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "still false after 100000 ticks" "(run-until TEST :limit TICKS)")))
  (is (string= "" (rover-writes () (run:run-until (constantly nil) :limit 3)))))

(defun run-a-few-ticks () (run:run-ticks 2))

(test run-ticks.in-a-step-of-a-plan-is-told-of-once
  (let ((text (rover-writes () (driver:run-plan (plan-of (run-a-few-ticks) (run-a-few-ticks))))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "run-ticks was called inside of a step of a plan" "(wait-time N)"))))

(test run-plan-alone.says-that-it-has-no-robot-whose-commands-could-end
  (with-messages
    (run:with-simulation (rover)
      (driver:rpl-init-robot rover)
      (let ((base:*message-queue* (base:make-message-queue)))
        (rpl:run-plan-alone 'turn-once)
        (is-true (has-words-p (displayed) "RUN-PLAN-ALONE runs turn-once without a robot"
                              "(run-plan 'turn-once)"))))))

(test deadlock.tells-of-pulses-before-the-wait
  (let ((door (rpl:create-fluent 'door)))
    (is-true (has-words-p (rover-writes ()
                            (driver:run-plan (plan-of (rpl:pulse door) (rpl:pulse door)
                                               (rpl:wait-for door))))
                          "door has been pulsed 2 times so far, before this wait began"))
    (is (not (search "pulsed" (rover-writes ()
                                (driver:run-plan
                                 (plan-of (rpl:wait-for (rpl:create-fluent 'gate))))))))))

;;; What is not there.

(test readers.of-nothing-say-what-is-wanted
  (flet ((text (form)
           (run:with-simulation (rover)
             (handler-case (funcall (compile nil `(lambda () ,form)))
               (error (condition)
                 (list (princ-to-string condition) (base:text-of-condition condition)))))))
    (loop for (form . words) in '(((ars:thing-x (world:find-thing 'bal))
                                   "nothing here is called bal")
                                  ((ars:thing-x 'ball) "(find-thing 'ball)")
                                  ((ars:robot-x 'rover) "rover without a quote")
                                  ((ars:robot-x nil) "(with-simulation (ROBOT) ...)"))
          do (dolist (text (let ((*error-output* (make-broadcast-stream))) (text form)))
               (is-true (apply #'has-words-p text words) "~A" text)))))

(test functions.that-nobody-defined-are-told-with-what-was-meant
  (flet ((texts (name)
           (let ((condition (make-condition 'undefined-function :name name)))
             (list (base:text-of-condition condition)))))
    (is-true (has-words-p (first (texts (intern "RUN-PLANN" :ars-user))) "Did you mean run-plan?"))
    (is-true (has-words-p (first (texts :run-plan)) "write nisp:run-plan") "~A" (texts :run-plan))
    (is (not (search "Did you" (first (texts (intern "XYZZY-PLUGH" :ars-user)))))))
  (is-true (has-words-p (princ-to-string
                         (nth-value 1 (ignore-errors (funcall (intern "RUN-PLANN" :ars-user)))))
                        "Did you mean run-plan?")))

(test names-that-are-offered.begin-with-the-newest-of-the-user
  (base:with-own-definitions ()
    (eval '(rpl:def-interp-proc quite-new () 1))
    (is-true (complains-p '(run:with-simulation (rover) (driver:run-plan 'zzzz))
                          "Known: quite-new, "))))

;;; Files.

(test files.given-to-the-wrong-function-are-told-by-what-they-are
  (uiop:with-temporary-file (:pathname journal)
    (uiop:with-temporary-file (:pathname saved)
      (run:with-simulation (rover :journal t)
        (command:robot-turn rover 1 nil)
        (run:run-ticks 5)
        (run:save-journal journal)
        (run:save-simulation saved))
      (let ((journal (uiop:native-namestring journal)) (saved (uiop:native-namestring saved)))
        (loop for (form . words)
                in `(((run:load-simulation ,journal) "the file is a journal; (replay FILE)")
                     ((run:load-journal ,saved) "the file is a saved run; (load-simulation FILE)")
                     ((floors:import-map ,saved) "the file is a saved run")
                     ((ars:read-results ,journal) "no directory of an experiment" "a journal"))
              do (is-true (apply #'complains-p form words)))))))

;;; Forms.

(test with-valve.says-that-a-list-is-wanted
  (flet ((told (valve)
           (beginners-complaint `(rpl:interp-lambda () (rpl:with-valve ,valve (rpl:wait-time 1))))))
    (is-true (has-words-p (told 'wheels) "not wheels: write (wheels)"))
    (is-true (has-words-p (told ''wheels) "write (wheels)"))
    (is-true (has-words-p (beginners-complaint '(rpl:with-valve wheels 1)) "of the plan language")))
  (with-messages
    (rpl:run-plan-alone (plan-of (rpl:with-valve ('wheels) (rpl:wait-time 1))))
    (is-true (has-words-p (displayed) "made by make-valve: wheels without a quote"))))

(test definers.say-which-list-is-missing
  (is-true (complains-p '(command:defmanipulation rub (:by robot))
                        "the list of options comes after the parameters"))
  (is-true (complains-p '(command:defmanipulation rub (:by robot) (print 3)) "or () for none"))
  (is-true (complains-p '(rpl:def-interp-proc rub (rpl:wait-time 3))
                        "The list of parameters comes before the body")))

(test attributes.warn-of-noise-of-the-other-kind
  (base:with-own-definitions ()
    (is-true (has-words-p (warning-about '(world:defattribute :mass world:numeric :success 1/2))
                          ":success is for readings that are right or wrong"))
    (is-true (has-words-p (warning-about '(world:defattribute :hue (red) :base 2)) "is :success"))
    (dolist (form '((world:defattribute :mass world:numeric :success 1/2 :base 1)
                    (world:defattribute :hue (red) :success 1/2)))
      (is (not (search "is for" (warning-about form)))))))

(test experiments.warn-of-measures-without-a-name
  (base:with-own-definitions ()
    (flet ((told (measure)
             (warning-about `(ars:defexperiment rubbing
                               (:robots rover) (:run (run:run-ticks 1)) (:measure ,measure)))))
      (is-true (has-words-p (told '(robot:robot-x rover)) "(:measure (NAME (robot-x rover)))"))
      (is (string= "" (told '(x (robot:robot-x rover))))))))

;;; Leaving Lisp.

(test compilation-units.are-not-told-of-in-our-threads-when-lisp-is-left
  (flet ((told-p (left-p leaving-p own-p)
           (let ((host::*exiting-p* leaving-p) (host::*own-thread-p* own-p) (told nil))
             (host::report-unit-end (lambda (left-p) (declare (ignore left-p)) (setf told t))
                                    left-p)
             told)))
    (is-true (told-p t nil t))
    (is-true (told-p t t nil))
    (is-true (told-p nil t t))
    (is (not (told-p t t t)))))

(test functions.that-the-prompt-calls-otherwise-are-named
  (is-true (has-words-p (definitions::undefined-function-text 'hand-grasp)
                        "write ars:hand-grasp-desig"))
  (is-true (has-words-p (language:advice-on-call 'rpl-hand-grasp)
                        "plans use the function rpl-hand-grasp-desig"))
  (is (null (language:advice-on-call 'driver:rpl-robot-turn))))

(test plans.that-are-begun-while-no-ticks-pass-are-told
  (with-messages
    (let ((driver::*default-interface* nil) (time:*simulation* nil) (world:*world* nil))
      (run:simulator 'rover :display nil :rate :free)
      (unwind-protect
           (progn
             (driver:begin-plan (rpl:make-plan '(rpl:wait-time 1)))
             (is (null (message-texts)) "while they do")
             (run:stop-simulator)
             (driver:begin-plan (rpl:make-plan '(rpl:wait-time 1)))
             (is-true (has-words-p (format nil "~{~A~}" (message-texts))
                                   "waits until ticks pass" "(run-ticks N)")))
        (run:stop-simulator)
        (driver:end-plan :all)))))

(test trials.that-begin-runs-of-their-own-are-warned-of
  (flet ((warnings-of-run (form)
           (warnings-of (lambda ()
                          (with-own-definitions
                            (eval `(experiment:defexperiment nested (:robots rover)
                                     (:run ,form))))))))
    (is-true (has-words-p (first (warnings-of-run '(run:with-simulation (rover)
                                                    (driver:run-plan 'anything))))
                          "a trial is already a run" "Leave with-simulation out"))
    (is (null (warnings-of-run '(driver:run-plan 'anything))))))

(test programs.that-end-before-their-commands-have-are-told
  "Commands to a live robot, also if it was stopped, except endless ones."
  (let ((driver::*default-interface* nil) (time:*simulation* nil) (world:*world* nil))
    (run:simulator 'rover :display nil :rate :free)
    (let ((world (run:simulation-world time:*simulation*)))
      (unwind-protect
           (progn
             (is (null (run::undone-work-text world)))
             (time:pause)
             (command:robot-turn (symbol-value 'rover) 1 (lambda (&rest ignore) ignore))
             (run:stop-simulator)
             (is-true (has-words-p (run::undone-work-text world) "robot-turn has ended"
                                   "(await-idle) waits")))
        (run:stop-simulator)))))

(test commands.that-cut-each-other-short-are-told-live-too
  (with-messages
    (let ((driver::*default-interface* nil) (time:*simulation* nil) (world:*world* nil))
      (run:simulator 'rover :display nil :rate 20)
      (unwind-protect
           (let ((rover (symbol-value 'rover)))
             (time:pause)
             (command:robot-turn rover 1 nil)
             (command:robot-go-forward rover 3 nil)
             (is-true (has-words-p (format nil "~{~A~}" (message-texts))
                                   "robot-turn does nothing" "(await-idle)")))
        (run:stop-simulator)))))

(test failures.that-nobody-has-read-name-their-command
  (is-true (has-words-p (error-output
                          (run:with-simulation (rover)
                            (command:robot-set-speed (symbol-value 'rover) 1 nil)
                            (command:hand-ungrasp (robot:robot-hand (symbol-value 'rover) 0) nil)
                            (run:run-ticks 20)))
                        "*ERROR* -> hand-ungrasp: Hand 0 is not holding anything")))

(test plans.without-a-list-of-parameters-are-doubted
  (flet ((warnings-of-plan (&rest body)
           (prog1 (warnings-of (lambda () (eval `(rpl:def-interp-proc no-list ,@body))))
             (fmakunbound 'no-list))))
    (is-true (has-words-p (first (warnings-of-plan '(driver:rpl-robot-stop) '(rpl:wait-time 1)))
                          "has the name of the function rpl-robot-stop" "() if the plan has no"))
    (is (null (warnings-of-plan '() '(driver:rpl-robot-stop) '(rpl:wait-time 1))))
    (is (null (warnings-of-plan '(rpl-thing) '(rpl:wait-time rpl-thing))))))

(test plans.with-steps-after-a-whenever-are-doubted
  (flet ((warnings-of-steps (&rest steps)
           (prog1 (warnings-of (lambda () (eval `(rpl:def-interp-proc after-whenever (f) ,@steps))))
             (fmakunbound 'after-whenever))))
    (is-true (has-words-p (first (warnings-of-steps '(rpl:whenever f (print 1))
                                                    '(driver:rpl-robot-turn 1)
                                                    '(rpl:wait-for driver:robot-stopped*)))
                          "the forms after whenever never run" "with-policy"))
    (is (null (warnings-of-steps '(rpl:whenever f (when (print 1) (return)))
                                 '(rpl:wait-time 1))))
    (is (null (warnings-of-steps '(rpl:wait-time 1) '(rpl:whenever f (print 1)))))))
