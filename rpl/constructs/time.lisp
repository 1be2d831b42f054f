;;;; time.lisp -- wait-time, and other waiting that ends with time.

(in-package :ars-magna.rpl.constructs)

(defun time-out (timer)
  "Let the task that TIMER is for go on with NIL."
  (let ((task (timer-client timer)))
    (setf (task-timer task) nil)
    (stop-waiting task)
    (wake task nil timer)))

(defun start-timer (task ticks)
  (let ((runner (task-runner task)))
    (setf (task-timer task)
          (set-timer (runner-timers runner) (+ (runner-tick runner) ticks) #'time-out task))))

(defun ticks-of (span unit operator)
  "Return SPAN, a number or fluent, of UNIT (:ticks or :seconds) in ticks, for OPERATOR."
  (let ((span (fluent-value span)))
    (unless (quantity-p span)
      (reject-argument operator 'span span "a number from -1e15 to 1e15"))
    (case unit
      (:ticks span)
      (:seconds (ceiling (* span (runner-ticks-per-second *runner*))))
      (t (reject-argument operator 'unit unit ":ticks or :seconds")))))

(defun check-unit (unit form)
  (when (and (atom unit) (or (keywordp unit) (not (symbolp unit)))
             (not (member unit '(:ticks :seconds))))
    (reject-clause (author) form (format nil ":unit :ticks or :unit :seconds, not ~(~S~)" unit))))

(defun check-span (span form)
  (when (and (realp span) (minusp span))
    (doubt-form form "~(~A~) does not wait for ~A, which is less than 0." (first form) span)))

(defun span-lambda (operator span unit form scope)
  "Return the lambda expression, of the environment, for SPAN of UNIT, forms in FORM, a use of
OPERATOR, in ticks."
  (check-unit unit form)
  (check-span span form)
  (value-lambda `(ticks-of ,span (or ,unit :ticks) ',operator) scope))

(define-construct wait-time (span &key unit)
  "Wait in a plan for SPAN, counted in ticks, or in seconds if UNIT is :seconds (manual D.4; reading
90). SPAN is a number up to 1e15; with 0 or less, the plan does not wait."
  (:manual)
  (:arguments span)
  (:parts (span function (span-lambda 'wait-time span unit form scope)))
  (:steps
   (begin
    (next waiting)
    (let ((span (funcall span environment)))
      (cond ((plusp span)
             (park task (start-timer task span))
             +parked+)
            (t (values (frame-up frame) nil)))))
   (waiting (values (frame-up frame) nil))))
