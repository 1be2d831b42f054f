;;;; handling.lisp -- handle-failure and retry.

(in-package :ars-magna.rpl.constructs)

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
