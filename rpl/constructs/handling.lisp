;;;; handling.lisp -- with-failure-handling and retry.

(in-package :ars-magna.rpl.constructs)

;;; A handler runs in an environment of the failure, which is remembered meanwhile. To retry is to
;;; leave for the body.

(defun handler-index (failure types)
  (position-if (lambda (type) (failure-matches-p failure type)) types))

(defun enter-handler (handler type failure frame)
  (make-frame handler
              (vector (frame-environment frame) (failure-subject failure type))
              frame))

(defun handler-code (clause scope)
  "Return code for the handler of CLAUSE, (type ([variable]) form...)."
  (destructuring-bind (type (&optional (variable (gensym "FAILURE"))) &rest body) clause
    (declare (ignore type))
    (binding-body-code body (variable-scope (single-scope scope) (list variable)))))

(defun failure-specifier-p (type)
  "True if TYPE can be what a clause is for: a symbol, or (or TYPE...)."
  (if (consp type)
      (and (symbolp (first type)) (same-name-p 'or (first type))
           (rest type) (proper-list-p type)
           (every #'failure-specifier-p (rest type)))
      (and type (symbolp type))))

(defun check-clause (clause form scope)
  (unless (and (typep clause '(cons t (cons list t))) (proper-list-p clause)
               (typep (second clause) '(or null (cons t null))))
    (reject-clause (author) (if (consp clause) clause form)
                   "clauses such as (type (variable) form...), with one variable or none"))
  (unless (failure-specifier-p (first clause))
    (reject-clause (author) clause
                   (format nil "~A, or (or type...): ~(~S~) matches no failure"
                           "t, the class of a failure or a condition type first"
                           (abridged (first clause)))))
  (check-variables (second clause) (scope-environment scope) clause))

;;; Commands do not fail: a fluent tells how they ended.

(defparameter *constructs-without-failures*
  '("SEQ" "PAR" "PURSUE" "N-TIMES" "WAIT-FOR" "WAIT-TIME" "WAIT-UNTIL" "SET-VALUE" "PULSE"
    "FLUENT-VALUE" "VREF" "WHENEVER" "WITH-POLICY" "WITH-VALVE")
  "Operators that fail with the code of no command unless what is in them does.")

(defun may-fail-so-p (form code)
  "True if FORM, in a plan's text, may fail with class CODE: it is no command and no construct or
function that is known not to."
  (let ((operator (first form)))
    (cond ((fail-p form) (let ((class (if (eq :class (second form)) (third form) (second form))))
                           (or (not (keywordp class)) (eq class code))))
          ((operator-in-p form '("FUNCALL" "APPLY" "FUNCTION" "LAMBDA" "EVAL")) t)
          ((consp operator) nil)
          (t (not (or (operator-in-p form *constructs-without-failures*)
                      (plan-function-p operator)
                      (eq (find-package "COMMON-LISP") (symbol-package operator))))))))

(defun doubt-code (code body form)
  "Warn if CODE, a class that FORM handles in BODY, is how a command in BODY may end, as nothing in
that fails so."
  (let* ((command (find-call (lambda (form) (teller-of-code (first form) code)) body))
         (fluent (and command (teller-of-code (first command) code))))
    (when (and command (not (find-call (lambda (form) (may-fail-so-p form code)) body)))
      (doubt-own-form form "~(~A~) does not fail with class ~S when it ends so; ~(~A~) has that ~
                            value then. After the wait write (if (fluent-value ~(~A~)) ...), or ~
                            (fail :class (fluent-value ~(~A~))) in that."
                      (first command) code fluent fluent fluent))))

(define-construct with-failure-handling (clauses &body body)
  "Run BODY in a plan; a failure is handled by the first of CLAUSES, (type (variable) form...),
whose type it matches: T, a class given to FAIL, a condition type of failures or of Lisp's, or
(or ...). The handler may wait. (return value) ends the whole with VALUE and (retry) runs BODY anew;
at the handler's end the failure goes on. Return all values of BODY."
  (:parts (body node (scope-retry scope))
          (types list `',(mapcar #'first clauses))
          (handlers simple-vector `(vector ,@(loop for clause in clauses
                                                   collect (handler-code clause scope)))))
  (:code
   (progn
     (unless (proper-list-p clauses)
       (reject-clause (author) form "a list of clauses such as (type (variable) form...)"))
     (when (and clauses (atom (first clauses)))
       (reject-clause (author) clauses (format nil "a list of clauses: write (~(~S~))"
                                               (abridged clauses))))
     (dolist (clause clauses)
       (check-clause clause form scope)
       (dolist (code (ensure-list (first clause))) (doubt-code code body form)))
     (block-code nil form scope
                 (lambda (scope)
                   (with-gensyms (start)
                     `(let ((,start ,(body-code body scope)))
                        ,(build (inner-scope scope :retry start))))))))
  (:steps
   (begin
    (next inside)
    (enter body environment frame))
   (inside (values (frame-up frame) value))
   (handling
    (setf (failure-passed-on-by memory) (nth (handler-index memory types) types))
    (unwind task (frame-up frame) memory)))
  (:unwind
   (cond ((and (escape-p signal) (eq body (escape-target signal)))
          (next begin)
          (setf memory nil)
          (values t frame nil))
         ((and (in-state-p inside) (typep signal 'plan-failure))
          (let ((index (handler-index signal types)))
            (when index
              (next handling)
              (setf memory signal)
              (values t
                      (enter-handler (svref handlers index) (nth index types) signal frame)
                      nil)))))))

(define-construct handle-failure (clauses &body body)
  "Do as WITH-FAILURE-HANDLING."
  (:like with-failure-handling))

(define-construct retry ()
  "In a handler of WITH-FAILURE-HANDLING: run its body anew."
  (:code
   (if (scope-retry scope)
       `(make-leave :form ',(form-as-written form) :target ,(scope-retry scope) :result +nothing+)
       (reject-clause (author) form "retry only in a handler of handle-failure"))))
