;;;; named-policies.lisp -- named policies: initialization, check, recovery, cleanup.

(in-package :ars-magna.rpl.constructs)

;;; The clauses of a policy are plans without a name. Their first parameter is the policy's use,
;;; which keeps what clauses share while it is in force; then come the policy's own parameters.

(addition policy-p)
(define-record (policy (:constructor %make-policy (name lambda-list init check recover clean-up)))
  "A policy: a condition that must hold while part of a plan runs, and reactions if it does not."
  (name nil symbol
        "the name of the policy, a symbol; NIL if MAKE-POLICY made the policy" :writable :addition)
  (lambda-list '() list "the lambda list of the policy's clauses" :writable :addition)
  (init nil (or null procedure) :writable)
  (check nil (or null procedure) :writable)
  (recover nil (or null procedure) :writable)
  (clean-up nil (or null procedure) :writable))

(defmethod print-object ((policy policy) stream)
  (print-unreadable-object (policy stream)
    (format stream "policy ~:[without a name~;~:*~A~] ~:A" (policy-name policy)
            (policy-lambda-list policy))))

(define-registry policy "policy" :object-p policy-p :by-symbol t :plans t
  :lister all-policies)

(addition policy-failure)
(define-condition policy-failure (plan-failure)
  ((policy :initarg :policy :initform nil :reader failed-policy))
  (:documentation "A named policy failed because its condition does not hold."))

(addition policy-init-failed)
(define-condition policy-init-failed (policy-failure)
  ()
  (:documentation "The :INIT of a named policy returned false: the body did not run (CRAM)."))

(addition policy-check-condition-met)
(define-condition policy-check-condition-met (policy-failure)
  ()
  (:documentation "The :CHECK of a named policy became true while its body ran (from CRAM)."))

(addition failed-policy)
(setf (documentation 'failed-policy 'function) "Return the named policy that failed.")

(defmethod write-failure ((failure policy-init-failed) stream)
  (format stream "~A did not begin, because its :init returned NIL and not a true value such as T"
          (failed-policy failure)))

(defmethod write-failure ((failure policy-check-condition-met) stream)
  (format stream "The :check of ~A became true" (failed-policy failure)))

;;; A use.

(defstruct (policy-use (:constructor make-policy-use (policy arguments)) (:copier nil)
                       (:conc-name use-))
  "A use of POLICY with ARGUMENTS, while a body runs under it. MEMORY is a property list."
  (policy nil :type policy :read-only t)
  (arguments '() :type list :read-only t)
  (memory '() :type list))

(defun new-policy-use (policy arguments)
  "Return a new use of POLICY, a policy or its name, with ARGUMENTS, or signal WRONG-ARGUMENT."
  (let* ((policy (find-policy policy))
         (parameters (policy-lambda-list policy))
         (trouble (arguments-misfit-text (lambda-list-shape parameters) arguments :wrong-p
                                         (constantly t))))
    (when trouble
      (reject-argument (or (policy-name policy) 'make-policy) "argument list" arguments
                       (format nil "~A, not ~A" (lambda-list-text parameters) trouble)))
    (make-policy-use policy arguments)))

(defun stored-policy-value (use name) (getf (use-memory use) name))

(defun store-policy-value (use name value)
  (setf (getf (use-memory use) name) value))

(define-global +use-variable+ (make-symbol "USE")
  "The variable in which each clause of a policy finds the current use of the policy.")

(defun check-inside-policy-clause (form environment)
  (unless (local-variable-p +use-variable+ environment)
    (reject-clause (text-title) form
                   (format nil "~(~A~) only in a clause of define-policy or make-policy, and not ~
                                inside another interp-lambda in the clause"
                           (first form)))))

(addition policy-get)
(defmacro policy-get (&whole form name &environment environment)
  "Return the value last stored under NAME by POLICY-SETF, or NIL. For use in a clause of a policy.
NAME is evaluated. The value is kept while the policy is in force (from CRAM)."
  (check-inside-policy-clause form environment)
  `(stored-policy-value ,+use-variable+ ,name))

(addition policy-setf)
(defmacro policy-setf (&whole form name value &environment environment)
  "Store VALUE under NAME for the other clauses of the policy, and return VALUE. For use in a
clause. VALUE and NAME are evaluated. The value is kept while the policy is in force (from CRAM)."
  (check-inside-policy-clause form environment)
  `(store-policy-value ,+use-variable+ ,name ,value))

;;; Defining.

(defun check-policy-clauses (definition clauses)
  (dolist (clause clauses)
    (unless (and (consp clause) (member (first clause) '(:init :check :recover :clean-up)))
      (reject-clause definition clause
                     "a list that starts with :init, :check, :recover or :clean-up")))
  (loop for (clause . more) on clauses
        when (assoc (first clause) more)
          do (reject-clause definition clause "each kind of clause once")))

(defun clause-code (kind parameters clauses environment)
  "Return code for the plan of the KIND clause in CLAUSES; NIL if CLAUSES have no KIND clause. A
missing :INIT counts as (:init t), because the plan of :INIT checks the arguments."
  (let ((clause (or (assoc kind clauses) (and (eq kind :init) '(:init t)))))
    (and clause
         (macroexpand-1 `(interp-lambda (,+use-variable+ ,@parameters) ,@(rest clause))
                        environment))))

(defun first-arguments-in (operator form)
  "Return the first arguments of all calls of OPERATOR, POLICY-GET or POLICY-SETF, in FORM."
  (when (consp form)
    (append (and (eq operator (first form)) (consp (rest form)) (list (second form)))
            (loop for rest = form then (cdr rest)
                  while (consp rest) append (first-arguments-in operator (car rest))))))

(defun warn-of-unstored-names (definition clauses)
  (let ((kept (first-arguments-in 'policy-setf clauses)))
    (when (every #'constantp kept)
      (dolist (name (set-difference (first-arguments-in 'policy-get clauses) kept :test #'equal))
        (when (constantp name)
          (warn-of-style "~A: (policy-get ~(~S~)) returns NIL, because no clause stores it.~
                          ~@[ Stored: ~{~(~S~)~^, ~}.~]"
                            definition name kept))))))

(defun policy-code (definition name parameters clauses environment)
  (check-policy-clauses definition clauses)
  (warn-of-unstored-names definition clauses)
  (let ((parameters (untyped-parameters parameters parameters environment definition)))
    `(%make-policy ',name ',parameters
                   ,@(loop for kind in '(:init :check :recover :clean-up)
                           collect (clause-code kind parameters clauses environment)))))

(addition define-policy)
(define-user-macro define-policy (&whole form name (&rest parameters) &body clauses
                                  &environment environment)
  "Define NAME as a policy with PARAMETERS, an ordinary lambda list. The special variable NAME holds
the policy. The clauses, after an optional documentation string, are plan text: they may wait.
  (:init form...)      runs first. If :INIT returns false, the policy fails with POLICY-INIT-FAILED.
  (:check form...)     is the condition that must not become true. It is watched as by WAIT-UNTIL,
                       before each step of the body. A fluent or network is waited for; any other
                       form is tested at each tick.
  (:recover form...)   runs when the check has become true and the body has evaporated. Then the
                       policy fails with POLICY-CHECK-CONDITION-MET.
  (:clean-up form...)  runs last, even if :INIT fails, but not if :INIT returned false.
The clauses share values by POLICY-GET and POLICY-SETF. See WITH-NAMED-POLICY. Return NAME. Signals
MALFORMED-DEFINITION. (From CRAM, where the check is polled.)"
  (let ((definition (definition-title "define-policy" name))
        (text (and (stringp (first clauses)) (pop clauses))))
    (expand-definition
     form environment
     (lambda ()
       (unless (and name (symbolp name) (not (keywordp name)))
         (reject-clause definition name "a symbol that is no keyword, as the name"))
       (values `((register *policys* ',name
                           ,(policy-code definition name parameters clauses environment)
                           :variable t)
                 ,@(when text `((setf (documentation ',name 'variable) ,text))))
               (defvar-forms name))))))

(addition make-policy)
(define-user-macro make-policy ((&rest parameters) &body clauses &environment environment)
  "Return a policy without a name. PARAMETERS and CLAUSES are as for DEFINE-POLICY. The clauses see
the variables around MAKE-POLICY. (From CRAM, where MAKE-POLICY takes a name.)"
  (policy-code "make-policy" nil parameters clauses environment))

;;; Being in force.

(defun named-policy-form (policy arguments body)
  "Return plan text that runs BODY while POLICY is in force with ARGUMENTS. BODY and ARGUMENTS are
lists of forms, POLICY is a form."
  (with-gensyms (use over met value refused)
    (flet ((clause (reader)
             `(if (,reader (use-policy ,use))
                  (apply-plan (,reader (use-policy ,use)) (cons ,use (use-arguments ,use))))))
      `(let ((,use (new-policy-use ,policy (list ,@arguments)))
             (,met nil) (,value nil) (,refused nil))
         (evap-protect
          (seq (if (not ,(clause 'policy-init))
                   (seq (setq ,refused t)
                        (fail 'policy-init-failed :policy (use-policy ,use))))
               (block ,over
                 (with-policy (if (policy-check (use-policy ,use))
                                  (seq (wait-until ,(clause 'policy-check))
                                       (setq ,met t)
                                       (return-from ,over nil)))
                   (setq ,value (seq ,@body))))
               (if ,met
                   (seq ,(clause 'policy-recover)
                        (fail 'policy-check-condition-met :policy (use-policy ,use))))
               ,value)
          (if (not ,refused) ,(clause 'policy-clean-up)))))))

(defun nested-policies-form (policies body form)
  (unless (proper-list-p policies)
    (reject-clause (text-title) form "(with-policies ((policy (argument...))...) form...)"))
  (dolist (policy policies)
    (unless (typep policy '(cons t (cons list null)))
      (reject-clause (text-title) policy "(policy (argument...)) for each policy")))
  (loop with text = `(seq ,@body)
        for (policy arguments) in (reverse policies)
        do (setf text (named-policy-form policy arguments (list text)))
        finally (return text)))

(defun check-argument-list-given (arguments form scope)
  (when (and (consp arguments)
             (name-without-quote-p (first arguments) scope)
             (fboundp (first arguments)))
    (reject-clause (text-title) form
                   (format nil "the list of the policy's arguments before the body, () if the ~
                                policy takes none: (with-named-policy ~(~S~) () ~(~A~) ...)"
                           (abridged (second form)) (form-text arguments 40)))))

(define-construct with-named-policy (policy arguments &body body)
  "Run BODY in a plan while POLICY, a policy or its name, is in force. ARGUMENTS is a list of forms,
whose values the policy receives. See DEFINE-POLICY. Return the first value of BODY. (From CRAM; the
policy of the manual's WITH-POLICY is plan text.)"
  (:code
   (progn
     (check-argument-list-given arguments form scope)
     (plan-code (note-expansion (nested-policies-form `((,policy ,arguments)) body form) form)
                scope))))

(define-construct with-policies (policies &body body)
  "Run BODY in a plan while POLICIES, each (policy (argument...)) as in WITH-NAMED-POLICY, are in
force. The first policy starts first and takes precedence over the others. (From CRAM.)"
  (:code (plan-code (note-expansion (nested-policies-form policies body form) form) scope)))

(define-construct with-named-policies (policies &body body)
  "Do as WITH-POLICIES. (From CRAM.)"
  (:like with-policies))
