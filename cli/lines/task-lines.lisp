;;;; task-lines.lisp -- END-TASK, STEP-TASK and TRACE-PLANS: what one does to plans under way.

(in-package :ars-magna.cli)

(define-choices :task-number
  (call-with-plans-in-use
   (lambda (runner) (and runner (mapcar #'task-serial (all-tasks runner))))))

(defun task-meant (text)
  "Return the task under way whose number TEXT says. Signals BAD-LINE."
  (unless (plans) (reject-line "No plan is under way."))
  (let ((number (ignore-errors (parse-integer text))))
    (call-with-plans-in-use
     (lambda (runner)
       (or (and number (task-numbered number runner))
           (reject-line "No task ~A is under way. PLANS shows which are." text))))))

(defun task-text (task) (format nil "~D, ~A" (task-serial task) (task-label task)))

(define-line "END-TASK" (session (n :task-number "the number of a task under way")) (:planning)
    "End the task N of a plan, and all that it consists of: it evaporates, as when what it is part
of needs it no longer, without stopping if it is stepped. What it has told the robot to do is
interrupted. STOP-PLAN ends whole plans."
  (let ((task (task-meant n)))
    (step-task task nil)
    (end-plan task)
    (format t "Task ~A ends.~%" (task-text task))))

(define-line "STEP-TASK" (session (n :task-number "the number of a task under way")
                                  (off :off "OFF: no longer" :optional))
    (:planning)
    "Stop before each expression of the task N, and of those that it consists of, and ask how far to
go on: STEP, NEXT, OUT or CONTINUE; no longer with OFF. Where nobody can answer, each stop is a
message."
  (let ((task (task-meant n)) (on-p (null off)))
    (unless (or on-p (string-equal off "off"))
      (reject-line "After the number of a task comes OFF or nothing, not ~A." off))
    (step-task task on-p)
    (format t "Task ~A ~:[goes on without stopping~;stops when it goes on~].~%" (task-text task)
            on-p)))

(define-line "TRACE-PLANS" (session (switch :switch "ON or OFF" :optional)) (:planning)
    "Keep a trace of what plans do, those under way included, from now on: for WHY, PLAN-TIMELINE
and the window's timeline. OFF keeps none, and forgets it; without ON or OFF, say which it is."
  (when switch
    (let ((on-p (switch-setting "TRACE-PLANS" switch)))
      ;; A plan may keep the thread of all: then none is asked, and nothing changes.
      (call-with-plans-in-use
       (lambda (runner)
         (when runner (if on-p (start-trace runner) (stop-trace runner)))))
      (setf *trace-plans* on-p)))
  (format t "~:[No trace of plans is kept~;A trace of plans is kept~].~%" *trace-plans*))
