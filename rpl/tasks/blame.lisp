;;;; blame.lisp -- what is known of a failure: where it happened and because of what.

(in-package :ars-magna.rpl.tasks)

(export '(*failure-hooks* failure-of plan-backtrace operator-called-p))

(defun operator-called-p (form &rest names)
  "True if FORM, of a plan's text, is a use of an operator that is called like one of NAMES."
  (and (typep form '(cons symbol)) (member (first form) names :test #'string=)))

(defun plan-backtrace (task frame)
  "Return the expressions under way in TASK at FRAME and around it, innermost first."
  (nconc (forms-under-way frame)
         (loop for whole in (rest (lineage task)) nconc (forms-under-way (task-frame whole)))))

(defun handled-failure (task frame)
  "Return the failure that TASK at FRAME, or a task around it, is handling or cleaning up after."
  (loop for each in (frames-around task frame)
        when (typep (frame-data each) 'plan-failure) return (frame-data each)))

(define-event *failure-hooks*
  "Functions that are called with each failure, its task and frame, where it happens.")

(defun failure-of (condition task frame)
  "Return the failure that CONDITION, met by TASK at FRAME, means, with all that is known of it. It
weighs as many steps as one could take meanwhile, so that a plan that only fails ends its slice."
  (let ((failure (if (typep condition 'plan-failure)
                     condition
                     (make-condition 'lisp-failure :condition condition
                                                   :backtrace (lisp-backtrace)))))
    (unless (failure-task-path failure)
      (weigh (if (typep failure 'lisp-failure) 5000 200) (task-runner task) task)
      (setf (failure-task-path failure) (task-path task)
            (failure-tick failure) (runner-tick (task-runner task))
            (failure-plan-backtrace failure) (plan-backtrace task frame)
            (failure-form failure) (first (failure-plan-backtrace failure))
            (failure-cause failure) (or (failure-cause failure) (handled-failure task frame)))
      (note-event task :failure failure)
      (hear-of-trouble (runner-client (task-runner task)) task failure)
      (tell-listeners *failure-hooks* failure task frame))
    failure))

(defun lisp-backtrace ()
  "Return as a string the Lisp calls under way in a plan's code that has just signalled an error."
  (let* ((calls (calls-under-way))
         (signalled (member-if (lambda (name) (and (symbolp name) (string= "%SIGNAL" name)))
                               calls :key #'first)))
    (with-output-to-string (stream)
      (loop for call in (if signalled (rest signalled) calls)
            for number from 0
            until (member (first call) '(run-steps step-leaf call-to-fate))
            do (format stream "    ~D: ~A~%" number (form-text call 100))))))

(defmethod value-behind ((task task))
  "BEGIN-PLAN returns the task of a plan that goes on; RUN-PLAN, the values of one that it runs.")
