;;;; clashes.lisp -- tasks side by side that interrupt each other's commands are told of, once.

(in-package :ars-magna.rpl-robot)

;;; The newer command counts (manual 3.1.2), and that is often what a plan is for: a policy, or what
;;; waits for an event, takes the robot on purpose. But branches of a PAR are all to succeed, and
;;; plans that were begun one after the other know nothing of each other.

(defun all-to-succeed-p (task)
  (let ((frame (task-frame task)))
    (and frame
         (operator-called-p (node-form (frame-node frame)) "PAR" "PAR-LOOP" "PARTIAL-ORDER"))))

(defun reacting-to-events-p (task whole)
  "True if TASK, a part of WHOLE (NIL: of nothing), runs what a construct does when something
happens."
  (loop for each in (lineage task)
        until (eq each whole)
        thereis (loop for frame in (frame-chain (task-frame each))
                      thereis (operator-called-p (node-form (frame-node frame))
                                                 "WHENEVER" "AT-LOCATION"))))

(defun watches-p (task)
  "True if TASK waits in a loop, or for whatever may come: to wait is what it is for."
  (find-if (lambda (form) (operator-called-p form "LOOP" "WHENEVER"))
           (plan-backtrace task (task-frame task))))

(defun clash-p (older newer)
  "True if the task OLDER, whose command NEWER has interrupted, most likely did not expect that."
  (and older newer
       (not (eq older newer))
       (not (task-over-p older))
       (not (evaporating-p older))
       (<= (task-level newer) (task-level older))
       (let ((common (find-if (lambda (whole) (part-of-p newer whole)) (lineage older))))
         (and (not (member common (list older newer)))
              (or (null common) (all-to-succeed-p common))
              (not (reacting-to-events-p newer common))))))

(defun deed-text (deed)
  (let ((task (deed-task deed)))
    (format nil "rpl-~(~A~) of ~@[~A in ~]the plan ~A"
            (deed-name deed)
            (and (task-parent task) (task-label task))
            (task-label (task-top task)))))

(defun gentle-p (deed)
  "True if DEED takes no time, stops the robot, or cleans up."
  (or (deed-cleanup-p deed)
      (command-instant-p (deed-command deed))
      (trait-p :stops (deed-command deed))))

(defun tell-of-clash (interface older newer)
  "Say once if the deed NEWER of INTERFACE has interrupted the deed OLDER of a task beside its own."
  (when (and newer
             (clash-p (deed-task older) (deed-task newer))
             (not (gentle-p newer))
             ;; Who gives way to a higher priority expects it.
             (notany (lambda (loser) (part-of-p (deed-task older) loser))
                     (valve-losers (interface-valve interface))))
    (let ((interrupted (deed-text older)) (by (deed-text newer)))
      (tell-once interface (list :clash interrupted by)
                 "~A was interrupted by ~A, which runs beside it: ~A carries out one command at a ~
                  time. Give them one after the other, or let each task have the robot while it ~
                  needs it: (with-valve ((rpl-robot-valve)) ...)."
                 interrupted by (deed-resource older)))))

;;; A task that gives one command after the other has forgotten to wait, or waits for a tick only.

(defun step-before (task)
  "Return the form of the innermost list of steps in TASK that it did before the one it is at."
  (dolist (frame (frame-chain (task-frame task)))
    (let ((form (node-form (frame-node frame))))
      (when (operator-called-p form "SEQ")
        (let ((at (current-form (frame-node frame) frame)))
          (return (first (last (ldiff (rest form) (member at form :test #'equal))))))))))

(defun hurry (older newer)
  "Return how many ticks, 0 or 1, the deed OLDER was given by its task, which cuts it short by the
deed NEWER, most likely by mistake; NIL if that may be meant, as where it reacts to an event."
  (let ((task (deed-task older)) (ticks (- (deed-tick newer) (deed-tick older))))
    (and task
         (eq task (deed-task newer))
         (not (gentle-p older))
         (not (gentle-p newer))
         (not (reacting-to-events-p task nil))
         (or (= 0 ticks)
             (and (= 1 ticks)
                  ;; One may drive on for a tick, too.
                  (not (trait-p :drives (deed-command older)))
                  (operator-called-p (step-before task) "WAIT-TIME")
                  (not (watches-p task))))
         ticks)))

(defun tell-of-hurry (interface older newer)
  "Say once if the deed NEWER of INTERFACE has cut the deed OLDER short before that has begun, or
just after."
  (let ((ticks (and newer (hurry older newer))))
    (when ticks
      (tell-once interface (list :hurry-in-plan (deed-name older) (deed-name newer))
                 "rpl-~(~A~) of the plan ~A ~:[was cut off after a tick, as rpl-~(~A~) was given~;~
                  does nothing: rpl-~(~A~) was given before a tick has passed~], and ~A carries ~
                  out one command at a time.~@[ Wait for the end of the first before it: ~A.~]"
                 (deed-name older) (task-label (task-top (deed-task older))) (= 0 ticks)
                 (deed-name newer) (deed-resource older)
                 (wait-text (deed-outcome older) (deed-resource older))))))
