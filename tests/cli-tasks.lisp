;;;; cli-tasks.lisp -- END-TASK, STEP-TASK, TRACE-PLANS, REWIND-TO at the prompt.

(in-package :ars-magna.tests)
(in-suite cli-plans)

(test end-task.ends-one-part-of-a-plan
  (let ((shown (joined (type-batch "(begin-plan 'loiter 9)" "step 2" "end-task 3" "plan-tree"
                                   "stop-plan"))))
    (is-true (has-words-p shown "Task 3, lazy ends." "1 waiting: loiter"))
    (is-false (has-words-p shown "waits for bell")))
  (is-true (has-words-p (complaint "end-task 1") "No plan is under way"))
  (is-true (has-words-p (joined (type-batch "(begin-plan 'loiter 9)" "step" "end-task 77"
                                            "end-task ho" "stop-plan"))
                        "No task 77 is under way" "No task ho is under way")))

(test step-task.is-switched-on-and-off
  (let ((shown (joined (type-batch "(begin-plan 'loiter 9)" "step 2" "step-task 2"
                                   "step-task 2 off" "step-task 2 maybe" "stop-plan"))))
    (is-true (has-words-p shown "stops when it continues." "continues without stopping."
                          "give OFF or nothing, not maybe"))))

(test trace-plans.begins-at-once
  (let ((ars-magna.rpl-robot:*trace-plans* nil))
    (is-true (has-words-p (joined (type-batch "(begin-plan 'loiter 4)" "step 2" "trace-plans on"
                                              "step 3" "why 2" "trace-plans off" "trace-plans"
                                              "stop-plan"))
                          "A trace of plans is kept." "Task 2, " "No trace of plans is kept."))))

(test trace-plans.changes-nothing-where-plans-cannot-be-asked
  (let ((ars-magna.rpl-robot:*trace-plans* nil))
    (run:call-with-simulation
     (lambda ()
       (let ((task (ars-magna.rpl-robot:begin-plan 'ars-user::loiter 9)))
         (run:run-ticks 2)
         (setf (ars-magna.rpl-robot::interface-hog ars-magna.rpl-robot::*default-interface*) task
               (ars-magna.rpl::task-state task) :running)
         (is (search "keeps the plans' thread busy" (type-here "trace-plans on")))
         (is (null ars-magna.rpl-robot:*trace-plans*))
         (setf (ars-magna.rpl::task-state task) :waiting)))
     '(ars-user::butler))))

(test rewind-to.goes-to-a-tick
  (let ((shown (joined (type-batch "(keep-forks)" "step 9" "rewind-to 4" "(simulation-tick)"
                                   "rewind-to 90"))))
    (is-true (has-words-p shown "Tick 4" "This run is at tick 4"))))

(test task-lines.complete-numbers-of-tasks
  (run:call-with-simulation
   (lambda ()
     (ars-magna.rpl-robot:begin-plan 'ars-user::loiter 9)
     (run:run-ticks 2)
     (is (equal '(1 2 3) (sort (copy-list (ars-magna.cli::argument-choices :task-number nil ""))
                               #'<))))
   '(ars-user::butler)))
