;;;; looking.lisp -- a rollout once more, to be looked at.

(in-package :ars-magna.rpl-projecting)

(defun call-with-rollout (function rollout &key print)
  "Call FUNCTION where ROLLOUT, run again, has ended; see WITH-ROLLOUT."
  (check-argument with-rollout rollout (rollout-p rollout)
                  "a rollout, as PROJECTION-ROLLOUTS returns")
  (roll-out (rollout-scene rollout) (rollout-trial rollout) (rollout-seed rollout)
            :print print
            :then (lambda (again)
                    (declare (ignore again))
                    (let ((*rolling-out* nil)) (funcall function)))))

(addition with-rollout)
(define-user-macro with-rollout ((rollout &key print) &body body)
  "Run BODY where ROLLOUT, of a projection, has ended: it is run again, just as it went, from the
moment in which it began, and BODY finds itself in that run, as in WITH-FORK, with its robots,
things and messages. What plans write before that is lost unless PRINT is true. Return the values of
BODY. Signals WRONG-ARGUMENT."
  `(call-with-rollout (lambda () ,@body) ,rollout :print ,print))
