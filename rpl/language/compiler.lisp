;;;; compiler.lisp -- from a plan's text to code that builds its nodes: leaves, and what may wait.

(in-package :ars-magna.rpl.language)

(export '(condition-lambda awaited-lambda value-lambda define-plan-form code-with-hoisted-parts
                           plan-code set-node-names
          leaf-code-or-reject suspends-p))

;;; Where the plan's own text says so, conditions read fluents by value and operators are lifted.
;;; What is written for a truth value must not be a vector of fluents.

(defun plan-operator-call-p (form environment names)
  (and (consp form)
       (plan-text-p form)
       (operator-in-p form names)
       (not (local-function-p (first form) environment))))

(defun operand-form (form environment)
  "Return a form for the value of FORM, an argument of a lifted operator in a condition."
  (cond ((plan-operator-call-p form environment '("AND" "OR" "NOT" "NULL"))
         (condition-form form environment))
        ((plan-operator-call-p form environment *lifted-operators*)
         (list* (first form)
                (loop for argument in (rest form) collect (operand-form argument environment))))
        ((constantp form environment) form)
        (t `(operand-value ,form))))

(defun condition-form (form environment)
  "Return a form that is true if FORM is true. A fluent in FORM counts as its value."
  (flet ((conditions (operator)
           (copy-source-location `(,operator ,@(loop for form in (rest form)
                                                     collect (condition-form form environment)))
                                 form)))
    (reject-vector-condition form)
    (cond ((plan-operator-call-p form environment '("AND")) (conditions 'and))
          ((plan-operator-call-p form environment '("OR")) (conditions 'or))
          ((plan-operator-call-p form environment '("NOT" "NULL")) (conditions 'not))
          ((plan-operator-call-p form environment *lifted-operators*)
           (copy-source-location (operand-form form environment) form))
          ((constantp form environment) form)
          (t (copy-source-location `(truth-value ,form) form)))))

(defun plan-meaning (form environment)
  "Return a Lisp form that means what the call FORM means in a plan; this may be FORM itself."
  (let ((name (or (plan-operator-name form) "")))
    (when (member name '("AND" "OR" "NOT" "NULL") :test #'string=)
      (mapc #'reject-vector-condition (rest form)))
    (flet ((condition (form) (condition-form form environment))
           (is (&rest names) (member name names :test #'string=)))
      (cond ((is "IF") `(if ,(condition (second form)) ,@(cddr form)))
            ((is "WHEN") `(when ,(condition (second form)) ,@(cddr form)))
            ((is "UNLESS") `(unless ,(condition (second form)) ,@(cddr form)))
            ((is "COND") `(cond ,@(loop for (test . body) in (rest form)
                                        collect `(,(condition test) ,@body))))
            ((is "CASE" "ECASE") `(,(first form) (operand-value ,(second form)) ,@(cddr form)))
            ((is "CCASE") (ccase-meaning form))
            ((is "LET" "LET*") (let-meaning form))
            ((is "AND") `(lifted:and ,@(rest form)))
            ((is "OR") `(lifted:or ,@(rest form)))
            ((is "LOOP") (if (plan-loop-p form)
                             (loop-meaning (rest form) environment)
                             (extended-loop-meaning form environment)))
            ((operator-in-p form *lifted-operators*) `(call-lifted ,@form))
            (t form)))))

(defun ccase-meaning (form)
  "Return a Lisp form for FORM, a CCASE in a plan. A new key goes to a variable, not to the fluent."
  (with-gensyms (key)
    `(let ((,key (operand-value ,(second form))))
       (,(first form) ,key ,@(cddr form)))))

(defun let-meaning (form)
  "Return FORM, a LET, without the types of its variables; without types, return FORM itself."
  (if (and (listp (second form)) (find '- (second form)))
      `(,(first form) ,(untyped-bindings (second form)) ,@(cddr form))
      form))

