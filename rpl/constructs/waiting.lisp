;;;; waiting.lisp -- waiting for time and for fluents, reacting to events, deadlines.

(in-package :ars-magna.rpl.constructs)

(addition deadline-missed deadline-missed-ticks)

(defun wake-at-timeout (timer)
  (let ((task (timer-client timer)))
    ;; An interrupt may have left the timer of a wait that is over.
    (when (or (eq timer (task-awaiting task)) (eq timer (task-timer task)))
      (stop-waiting task)
      (wake task nil timer))))

(defun make-timer-after (ticks task function)
  (let ((runner (task-runner task)))
    (set-timer (runner-timers runner) (+ (runner-tick runner) ticks) function task)))

(defun park-for (task ticks)
  "Note that TASK waits for TICKS. The current step of TASK must then return +PARKED+."
  (park task (make-timer-after ticks task #'wake-at-timeout)))

(defun exact-span-in-ticks (span unit operator)
  "Return SPAN, a number or fluent, in ticks. UNIT is :ticks or :seconds. Errors name OPERATOR."
  (let ((span (fluent-value span)))
    (unless (bounded-number-p span)
      (reject-argument operator 'span span "a number from -1e15 to 1e15"))
    (case unit
      (:ticks span)
      (:seconds (* span (runner-ticks-per-second *runner*)))
      (t (reject-argument operator 'unit unit ":ticks or :seconds")))))

(defun span-in-ticks (span unit operator)
  "Return the value of EXACT-SPAN-IN-TICKS, rounded up if UNIT is :seconds."
  (let ((ticks (exact-span-in-ticks span unit operator)))
    (if (eq unit :seconds) (ceiling ticks) ticks)))

(defun check-unit (unit form)
  (when (and (atom unit) (or (keywordp unit) (not (symbolp unit)))
             (not (member unit '(:ticks :seconds))))
    (reject-clause (text-title) form
                   (format nil ":unit :ticks or :unit :seconds, not ~(~S~)" unit))))

(defun span-lambda (operator span unit form scope)
  "Return a lambda expression that returns SPAN in ticks. SPAN and UNIT are forms in FORM."
  (check-unit unit form)
  (when (and (realp span) (minusp span))
    (style-warn-of-form form "~(~A~) does not wait for ~A, which is less than 0." (first form)
                        span))
  (value-lambda `(span-in-ticks ,span (or ,unit :ticks) ',operator) scope))

(define-construct wait-time (span &key unit)
  "Wait in a plan for SPAN ticks, or seconds if UNIT is :seconds (manual D.4; reading 90). SPAN is a
number up to 1e15. If SPAN is 0 or less, do not wait."
  (:manual)
  (:arguments span)
  (:parts (span function (span-lambda 'wait-time span unit form scope)))
  (:steps
   (begin
    (next waiting)
    (let ((span (funcall span environment)))
      (cond ((plusp span)
             (park-for task span)
             +parked+)
            (t (values (frame-up frame) nil)))))
   (waiting (values (frame-up frame) nil))))

;;;; Waiting for a fluent

(defun wake-waiter (watcher value trouble)
  "The fluent of WATCHER became true. Let its task go on with VALUE, or fail with TROUBLE."
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

(defun wait-until-true (task condition)
  "Let TASK wait until CONDITION, a fluent that is false, becomes true. If CONDITION is no fluent,
it never changes, and TASK waits forever."
  (if (fluent-p condition)
      (let ((watcher (make-watcher condition #'wake-waiter task)))
        (watch watcher)
        (park task watcher)
        ;; Another thread may have set it since it was looked at.
        (let ((value (fluent-value condition)))
          (when value (wake-waiter watcher value nil))))
      (wait-forever task)))

(defun checked-timeout (timeout)
  (let ((timeout (fluent-value timeout)))
    (check-argument wait-for timeout (or (null timeout) (bounded-number-p timeout))
                    "a number of ticks, from -1e15 to 1e15, or NIL")
    timeout))

(define-construct wait-for (fluent &key timeout)
  "Wait in a plan until FLUENT, or a network such as (and a (not b)), is true or pulsed. If FLUENT
is true already, do not wait. Return the value of FLUENT, or NIL if TIMEOUT is given and TIMEOUT
ticks have passed (manual C). TIMEOUT is a number up to 1e15."
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
             (unless (fluent-p fluent) (warn-of-dubious-condition task value))
             (values (frame-up frame) value))
            ((and timeout (<= (the real timeout) 0)) (values (frame-up frame) nil))
            (t (next waiting)
               (when timeout
                 (setf (task-timer task) (make-timer-after timeout task #'wake-at-timeout)))
               (wait-until-true task fluent)
               +parked+))))
   (waiting (values (frame-up frame) value))))

;;;; Reacting to events

(defun run-or-count-event (watcher value trouble)
  "Let the task of WATCHER run the body of its WHENEVER, or count the event for later."
  (declare (ignore value))
  (let* ((task (watcher-client watcher))
         (frame (task-frame task)))
    (incf (watcher-pending watcher))
    (when (and frame (eq watcher (frame-data frame)) (eq (task-state task) :waiting))
      (when trouble
        (setf (task-signal task) (failure-of trouble task frame)))
      (wake task nil))))

(defun make-event-source (condition task)
  "Return the source of events of CONDITION for TASK. For a view that counts each event, the source
is the view itself; for any other fluent, a watcher; for anything else, NIL."
  (cond ((not (fluent-p condition)) nil)
        ((counts-each-event-p condition) condition)
        (t (let ((watcher (make-watcher condition #'run-or-count-event task)))
             (watch watcher)
             watcher))))

(defun await-event (task source)
  (cond ((watcher-p source)
         (if (plusp (watcher-pending source))
             (give-way task)
             (park task (watcher-fluent source))))
        ((null source) (wait-forever task))
        ((fluent-value source) (give-way task))
        (t (wait-until-true task source)))
  +parked+)

(defun take-events (source missed)
  "Remove one event from SOURCE if MISSED is :all; otherwise all events. Signals WRONG-ARGUMENT."
  (check-argument whenever missed (member missed '(:once :all)) ":once or :all")
  (cond ((not (watcher-p source)))
        ((eq missed :all) (decf (watcher-pending source)))
        (t (setf (watcher-pending source) 0))))

(defun fluent-with-options-p (condition environment)
  "True if CONDITION, the first argument of WHENEVER, is a form with keywords, and not a call."
  (and (typep condition '(cons t (cons keyword)))
       (or (eq :missed (second condition))
           (consp (first condition))
           (known-variable-p (first condition) environment))))

(defun split-whenever-condition (condition scope)
  "Return a list of two forms in CONDITION, the first argument of a WHENEVER: the form of the fluent
and the value of :missed. Signals MALFORMED-DEFINITION."
  (cond ((not (fluent-with-options-p condition (scope-environment scope))) (list condition :once))
        ((and (typep condition '(cons t (cons (eql :missed) (cons t null))))
              (typep (third condition) '(or (member :once :all) (and symbol (not keyword)) cons)))
         (list (first condition) (third condition)))
        (t (reject-clause (text-title) condition
                          "(fluent :missed :once) or (fluent :missed :all)"))))

(define-construct whenever (fluent &body body)
  "Run BODY in a plan each time FLUENT, or a network, becomes true or is pulsed, and at once if
FLUENT is true. A pulse of a network's source pulses the network, if the network is true at that
instant. WHENEVER ends only by RETURN, failure or evaporation (manual D.4). Events while BODY runs
count as one event, as with (FLUENT :missed :once) as the first argument. With (FLUENT :missed
:all), or if FLUENT is a view with :ALWAYS, BODY runs once for each event."
  (:manual)
  (:arguments (first (split-whenever-condition fluent scope)))
  (:parts (condition function
                     (awaited-lambda (first (split-whenever-condition fluent scope)) form scope))
          (missed function (value-lambda (second (split-whenever-condition fluent scope)) scope))
          (body node (body-code body (single-value-scope scope))))
  (:code (block-code nil form scope #'build))
  (:steps
   (begin
    (let ((condition (funcall condition environment)))
      (setf memory (make-event-source condition task))
      (cond ((fluent-value condition) (next reacting) (enter body environment frame))
            (t (next waiting) (await-event task memory)))))
   (reacting
    (next waiting)
    (await-event task memory))
   (waiting
    (take-events memory (funcall missed environment))
    (next reacting)
    (enter body environment frame)))
  (:unwind
   (let ((source (shiftf memory nil)))
     (when (watcher-p source) (unwatch source)))
   nil))

;;;; Waiting for any condition

(defun wait-until-form (condition)
  "Return plan text that waits until the form CONDITION is true, and returns its value."
  (with-gensyms (met again value)
    `(block ,met
       (tagbody
          ,again
          (let ((,value ,condition))
            (if (fluent-p ,value) (return-from ,met (wait-for ,value)))
            (if ,value (return-from ,met ,value)))
          (wait-time 1)
          (go ,again)))))

(defun warn-of-wait-condition (condition form)
  (let ((advice (if (realp condition)
                    (format nil "~S is a number, which counts as true. To let time pass, write ~
                                 (wait-time ~:*~S)." condition)
                    (test-advice condition))))
    (when advice (style-warn-of-plan-text form "wait-until: ~A" advice))))

(define-construct wait-until (condition)
  "Wait in a plan until the form CONDITION is true; return the value of CONDITION. If the value is a
fluent or a network, as for (< level 46) where LEVEL is a fluent, wait for that fluent. Otherwise
test CONDITION again at each tick. CONDITION may itself wait. (Policies and AT-LOCATION watch their
conditions as WAIT-UNTIL does.)"
  (:code (progn (warn-of-wait-condition condition form)
                (plan-code (note-expansion (wait-until-form condition) form) scope))))

;;;; Deadlines

(define-condition deadline-missed (plan-failure)
  ((ticks :initarg :ticks :initform nil :reader deadline-missed-ticks))
  (:documentation "The forms of a WITH-DEADLINE were not done in time."))

(setf (documentation 'deadline-missed-ticks 'function)
      "Return the time limit of the WITH-DEADLINE, in ticks.")

(defmethod write-failure ((failure deadline-missed) stream)
  (format stream "Not done within ~A tick~:P" (deadline-missed-ticks failure)))

(defun fail-at-deadline (timer)
  "Let the task of TIMER fail, unless the task is ending."
  (let* ((task (timer-client timer))
         (frame (task-frame task))
         (*asker* (list "the deadline of " (car (frame-data frame)) " ticks of task "
                        (task-serial task))))
    (unless (task-signal task)
      (end-with-signal task
                       (failure-of (make-condition 'deadline-missed
                                                   :ticks (car (frame-data frame)))
                                   task frame)))))

(defun cancel-deadline (task memory)
  (when memory (cancel-timer (cdr memory) (runner-timers (task-runner task)))))

(define-construct with-deadline ((span &key unit) &body body)
  "Run BODY in a plan as a separate task. Return the first value of BODY. If BODY has not ended SPAN
ticks after its start, or seconds if UNIT is :seconds, BODY evaporates, and WITH-DEADLINE fails with
DEADLINE-MISSED. Cleanups of BODY may take longer. Time counts while BODY is suspended. SPAN is a
number up to 1e15; with 0 or less BODY must not take any time. (CRAM has a timeout-policy instead.)"
  (:arguments span)
  (:parts (span function (span-lambda 'with-deadline span unit form scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (next over)
    (let ((ticks (max 0 (funcall span environment))))
      (setf memory (cons ticks (make-timer-after ticks task #'fail-at-deadline))))
    (start-branch body task environment 0 (task-level task))
    (await-parts task))
   (over (values (frame-up frame) value)))
  (:unwind
   (cancel-deadline task (shiftf memory nil))
   nil)
  (:child-ended
   (cancel-deadline task (shiftf memory nil))
   (or (fail-or-escape task how result)
       (end-with-value task (and (eq how :succeeded) result)))))
