;;;; failing.lisp -- fail, handlers, retries and cleanups.

(in-package :ars-magna.rpl.constructs)

(define-expression failing
  "Fails as FAIL does. The function ARGUMENTS returns FAIL's arguments for the environment."
  (:parts (arguments function))
  (:step
   (let ((failure (make-failure (funcall arguments environment))))
     (unwind task frame (failure-of failure task frame)))))

(defun check-fail-keyword (form)
  (when (and (cddr form) (keywordp (second form)) (misspelling-p (second form) :class))
    (style-warn-of-form form "fail takes ~(~S~) as the class of the failure. Did you mean :class?"
                        (second form))))

(defun check-failure-class (form scope)
  (let ((class (and (eq :class (second form)) (third form))))
    (when (name-without-quote-p class scope)
      (style-warn-of-plan-text form
                               "~(~A~) is no variable. The class of a failure is a keyword: (fail ~
                                :class :~:*~(~A~))." class))))

(define-plan-form "FAIL" :may (&rest arguments) (form scope)
  (check-fail-keyword form)
  (check-failure-class form scope)
  (if (some (lambda (argument) (suspends-p argument scope)) arguments)
      (code-with-hoisted-parts form scope)
      `(make-failing :form ',(form-as-written form)
                      :arguments ,(value-lambda `(list ,@arguments) scope))))

;;; A handler runs in an environment of the failure. RETRY leaves the handler for the body.

(defun handler-index (failure types)
  (position-if (lambda (type) (failure-matches-p failure type)) types))

(defun handler-code (clause scope)
  (destructuring-bind (type (&optional (variable (gensym "FAILURE"))) &rest body) clause
    (declare (ignore type))
    (binding-body-code body (variable-scope (single-value-scope scope) (list variable)))))

(defun failure-specifier-p (type)
  "True if a clause of HANDLE-FAILURE may have the type TYPE: a symbol, or (or TYPE...)."
  (if (consp type)
      (and (symbolp (first type)) (same-name-p 'or (first type))
           (rest type) (proper-list-p type)
           (every #'failure-specifier-p (rest type)))
      (and type (symbolp type))))

(defun check-handler-clause (clause form scope)
  (unless (and (typep clause '(cons t (cons list t))) (proper-list-p clause)
               (typep (second clause) '(or null (cons t null))))
    (reject-clause (text-title) (if (consp clause) clause form)
                   "clauses such as (type (variable) form...), with one variable or none"))
  (unless (failure-specifier-p (first clause))
    (reject-clause (text-title) clause
                   (format nil "~A, or (or type...): ~(~S~) matches no failure"
                           "t, the class of a failure or a condition type first"
                           (abridged (first clause)))))
  (check-variables (second clause) (scope-environment scope) clause))

;;; Commands do not fail: a fluent tells how they ended.

(defparameter *constructs-without-failures*
  '("SEQ" "PAR" "PURSUE" "N-TIMES" "WAIT-FOR" "WAIT-TIME" "WAIT-UNTIL" "SET-VALUE" "PULSE"
    "FLUENT-VALUE" "VREF" "WHENEVER" "WITH-POLICY" "WITH-VALVE")
  "Names of operators that fail with a command's error code only if a form inside them does.")

(defun may-fail-with-class-p (form code)
  "True if FORM, in a plan, may fail with class CODE, as far as the functions in FORM are known."
  (let ((operator (first form)))
    (cond ((fail-p form) (let ((class (if (eq :class (second form)) (third form) (second form))))
                           (or (not (keywordp class)) (eq class code))))
          ((operator-in-p form '("FUNCALL" "APPLY" "FUNCTION" "LAMBDA" "EVAL")) t)
          ((consp operator) nil)
          (t (not (or (operator-in-p form *constructs-without-failures*)
                      (plan-function-p operator)
                      (eq (find-package "COMMON-LISP") (symbol-package operator))))))))

(defun warn-of-error-code-as-class (code body form)
  "Warn if FORM handles the failure class CODE, which in BODY is only an error code of commands."
  (let* ((command (find-call (lambda (form) (fluent-of-error-code (first form) code)) body))
         (fluent (and command (fluent-of-error-code (first command) code))))
    (when (and command (not (find-call (lambda (form) (may-fail-with-class-p form code)) body)))
      (style-warn-of-plan-text form
                               "~(~A~) does not fail with class ~S, but sets ~(~A~) to that value. ~
                               After the wait write (if (fluent-value ~(~A~)) ...). To fail, write ~
                                (fail :class (fluent-value ~(~A~))) there."
                               (first command) code fluent fluent fluent))))

(define-construct with-failure-handling (clauses &body body)
  "Run BODY in a plan and return all its values. The first of CLAUSES whose type matches handles a
failure. A clause is (type (variable) form...). A type is T, a class given to FAIL, a condition type
of failures or of Lisp, or (or type...). Handlers may wait. In a handler, (return value) ends
WITH-FAILURE-HANDLING with VALUE, and (retry) reruns BODY; else the failure propagates."
  (:parts (body node (scope-retry scope))
          (types list `',(mapcar #'first clauses))
          (handlers simple-vector `(vector ,@(loop for clause in clauses
                                                   collect (handler-code clause scope)))))
  (:code
   (progn
     (unless (proper-list-p clauses)
       (reject-clause (text-title) form "a list of clauses such as (type (variable) form...)"))
     (when (and clauses (atom (first clauses)))
       (reject-clause (text-title) clauses (format nil "a list of clauses: write (~(~S~))"
                                                   (abridged clauses))))
     (dolist (clause clauses)
       (check-handler-clause clause form scope)
       (dolist (code (ensure-list (first clause))) (warn-of-error-code-as-class code body form)))
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
                      (make-frame (svref handlers index)
                                  (vector environment
                                          (failure-for-clause signal (nth index types)))
                                  frame)
                      nil)))))))

(define-construct handle-failure (clauses &body body)
  "Do as WITH-FAILURE-HANDLING."
  (:like with-failure-handling))

(define-construct retry ()
  "In a handler of WITH-FAILURE-HANDLING, run the body again."
  (:code
   (if (scope-retry scope)
       `(make-leave :form ',(form-as-written form) :target ,(scope-retry scope) :result +nothing+)
       (reject-clause (text-title) form "retry only in a handler of handle-failure"))))

;;; A counter is a variable; another one, that only macros know, holds what it started with.

(defun initial-value-variable (counter)
  (or (get counter 'initial-value-variable)
      (setf (get counter 'initial-value-variable)
            (make-symbol (format nil "START-OF-~A" counter)))))

(defun check-counters (counters)
  (dolist (counter counters)
    (unless (typep counter '(cons (and symbol (not null)) (cons t null)))
      (reject-clause "with-retry-counters" counter "(name number)"))))

(define-construct with-retry-counters (counters &body body)
  "Run BODY in a plan with COUNTERS, each (name number), for DO-RETRY, GET-COUNTER and
RESET-COUNTER. (From CRAM, except that a counter is also a variable.)"
  (:in-lisp (progn
              (check-counters counters)
              `(let ,(loop for (name number) in counters
                           collect `(,(initial-value-variable name) ,number))
                 (let ,(loop for (name) in counters collect `(,name ,(initial-value-variable name)))
                   (declare (ignorable ,@(mapcar #'first counters)))
                   ,@body)))))

(define-construct do-retry (counter &body body)
  "If COUNTER is positive, decrement it and run BODY, usually (retry). For handlers. (From CRAM.)"
  (:in-lisp `(when (plusp ,counter)
               (decf ,counter)
               ,@body)))

(defun check-counter (operator counter environment)
  (unless (and counter (symbolp counter)
               (local-variable-p (initial-value-variable counter) environment))
    (reject-clause operator counter "the name of a counter of the with-retry-counters around it")))

(addition get-counter)
(defmacro get-counter (counter &environment environment)
  "Return how many times DO-RETRY may still run its body for COUNTER. (From CRAM.)"
  (check-counter "get-counter" counter environment)
  counter)

(addition reset-counter)
(defmacro reset-counter (counter &environment environment)
  "Set COUNTER of WITH-RETRY-COUNTERS to its initial value, and return that value. (From CRAM.)"
  (check-counter "reset-counter" counter environment)
  `(setq ,counter ,(initial-value-variable counter)))

;;; While the cleanup runs, the frame remembers the signal that is to go on after it, a completion
;;; if none. A task that is cleaning up does not evaporate: see EVAPORATE.

(defun start-cleanup (cleanup task frame signal)
  (setf (frame-data frame) signal)
  (push frame (task-cleaning task))
  (note-event task :clean)
  (make-frame cleanup (frame-environment frame) frame))

(defun end-cleanup (task frame)
  (setf (task-cleaning task) (remove frame (task-cleaning task)))
  (unless (task-cleaning task) (note-event task :cleaned))
  (shiftf (frame-data frame) nil))

(defun signal-after-cleanup (first signal task)
  "FIRST is the signal that caused a cleanup; SIGNAL is how the cleanup ended. If FIRST propagates
further, return NIL and FIRST. If SIGNAL propagates instead, return NIL."
  (let ((failed (typep signal 'plan-failure)))
    (when (or (eq first :evaporate) (and failed (not (completion-p first))))
      (when failed (note-suppressed-failure first signal task))
      (values nil first))))

(defun note-suppressed-failure (first failure task)
  (if (typep first 'plan-failure)
      (push failure (failure-suppressed first))
      (queue-notable-warning "A cleanup failed in " (task-label task) ": " (failure-text failure))))

(defun report-cleanup-timeout (cleanup)
  (queue-notable-warning "The cleanup " (form-text cleanup) " in " (task-label (current-task))
               " was given up at tick " (plan-time) ": it took longer than its limit."))

(defun cleanup-form (cleanup limit)
  "Return the form that runs CLEANUP for at most LIMIT ticks. LIMIT is a form, or NIL for no limit."
  (if limit
      (note-plan-text `(pursue ,cleanup
                               (seq (wait-time ,limit) (report-cleanup-timeout ',cleanup))))
      cleanup))

(define-construct evap-protect (protected cleanup &key limit)
  "Run PROTECTED, a form, in a plan, and then CLEANUP in every case: success, failure, evaporation
or a RETURN that leaves PROTECTED. CLEANUP may wait, but is abandoned with a warning after LIMIT
ticks. A failure of CLEANUP counts only if PROTECTED succeeded. Return all values of PROTECTED."
  (:parts (protected node (plan-code protected scope))
          (cleanup node (plan-code (cleanup-form cleanup limit) (single-value-scope scope))))
  (:steps
   (begin
    (next inside)
    (enter protected environment frame))
   (inside
    (next cleaning-up)
    (start-cleanup cleanup task frame (make-completion value)))
   (cleaning-up
    (let ((signal (end-cleanup task frame)))
      (if (completion-p signal)
          (receive-signal task frame signal)
          (unwind task (frame-up frame) signal)))))
  (:unwind
   (cond ((in-state-p inside)
          (next cleaning-up)
          (values t (start-cleanup cleanup task frame signal) nil))
         ((in-state-p cleaning-up)
          (signal-after-cleanup (end-cleanup task frame) signal task)))))
