;;;; failing.lisp -- fail, handle-failure and retry.

(in-package :ars-magna.rpl)

(defun plan-backtrace (task frame)
  "Return the expressions under way in TASK at FRAME and around it, innermost first."
  (loop with forms = '()
        for each = task then (task-parent each)
        for innermost = frame then (and each (task-frame each))
        while each
        do (loop for frame = innermost then (frame-up frame)
                 while frame
                 do (push (current-form (frame-node frame) frame) forms))
        finally (return (nreverse forms))))

(defun handled-failure (task frame)
  "Return the failure that TASK at FRAME, or a task around it, is handling or cleaning up after."
  (loop for each = task then (task-parent each)
        for innermost = frame then (and each (task-frame each))
        while each
        do (loop for frame = innermost then (frame-up frame)
                 while frame
                 do (when (typep (frame-data frame) 'plan-failure)
                      (return-from handled-failure (frame-data frame))))))

(defun failure-of (condition task frame)
  "Return the failure that CONDITION, met by TASK at FRAME, means, with all that is known of it."
  (let ((failure (if (typep condition 'plan-failure)
                     condition
                     (make-condition 'lisp-failure :condition condition
                                                   :backtrace (lisp-backtrace)))))
    (unless (failure-task-path failure)
      (setf (failure-task-path failure) (task-path task)
            (failure-tick failure) (runner-tick (task-runner task))
            (failure-plan-backtrace failure) (plan-backtrace task frame)
            (failure-form failure) (first (failure-plan-backtrace failure))
            (failure-cause failure) (or (failure-cause failure) (handled-failure task frame))))
    failure))

(defun engine-call-p (call)
  (member (first call) '(run-steps step-leaf call-catching-trouble)))

(defun signalling-call-p (call)
  (and (symbolp (first call)) (string= "%SIGNAL" (first call))))

(defun lisp-backtrace ()
  "Return as a string the Lisp calls under way in a plan's code that has just signalled an error."
  (let* ((calls (calls-under-way))
         (signalled (member-if #'signalling-call-p calls)))
    (with-output-to-string (stream)
      (loop for call in (if signalled (rest signalled) calls)
            for number from 0
            until (engine-call-p call)
            do (format stream "    ~D: ~A~%" number (form-text call 100))))))

(define-node failing ((arguments function))
  "Fail as FAIL would with the list that ARGUMENTS of the environment returns."
  :step step-failing)

(defun step-failing (node task frame value)
  (declare (ignore value))
  (let ((failure (make-failure (funcall (failing-arguments node) (frame-environment frame)))))
    (unwind task frame (failure-of failure task frame))))

(define-plan-form "FAIL" :may (&rest arguments) (form scope)
  (if (some (lambda (argument) (suspends-p argument scope)) arguments)
      (hoisted-code form scope)
      `(make-failing :form ',form :arguments ,(value-lambda `(list ,@arguments) scope))))

;;; Handling. A handler runs in an environment of the failure. While it does, DATA is the failure
;;; and COUNTER is 2.

(define-node handling ((body node) (types list) (handlers simple-vector))
  "BODY; a failure of one of TYPES is taken care of by the handler of the same index, and goes on
when that comes to its end."
  :step step-handling :unwind unwind-handling)

(defun step-handling (node task frame value)
  (ecase (frame-counter frame)
    (0 (setf (frame-counter frame) 1)
     (enter (handling-body node) (frame-environment frame) frame))
    (1 (values (frame-up frame) value))
    (2 (unwind task (frame-up frame) (frame-data frame)))))

(defun unwind-handling (node task frame signal)
  (declare (ignore task))
  (cond ((and (escape-p signal) (eq node (escape-target signal)))
         (setf (frame-counter frame) 0
               (frame-data frame) nil)
         (values t frame nil))
        ((and (= 1 (frame-counter frame)) (typep signal 'plan-failure))
         (let ((index (position-if (lambda (type) (failure-matches-p signal type))
                                   (handling-types node))))
           (when index
             (setf (frame-counter frame) 2
                   (frame-data frame) signal)
             (values t
                     (make-frame (svref (handling-handlers node) index)
                                 (vector (frame-environment frame)
                                         (failure-subject signal
                                                          (nth index (handling-types node))))
                                 frame)
                     nil))))))

(addition with-failure-handling)
(defmacro with-failure-handling (clauses &body body)
  "Run BODY in a plan; a failure is handled by the first of CLAUSES, (type (variable) form...),
whose type it matches: T, a class given to FAIL, a condition type of failures or of Lisp's, or
(or ...). The handler may wait. (return value) ends the whole with VALUE and (retry) runs BODY anew;
at the handler's end the failure goes on."
  (misplaced 'with-failure-handling (list* clauses body)))

(addition handle-failure)
(defmacro handle-failure (clauses &body body)
  "Do as WITH-FAILURE-HANDLING."
  (misplaced 'handle-failure (list* clauses body)))

(addition retry)
(defmacro retry ()
  "In a handler of WITH-FAILURE-HANDLING: run its body anew."
  (misplaced 'retry '()))

(defun handler-code (clause scope)
  "Return code for the handler of CLAUSE, (type ([variable]) form...)."
  (destructuring-bind (type (&optional (variable (gensym "FAILURE"))) &rest body) clause
    (declare (ignore type))
    (binding-body-code body (variable-scope (single-scope scope) (list variable)))))

(defun check-clause (clause form)
  (unless (typep clause '(cons t (cons list t)))
    (reject-clause "plan" form "clauses such as (type (variable) form...)")))

(defun handling-code (form clauses body scope)
  (dolist (clause clauses) (check-clause clause form))
  (block-code nil form scope
    (lambda (scope)
      (with-gensyms (node)
        `(let ((,node (make-handling :form ',form
                                     :body ,(body-code body scope)
                                     :types ',(mapcar #'first clauses)
                                     :handlers (vector))))
           (setf (handling-handlers ,node)
                 (vector ,@(loop with inner = (inner-scope scope :retry node)
                                 for clause in clauses
                                 collect (handler-code clause inner))))
           ,node)))))

(define-plan-form "WITH-FAILURE-HANDLING" :must (clauses &rest body) (form scope)
  (handling-code form clauses body scope))

(define-plan-form "HANDLE-FAILURE" :must (clauses &rest body) (form scope)
  (handling-code form clauses body scope))

(define-plan-form "RETRY" :must () (form scope)
  (if (scope-retry scope)
      `(make-leave :form ',form :target ,(scope-retry scope) :result +nothing+)
      (reject-clause "plan" form "retry only in a handler of handle-failure")))

;;; Counted retries.

(addition with-retry-counters)
(defmacro with-retry-counters (counters &body body)
  "Run BODY in a plan with COUNTERS, each (name number), for DO-RETRY."
  `(let ,counters ,@body))

(addition do-retry)
(defmacro do-retry (counter &body body)
  "In a handler: run BODY, most likely (retry), if COUNTER is positive, and count it down."
  `(when (plusp ,counter)
     (decf ,counter)
     ,@body))
