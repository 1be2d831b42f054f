;;;; unseen.lisp -- likely mistakes are reported, once, and correct code is not.

(in-package :ars-magna.tests)

(def-suite* unseen :in ars-magna)

(defmacro rover-writes ((&rest options) &body body)
  "Run BODY in a headless simulation of ROVER with OPTIONS. Return what it writes to the error
output."
  `(error-output (run:with-simulation (rover ,@options) ,@body)))

(defmacro plan-of (&body body)
  "Return a plan that does BODY."
  `(rpl:interp-lambda () ,@body))

(rpl:def-interp-proc forlorn ()
  (rpl:par (rpl:wait-for (svref driver:camera-moved* 0))
           (rpl:wait-for driver:robot-stopped*)))

;;; Plans that wait for something that cannot happen.

(test deadlock.names-the-plan-what-it-waits-for-and-a-remedy
  (is-true (has-words-p (rover-writes () (driver:run-plan 'forlorn))
                        "the plan forlorn waits for camera-moved* 0, robot-stopped*"
                        "change when a command of the robot ends"
                        "issue a command before the wait"))
  (is-true (has-words-p (rover-writes ()
                          (let ((level (rpl:create-fluent 'level 0)))
                            (driver:run-plan (plan-of (rpl:wait-for (> level 3))))))
                        "waits for (> level 3)"
                        "Only SET-VALUE and PULSE change level"))
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (rpl:wait-for (car (list nil))))))
                        "a value that is no fluent"
                        "Wait for the fluent itself")))

