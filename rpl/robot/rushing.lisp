;;;; rushing.lisp -- a plan that gives command after command, and lets no time pass, fails.

(in-package :ars-magna.rpl-robot)

(addition *plan-command-limit*)
(defparameter *plan-command-limit* 500
  "How many commands a plan may give its robot before time passes for it. To give one more fails
with class :TOO-MANY-COMMANDS. Commands that clean up do not count.")

(defun commands-in-tick (runner task)
  "Return a cons of TASK, a top-level task of RUNNER, and how many commands it has given in this
tick, and in those before that TAKEOVERS have cut short."
  (let ((tick (plan-runner-tick runner)) (note (runner-note runner 'commands)))
    (unless (and note (member (first note) (list tick (runner-note runner 'cut-short))))
      (setf note (setf (runner-note runner 'commands) (list tick))))
    (setf (first note) tick)
    (or (assoc task (rest note))
        (first (push (cons task 0) (rest note))))))

(defun fluent-form-text (fluent)
  "Return how plans write FLUENT, one of the robot's or of a part's."
  (let* ((name (fluent-text fluent)) (space (position #\Space name)))
    (if space
        (format nil "(vref ~A)" name)
        name)))

(defun wait-text (outcome resource)
  "Return how a plan waits for the end of a command on RESOURCE of which OUTCOME makes settings, or
NIL if nothing tells of that."
  (let ((pulse (assoc :pulse (funcall outcome resource :interrupt))))
    (and pulse (format nil "(wait-for ~A)" (fluent-form-text (second pulse))))))

(defun count-command (task command outcome resource)
  "Note that TASK gives COMMAND on RESOURCE, whose end OUTCOME makes settings of. Fail if its plan
has given as many as it may in this tick."
  (let ((count (commands-in-tick (task-runner task) (task-top task))))
    (when (< *plan-command-limit* (incf (cdr count)))
      (fail :class :too-many-commands :limit *plan-command-limit*
            :remedy (format nil "A loop gives rpl-~(~A~) without waiting, and no time passes. Put ~
                                 a wait into it, such as ~:[~;~:*~A or ~](wait-time 1); or, if ~
                                 parts of a plan take the robot from one another, let each own ~
                                 it: (with-valve ((rpl-robot-valve)) ...)"
                            (command-name command) (wait-text outcome resource))))))
