;;;; cli-trials.lisp -- the prompt inside a trial of an experiment.

(in-package :ars-magna.tests)

(def-suite* cli-trials :in ars-magna)

(defun trial-lines (&rest lines)
  "Type LINES in a batch, after one that opens a trial of a plan. Return what follows on that."
  (rest (apply #'type-batch "trial trying way=by-plan 1" lines)))

(test trial.begins-at-tick-0-and-passes-by-steps
  (let ((text (joined (trial-lines "trial" "plans" "step" "repeat 2 step" "status"))))
    (is-true (has-words-p text "Trial 1 of trying, way=by-plan." "Tick 0, paused."
                          "waiting: wander" "Tick 1." "Tick 3." "Position:"))))

(test trial.passes-to-its-end-and-stays-there
  (let* ((lines (trial-lines "resume" "trial" "(simulation-tick)" "step" "why 1" "trial off"
                             "(simulation-tick)"))
         (text (joined lines))
         (ticks (getf (experiment:replay-trial 'trying "by-plan" 1) :ticks)))
    (is (plusp ticks))
    (is-true (has-words-p text "robot-turn: Robot turned"
                          (format nil "The trial is over at tick ~D: success. angle " ticks)
                          (format nil "Tick ~D, over." ticks)
                          "*ERROR* -> The trial is over." "started at tick 0"
                          "You have left the trial for parlour."))
    (is (string= "0" (first (last lines))) "the prompt's own run has not moved")))

(test trial.is-the-very-run
  (call-with-trials
   (lambda (results path)
     (declare (ignore results))
     (dolist (way '("well" "badly" "loudly" "slowly" "in-passing" "breaking" "way=by-plan"))
       (multiple-value-bind (lines errors)
           (type-lines (list (format nil "trial trying ~A 2 ~A" way path) "plans" "step" "map 3"
                             "plan-tree" "status" "things" "resume")
                       :batch t)
         (is-true (find "The result equals its row." lines :test #'string=) "~A: ~S" way lines)
         (is (>= 1 errors) "none but that there is no plan in ~A" way))))))

(test trial.says-when-it-is-changed
  (flet ((told (line)
           (count-if (lambda (written) (search "not the experiment's run any more" written))
                     (trial-lines "step 2" line line))))
    (dolist (line '("turn 1" "pos 3 3" "seed 5" "(setf motion-noise* 0.5)" "stop-plan"
                    "(robot-turn butler 1)" "params motion-noise 0.5"))
      (is (= 1 (told line)) "~A" line))
    (dolist (line '("status" "map" "plan-tree" "why 1" "params" "rate 5" "(random 10)" "things"
                    "(state-digest)"))
      (is (= 0 (told line)) "~A" line)))
  (is-true (has-words-p (joined (trial-lines "step 2" "turn 1" "resume"))
                        "not the experiment's result: the run was changed at tick 2")))

(test trial.leads-on-to-others-and-out
  (let ((text (joined (trial-lines "step 2" "trial trying badly 1" "resume" "trial trying well 2"
                                   "step" "trial off" "trial"))))
    (is-true (has-words-p text "Trial 1 of trying, way=badly: seed 1, at most 50 ticks"
                          "over at tick 7: failure (no-luck)"
                          "Trial 2 of trying, way=well: seed 2" "Tick 1." "You have left the trial"
                          "  trying")))
  (is (string= "5" (first (last (trial-lines "step" "trial off" "(+ 2 3)")))))
  (is (null (trial-lines "quit" "(+ 2 3)"))))

(test trial.ends-as-the-session-ends
  (dolist (lines '(() ("step 2") ("resume") ("quit")))
    (is (listp (apply #'trial-lines lines)))
    (is (null time:*simulation*))))

(test trial.lines-that-go-wrong-cost-only-themselves
  (let ((lines (trial-lines "(error \"no\")" "nonsense" "(+ 2 3)" "(break \"oh\")" "(run-ticks 1)"
                            "repeat 2 turn" "step -1" "step" "resume")))
    (is-true (has-words-p (joined lines) "*ERROR* -> no" "*ERROR* -> There is no command" "5"
                          "*ERROR* -> Break: oh" "no time can pass" "Tick 1."
                          "The trial is over" "success"))))

(test trial.lists-what-there-is
  (let ((text (joined (type-batch "trial" "trial try"))))
    (is-true (has-words-p text "trying" "What becomes of trials" "2 trials of each" "1  way=well")))
  (is-true (has-words-p (complaint "trial tryingg 1 1") "no experiment" "trying"))
  (is-true (has-words-p (complaint "trial trying by- 1") "way=by-plan" "way=by-failing-plan"))
  (is-true (has-words-p (complaint "trial trying nonsense 1") "nonsense" "1: way=well"))
  (is-true (has-words-p (complaint "trial off") "not in a trial")))

(test trial.is-interrupted-by-control-c
  (let ((text (joined (type-at-terminal "trial interrupting all 1" "step 6" "(+ 40 2)" "resume"))))
    (is-true (has-words-p text "Interrupted: the trial pauses at its next tick" "Tick 3." "42"
                          "over at tick 7: success")))
  (let ((text (joined (type-at-terminal "trial interrupting-twice all 1" "step 6" "(+ 40 2)"
                                        "trial off"))))
    (is-true (has-words-p text "The trial has been left." "Interrupted." "42" "not in a trial")))
  (let ((text (joined (type-lines '("trial interrupting all 1" "step 6" "(+ 40 2)")))))
    (is-true (has-words-p text "The trial has been left." "Interrupted." "42")))
  (is (= 130 (catch 'cli::leave
               (type-batch "trial interrupting all 1" "step 6" "(+ 40 2)")))))

(test trial.line-can-be-interrupted
  (is-true (has-words-p (joined (type-lines '("trial trying well 1"
                                              "(ars-magna.host:signal-user-interrupt)" "step")))
                        "Interrupted." "Tick 1.")))

(test trial.breaks-ask-who-sits-there
  (let ((written (type-at-terminal "trial trying breaking 1" "step 9" "(simulation-tick)" "continue"
                                   "(+ 2 3)")))
    (dolist (line '("*BREAK* -> look here" "2" "The trial is over at tick 2: success" "5"))
      (is-true (written-p line written) "~A is not in ~S" line written))))

(test failures.can-be-opened
  (call-with-trials
   (lambda (results path)
     (declare (ignore results))
     (let* ((lines (type-batch (format nil "failures ~A" path)))
            (line (find "trial trying way=loudly 1" lines :test #'search)))
       (is-true (has-words-p (joined (type-batch (string-trim " " line) "resume"))
                             "over at tick 3: error" "This is loud."))
       (is (= 3 (length (type-batch "failures try loudly"))))
       (is-true (has-words-p (complaint "failures interrupting") "was not run"))))))

(test trial.stops-a-live-prompt-meanwhile
  (let ((lines (type-live '("pause" "(simulation-tick)" "trial trying well 1" "resume" "trial off"
                            "(simulation-tick)")
                          :batch t)))
    (is (string= (second lines) (first (last lines))))
    (is-true (has-words-p (joined lines) "over at tick 5: success"))))

(test trial.stays-open-if-another-has-no-row
  (let ((text (joined (trial-lines "step 2" "trial trying well 2 /no/such/directory" "trial"))))
    (is-true (has-words-p text "*ERROR* -> " "no/such" "Tick 2"))
    (is-false (search "way=well" text))))
