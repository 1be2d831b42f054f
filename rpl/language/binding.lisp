;;;; binding.lisp -- variables and local functions of a plan.

(in-package :ars-magna.rpl.language)

;;; Every time a binding form is run it makes a new environment: a vector of the environment around
;;; it and the variables. So what is true of Lisp's bindings is true here: closures made by leaves
;;; keep theirs, and the branches of a PAR-LOOP have each their own.

(define-node binding ((fill function) (body node))
  "BODY run in the environment that FILL returns."
  :step step-binding)

(defun step-binding (node task frame value)
  (declare #.*hot* (ignore task value) (type binding node) (type frame frame))
  (enter-last (binding-body node)
              (the simple-vector (funcall (binding-fill node) (frame-environment frame)))
              frame))

(define-node filling ((parts simple-vector) (sequential t) (body node))
  "BODY run in an environment of the values of PARTS, some of which may wait."
  :step step-filling)

(defun step-filling (node task frame value)
  (declare (ignore task))
  (let* ((parts (filling-parts node))
         (i (frame-counter frame))
         (inner (or (frame-data frame)
                    (setf (frame-data frame)
                          (make-array (1+ (length parts)) :initial-element nil)))))
    (declare (type simple-vector inner))
    (if (zerop i)
        (setf (svref inner 0) (frame-environment frame))
        (setf (svref inner i) (single-value value)))
    (setf (frame-counter frame) (1+ i))
    (if (< i (length parts))
        (enter (the node (svref parts i))
               (if (filling-sequential node) inner (frame-environment frame))
               frame)
        (enter-last (filling-body node) inner frame))))

(defun binding-variable (binding) (if (consp binding) (first binding) binding))
(defun binding-value (binding) (if (consp binding) (second binding) nil))

(defun binds-special-p (variables body scope)
  "True if a form that binds VARIABLES around BODY binds one of them as a special variable."
  (or (declared-special variables body)
      (some (lambda (variable) (special-variable-p variable (scope-environment scope)))
            variables)))

(defun fill-lambda (values scopes sequential)
  "Return the lambda expression that makes an environment of the forms VALUES, each in its scope."
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
  "Return SCOPE with VARIABLES bound, as by BINDINGS around BODY, in turn if SEQUENTIAL."
  (let ((inner (variable-scope scope variables)))
    (inner-scope inner :fluents (append (bound-to-fluents bindings body scope sequential)
                                        (scope-fluents inner)))))

(defun binding-code (form bindings body scope sequential)
  "Return code for FORM, a LET or, if SEQUENTIAL, a LET*."
  (let* ((bindings (untyped-bindings bindings (operator-text form)))
         (variables (mapcar #'binding-variable bindings))
         (values (mapcar #'binding-value bindings))
         (single (single-scope scope))
         (scopes (loop for i from 0 below (length bindings)
                       collect (if sequential
                                   (variable-scope single (subseq variables 0 i))
                                   single))))
    (check-use variables (list* (and sequential values) body) form)
    (cond ((null bindings) (binding-body-code body scope))
          ((binds-special-p variables body scope) (refuse-code form scope))
          (t (let ((body-code (binding-body-code
                               body (binding-scope scope variables bindings body
                                              sequential))))
               (if (some #'suspends-p values scopes)
                   `(make-filling :form ',form
                                  :parts (vector ,@(mapcar #'plan-code values scopes))
                                  :sequential ,sequential
                                  :body ,body-code)
                   `(make-binding :form ',form
                                  :fill ,(fill-lambda values scopes sequential)
                                  :body ,body-code)))))))

(define-plan-form "LET" nil (bindings &rest body) (form scope)
  (binding-code form bindings body scope nil))

(define-plan-form "LET*" nil (bindings &rest body) (form scope)
  (binding-code form bindings body scope t))

;;; Several values.

(define-node value-binding ((count fixnum) (source node) (body node))
  "BODY run in an environment of the first COUNT values of SOURCE."
  :step step-value-binding)

(defun step-value-binding (node task frame value)
  (declare (ignore task))
  (cond ((zerop (frame-counter frame))
         (setf (frame-counter frame) 1)
         (enter (value-binding-source node) (frame-environment frame) frame))
        (t (let ((inner (make-array (1+ (value-binding-count node)) :initial-element nil)))
             (setf (svref inner 0) (frame-environment frame))
             (replace inner (if (bundle-p value) (bundle-values value) (list value)) :start1 1)
             (enter-last (value-binding-body node) inner frame)))))

(define-plan-form "MULTIPLE-VALUE-BIND" nil (variables source &rest body) (form scope)
  (check-use variables body form)
  (if (binds-special-p variables body scope)
      (refuse-code form scope)
      `(make-value-binding :form ',form
                           :count ,(length variables)
                           :source ,(plan-code source (several-scope scope))
                           :body ,(binding-body-code body (variable-scope scope variables)))))
