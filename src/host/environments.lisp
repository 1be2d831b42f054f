;;;; environments.lisp -- the compiler's knowledge of names; code walking; package locks.

(in-package :ars-magna.host)

(export '(function-argument-types comma-p form-behind-comma bound-in-walk-p variable-kind
          local-variable-p known-variable-p special-variable-p bound-in-thread-p set-symbol-macro
          remove-symbol-macro local-function-p known-function-p
          macro-expander lisp-symbol-p extended-environment evaluate-form walk-form expand-in-walk
          users-symbol-p variable-name-p defvar-forms variable-name-trouble
          undefined-name-of-warning
          still-undefined-p lock-violation locked-symbol copy-nicknames))

(defun function-argument-types (name)
  "Return the argument types of the function NAME, as in a type (FUNCTION (type...)), and true; NIL
and NIL if the compiler does not know them."
  (let ((type (and (member (internal (:sb-int #:info) :function :where-from name)
                           '(:declared :defined))
                   (internal (:sb-kernel #:type-specifier)
                             (internal (:sb-int #:info) :function :type name)))))
    (if (typep type '(cons (eql function) (cons list)))
        (values (second type) t)
        (values nil nil))))

(defun comma-p (object)
  "True if OBJECT is a comma in a backquoted form."
  (internal (:sb-int #:comma-p) object))

(defun form-behind-comma (object)
  "Return the form of OBJECT if it is a comma in a backquoted form, else NIL."
  (and (comma-p object)
       (internal (:sb-int #:comma-expr) object)))

(defun bound-in-walk-p (variable environment)
  "True if VARIABLE is bound by a form around the current form of the code walk with ENVIRONMENT."
  ;; Variables of the environment in which the walk began are entries; others are lists of these.
  (let ((found (internal (:sb-walker #:var-lexical-p) variable environment)))
    (and (consp found) (consp (first found)))))

(defun variables-of-walk (environment)
  "Return the variables, without symbol macros, that are bound by the forms around the current form
of the code walk with ENVIRONMENT."
  (loop for (name . kind) in (internal (:sb-walker #:env-lexical-variables) environment)
        unless (member name seen)
          collect name into seen
          and when (equal '(:lexical-var) kind) collect name into variables
        finally (return variables)))

;;; SB-CLTL2 inspects and extends lexical environments.

;;; Variables.

(defun variable-kind (name &optional environment)
  "Return the kind of the variable NAME in ENVIRONMENT: :special, :lexical, :symbol-macro, :constant
and so on, or NIL if it is not known."
  (values (sb-cltl2:variable-information name environment)))

(defun local-variable-p (symbol environment)
  "True if SYMBOL is a local variable or symbol macro in ENVIRONMENT."
  (nth-value 1 (sb-cltl2:variable-information symbol environment)))

(defun known-variable-p (symbol environment)
  "True if SYMBOL is a known variable or constant in ENVIRONMENT."
  (and (variable-kind symbol environment) t))

(defun special-variable-p (symbol environment)
  "True if SYMBOL is a special variable in ENVIRONMENT."
  (eq :special (variable-kind symbol environment)))

(defun bound-in-thread-p (symbol)
  "True if this thread has a binding of the special variable SYMBOL, besides its global value."
  (nth-value 1 (sb-thread:symbol-value-in-thread symbol sb-thread:*current-thread* nil)))

(defun set-symbol-macro (name expansion)
  "Define NAME as a global symbol macro for the form EXPANSION. Return NAME."
  (eval `(define-symbol-macro ,name ,expansion)))

(defun remove-symbol-macro (name)
  "Make NAME, a global symbol macro, a symbol that is no variable."
  (when (eq :symbol-macro (variable-kind name))
    (internal (:sb-int #:clear-info) :variable :kind name)
    (internal (:sb-int #:clear-info) :variable :macro-expansion name)))

;;; Functions and macros.

(defun local-function-p (name environment)
  "True if NAME is a local function or macro in ENVIRONMENT."
  (nth-value 1 (sb-cltl2:function-information name environment)))

(defun known-function-p (name environment)
  "True if NAME is a function, including one defined earlier in the file being compiled."
  (or (fboundp name)
      (eq :function (sb-cltl2:function-information name environment))))

(defun macro-expander (definition environment)
  "Return the macro function of DEFINITION, (name lambda-list form...) as in MACROLET."
  (destructuring-bind (name lambda-list &rest body) definition
    (sb-cltl2:enclose (sb-cltl2:parse-macro name lambda-list body environment) environment)))

(defun lisp-symbol-p (name)
  "True if the symbol NAME belongs to Common Lisp or to SBCL."
  (let ((package (symbol-package name)))
    (and package
         (or (eq package #.(find-package :cl))
             (starts-with-subseq "SB-" (package-name package))))))

;;; Environments.

(defun extended-environment (environment &rest additions &key &allow-other-keys)
  "Return ENVIRONMENT, a lexical environment, extended by ADDITIONS: :variable and :function with
names, :macro with lists (name expander), :symbol-macro with (name expansion)."
  (apply #'sb-cltl2:augment-environment environment additions))

;;; Forms.

(defun evaluate-form (form &key compile)
  "Return the value of FORM, compiled if COMPILE is true, else interpreted."
  (let ((sb-ext:*evaluator-mode* (if compile :compile :interpret)))
    (eval form)))

;; Environments of a walk do not show that its variables shadow symbol macros.
(defun expand-in-walk (form environment)
  "Return FORM, a macro call in a code walk with ENVIRONMENT, expanded once."
  (let ((shadowing (remove :symbol-macro (variables-of-walk environment)
                           :key (lambda (name) (variable-kind name environment))
                           :test-not #'eq)))
    (macroexpand-1 form (if shadowing
                            (extended-environment environment :variable shadowing)
                            environment))))

(defun users-macro-p (form environment)
  (and (symbolp (first form))
       (not (lisp-symbol-p (first form)))
       (macro-function (first form) environment)))

(defun walk-form (form environment visit)
  "Return FORM with each subform, the outermost first, replaced by the value of VISIT, called with
the subform and its environment. A replacement is visited in turn, unless VISIT returns true as its
second value. A replacement gets the source location of the form that it replaces."
  (declare (type function visit))
  (let ((entered nil))
    (labels ((walk (form environment)
               (internal (:sb-walker #:walk-form) form environment #'replacement))
             (inside (form environment)
               (setf entered form)
               (expanded form form environment))
             (expanded (new form environment)
               (values (copy-source-location (walk new environment) form) t))
             (replacement (form context environment)
               (cond ((not (eq context :eval)) form)
                     ((and (consp form) (eq form (shiftf entered nil))) form)
                     (t (multiple-value-bind (new done) (funcall visit form environment)
                          (copy-source-location new form)
                          (cond (done (values new t))
                                ((atom new) new)
                                ((not (eq new form)) (expanded new form environment))
                                ((users-macro-p form environment)
                                 (expanded (expand-in-walk form environment) form environment))
                                (t (inside form environment))))))))
      (walk form environment))))

;;;; Names that can be variables, and undefined names

;;; A user's definition is often also the value of the variable of its name.

(defun variable-name-trouble (name)
  "Return a text that says why the symbol NAME cannot become a special variable, or NIL."
  (let ((package (symbol-package name)))
    (cond ((package-locked-p package) (format nil "belongs to ~A" (package-name package)))
          ((constantp name) "is a constant")
          ((not (member (variable-kind name) '(nil :special)))
           "is a symbol macro or a global variable"))))

(defun users-symbol-p (name)
  "True if users may define the symbol NAME: it is not a keyword, and its package is not locked."
  (let ((package (symbol-package name)))
    (and package
         (not (keywordp name))
         (not (package-locked-p package)))))

(defun variable-name-p (name)
  "True if the symbol NAME can become a special variable. Constants and symbols of locked packages,
such as those of Common Lisp and of the simulator, cannot."
  (and name
       (symbol-package name)
       (null (variable-name-trouble name))))

(defun defvar-forms (name)
  "Return the forms, or NIL, that declare NAME a special variable."
  (when (variable-name-p name) `((defvar ,name))))

;;; Names that the compiler finds used but undefined.

(defun undefined-name-of-warning (condition)
  "If CONDITION warns of an undefined name, return the name and :FUNCTION or :VARIABLE; else NIL."
  (let ((arguments (and (typep condition '(and warning simple-condition))
                        (simple-condition-format-arguments condition))))
    (when (and (proper-list-p arguments)
               (= 2 (length arguments))
               (member (first arguments) '(:function :variable)))
      (values (second arguments) (first arguments)))))

(defun still-undefined-p (name kind)
  "True if NAME is still undefined as KIND, :FUNCTION or :VARIABLE."
  (ecase kind
    (:function (not (fboundp name)))
    (:variable (not (or (boundp name) (known-variable-p name nil))))))

;;;; Packages

;;; Names of a locked package cannot be redefined by accident.

(deftype lock-violation ()
  "The type of the error that is signalled when a name of a locked package would be redefined."
  'sb-ext:package-lock-violation)

(defun locked-symbol (condition)
  "Return the symbol that a LOCK-VIOLATION, the error CONDITION, is about; or NIL."
  (ignore-errors (sb-ext:package-locked-error-symbol condition)))

(defun copy-nicknames (from to)
  "Add the local nicknames of the package FROM to the package TO."
  (loop for (nickname . other) in (sb-ext:package-local-nicknames from)
        do (sb-ext:add-package-local-nickname nickname other to)))
