;;;; rpl-constructs.lisp -- how constructs are defined, and their states.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; States.

(defun innermost-tasks (task)
  (if (rpl:task-children task)
      (mapcan #'innermost-tasks (rpl:task-children task))
      (list task)))

(defun frame-states (task)
  "Return the states of the frames of TASK, innermost first."
  (loop for frame = (rpl:task-frame task) then (rpl:frame-up frame)
        while frame collect (rpl:frame-state frame)))

(defun states-after-reaction (plan)
  "Return the states of the frames of the innermost tasks of PLAN when nothing is ready."
  (with-runner (runner)
    (let ((task (rpl:start-plan runner plan)))
      (rpl:react-to-all runner)
      (mapcar #'frame-states (innermost-tasks task)))))

(test states.have-names
  (let ((never (fluent)))
    (is (equal '((:waiting) (:waiting :in-turn) (:waiting :inside) (:waiting :handling)
                 (:waiting :cleaning-up) (:waiting :reacting) (:waiting) (:waiting :trying)
                 (:waiting 1 :inside))
               (states-after-reaction
                (rpl:interp-lambda ()
                  (rpl:par (rpl:wait-time 1)
                           (rpl:n-times 3 (rpl:wait-for never))
                           (rpl:handle-failure () (rpl:wait-for never))
                           (rpl:handle-failure ((t () (rpl:wait-for never))) (rpl:fail))
                           (rpl:evap-protect nil (rpl:wait-for never))
                           (rpl:whenever (not never) (rpl:wait-for never))
                           (rpl:whenever never (rpl:wait-time 1))
                           (rpl:try-in-order (rpl:fail) (rpl:wait-for never))
                           (block nil (rpl:wait-for never) (return)))))))))

(test states.are-numbers-where-parts-are-counted
  (is (equal '((:waiting 2))
             (states-after-reaction
              (rpl:interp-lambda () (rpl:seq 1 (rpl:wait-time 1) 2))))))

;;; Definitions.

(defun stub-error (form)
  "Return the error that FORM, of the plan language, is in ordinary Lisp, or NIL."
  (handler-case (prog1 nil (macroexpand form))
    (error (error) error)))

(test constructs.have-a-face-each
  (is (< 20 (length (rpl:all-constructs))))
  (dolist (name (rpl:all-constructs))
    (is (eq :external (nth-value 1 (find-symbol (symbol-name name) (symbol-package name)))))
    (is (macro-function name) "~S is no macro" name)
    (is (plusp (length (documentation name 'function))) "~S is not documented" name)))

(test constructs.are-for-plans-only
  (is (typep (stub-error '(rpl:par 1 2)) 'base:misuse))
  (is (typep (stub-error '(rpl:whenever 1 2)) 'base:misuse))
  (is (null (stub-error '(rpl:seq 1 2))))
  (is (= 2 (rpl:seq 1 2))))

(test constructs.refuse-clauses-that-they-do-not-know
  (signals base:malformed-definition
    (macroexpand-1 '(rpl:define-construct odd () "Odd." (:manuel))))
  (signals base:malformed-definition
    (macroexpand-1 '(rpl:define-expression odd "Odd." (:code 1))))
  (signals base:unknown-name
    (macroexpand-1 '(rpl:define-construct odd () "Odd." (:like no-such)))))

(test constructs.wait-for-their-arguments-from-left-to-right
  (is (equal '((:left 1) (:right 3))
             (with-log (note)
               (plan-value
                 (rpl:wait-for (rpl:seq (rpl:wait-time 1) (note :left) nil (fluent))
                               :timeout (rpl:seq (rpl:wait-time 2) (note :right) 1)))))))

(test retry.means-the-innermost-handler-around-it
  (is (equal '((:outer 0) (:inner 0) (:inner 0) (:outer 0) (:inner 0))
             (let ((inner 0) (outer 0))
               (with-log (note)
                 (plan-value
                   (rpl:handle-failure ((t () (when (< (incf outer) 2) (rpl:retry)) (return nil)))
                     (note :outer)
                     (rpl:handle-failure ((t () (when (< (incf inner) 2) (rpl:retry))))
                       (note :inner)
                       (rpl:fail)))))))))
