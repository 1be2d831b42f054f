;;;; awaiting.lisp -- what tasks wait for, in words and for traces.

(in-package :ars-magna.rpl.tasks)

(export '(awaited-text))

(defgeneric awaited-text (awaited)
  (:documentation "Return in words what a task that waits for AWAITED waits for.")
  (:method (awaited) (safe-text awaited :escape nil))
  (:method ((fluent fluent)) (fluent-text fluent))
  (:method ((watcher watcher)) (fluent-text (watcher-fluent watcher)))
  (:method ((timer timer))
    (format nil "tick ~D" (timer-due timer))))

(defgeneric traced-subject (awaited)
  (:documentation "Return what a trace keeps of AWAITED, that a task waits for: no task.")
  (:method (awaited) awaited)
  (:method ((watcher watcher)) (watcher-fluent watcher))
  (:method ((timer timer)) (timer-due timer)))

(addition task-awaits)
(defun task-awaits (task)
  "Return in words what TASK waits for: a fluent or network, a tick, a valve; NIL if it does not, or
waits for its own parts."
  (and (eq (task-state task) :waiting)
       (task-awaiting task)
       (awaited-text (task-awaiting task))))
