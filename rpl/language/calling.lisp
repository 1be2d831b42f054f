;;;; calling.lisp -- calling plans from plans.

(in-package :ars-magna.rpl.language)

;;; Calling. CALLER is compiled from the call's arguments: it takes the environment and a function,
;;; either the procedure's entry or a Lisp function, and calls that with them.

(define-node call ((procedure procedure) (caller function))
  "A call of a procedure, or of a Lisp function that was unknown when the plan was compiled."
  :step step-call)

(defun step-call (node task frame value)
  (declare (ignore task))
  (let ((procedure (call-procedure node))
        (caller (call-caller node))
        (environment (frame-environment frame)))
    (cond ((plusp (frame-counter frame)) (values (frame-up frame) value))
          ((defined-p procedure)
           (setf (frame-counter frame) 1)
           (enter (the node (procedure-body procedure))
                  (funcall caller environment (procedure-entry procedure))
                  frame))
          (t (values (frame-up frame)
                     (multiple-value-call #'bundle-up
                       (funcall caller environment
                                (lisp-function (procedure-name procedure)))))))))

(defun bundle-up (&optional value &rest more)
  "Return the values it is called with as one object."
  (if more (make-bundle (cons value more)) value))

(define-node plan-call ((enter function))
  "A call of a plan that is known when it happens: ENTER of the environment returns its body and the
environment for that."
  :step step-plan-call)

(defun step-plan-call (node task frame value)
  (declare (ignore task))
  (cond ((plusp (frame-counter frame)) (values (frame-up frame) value))
        (t (setf (frame-counter frame) 1)
           (multiple-value-bind (body environment)
               (funcall (plan-call-enter node) (frame-environment frame))
             (enter (the node body) environment frame)))))

(addition call-plan)
(defmacro call-plan (plan &rest arguments)
  "Run PLAN, a plan procedure or the name of one, with ARGUMENTS as part of a plan; return its
value."
  (misplaced 'call-plan (list* plan arguments)))

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
