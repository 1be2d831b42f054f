;;;; blocking.lisp -- with-task-blocked: keeping another task from running.

(in-package :ars-magna.rpl.constructs)

;;; Blocking. A blocked task keeps its place: what it waits for still counts, and it runs again
;;; when it is blocked no longer.

(define-node blocking ((target function) (body node))
  "BODY while the task that TARGET of the environment returns, DATA, does not run."
  :step step-blocking :unwind unwind-blocking)

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

(defun step-blocking (node task frame value)
  (cond ((plusp (frame-counter frame))
         (unblock-task (shiftf (frame-data frame) nil))
         (values (frame-up frame) value))
        (t (let ((target (funcall (blocking-target node) (frame-environment frame))))
             (check-blockable target task)
             (setf (frame-counter frame) 1
                   (frame-data frame) target)
             (block-task target)
             (enter (blocking-body node) (frame-environment frame) frame)))))

(defun unwind-blocking (node task frame signal)
  (declare (ignore node task signal))
  (let ((target (shiftf (frame-data frame) nil)))
    (when target (unblock-task target)))
  nil)

(addition with-task-blocked)
(defmacro with-task-blocked (task &body body)
  "Run BODY in a plan while TASK, and what it consists of, does not run. What TASK waits for still
counts; it goes on when BODY has ended, however that ended. An evaporating task is not kept."
  (misplaced 'with-task-blocked (list* task body)))

(define-plan-form "WITH-TASK-BLOCKED" :must (task &rest body) (form scope)
  `(make-blocking :form ',form
                  :target ,(value-lambda task scope)
                  :body ,(body-code body scope)))
