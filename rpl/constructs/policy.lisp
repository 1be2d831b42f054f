;;;; policy.lisp -- with-policy: one part of a plan watching over another.

(in-package :ars-magna.rpl.constructs)

;;; The policy is part 0 and starts first, one level above the rest: whenever it is ready, the body
;;; gives way to it before its next step.

(defun bare-test-p (policy)
  "True if POLICY, plan text, is (when test (fail ...)), which tests once."
  (and (typep policy '(cons symbol (cons t (cons (cons (member fail)) null))))
       (member (first policy) '(if when) :test #'same-name-p)))

(defun doubt-policy (policy form scope)
  "Warn if POLICY, of FORM in SCOPE, waits for nothing, and so has ended before anything happens."
  (when (or (bare-test-p policy) (not (suspends-p policy scope)))
    (doubt-own-form form "the policy ~S waits for nothing: it is done once, before the rest, and ~
                          then has ended. ~:[Write (whenever test form...), or (seq (wait-for ~
                          fluent) form...)~;Write ~:*~S~]."
                    policy (and (bare-test-p policy)
                                `(seq (wait-until ,(second policy)) ,@(cddr policy))))))

(define-construct with-policy (policy &body body)
  "Run BODY in a plan under POLICY, a form that runs beside it, starts before it and takes
precedence over it. The end of BODY ends POLICY; if one of them fails, all fails. Return BODY's
value, one as of every task (manual D.4; reading 186)."
  (:manual)
  (:parts (policy node (progn (doubt-policy policy form scope)
                             (plan-code policy (single-scope scope))))
          (body node (body-code body (single-scope scope))))
  (:steps
   (begin
    (next inside)
    (let ((level (task-level task)))
      (start-branch policy task environment 0 (1+ level))
      (start-branch body task environment 1 level))
    (await-parts task))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (when (= 1 (task-index child))
       (complete task (and (eq how :succeeded) result))))))
