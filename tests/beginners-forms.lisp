;;;; beginners-forms.lisp -- forms, names and types that are almost right.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Clauses for failures.

(defmacro failure-told (&body plan)
  "Return what is written of a run in which PLAN is carried out."
  `(rover-writes () (driver:run-plan (plan-of ,@plan))))

(test failures.tell-of-clauses-for-classes-like-theirs
  (is-true (has-words-p (failure-told (rpl:handle-failure ((:robot-blockd () 1))
                                        (rpl:fail :class :robot-blocked)))
                        "a clause is for :robot-blockd, but the class is :robot-blocked"))
  (is-true (has-words-p (failure-told (rpl:handle-failure (((or :late :deadline-mised) () 1))
                                        (rpl:with-deadline (2) (rpl:wait-time 5))))
                        "a clause is for :deadline-mised, but the class is"))
  (is (not (search "a clause is for"
                   (failure-told (rpl:handle-failure ((:door-1 () 1) (:lost () 2))
                                   (rpl:fail :class :door-2))))))
  (is-true (has-words-p (princ-to-string
                         (list (rpl:run-plan-alone
                                (plan-of (rpl:handle-failure ((:robot-blockd () 1))
                                           (rpl:fail :robot-blocked))))))
                        "Plan failure :ROBOT-BLOCKED")))
