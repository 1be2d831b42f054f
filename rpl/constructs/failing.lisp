;;;; failing.lisp -- fail.

(in-package :ars-magna.rpl.constructs)

(define-expression failing
  "Fail as FAIL would with the list that ARGUMENTS of the environment returns."
  (:parts (arguments function))
  (:step
   (let ((failure (make-failure (funcall arguments environment))))
     (unwind task frame (failure-of failure task frame)))))

(define-plan-form "FAIL" :may (&rest arguments) (form scope)
  (if (some (lambda (argument) (suspends-p argument scope)) arguments)
      (hoisted-code form scope)
      `(make-failing :form ',(form-as-written form)
                      :arguments ,(value-lambda `(list ,@arguments) scope))))
