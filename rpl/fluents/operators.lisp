;;;; operators.lisp -- Lisp's operators, lifted: given fluents they return a network.

(in-package :ars-magna.rpl.fluents)

(export '(lifting lifting-and lifting-or))

;;; LIFTING is what plans turn calls of these operators into. Where no argument is a fluent it is
;;; plain Lisp, and where the compiler can see that none is, nothing is left of it.

(defmacro lifting (operator &rest arguments &environment environment)
  "Call OPERATOR, the name of a function, with ARGUMENTS; return a network if any is a
fluent (reading 184)."
  (let* ((bindings (loop for argument in arguments
                         unless (constantp argument environment)
                           collect (list (gensym "ARGUMENT")
                                         (if (member operator '(not null))
                                             `(one-fluent ,argument)
                                             argument))))
         (values (loop with variables = (mapcar #'first bindings)
                       for argument in arguments
                       collect (if (constantp argument environment) argument (pop variables)))))
    `(let ,bindings
       (if (or ,@(loop for (variable) in bindings collect `(fluent-p ,variable)))
           (lift ',operator #',operator ,@values)
           (,operator ,@values)))))

(defun every-value (&rest values)
  "Return the last of VALUES if all are true: AND as a function."
  (loop for (value . more) on values
        unless value return nil
        unless more return value
        finally (return t)))

(defun some-value (&rest values)
  "Return the first true one of VALUES: OR as a function."
  (find-if #'identity values))

(defun lift-junction (name function absorbing thunks)
  "Return AND (if ABSORBING is NIL) or OR (if it is T) of what THUNKS return, the later ones not
called if the result is known before. From the first fluent on, the result is a network."
  (loop for (thunk . more) on thunks
        for value = (one-fluent (funcall (the function thunk)))
        when (fluent-p value)
          return (apply #'lift name function value
                        (mapcar (lambda (thunk) (one-fluent (funcall (the function thunk))))
                               more))
        when (or (null more) (eq absorbing (and value t)))
          return value))

(defmacro lifting-and (&rest forms)
  "AND of FORMS; from the first of them that is a fluent on, a network."
  (cond ((null forms) t)
        ((null (rest forms)) (first forms))
        (t `(lift-junction 'and #'every-value nil
                           (list ,@(loop for form in forms collect `(lambda () ,form)))))))

(defmacro lifting-or (&rest forms)
  "OR of FORMS; from the first of them that is a fluent on, a network."
  (if (rest forms)
      `(lift-junction 'or #'some-value t
                      (list ,@(loop for form in forms collect `(lambda () ,form))))
      (first forms)))

;;; The same under the names of the operators, for ordinary code. Each is also a function.

(defmacro define-lifted (&rest operators)
  "Define functions of package ARS-MAGNA.RPL.LIFTED named as OPERATORS, Lisp functions."
  `(progn
     ,@(loop for operator in operators
             for name = (find-symbol (symbol-name operator) :ars-magna.rpl.lifted)
             collect `(defun ,name (&rest arguments)
                        ,(format nil "Return ~A of ARGUMENTS; a network of them if any is a fluent."
                                 operator)
                        (apply #'lift ',operator #',operator arguments))
             collect `(define-compiler-macro ,name (&rest arguments)
                        (list* 'lifting ',operator arguments)))))

(define-lifted not null < > <= >= = + - * / eq eql equal)

(defmacro lifted:and (&rest forms)
  "Evaluate FORMS until one is false, as Lisp's AND; from the first one that is a fluent on, return
a network."
  `(lifting-and ,@forms))

(defmacro lifted:or (&rest forms)
  "Evaluate FORMS until one is true, as Lisp's OR; from the first one that is a fluent on, return a
network."
  `(lifting-or ,@forms))

(defmacro lifted:if (test then &optional else)
  "Evaluate THEN or ELSE as Lisp's IF; TEST may be a fluent and counts by its value (manual D.2)."
  `(if (truth-value ,test) ,then ,else))

(defmacro lifted:when (test &body body)
  "Evaluate BODY if the value of TEST, a fluent or not, is true."
  `(when (truth-value ,test) ,@body))

(defmacro lifted:unless (test &body body)
  "Evaluate BODY if the value of TEST, a fluent or not, is false."
  `(unless (truth-value ,test) ,@body))

(defmacro lifted:cond (&rest clauses)
  "Evaluate the first of CLAUSES whose test, a fluent or not, has a true value."
  `(cond ,@(loop for (test . body) in clauses
                 collect `((truth-value ,test) ,@body))))

(defmacro lifted:loop (&rest forms)
  "Repeat FORMS; (loop UNTIL test ...) and (loop WHILE test ...) read fluents by value. Other FORMS
mean what they mean to Lisp's LOOP (manual D.2)."
  (cond ((and (symbolp (first forms)) (string= (first forms) "UNTIL"))
         `(loop (when (truth-value ,(second forms)) (return)) ,@(cddr forms)))
        ((and (symbolp (first forms)) (string= (first forms) "WHILE"))
         `(loop (unless (truth-value ,(second forms)) (return)) ,@(cddr forms)))
        (t `(loop ,@forms))))
