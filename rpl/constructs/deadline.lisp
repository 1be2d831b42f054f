;;;; deadline.lisp -- with-deadline: what must be done in time or fails.

(in-package :ars-magna.rpl.constructs)

(addition deadline-missed deadline-missed-ticks)
(define-condition deadline-missed (plan-failure)
  ((ticks :initarg :ticks :initform nil :reader deadline-missed-ticks))
  (:documentation "What a WITH-DEADLINE is for was not done in time."))

(setf (documentation 'deadline-missed-ticks 'function)
      "Return how many ticks there were.")

(defmethod write-failure ((failure deadline-missed) stream)
  (format stream "Not done within ~A tick~:P" (deadline-missed-ticks failure)))

(defun miss-deadline (timer)
  "Let the task that TIMER is for fail, unless it is ending."
  (let* ((task (timer-client timer))
         (frame (task-frame task))
         (*asker* (list "the deadline of " (car (frame-data frame)) " ticks of task "
                        (task-serial task))))
    (unless (task-signal task)
      (decide task (failure-of (make-condition 'deadline-missed :ticks (car (frame-data frame)))
                               task frame)))))

(defun start-deadline (task ticks)
  "Let TASK miss its deadline in TICKS. Return what its frame is to remember."
  (let ((runner (task-runner task)))
    (cons ticks (set-timer (runner-timers runner) (+ (runner-tick runner) ticks)
                           #'miss-deadline task))))

(defun end-deadline (task memory)
  (when memory (cancel-timer (cdr memory) (runner-timers (task-runner task)))))

(define-construct with-deadline ((span &key unit) &body body)
  "Run BODY in a plan as a task of its own and return its value, one; if it has not ended SPAN ticks
after its start, or seconds if UNIT is :seconds, it evaporates, and then the whole fails with a
DEADLINE-MISSED. Its cleanups may take longer. Time goes on while it is suspended. SPAN is a number
up to 1e15; with 0 or less there is time for what takes none (ours; CRAM's is a timeout-policy)."
  (:arguments span)
  (:parts (span function (span-lambda 'with-deadline span unit form scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (next over)
    (setf memory (start-deadline task (max 0 (funcall span environment))))
    (start-branch body task environment 0 (task-level task))
    (await-parts task))
   (over (values (frame-up frame) value)))
  (:unwind
   (end-deadline task (shiftf memory nil))
   nil)
  (:child-ended
   (end-deadline task (shiftf memory nil))
   (or (fail-or-escape task how result)
       (complete task (and (eq how :succeeded) result)))))
