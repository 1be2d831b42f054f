;;;; awaiting.lisp -- what tasks wait for, in words and for traces.

(in-package :ars-magna.rpl.tasks)

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
