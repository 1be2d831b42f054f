;;;; joining.lisp -- join-task: waiting for another task's end.

(in-package :ars-magna.rpl.constructs)

(defun over-p (status)
  (and (member status '(:succeeded :failed :evaporated)) t))

(defun pass-on-outcome (target task frame)
  "Let TASK at FRAME go on as TARGET ended. Return what a step returns."
  (let ((result (task-result target)))
    (cond ((eq :failed (task-state target)) (unwind task (frame-up frame) result))
          (t (values (frame-up frame)
                     (and (eq :succeeded (task-state target)) (not (escape-p result)) result))))))

(defstruct (joining (:constructor make-joining (target watcher)) (:copier nil))
  "What a task waits for that joins TARGET; WATCHER watches its status."
  (target nil :type task :read-only t)
  (watcher nil :type watcher :read-only t))

(defmethod awaited-text ((joining joining))
  (format nil "the end of ~A" (task-label (joining-target joining))))

(defmethod withdraw (task (joining joining))
  (unwatch (joining-watcher joining)))

(defmethod hinderers ((joining joining))
  (let ((target (joining-target joining)))
    (and (under-way-p target) (list target))))

(defun hear-end (watcher value trouble)
  (declare (ignore value trouble))
  (unwatch watcher)
  (wake (watcher-client watcher) nil))

(defun await-end (target task)
  (let ((watcher (make-watcher (fl-funcall 'over-p (task-status target)) #'hear-end task)))
    (watch watcher)
    (park task (make-joining target watcher))
    (report-circle task)))

(define-construct join-task (task)
  "Wait in a plan until TASK is over, not at all if it is, and return its value; fail as it failed.
Of a task that evaporated or was left, return NIL (CRAM's; the last is ours)."
  (:arguments task)
  (:parts (target function (value-lambda task scope)))
  (:steps
   (begin
    (let ((target (checked-target (funcall target environment) task 'join-task "wait for")))
      (cond ((task-over-p target) (pass-on-outcome target task frame))
            (t (next over)
               (setf memory target)
               (await-end target task)
               +parked+))))
   (over (pass-on-outcome memory task frame))))
