;;;; failure.lisp -- how plans fail.

(in-package :ars-magna.rpl.tasks)

(export '(failure-matches-p failure-passed-on-by failure-for-clause failure-text make-failure
          write-failure))

;;; A failure is a condition but no error: failing is normal in plans, and IGNORE-ERRORS in a plan's
;;; Lisp code must not swallow it. It spreads from a task to the construct that the task is part of,
;;; until something handles it.

(addition plan-failure)
(define-condition plan-failure (serious-condition)
  ((class :initarg :class :initform nil :reader failure-class)
   (data :initarg :data :initform '() :reader failure-data)
   (form :initform nil :accessor failure-form)
   (path :initform nil :accessor failure-task-path)
   (tick :initform nil :accessor failure-tick)
   (cause :initarg :cause :initform nil :accessor failure-cause)
   (suppressed :initform '() :accessor failure-suppressed)
   ;; The type of the last clause that has handled it and let it propagate.
   (passed-on-by :initform nil :accessor failure-passed-on-by)
   (expressions :initform '() :accessor failure-plan-backtrace))
  (:report (lambda (failure stream) (write-string (failure-report failure) stream)))
  (:documentation "A failure of a plan. Your own condition types may inherit from PLAN-FAILURE. If
NAME is such a type, (fail :class name ...) makes a condition of this type; otherwise it makes a
PLAN-FAILURE of class NAME."))

(addition composite-failure)
(define-condition composite-failure (plan-failure)
  ((failures :initarg :failures :initform '() :reader composite-failures)
   ;; How many attempts were made, if not as many as there are failures.
   (attempts :initarg :attempts :initform nil :reader composite-attempts))
  (:documentation "All attempts or branches of a construct have failed."))

(addition lisp-failure)
(define-condition lisp-failure (plan-failure)
  ((condition :initarg :condition :reader lisp-failure-condition)
   (backtrace :initarg :backtrace :initform "" :reader lisp-failure-backtrace))
  (:documentation "Lisp code of a plan signalled an error."))

(addition failure-class failure-data failure-form failure-task-path failure-tick failure-cause
          failure-suppressed failure-plan-backtrace composite-failures lisp-failure-condition
          lisp-failure-backtrace)
(loop for (reader text) in
      '((failure-class "Return the class given to FAIL, or NIL.")
        (failure-data "Return the further arguments of FAIL, a property list.")
        (failure-form "Return the plan's expression that failed.")
        (failure-task-path "Return the names of the tasks from the top of the plan to the failed
task.")
        (failure-tick "Return the tick at which the failure happened.")
        (failure-cause "Return the failure that was being handled when the failure happened, or
NIL.")
        (failure-passed-on-by "Return the type in the last clause that handled the failure and let
it propagate; or NIL.")
        (failure-suppressed "Return the failures that happened while plans cleaned up after the
failure.")
        (failure-plan-backtrace "Return the expressions in progress when the failure happened,
innermost first.")
        (composite-failures "Return the failures that make up a composite failure, in order.")
        (lisp-failure-condition "Return the Lisp condition behind the failure.")
        (lisp-failure-backtrace "Return the Lisp backtrace of the error, a string."))
      do (setf (documentation reader 'function) text))

(defgeneric write-failure (failure stream)
  (:documentation "Write a description of FAILURE to STREAM, on one line.")
  (:method ((failure plan-failure) stream)
    (format stream "Plan failure~@[ ~A~]~{ ~A~}"
            (and (failure-class failure) (safe-text (failure-class failure)))
            (mapcar #'safe-text (failure-data failure))))
  (:method ((failure composite-failure) stream)
    (let* ((count (length (composite-failures failure)))
           (attempts (or (composite-attempts failure) count)))
      (format stream "~:[~D of ~;All ~*~]~D attempts failed: ~{~A~^; ~}"
              (= count attempts) count attempts
              (mapcar #'failure-text (composite-failures failure)))))
  (:method ((failure lisp-failure) stream)
    (format stream "Lisp error in a plan: ~A" (failure-text (lisp-failure-condition failure)))))

(defconstant +longest-failure+ 2000 "The largest number of characters in the text of a failure.")

(defmacro safe-report-text ((condition) form)
  "Return the beginning of the text that FORM returns. If FORM signals an error, return a text of
the parts of CONDITION that can be printed."
  `(cut (handler-case (printing-text () ,form)
          ((or error storage-condition) () (partial-report ,condition)))
        +longest-failure+))

(defun failure-report (failure)
  (safe-report-text (failure)
    (with-output-to-string (stream) (write-failure failure stream))))

(defun failure-text (failure)
  "Return the report of FAILURE, or of another condition, cut if it is deep, long or circular. If
the report signals an error, return the type of FAILURE."
  (safe-report-text (failure) (or (simulator-error-text failure) (report-briefly failure))))

(defun make-failure (arguments)
  "Return the failure that (fail ARGUMENTS...) makes."
  (destructuring-bind (&optional (head nil) &rest more) arguments
    (cond ((null arguments) (make-condition 'plan-failure))
          ((typep head 'plan-failure) head)
          ((typep head 'condition) (make-condition 'lisp-failure :condition head))
          (t (when (and (eq head :class) (consp more)) (setf head (pop more)))
             (if (and (symbolp head) (find-class head nil) (subtypep head 'plan-failure))
                 (apply #'make-condition head more)
                 (make-condition 'plan-failure :class head :data more))))))

(public fail)
(defun fail (&rest arguments)
  "Make the task fail. ARGUMENTS are nothing, a condition, or a class and a property list of data or
initargs. The class may follow the word :class. A class is a name, or a subclass of PLAN-FAILURE
(manual D.2). The failure propagates to the innermost construct that handles it."
  (error (make-failure arguments)))

(defun failure-matches-p (failure type)
  "True if TYPE, the type of a clause, matches FAILURE. TYPE is T, a class given to FAIL, a
condition type of the failure or of its Lisp error, or (or TYPE...)."
  (cond ((eq type t) t)
        ((consp type) (some (lambda (type) (failure-matches-p failure type)) (rest type)))
        ((and (failure-class failure) (symbolp (failure-class failure))
              (same-name-p type (failure-class failure))))
        ((null (find-class type nil)) nil)
        ((typep failure type) t)
        ((typep failure 'lisp-failure) (typep (lisp-failure-condition failure) type))))

(defun failure-for-clause (failure type)
  "Return the object that the variable of a clause for TYPE is bound to. The object is FAILURE, or
the Lisp condition of FAILURE if TYPE is a type of Lisp conditions."
  (if (and (typep failure 'lisp-failure)
           (symbolp type) (not (eq type t)) (find-class type nil)
           (not (typep failure type)))
      (lisp-failure-condition failure)
      failure))
