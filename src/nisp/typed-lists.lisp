;;;; typed-lists.lisp -- taking the type declarations out of parameter and binding lists.

(in-package :ars-magna.nisp)

(export '(untyped-bindings untyped-lambda-list lambda-list-variables))

;;; A hyphen and a type after a variable declare its type (manual 3.1). Types are documentation:
;;; they are checked for being there and then dropped, known or not. A name that may be a slip for
;;; that of a known type is warned of.

(defun hyphen-p (form)
  (and (symbolp form) (string= form "-")))

(defun lambda-keyword-p (form)
  (member form lambda-list-keywords))

(defun type-like (type)
  "Return the name of a known type for which TYPE, which is unknown, may be a slip; or NIL."
  (and type
       (symbolp type)
       (not (find-nisp-type type))
       (not (find-class type nil))
       (find-if (lambda (name) (resembles-p type name)) (known-types))))

(defun doubt-type (operator type)
  (when (type-like type)
    (doubt-definition "~A: there is no type ~(~A~). Did you mean ~(~A~)?"
                      operator type (type-like type))))

(defun without-types (operator list)
  "Return LIST without each hyphen and the type that follows it. OPERATOR, a string, is named in
the error if a hyphen has no variable before it or no type behind it."
  (loop with typed = t                  ; nothing to declare yet
        with tail = list
        while (consp tail)
        for element = (pop tail)
        if (hyphen-p element)
          do (when (or typed (atom tail) (hyphen-p (first tail)))
               (reject-clause operator list "each hyphen between a variable and its type"))
             (doubt-type operator (pop tail))
             (setf typed t)
        else
          do (setf typed (lambda-keyword-p element))
          and collect element))

(defun untyped-lambda-list (lambda-list &optional (operator "lambda"))
  "Return LAMBDA-LIST, an ordinary one in which a hyphen and a type may follow each variable, as
an ordinary lambda list. OPERATOR, a string, is named in errors (manual 3.1)."
  (unless (listp lambda-list)
    (reject-clause operator lambda-list "a list of parameters"))
  (without-types operator lambda-list))

(defun untyped-bindings (bindings &optional (operator "let"))
  "Return BINDINGS as LET takes them, without the hyphen and type that may follow each one.
OPERATOR, a string, is named in errors (manual 3.1)."
  (unless (listp bindings)
    (reject-clause operator bindings "a list of bindings"))
  (without-types operator bindings))

(defun parameter-variables (parameter)
  (if (atom parameter)
      (list parameter)
      (destructuring-bind (name &optional default (supplied nil supplied-p)) parameter
        (declare (ignore default))
        (cons (if (consp name) (second name) name)
              (and supplied-p (list supplied))))))

(defun lambda-list-variables (lambda-list)
  "Return the variables that LAMBDA-LIST, an ordinary one without types, binds."
  (mapcan #'parameter-variables
          (remove-if #'lambda-keyword-p lambda-list)))
