;;;; soundness.lisp -- check commands in progress that were read from a file.

(in-package :ars-magna.command)

(export '(check-commands))

(defun step-fits-p (operation)
  (let ((fits-p (get (operation-step operation) 'step)))
    (if (eq :guarded fits-p)
        (command-guarded-p (operation-command operation))
        (funcall fits-p operation))))

(defun arguments-fit-p (operation)
  (let ((command (operation-command operation)) (arguments (operation-arguments operation)))
    (or (manipulation-command-p command)
        (and (= (length arguments) (length (command-parameters command)))
             (every (lambda (spec argument) (argument-of-type-p argument (spec-type spec)))
                    (cons (command-resource command) (command-parameters command))
                    (cons (named-resource operation) arguments))))))

(defun check-operation (operation)
  (must-hold (and (command-p (request-operator operation))
                  (eq #'run-operation (event-function operation))
                  (eq #'interrupt-operation (event-interrupt operation))
                  (typep (operation-resource operation) 'resource)
                  (proper-list-p (operation-arguments operation)))
             "a command in progress is invalid")
  (let ((name (command-name (operation-command operation))))
    (must-hold (eq (operation-resource operation)
                   (occupied-resource (operation-command operation) (named-resource operation)))
               "~(~A~) does not occupy its resource" name)
    (must-hold (arguments-fit-p operation) "~(~A~) does not have the arguments that it needs" name)
    (when (operation-step operation)
      (must-hold (step-p (operation-step operation))
                 "~(~A~) would continue with a function that is no step of a command" name)
      (must-hold (step-fits-p operation) "~(~A~) would continue with a step of another ~
                                          command" name))
    (must-hold (eq (operation-timeline operation)
                   (timeline-of (named-resource operation)))
               "~(~A~) is in progress in another run" name)))

(defmethod check-request ((operation operation))
  (check-operation operation))

(defmethod check-request ((withdrawal withdrawal))
  (must-hold (and (null (withdrawal-continuation withdrawal))
                  (typep (request-arguments withdrawal)
                         '(cons resource (cons (member :command :track nil) null))))
             "a withdrawal of a command is invalid"))

(defun check-commands (timeline events)
  "Signal CONTRADICTION unless EVENTS, which wait in the agenda of TIMELINE, can be carried out."
  (dolist (event events)
    (check-request event)
    (must-hold (and (operation-p event)
                    (operation-step event)
                    (not (operation-finished-p event))
                    (eq timeline (operation-timeline event)))
               "an event in the agenda is no command in progress")))
