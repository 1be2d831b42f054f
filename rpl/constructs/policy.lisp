;;;; policy.lisp -- with-policy: a part of a plan that watches over another.

(in-package :ars-magna.rpl.constructs)

;;; The policy is part 0 and starts first, one level above the rest: whenever it is ready, the body
;;; gives way to it before its next step.

(defun tests-once-p (policy scope)
  "True if POLICY, plan text, only tests a condition once, and then fails or ends without a wait."
  (and (consp policy)
       (operator-in-p policy '("IF" "WHEN" "UNLESS" "COND"))
       (find-call #'fail-p (list policy))
       (not (suspends-p (subst-if nil #'fail-p policy) scope))))

(defun waiting-policy-form (policy)
  (and (operator-in-p policy '("IF" "WHEN"))
       (or (operator-in-p policy '("WHEN")) (null (cdddr policy)))
       `(seq (wait-until ,(second policy)) ,@(cddr policy))))

(defun only-waits-p (policy scope)
  (and (consp policy)
       (operator-in-p policy '("WAIT-FOR" "WAIT-UNTIL"))
       (not (suspends-p (second policy) scope))))

(defparameter *constructs-left-by-return*
  '("LOOP" "DO" "DO*" "DOTIMES" "DOLIST" "N-TIMES" "BLOCK" "PROG" "PROG*" "WHENEVER" "PAR-LOOP"
    "HANDLE-FAILURE" "WITH-FAILURE-HANDLING")
  "Names of operators that end when a form in their body is (return value).")

(defun lost-return-form (policy)
  "Return the (return value) that ends POLICY, a WHENEVER, and whose value is lost; or NIL."
  (and (operator-in-p policy '("WHENEVER"))
       (null (find-call (lambda (form) (operator-in-p form *constructs-left-by-return*))
                        (cddr policy)))
       (find-call (lambda (form)
                    (and (operator-in-p form '("RETURN"))
                         (not (member (second form) '(nil t)))))
                  (cddr policy))))

(defun warn-of-policy-mistake (policy form scope)
  "Warn if FORM's POLICY in SCOPE waits for nothing, does nothing after a wait or returns a value."
  (let ((once-p (tests-once-p policy scope)))
    (cond ((or once-p (not (suspends-p policy scope)))
           (style-warn-of-plan-text form
                                    "the policy ~S waits for nothing: it runs once, before the ~
                                     body, and then ends. ~:[Write (whenever test form...), or ~
                                     (seq (wait-for fluent) form...)~;Write ~:*~S~]."
                                    policy (and once-p (waiting-policy-form policy))))
          ((only-waits-p policy scope)
           (style-warn-of-plan-text form "the policy ~S does nothing after its wait, so it has no ~
                                    effect. Write what the policy must do: (seq ~:*~S form...), or ~
                                          (whenever fluent form...) to react each time."
                                    policy))
          ((lost-return-form policy)
           (style-warn-of-plan-text form
                                    "~S ends only the policy, and its value is lost; the body goes ~
                                     on. (fail ...) in the policy ends the whole form; (pursue ~
                                     (seq (wait-for fluent) value) form...) returns the value of ~
                                     the form that ends first."
                                    (lost-return-form policy))))))

(defun looks-like-policy-p (policy)
  (find-call (lambda (form)
               (or (fail-p form)
                   (operator-in-p form '("WHENEVER" "AT-LOCATION" "LOOP"))
                   (may-return-p form)))
             (list policy)))

(defun waits-then-fails-p (body)
  (let ((forms (if (and (null (rest body)) (operator-in-p (first body) '("SEQ" "PROGN")))
                   (rest (first body))
                   body)))
    (and (operator-in-p (first forms) '("WAIT-FOR" "WAIT-UNTIL"))
         (operator-in-p (first (last forms)) '("FAIL")))))

(defun warn-of-swapped-policy (policy body form)
  "Warn if POLICY and BODY of FORM have probably been swapped. This is so if BODY is a WHENEVER that
never ends and POLICY is a list of steps, or if BODY only waits and then fails, as policies do."
  (let ((endless-p (and (null (rest body)) (endless-whenever-p (first body)))))
    (when (and (not (looks-like-policy-p policy))
               (if endless-p
                   (or (operator-in-p policy '("SEQ" "PROGN"))
                       (find-call #'fail-p (first body)))
                   (waits-then-fails-p body)))
      (style-warn-of-plan-text form
                               "the body ~S ~:[waits, and then fails~;never ends~], and ~S runs ~
                                once, in parallel. Write the policy before the body: (with-policy ~
                                ~:[(seq (wait-for ...) (fail ...))~;(whenever ...)~] form...)."
                               (if (rest body) (cons 'seq body) (first body))
                               endless-p policy endless-p))))

(define-construct with-policy (policy &body body)
  "Run BODY in a plan while POLICY, a form, runs in parallel. POLICY starts first and takes
precedence. POLICY evaporates when BODY ends. If POLICY or BODY fails, WITH-POLICY fails. Return the
first value of BODY (manual D.4; reading 186)."
  (:manual)
  (:parts (policy node (progn (warn-of-policy-mistake policy form scope)
                             (warn-of-swapped-policy policy body form)
                             (plan-code policy (single-value-scope scope))))
          (body node (body-code body (single-value-scope scope))))
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
       (end-with-value task (and (eq how :succeeded) result))))))
