;;;; binding.lisp -- variables, local functions and local macros of a plan.

(in-package :ars-magna.rpl.language)

;;; Every time a binding form is run it makes a new environment: a vector of the environment around
;;; it and the variables. So what is true of Lisp's bindings is true here: closures made by leaves
;;; keep theirs, and the branches of a PAR-LOOP have each their own.

(define-expression binding
  "Runs BODY in the environment that the function FILL returns."
  (:hot)
  (:parts (fill function) (body node))
  (:step (enter-tail body (the simple-vector (funcall fill environment)) frame)))

(define-expression filling
  "Runs BODY in an environment of the values of PARTS, some of which may wait. The frame's counter
says how many parts have begun; its memory is the new environment."
  (:parts (parts simple-vector) (sequential t) (body node))
  (:step
   (let ((i (frame-counter frame))
         (inner (or memory
                    (setf memory (make-array (1+ (length parts)) :initial-element nil)))))
     (declare (type simple-vector inner))
     (setf (svref inner i) (if (zerop i) environment (single-value value))
           (frame-counter frame) (1+ i))
     (if (< i (length parts))
         (enter (the node (svref parts i)) (if sequential inner environment) frame)
         (enter-tail body inner frame)))))

(defun binds-special-p (variables body scope)
  (or (variables-declared-special variables body)
      (some (lambda (variable) (special-variable-p variable (scope-environment scope)))
            variables)))

(defun environment-lambda (values scopes sequential)
  "Return a lambda expression that makes an environment from VALUES, forms in SCOPES."
  (if sequential
      (let ((inner (scope-variable (first scopes))))
        `(lambda (outer)
           (let ((,inner (make-array ,(1+ (length values)) :initial-element nil)))
             (setf (svref ,inner 0) outer)
             ,@(loop for value in values
                     for scope in scopes
                     for i from 1
                     collect `(setf (svref ,inner ,i)
                                    ,(wrap-for-leaf (as-lisp value scope) scope)))
             ,inner)))
      (leaf-lambda `(vector ,(scope-variable (first scopes))
                            ,@(loop for value in values
                                    for scope in scopes
                                    collect (as-lisp value scope)))
                   (first scopes))))

(defun binding-scope (scope variables bindings body sequential)
  (let ((inner (variable-scope scope variables)))
    (inner-scope inner :fluents (append (variables-bound-to-fluents bindings body scope sequential)
                                        (scope-fluents inner)))))

(defun binding-code (form bindings body scope sequential)
  "Return code for FORM, a LET. If SEQUENTIAL is true, FORM is a LET*."
  (let* ((bindings (untyped-bindings bindings (operator-text form)))
         (variables (loop for binding in bindings
                          collect (if (consp binding) (first binding) binding)))
         (values (loop for binding in bindings collect (second (ensure-list binding))))
         (single (single-value-scope scope))
         (scopes (loop for i from 0 below (length bindings)
                       collect (if sequential
                                   (variable-scope single (subseq variables 0 i))
                                   single))))
    (unless sequential (check-distinct-variables variables form))
    (cond ((null bindings) (binding-body-code body scope))
          ((binds-special-p variables body scope) (leaf-code-or-reject form scope))
          (t (warn-of-unused-bindings variables (list* (and sequential values) body) form)
             (let ((body-code (binding-body-code
                               body (binding-scope scope variables bindings body
                                              sequential))))
               (if (some #'suspends-p values scopes)
                   `(make-filling :form ',(form-as-written form)
                                  :parts (vector ,@(mapcar #'plan-code values scopes))
                                  :sequential ,sequential
                                  :body ,body-code)
                   `(make-binding :form ',(form-as-written form)
                                  :fill ,(environment-lambda values scopes sequential)
                                  :body ,body-code)))))))

(define-plan-form "LET" nil (bindings &rest body) (form scope)
  (binding-code form bindings body scope nil))

(define-plan-form "LET*" nil (bindings &rest body) (form scope)
  (binding-code form bindings body scope t))

;;; Several values.

(define-expression value-binding
  "Runs BODY in an environment of the first COUNT values of SOURCE."
  (:parts (count fixnum) (source node) (body node))
  (:steps
   (begin
    (next getting-values)
    (enter source environment frame))
   (getting-values
    (let ((inner (make-array (1+ count) :initial-element nil)))
      (setf (svref inner 0) environment)
      (replace inner (if (bundle-p value) (bundle-values value) (list value)) :start1 1)
      (enter-tail body inner frame)))))

(define-plan-form "MULTIPLE-VALUE-BIND" nil (variables source &rest body) (form scope)
  (check-distinct-variables variables form)
  (cond ((binds-special-p variables body scope) (leaf-code-or-reject form scope))
        (t (warn-of-unused-bindings variables body form)
           `(make-value-binding :form ',(form-as-written form)
                                :count ,(length variables)
                                :source ,(plan-code source (multiple-values-scope scope))
                                :body ,(binding-body-code body
                                                          (variable-scope scope variables))))))

;;; A local function whose body waits becomes a separate procedure, which only plans can call;
;;; others are Lisp functions, kept in an environment. One that may wait (see SUSPENSION) becomes a
;;; procedure unless its name is also used as #'name.

