;;;; care.lisp -- what becomes of a plan whose Lisp code meets trouble; the plans' runner goes on.

(in-package :ars-magna.rpl.tasks)

;;; An error in a leaf becomes a failure of its task. While *BREAK-ON-USER-ERROR* is true, and
;;; somebody is there to answer, the debugger comes first; its restarts are: do the leaf again, let
;;; it return a value, let the task fail, end the plan. An ABORT ends the plan that it meets. A leaf
;;; that is left for good, as by THROW, ends its plan too.

;;; What happens to the task.

(defun running-task (runner)
  "Return the task of RUNNER whose step is under way, or NIL."
  (let ((task (runner-current runner)))
    (and task (eq (task-state task) :running) task)))

(defun current-failure (runner condition)
  "Return the failure of the running task of RUNNER that CONDITION, which it met, means."
  (let ((task (runner-current runner)))
    (failure-of condition task (task-frame task))))

(defun fail-current (runner trouble)
  "Let TROUBLE, a failure or that there was no room, be the failure of the running task of RUNNER."
  (let ((task (runner-current runner)))
    (when (typep trouble 'storage-condition) (regain-room trouble))
    (setf (task-signal task) (current-failure runner trouble))
    (make-ready-first task)))

(defun end-current (runner)
  "Evaporate the plan of the running task of RUNNER; if that was cleaning up, not to the end."
  (let* ((task (runner-current runner))
         (cleaner (loop for each = task then (task-parent each)
                        while each
                        when (task-cleaning each) return each)))
    (setf (task-signal task) nil)
    (make-ready-first task)
    (evaporate (task-top task))
    (when cleaner (give-up-cleanup cleaner))))

(defun report-abort (runner)
  (let ((task (runner-current runner)))
    (error-set (task-label (task-top task)) " was aborted at " (form-text (task-form task)))))

(defun put-in-order (runner)
  "Let RUNNER be fit to go on after a step has been left for good: the plan that took it ends."
  (clear-backlog runner)
  (when (running-task runner) (end-current runner)))

;;; Calling.

(defun offer-failing (stream) (write-string "Let the task fail." stream))
(defun offer-ending (stream) (write-string "End the plan." stream))

(defun call-offering-ends (runner function fail end)
  "Call FUNCTION with RUNNER and the restarts FAIL-TASK and ABORT, which call FAIL and END."
  (declare (type function function fail end))
  (flet ((in-step-p (condition)
           (declare (ignore condition))
           (running-task runner)))
    (declare (dynamic-extent #'in-step-p))
    (restart-bind ((fail-task fail :report-function #'offer-failing
                                   :test-function #'in-step-p)
                   (abort end :report-function #'offer-ending
                              :test-function #'in-step-p))
      (funcall function runner))))

(defun call-with-care (runner function)
  "Call FUNCTION with RUNNER and return its value; NIL if the step of a task met trouble, which that
task has to bear."
  (let ((fate nil) (trouble nil) (result nil))
    (unwind-protect
         (block call
           (labels ((bear (what) (setf fate what) (return-from call))
                    (end () (bear :end))
                    (fail ()
                      (unless (typep trouble '(or plan-failure storage-condition))
                        (setf trouble (current-failure runner (or trouble (make-failure '())))))
                      (bear :fail))
                    (note (condition)
                      (when (running-task runner)
                        (setf trouble condition)
                        (when (and *break-on-user-error* (typep condition 'error))
                          (invoke-debugger condition))
                        (fail)))
                    (answer (condition somebody-p)
                      (cond (somebody-p (setf (runner-looked-at runner) t)
                                       (note-waiting))
                            ((not (running-task runner)))
                            ((typep condition 'serious-condition)
                             (setf trouble condition)
                             (fail))
                            (t (report-break condition (list (task-label (runner-current runner))))
                               (continue-inside condition)
                               (end)))))
             (declare (dynamic-extent #'end #'fail #'note #'answer))
             (setf result (handler-bind (((or error plan-failure storage-condition) #'note))
                            (answering-debugger (#'answer)
                              (call-offering-ends runner function #'fail #'end)))
                   fate :done)))
      (unless fate (put-in-order runner)))
    (ecase fate
      (:done)
      (:fail (fail-current runner trouble))
      (:end (report-abort runner) (end-current runner)))
    result))
