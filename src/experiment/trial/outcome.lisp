;;;; outcome.lisp -- how a trial went, from what its forms returned.

(in-package :ars-magna.experiment)

;;; An outcome is "success", "failure", "limit" (no more ticks were left), "error" (the trial's
;;; own code broke off) or "timeout" (it took too long by the clock). A failure has a reason, a word
;;; or two that others may share.

(defparameter *plan-states* '(:succeeded :failed :evaporated :deadlock :limit :stopped)
  "What RUN-PLAN returns as its second value.")

(defun reason-of-failure (failure)
  "Return the word for FAILURE, of a plan."
  (value-text (or (and (typep failure 'plan-failure) (failure-class failure))
                  (type-of failure))))

(defun success-p (outcome) (string= outcome "success"))

(defun plan-outcome (result state)
  "Return outcome and reason of a plan that RUN-PLAN said has RESULT and STATE."
  (case state
    (:succeeded (values "success" ""))
    (:failed (values "failure" (reason-of-failure result)))
    (:limit (values "limit" ""))
    (t (values "failure" (value-text state)))))

(defun task-outcome (task)
  "Return outcome and reason of TASK, a plan that was begun, as it is when its trial ends."
  (if (task-over-p task)
      (plan-outcome (task-result task) (task-state task))
      (values "failure" "unfinished")))

(defun outcome-of-values (&optional result reason &rest others)
  "Return outcome and reason of a trial whose form :run returned RESULT, REASON and OTHERS."
  (declare (ignore others))
  (cond ((member reason *plan-states*) (plan-outcome result reason))
        ((task-p result) (task-outcome result))
        (result (values "success" ""))
        (t (values "failure"
                   (if (and reason (typep reason '(or symbol string))) (value-text reason) "")))))

(defun check-run-something (values)
  "Signal MISUSE if VALUES, of :run, are a plan or the symbol that it is called by, and no tick has
passed."
  (let* ((value (first values))
         (plan (and value
                    (null (rest values))
                    (zerop (simulation-tick))
                    (typep value '(or symbol procedure))
                    (find-procedure value nil))))
    (when (and plan (or (eq plan value) (eq value (procedure-name plan))))
      (reject-use "The value of :run is the plan ~(~A~), which has not been run. Write ~A."
                  (procedure-name plan) (run-plan-text (procedure-name plan))))))

(defun error-in-plan (values)
  "Return the text of the error in Lisp code that let a plan fail, if VALUES are RUN-PLAN's and it
did; else an empty one."
  (if (and (eq :failed (second values)) (typep (first values) 'lisp-failure))
      (plain-text (failure-text (lisp-failure-condition (first values))))
      ""))
