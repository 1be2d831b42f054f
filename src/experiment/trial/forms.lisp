;;;; forms.lisp -- calling the forms of an experiment in a trial, and what one says that breaks off.

(in-package :ars-magna.experiment)

(export '(call-until-error))

(defun call-form (function condition)
  "Call FUNCTION, of a form of the experiment, with the values that CONDITION has for variables."
  (apply (the function function) (condition-arguments condition)))

(defun truth-of (clause function condition)
  "Return what FUNCTION, of the form of CLAUSE, returns. Signals MISUSE if that is a fluent, or how
a plan has failed."
  (let ((value (call-form function condition)))
    (when (fluent-p value)
      (reject-use "The value of ~(~S~) is the fluent ~A itself, which is true whatever its value ~
                   is. Write (fluent-value ...)." clause (fluent-text value)))
    (when (typep value 'plan-failure)
      (reject-use "The value of ~(~S~) is the failure of a plan, which is true. RUN-PLAN returns ~
                   how a plan ended as its second value: (eq (second (trial-values)) :succeeded)."
                  clause))
    value))

(defun text-of-measure (clause name function condition)
  "Return the text of what FUNCTION, called NAME in CLAUSE, returns. Signals WRONG-ARGUMENT if a
table cannot have it."
  (let ((value (call-form function condition)))
    (unless (value-p value)
      (reject-argument clause name value "a number, symbol, string or list of them"))
    (value-text value)))

(defvar *aside-p* nil
  "True while somebody looks at a trial that stands still: what goes wrong is not the trial's.")

(defun call-until-error (function)
  "Call FUNCTION, which is not to end this Lisp. Return the condition with which it broke off, or
NIL."
  (flet ((leave (condition)
           (unless *aside-p*
             (when (and *break-on-user-error* (not (typep condition 'storage-condition)))
               (invoke-debugger condition))
             (return-from call-until-error condition))))
    (let ((*aside-p* nil))
      (handler-bind (((or error storage-condition) #'leave))
        (call-refusing-exits function)))
    nil))

(defun trouble-text (function)
  "Call FUNCTION. Return what is to be said if it breaks off, or NIL."
  (let ((trouble (catch 'broken-off
                   (restart-case (call-until-error function)
                     (abort () :report "End this trial." "aborted")))))
    (when (typep trouble 'condition) (regain-room trouble))
    (if (typep trouble 'condition)
        (call-plainly (lambda () (text-of-condition trouble)))
        trouble)))
