;;;; blocking.lisp -- with-task-blocked: keeping another task from running.

(in-package :ars-magna.rpl.constructs)

;;; Blocking. A blocked task keeps its place: what it waits for still counts, and it runs again
;;; when it is blocked no longer.

(defun part-of-p (task whole)
  (loop for each = task then (task-parent each)
        while each thereis (eq each whole)))

(defun block-task (task)
  (incf (task-blocked task))
  (incf (runner-blocks *runner*))
  (note-event task :block)
  (note-status task :blocked))

(defun unblock-task (task)
  (decf (task-blocked task))
  (decf (runner-blocks *runner*))
  (unless (or (task-over-p task) (plusp (task-blocked task)))
    (note-event task :unblock)
    (note-status task :running))
  (release-held *runner*))

(defun check-blockable (target task)
  (check-argument with-task-blocked target (task-p target) "a task, such as the name of a :tag")
  (when (part-of-p task target)
    (reject-use "~A would block itself: it is part of ~A." (task-label task) (task-label target))))

(define-construct with-task-blocked (task &body body)
  "Run BODY in a plan while TASK, and what it consists of, does not run. What TASK waits for still
counts; it goes on when BODY has ended, however that ended. An evaporating task is not kept."
  (:parts (target function (value-lambda task scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (let ((target (funcall target environment)))
      (check-blockable target task)
      (block-task target)
      (setf memory target)
      (next inside)
      (enter body environment frame)))
   (inside
    (unblock-task (shiftf memory nil))
    (values (frame-up frame) value)))
  (:unwind
   (let ((target (shiftf memory nil)))
     (when target (unblock-task target)))
   nil))
