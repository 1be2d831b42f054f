;;;; rpl-seeing-truth.lisp -- what is seen of plans is so, and can be read.

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
                  (let* ((x a) (x (+ x 10)) (x (list x)) (a 3))
                    (rpl:wait-time 9)
                    (list a b x))))
         (task (seen-at 0 form)))
    (is (equal '((x (11)) (a 3) (b 2)) (rpl:task-variables task)))
    (is (= 1 (count-of "x = (11)" (tree-text task t))))
    (is (search "a = 3" (tree-text task t)))
    (is (null (search "a = 1" (tree-text task t))))
    (is (search "b = 2" (tree-text task t)))
    (is (null (search "x = 1" (tree-text task t))))))

(test task-variables.of-a-let*-that-waits-are-those-bound-so-far
  (is (equal '((x 1)) (rpl:task-variables
                       (seen-at 0 '(let* ((x 1) (x (rpl:seq (rpl:wait-time 9) x))) (list x)))))))

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
