;;;; policy.lisp -- with-policy and with-task-blocked: one part of a plan watching over another.

(in-package :ars-magna.rpl.constructs)

;;; The policy is part 0 and starts first, one level above the rest: whenever it is ready, the body
;;; gives way to it before its next step.

(define-node policed ((policy node) (body node))
  "BODY while POLICY holds."
  :step step-policed :child-ended policed-part-over)

(defun step-policed (node task frame value)
  (cond ((plusp (frame-counter frame)) (values (frame-up frame) value))
        (t (setf (frame-counter frame) 1)
           (let ((environment (frame-environment frame))
                 (level (task-level task)))
             (start-branch (policed-policy node) task environment 0 (1+ level))
             (start-branch (policed-body node) task environment 1 level))
           (park task nil)
           +parked+)))

;; As reading 186 says.
(defun policed-part-over (node task frame child how result)
  (declare (ignore node frame))
  (unless (fail-or-escape task how result)
    (when (= 1 (task-index child))
      (complete task (and (eq how :succeeded) result)))))

(public with-policy)
(defmacro with-policy (policy &body body)
  "Run BODY in a plan under POLICY, a form that runs beside it, starts before it and takes
precedence over it. The end of BODY ends POLICY; if one of them fails, all fails. Return BODY's
value (manual D.4)."
  (misplaced 'with-policy (list* policy body)))

(define-plan-form "WITH-POLICY" :must (policy &rest body) (form scope)
  (let ((single (single-scope scope)))
    `(make-policed :form ',form
                   :policy ,(plan-code policy single)
                   :body ,(body-code body single))))
