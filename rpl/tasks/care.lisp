;;;; care.lisp -- what becomes of a plan whose Lisp code meets trouble; the plans' runner goes on.

(in-package :ars-magna.rpl.tasks)

(export '(leave-plan))

;;; An error in a leaf becomes a failure of its task. While *BREAK-ON-USER-ERROR* is true, and
;;; somebody is there to answer, the debugger comes first; its restarts are: do the leaf again, let
;;; it return a value, let the task fail, end the plan. An ABORT ends the plan that it meets. A leaf
;;; that is left for good, as by THROW, ends its plan too.

;;; What happens to the task.

(defun current-failure (runner condition)
  (let ((task (runner-current runner)))
    (failure-of condition task (task-frame task))))

(defun fail-current (runner trouble)
  "Let TROUBLE, a failure or that there was no room, be the failure of the running task of RUNNER."
  (let ((task (runner-current runner)))
    (when (typep trouble 'storage-condition) (regain-room trouble))
    (let ((failure (current-failure runner trouble)))
      (cond ((task-newest-child task)   ; The step was starting parts.
             (setf (task-state task) :waiting)
             (decide task failure))
            (t (setf (task-signal task) failure)
               (make-ready-first task))))))

(defun end-plan-of (task)
  "Evaporate the plan of TASK, which is ready; if that was cleaning up, not to the end."
  (let ((cleaner (find-if #'task-cleaning (lineage task))))
    (evaporate (task-top task))
    (when (and cleaner (not (task-over-p cleaner))) (give-up-cleanup cleaner))))

(defun end-current (runner)
  "Evaporate the plan of the running task of RUNNER; if that was cleaning up, not to the end."
  (let ((task (runner-current runner)))
    (setf (task-signal task) nil)
    (make-ready-first task)
    (end-plan-of task)))

(defun report-abort (runner)
  (let ((task (runner-current runner)))
    (error-set (task-label (task-top task)) " was aborted at " (form-text (task-form task)))))

(defun put-in-order (runner)
  "Let RUNNER be fit to go on after a step has been left for good: the plan that took it ends."
  (let ((task (running-task runner)))
    (when task
      (setf (task-state task) :ready
            (task-signal task) nil))
    (repair runner)
    (when (and task (not (task-over-p task))) (end-plan-of task))))

;;; Calling.

(document-restarts
 'fail-task "Let the plan's task whose code went wrong fail: other branches of the plan go on as
after any failure."
 'leave-plan "End the plan without a message.")

(defun leave-plan ()
  "In a plan's Lisp code: end the plan, and report nothing. Elsewhere return."
  (let ((restart (find-restart 'leave-plan)))
    (when restart (invoke-restart restart))))

(defun call-offering-ends (runner function fail end leave)
  "Call FUNCTION with RUNNER and the restarts FAIL-TASK, LEAVE-PLAN and ABORT, which call FAIL,
LEAVE and END. A step that is left by another ends its plan, and so cannot be tried again."
  (declare (type function function fail end leave))
  (labels ((in-step-p (&optional condition)
             (declare (ignore condition))
             (running-task runner))
           (current () (runner-current runner))
           (offer-failing (stream)
             (format stream "Let the task ~A fail." (task-label (current))))
           (plan () (task-label (task-top (current))))
           (offer-ending (stream) (format stream "End the plan ~A; a message says so." (plan)))
           (offer-leaving (stream)
             (format stream "End the plan ~A; no message says so." (plan))))
    (declare (dynamic-extent #'in-step-p #'offer-failing #'offer-ending #'offer-leaving))
    (restart-bind ((fail-task fail :report-function #'offer-failing
                                   :test-function #'in-step-p)
                   (leave-plan leave :report-function #'offer-leaving
                                     :test-function #'in-step-p)
                   (abort end :report-function #'offer-ending
                              :test-function #'in-step-p))
      (let ((*spoilt-by-leaving-p* #'in-step-p))
        (funcall function runner)))))

;;; What a step meets decides the fate of its task, a keyword:
;;;   :DONE    nothing;
;;;   :FAIL    an error or failure, or the restart FAIL-TASK;
;;;   :END     the restart ABORT, or a debugger at which nobody sits;
;;;   :LEAVE   the restart LEAVE-PLAN.
;;; There is none if the step is left for good by another way, such as THROW.

(defun call-to-fate (runner function)
  "Call FUNCTION with RUNNER. Return the fate of its task, the value of FUNCTION or what trouble it
met, and whether it may have been stopped in the middle of our own code."
  (let ((trouble nil) (anywhere-p nil))
    (block call
      (labels ((meet (fate) (return-from call (values fate trouble anywhere-p)))
               (end () (meet :end))
               (leave () (meet :leave))
               (fail ()
                 ;; A failure keeps the backtrace of where it is made. Without room for one, that
                 ;; waits until there is: see FAIL-CURRENT.
                 (unless (typep trouble '(or plan-failure storage-condition))
                   (setf trouble (current-failure runner (or trouble (make-failure '())))))
                 (meet :fail))
               (note (condition)
                 (when (let-callers-handle condition) (setf anywhere-p t))
                 ;; Without a task, plans hear something; that trouble is for those who called.
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
        ;; Each step of each task comes by here, so nothing is allocated.
        (declare (dynamic-extent #'end #'leave #'fail #'note #'answer))
        (values :done
                (handler-bind (((or error plan-failure storage-condition) #'note))
                  (answering-debugger (#'answer)
                    (call-offering-ends runner function #'fail #'end #'leave)))
                anywhere-p)))))

(defun bear-fate (runner fate trouble)
  "Let the running task of RUNNER bear FATE, no :DONE, that TROUBLE brought. Return NIL."
  (ecase fate
    (:fail (fail-current runner trouble))
    (:end (report-abort runner) (end-current runner))
    (:leave (end-current runner)))
  nil)

(defun call-with-care (runner function)
  "Call FUNCTION with RUNNER and return its value; NIL if the step of a task met trouble, which that
task has to bear."
  (let ((fate nil) (result nil) (anywhere-p nil))
    (unwind-protect
         (setf (values fate result anywhere-p) (call-to-fate runner function))
      (cond ((null fate) (put-in-order runner))
            ((or anywhere-p (eq fate :end)) (repair runner))))
    (if (eq fate :done)
        result
        (bear-fate runner fate result))))
