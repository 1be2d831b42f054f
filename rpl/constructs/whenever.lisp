;;;; whenever.lisp -- reacting to whatever happens.

(in-package :ars-magna.rpl.constructs)

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
                                      :condition ,(condition-lambda fluent scope)
                                      :missed ,(value-lambda missed scope)
                                      :body ,(body-code body (single-scope scope))))))))
