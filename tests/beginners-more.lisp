;;;; beginners-more.lisp -- what beginners forget: waits, parentheses, which robot is meant.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; What may never end.

(test runaways.are-told-of-while-they-run
  (let* ((driver:*plan-limit* 1)
         (told nil)
         (text (error-output
                 (let ((output *error-output*) (rpl:*runaway-limit* 1000))
                   (run:with-simulation (rover)
                     (driver:run-plan (plan-of (loop (identity :unheard-of))))
                     (setf told (get-output-stream-string output)))))))
    (is-true (has-words-p told "*WARNING* -> A plan took 1000 steps without waiting, at"
                          "unheard-of"))
    (is (not (search "without waiting" text)) "told once: ~A" text)))

(test warnings.at-once-are-for-a-listener-if-there-is-one
  (with-messages
    (setf (base:message-queue-listener base:*message-queue*) (constantly nil))
    (is (string= "" (error-output (base:warn-at-once "still at it")))))
  (with-messages
    (is (string= (format nil "*WARNING* -> still at it~%")
                 (error-output (base:warn-at-once "still at it"))))
    (is-true (has-words-p (displayed) "still at it") "it can be read, too")))

;;; Waits for what does not wait.

(test wait-for.tells-once-of-numbers-tasks-and-functions
  (flet ((told (value)
           (rover-writes ()
             (driver:run-plan (rpl:interp-lambda (given) (dotimes (i 3) (rpl:wait-for given)))
                              value))))
    (is (= 1 (length (lines-of (told 7)))))
    (is-true (has-words-p (told 7) "(wait-for given) does not wait: its argument is a number, 7"
                          "(wait-time 7)"))
    (is-true (has-words-p (told #'car) "a function" "wait-until"))
    (dolist (value '(t ball :done "open" (1 2))) (is (string= "" (told value)))))
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (rpl:wait-for (driver:begin-plan 'turn-once)))))
                        "a task" "(join-task task)")))

;;; Commands without a tick between them.

(test commands.that-replace-each-other-before-a-tick-are-told-of-once
  (flet ((hurry (rover) (command:robot-turn rover 1 nil) (command:robot-go-forward rover 1 nil)))
    (let ((text (rover-writes () (hurry rover) (run:run-ticks 3) (hurry rover) (run:run-ticks 1))))
      (is (= 1 (length (lines-of text))) "~A" text)
      (is-true (has-words-p text "robot-turn does nothing: robot-go-forward was issued before"
                            "(robot-turn ... (continuation (err robot angle) (robot-go-forward"
                            "(run-ticks N)")))
    (is-true (has-words-p (rover-writes ()
                            (command:robot-turn rover 1 (lambda (&rest told)
                                                          (declare (ignore told))
                                                          (hurry rover)))
                            (run:run-ticks 30))
                          "robot-turn does nothing"))))

(test commands.that-may-replace-each-other-are-quiet
  (is (string= "" (rover-writes ()
                    (command:robot-turn rover 1 (constantly nil))
                    (command:robot-go-forward rover 1 nil)
                    (command:robot-stop rover nil)
                    (run:run-ticks 1)
                    (command:robot-set-speed rover 1 nil)
                    (command:robot-turn rover 1 nil)
                    (command:robot-turn rover 1/2 nil)
                    (command:camera-turn (robot:robot-camera rover 0) 1 nil)
                    (run:run-ticks 1)
                    (command:robot-go-forward rover 1 nil)
                    (run:run-ticks 1)))))

(test plans.that-give-commands-without-a-wait-are-told-so-once
  (flet ((told (plan) (rover-writes () (driver:run-plan plan) (driver:run-plan plan))))
    (let ((text (told (plan-of (driver:rpl-robot-turn 1)
                               (driver:rpl-robot-go-forward 1)
                               (rpl:wait-for driver:robot-stopped*)))))
      (is (= 1 (length (lines-of text))) "~A" text)
      (is-true (has-words-p text "rpl-robot-turn of the plan"
                            "rpl-robot-go-forward was issued before" "(wait-for robot-stopped*)")))
    (dolist (plan (list (plan-of (driver:rpl-robot-go-forward 1)
                                 (driver:rpl-robot-set-speed 1)
                                 (driver:rpl-robot-stop)
                                 (rpl:wait-for driver:robot-stopped*))
                        (plan-of (driver:rpl-robot-go-forward 1)
                                 (rpl:wait-time 1)
                                 (driver:rpl-robot-turn 1)
                                 (rpl:wait-for driver:robot-stopped*))
                        (plan-of (rpl:evap-protect (driver:rpl-robot-go-forward 1)
                                   (driver:rpl-robot-turn 1))
                                 (rpl:wait-for driver:robot-stopped*))))
      (is (string= "" (told plan))))))

;;; Robots, designators and things.

(test rpl-init-robot.leaves-plans-of-others-alone
  (flet ((told (&rest names)
           (error-output
             (run:with-simulation ((keeper helper))
               (dolist (name names)
                 (driver:rpl-init-robot name)
                 (driver:begin-plan 'turn-once))
               (run:run-ticks 30)))))
    (is (string= "" (told 'keeper 'helper)))
    (is (string= "" (told 'keeper 'keeper)))))

(test commands.refuse-what-belongs-to-another-robot
  (is-true (complains-p '(run:with-simulation ((keeper helper))
                          (command:robot-goto-designator keeper (robot:robot-camera helper 0) nil))
                        "robot-goto-designator: Camera 0 belongs to HELPER, but KEEPER needs")))

(test arguments.say-where-designators-and-things-come-from
  (is-true (complains-p '(run:with-simulation (rover)
                          (command:camera-track (robot:robot-camera rover 0) 'ball))
                        "a designator: cameras' searches pass designators"
                        "(camera-get-object-designator"))
  (is-true (complains-p '(world:get-attribute 'ball :color) "the value of (find-thing 'ball)"))
  (is-true (complains-p '(world:set-attribute 3 :color 'red) "(find-thing 'NAME)")))

(test run-plan.in-a-continuation-names-begin-plan
  (is-true (has-words-p (rover-writes ()
                          (command:robot-turn rover 1 (lambda (&rest told)
                                                        (declare (ignore told))
                                                        (driver:run-plan 'turn-once)))
                          (run:run-ticks 20))
                        "a tick is under way" "(begin-plan ...) instead of (run-plan ...)")))

(test commands.warn-of-units
  (is-true (has-words-p (warning-about '(lambda (robot) (command:robot-turn robot (90 deg) nil)))
                        "(90 deg) is no call" "Units are for the prompt" "(* 90 (/ pi 180))")))

;;; Failures, fluents and variables.

(test failures.that-a-handler-lets-go-on-say-so
  (flet ((told (plan) (let ((*package* (find-package :ars-magna.tests)))
                        (prin1-to-string (nth-value 0 (driver:run-plan plan))))))
    (with-rover ()
      (is-true (has-words-p (told (plan-of (rpl:handle-failure ((:lost () :ok)) (rpl:fail :lost))))
                            "the handler for :lost ended without (return ...) or (retry)"))
      (is (not (search "handler" (told (plan-of (rpl:handle-failure ((:gone () :ok))
                                                  (rpl:fail :lost))))))))))

(test fluents.without-a-name-are-called-so
  (is (string= "a fluent without a name" (rpl:fluent-text (rpl:create-fluent nil))))
  (is (string= "(not a fluent without a name)"
               (rpl:fluent-text (rpl:fl-apply 'not (list (rpl:create-fluent nil)))))))

(test variables.without-a-value-name-the-nearest
  (flet ((text (name) (basics::lisp-error-text (make-condition 'unbound-variable :name name))))
    (is-true (has-words-p (text (intern "ROBOT-STOPED*" :ars-user))
                          "ROBOT-STOPED* has no value. Did you mean robot-stopped*?"))
    (is (not (search "Did you" (text (intern "NOTHING-LIKE-IT" :ars-user)))))
    (is (not (search "Did you" (text (make-symbol "ROBOT-STOPED*")))))))

;;; Definitions.

(test manipulations.tell-of-values-that-are-no-error-codes
  (flet ((told (result)
           (with-own-manipulations
             (define-way 'poke '(:by hand) (list result))
             (outcome-of 'poke (hand 0))
             (displayed))))
    (is-true (has-words-p (told '(lid 3)) "its body returned (lid 3)" "(values nil result)"))
    (is (not (search "its body" (told nil))))
    (is (not (search "its body" (told :jammed))))))

(test plans.name-nisp-where-it-is-not-used
  (let ((*package* (make-package (gensym "ALIEN") :use '(:cl))))
    (unwind-protect
         (let ((plan `(rpl:interp-lambda () (,(intern "RPL-ROBOT-TURN") 1))))
           (is-true (has-words-p (rover-writes () (driver:run-plan (eval plan)))
                                 "NISP has one. Write (in-package :ars-user)")))
      (delete-package *package*)))
  (is-true (has-words-p (warnings-of-procedure '(sb-ext:wait-for robot))
                        "wait-for is not the construct of plans, which belongs to NISP"
                        "nisp:wait-for")))

(test with-valve.warns-of-a-function-without-its-parentheses
  (is-true (has-words-p (warnings-of-plan (rpl:with-valve (driver:rpl-robot-valve) 1))
                        "is a function, not a variable" "(with-valve ((" ))
  (is (string= "" (warnings-of-plan (rpl:with-valve ((driver:rpl-robot-valve)) 1))))
  (is (string= "" (warnings-of-plan (rpl:with-valve (given) 1)))))

(test robots.say-what-lists-their-options-take
  (is-true (complains-p '(robot:defrobot pal (arena (5 5) 0) :hands 2)
                        "(10) is one hand of strength 10"))
  (is-true (complains-p '(robot:defrobot pal (arena (5 5) 0) :cameras 1) "is one camera")))

(test experiments.want-values-one-by-one
  (is-true (complains-p '(experiment:defexperiment idle (:robots rover)
                          (:vary (base:motion-noise* (0 1/10))) (:run t))
                        "values one by one, as in (motion-noise* 0 1/10)")))

(test macros.with-rest-and-keys-name-the-nearest-keyword
  (is (string= "there is no keyword :robot; did you mean :robots?"
               (definitions::misfit-text '(form &rest options &key robots seed)
                                         '(x :robot rover)))))

;;; Robots of the top level, named in threads of a WITH-SIMULATION.

(defun told-in-thread (function)
  "Call FUNCTION in another thread, \"helper\". Return its output, or the error."
  (let ((text ""))
    (base:join-thread
     (base:start-thread (lambda ()
                          (with-messages
                            (let ((trouble (trouble-of function)))
                              (setf text (concatenate 'string (displayed) trouble)))))
                        "helper"))
    text))

(test threads.that-name-a-robot-are-told-whose-it-is
  (flet ((turn () (command:robot-turn rover 1)))
    (with-rover ()
      (let ((told (told-in-thread #'turn)) (again (told-in-thread #'turn)))
        (is-true (has-words-p told "robot-turn is kept" "In this thread (helper), rover is the"
                              "(with-simulation (rover) ...)"
                              (base:thread-name (base:current-thread))
                              "(let ((robot rover)) (make-thread (lambda () ... robot)))")
                 "~A" told)
        (is (string= "no error" again) "told once"))
      (is-true (has-words-p (told-in-thread (lambda () (run:run-ticks 1)))
                            "no current simulation" "(with-simulation (rover) ...)"
                            "(current-simulation)")))
    (with-rover ()
      (is-true (has-words-p (told-in-thread #'turn) "In this thread") "again in each run"))))

(test threads.that-know-their-robot-are-not-told
  (let ((quiet "no error"))
    (with-rover ()
      (let ((robot rover))
        (is (string= quiet (told-in-thread (lambda () (command:robot-turn robot 1))))
            "handed over"))
      (is (string= quiet (told-in-thread (lambda ()
                                           (with-rover ()
                                             (command:robot-turn rover 1)
                                             (run:run-ticks 1)))))
          "in a run of its own"))
    (is-false (has-words-p (told-in-thread (lambda () (command:robot-turn rover 1)))
                           "In this thread")
              "when the run is over")
    (live-rover (:rate :free)
      (with-rover ()
        (is (string= quiet (told-in-thread (lambda () (command:robot-turn rover 1))))
            "to one that is under way")))))
