;;;; applying.lisp -- apply-plan: calling a plan with a list of arguments.

(in-package :ars-magna.rpl.constructs)

(define-construct apply-plan (plan arguments)
  "Run PLAN, a plan procedure or the name of one, with the list ARGUMENTS as part of a plan; return
its values. (Ours: what APPLY is to FUNCALL, it is to CALL-PLAN.)"
  (:arguments plan arguments)
  (:parts (plan function (value-lambda plan scope))
          (arguments function (value-lambda arguments scope)))
  (:steps
   (begin
    (next called)
    (multiple-value-bind (body inner)
        (apply #'enter-plan (funcall plan environment) (funcall arguments environment))
      (enter (the node body) inner frame)))
   (called (values (frame-up frame) value))))
