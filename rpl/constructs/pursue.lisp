;;;; pursue.lisp -- side by side until the first ends.

(in-package :ars-magna.rpl.constructs)

(define-construct pursue (&body branches)
  "Run BRANCHES in a plan side by side. Succeed as soon as one does, with its value; fail as soon as
one fails. Evaporate the others (manual D.4; reading 185)."
  (:manual)
  (:like par)
  (:child-ended
   (cond ((fail-or-escape task how result))
         ((eq how :succeeded) (complete task result))
         (t (complete-when-alone task nil)))))
