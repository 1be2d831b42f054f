;;;; lisp-environment.lisp -- what Lisp's compiler knows of names: the one door to SBCL's walkers.

(in-package :ars-magna.rpl)

;;; SB-CLTL2 looks into and extends lexical environments; SB-WALKER visits the expressions of a
;;; form, each with its true environment.

(defun extended-environment (environment &rest additions &key &allow-other-keys)
  "Return ENVIRONMENT with ADDITIONS: :variable and :function and lists of names, :macro and a list
of (name expander), :symbol-macro and a list of (name expansion)."
  (apply #'sb-cltl2:augment-environment environment additions))

(defun local-function-p (name environment)
  "True if NAME is a local function or macro in ENVIRONMENT."
  (nth-value 1 (sb-cltl2:function-information name environment)))

(defun known-function-p (name environment)
  "True if NAME is a function, also one defined earlier in the file that is being compiled."
  (or (fboundp name)
      (eq :function (sb-cltl2:function-information name environment))))

(defun special-variable-p (variable environment)
  (eq :special (sb-cltl2:variable-information variable environment)))

(defun macro-expander (definition environment)
  "Return the expander of DEFINITION, (name lambda-list form...) as in MACROLET."
  (destructuring-bind (name lambda-list &rest body) definition
    (sb-cltl2:enclose (sb-cltl2:parse-macro name lambda-list body environment) environment)))

(defun lisps-macro-p (name)
  "True if NAME is of Common Lisp or its implementation."
  (let ((package (symbol-package name)))
    (and package
         (or (eq package #.(find-package :cl))
             (starts-with-subseq "SB-" (package-name package))))))

(defun walk (form environment visit)
  "Return FORM with each expression in it replaced by what VISIT returns for it and its environment,
outermost first; what is put in place is visited in turn. A second value that is true keeps the
walk out of what is put there."
  (declare (type function visit))
  (sb-walker:walk-form form environment
                       (lambda (form context environment)
                         (if (eq context :eval)
                             (funcall visit form environment)
                             form))))
