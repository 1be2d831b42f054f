;;;; waiting.lisp -- wait-for, whenever, wait-time.

(in-package :ars-magna.rpl)

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
    (wake task nil)))

(defun start-timer (task ticks)
  "Let TASK be woken after TICKS."
  (let ((runner (task-runner task)))
    (setf (task-timer task)
          (set-timer (runner-timers runner) (+ (runner-tick runner) ticks) #'time-out task))))

;;; Waiting for a fluent.

(define-node wait ((condition function) (timeout function))
  "Wait until what CONDITION of the environment returns is true, at most as many ticks as TIMEOUT
returns (NIL: for ever)."
  :step step-wait)

(defun step-wait (node task frame value)
  (declare #.*hot* (type wait node) (type task task) (type frame frame))
  (if (plusp (frame-counter frame))
      (values (frame-up frame) value)
      (let* ((environment (frame-environment frame))
             (condition (funcall (wait-condition node) environment))
             (value (fluent-value condition))
             (timeout (if value nil (fluent-value (funcall (wait-timeout node) environment)))))
        (check-argument wait-for timeout (or (null timeout) (quantity-p timeout))
                        "a number of ticks, from -1e15 to 1e15, or NIL")
        (cond (value (values (frame-up frame) value))
              ((and timeout (<= (the real timeout) 0)) (values (frame-up frame) nil))
              (t (setf (frame-counter frame) 1)
                 (wait-until-heard task condition)
                 (when timeout (start-timer task timeout))
                 +parked+)))))

(defun wait-until-heard (task condition)
  "Let TASK wait until CONDITION, a fluent that is false, changes. Another object never does."
  (if (fluent-p condition)
      (let ((watcher (make-watcher condition #'wake-waiter task)))
        (watch watcher)
        (park task watcher))
      (park task "what cannot change: no fluent")))

(public wait-for)
(defmacro wait-for (fluent &key timeout)
  "Wait in a plan until FLUENT, or a network such as (and a (not b)), is true; not at all if it is
already. A pulse is enough. Return its value. After TIMEOUT ticks, if given, go on nevertheless and
return NIL (manual C). TIMEOUT is a number up to 1e15."
  (misplaced 'wait-for (list* fluent (and timeout (list :timeout timeout)))))

(define-plan-form "WAIT-FOR" :must (condition &key timeout) (form scope)
  (cond ((suspends-p condition scope)
         (with-gensyms (value)
           (plan-code (note-own-text `(let ((,value ,condition))
                                        (wait-for ,value :timeout ,timeout)))
                      scope)))
        ((suspends-p timeout scope)
         (with-gensyms (value)
           (plan-code (note-own-text `(let ((,value ,timeout))
                                        (wait-for ,condition :timeout ,value)))
                      scope)))
        (t `(make-wait :form ',form
                       :condition ,(value-lambda condition scope)
                       :timeout ,(value-lambda timeout scope)))))

;;; Waiting for time.

(define-node pause ((span function))
  "Wait for what SPAN of the environment returns, in ticks."
  :step step-pause)

(defun step-pause (node task frame value)
  (declare (ignore value))
  (cond ((plusp (frame-counter frame)) (values (frame-up frame) nil))
        (t (setf (frame-counter frame) 1)
           (let ((span (funcall (pause-span node) (frame-environment frame))))
             (cond ((plusp span)
                    (park task (start-timer task span))
                    +parked+)
                   (t (values (frame-up frame) nil)))))))

(defun ticks-of (span unit)
  "Return SPAN, a number or fluent, of UNIT (:ticks or :seconds) in ticks."
  (let ((span (fluent-value span)))
    (check-argument wait-time span (quantity-p span) "a number from -1e15 to 1e15")
    (ecase unit
      (:ticks span)
      (:seconds (ceiling (* span (runner-ticks-per-second *runner*)))))))

(public wait-time)
(defmacro wait-time (span &key (unit :ticks))
  "Wait in a plan for SPAN, counted in ticks, or in seconds if UNIT is
:seconds (manual D.4; reading 90). SPAN is a number up to 1e15; with 0 or less, the plan does not
wait."
  (misplaced 'wait-time (list span :unit unit)))

(define-plan-form "WAIT-TIME" :must (span &key unit) (form scope)
  (if (suspends-p span scope)
      (with-gensyms (value)
        (plan-code (note-own-text `(let ((,value ,span)) (wait-time ,value :unit ,unit))) scope))
      `(make-pause :form ',form
                   :span ,(value-lambda `(ticks-of ,span (or ,unit :ticks)) scope))))

;;; Reacting whenever.

(define-node reaction ((condition function) (missed function) (body node))
  "BODY whenever what CONDITION of the environment returns becomes true or is pulsed. DATA is the
watcher; COUNTER is 1 while BODY runs and 2 while the task waits."
  :step step-reaction :unwind unwind-reaction)

(defun hear (watcher value trouble)
  "Let the task that WATCHER is for start its body, or remember that it is to."
  (declare (ignore value))
  (let* ((task (watcher-client watcher))
         (frame (task-frame task)))
    (incf (watcher-pending watcher))
    (when (and frame (eq watcher (frame-data frame)) (eq (task-state task) :waiting))
      (when trouble
        (setf (task-signal task) (failure-of trouble task frame)))
      (wake task nil))))

(defun step-reaction (node task frame value)
  (declare (ignore value))
  (let ((environment (frame-environment frame))
        (watcher (frame-data frame)))
    (ecase (frame-counter frame)
      (0 (let ((condition (funcall (reaction-condition node) environment)))
           (when (fluent-p condition)
             (setf watcher (make-watcher condition #'hear task)
                   (frame-data frame) watcher)
             (watch watcher))
           (if (fluent-value condition)
               (react-once node frame)
               (await-event task frame watcher))))
      (1 (if (and watcher (plusp (watcher-pending watcher)))
             (after-others task frame)
             (await-event task frame watcher)))
      (2 (forget-events watcher (funcall (reaction-missed node) environment))
       (react-once node frame)))))

(defun react-once (node frame)
  (setf (frame-counter frame) 1)
  (enter (reaction-body node) (frame-environment frame) frame))

(defun await-event (task frame watcher)
  (setf (frame-counter frame) 2)
  (park task (if watcher (watcher-fluent watcher) "what cannot change: no fluent"))
  +parked+)

(defun after-others (task frame)
  (setf (frame-counter frame) 2)
  (make-ready task)
  +parked+)

(defun forget-events (watcher missed)
  "Count the events that the next run of the body answers: all, or one if MISSED is :all."
  (if (eq missed :all)
      (decf (watcher-pending watcher))
      (setf (watcher-pending watcher) 0)))

(defun unwind-reaction (node task frame signal)
  (declare (ignore node task signal))
  (let ((watcher (shiftf (frame-data frame) nil)))
    (when watcher (unwatch watcher)))
  nil)

(public whenever)
(defmacro whenever (fluent &body body)
  "Run BODY in a plan whenever FLUENT, or a network, becomes true or is pulsed, and at once if it is
true. Several such events while BODY runs count as one; with (FLUENT :missed :all) as the first
argument as many runs follow. Ends only by RETURN, failure or evaporation (manual D.4)."
  (misplaced 'whenever (cons fluent body)))

(defun split-condition (condition)
  "Return the fluent's form and the form for :missed in CONDITION, the first argument of WHENEVER."
  (if (and (consp condition) (consp (cdr condition)) (eq (second condition) :missed))
      (values (first condition) (third condition))
      (values condition :once)))

(define-plan-form "WHENEVER" :must (condition &rest body) (form scope)
  (multiple-value-bind (fluent missed) (split-condition condition)
    (if (suspends-p fluent scope)
        (with-gensyms (value)
          (plan-code (note-own-text `(let ((,value ,fluent))
                                       (whenever (,value :missed ,missed) ,@body)))
                     scope))
        (block-code nil form scope
                    (lambda (scope)
                      `(make-reaction :form ',form
                                      :condition ,(value-lambda fluent scope)
                                      :missed ,(value-lambda missed scope)
                                      :body ,(body-code body (single-scope scope))))))))
