;;;; stranded.lisp -- plans that were begun, headless, and that nothing in the run will wake.

(in-package :ars-magna.rpl-robot)

;;; Programs may set fluents between two calls of RUN-TICKS. So it is a warning, once for each plan
;;; and run. Whether it is also shown to who reads no messages depends on what the plan waits for:
;;; a program is not likely to set what the robot sets.

(defun watches-p (task)
  "True if TASK waits in a loop, or for whatever may come: to wait is what it is for."
  (find-if (lambda (form)
             (and (consp form) (member (first form) '("LOOP" "WHENEVER") :test #'string=)))
           (plan-backtrace task (task-frame task))))

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

(defun still-waiting-p (parts awaited)
  "True if PARTS of a plan wait for what they AWAITED."
  (every (lambda (part awaiting) (eq awaiting (task-awaiting part))) parts awaited))

(defun warn-of-stranded (interface task parts)
  "Say once that TASK, of the plans of INTERFACE, will not go on, as PARTS of it wait in vain."
  (let ((awaited (mapcar #'task-awaiting parts)))
    (warn-once (list :stranded (task-label task))
               (simulation-world (interface-simulation interface))
               (list "At tick " (simulation-tick (interface-simulation interface)) " "
                     (text-of-plans (list task)) ", which nothing in the run will change."
                     (advice-on-stillness parts))
               :notable (lambda ()
                          (and (every #'robots-wait-p parts)
                               (still-waiting-p parts awaited))))))

(defun look-for-stranded (interface task)
  "Say so if TASK, a plan, was begun and waits in vain."
  (let ((parts (waiting-parts task)))
    (when (and parts
               (notany #'watches-p parts)
               (or (every #'robots-wait-p parts)
                   (not (others-may-help-p interface))))
      (warn-of-stranded interface task parts))))

(defmethod participant-after-ticks ((interface interface) simulation)
  (when (and (null (interface-awaited interface))
             (not (simulation-over simulation))
             (tasks-of interface)
             (deadlocked-p interface))
    (with-plans (interface)
      (dolist (task (tasks-of interface)) (look-for-stranded interface task)))))
