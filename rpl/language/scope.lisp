;;;; scope.lisp -- what is visible at a place in a plan's text.

(in-package :ars-magna.rpl.language)

(export '(inner-scope scope single-scope variable-scope scope-variables scope))

;;; Variables that a plan binds live in environments, vectors linked by element 0. A leaf is a Lisp
;;; function of the environment at its place; within it each visible variable is a symbol macro for
;;; its element. Local functions live in environments too.

(define-record (scope (:copier copy-scope))
  "What is visible at a place in a plan. The slots that say nothing else map names to the variables,
in the code that builds the plan, that hold their nodes."
  (variable (gensym "ENVIRONMENT") symbol "what leaves call their environment; it is one procedure's
own, so that plans can be written in the leaves of others" :writable)
  (environment nil t "the Lisp environment at the place" :writable :export)
  (level 0 fixnum :writable)
  (layers '() list "how leaves get to see what is visible, innermost first" :writable)
  (blocks '() list "an alist from the names of the blocks around to the variables of their
nodes" :writable :export)
  (tags '() list :writable)
  (procedures '() list :writable)
  (retry nil symbol
         "the variable that holds the node to begin anew at (retry), NIL outside" :writable :export)
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
  "Return SCOPE with LAYER, at LEVEL, as its innermost; macros get to see ADDITIONS."
  (inner-scope scope
               :level level
               :layers (cons layer (scope-layers scope))
               :environment (apply #'extended-environment (scope-environment scope) additions)))

(defun single-scope (scope)
  "Return SCOPE for an expression of which only one value matters."
  (if (scope-several scope) (inner-scope scope :several nil) scope))

(defun several-scope (scope)
  "Return SCOPE for an expression all of whose values matter."
  (inner-scope scope :several t))

(defun check-lexical (variables environment)
  "Signal MALFORMED-DEFINITION if one of VARIABLES is a task variable."
  (let ((variable (find-if (lambda (variable) (task-variable-p variable environment)) variables)))
    (when variable
      (reject-clause (author) variable
                     "the name of a lexical variable; bind this one by with-task-variables"))))

(defun variable-scope (scope variables)
  "Return SCOPE with VARIABLES bound in an environment of their own."
  (check-variables variables (scope-environment scope))
  (check-lexical variables (scope-environment scope))
  (let ((level (1+ (scope-level scope)))
        (special (find-if (lambda (variable)
                            (special-variable-p variable (scope-environment scope)))
                          variables)))
    (when special
      (reject-clause (author) special "the name of a lexical variable; this one is special"))
    (inner-scope (layered-scope scope (list :variables level variables) level
                                :variable (remove-duplicates variables))
                 :fluents (set-difference (scope-fluents scope) variables))))

(defun function-scope (scope names)
  (let ((level (1+ (scope-level scope))))
    (layered-scope scope (list :functions level names) level :function names)))

(defun wrapped-scope (scope wrapping &rest additions)
  "Return SCOPE with WRAPPING, a form to be completed by a body, around leaves; macros get to see
ADDITIONS."
  (apply #'layered-scope scope (list :wrapping wrapping) (scope-level scope) additions))

(defun scope-variables (scope)
  "Return the variables of the plan that are visible in SCOPE."
  (loop for (kind nil names) in (scope-layers scope)
        when (eq kind :variables) append names))

(defun names-by-level (scope)
  "Return a list of lists: the variables in each environment of SCOPE, innermost first."
  (loop for level from (scope-level scope) above 0
        collect (loop for (kind layer-level names) in (scope-layers scope)
                      when (and (eq kind :variables) (= level layer-level))
                        return names)))

;;; How a leaf sees its scope.

(defun element-form (scope level index)
  "Return the form, within a leaf of SCOPE, for element INDEX of the environment made at LEVEL."
  `(svref ,(loop with form = (scope-variable scope)
                 repeat (- (scope-level scope) level)
                 do (setf form `(the simple-vector (svref ,form 0)))
                 finally (return form))
          ,index))

(defun environment-form (scope level)
  "Return the form, within a leaf of SCOPE, for the environment made at LEVEL."
  (second (element-form scope level 0)))

(defun layer-wrapping (layer scope)
  "Return the form, to be completed by a body, that makes LAYER visible in a leaf of SCOPE."
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

(defvar *form-at-hand* nil
  "The innermost form around, of those in the source that is being compiled, or NIL.")

(defun place-made (form)
  "Let what has been made around parts of the form at hand stand where that does, so that the
compiler tells of that and not of what was made. Return FORM."
  (labels ((place (form depth)
             (when (and (consp form) (plusp depth) (not (in-source-p form)))
               (keep-place form *form-at-hand*)
               (loop for tail = form then (rest tail)
                     repeat 8
                     while (consp tail)
                     do (place (first tail) (1- depth))))))
    (when (in-source-p *form-at-hand*) (place form 12)))
  form)

(defun leaf-lambda (form scope &rest parameters)
  "Return the lambda expression for FORM in SCOPE: it takes the environment and PARAMETERS."
  (place-made
   `(lambda (,(scope-variable scope) ,@parameters)
      (declare (type simple-vector ,(scope-variable scope)) (ignorable ,(scope-variable scope)))
      ,(wrap-for-leaf form scope))))
