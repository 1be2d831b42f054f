;;;; images.lisp -- the tree of tasks as data that never change, for those who draw it.

(in-package :ars-magna.rpl.seeing)

(export '(image-of-tasks runner-mark task-image task-image-serial task-image-depth task-image-look
          task-image-state task-image-name task-image-form task-image-calls task-image-awaits
          task-image-since task-image-path task-image-parts task-image-folded-p tree-image-tick
          tree-image-rows tree-image-plans tree-image-tasks))

;;; An image is made where no plan goes on, as between two ticks; whoever draws from it may do so in
;;; any thread. It has the rows that are to be seen, from top to bottom, and no more than so many of
;;; them: what is left out, or folded away, is only counted.

(defstruct (task-image (:copier nil))
  "What is to be seen of a task. LOOK is :running, :waiting, :blocked, :cleaning, :ending or
:stepped; STATE says it in words. CALLS are the calls of plans that it is in the middle of, as
texts, outermost first. PARTS is how many tasks it consists of; if it is FOLDED-P, they are not
among the rows."
  (serial 0 :type fixnum :read-only t)
  (depth 0 :type fixnum :read-only t)
  (look :running :type keyword :read-only t)
  (state "" :type string :read-only t)
  (name nil :type (or null string) :read-only t)
  (form "" :type string :read-only t)
  (calls '() :type list :read-only t)
  (awaits nil :type (or null string) :read-only t)
  (since 0 :type real :read-only t)
  (path '() :type list :read-only t)
  (parts 0 :type fixnum :read-only t)
  (folded-p nil :type boolean :read-only t))

(defstruct (tree-image (:copier nil))
  "The tasks of a plan runner at TICK: ROWS are the images of those to be seen, each before its
parts, PLANS how many plans there are, TASKS how many tasks in all."
  (tick 0 :type real :read-only t)
  (rows '() :type list :read-only t)
  (plans 0 :type fixnum :read-only t)
  (tasks 0 :type fixnum :read-only t))

(document-functions
  task-image-serial "Return the number of the task."
  task-image-depth "Return of how many tasks the task is part."
  task-image-look "Return how the task is, as a keyword: :running, :waiting, :blocked, :cleaning,
:ending or :stepped."
  task-image-state "Return in words how the task is."
  task-image-name "Return what the task is called, or NIL."
  task-image-form "Return the expression that the task is at, as text."
  task-image-calls "Return the calls of plans that the task is in the middle of, as texts, outermost
first; of many the innermost."
  task-image-awaits "Return in words what the task waits for, or NIL."
  task-image-since "Return the tick at which the task began to wait."
  task-image-path "Return the labels of the tasks from the top of the plan to the task."
  task-image-parts "Return how many tasks the task consists of."
  task-image-folded-p "True if the parts of the task are folded away."
  tree-image-tick "Return the tick of the image."
  tree-image-rows "Return the images of the tasks to be seen, each before its parts."
  tree-image-plans "Return how many plans are under way."
  tree-image-tasks "Return how many tasks there are, those included that are not to be seen.")

;;; A task.

(defun look-of (task)
  (cond ((evaporating-p task) (if (task-cleaning task) :cleaning :ending))
        ((blocked-p task) :blocked)
        ((task-cleaning task) :cleaning)
        ((find task (courses-of (task-runner task)) :key #'course-task) :stepped)
        ((eq :waiting (task-state task)) :waiting)
        (t :running)))

(defconstant +most-calls+ 10 "How many calls of plans an image of a task shows at most.")

(defun image-of-task (task depth folded-p)
  (make-task-image :serial (task-serial task) :depth depth
                   :look (look-of task) :state (task-state-text task)
                   :name (and (task-name task) (task-label task))
                   :form (form-text (task-form task) 100)
                   :calls (loop for call in (last (calls-in (task-stack task)) +most-calls+)
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
  "Return the image of the tasks of RUNNER, none of which goes on meanwhile: at most MOST rows, and
without the parts of those tasks whose numbers are among FOLDED."
  (let ((plans (plan-runner-tasks runner)))
    (make-tree-image :tick (plan-runner-tick runner) :rows (rows-of-tasks plans folded most)
                     :plans (length plans) :tasks (runner-alive runner))))

(defun runner-mark (runner)
  "Return what changes, for EQUAL, whenever the tasks of RUNNER do; for any thread, and at once."
  (list (plan-runner-steps runner) (runner-alive runner) (runner-serial runner)
        (runner-blocks runner) (and (runner-stepper runner) t)))
