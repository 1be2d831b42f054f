;;;; outside.lisp -- commands that no plan has given, while a plan waits to hear of such an end.

(in-package :ars-magna.rpl-robot)

;;; Fluents tell plans how their own commands end. What the prompt or a program has told the robot
;;; to do ends unheard, and a plan such as (whenever robot-stopped* ...) stays silent. Plans that
;;; wait once are named where that is said of all that wait in vain; see stranded.lisp.

(defun watcher-of-end (interface command)
  "Return a top-level task of INTERFACE, which this thread holds, that watches for the end of
commands of the robot such as COMMAND; or NIL."
  (let ((pulse (symbol-value (pulse-of-command command))))
    (find-if (lambda (task)
               (let ((parts (waiting-parts task)))
                 (and (some #'watches-p parts) (member pulse (fluents-awaited parts)))))
             (tasks-of interface))))

(defun tell-of-outside (interface command)
  (let ((task (call-with-plans-if-free (lambda () (watcher-of-end interface command)) interface)))
    (when task
      (tell-once interface (list :outside (task-label task))
                 "~(~A~) has ended. No plan has given it, so the plan ~A, which waits for ~A, does ~
                  not hear of it. Let a plan give it: ~A."
                 command (task-label task)
                 (fluent-text (symbol-value (pulse-of-command command)))
                 (twin-text command)))))

(defun look-for-outside (interface)
  (let* ((robot (interface-robot interface))
         (event (resource-event robot))
         (command (and (operation-p event)
                       (not (find robot (interface-deeds interface) :key #'deed-resource))
                       (command-name (operation-command event))))
         (before (shiftf (interface-outside interface) command)))
    (when (and before (null command) (pulse-of-command before) (tasks-of interface))
      (tell-of-outside interface before))))
