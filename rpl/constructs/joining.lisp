;;;; joining.lisp -- join-task: waiting for another task's end.

(in-package :ars-magna.rpl.constructs)

(defun over-p (status)
  "True if STATUS, of a task, is one that lasts."
  (and (member status '(:succeeded :failed :evaporated)) t))

(defun checked-other (target task)
  "Return TARGET, which TASK wants to wait for. Signals WRONG-ARGUMENT and MISUSE."
  (check-argument join-task target (task-p target) "a task, such as the name of a :tag")
  (when (part-of-p task target)
    (reject-use "~A would wait for itself: it is part of ~A." (task-label task)
                (task-label target)))
  target)

(defun pass-on-outcome (target task frame)
  "Let TASK at FRAME go on as TARGET ended. Return what a step returns."
  (let ((result (task-result target)))
    (cond ((eq :failed (task-state target)) (unwind task (frame-up frame) result))
          (t (values (frame-up frame)
                     (and (eq :succeeded (task-state target)) (not (escape-p result)) result))))))

(define-construct join-task (task)
  "Wait in a plan until TASK is over, not at all if it is, and return its value; fail as it failed.
Of a task that evaporated or was left, return NIL (CRAM's; the last is ours)."
  (:arguments task)
  (:parts (target function (value-lambda task scope)))
  (:steps
   (begin
    (let ((target (checked-other (funcall target environment) task)))
      (cond ((task-over-p target) (pass-on-outcome target task frame))
            (t (next over)
               (setf memory target)
               (wait-until-heard task (fl-funcall 'over-p (task-status target)))
               +parked+))))
   (over (pass-on-outcome memory task frame))))
