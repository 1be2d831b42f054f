;;;; subjects.lisp -- which runner and which tasks somebody wants to see, and their valves.

(in-package :ars-magna.rpl.seeing)

(export '(runner-in-use runner-to-see task-with))

(defgeneric runner-in-use (interface)
  (:documentation "Return the plan runner whose tasks are shown where nobody says which and
INTERFACE is in use, or NIL.")
  (:method (interface) (declare (ignore interface)) nil))

(defun runner-to-see (&optional subject)
  "Return the plan runner of SUBJECT: itself, a task's, that of the plan that asks, or the one in
use. Signals MISUSE if there is none."
  (or (cond ((task-p subject) (task-runner subject))
            ((typep subject 'plan-runner) subject)
            (*runner*)
            (t (runner-in-use *interface*)))
      (reject-use "No plans have run here. Start one first: (begin-plan ...), or the line PLAN at ~
                   the prompt.")))

(defun task-with (value runner)
  "Return the task of RUNNER that has VALUE in a variable, or in what is there, and the name of that
variable; or NIL."
  (dolist (task (all-tasks runner) nil)
    (loop for (nil . variables) in (stack-entries task)
          for (name) = (find-if (lambda (variable) (holds-p (second variable) value)) variables)
          do (when name (return-from task-with (values task name))))))

(defun valves-of (task)
  (flet ((valves-in (object)
           (if (claim-p object) (claim-valves object) '())))
    (remove-duplicates
     (append (valves-in (task-awaiting task))
             (mapcan (lambda (frame) (copy-list (valves-in (frame-data frame))))
                     (frame-chain (task-frame task))))
     :from-end t)))
