;;;; failing.lisp -- fail.

(in-package :ars-magna.rpl.constructs)

(define-node failing ((arguments function))
  "Fail as FAIL would with the list that ARGUMENTS of the environment returns."
  :step step-failing)

(defun step-failing (node task frame value)
  (declare (ignore value))
  (let ((failure (make-failure (funcall (failing-arguments node) (frame-environment frame)))))
    (unwind task frame (failure-of failure task frame))))

(define-plan-form "FAIL" :may (&rest arguments) (form scope)
  (if (some (lambda (argument) (suspends-p argument scope)) arguments)
      (hoisted-code form scope)
      `(make-failing :form ',form :arguments ,(value-lambda `(list ,@arguments) scope))))
