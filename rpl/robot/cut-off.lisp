;;;; cut-off.lisp -- plans that were begun, headless, and that the end of the run cuts off.

(in-package :ars-magna.rpl-robot)

;;; Programs begin plans that never end, and stop when they have seen enough. Loops and policies say
;;; so, and RUN-UNTIL, PRINT-PLANS and the like do, see NOTE-LOOKED-AFTER. What is left are plans
;;; that would have ended, had more ticks passed.

(defun cut-off-p (interface task)
  "True if TASK, of the plans of INTERFACE, is under way and would have ended by itself."
  (not (or (task-parent task)
           (task-over-p task)
           (member task (interface-unwanted interface))
           (said-p (list :stranded (task-label task))
                   (simulation-world (interface-simulation interface)))
           (some #'watches-p (all-tasks task)))))

(defmethod note-seen ((interface interface))
  (note-looked-after (simulation-world (interface-simulation interface))))

(defmethod participant-cut-off ((interface interface))
  (when (interface-valid-p interface)
    (with-plans (interface)
      (loop for task in (tasks-of interface)
            when (cut-off-p interface task)
              collect (format nil "the plan ~A" (task-label task))))))
