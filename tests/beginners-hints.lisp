;;;; beginners-hints.lisp -- hints for names, calls and files that beginners confuse.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Names outside of their package, and syntax outside of its readtable.

(defun hint-to (function)
  "Return the text with which FUNCTION fails, as a debugger of Lisp's shows it."
  (handler-case (progn (funcall function) "")
    (error (condition) (princ-to-string condition))))

(defun hint-to-variable (name)
  "Return the text that a debugger shows for NAME, a symbol without a value."
  (hint-to (lambda () (symbol-value name))))

(defun stranger (name)
  "Return the symbol called NAME of a package that uses nothing of this system."
  (intern name (or (find-package :beginners-elsewhere)
                   (make-package :beginners-elsewhere :use '()))))

(test names.of-other-packages-are-hinted-at
  (setf (symbol-value (intern "PARKED-CAR" :ars-user)) 1)
  (setf (symbol-function (intern "PARK-CAR" :ars-user)) #'identity)
  (dolist (name '("PARKED-CAR" "ROBOT-STOPPED*" "*PLAN-LIMIT*"))
    (is-true (has-words-p (hint-to-variable (stranger name))
                          "ARS-USER has it: type (in-package :ars-user) first.")
             "~A" name))
  (is-true (has-words-p (hint-to (lambda () (funcall (stranger "PARK-CAR"))))
                        "ARS-USER has it: type (in-package :ars-user) first."))
  (is-true (has-words-p (hint-to-variable (stranger "DOT")) "There is ars-worlds:dot."))
  (is (not (search "ARS" (hint-to-variable (stranger "NOBODYS-NAME"))))))

(test names.of-plans-without-a-quote-are-hinted-at
  (is-true (has-words-p (hint-to-variable 'turn-once) "is the name of a plan: write 'turn-once."))
  (is-true (has-words-p (basics::lisp-error-text
                         (make-condition 'unbound-variable :name 'turn-once))
                        "has no value. It is the name of a plan: write 'turn-once.")))

(test syntax.of-nisp-is-hinted-at
  (let ((*readtable* (copy-readtable nil)))
    (dolist (text '("#f" "#T"))
      (is-true (has-words-p (hint-to (lambda () (read-from-string text)))
                            "(named-readtables:in-readtable :nisp)")))
    (is (not (search "nisp" (hint-to (lambda () (read-from-string "#z"))))))))

;;; The prompt.

(test prompt.says-what-is-lisp
  (dolist (line '("robot-x porter" "set-value x 1" "def-interp-proc d () 1"))
    (is-true (has-words-p (complaint line) "is Lisp, in parentheses: (") "~A" line))
  (dolist (line '("begin-plan turn-once" "run-plan 'turn-once"))
    (is-true (has-words-p (complaint line) "PLAN name argument..." "(run-plan 'name") "~A" line))
  (is-true (has-words-p (complaint "*score*") "EVAL *SCORE* shows the value"))
  (is (not (search "is Lisp" (complaint "xyzzy 1"))))
  (is (not (search "EVAL" (complaint "*")))))

;;; Plans.

(test run-plan.says-how-a-form-becomes-a-plan
  (flet ((told (plan) `(run:with-simulation (rover) (driver:run-plan ',plan))))
    (dolist (plan '((rpl:seq (driver:rpl-robot-turn 1)) (driver:rpl-robot-turn 1)))
      (is-true (complains-p (told plan)
                            (format nil "(run-plan (interp-lambda () (~(~A~) " (first plan)))))
    (is-true (complains-p (told '((driver:rpl-robot-turn 1) (rpl:wait-time 1)))
                          "(run-plan (interp-lambda () (rpl-robot-turn 1) (wait-time 1)))"))
    (is-true (complains-p (told '(take-two 1 2)) "(run-plan 'take-two 1 2)"))))

;;; Runs.

(test simulator.says-that-it-takes-one-robot
  (is-true (complains-p '(run:simulator '(rover buddy))
                        "Give one robot, as 'rover: all robots of its map are in its world"))
  (flet ((told (form) (warning-about `(lambda () ,form))))
    (is-true (has-words-p (told '(run:simulator 'rover 'buddy)) "simulator takes one robot"))
    (is (string= "" (told '(run:simulator 'rover :rate :free))))))

(test run-experiment.names-the-nearest-keyword
  (is-true (complains-p '(experiment:run-experiment 'none :trails 4)
                        "There is no keyword of run-experiment called trails"
                        "Did you mean trials?")))

(world:defmap quay (9 9))
(robot:defrobot crane (quay (3 3) 0) :cameras ((1 5)))
(robot:defrobot barrow (quay (6 6) 0) :hands (10))

(test commands.for-parts-outside-of-the-run-say-how-to-have-those-inside
  (flet ((told (name function reader &rest index)
           (let ((resource (apply reader (robot:find-robot name) index)))
             (error-output (run:with-simulation ((crane barrow))
                             (funcall function resource)
                             (run:run-ticks 1))))))
    (is-true (has-words-p (told 'crane (lambda (camera) (command:camera-turn camera 1))
                                #'robot:robot-camera 0)
                          "camera belongs to the crane outside"
                          "Inside WITH-SIMULATION, write (robot-camera crane 0)"))
    (is-true (has-words-p (told 'barrow (lambda (robot) (command:robot-turn robot 1)) #'identity)
                          "robot belongs to the barrow outside"
                          "Inside WITH-SIMULATION, write barrow"))))

(test schedule.says-where-the-delay-stands
  (loop for (form . words)
          in '(((time:schedule 10 (base:out "ten" t)) "write (schedule (nil :timer 10) ...)")
               ((time:schedule (:timer 10) (base:out "ten" t)) "(schedule (nil :timer 10) ...)")
               ((time:schedule (lambda () 1) 10) "the code to run is the body" "(nil :timer 10)")
               ((time:schedule rover 1) "write (schedule (rover :timer 1) ...)")
               ((time:schedule (rover 10) 1) "write (schedule (rover :timer 10) ...)")
               ((time:schedule (nil :timr 10) 1) "did you mean :timer?"))
        do (is-true (apply #'complains-p form words))))

(test rpl-init-robot.is-asked-for-before-the-plan
  (is-true (complains-p '(run:with-simulation ((crane barrow))
                          (driver:run-plan (rpl:interp-lambda () (driver:rpl-init-robot crane))))
                        "(rpl-init-robot crane) before the plan" ":robot ROBOT")))

(test commands-of-plans.outside-of-plans-name-those-of-programs
  (is-true (complains-p '(run:with-simulation (rover)
                          (let ((driver::*default-interface* nil))
                            (driver:rpl-robot-go-forward 3)))
                        "use commands without RPL-, such as (robot-turn rover 1)")))

(test sleep.in-plans-is-a-wait-in-seconds
  (is-true (has-words-p (warnings-of-procedure '(list robot) '(sleep 5))
                        "In a plan write (wait-time 5 :unit :seconds)."))
  (is-true (has-words-p (warnings-of-procedure '(list robot) '(run:run-ticks 5))
                        "(wait-time 5), for that many ticks")))

(test designators.that-are-not-yet-found-are-waited-for
  (flet ((told (&rest waits)
           (rover-writes ()
             (driver:run-plan
              (rpl:make-plan
               `(rpl:seq (driver:rpl-camera-get-all-object-designators 0 :non-local '((:color red)))
                         ,@waits
                         (driver:rpl-camera-track
                          0 (first (rpl:fluent-value
                                    (svref driver:camera-designators* 0))))))))))
    (is-true (has-words-p (told) "designator is NIL" "The search for it is still under way"
                          "(wait-for (vref camera-input* 0))"))
    (is (not (search "under way"
                     (told '(rpl:wait-for (svref driver:camera-input* 0))))))))

;;; Functions called in the place of a continuation.

(defun arrived-here (&rest told) told)
(defun rider-of (&rest told) (lambda (&rest more) (append told more)))
(defun next-one () nil)

(test continuations.that-are-called-at-once-are-warned-of
  (flet ((told (continuation)
           (warning-about `(lambda () (command:robot-turn rover 1 ,continuation)))))
    (is-true (has-words-p (told '(arrived-here)) "(arrived-here) is evaluated at once"
                          "(continuation (err &rest results) (arrived-here))"))
    (dolist (form '(#'arrived-here (rider-of) (next-one) (arrived-here 1) nil))
      (is (string= "" (told form))))))

(test commands.whose-values-are-used-are-warned-of
  (flet ((told (form) (warning-about `(lambda () (run:with-simulation (rover) ,form)))))
    (dolist (form '((let ((v (command:robot-turn rover 1))) (length v))
                    (case (command:robot-turn rover 1) (1 2))
                    (if (command:robot-turn rover 1) 1 2)
                    (progn (dolist (x (command:camera-view (robot:robot-camera rover 0))) x))))
      (is-true (has-words-p (told form) "returns nothing: it only begins the command")))
    (dolist (form '((progn (command:robot-turn rover 1) (run:run-ticks 3))
                    (let ((v 3)) (command:robot-turn rover v))))
      (is (string= "" (told form))))))

(test rpl-init-robot.in-a-plan-says-that-it-ends-that
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (driver:rpl-init-robot rover)
                                                    (rpl:wait-time 3))))
                        "ends the plan" "Call it before the plan, not in the plan")))

(test manipulations.say-that-no-method-is-for-the-things
  (with-own-definitions
    (eval '(command:defmanipulation paint-over (pot - ((:kind :pot)) :by hand) () t))
    (is-true (has-words-p
              (rover-writes (:clean t)
                (let ((crate (world:find-thing 'crate)))
                  (robot:place-robot rover (world:thing-x crate) (- (world:thing-y crate) .3) 0)
                  (command:camera-get-object-designator
                   (robot:robot-camera rover 0) :local '((:size 6))
                   (lambda (err camera designator)
                     (declare (ignore err camera))
                     (command:run-manipulation 'paint-over designator
                                               (robot:robot-hand rover 0) nil)))
                  (run:run-ticks 9)))
              "paint-over failed: no method fits"))))

(test handlers.of-errors-are-told-to-take-no-fail
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (rpl:handle-failure ((error () (return 1)))
                                                      (rpl:fail :class :lost)))))
                        "a clause is for error, which matches Lisp errors" "write :lost or T")))

(test plans.that-fail-live-are-told-to-programs
  (live (simulation)
    (driver:run-plan (plan-of (rpl:fail :class :lost)))
    (is-true (some (lambda (message)
                     (and (eq t (definitions::message-notable-p message))
                          (has-words-p (base:message-text message) "The second value of RUN-PLAN")))
                   (base:take-messages)))))

(test handlers.of-condition-types-as-keywords-are-told-of
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan
                           (plan-of (rpl:handle-failure ((:deadline-missed () (return 1)))
                                      (rpl:with-deadline (3) (rpl:wait-time 9))))))
                        "a clause is for :deadline-missed, but the class of the failure is"
                        "deadline-missed")))

(test handlers.with-other-endings-are-told-of
  (is-true (has-words-p (rover-writes ()
                          (driver:run-plan (plan-of (rpl:handle-failure ((:stucked () (return 1)))
                                                      (rpl:fail :class :stuck)))))
                        "a clause is for :stucked, but the class of the failure is :stuck")))

;;; Kickers and attributes of things.

(defun told-of-run (&rest forms)
  "Return the output of two runs of a robot after the definitions FORMS. The map is new; its thing
PAIL has the attribute :level and the kicker IN-USE. The second run has no new definitions."
  (with-own-definitions
    (mapc #'eval forms)
    (eval '(world:defmap loft (10 10) (obj (pail :kickers (in-use)) (5 5) ((:level 3)))))
    (eval '(robot:defrobot loftman (loft (3 3) 0)))
    (loop repeat 2
          collect (error-output (eval '(run:with-simulation (loftman) (run:run-ticks 3)))))))

(test kickers.on-no-thing-are-told-once
  (destructuring-bind (first second)
      (told-of-run '(world:defkicker in-use (thing) () nil)
                   '(world:defkicker left-over (thing) () nil))
    (is-true (has-words-p first "No thing has the kicker left-over"
                          "(set-kicker THING 'left-over)"))
    (is (= 1 (count #\Newline first)))
    (is (string= "" second)))
  (is (equal '("" "")
             (told-of-run '(world:defkicker in-use (thing) () nil)
                          '(world:defkicker for-later (thing) () nil)
                          '(world:defmap attic (10 10)
                            (obj chest (5 5) () ((box :kickers (for-later)) ())))))))

(test kickers.of-files-are-told-of-if-these-name-them-once
  (with-own-definitions
    (flet ((told (more)
             (uiop:with-temporary-file (:pathname path :type "lisp")
               (write-text (format nil "(in-package :ars-magna.tests)
(world:defkicker prowl-about (thing) () nil)
(world:defmap barn (9 9) (obj cat (5 5) ()))
(robot:defrobot farmer (barn (3 3) 0))
~@[~A~]~%" more) path)
               (load path)
               (error-output (eval '(run:with-simulation (farmer) (run:run-ticks 3)))))))
      (is-true (has-words-p (told nil) "No thing has the kicker prowl-about"))
      (is (string= "" (told "(defun prowl (cat) (world:set-kicker cat 'prowl-about))"))))))

(test kickers.whose-tests-ask-for-what-nothing-has-are-told
  (flet ((told (test)
           (first (told-of-run `(world:defkicker in-use (thing) (:test ,test) nil)))))
    (is-true (has-words-p (told '(world:get-attribute thing :hungry))
                          "The :test of the kicker in-use was never true" ":hungry"))
    (dolist (test '((not (world:get-attribute thing :hungry))
                    (eql 9 (world:get-attribute thing :level))
                    (world:get-attribute thing :closed)))
      (is (string= "" (told test))))))

(test kickers.that-functions-put-on-things-are-quiet
  (is (equal '("" "")
             (told-of-run '(world:defkicker in-use (thing) () (world:set-kicker thing 'hatched))
                          '(world:defkicker hatched (thing) () nil)))))

(test kickers.on-no-thing-are-told-live
  (with-own-definitions
    (eval '(world:defkicker live-spare (thing) () nil))
    (live (simulation)
      (command:robot-turn fitter 1/2 nil)
      (is-true (await (lambda () (plusp (run:simulation-tick simulation)))))
      (run:stop-simulator simulation)
      (is-true (some (lambda (message)
                       (has-words-p (base:message-text message) "the kicker live-spare"))
                     (base:take-messages))))))

(test attributes.misspelt-in-equal-clauses-have-lines-of-their-own
  (with-own-definitions
    (uiop:with-temporary-file (:pathname path :type "lisp")
      (write-text "(in-package :ars-magna.tests)
(world:defmap barn (9 9)
  (obj cat (5 5) ((:size 1) (:colour red)))
  (obj dog (4 5) ((:size 1) (:colour red))) (obj cow (3 5) ())
  (obj pig (3 5)
       ((:size 1) (:colour red))))" path)
      (let ((text (with-output-to-string (*error-output*) (load path))))
        (is-true (has-words-p text "line 3): cat has :colour" "line 4): dog has :colour"
                              "line 5): pig has :colour"))))))

(test attributes.asked-for-are-compared-with-those-of-things
  (flet ((told (key)
           (first (told-of-run `(world:defkicker in-use (thing) ()
                                  (world:get-attribute thing ,key))))))
    (is-true (has-words-p (told :levl) "get-attribute of pail: :levl is not declared"
                          "nothing here has it" "did you mean :level?"))
    (is (string= "" (told :level)))
    (is (string= "" (told :owner)))))
