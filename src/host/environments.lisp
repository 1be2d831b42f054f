;;;; environments.lisp -- what the compiler knows beyond SB-CLTL2, and a walk through forms.

(in-package :ars-magna.host)

(export '(function-arguments form-behind-comma user-type-p walk-expressions bound-in-walk-p
          variables-of-walk))

;;; Tried with SBCL 2.2.9, 2.5.2 and 2.6.4.

(defun function-arguments (name)
  "Return what the function NAME takes, types and lambda list keywords as in the type FUNCTION, and
true; or NIL twice if the compiler does not know."
  (let ((type (and (member (internal (:sb-int #:info) :function :where-from name)
                           '(:declared :defined))
                   (internal (:sb-kernel #:type-specifier)
                             (internal (:sb-int #:info) :function :type name)))))
    (if (typep type '(cons (eql function) (cons list)))
        (values (second type) t)
        (values nil nil))))

(defun user-type-p (symbol)
  "True if SYMBOL is a type that DEFTYPE has defined."
  (and (internal (:sb-int #:info) :type :expander symbol) t))

(defun form-behind-comma (object)
  "Return the form behind OBJECT if that is a comma in a backquoted form, or NIL."
  (and (internal (:sb-int #:comma-p) object)
       (internal (:sb-int #:comma-expr) object)))

(defun walk-expressions (form environment function)
  "Return FORM with each form in it replaced by what FUNCTION returns for it, its context and its
environment. FUNCTION's second value is true where the walk is not to enter the replacement."
  (internal (:sb-walker #:walk-form) form environment function))

(defun bound-in-walk-p (variable environment)
  "True if VARIABLE is bound by a form that the walk which visits ENVIRONMENT has entered."
  ;; Variables of the environment that the walk began in are entries, others lists of these.
  (let ((found (internal (:sb-walker #:var-lexical-p) variable environment)))
    (and (consp found) (consp (first found)))))

(defun variables-of-walk (environment)
  "Return the names of the variables that forms bind which the walk that visits ENVIRONMENT has
entered, but for those that are symbol macros there."
  (loop for (name . kind) in (internal (:sb-walker #:env-lexical-variables) environment)
        unless (member name seen)
          collect name into seen
          and when (equal '(:lexical-var) kind) collect name into variables
        finally (return variables)))
