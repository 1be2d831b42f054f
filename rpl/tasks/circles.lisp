;;;; circles.lisp -- tasks that wait for each other, so that none can go on.

(in-package :ars-magna.rpl.tasks)

(export '(hinderers hindrance-text report-circle taken-from those-who-took-from))

;;; A task is stuck if what it waits for can only come from tasks that are stuck. A task with parts
;;; is stuck if all of them are, policies, which only watch, not counted. Where it is not known who
;;; could help, somebody may: that is left to the report of deadlocks when nothing goes on any more.

(defgeneric hinderers (awaited)
  (:documentation "Return the tasks without which AWAITED cannot come; NIL if that is unknown.")
  (:method (awaited)
    (declare (ignore awaited))
    '()))

(defgeneric taken-from (task data)
  (:documentation "Return the tasks that keep TASK from running by having what DATA, of one of its
frames, is about.")
  (:method (task data)
    (declare (ignore task data))
    '()))

(defun those-who-took-from (task)
  "Return the tasks that keep TASK, or what it is part of, from running by having what it needs."
  (loop for each in (lineage task)
        append (loop for frame in (frame-chain (task-frame each))
                     append (taken-from each (frame-data frame)))))

(defun working-parts (task)
  "Return the innermost parts of TASK that are at its own level."
  (let ((children (remove (task-level task) (task-children task) :key #'task-level :test #'<)))
    (if children
        (loop for child in children append (working-parts child))
        (list task))))

(defun obstacles (task)
  "Return the tasks without which TASK, which is no more than one task, cannot go on; NIL if that is
unknown."
  (or (and (task-awaiting task) (hinderers (task-awaiting task)))
      (those-who-took-from task)))

(defun stuck-tasks (task)
  "Return TASK and the tasks that wait for each other with it, or NIL if some of them can go on."
  (let ((stuck '()) (open (list task)))
    (loop while open
          do (let* ((next (pop open)) (others (obstacles next)))
               (unless others (return-from stuck-tasks '()))
               (pushnew next stuck)
               (dolist (part (mapcan #'working-parts others))
                 (unless (or (member part stuck) (member part open))
                   (push part open)))))
    (reverse stuck)))

(defgeneric hindrance-text (awaited)
  (:documentation "Return in words what a task that is stuck waits for.")
  (:method (awaited) (awaited-text awaited)))

(defun wait-text (task)
  "Return in words what TASK waits for, as TASK-AWAITS does, and who has it if that is known."
  (and (task-awaits task)
       (if (hinderers (task-awaiting task))
           (hindrance-text (task-awaiting task))
           (task-awaits task))))

(defun stuck-text (task)
  (let ((awaiting (task-awaiting task)))
    (if (and awaiting (hinderers awaiting))
        (format nil "~A waits for ~A" (task-label task) (hindrance-text awaiting))
        (let ((names (mapcar #'task-label (those-who-took-from task))))
          (format nil "~A waits until ~{~A~^ and ~} ~:[gives~;give~] back what was taken from it"
                  (task-label task) names (rest names))))))

(defun tell-of-circle (tasks)
  "Queue a warning: TASKS wait for each other. What they are parts of may still end one of them."
  (warn-notably "Deadlock at tick " (runner-tick (task-runner (first tasks))) ": "
                (format nil "~{~A~^; ~}" (mapcar #'stuck-text tasks))
                ". None can go on until one of them is ended, as by a deadline."))

(defun report-circle (task)
  "Queue a warning if TASK, which has come to wait, waits in a circle."
  (let ((tasks (stuck-tasks task)))
    (when tasks (tell-of-circle tasks))))

;;; As long as a part of a task goes on, the task is not stuck. A circle through it may close when
;;; that part ends.

(defun first-working-part (task)
  (let ((child (loop for child = (task-newest-child task) then (task-older child)
                     while child
                     when (<= (task-level child) (task-level task)) return child)))
    (if child (first-working-part child) task)))

(defun hinders-p (task others)
  "True if TASK, or one that it is part of, is an obstacle to one of OTHERS."
  (some (lambda (other)
          (some (lambda (obstacle) (part-of-p task obstacle)) (obstacles other)))
        others))

(defun report-circle-left (task)
  "Queue a warning if the parts that TASK is left with, as one has ended, wait in a circle
through it."
  (when (and (task-newest-child task) (null (task-signal task)))
    (let* ((part (first-working-part task))
           (tasks (and (or (task-awaiting part) (plusp (task-blocked part)))
                       (stuck-tasks part))))
      (when (hinders-p task tasks) (tell-of-circle tasks)))))
