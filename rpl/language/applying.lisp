;;;; applying.lisp -- apply-plan: calling a plan with a list of arguments.

(in-package :ars-magna.rpl.language)

(export '(enter-application))

(defstruct (application (:include call-plan-node) (:copier nil))
  "A call of the plan and with the list of arguments that are the variables of its environment.")

(define-global +application+
    (make-application :form '(call-plan)
                      :entry (lambda (environment)
                               (apply #'enter-plan (svref environment 1) (svref environment 2))))
  "The one application that there is.")

(defmethod current-form ((node application) frame)
  (destructuring-bind (plan arguments) (rest (coerce (frame-environment frame) 'list))
    (let ((name (if (procedure-p plan) (procedure-name plan) plan)))
      (if name
          (list* name arguments)
          (list* 'call-plan plan arguments)))))

(defun enter-application (plan arguments frame)
  "Begin PLAN, a procedure or its name, with the list ARGUMENTS for FRAME. Return what a step
returns."
  (enter +application+ (vector (frame-environment frame) plan arguments) frame))

(define-construct apply-plan (plan arguments)
  "Run PLAN, a plan procedure or the name of one, with the list ARGUMENTS as part of a plan; return
its values. (Ours: what APPLY is to FUNCALL, it is to CALL-PLAN.)"
  (:arguments plan arguments)
  (:parts (plan function (value-lambda plan scope))
          (arguments function (value-lambda arguments scope)))
  (:steps
   (begin
    (next inside)
    (enter-application (funcall plan environment) (funcall arguments environment) frame))
   (inside (values (frame-up frame) value))))
