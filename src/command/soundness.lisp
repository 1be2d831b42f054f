;;;; soundness.lisp -- commands under way that were put together from a file.

(in-package :ars-magna.command)

(export '(check-commands))

(defun step-fits-p (operation)
  "True if OPERATION is such as its step needs."
  (let ((fits-p (get (operation-step operation) 'step)))
    (if (eq :guarded fits-p)
        (command-guarded-p (operation-command operation))
        (funcall fits-p operation))))

(defun arguments-fit-p (operation)
  "True if OPERATION has arguments such as its command takes."
  (let ((command (operation-command operation)) (arguments (operation-arguments operation)))
    (or (manipulation-command-p command)
        (and (= (length arguments) (length (command-parameters command)))
             (every (lambda (spec argument) (argument-of-type-p argument (spec-type spec)))
                    (cons (command-resource command) (command-parameters command))
                    (cons (resource-told operation) arguments))))))

(defun check-operation (operation)
  "Signal CONTRADICTION unless OPERATION, put together from a file, could be under way or begin."
  (must-hold (and (command-p (request-operator operation))
                  (eq #'run-operation (event-function operation))
                  (eq #'interrupt-operation (event-interrupt operation))
                  (typep (operation-resource operation) 'resource)
                  (proper-list-p (operation-arguments operation)))
             "a command under way makes no sense")
  (let ((name (command-name (operation-command operation))))
    (must-hold (eq (operation-resource operation)
                   (occupied (operation-command operation) (resource-told operation)))
               "~(~A~) does not occupy what it should" name)
    (must-hold (arguments-fit-p operation) "~(~A~) has not the arguments that it needs" name)
    (when (operation-step operation)
      (must-hold (step-p (operation-step operation))
                 "~(~A~) would go on with what is no step of a command" name)
      (must-hold (step-fits-p operation) "~(~A~) would go on with what it has not" name))
    (must-hold (eq (operation-timeline operation)
                   (timeline-of (resource-told operation)))
               "~(~A~) is under way in another run" name)))

(defmethod check-request ((operation operation))
  (check-operation operation))

(defmethod check-request ((withdrawal withdrawal))
  (must-hold (and (null (withdrawal-continuation withdrawal))
                  (typep (request-arguments withdrawal)
                         '(cons resource (cons (member :command :track nil) null))))
             "a withdrawal makes no sense"))

(defun check-commands (timeline events)
  "Signal CONTRADICTION unless EVENTS, which wait in the agenda of TIMELINE, can be carried out."
  (dolist (event events)
    (check-request event)
    (must-hold (and (operation-p event)
                    (operation-step event)
                    (not (operation-finished-p event))
                    (eq timeline (operation-timeline event)))
               "what waits in the agenda is no command")))
