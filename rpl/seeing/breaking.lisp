;;;; breaking.lisp -- stopping where a plan fails, with its stack at hand.

(in-package :ars-magna.rpl.seeing)

(export '(plan-break-p))

;;; A break is no error. Where nobody is there to answer a debugger it is a message, and the plan
;;; goes on.

(addition plan-break plan-break-task)
(define-condition plan-break (condition)
  ((text :initarg :text :reader plan-break-text)
   (task :initarg :task :reader plan-break-task)
   (frame :initarg :frame :reader plan-break-frame))
  (:report (lambda (break stream) (write-break break stream)))
  (:documentation "A plan has stopped for somebody to look at it: where it failed, or step by
step."))

(defun plan-break-p (object)
  "True of breaks of plans."
  (typep object 'plan-break))

(setf (documentation 'plan-break-task 'function)
      "Return the task that stopped.")

(defparameter *longest-stack* 12 "How many expressions of a plan a break shows at most.")

(defun write-break (break stream)
  (let ((task (plan-break-task break)))
    (format stream "~A~%  in task ~{~A~^ > ~}, at tick ~D"
            (plan-break-text break) (task-path task) (runner-tick (task-runner task)))
    (loop for form in (plan-backtrace task (plan-break-frame break))
          repeat *longest-stack*
          do (format stream "~%    ~A" (form-text form 70)))
    (loop for (name value) in (frame-variables (plan-break-frame break))
          repeat *longest-stack*
          do (format stream "~%    ~(~A~) = ~A" name (form-text value 70)))))

(defun enter-break (break)
  "Let somebody look at BREAK, if there is somebody; return when the plan is to go on."
  (if (debugger-p)
      (invoke-debugger break)
      (message-set "Break: " (own-text break))))

;;; Where plans fail.

(addition *break-on-plan-failures*)
(defvar *break-on-plan-failures* nil
  "T, a class of failures as HANDLE-FAILURE takes it, or a list of such: a failure of that class
enters the debugger where it happens, also if the plan handles it. NIL: none does. Where nobody is
there to answer, it is a message.")

(defun break-wanted-p (failure)
  (let ((types *break-on-plan-failures*))
    (and types
         (some (lambda (type)
                 (and (typep type '(or symbol cons)) (failure-matches-p failure type)))
               (if (and (consp types) (not (eq 'or (first types)))) types (list types))))))

(defun consider-break (failure task frame)
  (when (break-wanted-p failure)
    (with-simple-restart (continue "Let the failure happen.")
      (enter-break (make-condition 'plan-break :text (own-text failure) :task task :frame frame)))))

(attend *failure-hooks* consider-break)
