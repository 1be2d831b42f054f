;;;; outcome.lisp -- what came of a trial, and how it went, from what its forms returned.

(in-package :ars-magna.experiment)

;;; An outcome is "success", "failure", "limit" (no more ticks were left), "error" (the trial's
;;; own code broke off) or "timeout" (it took too long by the clock). A failure has a reason, a word
;;; or two that others may share.

(define-record (result (:constructor make-result (condition trial seed)))
  "What came of a trial."
  (condition nil trial-condition)
  (trial 0 integer "the number of the trial" :export)
  (seed 0 integer "the seed of the trial" :export)
  (outcome "error" string
           "\"success\", \"failure\", \"limit\", \"error\" or \"timeout\"" :writable :export)
  (reason "" string "why the trial failed, a string" :writable :export)
  (ticks 0 (or null integer)
         "how many ticks passed, or NIL if the trial's time was up" :writable :export)
  (measures '() list :writable)
  (series '() list "what was recorded from tick to tick, lists (tick text...)" :writable)
  (digest nil (or null integer) "the digest of the state at the end, or NIL" :writable :export)
  (error "" string "what error there was, a string; \"\" if none" :writable :export))

(defparameter *plan-states* '(:succeeded :failed :evaporated :deadlock :limit :stopped)
  "What RUN-PLAN returns as its second value.")

(defun reason-of-failure (failure)
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

(defun add-error (result text)
  "Enter into RESULT that there was an error of which TEXT tells, unless there was one before."
  (when (string= "" (result-error result))
    (setf (result-error result) (plain-text text))))
