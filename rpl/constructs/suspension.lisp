;;;; suspension.lisp -- stopping another task, and how a task reacts to that.

(in-package :ars-magna.rpl.constructs)

(defun checked-target (target task operator what)
  "Return TARGET, the task that TASK blocks or joins by OPERATOR. WHAT is the verb for error
messages. Signals WRONG-ARGUMENT and MISUSE."
  (unless (task-p target)
    (reject-argument operator 'target target "a task, such as the name of a :tag"))
  (check-same-runner task target)
  (when (part-of-p task target)
    (reject-use "~A would ~A itself: it is part of ~A." (task-label task) what
                (task-label target)))
  target)

(define-construct with-task-blocked (task &body body)
  "Run BODY in a plan while TASK and its parts are stopped. Meanwhile fluents can still end the
waits of TASK. TASK goes on when BODY has ended in any way. An evaporating task is not stopped. The
status of TASK is :BLOCKED meanwhile. From CRAM (2009)."
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
  "Like WITH-TASK-BLOCKED, but the status of TASK is :SUSPENDED meanwhile. From CRAM (2020)."
  (:like with-task-blocked)
  (:parts (target function (value-lambda task scope))
          (status keyword :suspended)
          (body node (body-code body scope))))

;;;; Reacting to suspension

(defun run-reaction (reaction task frame)
  "Run the leaf REACTION with the task variables of TASK at FRAME. Its errors become messages."
  (let ((*calling-task* task)
        (*asker* task)
        (innermost (shiftf (task-frame task) frame)))
    (unwind-protect
         (handler-case (call-user-code (leaf-function reaction) "an on-suspension"
                                       (frame-environment frame))
           (plan-failure (failure)
             (error-set "An on-suspension failed in " (task-label task) ": "
                        (failure-text failure))))
      (setf (task-frame task) innermost))))

(define-construct on-suspension (reaction &body body)
  "Run BODY in a plan. Each time the task is stopped meanwhile, by SUSPEND, WITH-TASK-BLOCKED or the
loss of a valve, run REACTION at once, before the task stops. REACTION is a form that cannot wait,
such as a command that stops the robot. An error in REACTION becomes a message and has no other
effect. Return the value of BODY. (From CRAM, except that REACTION cannot wait.)"
  (:parts (reaction node (leaf-code-or-reject reaction scope form))
          (body node (body-code body scope)))
  (:steps
   (begin
    (next inside)
    (let ((reaction reaction))
      (setf memory (make-block-hook (lambda (task frame) (run-reaction reaction task frame)))))
    (enter body environment frame))
   (inside (values (frame-up frame) value))))

(defun evaporate-body (task frame)
  "Evaporate the part of TASK that runs the body of FRAME, because this part must not go on."
  (when (eq frame (task-frame task))
    (setf (frame-data frame) nil)
    (mapc #'evaporate (task-children task))))

(define-construct retry-after-suspension (&body body)
  "Run BODY in a plan as a separate task. If the task is stopped, BODY evaporates, and its cleanups
run. When the task may go on, BODY starts anew. Return the first value of BODY (from CRAM)."
  (:parts (body node (body-code body scope)))
  (:steps
   (begin
    (next inside)
    (setf memory (make-block-hook #'evaporate-body))
    (start-branch body task environment 0 (task-level task))
    (await-parts task))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (cond ((fail-or-escape task how result))
         ((and (eq how :evaporated) (null memory))
          (next begin)
          (wake task nil))
         (t (end-with-value task result)))))

(define-construct without-scheduling (&body body)
  "Run BODY in a plan as one step, without scheduling. Meanwhile nothing can suspend or end the
task, and no other task runs. Requests to suspend or end the task take effect after BODY. BODY
cannot wait, call plans or leave by a non-local exit: these are errors when the plan is defined.
Return the value of BODY. In ordinary Lisp, WITHOUT-SCHEDULING is PROGN. (From CRAM, except that
BODY cannot wait, because no other task could run meanwhile.)"
  (:waits :may)
  (:in-lisp `(progn ,@body))
  (:code (leaf-code-or-reject (note-plan-text `(progn ,@body)) scope form)))