(defun loop-meaning (forms environment)
  (let ((end (cond ((starts-with-test-p forms "UNTIL") 'when)
                   ((starts-with-test-p forms "WHILE") 'unless))))
    (if end
        `(loop (,end ,(condition-form (second forms) environment) (return)) ,@(cddr forms))
        `(loop ,@forms))))

(defparameter *loop-test-keywords*
  '("WHILE" "UNTIL" "WHEN" "IF" "UNLESS" "ALWAYS" "NEVER" "THEREIS")
  "The keywords of LOOP that stand before a test.")

(defun extended-loop-meaning (form environment)
  "Return FORM, an extended LOOP of Lisp, with tests that use the values of fluents."
  (let ((last nil) (test-p nil))
    (flet ((word-p (word words) (and (symbolp word) (member word words :test #'string=))))
      (cons (first form)
            (loop for part in (rest form)
                  collect (if (shiftf test-p (and (word-p part *loop-test-keywords*)
                                                  (not (word-p last '("FOR" "AS" "WITH" "INTO")))))
                              (condition-form part environment)
                              part)
                  do (setf last part))))))

(defvar *noted-assignments* '()
  "The forms in the current leaf whose assignments are noted when they run.")

(defun noting-form (form environment)
  "If FORM assigns users' global variables, return a form that also notes that; else NIL."
  (when (and (consp form)
             (eq 'setq (first form))
             (not (member form *noted-assignments* :test #'eq)))
    (let ((names (loop for (name) on (rest form) by #'cddr
                       when (users-global-p name environment) collect name)))
      (when names
        (push form *noted-assignments*)
        `(progn ,@(loop for name in names collect `(note-assignment ',name)) ,form)))))

(defun leaf-meaning (form environment)
  (cond ((noting-form form environment))
        ((global-symbol-macro-p form environment)
         (note-plan-text (macroexpand-1 form environment)))
        ((not (and (consp form) (symbolp (first form)) (plan-text-p form))) form)
        ((plan-making-form-p form) (values form t))
        ((represented-construct form) (reject-in-lisp (represented-construct form)))
        (t (check-fluent-increment form environment)
           (check-assignments form environment)
           (check-fluent-arguments form environment)
           (warn-of-namesake form)
           (let ((meaning (if (local-function-p (first form) environment)
                              form
                              (plan-meaning form environment))))
             (if (and (eq meaning form)
                      (macro-function (first form) environment)
                      (not (lisp-symbol-p (first form))))
                 (note-plan-text (expand-in-walk form environment))
                 meaning)))))

(defun as-lisp (form scope)
  (cond ((and (atom form) (not (symbol-macro-p form (scope-environment scope)))) form)
        (t (warn-of-leaf-mistakes form)
           (let ((*fluents-here* (scope-fluents scope)) (*noted-assignments* '()))
             (walk-form form (scope-environment scope) #'leaf-meaning)))))

(defun condition-lambda (form scope)
  "Return a lambda expression that takes an environment and returns the fluent or value of FORM."
  (reject-vector-condition form)
  (leaf-lambda `(checked-condition ,(as-lisp form scope)) scope))

(defun awaited-lambda (condition form scope)
  "Do as CONDITION-LAMBDA, and warn of mistakes in CONDITION. FORM waits for CONDITION."
  (check-awaited condition form scope)
  (condition-lambda condition scope))

(defun value-lambda (form scope)
  "Return a lambda expression that takes an environment and returns the first value of FORM."
  (leaf-lambda (as-lisp form scope) scope))

(defun bundle-several-values (&optional value &rest more)
  (if more (make-bundle (cons value more)) value))

(defun leaf-code (form scope)
  (let ((meaning (as-lisp form scope)))
    `(make-leaf :form ',(form-as-written form)
                :function ,(leaf-lambda (if (and (scope-several scope) (consp form))
                                            `(multiple-value-call #'bundle-several-values ,meaning)
                                            meaning)
                                        scope))))

;;; Functions named X-CODE return a form that builds nodes. It is run when the plan is loaded.

(defun destructuring-variables (lambda-list)
  "Return a list of the variables of LAMBDA-LIST, a destructuring lambda list without defaults."
  (cond ((null lambda-list) '())
        ((atom lambda-list)
         (unless (member lambda-list lambda-list-keywords) (list lambda-list)))
        (t (append (destructuring-variables (car lambda-list))
                   (destructuring-variables (cdr lambda-list))))))

(defmacro define-plan-form (name suspends lambda-list (form scope) &body body)
  "Define the meaning in plans of the operator with the name NAME, a string or a symbol. BODY
returns the code for FORM in SCOPE; the variables of LAMBDA-LIST are bound to the arguments of FORM.
SUSPENDS says whether the operator makes a task wait: see SUSPENSION."
  (let ((names (destructuring-variables lambda-list)))
    (with-gensyms (fits values)
      `(setf (gethash (plan-form-key ',name) *plan-forms*)
             (make-plan-form
              ,(string name) ,suspends
              (lambda (,form ,scope)
                (declare (ignorable ,scope))
                (multiple-value-bind (,fits ,values)
                    (ignore-errors
                     (values t (destructuring-bind ,lambda-list (rest ,form) (list ,@names))))
                  (unless ,fits (reject-shape ,form ',lambda-list))
                  (destructuring-bind ,names ,values
                    (declare (ignorable ,@names))
                    ,@body))))))))

(defun reject-shape (form lambda-list)
  (let ((*print-case* :downcase))
    (reject-clause (text-title) form
                   (format nil "(~A~{ ~A~})~@[, not ~A~]" (operator-text form) lambda-list
                           (argument-mistake-text form lambda-list)))))

(defun leaf-code-or-reject (form scope &optional (container form))
  "Return code for FORM as a leaf. Signal MISPLACED-SUSPENSION if FORM, in CONTAINER, would wait."
  (multiple-value-bind (suspends reason) (suspension form scope)
    (if (eq suspends :must)
        (reject-suspension reason container)
        (leaf-code form scope))))

(defun suspends-p (form scope)
  "True if FORM in SCOPE makes its task wait, or may make it wait."
  (and (or (consp form) (symbol-macro-p form (scope-environment scope)))
       (suspension form scope)))

(defun binds-fluents-p (form scope)
  "True if FORM, in plan text, is a LET that binds fluents. Leaves do not record such bindings."
  (and (consp form)
       (plan-text-p form)
       (operator-in-p form '("LET" "LET*"))
       (proper-list-p (second form))
       (variables-bound-to-fluents (second form) (cddr form) scope (operator-in-p form '("LET*")))))

;;; An expression of which a part that Lisp is to use makes the task wait.

(defun code-with-hoisted-parts (form scope &optional (fixed 1))
  "Return code for FORM, whose first FIXED elements stay in place. Other elements that suspend are
bound to variables before FORM. So are all elements to their left, to keep the order of evaluation."
  (let* ((parts (nthcdr fixed form))
         (count (1+ (position-if (lambda (part) (suspends-p part scope)) parts :from-end t)))
         (names (loop for part in (subseq parts 0 count)
                      collect (if (constantp part) nil (gensym "PART")))))
    (plan-code (note-expansion
                `(let ,(loop for name in names
                             for part in parts
                             when name collect (list name part))
                   (,@(subseq form 0 fixed)
                    ,@(loop for name in names
                            for part in parts
                            collect (or name part))
                    ,@(nthcdr count parts)))
                form)
               scope)))

(defun ordinary-call-code (form scope)
  "Return code for FORM, a call of an operator without a special meaning in plans."
  (cond ((some (lambda (argument) (suspends-p argument scope)) (rest form))
         (code-with-hoisted-parts form scope))
        ((call-suspension form scope (scope-environment scope)) (call-code form scope))
        (t (leaf-code form scope))))

(defun plan-code (form scope)
  "Return code that builds the node for FORM."
  (let ((*current-source-form* (if (has-source-location-p form) form *current-source-form*)))
    (copy-source-location (if (or (suspends-p form scope) (binds-fluents-p form scope))
                    (node-naming-code (waiting-code form scope) scope)
                    (leaf-code form scope))
                form)))

(defun node-naming-code (code scope)
  "Return CODE, extended so that its node has the names of the variables in SCOPE."
  (let ((names (names-by-level scope)))
    (if (some #'identity names)
        `(set-node-names ,code ',names)
        code)))

(defun set-node-names (node names)
  "Let NODE, unless it is a leaf, have NAMES: see NODE-NAMES. Return NODE."
  (unless (leaf-p node)
    (setf (node-names node) names))
  node)

(defun waiting-code (form scope)
  (let* ((environment (scope-environment scope))
         (plan-form (find-plan-form form environment)))
    (cond ((symbolp form) (expansion-code form scope))
          ((represented-construct form) (plan-code (represented-construct form) scope))
          (plan-form (funcall (plan-form-compiler plan-form) form scope))
          ((not (symbolp (first form))) (leaf-code-or-reject form scope))
          ((assoc (first form) (scope-procedures scope)) (ordinary-call-code form scope))
          ((local-function-p (first form) environment)
           (if (macro-function (first form) environment)
               (expansion-code form scope)
               (ordinary-call-code form scope)))
          ((advice-for-form form) (leaf-code-or-reject form scope))
          ((macro-function (first form) environment) (expansion-code form scope))
          ((special-operator-p (first form)) (leaf-code-or-reject form scope))
          ((operator-in-p form *waking-functions*)
           (if (some (lambda (argument) (suspends-p argument scope)) (rest form))
               (code-with-hoisted-parts form scope)
               (leaf-code form scope)))
          (t (ordinary-call-code form scope)))))

(defun expansion-code (form scope)
  (let ((expansion (macroexpand-1 form (scope-environment scope))))
    (if (and (consp form) (lisp-symbol-p (first form)))
        (note-written-as expansion form)
        (note-plan-text expansion))
    (plan-code expansion scope)))
