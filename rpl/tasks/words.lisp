;;;; words.lisp -- what is said to plans from outside of them, by SUSPEND, EVAPORATE and the like.

(in-package :ars-magna.rpl.tasks)

(export '(note-word task-now))

;;; Plans do again by themselves what they did, given what they were told. So whoever is to repeat a
;;; run must know what was said to its plans from outside: each word that can be notes itself, with
;;; the task or plan runner that it is said to.

(defgeneric note-word (client word arguments subject)
  (:documentation "Take note that somebody who is not at work in the plans of CLIENT, see
RUNNER-CLIENT, calls the function WORD with the list ARGUMENTS and then SUBJECT, a task of theirs or
their plan runner.")
  (:method (client word arguments subject)
    (declare (ignore client word arguments subject))
    (values)))

(defgeneric task-now (client task)
  (:documentation "Return what TASK, one of the plans of CLIENT, is in the run that this thread
works in, or that goes on since that of TASK was rewound: TASK itself if it is not there.")
  (:method (client task)
    (declare (ignore client))
    task))

(defun inside-plans-p (runner)
  "True if there is no RUNNER, or this thread is at work in its plans."
  (or (null runner) (eq runner *runner*)))

(defun task-meant (task)
  "Return TASK; if somebody outside of its plan means it, what has become of it."
  (let ((runner (task-runner task)))
    (if (inside-plans-p runner)
        task
        (task-now (runner-client runner) task))))

(defun note-from-outside (word subject &rest arguments)
  "Note that the function WORD is called with ARGUMENTS and then SUBJECT, a task or a plan runner,
if that comes from outside of the plans of SUBJECT."
  (let ((runner (if (task-p subject) (task-runner subject) subject)))
    (unless (inside-plans-p runner)
      (note-word (runner-client runner) word arguments subject))))
