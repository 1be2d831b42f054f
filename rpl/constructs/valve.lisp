;;;; valve.lisp -- who owns a resource (manual D).

(in-package :ars-magna.rpl.constructs)

;;; A valve has one owner. The tasks that want it queue by level, then first in first out. What an
;;; owner's own parts ask for they have: it is for the owner to keep them apart.

(defstruct (valve (:constructor %make-valve (name)) (:copier nil))
  "What guarantees that one task at a time has a resource."
  (name nil :read-only t)
  (owner nil :type (or null task))
  (requests '() :type list))

(setf (documentation 'valve-name 'function) "Return the name that the valve was made with."
      (documentation 'valve-owner 'function) "Return the task that has the valve, or NIL."
      (documentation 'valve-requests 'function) "Return the tasks that queue for the valve."
      (documentation 'valve-p 'function) "True of valves.")

(addition make-valve)
(defun make-valve (name)
  "Return a new valve called NAME, that nobody owns."
  (%make-valve name))

(defmethod print-object ((valve valve) stream)
  (print-unreadable-object (valve stream)
    (format stream "valve ~A~@[ of task ~D~]" (valve-name valve)
            (and (valve-owner valve) (task-serial (valve-owner valve))))))

(defmethod awaited-text ((valve valve))
  (format nil "valve ~(~A~)" (valve-name valve)))

(defmethod withdraw (task (valve valve))
  (setf (valve-requests valve) (remove task (valve-requests valve))))

(defun add-request (task valve)
  "Let TASK queue for VALVE: behind those of its level and above."
  (setf (valve-requests valve)
        (merge 'list (valve-requests valve) (list task) #'> :key #'task-level)))

(defun grant-next (valve)
  "Give VALVE to the next task that wants it."
  (let ((task (pop (valve-requests valve))))
    (setf (valve-owner valve) task)
    (when task
      (setf (frame-data (task-frame task)) valve)
      (wake task nil))))

(defun give-back (frame)
  (let ((valve (shiftf (frame-data frame) nil)))
    (when valve (grant-next valve))))

(define-construct with-valve ((valve) &body body)
  "Run BODY in a plan while the task owns VALVE, waiting for it first if another task has it. The
valve is given back however BODY ends. If tasks wait for each other's valves, an error message says
so (manual D)."
  (:parts (valve function (value-lambda valve scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (let ((valve (fluent-value (funcall valve environment))))
      (check-argument with-valve valve (valve-p valve) "a valve, made by make-valve")
      (next granted)
      (cond ((null (valve-owner valve))
             (setf (valve-owner valve) task
                   memory valve)
             (values frame nil))
            ((part-of-p task (valve-owner valve)) (values frame nil))
            (t (add-request task valve)
               (park task valve)
               (report-circle task)
               +parked+))))
   (granted
    (next inside)
    (enter body environment frame))
   (inside
    (give-back frame)
    (values (frame-up frame) value)))
  (:unwind
   (give-back frame)
   nil))

;;; Circles. A task is stuck if it waits for a valve whose owner is stuck; a task with parts is
;;; stuck if all of them are, policies, which only watch, not counted.

(defun working-parts (task)
  "Return the innermost parts of TASK that are at its own level."
  (let ((children (remove (task-level task) (task-children task) :key #'task-level :test #'<)))
    (if children
        (loop for child in children append (working-parts child))
        (list task))))

(defun stuck-tasks (task)
  "Return the tasks that wait for each other's valves with TASK, or NIL if some of them can go on."
  (let ((stuck '()) (open (list task)))
    (loop while open
          do (let* ((next (pop open))
                    (valve (task-awaiting next)))
               (unless (valve-p valve) (return-from stuck-tasks '()))
               (pushnew next stuck)
               (dolist (part (working-parts (valve-owner valve)))
                 (unless (or (member part stuck) (member part open))
                   (push part open)))))
    (reverse stuck)))

(defun report-circle (task)
  "Queue an error message if TASK, which waits for a valve, waits in a circle."
  (let ((tasks (stuck-tasks task)))
    (when tasks
      (error-set "Deadlock at tick " (runner-tick (task-runner task)) ": "
                 (format nil "~{~A~^; ~}"
                         (loop for task in tasks
                               for valve = (task-awaiting task)
                               collect (format nil "~A waits for the ~A that ~A has"
                                               (task-label task) (awaited-text valve)
                                               (task-label (valve-owner valve)))))
                 ". None can go on."))))
