;;;; environments.lisp -- what the compiler knows of names, walks through forms, package locks.

(in-package :ars-magna.host)

(export '(function-arguments form-behind-comma bound-in-walk-p variable-kind local-variable-p
          known-variable-p special-variable-p local-function-p known-function-p macro-expander
          lisps-own-p extended-environment evaluate-form walk-form expand-in-walk users-symbol-p
          variable-name-p variable-forms variable-name-trouble undefined-name still-undefined-p
          lock-violation locked-symbol copy-nicknames))

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

(defun form-behind-comma (object)
  "Return the form behind OBJECT if that is a comma in a backquoted form, or NIL."
  (and (internal (:sb-int #:comma-p) object)
       (internal (:sb-int #:comma-expr) object)))

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
               (internal (:sb-walker #:walk-form) form environment #'replacement))
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

;;;; Which names can be variables, and which mean nothing at all

;;; What a user defines by a name can often be had as the value of a variable of that name too.

(defun variable-name-trouble (name)
  "Return in words why the symbol NAME, of a package, cannot become a special variable, or NIL."
  (let ((package (symbol-package name)))
    (cond ((package-locked-p package) (format nil "belongs to ~A" (package-name package)))
          ((constantp name) "is a constant")
          ((not (member (variable-kind name) '(nil :special)))
           "is a symbol macro or a global variable"))))

(defun users-symbol-p (name)
  "True if the symbol NAME is in a package whose names users may define."
  (let ((package (symbol-package name)))
    (and package
         (not (keywordp name))
         (not (package-locked-p package)))))

(defun variable-name-p (name)
  "True if the symbol NAME can become a special variable: constants cannot, nor what belongs to a
locked package, such as Common Lisp's or ours."
  (and name
       (symbol-package name)
       (null (variable-name-trouble name))))

(defun variable-forms (name)
  "Return the forms, perhaps none, that declare NAME a special variable."
  (when (variable-name-p name) `((defvar ,name))))

;;; Names that the compiler finds used, and that nobody has defined.

(defun undefined-name (condition)
  "Return the name that CONDITION, a warning of the compiler's, says is not defined, and whether as
a :FUNCTION or :VARIABLE; NIL if it says something else."
  (let ((arguments (and (typep condition '(and warning simple-condition))
                        (simple-condition-format-arguments condition))))
    (when (and (proper-list-p arguments)
               (= 2 (length arguments))
               (member (first arguments) '(:function :variable)))
      (values (second arguments) (first arguments)))))

(defun still-undefined-p (name kind)
  "True if NAME is not defined as KIND, a :FUNCTION or :VARIABLE, by now either."
  (ecase kind
    (:function (not (fboundp name)))
    (:variable (not (or (boundp name) (known-variable-p name nil))))))

;;;; Packages

;;; What a locked package has cannot be redefined by accident.

(deftype lock-violation ()
  "The condition that a name of a locked package was to be redefined."
  'sb-ext:package-lock-violation)

(defun locked-symbol (condition)
  "Return the symbol that CONDITION, a LOCK-VIOLATION, is about, or NIL if it is about no symbol."
  (ignore-errors (sb-ext:package-locked-error-symbol condition)))

(defun copy-nicknames (from to)
  "Let the package TO call others by the nicknames that are local to the package FROM."
  (loop for (nickname . other) in (sb-ext:package-local-nicknames from)
        do (sb-ext:add-package-local-nickname nickname other to)))
