;;;; blocking.lisp -- keeping tasks from running, and letting them go on.

(in-package :ars-magna.rpl.tasks)

(export '(block-task check-together make-heed unblock-task))

;;; A blocked task keeps its place, with all that it consists of: what it waits for still counts,
;;; and it runs again when nobody blocks it any longer. The expressions that it is at may want to do
;;; something when that happens: those whose frame's DATA is a HEED.

(define-record (heed (:constructor make-heed (function)))
  "What an expression does when its task is blocked: FUNCTION is called with the task and the
frame."
  (function #'list function))
(declaim-final heed)

(defun tell-blocked (task)
  "Let the parts of TASK, newest first, and then its own expressions, innermost first, know that
they do not run; but not those that did not run before."
  (unless (task-doomed task)
    (dolist (child (reverse (task-children task)))
      (unless (plusp (task-blocked child)) (tell-blocked child)))
    (dolist (frame (frame-chain (task-frame task)))
      (when (heed-p (frame-data frame))
        (funcall (heed-function (frame-data frame)) task frame)))))

(defun interrupt-parts (task)
  "If the running task is a part of TASK let it give way after this step."
  (let* ((runner (task-runner task))
         (current (runner-current runner)))
    (when (and current (eq (task-state current) :running) (part-of-p current task))
      (setf (runner-mask runner) (logior +interrupt+ (runner-mask runner))))))

(defun block-task (task &optional suspension)
  "Keep TASK from running once more; SUSPENSION says whether its status shows it as suspended."
  (let ((blocked (blocked-p task)))
    (incf (task-blocked task))
    (when suspension (incf (task-suspensions task)))
    (note-status task (if (under-way-p task) :running (task-state task)))
    (when (under-way-p task)
      (incf (runner-blocks (task-runner task)))
      (note-event task :block)
      (interrupt-parts task)
      (unless blocked (tell-blocked task)))))

(defun unblock-task (task &optional suspension)
  "Undo one BLOCK-TASK with the same SUSPENSION."
  (decf (task-blocked task))
  (when suspension (decf (task-suspensions task)))
  (when (under-way-p task)
    (decf (runner-blocks (task-runner task)))
    (unless (plusp (task-blocked task)) (note-event task :unblock))
    (note-status task :running)
    (release-held (task-runner task))))

(defun check-together (task other)
  "Signal MISUSE if TASK, which runs, and OTHER belong to different plan runners."
  (when (and (task-runner other) (not (eq (task-runner task) (task-runner other))))
    (reject-use "~A is part of plans of another robot, which go on by themselves. From here it can ~
                 only be asked to SUSPEND and WAKE-UP."
                (task-label other))))

;;; By a word, instead of as long as something lasts.

(defun say-in-plans (word task function)
  "Call FUNCTION, which does what the function WORD says of TASK, when the plan of that can hear of
it: now, if a plan of the same runner asks, or TASK is in none; else, posted to its runner, before
that reacts again. Return TASK."
  (let ((runner (task-runner task)))
    (cond ((inside-plans-p runner) (funcall function))
          (t (note-from-outside word task)
             (post runner function))))
  task)

(addition suspend)
(defun suspend (task)
  "Keep TASK, and what it consists of, from running until WAKE-UP, and return it. What it waits for
still counts. A second SUSPEND changes nothing. A task that suspends itself, or what it is part of,
stops after the step that it is at. One that has not started will wait when it is, one that
evaporates is not kept, and a suspended part does not keep the whole from ending. From a REPL or
another thread it is heard before the plans react again (CRAM's)."
  (check-argument suspend task (task-p task) "a task, such as the name of a :tag")
  (let ((task (task-meant task)))
    (say-in-plans #'suspend task
                  (lambda ()
                    (unless (or (task-suspended task) (task-over-p task))
                      (setf (task-suspended task) t)
                      (block-task task t))))))

(addition wake-up)
(defun wake-up (task)
  "Let TASK, if SUSPEND keeps it, run again, and return it; WITH-TASK-BLOCKED and the like are not
undone. From anywhere, as SUSPEND (CRAM's)."
  (check-argument wake-up task (task-p task) "a task, such as the name of a :tag")
  (let ((task (task-meant task)))
    (say-in-plans #'wake-up task
                  (lambda ()
                    (when (shiftf (task-suspended task) nil)
                      (unblock-task task t))))))
