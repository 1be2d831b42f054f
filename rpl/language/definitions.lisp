;;;; definitions.lisp -- def-interp-proc, def-interp-macro, and plans without a name.

(in-package :ars-magna.rpl.language)

(export '(split-documentation variable-of procedure-form check-plan-name))

(defun procedure-scope-and-entry (parameters environment)
  "Return the scope of a procedure's body, and the lambda expression for the procedure's entry."
  (let ((scope (make-scope :environment environment))
        (variables (lambda-list-variables parameters)))
    (check-lambda-list parameters scope)
    (values (variable-scope scope variables)
            (entry-lambda parameters scope nil))))

(defun split-documentation (body)
  "Return BODY without its documentation string, and this string or NIL."
  (if (and (stringp (first body)) (rest body))
      (values (rest body) (first body))
      (values body nil)))

(defun procedure-form (name parameters body environment
                       &optional (text `(def-interp-proc ,name ,parameters ,@body)))
  "Return the form that defines the plan procedure NAME with PARAMETERS and BODY. ENVIRONMENT is the
Lisp environment of the definition. TEXT is the definition as the user wrote it, (definer name
form...). Signals MALFORMED-DEFINITION."
  (let* ((definition (definition-title (first text) name))
         (parameters (untyped-parameters parameters (list* name parameters body) environment
                                         definition))
         (form (list* name parameters body)))
    (declare-procedure name parameters)
    (warn-of-unused-bindings (lambda-list-variables parameters)
                             (list* (remove-if #'symbolp parameters) body)
                             (if *definition* (defining-form *definition*) form))
    (with-plan-text (form)
      (warn-of-text-mistakes body)
      (multiple-value-bind (body documentation) (split-documentation body)
        (multiple-value-bind (scope entry) (procedure-scope-and-entry parameters environment)
          `(progn
             (eval-when (:compile-toplevel :load-toplevel :execute)
               (declare-procedure ',name ',parameters)
               (declaim (ftype function ,name)))
             (install-procedure ',name ',parameters ,documentation
                                ,entry ,(procedure-body-code name form body scope)
                                (lambda (&rest arguments) (reject-lisp-call ',name arguments))
                                ',(source-of-current-form) ',text)))))))

(defun check-plan-name (definition name)
  "Signal MALFORMED-DEFINITION about DEFINITION unless users can define a plan with the name NAME."
  (unless (symbolp name) (reject-clause definition name "a symbol as the name"))
  (check-function-name definition name))

(public def-interp-proc)
(define-user-macro def-interp-proc (&whole form name parameters &body body &environment environment)
  "Define NAME as a plan procedure with PARAMETERS. PARAMETERS is an ordinary lambda list in which a
hyphen and a type may follow each variable. BODY is plan text and may start with a documentation
string. The value of the procedure is that of its last form. A new definition takes effect at the
next call, also in running plans (manual D.2)."
  (check-plan-name (definition-title "def-interp-proc" name) name)
  (call-with-definition form (lambda () (procedure-form name parameters body environment))))

(addition interp-lambda)
(define-user-macro interp-lambda ((&rest parameters) &body body &environment environment)
  "Return a nameless plan procedure. PARAMETERS and BODY are as for DEF-INTERP-PROC. BODY sees the
variables around INTERP-LAMBDA, but not blocks, tags and local plans. Run the plan by CALL-PLAN."
  (let ((parameters (untyped-parameters parameters (list* 'interp-lambda parameters body)
                                        environment
                                        (if *definition* (text-title) "interp-lambda")))
        (form (list* 'interp-lambda parameters body))
        (inside-p (and *conses-of-plan-text* t)))
    (with-plan-text (form)
      (unless inside-p (warn-of-text-mistakes body))
      (multiple-value-bind (scope entry) (procedure-scope-and-entry parameters environment)
        `(anonymous-procedure ',parameters ,entry
                              ,(procedure-body-code nil form body scope)
                              ',form)))))

(addition make-plan)
(defun make-plan (form &key compile)
  "Return a plan procedure without parameters that runs FORM, plan text made by a program. If
COMPILE is false, the Lisp code in FORM is interpreted: MAKE-PLAN is fast, and the plan slow. If
COMPILE is true, the code is compiled."
  (evaluate-form `(interp-lambda () ,form) :compile compile))

;;; Macros.

(defun pattern-lambda-list (pattern)
  "Return PATTERN as a macro lambda list. In PATTERN, ?x stands for the variable x, and ?() for
anything. The second value is a list of (variable word) for each word that must occur literally."
  (let ((literals '()))
    (labels ((parameter (pattern)
               (cond ((variable-of pattern))
                     ((consp pattern) (parameters pattern))
                     (t (let ((variable (gensym "LITERAL")))
                          (push (list variable pattern) literals)
                          variable))))
             (parameters (pattern)
               (cond ((null pattern) '())
                     ((consp pattern) (cons (parameter (car pattern)) (parameters (cdr pattern))))
                     (t (list '&rest (parameter pattern))))))
      (values (parameters pattern) (nreverse literals)))))

(defun variable-of (pattern)
  "Return the variable of PATTERN if PATTERN is a symbol such as ?x, or NIL."
  (cond ((matchvar-p pattern) (or (matchvar-name pattern) (gensym "ANY")))
        ((and (symbolp pattern) (starts-with-subseq "?" (symbol-name pattern)))
         (if (string= "?" (symbol-name pattern))
             (gensym "ANY")
             (intern (subseq (symbol-name pattern) 1))))))

(defun check-pattern-word (name form given expected)
  (unless (or (eq given expected)
              (and given expected (symbolp given) (symbolp expected) (same-name-p given expected)))
    (reject-clause (format nil "~(~A~)" name) form (format nil "the word ~(~S~)" expected))))

(defparameter *largest-pattern* 250
  "The largest number of lists, words and variables in a pattern, to spare the compiler's stack.")

(defun larger-than-p (form limit)
  (let ((open (list form)))
    (loop while open
          do (let ((part (pop open)))
               (when (consp part)
                 (when (minusp (decf limit)) (return t))
                 (push (cdr part) open)
                 (push (car part) open))))))

(defun check-pattern (name pattern)
  (when (larger-than-p pattern *largest-pattern*)
    (reject-clause (definition-title "def-interp-macro" name) (abridged pattern)
                   (format nil "a pattern of at most ~D words and variables; at its end, . ?x ~
                                matches all the rest" *largest-pattern*))))

(public def-interp-macro)
(define-user-macro def-interp-macro ((name &rest pattern) &body template)
  "Define NAME as a macro for plans. ?x in PATTERN stands for any form, to which the variable x is
bound while TEMPLATE is evaluated. A pattern may end in a dot and ?x for all remaining forms. The
value of TEMPLATE is the plan text. A documentation string may come before TEMPLATE (manual D.8)."
  (check-plan-name (definition-title "def-interp-macro" name) name)
  (check-pattern name pattern)
  (multiple-value-bind (parameters literals) (pattern-lambda-list pattern)
    (multiple-value-bind (body documentation) (split-documentation template)
      (with-gensyms (form)
        `(progn
           ,(user-macro-form
             name `(&whole ,form ,@parameters) (cons name pattern)
             `(,@(when documentation (list documentation))
               (declare (ignorable ,@(remove-if #'symbol-package
                                                (destructuring-variables parameters))))
               ,@(loop for (variable word) in literals
                       collect `(check-pattern-word ',name ,form ,variable ',word))
               ,@body))
           (show-lambda-list ',name ',(lambda-list-for-display parameters literals))
           ',name)))))

(defun lambda-list-for-display (parameters literals)
  "Return PARAMETERS as a lambda list for display, with the words of LITERALS. A variable BODY or
FORMS that takes all remaining forms is shown after &BODY."
  (cond ((null parameters) '())
        ((atom parameters) (if (assoc parameters literals)
                               (second (assoc parameters literals))
                               (intern (string-right-trim "0123456789" (symbol-name parameters)))))
        ((and (eq '&rest (first parameters))
              (member (second parameters) '("BODY" "FORMS") :test #'string=))
         (list '&body (second parameters)))
        (t (cons (lambda-list-for-display (first parameters) literals)
                 (lambda-list-for-display (rest parameters) literals)))))
