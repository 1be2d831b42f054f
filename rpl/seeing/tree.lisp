;;;; tree.lisp -- the tree of tasks: as text, and as data for pictures.

(in-package :ars-magna.rpl.seeing)

(export '(runner-in-use runner-to-show task-whose-variable-holds image-of-tasks runner-change-mark
          task-image))

(defgeneric runner-in-use (interface)
  (:documentation "Return the plan runner shown by default while INTERFACE is in use, or NIL.")
  (:method (interface) (declare (ignore interface)) nil))

(defun runner-to-show (&optional subject)
  "Return the plan runner of SUBJECT, a plan runner, a task or NIL. For NIL, return the runner of
the running plan, or else the runner in use. Signals MISUSE without a runner."
  (or (cond ((task-p subject) (task-runner subject))
            ((typep subject 'plan-runner) subject)
            (*runner*)
            (t (runner-in-use *default-interface*)))
      (reject-use "No plans have run here. Start one first: (begin-plan ...), or the line PLAN at ~
                   the prompt.")))

(defun task-whose-variable-holds (value runner)
  "Return a task of RUNNER, and the name of its variable that is or contains VALUE; or NIL."
  (dolist (task (all-tasks runner) nil)
    (loop for (nil . variables) in (stack-entries task)
          for (name) = (find-if (lambda (variable) (contains-value-p (second variable) value))
                                variables)
          do (when name (return-from task-whose-variable-holds (values task name))))))

(defun valves-of-task (task)
  (flet ((valves-in (object)
           (if (claim-p object) (claim-valves object) '())))
    (remove-duplicates
     (append (valves-in (task-awaiting task))
             (mapcan (lambda (frame) (copy-list (valves-in (frame-data frame))))
                     (frame-chain (task-frame task))))
     :from-end t)))

;;;; As text

(defun write-stack (task column stream)
  "Write to STREAM the expressions that TASK is evaluating, innermost first, and its variables."
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
  "Write to STREAM the tree of tasks of WHICH: a task, a plan runner for all its tasks, or NIL for
the plan runner in use. Each line has number, state, expression, what the task waits for and since
which tick. If ALL is true, write stacks, innermost expression first, with the plan's variables and
their values, and the valves that tasks have or want."
  (check-argument print-tasks which (typep which '(or null task plan-runner))
                  "a task, as begin-plan returns, or a plan runner")
  (let ((which (or which (runner-to-show))))
    (dolist (task (if (task-p which) (list which) (plan-runner-tasks which)))
      (write-task-tree task 0 stream (and all #'write-stack)))
    (when all
      (dolist (valve (remove-duplicates (mapcan #'valves-of-task (all-tasks which)) :from-end t))
        (write-valve valve stream)))))

;;; An image is made while no plan runs, as between two ticks; any thread may draw from it. It has
;;; the visible rows, from top to bottom, up to a given number. Other rows are only counted.

(define-record task-image
  "The data of a task that pictures show."
  (serial 0 fixnum "the number of the task" :export)
  (depth 0 fixnum "of how many tasks the task is part" :export)
  (look :running keyword "how the task is, as a keyword: :running, :waiting, :blocked, :cleaning,
:ending or :stepped" :export)
  (state "" string "in words how the task is" :export)
  (name nil (or null string) "what the task is called, or NIL" :export)
  (form "" string "the expression that the task is at, as text" :export)
  (calls '() list "the calls of plans that the task is in the middle of, as texts, outermost first;
of many the innermost" :export)
  (awaits nil (or null string) "in words what the task waits for, or NIL" :export)
  (since 0 real "the tick at which the task began to wait" :export)
  (path '() list "the labels of the tasks from the top of the plan to the task" :export)
  (parts 0 fixnum "how many tasks the task consists of" :export)
  (folded-p nil boolean "the parts of the task are folded away" :export))

(define-record tree-image
  "The tasks of a plan runner at one tick."
  (tick 0 real "the tick of the image" :export)
  (rows '() list "the images of the tasks to be seen, each before its parts" :export)
  (plans 0 fixnum "how many plans are under way" :export)
  (tasks 0 fixnum "how many tasks there are, those included that are not to be seen" :export))

;;; A task.

(defun task-display-state (task)
  (cond ((evaporating-p task) (if (task-cleaning task) :cleaning :ending))
        ((blocked-p task) :blocked)
        ((task-cleaning task) :cleaning)
        ((find task (stepping-courses (task-runner task)) :key #'stepping-course-task) :stepped)
        ((eq :waiting (task-state task)) :waiting)
        (t :running)))

(defconstant +most-calls+ 10 "The largest number of plan calls that an image of a task shows.")

(defun image-of-task (task depth folded-p)
  (make-task-image :serial (task-serial task) :depth depth
                   :look (task-display-state task) :state (task-state-text task)
                   :name (and (task-name task) (task-label task))
                   :form (form-text (task-form task) 100)
                   :calls (loop for call in (last (plan-calls-in (task-stack task)) +most-calls+)
                                collect (form-text call 100))
                   :awaits (task-awaits task) :since (task-since task)
                   :path (task-path task)
                   :parts (length (task-children task)) :folded-p folded-p))

;;; The tree.

(defun rows-of-tasks (tasks folded most)
  (let ((rows '()) (count 0))
    (labels ((add (task depth)
               (let ((folded-p (and (member (task-serial task) folded) t)))
                 (incf count)
                 (push (image-of-task task depth folded-p) rows)
                 (unless folded-p (add-all (task-children task) (1+ depth)))))
             (add-all (tasks depth)
               (loop for task in tasks while (< count most) do (add task depth))))
      (add-all tasks 0))
    (nreverse rows)))

(defun image-of-tasks (runner &key (folded '()) (most 300))
  "Return the image of the tasks of RUNNER, with at most MOST rows. The parts of tasks whose numbers
are among FOLDED are left out. No task may go on meanwhile."
  (let ((plans (plan-runner-tasks runner)))
    (make-tree-image :tick (plan-runner-tick runner) :rows (rows-of-tasks plans folded most)
                     :plans (length plans) :tasks (runner-alive runner))))

(defun runner-change-mark (runner)
  "Return a list that changes (under EQUAL) when tasks of RUNNER change. For any thread."
  (list (runner-steps runner) (runner-alive runner) (runner-serial runner)
        (runner-blocks runner) (and (runner-stepper runner) t)))
