;;;; failures.lisp -- which command failed last on a robot, and why: for people to read.

(in-package :ars-magna.command)

(export '(failure-sentences))

(defun argument-as-typed (argument)
  "Return ARGUMENT of a command as one would type it in Lisp, as far as one can."
  (let ((index (and (part-p argument) (part-index argument))))
    (typecase argument
      (robot (robot-name argument))
      (camera `(robot-camera ,(robot-name (part-robot argument)) ,index))
      (hand `(robot-hand ,(robot-name (part-robot argument)) ,index))
      (storage-bin `(robot-storage-bin ,(robot-name (part-robot argument)) ,index))
      (designator `(find-designator ,(robot-name (designator-robot argument))
                                    ,(designator-number argument)))
      ((or symbol cons) (if (constantp argument) argument `',argument))
      (t argument))))

(defun call-text (failure)
  "Return what was asked for, as one would type it in Lisp."
  (let ((*print-case* :downcase) (*read-default-float-format* 'double-float))
    (safe-text (list* (failure-command failure)
                     (mapcar #'argument-as-typed
                             (cons (failure-resource failure) (failure-arguments failure)))))))

(defun robot-with (resource)
  "Return the robot that RESOURCE, a robot or part of one, is or belongs to."
  (if (robot-p resource) resource (part-robot resource)))

(addition last-failure)
(defun last-failure (resource)
  "Return, as a property list, what failed or was interrupted last of the commands given to
RESOURCE, a robot or part of one, or to another part of that robot: :COMMAND, its name; :CALL, what
was asked for, a string; :FOR, who asked; :ASKED, the tick after which that was; :TICK, the one in
which it ended; :ERROR, the code; :TEXT, the message; :BY, what interrupted it, if that is known,
and :BY-FOR, who asked for that. NIL if none has failed. See WHY."
  (check-resource 'last-failure resource)
  (let ((failure (robot-failure (robot-with resource))))
    (when failure
      (destructuring-bind (&optional by by-asker) (failure-interrupter failure)
        (list :command (failure-command failure) :call (call-text failure)
              :for (note-text (failure-asker failure))
              :asked (failure-asked failure) :tick (failure-tick failure)
              :error (failure-code failure) :text (failure-text failure)
              :by by :by-for (and by (note-text by-asker)))))))

(defun failure-sentences (resource)
  "Return a list of sentences about the LAST-FAILURE of RESOURCE: what was asked for and when, what
came of it, what that means and what to try."
  (destructuring-bind (&key call for asked tick error text by by-for &allow-other-keys)
      (last-failure resource)
    (if (null error)
        (list (format nil "No command of ~A has failed." (robot-with resource)))
        (remove nil
                (list (format nil "~A, asked for by ~A after tick ~D, ended at tick ~D with ~S: ~A."
                              call for asked tick error text)
                      (and by (format nil "What took over was ~(~A~), asked for by ~A." by by-for))
                      (error-code-meaning error)
                      (error-code-remedy error))))))
