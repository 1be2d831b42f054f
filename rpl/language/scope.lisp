;;;; scope.lisp -- which names plans can bind, and what is visible at a place in a plan's text.

(in-package :ars-magna.rpl.language)

(export '(check-variables untyped-parameters inner-scope scope single-value-scope
          variable-scope scope-variables names-by-level scope))

(defun invalid-variable-text (name environment)
  "Return a text which says why NAME cannot be a variable of any kind in ENVIRONMENT; or NIL."
  (cond ((not (symbolp name)) "is no symbol")
        ((or (null name) (keywordp name)) "is a constant")
        ((member name lambda-list-keywords) "is a word of lambda lists")
        (t (case (variable-kind name environment)
             (:constant "is a constant")
             (:global "is a global variable")))))

(defun check-variables (variables environment &optional (form nil form-p))
  "Signal MALFORMED-DEFINITION, about FORM if given, unless VARIABLES can be bound in ENVIRONMENT."
  (dolist (variable variables)
    (let ((trouble (invalid-variable-text variable environment)))
      (when trouble
        (reject-clause (text-title) (if form-p form variable)
                       (format nil "the name of a lexical variable; ~(~S~) ~A"
                               (abridged variable) trouble))))))

;;; Lambda lists.

(defun invalid-parameters-text (parameters environment)
  "Return a text which says why PARAMETERS, without types, is no ordinary lambda list; or NIL."
  (flet ((first-trouble (names)
           (loop for name in names
                 for trouble = (invalid-variable-text name environment)
                 when trouble return (format nil "~(~S~) ~A" name trouble))))
    (handler-case (parse-ordinary-lambda-list parameters :normalize nil)
      (error ()
        (return-from invalid-parameters-text
          (or (first-trouble (remove-if (lambda (parameter)
                                      (or (consp parameter)
                                          (member parameter lambda-list-keywords)))
                                    parameters))
              "this is none"))))
    (let* ((variables (lambda-list-variables parameters))
           (twice (find-if (lambda (variable) (< 1 (count variable variables))) variables)))
      (cond (twice (format nil "~(~S~) occurs twice" twice))
            ((equal '(&rest) (last parameters)) "a variable comes after &rest")
            (t (first-trouble variables))))))

(defun forgotten-parameters-text (parameters environment)
  (and (typep parameters '(cons symbol))
       (known-function-p (first parameters) environment)
       "The list of parameters comes before the body; write () if the plan has no parameters"))

(defun warn-of-missing-parameters (parameters definition environment)
  "Warn if one of PARAMETERS, in DEFINITION, has the name of a function by which plans command the
robot. Then PARAMETERS is probably the first form of the body."
  (let ((name (find-if (lambda (name)
                         (and (starts-with-subseq "RPL-" (string name))
                              (known-function-p name environment)))
                       (lambda-list-variables parameters))))
    (when name
      (warn-of-style "~A: a parameter has the name of the function ~(~A~). If (~1@*~(~A~)) is ~
                      the first form of the body, write the list of parameters before it: () ~
                      if the plan has no parameters."
                        definition name))))

(defun untyped-parameters (parameters form environment &optional (definition (text-title)))
  "Return the lambda list PARAMETERS, a part of FORM in DEFINITION, without types. Signals
MALFORMED-DEFINITION if PARAMETERS is not an ordinary lambda list with types."
  (flet ((reject (trouble)
           (reject-clause definition (if (consp parameters) parameters form)
                          (format nil "an ordinary lambda list, such as (a &optional b &key c); ~
                                       ~A~@[. ~A~]"
                                  trouble (forgotten-parameters-text parameters environment)))))
    (unless (proper-list-p parameters) (reject "this is not a proper list"))
    (let* ((plain (untyped-lambda-list parameters definition))
           (trouble (invalid-parameters-text plain environment)))
      (when trouble (reject trouble))
      (warn-of-missing-parameters plain definition environment)
      plain)))

;;; Forms that bind, also where they are Lisp's to run.

(defun check-bindings (form environment)
  (let ((bindings (second form)))
    (unless (proper-list-p bindings)
      (reject-clause (text-title) form "(variable value) for each variable, in a proper list"))
    (dolist (entry (untyped-bindings bindings (text-title)))
      (unless (typep entry '(or symbol (cons t (or null (cons t null)))))
        (reject-clause (text-title) (if (consp entry) entry form)
                       "(variable value) for each variable"))
      (check-variables (list (first (ensure-list (or entry '(nil))))) environment form))))

(defun check-local-functions (form environment)
  (unless (proper-list-p (second form))
    (reject-clause (text-title) form
                   "(name parameters form...) for each function, in a proper list"))
  (dolist (definition (second form))
    (unless (and (typep definition '(cons t (cons list t))) (proper-list-p definition))
      (reject-clause (text-title) (if (consp definition) definition form)
                     "(name parameters form...) for each"))
    (untyped-parameters (second definition) definition environment)))

(defun check-bound-names (form environment)
  (flet ((is (&rest names) (operator-in-p form names)))
    (cond ((is "LET" "LET*") (check-bindings form environment))
          ((is "FLET" "LABELS") (check-local-functions form environment))
          ((is "MULTIPLE-VALUE-BIND")
           (when (proper-list-p (second form))
             (check-variables (second form) environment form)))
          ((is "DOLIST" "DOTIMES" "PAR-LOOP" "TRY-EACH-IN-ORDER")
           (when (typep (second form) '(cons t cons))
             (check-variables (list (first (second form))) environment form))))))

;;; Variables that a plan binds live in environments, vectors linked by element 0. A leaf is a Lisp
;;; function of the environment at its place; within it each visible variable is a symbol macro for
;;; its element. Local functions live in environments too.

(define-record (scope (:copier copy-scope))
  "The names that are visible at a place in a plan. Slots without documentation map names to
variables. In the code that builds the plan, these variables hold the nodes of the names."
  (variable (gensym "ENVIRONMENT") symbol "the variable of the environment in leaves. Each procedure
has a separate variable, because a leaf of a plan can contain other plans" :writable)
  (environment nil t "the Lisp environment at the place" :writable :export)
  (level 0 fixnum :writable)
  (layers '() list "the layers of names that are made visible in leaves, innermost first" :writable)
  (blocks '() list "an alist from block names to the variables of their nodes" :writable :export)
  (tags '() list :writable)
  (procedures '() list :writable)
  (retry nil symbol
         "the variable of the node that (retry) reruns; NIL outside handlers" :writable :export)
  (task-tags '() list :writable)
  (fluents '() list "the variables that are known to hold fluents" :writable)
  (several nil boolean :writable))

(defmacro inner-scope (scope &rest changes)
  "Return a copy of SCOPE in which the slots named in CHANGES, a property list, have new values."
  (with-gensyms (inner)
    `(let ((,inner (copy-scope ,scope)))
       (setf ,@(loop for (slot value) on changes by #'cddr
                     append `((,(symbolicate 'scope- slot) ,inner) ,value)))
       ,inner)))

(defun layered-scope (scope layer level &rest additions)
  "Return a copy of SCOPE with the new layer LAYER at LEVEL, and ADDITIONS to its Lisp environment."
  (inner-scope scope
               :level level
               :layers (cons layer (scope-layers scope))
               :environment (apply #'extended-environment (scope-environment scope) additions)))

(defun single-value-scope (scope)
  "Return a scope like SCOPE for an expression of which only the first value is used."
  (if (scope-several scope) (inner-scope scope :several nil) scope))

(defun multiple-values-scope (scope)
  "Return a scope like SCOPE for an expression of which all values are used."
  (inner-scope scope :several t))

(defun check-lexical-variables (variables environment)
  (let ((variable (find-if (lambda (variable) (task-variable-p variable environment)) variables)))
    (when variable
      (reject-clause (text-title) variable
                     "a lexical variable's name; bind task variables by with-task-variables"))))

(defun variable-scope (scope variables)
  "Return a copy of SCOPE in which VARIABLES are bound in a new environment."
  (check-variables variables (scope-environment scope))
  (check-lexical-variables variables (scope-environment scope))
  (let ((level (1+ (scope-level scope)))
        (special (find-if (lambda (variable)
                            (special-variable-p variable (scope-environment scope)))
                          variables)))
    (when special
      (reject-clause (text-title) special
                     "the name of a lexical variable; this variable is special"))
    (inner-scope (layered-scope scope (list :variables level variables) level
                                :variable (remove-duplicates variables))
                 :fluents (set-difference (scope-fluents scope) variables))))

(defun function-scope (scope names)
  (let ((level (1+ (scope-level scope))))
    (layered-scope scope (list :functions level names) level :function names)))

(defun wrapped-scope (scope wrapping)
  "Return a copy of SCOPE that wraps leaves in WRAPPING, a MACROLET or the like without a body."
  (destructuring-bind (operator definitions) wrapping
    (multiple-value-call #'layered-scope scope (list :wrapping wrapping) (scope-level scope)
      (ecase operator
        (macrolet
         (values :macro (loop for definition in definitions
                              collect (list (first definition)
                                            (macro-expander definition
                                                            (scope-environment scope))))))
        (symbol-macrolet (values :symbol-macro definitions))))))

(defun scope-variables (scope)
  "Return a list of the variables of the plan that are visible in SCOPE."
  (loop for (kind nil names) in (scope-layers scope)
        when (eq kind :variables) append names))

(defun names-by-level (scope)
  "Return lists of the names of the variables in each environment of SCOPE, innermost first."
  (loop for level from (scope-level scope) above 0
        collect (loop for (kind layer-level names) in (scope-layers scope)
                      when (and (eq kind :variables) (= level layer-level))
                        return names)))

;;; How a leaf sees its scope.

(defun element-form (scope level index)
  "Return a form for element INDEX of the environment made at LEVEL, for use in a leaf of SCOPE."
  `(svref ,(loop with form = (scope-variable scope)
                 repeat (- (scope-level scope) level)
                 do (setf form `(the simple-vector (svref ,form 0)))
                 finally (return form))
          ,index))

(defun environment-form (scope level)
  (second (element-form scope level 0)))

(defun layer-wrapping (layer scope)
  "Return a form that makes LAYER visible in a leaf of SCOPE. The caller appends the body."
  (destructuring-bind (kind &rest parts) layer
    (ecase kind
      (:variables
       (destructuring-bind (level variables) parts
         `(symbol-macrolet
              ,(remove-duplicates
                (loop for variable in variables
                      for index from 1
                      collect (list variable (element-form scope level index)))
                :key #'first))))
      (:functions
       (destructuring-bind (level names) parts
         `(flet ,(loop for name in names
                       for index from 1
                       collect `(,name (&rest arguments)
                                  (declare (dynamic-extent arguments))
                                  (apply (the function ,(element-form scope level index))
                                         arguments)))
            (declare (ignorable ,@(loop for name in names collect `(function ,name)))))))
      (:wrapping (first parts)))))

(defun wrap-for-leaf (form scope)
  (dolist (layer (scope-layers scope) form)
    (unless (equal (cddr layer) '(()))  ; no variables
      (setf form `(,@(layer-wrapping layer scope) ,form)))))

(defvar *current-source-form* nil
  "The innermost form of the source text around the form that is being compiled, or NIL.")

(defun add-source-location (form)
  "Give FORM the location of the current source form, of which FORM has parts. Return FORM."
  (labels ((place (form depth)
             (when (and (consp form) (plusp depth) (not (has-source-location-p form)))
               (copy-source-location form *current-source-form*)
               (loop for tail = form then (rest tail)
                     repeat 8
                     while (consp tail)
                     do (place (first tail) (1- depth))))))
    (when (has-source-location-p *current-source-form*) (place form 12)))
  form)

(defun leaf-lambda (form scope &rest parameters)
  (add-source-location
   `(lambda (,(scope-variable scope) ,@parameters)
      (declare (type simple-vector ,(scope-variable scope)) (ignorable ,(scope-variable scope)))
      ,(wrap-for-leaf form scope))))
