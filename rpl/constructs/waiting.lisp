;;;; waiting.lisp -- wait-for: waiting for a fluent.

(in-package :ars-magna.rpl.constructs)

(defun wake-waiter (watcher value trouble)
  "Let the task that WATCHER is for go on with VALUE, or fail of TROUBLE: it heard what it wanted."
  (let ((task (watcher-client watcher)))
    (unwatch watcher)
    (when (eq watcher (task-awaiting task))
      (wake-from-wait task value trouble))))

(defun wake-from-wait (task value trouble)
  (when (task-timer task)
    (cancel-timer (task-timer task) (runner-timers (task-runner task)))
    (setf (task-timer task) nil))
  (when trouble
    (setf (task-signal task) (failure-of trouble task (task-frame task))))
  (wake task value))

(defun wait-for-no-fluent (task)
  (park task +no-fluent+)
  (warn-of-no-fluent task))

(defun wait-until-heard (task condition)
  "Let TASK wait until CONDITION, a fluent that is false, changes. Another object never does."
  (if (fluent-p condition)
      (let ((watcher (make-watcher condition #'wake-waiter task)))
        (watch watcher)
        (park task watcher)
        ;; Another thread may have set it since it was looked at.
        (let ((value (fluent-value condition)))
          (when value (wake-waiter watcher value nil))))
      (wait-for-no-fluent task)))

(defun checked-timeout (timeout)
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
  (:parts (fluent function (awaited-lambda fluent form scope))
          (timeout function (value-lambda timeout scope)))
  (:steps
   (begin
    (let* ((fluent (funcall fluent environment))
           (value (fluent-value fluent))
           (timeout (if value nil (checked-timeout (funcall timeout environment)))))
      (cond (value
             (unless (fluent-p fluent) (doubt-awaited task value))
             (values (frame-up frame) value))
            ((and timeout (<= (the real timeout) 0)) (values (frame-up frame) nil))
            (t (next waiting)
               (when timeout (start-timer task timeout))
               (wait-until-heard task fluent)
               +parked+))))
   (waiting (values (frame-up frame) value))))
