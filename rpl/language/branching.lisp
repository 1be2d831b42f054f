;;;; branching.lisp -- if, when, unless, cond, case, and, or, not.

(in-package :ars-magna.rpl.language)

(define-expression branch
  "The one of BRANCHES whose index CHOOSER returns; nothing if it returns NIL."
  (:parts (chooser function) (branches simple-vector))
  (:step
   (let ((index (funcall chooser environment)))
     (if index
         (enter-last (the node (svref branches index)) environment frame)
         (values (frame-up frame) nil)))))

(defun choice-code (form test then else scope)
  "Return code for a choice by TEST, whose source is FORM. THEN and ELSE are lists of forms."
  (if (suspends-p test scope)
      (with-gensyms (value)
        (plan-code (note-expansion `(let ((,value ,test))
                                      (if ,value (progn ,@then) (progn ,@else)))
                                   form)
                   scope))
      `(make-branch :form ',(form-as-written form)
                    :chooser ,(leaf-lambda
                               (as-lisp `(if ,(condition-form test (scope-environment scope)) 0 1)
                                          scope)
                               scope)
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
        (let ((more (note-own-text `(cond ,@more))))
          (if body
              (choice-code form test body (list more) scope)
              (plan-code (note-own-text `(or ,test ,more)) scope))))))

(defun case-code (form operator key clauses scope)
  (hoisting (key) form scope
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
      (choice-code form (first forms) (list (note-own-text `(and ,@(rest forms)))) '() scope)
      (plan-code (if forms (first forms) t) scope)))

(define-plan-form "OR" nil (&rest forms) (form scope)
  (if (rest forms)
      (with-gensyms (value)
        (plan-code (note-expansion `(let ((,value ,(first forms)))
                                      (if ,value ,value ,(note-own-text `(or ,@(rest forms)))))
                                   form)
                   scope))
      (plan-code (first forms) scope)))
