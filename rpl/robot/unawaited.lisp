;;;; unawaited.lisp -- commands that go on after the plan that gave them has succeeded.

(in-package :ars-magna.rpl-robot)

;;; That is allowed (reading 185), but most often a wait has been forgotten. Not counted are
;;; commands that take no time and do more than look, go on in the background, stop the robot, or
;;; were given to clean up.

(defun unawaited-deeds (interface task)
  "Return what the top-level TASK, of INTERFACE, has asked for and is under way."
  (remove-if-not (lambda (deed)
                   (and (deed-open-p deed)
                        (or (ends-by-command-p deed)
                            (trait-p :asks (deed-command deed)))
                        (not (trait-p :stops (deed-command deed)))
                        (not (deed-cleanup-p deed))
                        (deed-task deed)
                        (eq task (task-top (deed-task deed)))))
                 (interface-deeds interface)))

(defun unawaited-advice (deed)
  "Return in a sentence what to do if DEED is not to be under way when its plan has succeeded; or
NIL."
  (if (eq :evaporated (task-state (deed-task deed)))
      (format nil "What gave it was ended before, as by a deadline. ~
                   If the command is to end as well, stop it: (rpl-robot-stop).")
      (let ((wait (wait-text (deed-outcome deed) (deed-resource deed))))
        (and wait (format nil "If the plan is to end with it, let it ~A." wait)))))

(defun tell-of-unawaited (interface task)
  (let ((deed (first (unawaited-deeds interface task))))
    (when deed
      (tell-once interface (list :unawaited (task-label task))
                 "The plan ~A succeeded while its command rpl-~(~A~) was under way, which goes ~
                  on.~@[ ~A~]"
                 (task-label task) (deed-name deed) (unawaited-advice deed)))))
