;;;; binding.lisp -- variables and local functions of a plan.

(in-package :ars-magna.rpl.language)

;;; Every time a binding form is run it makes a new environment: a vector of the environment around
;;; it and the variables. So what is true of Lisp's bindings is true here: closures made by leaves
;;; keep theirs, and the branches of a PAR-LOOP have each their own.

(define-expression binding
  "BODY run in the environment that FILL returns."
  (:hot)
  (:parts (fill function) (body node))
  (:step (enter-last body (the simple-vector (funcall fill environment)) frame)))

(define-expression filling
  "BODY run in an environment of the values of PARTS, some of which may wait. A frame counts the
parts begun; its memory is the environment to be."
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
         (enter-last body inner frame)))))

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
  (let ((inner (variable-scope scope variables)))
    (inner-scope inner :fluents (append (bound-to-fluents bindings body scope sequential)
                                        (scope-fluents inner)))))

(defun binding-code (form bindings body scope sequential)
  "Return code for FORM, a LET or, if SEQUENTIAL, a LET*."
  (let* ((bindings (untyped-bindings bindings (operator-text form)))
         (variables (loop for binding in bindings
                          collect (if (consp binding) (first binding) binding)))
         (values (loop for binding in bindings collect (second (ensure-list binding))))
         (single (single-scope scope))
         (scopes (loop for i from 0 below (length bindings)
                       collect (if sequential
                                   (variable-scope single (subseq variables 0 i))
                                   single))))
    (unless sequential (check-distinct variables form))
    (cond ((null bindings) (binding-body-code body scope))
          ((binds-special-p variables body scope) (refuse-code form scope))
          (t (check-use variables (list* (and sequential values) body) form)
             (let ((body-code (binding-body-code
                               body (binding-scope scope variables bindings body
                                              sequential))))
               (if (some #'suspends-p values scopes)
                   `(make-filling :form ',(form-as-written form)
                                  :parts (vector ,@(mapcar #'plan-code values scopes))
                                  :sequential ,sequential
                                  :body ,body-code)
                   `(make-binding :form ',(form-as-written form)
                                  :fill ,(fill-lambda values scopes sequential)
                                  :body ,body-code)))))))

(define-plan-form "LET" nil (bindings &rest body) (form scope)
  (binding-code form bindings body scope nil))

(define-plan-form "LET*" nil (bindings &rest body) (form scope)
  (binding-code form bindings body scope t))

;;; Several values.

(define-expression value-binding
  "BODY run in an environment of the first COUNT values of SOURCE."
  (:parts (count fixnum) (source node) (body node))
  (:steps
   (begin
    (next getting-values)
    (enter source environment frame))
   (getting-values
    (let ((inner (make-array (1+ count) :initial-element nil)))
      (setf (svref inner 0) environment)
      (replace inner (if (bundle-p value) (bundle-values value) (list value)) :start1 1)
      (enter-last body inner frame)))))

(define-plan-form "MULTIPLE-VALUE-BIND" nil (variables source &rest body) (form scope)
  (check-distinct variables form)
  (cond ((binds-special-p variables body scope) (refuse-code form scope))
        (t (check-use variables body form)
           `(make-value-binding :form ',(form-as-written form)
                                :count ,(length variables)
                                :source ,(plan-code source (several-scope scope))
                                :body ,(binding-body-code body
                                                          (variable-scope scope variables))))))
