;;;; steps.lisp -- one thing after the other: seq, progn and forms that stand for their contents.

(in-package :ars-magna.rpl.language)

(define-node steps ((parts simple-vector))
  "Expressions, at least one, run in order. COUNTER counts those begun."
  :step step-steps)

(document-functions
  steps-parts "Return the vector of the nodes that are run one after the other.")

(declaim (inline enter-last))
(defun enter-last (node environment frame)
  "Begin NODE as the last thing that FRAME does."
  (let ((up (frame-up frame)))
    (if (leaf-p node)
        (values up (funcall (leaf-function node) environment))
        (values (make-frame node environment up) nil))))

(defun step-steps (node task frame value)
  (declare #.*hot* (ignore task value) (type steps node) (type frame frame))
  (let* ((parts (steps-parts node))
         (i (frame-counter frame))
         (environment (frame-environment frame)))
    (setf (frame-counter frame) (1+ i))
    (cond ((< (1+ i) (length parts)) (enter (the node (svref parts i)) environment frame))
          (t (enter-last (the node (svref parts i)) environment frame)))))

(defmethod current-form ((node steps) frame)
  (let ((i (frame-counter frame)))
    (if (plusp i)
        (node-form (svref (steps-parts node) (1- i)))
        (node-form node))))

(public seq)
(defmacro seq (&body steps)
  "Run STEPS in order and return the value of the last one; fail as soon as one fails. Policies
get their chance between steps. In ordinary Lisp, PROGN (manual D.2)."
  `(progn ,@steps))

(define-plan-form "SEQ" :may (&rest steps) (form scope)
  (body-code steps scope))

(define-plan-form "PROGN" nil (&rest steps) (form scope)
  (body-code steps scope))

(define-plan-form "LOCALLY" nil (&rest steps) (form scope)
  (if (declared-special (scope-variables scope) steps)
      (refuse-code form scope)
      (binding-body-code steps scope)))

(define-plan-form "THE" nil (type part) (form scope)
  (declare (ignore type))
  (plan-code part scope))

(define-plan-form "SETQ" nil (&rest pairs) (form scope)
  (if (cddr pairs)
      (body-code (loop for (variable value) on pairs by #'cddr
                       collect (note-own-text `(setq ,variable ,value)))
                 scope)
      (hoisted-code form scope 2)))

(define-plan-form "CALL-PLAN" :must (&rest arguments) (form scope)
  (if (some (lambda (argument) (suspends-p argument scope)) arguments)
      (hoisted-code form scope)
      `(make-plan-call :form ',form
                       :enter ,(value-lambda `(enter-plan ,@arguments) scope))))
