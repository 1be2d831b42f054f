;;;; variables.lisp -- task variables: a value for each task, inherited by the tasks it starts.

(in-package :ars-magna.rpl.tasks)

(export '(*calling-task* calling-task install-task-variable make-task-bindings task-bindings-p
          task-variable task-variable-p))

;;; All tasks share the thread and its special variables. A task variable is sought from the calling
;;; task outwards: in its frames (those that bind variables have TASK-BINDINGS as DATA), in what it
;;; has set, in the frames of the task around it, and so on. A binding is gone with its frame.

(define-record (task-bindings (:constructor make-task-bindings (cells)))
  "The data of a frame that binds task variables. CELLS is a list of conses (name . value)."
  (cells '() list "an alist from variables to their values" :export))
(declaim-final task-bindings)

(defvar *task-variable-defaults* (make-hash-table :test 'eq :synchronized t)
  "The default values of task variables, by name.")

(defvar *calling-task* nil
  "The task for which Lisp code runs, if it is not the running task.")

(defun calling-task ()
  "Return the task for which the calling Lisp code runs, or NIL outside of plans."
  (or *calling-task*
      (and *runner* (running-task *runner*))))

(defun variable-cell (name task)
  (or (loop for frame = (task-frame task) then (frame-up frame)
            while frame
            thereis (and (task-bindings-p (frame-data frame))
                         (assoc name (task-bindings-cells (frame-data frame)) :test #'eq)))
      (assoc name (task-variables task) :test #'eq)))

(defun task-variable (name)
  "Return the value of the task variable NAME for the calling task."
  (let ((cell (loop for task = (calling-task) then (task-parent task)
                    while task thereis (variable-cell name task))))
    (if cell (cdr cell) (values (gethash name *task-variable-defaults*)))))

(defun (setf task-variable) (value name)
  (let* ((task (calling-task))
         (cell (and task (variable-cell name task))))
    (cond (cell (setf (cdr cell) value))
          (task (push (cons name value) (task-variables task)))
          (t (setf (gethash name *task-variable-defaults*) value)))
    value))

(defun task-variable-p (name &optional environment)
  "True if the symbol NAME names a task variable in ENVIRONMENT."
  (and (symbolp name)
       (eq :symbol-macro (variable-kind name environment))
       (let ((expansion (macroexpand-1 name environment)))
         (and (consp expansion) (eq 'task-variable (first expansion))))))

(defun install-task-variable (name value documentation)
  "Define VALUE as the default of the task variable NAME."
  (setf (gethash name *task-variable-defaults*) value
        (documentation name 'variable) documentation)
  name)
