;;;; time.lisp -- wait-time, and other waiting that ends with time.

(in-package :ars-magna.rpl.constructs)

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

(defun ticks-of (span unit)
  "Return SPAN, a number or fluent, of UNIT (:ticks or :seconds) in ticks."
  (let ((span (fluent-value span)))
    (check-argument wait-time span (quantity-p span) "a number from -1e15 to 1e15")
    (ecase unit
      (:ticks span)
      (:seconds (ceiling (* span (runner-ticks-per-second *runner*)))))))

(define-construct wait-time (span &key unit)
  "Wait in a plan for SPAN, counted in ticks, or in seconds if UNIT is :seconds (manual D.4; reading
90). SPAN is a number up to 1e15; with 0 or less, the plan does not wait."
  (:manual)
  (:arguments span)
  (:parts (span function (value-lambda `(ticks-of ,span (or ,unit :ticks)) scope)))
  (:steps
   (begin
    (next waiting)
    (let ((span (funcall span environment)))
      (cond ((plusp span)
             (park task (start-timer task span))
             +parked+)
            (t (values (frame-up frame) nil)))))
   (waiting (values (frame-up frame) nil))))
