;;;; places.lisp -- where a task is in its plan, as data, and which task is there.

(in-package :ars-magna.rpl.tasks)

;;; A place is a list. First comes the plan: its name, its number, or (name number) if several plans
;;; of that name are under way. Then, for each step inwards, which part: (:tag name), or the number
;;; of the branch, from 0. It stays true when the task is over.

(defun top-place (task)
  (cond ((null (task-name task)) (task-serial task))
        ((find (task-name task) (remove task (runner-roots (task-runner task))) :key #'task-name)
         (list (task-name task) (task-serial task)))
        (t (task-name task))))

(defun part-place (task)
  (let ((name (task-name task)))
    (cond ((null name) (task-index task))
          ((find name (remove task (task-children (task-parent task))) :key #'task-name)
           (list :tag name (task-index task)))
          (t (list :tag name)))))

(addition task-place)
(defun task-place (task)
  "Return where TASK is in its plan, a list that can be printed, read, and given to FIND-TASK: the
name or number of the plan, and for each step inwards (:tag name), or the number of the branch,
from 0. Where tasks have the same name, their number comes after it. A task that has not started is
nowhere: NIL (CRAM's paths go from the inside out, and have the operators' names)."
  (check-argument task-place task (task-p task) "a task, as begin-plan returns")
  (unless (eq (task-state task) :created)
    (destructuring-bind (top . parts) (reverse (lineage task))
      (cons (top-place top) (mapcar #'part-place parts)))))

(defun at-place-p (task step)
  (typecase step
    (integer (= step (if (task-parent task) (task-index task) (task-serial task))))
    ((cons (eql :tag) (cons t list))
     (and (at-place-p task (second step))
          (or (null (cddr step)) (eql (third step) (task-index task)))))
    ((cons symbol (cons integer null))
     (and (at-place-p task (first step)) (= (second step) (task-serial task))))
    ((or symbol string) (and step (task-name task) (same-name-p step (task-name task))))))

(addition find-task)
(defun find-task (place &optional (within *runner*))
  "Return the task under way at PLACE, as TASK-PLACE returns, or whose number PLACE is; NIL if there
is none. WITHIN is a plan runner, or a task, whose parts PLACE then starts with."
  (check-argument find-task within (or (task-p within) (plan-runner-p within))
                  "a plan runner, such as (rpl-runner), or a task")
  (if (integerp place)
      (find place (mapcan #'all-tasks (parts-of within)) :key #'task-serial)
      (loop with tasks = (parts-of within)
            for (step . more) on place
            for task = (find-if (lambda (task) (at-place-p task step)) tasks)
            while (and task more) do (setf tasks (task-children task))
            finally (return task))))

(defun parts-of (within)
  (if (task-p within) (task-children within) (plan-runner-tasks within)))

(addition task-source)
(defun task-source (task)
  "Return the source of all that TASK runs, as data: the form of a branch; of a top-level task the
text of its plan, as PROCEDURE-SOURCE does, or, if it has no name or has been defined anew since, of
that plan's body."
  (check-argument task-source task (task-p task) "a task, as begin-plan returns")
  (let ((procedure (and (null (task-parent task))
                        (find (task-node task) (all-procedures) :key #'procedure-body))))
    (if procedure
        (procedure-source procedure)
        (node-form (task-node task)))))
