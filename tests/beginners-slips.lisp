;;;; beginners-slips.lisp -- what beginners confuse: results, worlds, walls, types.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Continuations.

(test commands.warn-of-what-is-done-where-a-continuation-is-wanted
  (flet ((told (form) (warning-about `(lambda (robot) (command:robot-turn robot 1 ,form)))))
    (dolist (form '((base:out "done") (setq done nil) (command:robot-go-forward robot 1 nil)))
      (is-true (has-words-p (told form) "is evaluated at once, not when the command has ended"
                            "(continuation (err &rest results) (")))
    (dolist (form '(nil 'later (nisp:continuation (err &rest results) (base:out "done"))
                    #'list (car (list 'list))))
      (is (string= "" (told form))))))

(test commands.refuse-t-and-keywords-as-continuations
  (dolist (continuation '(t :done))
    (is-true (complains-p `(run:with-simulation (rover) (command:robot-turn rover 1 ,continuation))
                          "give a continuation" "(continuation (err &rest results) ...)"))))

(test variables.called-like-an-error-code-are-told-of-the-colon
  (flet ((text (name) (basics::lisp-error-text (make-condition 'unbound-variable :name name))))
    (is-true (has-words-p (text (intern "ROBOT-BLOCKED" :ars-user)) "Did you mean :robot-blocked?"))
    (is (not (search "Did you" (text (intern "NOT-A-CODE-OF-OURS" :ars-user)))))))

;;; Other worlds.

(world:defmap bay (9 9))
(robot:defrobot barge (bay (3 3) 0))
(robot:defrobot tug (bay (6 6) 0))

(test changes.of-what-is-over-are-told-of-once
  (let ((old (run:with-simulation (rover) rover)))
    (with-messages
      (loop repeat 2 do (robot:place-robot old 3 3 0))
      (let ((text (displayed)))
        (is (= 1 (length (lines-of text))) "~A" text)
        (is-true (has-words-p text "place-robot changes an object of a past run" "is over"))))))

(test changes.for-a-later-run-are-told-of-inside-of-another
  (let ((later (robot:find-robot 'barge)))
    (is-true (has-words-p (rover-writes () (robot:place-robot later 4 4 0))
                          "place-robot changes bay for a later run" "WITH-SIMULATION"))))

(test commands.for-a-robot-that-is-not-in-the-run-say-how-it-gets-there
  (let ((tug (robot:find-robot 'tug)))
    (is-true (has-words-p (error-output (run:with-simulation (barge)
                                          (command:robot-turn tug 1)
                                          (run:run-ticks 1)))
                          "no run of TUG is in progress"
                          "(with-simulation ((ROBOT tug)) ...)"))))

(test changes.of-forks-are-quiet
  (is (string= "" (rover-writes ()
                    (robot:place-robot (run:counterpart rover (run:fork-simulation)) 3 3 0)))))

(test walls.are-told-of-once-by-what-is-put-into-them
  (let ((text (rover-writes () (loop repeat 2 do (robot:place-robot rover 0 0 0)))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "ROVER is inside a wall now, at 0.00, 0.00")))
  (is (string= "" (rover-writes () (robot:place-robot rover 3 3 0)))))

;;; Parameters.

(test parameters.bound-around-a-command-alone-are-told-of-once
  (flet ((go-forward (rover) (command:robot-go-forward rover 1 nil)))
    (let ((text (rover-writes ()
                  (loop repeat 2
                        do (let ((base:max-speed* 1/10)) (go-forward rover))
                           (run:run-ticks 2)))))
      (is (= 1 (length (lines-of text))) "~A" text)
      (is-true (has-words-p text "robot-go-forward was issued while max-speed* was 1/10"
                            ":parameters '((max-speed* 1/10))")))
    (is (string= "" (rover-writes ()
                      (let ((base:max-speed* 1/10)) (go-forward rover) (run:run-ticks 2))
                      (setf base:max-speed* 1/5)
                      (go-forward rover)
                      (run:run-ticks 2))))))

(test parameters.bound-around-a-command-of-a-live-run-are-told-of
  (let ((robot (robot:find-robot 'rover)))
    (with-messages
      (run:simulator 'rover :rate :free :display nil)
      (unwind-protect
           (progn (let ((base:max-speed* 1/10)) (command:robot-stop robot nil))
                  (is-true (has-words-p (displayed) "robot-stop is carried out in the simulator"
                                        "not 1/10 as in this LET"
                                        "(setf max-speed* 1/10)"))
                  (command:robot-turn robot 1 nil)
                  (is (not (search "LET" (displayed) :test #'char=))))
        (run:stop-simulator)))))

;;; Plans.

(test fluent-value.refuses-vectors-of-fluents
  (is-true (complains-p '(rpl:fluent-value (rpl:create-fluent-vector 'driver:camera-views* 1))
                        "camera-views* is a vector of fluents: fluent-value needs one of them"
                        "(vref camera-views* camera)"))
  (is (equalp #(1 2) (rpl:fluent-value (vector 1 2)))))

(test plans.warn-of-handlers-of-errors-around-failures
  (dolist (form '((handler-case (rpl:fail :lost) (error () :ok))
                  (list (ignore-errors (rpl:fail :lost)))
                  (handler-bind ((error #'print)) (rpl:fail :lost))))
    (is-true (has-words-p (warnings-of-procedure '(list robot) form)
                          "does not handle failures of plans" "(handle-failure (")))
  (dolist (form '((handler-case (rpl:fail :lost) (rpl:plan-failure () :ok))
                  (handler-case (car robot) (error () (rpl:fail :lost)))
                  (ignore-errors (car robot))))
    (is (string= "" (warnings-of-procedure '(list robot) form)))))

(test types.that-are-slips-for-known-ones-are-warned-of
  (flet ((told (type)
           (warning-about `(rpl:def-interp-proc ,(gensym "PLAN") (part - ,type) (list part)))))
    (is-true (has-words-p (told (intern "HND" :ars-user)) "there is no type hnd"
                          "Did you mean hand?"))
    (dolist (type '(hand integer vase (lst vase)))
      (is (string= "" (told type))))))

;; Which of the names in conflict comes first depends on the version of SBCL.
(test packages.with-a-conflict-say-how-to-settle-it
  (let ((package (make-package (gensym "MINE") :use '(:cl))))
    (unwind-protect
         (handler-case (use-package :ars package)
           (package-error (condition)
             (let ((text (base:text-of-condition condition)))
               (is-true (or (has-words-p text "MAP would mean ARS-MAGNA.WORLD:MAP and"
                                         "COMMON-LISP:MAP"
                                         "(:shadowing-import-from :ars #:map)"
                                         "(ars:define-user-package :mine)")
                            (has-words-p text "EQUAL would mean ARS-MAGNA.GEOMETRY:EQUAL and"
                                         "COMMON-LISP:EQUAL"
                                         "(:shadowing-import-from :ars #:equal)"
                                         "(ars:define-user-package :mine)"))
                        "~A" text))))
      (delete-package package))))

(test commands.name-their-parameters-where-one-is-missing
  (flet ((told (form) (warning-about `(lambda (robot) ,form))))
    (is-true (has-words-p (told '(command:robot-turn robot))
                          "robot-turn takes (robot angle &optional continuation), not 1 argument."))
    (is-true (has-words-p (told '(command:robot-turn robot 1 nil 2)) "not 4 arguments"))
    (dolist (form '((command:robot-turn robot 1) (command:robot-turn robot 1 nil)
                    (command:robot-stop robot)))
      (is (string= "" (told form))))))

;;; The prompt.

(defun typed (&rest lines)
  "Return the output of a session in which LINES are typed."
  (joined (apply #'type-batch lines)))

(test prompt.says-what-is-a-plan-and-what-is-a-line
  (is-true (has-words-p (typed "fetch-thing") "FETCH-THING is a plan: PLAN FETCH-THING"))
  (is-true (has-words-p (typed "(fetch-thing 1)") "FETCH-THING is a plan: PLAN FETCH-THING"))
  (is (null (search "There is" (typed "(fetch-thing 1)"))) "the advice of the prompt alone")
  (is-true (has-words-p (typed "(turn 1)") "TURN is a command of this prompt"
                        "without parentheses: TURN angle"))
  (is-true (has-words-p (typed "go 3 4") "GO-TO x y drives to a place"))
  (is-true (has-words-p (typed "(robot-turn robbie)")
                        "robot-turn takes (robot angle &optional continuation), not 1 argument")))

(test prompt.tells-of-commands-in-comments
  (is-true (has-words-p (typed "turn 1; go 3 m") "is a comment: go 3 m was left out"))
  (dolist (line '("turn 1 ; go home" "turn 1 ;; stop" "turn 1; the other way"))
    (is (not (search "left out" (typed line))))))

(test prompt.tells-of-new-variables-that-may-be-slips
  (dolist (name '("MAX-SPED*" "NEVER-SEEN*" "XX"))
    (makunbound (intern name :ars-user)))
  (is-true (has-words-p (typed "(setf max-sped* 1)") "max-sped* is a new variable"
                        "Did you mean max-speed*?"))
  (let ((text (typed "(setf never-seen* 0)" "(setf never-seen* 1)")))
    (is-true (has-words-p text "never-seen* is a new variable"))
    (is (= 1 (count-of "new variable" text))))
  (dolist (line '("(setf xx 4)" "(defvar *known-by-now* 1)" "(setf max-speed* 1)"
                  "(let ((zz* 3)) (setf zz* 4))"))
    (is (not (search "new variable" (typed line))))))

(test shipped-plans.want-places-in-a-list
  (flet ((told (&rest plan)
           (error-output (run:with-simulation (ars-worlds:robbie)
                           (apply #'driver:run-plan plan)))))
    (dolist (plan '((ars-worlds:fetch-thing ((:color blue)) (3 4))
                    (ars-worlds:tidy-room (((:color blue))) 4)
                    (ars-worlds:search-nearest ((:color blue)) (3 4))))
      (is-true (has-words-p (apply #'told plan) "places is" "such as ((3 4) (5 6))")))
    (is-true (has-words-p (told 'ars-worlds:patrol-places '(3 4)) "points is (3 4)"))))
