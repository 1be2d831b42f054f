;;;; blocking.lisp -- with-task-blocked: keeping another task from running for a while.

(in-package :ars-magna.rpl.constructs)

(defun checked-target (target task operator what)
  "Return TARGET, another task for which TASK does OPERATOR: WHAT says it in words. Signals
WRONG-ARGUMENT and MISUSE."
  (unless (task-p target)
    (reject-argument operator 'target target "a task, such as the name of a :tag"))
  (check-together task target)
  (when (part-of-p task target)
    (reject-use "~A would ~A itself: it is part of ~A." (task-label task) what
                (task-label target)))
  target)

(define-construct with-task-blocked (task &body body)
  "Run BODY in a plan while TASK, and what it consists of, does not run. What TASK waits for still
counts; it goes on when BODY has ended, however that ended. An evaporating task is not kept. Its
status is :blocked meanwhile (CRAM's, of 2009)."
  (:parts (target function (value-lambda task scope))
          (status keyword :blocked)
          (body node (body-code body scope)))
  (:steps
   (begin
    (next inside)
    (setf memory (checked-target (funcall target environment) task
                                 'with-task-blocked "block"))
    (block-task memory (eq status :suspended))
    (enter body environment frame))
   (inside
    (unblock-task (shiftf memory nil) (eq status :suspended))
    (values (frame-up frame) value)))
  (:unwind
   (when memory (unblock-task (shiftf memory nil) (eq status :suspended)))
   nil))

(define-construct with-task-suspended (task &body body)
  "Do as WITH-TASK-BLOCKED; the status of TASK is :suspended meanwhile (CRAM's, of 2020)."
  (:like with-task-blocked)
  (:parts (target function (value-lambda task scope))
          (status keyword :suspended)
          (body node (body-code body scope))))
