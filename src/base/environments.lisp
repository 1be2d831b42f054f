;;;; environments.lisp -- what Lisp's compiler knows of names, and walks through forms.

(in-package :ars-magna.base)

(export '(variable-kind local-variable-p known-variable-p special-variable-p local-function-p
          known-function-p macro-expander lisps-own-p extended-environment evaluate-form walk-form
          expand-in-walk))

;;; SB-CLTL2 looks into and extends lexical environments.

;;; Variables.

(defun variable-kind (name &optional environment)
  "Return what variable NAME is in ENVIRONMENT: :special, :lexical, :symbol-macro, :constant and so
on, or NIL if it is none that is known."
  (values (sb-cltl2:variable-information name environment)))

(defun local-variable-p (symbol environment)
  "True if SYMBOL is a local variable or symbol macro in ENVIRONMENT."
  (nth-value 1 (sb-cltl2:variable-information symbol environment)))

(defun known-variable-p (symbol environment)
  "True if SYMBOL, as a form in ENVIRONMENT, is a variable or constant that is known."
  (and (variable-kind symbol environment) t))

(defun special-variable-p (symbol environment)
  "True if SYMBOL is a special variable in ENVIRONMENT."
  (eq :special (variable-kind symbol environment)))

;;; Functions and macros.

(defun local-function-p (name environment)
  "True if NAME is a local function or macro in ENVIRONMENT."
  (nth-value 1 (sb-cltl2:function-information name environment)))

(defun known-function-p (name environment)
  "True if NAME is a function, also one defined earlier in the file that is being compiled."
  (or (fboundp name)
      (eq :function (sb-cltl2:function-information name environment))))

(defun macro-expander (definition environment)
  "Return the expander of DEFINITION, (name lambda-list form...) as in MACROLET."
  (destructuring-bind (name lambda-list &rest body) definition
    (sb-cltl2:enclose (sb-cltl2:parse-macro name lambda-list body environment) environment)))

(defun lisps-own-p (name)
  "True if the symbol NAME is of Common Lisp or its implementation."
  (let ((package (symbol-package name)))
    (and package
         (or (eq package #.(find-package :cl))
             (starts-with-subseq "SB-" (package-name package))))))

;;; Environments.

(defun extended-environment (environment &rest additions &key &allow-other-keys)
  "Return ENVIRONMENT with ADDITIONS: :variable and :function and lists of names, :macro and a list
of (name expander), :symbol-macro and a list of (name expansion)."
  (apply #'sb-cltl2:augment-environment environment additions))

;;; Forms.

(defun evaluate-form (form &key compile)
  "Return what FORM does when it is compiled, if COMPILE is true, or else interpreted."
  (let ((sb-ext:*evaluator-mode* (if compile :compile :interpret)))
    (eval form)))

;; Environments of a walk do not tell that variables which it has met shadow symbol macros.
(defun expand-in-walk (form environment)
  "Return what FORM, a macro call that a walk has met in ENVIRONMENT, expands to at first."
  (let ((shadowing (remove :symbol-macro (variables-of-walk environment)
                           :key (lambda (name) (variable-kind name environment))
                           :test-not #'eq)))
    (macroexpand-1 form (if shadowing
                            (extended-environment environment :variable shadowing)
                            environment))))

(defun users-macro-p (form environment)
  "True if FORM is a call of a macro in ENVIRONMENT that is not Lisp's."
  (and (symbolp (first form))
       (not (lisps-own-p (first form)))
       (macro-function (first form) environment)))

(defun walk-form (form environment visit)
  "Return FORM with each expression in it replaced by what VISIT returns for it and its environment,
outermost first; what is put in place is visited in turn. A second value that is true keeps the
walk out of what is put there. What takes the place of an expression stands where that stood."
  (declare (type function visit))
  (let ((entered nil))
    (labels ((walk (form environment)
               (walk-expressions form environment #'replacement))
             (inside (form environment)
               (setf entered form)
               (expanded form form environment))
             (expanded (new form environment)
               (values (keep-place (walk new environment) form) t))
             (replacement (form context environment)
               (cond ((not (eq context :eval)) form)
                     ((and (consp form) (eq form (shiftf entered nil))) form)
                     (t (multiple-value-bind (new done) (funcall visit form environment)
                          (keep-place new form)
                          (cond (done (values new t))
                                ((atom new) new)
                                ((not (eq new form)) (expanded new form environment))
                                ((users-macro-p form environment)
                                 (expanded (expand-in-walk form environment) form environment))
                                (t (inside form environment))))))))
      (walk form environment))))
