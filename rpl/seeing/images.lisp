;;;; images.lisp -- the tree of tasks as data that never change, for those who draw it.

(in-package :ars-magna.rpl.seeing)

(export '(image-of-tasks runner-mark task-image))

;;; An image is made where no plan goes on, as between two ticks; whoever draws from it may do so in
;;; any thread. It has the rows that are to be seen, from top to bottom, and no more than so many of
;;; them: what is left out, or folded away, is only counted.

(define-record task-image
  "What is to be seen of a task."
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