(test stranded.a-plan-that-was-begun-is-told-once
  (let ((text (rover-writes ()
                (driver:begin-plan 'forlorn)
                (driver:begin-plan 'forlorn)
                (run:run-ticks 10)
                (run:run-ticks 10))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "*WARNING* -> At tick 10 the plan forlorn waits for"
                          "camera-moved* 0, robot-stopped*" "nothing in the run will change")))
  (is (string= "" (rover-writes (:errors :signal)
                    (driver:begin-plan 'forlorn)
                    (run:run-until (constantly nil) :limit 5)
                    (is-true (has-words-p (displayed) "the plan forlorn")))))
  (is-true (has-words-p (rover-writes ()
                          (driver:begin-plan (plan-of (rpl:wait-for (car (list nil)))))
                          (run:run-ticks 1))
                        "a value that is no fluent")))

(test stranded.what-programs-may-set-is-shown-if-they-do-not
  (let ((level (rpl:create-fluent 'level 0)))
    (flet ((shown (value)
             (rover-writes ()
               (driver:begin-plan (plan-of (rpl:wait-for (> level 3))))
               (run:run-ticks 1)
               (rpl:set-value level value)
               (run:run-ticks 1))))
      (is-true (has-words-p (shown 3) "waits for (> level 3)" "nothing in the run will change"
                            "Only SET-VALUE and PULSE change level"))
      (is (string= "" (shown 4))))
    (rover-writes ()
      (driver:begin-plan (plan-of (rpl:wait-for (> level 4))))
      (run:run-ticks 1)
      (is-true (has-words-p (displayed) "waits for (> level 4)" "nothing in the run")))))

(test stranded.is-told-of-live-plans-at-once
  (live (simulation)
    (driver:begin-plan 'forlorn)
    (let ((message (await (lambda () (first (base:take-messages))))))
      (is (eq t (definitions::message-notable-p message)))
      (is-true (has-words-p (base:message-text message)
                            "the plan forlorn waits for camera-moved* 0, robot-stopped*"
                            "issue a command before the wait")))))

(test with-simulation.tells-of-what-had-no-tick
  (is-true (has-words-p (rover-writes () (driver:begin-plan 'forlorn))
                        "No ticks have passed" "the plan forlorn" "run-ticks"))
  (is-true (has-words-p (rover-writes (:errors :collect) (command:robot-turn rover 1 nil))
                        "No ticks have passed" "robot-turn did nothing"))
  (is (string= "" (rover-writes () (robot:robot-x rover))))
  (is (string= "" (rover-writes () (run:run-ticks 1) (command:robot-stop rover nil))))
  (is (string= "" (rover-writes ()
                    (ignore-errors (run:with-simulation (rover)
                                     (command:robot-turn rover 1 nil)
                                     (error "left")))))))

(test stranded.no-plan-that-goes-on-or-is-to-wait
  (flet ((quiet-p (plan &optional (after (constantly nil)))
           (string= "" (rover-writes ()
                         (driver:begin-plan plan)
                         (run:run-ticks 3)
                         (funcall after)
                         (is (string= "" (displayed)))))))
    (is-true (quiet-p (plan-of (driver:rpl-robot-turn 1)
                               (rpl:wait-for driver:robot-stopped*))))
    (is-true (quiet-p (plan-of (rpl:wait-time 50))))
    (is-true (quiet-p (plan-of (rpl:whenever driver:robot-stopped* (rpl:wait-time 1)))))
    (is-true (quiet-p (plan-of (loop (rpl:wait-for driver:robot-stopped*)))))
    (is-true (quiet-p (plan-of (rpl:wait-for driver:robot-stopped* :timeout 50)))))
  (is (string= "" (rover-writes ()
                    (driver:rpl-init-robot rover)
                    (driver:begin-plan (plan-of (rpl:wait-for driver:robot-stopped*)))
                    (run:run-ticks 3)
                    (driver:rpl-robot-turn 1)
                    (run:run-ticks 30)))
      "what went on in the end"))

;;; Waits for values.

(defun warning-about (form)
  "Return the text of the warnings that come when FORM is evaluated."
  (with-output-to-string (stream)
    (handler-bind ((warning (lambda (condition)
                              (format stream "~A~%" condition)
                              (muffle-warning condition))))
      (eval form))))

(defmacro warnings-of-plan (&body body)
  "Return the text of the warnings that come when a plan that does BODY is made."
  `(warning-about '(rpl:interp-lambda (given) ,@body)))

(defvar *level* (rpl:create-fluent 'level 0))

(test wait-for.warns-of-values
  (is-true (has-words-p (warnings-of-plan (rpl:wait-for (rpl:fluent-value driver:robot-stopped*)))
                        "wait-for needs a fluent" "never changes"
                        "Write (wait-for driver:robot-stopped*)"))
  (is-true (has-words-p (warnings-of-plan (rpl:wait-for (> (rpl:fluent-value *level*) 3)))
                        "Write (wait-for (> *level* 3))"))
  (is-true (has-words-p (warnings-of-plan (rpl:wait-for 'driver:robot-stopped* :timeout 3))
                        "Write (wait-for driver:robot-stopped* ...)"))
  (is-true (has-words-p (warnings-of-plan (rpl:whenever (not (rpl:fluent-value *level*)) 1))
                        "Write (whenever (not *level*) ...)")))

(test wait-for.warns-of-constants
  (is-true (has-words-p (warnings-of-plan (rpl:wait-for 5))
                        "wait-for needs a fluent, such as robot-stopped*"
                        "5 is a constant" "write (wait-time 5)"))
  (loop for (constant text) in '((t "t is a constant")
                                 ('ball "'ball is a constant") ("a" "\"a\" is a constant"))
        do (is-true (has-words-p (warning-about `(rpl:interp-lambda () (rpl:wait-for ,constant)))
                                 text)))
  (is-true (has-words-p (warnings-of-plan (rpl:whenever t 1)) "whenever needs a fluent")))

(test wait-for.takes-what-may-be-a-fluent
  (is (string= "" (warnings-of-plan
                    (rpl:wait-for driver:robot-stopped*)
                    (rpl:wait-for (> *level* 3))
                    (rpl:wait-for (> *level* (rpl:fluent-value given)))
                    (rpl:wait-for (> given (rpl:fluent-value *level*)))
                    (rpl:wait-for (svref driver:camera-moved* 0))
                    (rpl:wait-for given)
                    (rpl:wait-for (or given driver:robot-stopped*))
                    (rpl:wait-until (> (rpl:fluent-value *level*) 3))))))

(test wait-for.tells-at-run-time-of-a-value-that-is-no-fluent
  (let ((text (rover-writes ()
                (flet ((idle ()
                         (driver:run-plan (rpl:interp-lambda (given)
                                            (dotimes (i 3) (rpl:wait-for given :timeout 2)))
                                          nil)))
                  (idle)
                  (idle)))))
    (is (= 1 (length (lines-of text))) "once for each form: ~A" text)
    (is-true (has-words-p text "(wait-for given :timeout 2) waits for a value that is not a fluent"
                          "wait-until"))))

;;; Options of things among their attributes.

(test descriptors.warn-of-options-of-things
  (is-true (has-words-p (warning-about
                         '(world:defmap cluttered (9 9)
                           (obj ball (3 3) ((:size 1) (:kickers (wobble)) (:prototype crate)))))
                        "ball has :kickers among its attributes, where it has no effect"
                        "write (obj (ball :kickers (sway)) ...)"
                        "write (obj (ball :prototype box) ...)"))
  (is-true (has-words-p (warning-about '(world:new-thing ball nil ((:size 1) (:prototype crate))))
                        "(new-thing ball place (...) :prototype box)"))
  (rover-writes ()
    (loop repeat 2
          do (world:make-new-thing 'ball (list (world:find-map 'arena) 3 3) '((:kickers (wobble)))))
    (is (= 1 (length (lines-of (displayed)))))))

;;; Said once for each name and run.

(test plans.tell-of-commands-that-go-on
  (flet ((leave () (driver:run-plan (plan-of (driver:rpl-camera-turn 0 1)))))
    (let ((text (rover-writes () (leave) (leave) (run:run-ticks 1))))
      (is (= 1 (length (lines-of text))) "~A" text)
      (is-true (has-words-p text "succeeded while its command rpl-camera-turn was under way"
                            "(wait-for (vref camera-moved* 0))"))))
  (let ((text (rover-writes ()
                (driver:run-plan (plan-of (rpl:pursue (driver:rpl-camera-turn 0 1)
                                                      (rpl:wait-time 1)))))))
    (is-true (has-words-p text "succeeded while its command rpl-camera-turn was under way")))
  (let ((text (rover-writes ()
                (driver:run-plan (plan-of (rpl:pursue (rpl:seq (driver:rpl-robot-turn 1)
                                                               (rpl:wait-for driver:robot-stopped*))
                                                      (rpl:wait-time 1)))))))
    (is-true (has-words-p text "(rpl-robot-stop)") "~A" text)
    (is-false (search "wait-for" text)))
  (is (string= "" (rover-writes ()
                    (driver:run-plan (plan-of (driver:rpl-robot-turn 1)
                                              (rpl:wait-for driver:robot-stopped*)
                                              (driver:rpl-robot-set-speed 1)
                                              (driver:rpl-robot-stop)))))))

(test angles.in-degrees-are-told-of
  (let ((text (rover-writes ()
                (command:robot-turn rover 90)
                (command:robot-turn rover 45)
                (command:camera-turn (robot:robot-camera rover 0) -30)
                (robot:place-robot rover 5 9 7.5)
                (run:run-ticks 1))))
    (is (= 3 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "robot-turn: 90 radians are 14.3 full turns" "(* 90 (/ pi 180))"
                          "camera-turn: -30" "place-robot: 7.50 radians")))
  (is (string= "" (rover-writes ()
                    (command:robot-turn rover (* 4 pi))
                    (command:robot-turn rover 6)
                    (command:robot-turn rover (* 400 (/ pi 180)))
                    (run:run-ticks 1)))
      "said by pi, or in degrees"))

(test commands.without-a-run-are-told-of
  (let ((robot (robot:find-robot 'rover)))
    (run:simulator 'rover :rate :free)
    (run:stop-simulator)
    (with-messages
      (command:robot-turn robot 1)
      (command:robot-turn robot 1)
      (let ((text (displayed)))
        (is (= 1 (length (lines-of text))) "~A" text)
        (is-true (has-words-p text "robot-turn is kept for a later run" "(simulator 'rover)"))))
    (run:simulator 'rover :rate :free)
    (with-messages
      (command:robot-turn robot 1)
      (is (string= "" (displayed))))
    (run:stop-simulator)))

(test commands.of-plans-are-not-said-to-be-kept
  (run:simulator 'rover :rate :free :display nil)
  (run:stop-simulator)
  (with-messages
    (driver:rpl-init-robot 'rover)
    (is (eql 1 (driver:run-plan (plan-of (driver:rpl-robot-turn 1)
                                         (rpl:wait-for driver:robot-stopped*)
                                         1))))
    (is (not (search "kept" (displayed))))))

;;; What is of another run.

(test another-run.its-designators-and-things-are-refused
  (let ((designator nil) (thing nil))
    (run:with-simulation (rover :clean t)
      (setf thing (world:find-thing 'pillar)
            designator (robot::make-designator :robot rover :type :non-local)))
    (run:with-simulation (rover)
      (signals base:misuse (command:camera-track (robot:robot-camera rover 0) designator))
      (signals base:misuse (world:move-thing thing '(3 3)))
      (signals base:misuse (world:set-attribute thing :color 'red)))))

;;; Calls from Lisp, and names.

(test plans.called-by-lisp-name-run-plan
  (is-true (has-words-p (handler-case (funcall 'forlorn)
                          (base:misuse (trouble) (princ-to-string trouble)))
                        "(run-plan '" "FORLORN)")))

(test plans.say-that-what-they-sense-has-not-come
  (flet ((said (plan)
           (with-rover ()
             (driver:run-plan plan)
             (format nil "~{~A~}" (texts-of-warnings)))))
    (is-true (has-words-p (said (rpl:interp-lambda ()
                                  (driver:rpl-camera-view 0)
                                  (rpl:fluent-value (svref driver:camera-views* 0))))
                          "succeeded while its command rpl-camera-view was under way"
                          "let the plan (wait-for (vref camera-input* 0))"))
    (is (string= "" (said (rpl:interp-lambda ()
                            (driver:rpl-camera-view 0)
                            (rpl:wait-for (svref driver:camera-input* 0))
                            (driver:rpl-robot-set-speed 1)))))))

;;; Quotes, keywords and spans.

(test fluent-value.refuses-the-quoted-name-of-a-fluent
  (with-rover ()
    (driver:rpl-init-robot rover)
    (dolist (form '((rpl:fluent-value 'driver:robot-stopped*)
                    (rpl:fluent-value 'driver:camera-input*)
                    (rpl:fluent-value '*level*)
                    (rpl:set-value '*level* 3)
                    (rpl:pulse 'driver:robot-stopped*)))
      (let ((said (complaint-of (lambda () (eval form)))))
        (is-true (and said (has-words-p said "leave out the quote")) "~S: ~A" form said)))
    (let ((failure (driver:run-plan (rpl:interp-lambda (name) (rpl:wait-for name)) '*level*)))
      (is-true (has-words-p (princ-to-string failure)
                            "*LEVEL* is a symbol, not a fluent. Leave out the quote: *level*.")))))

(test fluent-value.takes-other-symbols
  (is (equal '(ball t :red *package*) (mapcar 'rpl:fluent-value '(ball t :red *package*))))
  (is (eq 2 (plan-value (let ((name '*level*)) (case name (*level* 2)))))))

(test fail.warns-of-what-may-be-the-word-class
  (is-true (has-words-p (warnings-of-plan (rpl:fail :clas :lost :why 1))
                        "takes :clas as the class" "Did you mean :class?"))
  (is (string= "" (warnings-of-plan (rpl:fail :clash) (rpl:fail :clash 'door) (rpl:fail :glass 1 2)
                                    (rpl:fail :class :clas) (rpl:fail :clas)))))

(test wait-time.warns-of-less-than-nothing
  (is (string= "" (warnings-of-plan (rpl:wait-time (- 2 2)))))
  (is-true (has-words-p (warnings-of-plan (rpl:wait-time -2)) "does not wait for -2")))

(test failures.show-forms-as-they-were-written
  (flet ((text (plan) (rover-writes () (driver:run-plan plan))))
    (is-true (has-words-p (text (plan-of (rpl:wait-until (> (symbol-value 'nonsuch) 3))))
                          "in (wait-until (> (symbol-value"))
    (let ((text (text (plan-of (if (= (rpl:wait-time 1) (symbol-value 'nonsuch))
                                   (rpl:wait-time 1)
                                   (rpl:wait-time 2))))))
      (is-true (has-words-p text "in (= (wait-time 1) (symbol-value (quote nonsuch)))"
                            "(if (= (wait-time 1)"))
      (is (not (search "part" text)))
      (is (not (search "value2" text))))))

(test undefined-variables.are-told-of-in-what-was-written
  (let ((told (error-output
                (call-with-files #'compiled
                                 '("(def-interp-proc idle () (wait-for no-such-fluent*))")))))
    (is-true (has-words-p told "WAIT-FOR" "undefined variable" "NO-SUCH-FLUENT*"))
    (is (not (search "CHECKED-CONDITION" told)) "~A" told)))

;;; Names of attributes and things, once in a run.

(defmacro said-in-rover-world (&body body)
  "Return the texts of the warnings that come when BODY runs in a headless simulation of ROVER."
  `(with-rover ()
     ,@body
     (texts-of-warnings)))

(test attributes.slips-are-said-once
  (loop for (function operator) in `((,(lambda (ball) (world:get-attribute ball :colour))
                                      "get-attribute of ball")
                                     (,(lambda (ball) (world:set-attribute ball :colour 'red))
                                      "set-attribute of ball")
                                     (,(lambda (ball) (world:change-attribute ball '((:sise 1))))
                                      "change-attribute of ball"))
        for texts = (said-in-rover-world
                      (let ((ball (world:new-thing ball (arena 3 3) ())))
                        (loop repeat 3 do (funcall function ball))))
        do (is (= 1 (length texts)))
           (is-true (has-words-p (first texts) operator "is not declared" "did you mean"))))

(test attributes.of-ones-own-are-quiet
  (is (null (said-in-rover-world
              (let ((ball (world:new-thing ball (arena 3 3) ())))
                (world:get-attribute ball :heading)
                (world:set-attribute ball :rolling 3)
                (world:get-attribute ball :color))))))

(test attributes.options-of-things-are-named-in-searches
  (let ((texts (said-in-rover-world
                 (command:camera-get-all-object-designators
                  (robot:robot-camera rover 0) :non-local '((:kickers t)) nil)
                 (run:run-ticks 5))))
    (is-true (some (lambda (text)
                     (has-words-p text ":kickers, which is not declared"
                                  "an option for making things"))
                   texts))))

(test find-thing.says-once-what-is-like-the-name
  (let ((texts (said-in-rover-world
                 (world:new-thing marble (arena 3 3) ())
                 (loop repeat 3 do (is (null (world:find-thing 'marbel)))))))
    (is (equal '("No thing here is called marbel. Did you mean marble?") texts))))

(test find-thing.is-quiet-about-other-names-and-what-is-gone
  (is (null (said-in-rover-world
              (world:new-thing marker-11 (arena 3 3) ())
              (dolist (name '(marker-10 zebra "MARKER-11#7" nil))
                (world:find-thing name))))))

(test plans.tell-of-cleanups-that-are-given-up
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (rpl:evap-protect 1 (rpl:wait-time 9)
                                                                      :limit 3))))
                        "The cleanup (wait-time 9)" "it took longer than its limit")))

(test deadlocks.tell-of-tasks-that-are-suspended
  (let ((text (rover-writes ()
                (driver:run-plan
                 (plan-of (rpl:with-tags
                            (:tag o (rpl:seq (rpl:suspend o) (rpl:wait-time 1)))))))))
    (is-true (has-words-p text "a call, such as of WAKE-UP, that lets o go on") "~A" text)))
