;;;; calling.lisp -- calling plans from plans.

(in-package :ars-magna.rpl.language)

;;; Calling. CALLER is compiled from the call's arguments: it takes the environment and a function,
;;; either the procedure's entry or a Lisp function, and calls that with them.

(define-expression call
  "A call of a procedure, or of a Lisp function that was unknown when the plan was compiled."
  (:parts (procedure procedure) (caller function))
  (:steps
   (begin
    (cond ((defined-p procedure)
           (next inside)
           (enter (the node (procedure-body procedure))
                  (funcall caller environment (procedure-entry procedure))
                  frame))
          (t (values (frame-up frame)
                     (multiple-value-call #'bundle-up
                       (funcall caller environment
                                (lisp-function (procedure-name procedure))))))))
   (inside (values (frame-up frame) value))))

(define-construct call-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or the name of one, with ARGUMENTS as part of a plan; return its
value."
  (:arguments plan &rest arguments)
  (:parts (entry function (value-lambda `(enter-plan ,plan ,@arguments) scope)))
  (:steps
   (begin
    (next inside)
    (multiple-value-bind (body environment) (funcall entry environment)
      (enter (the node body) environment frame)))
   (inside (values (frame-up frame) value))))

(defun lisp-function (name)
  (if (and (fboundp name) (not (macro-function name)))
      (fdefinition name)
      (reject-call name)))

(defun reject-call (name)
  "Signal that there is neither a plan nor a function to call by NAME."
  (let ((namesake (find-procedure name nil)))
    (when namesake
      (reject-use "There is no plan procedure or function ~S. Calls go by the very symbol: if the ~
                   plan ~:*~A of another package is meant, write ~S."
                  name (procedure-name namesake)))
    (reject-name "plan procedure or function" name (mapcar #'procedure-name (all-procedures)))))
