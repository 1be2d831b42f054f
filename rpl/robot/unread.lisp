;;;; unread.lisp -- commands that came to nothing, while the plan that gave them did not look.

(in-package :ars-magna.rpl-robot)

;;; Commands do not fail: fluents such as ROBOT-MOVEMENT-ERROR* tell how they have ended. A plan
;;; that reads none of these may succeed though nothing was done. Reading, waiting and networks all
;;; count as looking; being blocked and interrupted are left out, as plans make use of both.

(defparameter *codes-of-no-trouble*
  '(:interrupt :not-moving :goto-local :already-tracking
    :lost-track :grasping :not-grasping :grasp-lost :not-inside :bin-open)
  "Codes with which commands end that plans use, as those of the manual's appendix D do.")

(defun came-to-nothing-p (command err)
  "True if COMMAND, which ended with ERR, could not do what it is for."
  (and err
       (not (member err *codes-of-no-trouble*))
       (not (member err (command-expected command)))))

;; Plain data, so that forks have it, too.
(defstruct (unread-end (:type list) (:conc-name unread-)
                       (:constructor make-unread (plan command part err)) (:copier nil))
  "That COMMAND, a name, on the part numbered PART (NIL: the robot) has ended with ERR, of a plan
with the serial number PLAN."
  plan command part err)

(defun number-of-part (resource)
  (and (part-p resource) (part-index resource)))

(defun unread-fluents (unread)
  "Return the fluents that tell of UNREAD, that of its error the last."
  (loop for variable in (get (unread-command unread) 'result-fluents)
        for value = (symbol-value variable)
        collect (if (simple-vector-p value) (svref value (unread-part unread)) value)))

(defun still-unread-p (unread)
  (notany #'looked-at-p (unread-fluents unread)))

(defun note-unread (interface deed err)
  "Note that DEED of INTERFACE has ended with ERR, before anybody can have looked at that; it
supersedes how the same command ended before."
  (let ((command (deed-name deed)) (task (deed-task deed))
        (part (number-of-part (deed-resource deed))))
    (when (or err (interface-unread interface))
      (setf (interface-unread interface)
            (remove-if (lambda (unread)
                         (or (not (still-unread-p unread))
                             (and (eq command (unread-command unread))
                                  (eql part (unread-part unread)))))
                       (interface-unread interface))))
    (when (and task
               (came-to-nothing-p (deed-command deed) err)
               (not (deed-told-p deed))
               (not (deed-cleanup-p deed)))
      (let ((unread (make-unread (task-serial (task-top task)) command part err)))
        (mapc #'forget-looks (unread-fluents unread))
        ;; Who waits for one of them will be woken.
        (when (still-unread-p unread) (push unread (interface-unread interface)))))))

(defun take-unread (interface task)
  (flet ((of-task-p (unread) (eql (task-serial task) (unread-plan unread))))
    (prog1 (remove-if-not #'of-task-p (interface-unread interface))
      (setf (interface-unread interface) (remove-if #'of-task-p (interface-unread interface))))))

(defun tell-of-unread (interface task)
  "Say once if a command of TASK, a plan of INTERFACE that has succeeded, came to nothing, and
nobody has looked."
  (let ((unread (find-if #'still-unread-p (take-unread interface task)))
        (simulation (interface-simulation interface)))
    (when (and unread (not (message-queue-listener *message-queue*)))
      (warn-once (list :unread (task-label task)) (simulation-world simulation)
                 (format nil "The plan ~A succeeded, though its command rpl-~(~A~) ended with ~S, ~
                              and did not look at ~A. After the wait write (if (fluent-value ~
                              ~:*~A) (fail ...)), or what is to be done then."
                         (task-label task) (unread-command unread) (unread-err unread)
                         (fluent-form-text (first (last (unread-fluents unread)))))
                 :notable (or (live-p simulation) (lambda () (still-unread-p unread)))))))
