;;;; rpl-seeing-truth.lisp -- what is shown of plans is correct and readable.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun seen-at (tick form)
  "Return the top-level task of the plan FORM, which has run until TICK, and its runner."
  (multiple-value-bind (runner task) (seen-until tick :plan (rpl:make-plan form))
    (values task runner)))

;;; Names.

(test text.leaves-out-the-packages-of-symbols
  (let* ((*package* (find-package :keyword))
         (task (seen-at 0 '(rpl:seq (rpl:wait-for (fluent nil 'f) :timeout 9) "a:b"))))
    (is (string= "1 waiting: (wait-for (fluent nil (quote f)) :timeout 9) waits for f since tick 0"
                 (first (lines-of (tree-text task)))))
    (is (string= "(a \"p:q\" :key nil \"cl:car\" nil . b)"
                 (tasks:form-text '(a "p:q" :key nil "cl:car" nil . b))))
    (is (string= "Plan failure SLIP WHO :ME"
                 (princ-to-string (tasks:make-failure '(:class slip who :me)))))
    (is (search "(eq f never)" (princ-to-string (rpl:fl-funcall 'eq (fluent nil 'f) 'never))))))

;;; Variables.

(test task-variables.are-those-in-force
  (let* ((form '(let ((a 1) (b 2))
                  (let* ((reached a) (reached (+ reached 10)) (reached (list reached)) (a 3))
                    (rpl:wait-time 9)
                    (list a b reached))))
         (task (seen-at 0 form)))
    (is (equal '((reached (11)) (a 3) (b 2)) (rpl:task-variables task)))
    (is (= 1 (count-of "reached = (11)" (tree-text task t))))
    (is (search "a = 3" (tree-text task t)))
    (is (null (search "a = 1" (tree-text task t))))
    (is (search "b = 2" (tree-text task t)))
    (is (null (search "reached = 1" (tree-text task t))))))

(test task-variables.of-a-let*-that-waits-are-those-bound-so-far
  (is (equal '((reached 1))
             (rpl:task-variables
              (seen-at 0 '(let* ((reached 1)
                                 (reached (rpl:seq (rpl:wait-time 9) reached)))
                           (list reached)))))))

;;; Calls.

(rpl:def-interp-proc seen-deep (k)
  (if (> k 0)
      (seen-deep (- k 1))
      (rpl:wait-time 9)))

(rpl:def-interp-proc seen-deeper (k)
  (rpl:seq (list k)
           (when (= k 0) (rpl:wait-time 9))
           (seen-deeper (- k 1))
           (list k)))

(test stack.has-a-frame-for-each-call
  (dolist (plan '(seen-deep seen-deeper))
    (let* ((task (seen-at 0 `(,plan 2)))
           (text (tree-text task t)))
      (is (equal `((,plan (- k 1)) (,plan (- k 1)) (,plan 2))
                 (last (rpl:task-stack task) 3)))
      (is (= 2 (count-of "(- k 1)" text)))
      (is (= 2 (count-of "(- k 1)" (described task))))
      (loop for k below 3
            do (is (= 1 (count-of (format nil "k = ~D" k) text)) "~A" text)))))

;;; Why.

(test why.of-no-task-is-a-clear-error
  (let ((runner (seen-until 0)))
    (dolist (object '(nil foo "1" 0))
      (signals base:wrong-argument (rpl:why object :runner runner)))
    (dolist (function (list 'rpl:evaporate 'rpl:task-status 'rpl:task-children 'rpl:task-top
                            'rpl:task-form 'rpl:task-place 'rpl:task-source 'rpl:valve-owner
                            'rpl:task-stack 'rpl:task-variables))
      (signals base:wrong-argument (funcall function nil)))
    (signals base:wrong-argument (rpl:print-tasks 5))))

(defun why-at (tick form number)
  (why-text number (nth-value 1 (seen-at tick form))))

(test why.names-deadlines-and-limits
  (is-true (has-words-p (why-at 5 '(rpl:with-deadline (3) (rpl:wait-time 9)) 2)
                        "evaporated, because the deadline of 3 ticks of task 1 ended it")))

(test why.says-what-was-blocked
  (let ((text (why-at 9 '(rpl:par (:tag a (rpl:wait-time 4))
                          (rpl:seq (rpl:wait-time 3)
                                   (rpl:suspend a)
                                   (rpl:wait-time 5)
                                   (rpl:wake-up a)))
                      2)))
    (is-true (has-words-p text
                          "At tick 4 it could have gone on at (wait-time 4), but was blocked"
                          "At tick 8 it was blocked no longer"))))

(test why.tells-of-orders
  (let ((text (why-at 9 '(rpl:partial-order ((:tag a (rpl:wait-time 2))
                                             (:tag b (rpl:wait-time 1)))
                          (:order a b))
                      3)))
    (is-true (has-words-p text "At tick 2 it went on, because what it had to come after was over"
                          "At tick 0 it began to wait for the end of a."))))

(test why.names-who-ended-a-plan
  (let* ((runner (rpl:make-plan-runner :trace t))
         (task (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-time 9)))))
    (rpl:react-to-all runner)
    (let ((base:*asker* "the prompt")) (rpl:evaporate task))
    (let ((base:*asker* "running plans")) (rpl:react-to-all runner))
    (is-true (has-words-p (why-text task runner) "evaporated, because the prompt ended it"))))

;;; Valves.

(test valves.are-told-of-once-and-on-a-line
  (let* ((form '(let ((valve (rpl:make-valve (format nil "two~%lines"))))
                  (rpl:par (rpl:with-valve (valve) (rpl:wait-time 5))
                           (rpl:with-valve (valve) (rpl:wait-time 5)))))
         (task (seen-at 0 form)))
    (is (= 1 (count-of "valve \"two lines" (described (part task 0)))))
    (is (= 3 (length (lines-of (tree-text task)))))))

;;; Pictures.

(test timeline.marks-failures-that-are-handled-where-they-happen
  (let ((runner (seen-until 3 :plan (rpl:make-plan
                                     '(rpl:seq (rpl:handle-failure ((:slip () nil))
                                                 (rpl:wait-time 1)
                                                 (rpl:fail :class :slip))
                                               (rpl:wait-time 1))))))
    (is (equal '((1 1 "Plan failure :SLIP"))
               (span-list (first (rpl:bars (rpl:plan-trace runner))) :failure)))
    (is (search "failed at tick 1: Plan failure :SLIP" (timeline-text runner)))))