(defun entry-lambda (parameters scope outer)
  "Return a lambda expression that takes arguments for PARAMETERS and returns the environment for a
procedure's body. If OUTER is true, the first argument is the environment around the procedure."
  (let ((make `(vector ,(and outer (scope-variable scope))
                       ,@(lambda-list-variables parameters))))
    (cond ((not outer)
           (second (as-lisp `(function (lambda ,parameters ,make)) scope)))
          ((intersection parameters lambda-list-keywords)
           (leaf-lambda `(apply ,(as-lisp `(function (lambda ,parameters ,make)) scope) %arguments)
                        scope '&rest '%arguments))
          (t `(lambda (,(scope-variable scope) ,@parameters) ,make)))))

(defun lambda-suspension (parameters body scope)
  (suspension (note-plan-text `(function (lambda ,parameters ,@body))) scope))

(defun check-lambda-list (parameters scope)
  "Signal MISPLACED-SUSPENSION if a default form in PARAMETERS would wait."
  (multiple-value-bind (suspends reason) (lambda-suspension parameters '() scope)
    (when (eq suspends :must)
      (reject-suspension reason (list 'lambda parameters)))))

(defun mentions-function-p (name forms)
  (cond ((atom forms) nil)
        ((equal forms `(function ,name)) t)
        (t (loop for tail on forms
                   thereis (mentions-function-p name (car tail))))))

(defun local-procedure-p (definition scope forms)
  (destructuring-bind (name parameters . body) definition
    (case (lambda-suspension (untyped-lambda-list parameters) body scope)
      (:must t)
      (:may (not (mentions-function-p name forms))))))

(defun local-procedures (definitions scope recursive forms)
  "Return those of DEFINITIONS that must become plan procedures."
  (loop with known = '()
        for scope-now = (if recursive (procedure-scope scope known) scope)
        for found = (remove-if-not (lambda (definition)
                                     (or (member definition known)
                                         (local-procedure-p definition scope-now forms)))
                                   definitions)
        until (or (not recursive) (= (length found) (length known)))
        do (setf known found)
        finally (return found)))

(defun procedure-scope (scope definitions)
  (if definitions
      (inner-scope scope
                   :procedures (append (loop for (name parameters) in definitions
                                             collect (list name (gensym (string name))
                                                           (scope-level scope)
                                                           (untyped-lambda-list parameters)))
                                       (scope-procedures scope))
                   :environment (extended-environment (scope-environment scope)
                                                      :function (mapcar #'first definitions)))
      scope))

(defun procedure-body-code (name form body scope)
  (with-tags-code form (tags-in body) (multiple-values-scope scope)
                  (lambda (scope)
                    (block-code name form scope
                                (lambda (scope) (binding-body-code body scope))))))

(defun local-procedure-code (definition variable scope)
  (destructuring-bind (name parameters . body) definition
    (let ((parameters (untyped-lambda-list parameters (string-downcase name))))
      (check-lambda-list parameters scope)
      `(setf (procedure-lambda-list ,variable) ',parameters
             (procedure-entry ,variable) ,(entry-lambda parameters scope t)
             (procedure-body ,variable)
             ,(procedure-body-code name definition body
                                   (variable-scope scope (lambda-list-variables parameters)))))))

(defun functions-code (form definitions body scope recursive)
  "Return code for FORM, an FLET. If RECURSIVE is true, FORM is a LABELS."
  (let* ((procedures (local-procedures definitions scope recursive (rest form)))
         (functions (set-difference definitions procedures))
         (names (mapcar #'first functions))
         (around (if functions (function-scope scope names) scope))
         (inner (procedure-scope around procedures))
         (outer (if recursive inner (inner-scope scope :level (scope-level around))))
         (variables (loop for (name) in procedures
                          collect (second (assoc name (scope-procedures inner)))))
         (body-code (binding-body-code body inner)))
    `(let ,(loop for (name) in procedures
                 for variable in variables
                 collect `(,variable (make-procedure ',name)))
       ,@(loop for definition in procedures
               for variable in variables
               collect (local-procedure-code definition variable outer))
       ,(if functions
            `(make-binding :form ',(form-as-written form)
                           :fill ,(functions-lambda (first form) functions scope)
                           :body ,body-code)
            body-code))))

(defun functions-lambda (operator definitions scope)
  (let ((definitions (loop for (name parameters . body) in definitions
                           collect (list* name (untyped-lambda-list parameters) body))))
    (leaf-lambda (as-lisp `(,operator ,definitions
                               (vector ,(scope-variable scope)
                                       ,@(loop for (name) in definitions
                                               collect `(function ,name))))
                            scope)
                 scope)))

(define-plan-form "FLET" nil (definitions &rest body) (form scope)
  (functions-code form definitions body scope nil))

(define-plan-form "LABELS" nil (definitions &rest body) (form scope)
  (functions-code form definitions body scope t))

;;; Local macros.

(define-plan-form "MACROLET" nil (definitions &rest body) (form scope)
  (binding-body-code body (wrapped-scope scope `(macrolet ,definitions))))

(define-plan-form "SYMBOL-MACROLET" nil (definitions &rest body) (form scope)
  (binding-body-code body (wrapped-scope scope `(symbol-macrolet ,definitions))))
