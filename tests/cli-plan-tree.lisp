;;;; cli-plan-tree.lisp -- plans at the prompt: PLAN-TREE, WHY, PLAN-TIMELINE, breaks, steps.

(in-package :ars-magna.tests)
(in-suite cli-plans)

(rpl:def-interp-proc ars-user::loiter (ticks)
  (let ((mood :idle))
    (rpl:par (rpl:seq (rpl:wait-time ticks) mood)
             (:tag ars-user::lazy (rpl:wait-for (rpl:create-fluent 'ars-user::bell))))))

(test plan-tree.shows-stacks-and-variables
  (let ((shown (joined (type-batch "(begin-plan 'loiter 9)" "step 2" "plan-tree" "stop-plan"))))
    (is-true (has-words-p shown "1 waiting: loiter" "ticks = 9" "mood = :idle" "3 waiting: lazy"
                          "waits for bell since tick 1"))
    (is-false (has-words-p shown "ars-user::"))))

(test plan-tree.of-one-task
  (let ((shown (joined (type-batch "(begin-plan 'loiter 9)" "step 2" "plan-tree 3" "stop-plan"))))
    (is-true (has-words-p shown "3 waiting: lazy" "waits for bell"))
    (is-false (has-words-p shown "1 waiting")))
  (is-true (has-words-p (complaint "plan-tree") "No plan is under way"))
  (is-true (has-words-p (joined (type-batch "(begin-plan 'loiter 9)" "step" "plan-tree 7"
                                            "stop-plan"))
                        "*ERROR*" "No task 7")))

(test why.tells-at-the-prompt
  (let ((shown (joined (type-batch "(setf *trace-plans* t)" "plan dawdle 3" "why 1"
                                   "plan stroll 1" "why 2"
                                   "(setf *trace-plans* nil)"))))
    (is-true (has-words-p shown "At tick 4 it went on" "because tick 4 had come"
                          "Task 1 is the plan dawdle, started at tick 0 by the prompt"
                          "the answer to (rpl-robot-turn 1)")))
  (is-true (has-words-p (joined (type-batch "plan dawdle 1" "why 1")) "*ERROR*" "*trace-plans*")))

(test plan-timeline.saves-a-picture
  (uiop:with-temporary-file (:pathname path :type "svg")
    (let ((shown (type-batch "(setf *trace-plans* t)" "plan dawdle 3"
                             (format nil "plan-timeline ~A" (uiop:native-namestring path))
                             "(setf *trace-plans* nil)")))
      (is (search ".svg" (third shown)) "~S" shown)
      (is (search "1 dawdle" (uiop:read-file-string path))))))

(test breaks.of-plans-are-messages-in-a-batch
  (let ((shown (joined (type-batch "(setf *break-on-plan-failures* t)" "plan stumble :ice"
                                   "(setf *break-on-plan-failures* nil)"))))
    (is-true (has-words-p shown "Break" "Plan failure :ICE" "stumble failed"))))

;;; Where somebody sits.

(rpl:def-interp-proc ars-user::two-waits ()
  (rpl:wait-time 1)
  (rpl:wait-time 2)
  :waited)

(test steps.are-taken-at-the-prompt
  (let ((written (type-at-terminal "(step-plan 'two-waits)" "step" "(* 6 7)" "continue" "(+ 2 3)")))
    (dolist (line '("*BREAK* -> Next: (wait-time 1)" "*BREAK* -> Next:" "42" "5"))
      (is-true (written-p line written) "~A is not in ~S" line written))
    (is (= 2 (count-if (lambda (line) (search "*BREAK* -> Next" line)) written)))
    (is-true (find-if (lambda (line) (search "in task two-waits, at tick 0" line)) written))))

(test breaks.of-plans-ask-how-to-go-on
  (let ((written (type-at-terminal "(setf *break-on-plan-failures* t)" "(run-plan 'stumble :ice)"
                                   "continue" "(setf *break-on-plan-failures* nil)" "(+ 2 3)")))
    (is-true (written-p "*BREAK* -> Plan failure :ICE" written) "~S" written)
    (is-true (find-if (lambda (line) (search "reason = :ice" line)) written))
    (is-true (written-p "5" written))))

(test break.shows-plans-and-their-variables
  (let* ((base:*break-on-user-error* t)
         (written (type-at-terminal
                   "(run-plan (interp-lambda () (let ((spade 10)) (error \"stone\") spade)))"
                   "plan-tree" "backtrace" "leave-plan")))
    (is-true (find-if (lambda (line) (has-words-p line "spade" "10")) written) "~S" written)
    (is-true (find-if (lambda (line) (has-words-p line "(error \"stone\")")) written) "~S" written)
    (is (notany (lambda (line) (search "RUN-ROUNDS" line)) written)
        "the engine's own calls are not shown")))
