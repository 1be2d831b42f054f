;;;; awaiting.lisp -- steps of task nets that wait for the memory, and fail because of it.

(in-package :ars-rap)

;;; The memory is looked at in each tick. The wait shows, and is traced, as one wait for a fluent
;;; whose name is the query.

(defstruct (memory-wait (:constructor make-memory-wait (fluent)) (:copier nil))
  "A task waits for the memory. FLUENT never changes; its name is the query."
  (fluent nil :type fluent :read-only t))

(defmethod awaited-text ((wait memory-wait))
  (awaited-text (memory-wait-fluent wait)))

(defmethod traced-subject ((wait memory-wait))
  (memory-wait-fluent wait))

(defun look-again (timer)
  (let ((task (timer-client timer)))
    (when (eq timer (task-timer task))
      (setf (task-timer task) nil
            (task-awaiting task) nil)
      (make-ready task))))

(defun await-next-tick (task wait)
  "Let TASK look at the memory again in the next tick. Return what a step returns."
  (let ((runner (task-runner task)))
    (setf (task-timer task) (set-timer (runner-timers runner) (1+ (plan-runner-tick runner))
                                       #'look-again task))
    (park-again task wait)
    +parked+))

(define-expression await-memory
  "Waits until the function TEST returns true. SHOWN returns the query that is shown."
  (:parts (test function) (shown function))
  (:steps
   (begin
    (cond ((funcall test environment) (values (frame-up frame) t))
          (t (next waiting)
             (setf memory (make-memory-wait
                           (create-fluent (data-text (funcall shown environment)))))
             (park task memory)
             (await-next-tick task memory))))
   (waiting
    (cond ((funcall test environment)
           (note-event task :wake (memory-wait-fluent memory))
           (values (frame-up frame) t))
          (t (await-next-tick task memory))))))

(define-plan-form await-memory :must (test shown) (form scope)
  `(make-await-memory :form ',(form-as-written form)
                      :test ,(value-lambda test scope)
                      :shown ,(value-lambda shown scope)))

;;; Failures.

(define-condition step-failed (plan-failure)
  ((tag :initarg :tag :reader step-failed-tag)
   (query :initarg :query :reader step-failed-query))
  (:documentation "A query has ended a step of a task net, or does not hold when a step begins."))

(defmethod write-failure ((failure step-failed) stream)
  (format stream "~A ~:[does not hold for~;has ended~] the step ~(~A~)"
          (data-text (step-failed-query failure))
          (eq :rap-event (failure-class failure)) (step-failed-tag failure)))

(defun fail-by-event (query tag)
  (fail (make-condition 'step-failed :class :rap-event :query query :tag tag)))

(defun check-happened (true query tag)
  (unless true (fail (make-condition 'step-failed :class :rap-condition :query query :tag tag))))
