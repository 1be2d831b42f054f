;;;; tree.lisp -- the tree of tasks as text.

(in-package :ars-magna.rpl.seeing)

(defun write-stack (task column stream)
  "Write to STREAM the expressions that TASK is at, innermost first, and its variables."
  (loop for (form . variables) in (stack-entries task)
        for head = "at " then "in "
        do (format stream "~V@T~A~A~%" column head (form-text form 70))
           (loop for (name value) in variables
                 do (format stream "~V@T~(~A~) = ~A~%" (+ column 5) name (form-text value 70)))))

(defun write-valve (valve stream)
  (format stream "valve ~(~A~): ~:[free~;~:*of task ~D~]~@[, wanted by ~{~D~^, ~}~]~%"
          (form-text (valve-name valve) 40)
          (and (valve-owner valve) (task-serial (valve-owner valve)))
          (mapcar #'task-serial (valve-requests valve))))

(addition print-tasks)
(defun print-tasks (&optional which (stream *standard-output*) all)
  "Write to STREAM the tree of tasks of WHICH, a task or a plan runner (all its tasks; NIL: the one
in use): number, state, expression, what each waits for and since which tick. If ALL is true, also
the whole stack of each, innermost expression first, with the variables of the plan and their
values; and the valves that they have or want."
  (check-argument print-tasks which (typep which '(or null task plan-runner))
                  "a task, as begin-plan returns, or a plan runner")
  (let ((which (or which (runner-to-see))))
    (dolist (task (if (task-p which) (list which) (plan-runner-tasks which)))
      (write-task-tree task 0 stream (and all #'write-stack)))
    (when all
      (dolist (valve (remove-duplicates (mapcan #'valves-of (all-tasks which)) :from-end t))
        (write-valve valve stream)))))
