;;;; stranded.lisp -- plans that were begun, headless, and that nothing in the run will wake.

(in-package :ars-magna.rpl-robot)

;;; Programs may set fluents between two calls of RUN-TICKS. So it is a warning, once for each plan
;;; and run, and who reads no messages is shown it if the plan still waits when the run ends.

(defun others-may-help-p (interface)
  "True if what the run calls besides plans may set fluents: kickers, observers, other plans."
  (let ((simulation (interface-simulation interface)))
    (or (world-has-kickers-p (simulation-world simulation))
        (simulation-observers simulation)
        (rest (simulation-participants simulation)))))

(defun robots-wait-p (task)
  "True if TASK waits for nothing but what only the robot changes, or for what never changes."
  (or (eq +no-fluent+ (task-awaiting task))
      (let ((fluents (fluents-awaited (list task))))
        (and fluents (every #'robots-fluent-p fluents)))))

(defun stranded-parts (interface task)
  "Return the parts of TASK, a plan of INTERFACE, that wait in vain; NIL if it may go on."
  (let ((parts (waiting-parts task)))
    (and (notany #'watches-p parts)
         (or (every #'robots-wait-p parts)
             (not (others-may-help-p interface)))
         parts)))

(defun text-of-stranded (task parts)
  (format nil "~A, which nothing in the run will change.~A"
          (text-of-plans (list task)) (advice-on-stillness parts)))

(defun warn-of-stranded (interface task parts)
  "Say once that TASK, of the plans of INTERFACE, will not go on, as PARTS of it wait in vain."
  (let ((simulation (interface-simulation interface))
        (awaited (mapcar #'task-awaiting parts)))
    (warn-once (list :stranded (task-label task))
               (simulation-world simulation)
               (list "At tick " (simulation-tick simulation) " " (text-of-stranded task parts)
                     (if (and (live-p simulation) (notany #'robots-wait-p parts))
                         " So it waits until you do, as from a REPL."
                         ""))
               :notable (or (live-p simulation)
                            ;; Whether they still wait for that at the end.
                            (lambda () (equal awaited (mapcar #'task-awaiting parts)))))))

(defun deadlocked-p (interface)
  "True if plans of INTERFACE wait and nothing can ever wake them. For any thread."
  (and (null (hog-of interface))
       ;; What is published tells most cases apart without the lock.
       (not (ready-p interface))
       (with-plans (interface) (plan-deadlocked-p (interface-runner interface)))))

(defun stranded-plans (interface)
  "Return a list (task parts) for each plan of INTERFACE that was begun and waits in vain; () if one
of its plans can go on."
  (when (and (null (interface-awaited interface))
             (interface-valid-p interface)
             (tasks-of interface)
             (deadlocked-p interface))
    (with-plans (interface)
      (loop for task in (tasks-of interface)
            for parts = (stranded-parts interface task)
            when parts collect (list task parts)))))

(defun look-for-stranded (interface)
  "Say so if plans of INTERFACE were begun and wait in vain."
  (loop for (task parts) in (stranded-plans interface)
        do (warn-of-stranded interface task parts)))

(defmethod participant-after-ticks ((interface interface) simulation)
  (unless (simulation-over simulation) (look-for-stranded interface)))

(defun stranded-plan-text ()
  "Return in a sentence that a plan that was begun in the current simulation waits in vain, or NIL."
  (let ((interface (usable-interface)))
    (destructuring-bind (&optional task parts) (and interface (first (stranded-plans interface)))
      (and task (format nil "At the end ~A" (text-of-stranded task parts))))))
