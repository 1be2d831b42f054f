;;;; waiting.lisp -- wait-for, whenever, wait-time.

(in-package :ars-magna.rpl.constructs)

(defun wake-waiter (watcher value trouble)
  "Let the task that WATCHER is for go on with VALUE, or fail of TROUBLE: it heard what it wanted."
  (let ((task (watcher-client watcher)))
    (unwatch watcher)
    (cond ((task-timer task)
           (cancel-timer (task-timer task) (runner-timers (task-runner task)))
           (setf (task-timer task) nil)))
    (when trouble
      (setf (task-signal task) (failure-of trouble task (task-frame task))))
    (wake task value)))

(defun time-out (timer)
  "Let the task that TIMER is for go on with NIL."
  (let ((task (timer-client timer)))
    (setf (task-timer task) nil)
    (stop-waiting task)
    (wake task nil timer)))

(defun start-timer (task ticks)
  "Let TASK be woken after TICKS."
  (let ((runner (task-runner task)))
    (setf (task-timer task)
          (set-timer (runner-timers runner) (+ (runner-tick runner) ticks) #'time-out task))))

;;; Waiting for a fluent.

(defun wait-until-heard (task condition)
  "Let TASK wait until CONDITION, a fluent that is false, changes. Another object never does."
  (if (fluent-p condition)
      (let ((watcher (make-watcher condition #'wake-waiter task)))
        (watch watcher)
        (park task watcher))
      (park task "what cannot change: no fluent")))

(defun checked-timeout (timeout)
  "Return TIMEOUT, a number of ticks or NIL, or its value. Signals WRONG-ARGUMENT."
  (let ((timeout (fluent-value timeout)))
    (check-argument wait-for timeout (or (null timeout) (quantity-p timeout))
                    "a number of ticks, from -1e15 to 1e15, or NIL")
    timeout))

(define-construct wait-for (fluent &key timeout)
  "Wait in a plan until FLUENT, or a network such as (and a (not b)), is true; not at all if it is
already. A pulse is enough. Return its value. After TIMEOUT ticks, if given, go on nevertheless and
return NIL (manual C). TIMEOUT is a number up to 1e15."
  (:manual)
  (:arguments fluent timeout)
  (:parts (fluent function (value-lambda fluent scope))
          (timeout function (value-lambda timeout scope)))
  (:steps
   (begin
    (let* ((fluent (funcall fluent environment))
           (value (fluent-value fluent))
           (timeout (if value nil (checked-timeout (funcall timeout environment)))))
      (cond (value (values (frame-up frame) value))
            ((and timeout (<= (the real timeout) 0)) (values (frame-up frame) nil))
            (t (next heard)
               (wait-until-heard task fluent)
               (when timeout (start-timer task timeout))
               +parked+))))
   (heard (values (frame-up frame) value))))

;;; Waiting for time.

(defun ticks-of (span unit)
  "Return SPAN, a number or fluent, of UNIT (:ticks or :seconds) in ticks."
  (let ((span (fluent-value span)))
    (check-argument wait-time span (quantity-p span) "a number from -1e15 to 1e15")
    (ecase unit
      (:ticks span)
      (:seconds (ceiling (* span (runner-ticks-per-second *runner*)))))))

(define-construct wait-time (span &key unit)
  "Wait in a plan for SPAN, counted in ticks, or in seconds if UNIT is
:seconds (manual D.4; reading 90). SPAN is a number up to 1e15; with 0 or less, the plan does not
wait."
  (:manual)
  (:arguments span)
  (:parts (span function (value-lambda `(ticks-of ,span (or ,unit :ticks)) scope)))
  (:steps
   (begin
    (next over)
    (let ((span (funcall span environment)))
      (cond ((plusp span)
             (park task (start-timer task span))
             +parked+)
            (t (values (frame-up frame) nil)))))
   (over (values (frame-up frame) nil))))
