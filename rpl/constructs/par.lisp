;;;; par.lisp -- par, and what all constructs with branches side by side have in common.

(in-package :ars-magna.rpl.constructs)

;;; The task that runs one of these starts a child for each branch, in order, and waits. When the
;;; outcome is known the children that are left evaporate, newest first, and when all are gone the
;;; task goes on.
;;;
;;; A branch that others than the construct have evaporated counts as ended, neither well nor badly.

(defun branches-code (branches scope)
  `(vector ,@(loop with single = (single-scope scope)
                   for branch in branches
                   collect (plan-code branch single))))

(defun start-branches (branches task environment)
  "Start each of BRANCHES as a part of TASK, which then waits. Return what a step returns."
  (loop for branch across branches
        for index from 0
        do (start-branch branch task environment index (task-level task)))
  (await-parts task))

(defun await-parts (task)
  "Let TASK wait for its parts. Return what a step returns."
  (park task nil)
  +parked+)

(define-construct par (&body branches)
  "Run BRANCHES in a plan side by side. Succeed when all have, with the value of the last one, one
as of every task; fail as soon as one fails, and evaporate the others (manual D.7)."
  (:manual)
  (:parts (branches simple-vector (branches-code branches scope)))
  (:steps
   (begin
    (next inside)
    (if (plusp (length branches))
        (start-branches branches task environment)
        (values (frame-up frame) nil)))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (when (= (1+ (task-index child)) (length branches))
       (setf memory result))
     (complete-when-alone task memory))))
