;;;; branching.lisp -- sequences and choices: seq, progn, if, cond, case, and, or.

(in-package :ars-magna.rpl.language)

(export '(binding-body-code body-code steps steps-parts))

(declaim (inline enter-tail))
(defun enter-tail (node environment frame)
  (let ((up (frame-up frame)))
    (if (leaf-p node)
        (values up (call-leaf node environment))
        (values (make-frame node environment up) nil))))

(define-expression steps
  "Runs one or more expressions in order. The frame's counter says how many have begun."
  (:hot)
  (:parts (parts simple-vector))
  (:step
   (let ((parts parts)
         (i (frame-counter frame)))
     (setf (frame-counter frame) (1+ i))
     (if (< (1+ i) (length parts))
         (enter (the node (svref parts i)) environment frame)
         (enter-tail (the node (svref parts i)) environment frame)))))

(setf (documentation 'steps-parts 'function)
      "Return the vector of the nodes that a node of type STEPS runs one after the other.")

(defmethod current-form ((node steps) frame)
  (let ((i (frame-counter frame)))
    (if (plusp i)
        (node-form (svref (steps-parts node) (1- i)))
        (node-form node))))

(defun steps-code (forms scope)
  (let ((single (single-value-scope scope)))
    (node-naming-code `(make-steps :form '(seq ,@forms)
                                   :parts (vector ,@(loop for (form . more) on forms
                                                          for inner = (if more single scope)
                                                          collect (plan-code form inner))))
                      scope)))

(defun body-code (forms scope)
  "Return code for FORMS as the steps of a body. The last form gives the values of the body."
  (cond
    ((null forms) '+nothing+)
    ((null (rest forms)) (plan-code (first forms) scope))
    ;; Mistakes in the forms themselves are reported first.
    (t (prog1 (steps-code forms scope)
         (check-after-whenever forms)))))

(defun binding-body-code (forms scope)
  "Return code for FORMS, a body that may start with declarations. Declarations are ignored."
  (body-code (remove-if #'declaration-p forms) scope))

(defun declaration-p (form)
  (and (consp form) (eq (first form) 'declare)))

(defun variables-declared-special (variables forms)
  (loop for form in forms
        when (declaration-p form)
          append (loop for (kind . names) in (rest form)
                       when (eq kind 'special) append (intersection names variables))))

;;; The forms.

(define-construct seq (&body steps)
  "Run STEPS in order and return the value of the last step. SEQ fails as soon as one step fails.
Policies can run between steps. In ordinary Lisp, SEQ is PROGN (manual D.2)."
  (:manual)
  (:waits :may)
  (:in-lisp `(progn ,@steps))
  (:code (body-code steps scope)))

(define-plan-form "PROGN" nil (&rest steps) (form scope)
  (body-code steps scope))

(define-plan-form "LOCALLY" nil (&rest steps) (form scope)
  (if (variables-declared-special (scope-variables scope) steps)
      (leaf-code-or-reject form scope)
      (binding-body-code steps scope)))

(define-plan-form "THE" nil (type part) (form scope)
  (declare (ignore type))
  (plan-code part scope))

(define-plan-form "SETQ" nil (&rest pairs) (form scope)
  (if (cddr pairs)
      (body-code (loop for (variable value) on pairs by #'cddr
                       collect (note-plan-text `(setq ,variable ,value)))
                 scope)
      (code-with-hoisted-parts form scope 2)))

;;;; Choices

(define-expression branch
  "Runs the one of BRANCHES whose index the function CHOOSER returns; runs nothing for NIL."
  (:parts (chooser function) (branches simple-vector))
  (:step
   (let ((index (funcall chooser environment)))
     (if index
         (enter-tail (the node (svref branches index)) environment frame)
         (values (frame-up frame) nil)))))

(defun choice-code (form test then else scope)
  (if (suspends-p test scope)
      (with-gensyms (value)
        (plan-code (note-expansion `(let ((,value ,test))
                                      (if ,value (progn ,@then) (progn ,@else)))
                                   form)
                   scope))
      `(make-branch :form ',(form-as-written form)
                    :chooser ,(value-lambda
                               `(if ,(condition-form test (scope-environment scope)) 0 1) scope)
                    :branches (vector ,(body-code then scope) ,(body-code else scope)))))

(define-plan-form "IF" nil (test then &rest else) (form scope)
  (choice-code form test (list then) else scope))

(define-plan-form "WHEN" nil (test &rest body) (form scope)
  (choice-code form test body '() scope))

(define-plan-form "UNLESS" nil (test &rest body) (form scope)
  (choice-code form test '() body scope))

(define-plan-form "COND" nil (&rest clauses) (form scope)
  (if (null clauses)
      (leaf-code nil scope)
      (destructuring-bind ((test . body) . more) clauses
        (let ((more (note-plan-text `(cond ,@more))))
          (if body
              (choice-code form test body (list more) scope)
              (plan-code (note-plan-text `(or ,test ,more)) scope))))))

(defun case-code (form operator key clauses scope)
  (with-hoisted-arguments (key) form scope
    `(make-branch :form ',(form-as-written form)
                  :chooser ,(value-lambda `(,operator (operand-value ,key)
                                                      ,@(loop for (keys) in clauses
                                                              for index from 0
                                                              collect (list keys index)))
                                          scope)
                  :branches (vector ,@(loop for (nil . body) in clauses
                                            collect (body-code body scope))))))

(define-plan-form "CASE" nil (key &rest clauses) (form scope)
  (case-code form 'case key clauses scope))

(define-plan-form "ECASE" nil (key &rest clauses) (form scope)
  (case-code form 'ecase key clauses scope))

(define-plan-form "CCASE" nil (key &rest clauses) (form scope)
  (case-code form 'ecase key clauses scope))

(define-plan-form "AND" nil (&rest forms) (form scope)
  (if (rest forms)
      (choice-code form (first forms) (list (note-plan-text `(and ,@(rest forms)))) '() scope)
      (plan-code (if forms (first forms) t) scope)))

(define-plan-form "OR" nil (&rest forms) (form scope)
  (if (rest forms)
      (with-gensyms (value)
        (plan-code (note-expansion `(let ((,value ,(first forms)))
                                      (if ,value ,value ,(note-plan-text `(or ,@(rest forms)))))
                                   form)
                   scope))
      (plan-code (first forms) scope)))
