;;;; calling.lisp -- calling plans from plans, and which plans a plan calls.

(in-package :ars-magna.rpl.language)

(export '(name-without-quote-p check-plan-quote enter-application))

;;; Calling. CALLER is compiled from the call's arguments: it takes the environment and a function,
;;; either the procedure's entry or a Lisp function, and calls that with them.

(define-expression call
  "A call, with COUNT arguments, of a procedure or of a function that the compiler does not know."
  (:parts (procedure procedure) (count fixnum) (caller function))
  (:steps
   (begin
    (cond ((procedure-usable-p procedure)
           (next inside)
           (record-call-depth task frame)
           (enter (the node (procedure-body procedure))
                  (funcall caller environment (entry-for-arity procedure count))
                  frame))
          (t (values (frame-up frame)
                     (multiple-value-call #'bundle-several-values
                       (funcall caller environment
                                (lisp-function (procedure-name procedure))))))))
   (inside (values (frame-up frame) value))))

(defun call-code (form scope)
  "Return code for FORM, a call of a procedure or unknown function, whose arguments do not wait."
  (let* ((local (cdr (assoc (first form) (scope-procedures scope))))
         (arguments (loop for argument in (rest form) collect (as-lisp argument scope)))
         (outer (and local (list (environment-form scope (second local))))))
    (check-call form scope)
    `(make-call :form ',(form-as-written form)
                :count ,(length arguments)
                :procedure ,(if local (first local) `(ensure-procedure ',(first form)))
                :caller ,(leaf-lambda `(funcall %function ,@outer ,@arguments) scope
                                      '%function))))

(defun name-without-quote-p (name scope)
  "True if NAME, a form in SCOPE, is a symbol that is not a variable."
  (and name
       (symbolp name)
       (not (constantp name))
       (not (known-variable-p name (scope-environment scope)))))

(defun check-plan-quote (plan form scope)
  "Warn if PLAN, an argument in FORM, is the unquoted name of a plan and no variable in SCOPE."
  (when (and (name-without-quote-p plan scope) (procedure-name-p plan))
    (style-warn-of-plan-text form "~(~A~) is a plan, not a variable. Quote its name: '~:*~(~A~)."
                             plan)))

(define-construct call-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or its name, with ARGUMENTS as part of a plan; return its values."
  (:arguments plan &rest arguments)
  (:parts (entry function (progn (check-plan-quote plan form scope)
                                 (value-lambda `(enter-plan ,plan ,@arguments) scope))))
  (:steps
   (begin
    (next inside)
    (record-call-depth task frame)
    (multiple-value-bind (body environment) (funcall entry environment)
      (enter (the node body) environment frame)))
   (inside (values (frame-up frame) value))))

;;; How deep the calls are in each other is kept in the memory of a call's frame.

(addition *plan-depth-limit*)
(defparameter *plan-depth-limit* 2000
  "The largest depth of nested calls of plans, a number from 1. The depth also counts calls across
tasks. A deeper call fails with class :TOO-DEEP. The limit stops endless recursion.")

(defun call-depth (task frame)
  "Return the depth of the innermost call around FRAME of TASK; 0 if there is no call around FRAME."
  (loop
    (loop for each = frame then (frame-up each)
          while each
          do (when (or (call-p (frame-node each)) (call-plan-node-p (frame-node each)))
               (when (frame-data each) (return-from call-depth (frame-data each)))))
    (setf task (task-parent task))
    (unless task (return 0))
    (setf frame (task-frame task))))

(defun record-call-depth (task frame)
  "Record the depth of the call of FRAME, or let TASK fail if the depth is too large."
  (let ((depth (1+ (the fixnum (call-depth task (frame-up frame))))))
    (when (> depth *plan-depth-limit*)
      (fail :class :too-deep :depth depth :limit *plan-depth-limit*
            :remedy "See to it that the plan ends, or set *plan-depth-limit*"))
    (setf (frame-data frame) depth)))

;;; Calling Lisp.

(defun lisp-function (name)
  (if (and (fboundp name) (not (macro-function name)))
      (fdefinition name)
      (reject-unknown-call name)))

(defun reject-unknown-call (name)
  (let ((remedy (unknown-call-remedy name)))
    (when remedy (reject-use "There is no plan procedure or function ~A" remedy))
    (reject-name "plan procedure or function" name (procedure-names-to-offer)
                 (known-operators (or (symbol-package name) *package*)))))

;;;; Calls with a list of arguments

(defstruct (application (:include call-plan-node) (:copier nil))
  "A call of a plan with a list of arguments. Its environment contains the plan and the list.")

(define-global +application+
    (make-application :form '(call-plan)
                      :entry (lambda (environment)
                               (apply #'enter-plan (svref environment 1) (svref environment 2))))
  "The only object of type APPLICATION.")

(defmethod current-form ((node application) frame)
  (destructuring-bind (plan arguments) (rest (coerce (frame-environment frame) 'list))
    (let ((name (if (procedure-p plan) (procedure-name plan) plan)))
      (if name
          (list* name arguments)
          (list* 'call-plan plan arguments)))))

(defun enter-application (plan arguments frame)
  "Begin PLAN, a procedure or its name, with ARGUMENTS, for FRAME. Return what a step returns."
  (enter +application+ (vector (frame-environment frame) plan arguments) frame))

(define-construct apply-plan (plan arguments)
  "Run PLAN, a plan procedure or its name, with the list ARGUMENTS as part of a plan; return the
values of PLAN. (APPLY-PLAN is to CALL-PLAN what APPLY is to FUNCALL.)"
  (:arguments plan arguments)
  (:parts (plan function (value-lambda plan scope))
          (arguments function (value-lambda arguments scope)))
  (:steps
   (begin
    (next inside)
    (enter-application (funcall plan environment) (funcall arguments environment) frame))
   (inside (values (frame-up frame) value))))

;;; Calls in Lisp code, and those of plans that are only known when they are called, do not show.

(addition called-procedures)
(defun called-procedures (procedure)
  "Return a list of the plan procedures that the plan procedure PROCEDURE calls by name."
  (let ((seen (make-hash-table :test 'eq))
        (called '()))
    (labels ((visit (part)
               (unless (or (not (typep part 'node)) (gethash part seen))
                 (setf (gethash part seen) t)
                 (when (call-p part) (pushnew (call-procedure part) called))
                 (mapc #'visit (node-parts part)))))
      (visit (procedure-body procedure))
      (reverse called))))
