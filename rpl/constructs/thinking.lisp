;;;; thinking.lisp -- think and with-charge: what takes time where thinking is charged.

(in-package :ars-magna.rpl.constructs)

;;; A thought is a wait, made only where thinking is charged for. The robot's other plans go on
;;; meanwhile, or all of them stop.

(defun price-of (operator span unit)
  "Return the exact price SPAN of OPERATOR in ticks. UNIT is :ticks or :seconds. Signals
WRONG-ARGUMENT."
  (let ((span (fluent-value span)))
    (unless (amount-p span)
      (reject-argument operator 'span span "a number from 0 to 1e15"))
    (exact-span-in-ticks span unit operator)))

(defun price-lambda (operator span unit form scope)
  (check-unit unit form)
  (value-lambda `(price-of ',operator ,span (or ,unit :ticks)) scope))

(defun think-for (task ticks alone)
  "Make TASK think for TICKS. If ALONE is true, no other task runs meanwhile."
  (when alone (stop-agent (task-agent task) ticks))
  (park-for task ticks)
  +parked+)

(defun takes-time-p (task ticks)
  (and (agent-charged-p (task-agent task)) (plusp ticks)))

(defun whole-ticks-to-think (task span)
  "Charge TASK for a thought of SPAN ticks. Return how many ticks it takes now."
  (if (takes-time-p task span)
      (let ((agent (task-agent task))) (ticks-to-think (agent-client agent) agent span))
      0))

(define-construct think (span &key unit alone)
  "Think in a plan for SPAN ticks, or seconds if UNIT is :seconds. If thinking is charged, wait for
SPAN; otherwise return at once. Fractions of a tick add up exactly, for each robot: four thoughts of
1/4 tick cost one tick, in the fourth. Other tasks of the robot's plans go on meanwhile. If ALONE is
true, all other tasks stop, policies too, and react afterwards. Return NIL. Signals WRONG-ARGUMENT
(manual 1.2)."
  (:command)
  (:arguments span alone)
  (:parts (span function (price-lambda 'think span unit form scope))
          (alone function (value-lambda alone scope)))
  (:steps
   (begin
    (next thinking)
    (let ((ticks (whole-ticks-to-think task (funcall span environment))))
      (setf memory (funcall alone environment))
      (if (plusp ticks)
          (think-for task ticks memory)
          (values (frame-up frame) nil))))
   (thinking (values (frame-up frame) nil)))
  (:unwind
   ;; Others may go on.
   (when (and memory (in-state-p thinking)) (resume-agent (task-agent task)))
   nil))

;;; A body with a price. Its steps are not charged for, and its end comes when the price is paid.

(defstruct (thought (:constructor make-thought (ticks alone start)) (:copier nil))
  "The state of a WITH-CHARGE. The thought takes TICKS from the tick START on, and if ALONE is true,
other tasks stop meanwhile. The body of the WITH-CHARGE has ended with RESULT or SIGNAL."
  (ticks 0 :type (integer 0) :read-only t)
  (alone nil :read-only t)
  (start 0 :type real :read-only t)
  (result nil)
  (signal nil))

(defun begin-thought (task ticks alone)
  (make-thought (whole-ticks-to-think task ticks) alone (runner-tick (task-runner task))))

(defun ticks-left (thought task)
  (let ((now (runner-tick (task-runner task))))
    (if (agent-charged-p (task-agent task))
        (max 0 (- (+ (thought-start thought) (thought-ticks thought)) now))
        0)))

(defun start-uncharged-branch (body task environment)
  "Start BODY as a part of TASK whose steps are not charged. Return +PARKED+."
  (let ((branch (start-branch body task environment 0 (task-level task))))
    (when (agent-charged-p (task-agent task)) (setf (task-uncounted-p branch) t)))
  (await-parts task))

(defun end-thought (thought task frame)
  (let ((signal (thought-signal thought)))
    (if signal
        (unwind task (frame-up frame) signal)
        (values (frame-up frame) (thought-result thought)))))

(define-construct with-charge ((span &key unit alone) &body body)
  "Run BODY in a plan, as a separate task, at the price of SPAN ticks, or seconds if UNIT is
:seconds. Return the first value of BODY. If thinking is charged, the steps of BODY do not count.
WITH-CHARGE then ends SPAN after the start of BODY, or with BODY if BODY ends later. If ALONE is
true, other tasks stop after BODY until the price is paid. Fractions of a tick add up as for
THINK. If thinking is not charged, just run BODY. A task that evaporates does not wait for the rest
of SPAN. Signals WRONG-ARGUMENT (manual 1.2)."
  (:arguments span alone)
  (:parts (span function (price-lambda 'with-charge span unit form scope))
          (alone function (value-lambda alone scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    ;; An invalid price fails before there is a thought.
    (setf memory (begin-thought task (funcall span environment) (funcall alone environment)))
    (next inside)
    (start-uncharged-branch body task environment))
   (inside
    (next thinking)
    (setf (thought-result memory) value)
    (let ((ticks (ticks-left memory task)))
      (if (plusp ticks)
          (think-for task ticks (thought-alone memory))
          (end-thought memory task frame))))
   (thinking (end-thought memory task frame)))
  (:unwind
   (cond ((in-state-p thinking)
          (when (thought-alone memory) (resume-agent (task-agent task)))
          nil)
         ((and (in-state-p inside) (not (eq signal :evaporate)) (plusp (ticks-left memory task)))
          (next thinking)
          (setf (thought-signal memory) signal)
          (values t (think-for task (ticks-left memory task) (thought-alone memory)) nil))))
  (:child-ended
   (or (fail-or-escape task how result)
       (end-with-value task (and (eq how :succeeded) result)))))
