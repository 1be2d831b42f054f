;;;; task-variables.lisp -- define-task-variable and with-task-variables.

(in-package :ars-magna.rpl.constructs)

(defun check-task-variable (name)
  (unless (or (task-variable-p name)
              (and (symbolp name) (variable-name-p name)
                   (not (eq :special (variable-kind name)))))
    (reject-clause (definition-title "define-task-variable" name) name
                   "a symbol that is not yet a variable and belongs to no locked package")))

(addition define-task-variable)
(define-user-macro define-task-variable (name value &optional documentation)
  "Define NAME as a variable with a separate value for each task. If a task sets the variable, only
this task and the tasks it starts see the new value. In other tasks the value is VALUE, or the value
set outside of plans. WITH-TASK-VARIABLES binds the variable. (A special variable belongs to the
whole thread, and LET cannot bind it around forms that wait.) Functions that plans call see the
variable too, if they are compiled after its definition. Evaluating the definition again sets the
value, as DEFPARAMETER does. (From CRAM, except for setting the variable in a task.)"
  (check-task-variable name)
  (unless (typep documentation '(or null string))
    (reject-clause (definition-title "define-task-variable" name) documentation
                   "(define-task-variable name value [string])"))
  `(progn
     (eval-when (:compile-toplevel :load-toplevel :execute)
       (define-symbol-macro ,name (task-variable ',name)))
     (install-task-variable ',name ,value ,documentation)))

(defun checked-bindings (bindings form scope)
  (dolist (binding bindings bindings)
    (unless (and (typep binding '(cons symbol (cons t null)))
                 (task-variable-p (first binding) (scope-environment scope)))
      (reject-clause (text-title) form
                     "bindings (name value) of variables defined by define-task-variable"))))

(define-construct with-task-variables (bindings &body body)
  "Run BODY in a plan with BINDINGS, each (name value), of task variables. The bindings hold for the
task that runs BODY and for the tasks it starts, until BODY ends in any way. All values are computed
before any variable is bound. Return the value of BODY (after CRAM's task variables)."
  (:arguments &rest (mapcar #'second (checked-bindings bindings form scope)))
  (:parts (variables list `',(mapcar #'first bindings))
          (values-of function (value-lambda `(list ,@(mapcar #'second bindings)) scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (let ((cells (mapcar #'cons variables (funcall values-of environment))))
      (next inside)
      (setf memory (make-task-bindings cells))
      (enter body environment frame)))
   (inside (values (frame-up frame) value))))
