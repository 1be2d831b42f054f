;;;; plans.lisp -- plans started by the prompt: waiting for them and reporting how they end.

(in-package :ars-magna.cli)

;;; A plan is a job, like a command to the robot. Live, a thread watches each plan and reports its
;;; end. Now and then, between two reactions, it checks whether the plans can still continue; a plan
;;; that cannot is ended if the session waits for it. Headless, the prompt checks after each tick.
;;;
;;; A plan should recover from errors of its commands. So a session that waits for a plan does not
;;; count those errors, only the plan's own failure: see VERDICT.

(defstruct (plan-job (:include job) (:copier nil)
                     (:constructor make-plan-job (plan session simulation)))
  "A plan that the prompt has started. STUCK is NIL, or a list of two texts: what the plan
waits for in vain, and what could be done."
  (plan nil :type symbol :read-only t)
  (session nil :type session :read-only t)
  (simulation nil :read-only t)
  ;; Who has started it, as messages tell.
  (asker *asker* :read-only t)
  (task nil)
  ;; Its end is not to be reported, as the run has been rewound.
  (forgotten-p nil)
  (stuck nil :type list)
  ;; The last message on that.
  (told-stuck nil :type list)
  (over (make-semaphore "plan over") :read-only t)
  (told (make-semaphore "plan's end told") :read-only t))

(defvar *plan-jobs* '() "The plans started by the prompt whose ends are not reported yet.")
(defvar *plan-jobs-lock* (make-lock "plans of prompts"))

(defun plan-over-p (job)
  (let ((task (plan-job-task job)))
    (and task (task-over-p task))))

(defun current-plan-runner ()
  (handler-case (rpl-runner) (misuse () nil)))

;;; A plan may end before BEGIN-PLAN has returned its task.

(defun note-plan-end (task)
  "Notify sessions that wait for TASK, a plan that is over. Return true if a prompt started TASK."
  (flet ((started-p (job)
           (if (plan-job-task job)
               (eq task (plan-job-task job))
               (eq (task-name task) (plan-job-plan job)))))
    (let ((job (with-lock (*plan-jobs-lock*)
                 (let ((job (find-if #'started-p *plan-jobs*)))
                   (when job (setf (plan-job-task job) task))
                   job))))
      (when job
        (signal-semaphore (plan-job-over job))
        t))))

(add-listener *plan-end-hooks* note-plan-end)

;;; What is told.

(defun call-in-user-syntax (function)
  "Return the string that FUNCTION makes, with names and numbers printed as users type them."
  (let ((*package* (user-package))
        (*read-default-float-format* 'double-float)
        (*print-pretty* nil))
    (printing-text () (funcall function))))

(defun text-in-user-syntax (function object)
  "Return FUNCTION's string for OBJECT on one line, with names and numbers as users type them."
  (cut (one-line (call-in-user-syntax (lambda () (funcall function object)))) 300))

(defun failure-reason-text (failure)
  (if (eq (type-of failure) 'plan-failure)
      (format nil "~:[no reason given~;~:*~A~]~{ ~A~}"
              (and (failure-class failure) (safe-text (failure-class failure)))
              (mapcar #'safe-text (failure-data failure)))
      (condition-text failure)))

(defun make-plan-verdict (job control &rest arguments)
  (make-verdict (format nil "~(~A~) ~?" (plan-job-plan job) control arguments)
                (plan-job-session job)))

(defmacro with-messages-for-job ((job) &body body)
  "Run BODY. Messages of BODY belong to the simulation of JOB and to the line that started JOB."
  `(let ((*message-queue* (simulation-messages (plan-job-simulation ,job)))
         (*request-origin* (plan-job-asker ,job))
         (*reported-robot* (and (plan-job-task ,job) (robot-name-of-plan (plan-job-task ,job)))))
     ,@body))

(defun waiting-for-plan-p (session)
  (and (session-patient-p session)
       (with-lock (*plan-jobs-lock*)
         (find session *plan-jobs* :key #'plan-job-session))))

;; Errors in a trial belong to the trial. Those of commands issued by a plan, GO-TO or a program
;; that gets them belong to that.
(defmethod error-counts-p (message (session session))
  (and (null (session-trial session))
       (or (verdict-p (first (message-items message)))
           (not (or (has-program-continuation-p message)
                    (and (waiting-for-plan-p session) (not (about-line-request-p message)))
                    (and (from-program-p message)
                         (some #'job-verdict-p (jobs-under-way session))))))))

(defun note-failure (job failure)
  "Let the line PLANS report FAILURE of JOB's plan in each session that shows the plan's run."
  (dolist (session (adjoin (plan-job-session job)
                           (sessions-showing (plan-job-simulation job))))
    (setf (session-failure session) (list failure (plan-job-plan job)))))

(defun report-plan-end (job)
  (let ((result (task-result (plan-job-task job))))
    (with-messages-for-job (job)
      (case (task-state (plan-job-task job))
        (:succeeded (message-set (make-plan-verdict job "succeeded: ~A"
                                                    (text-in-user-syntax #'safe-text result))))
        (:failed (note-failure job result)
                 (error-set (make-plan-verdict
                             job "failed: ~A. PLANS tells more."
                             (string-right-trim "." (text-in-user-syntax #'failure-reason-text
                                                                         result)))))
        (t (message-set (make-plan-verdict job "was stopped.")))))))

(defun report-stuck-plan (job)
  "Queue a message that says what the plan of JOB waits for in vain, and what could be done."
  (with-messages-for-job (job)
    (destructuring-bind (waits advice) (plan-job-stuck job)
      (if (session-patient-p (plan-job-session job))
          (error-set (make-plan-verdict
                      job "is in a deadlock and was stopped: it ~A, which nothing will bring ~
                           about.~@[ ~A~]"
                      waits advice))
          (warning-set (make-plan-verdict
                        job "~A. Neither the robot nor time can end this wait, but you can. ~
                             STOP-PLAN ends the plan.~@[ ~A~]"
                        waits advice))))))

(defun close-job (job)
  (with-lock (*plan-jobs-lock*) (removef *plan-jobs* job))
  ;; There is no task if the plan has not begun.
  (let ((task (plan-job-task job)))
    (end-job job (not (and task (eq :succeeded (task-state task))))))
  (signal-semaphore (plan-job-told job)))

;;; Deadlocks.

(defun stuck-plan-texts (runner task awaited-p)
  "If no plan of RUNNER can ever continue, return a list of two texts: what TASK waits for, and what
could be done. Otherwise return NIL. AWAITED-P is true if the session waits for the end of TASK. If
not, TASK may wait for a message. Call this function while no plan reacts."
  (let ((tasks (and (not (task-over-p task)) (waiting-parts task))))
    (when (and (not (task-over-p task))
               (plan-deadlocked-p runner)
               (or awaited-p (notany #'waits-for-message-p tasks)))
      (list (text-in-user-syntax (lambda (tasks)
                                   (format nil "waits for ~A"
                                           (or (text-of-waits tasks) "what cannot come")))
                                 tasks)
            (let ((advice (one-line (call-in-user-syntax (lambda ()
                                                           (advice-on-endless-waits
                                                            tasks (and awaited-p task)))))))
              (and (string/= "" advice) (cut advice 1000)))))))

(defun note-if-stuck (job runner)
  (setf (plan-job-stuck job)
        (stuck-plan-texts runner (plan-job-task job) (session-patient-p (plan-job-session job)))))

;;; Live.

(defun report-if-stuck (job runner)
  "Report if the last check has found the plan of JOB stuck, unless that was already reported. Post
the next check to RUNNER. Return the result of the last check."
  (let ((stuck (plan-job-stuck job)))
    (unless (or (null stuck) (equal stuck (plan-job-told-stuck job)))
      (setf (plan-job-told-stuck job) stuck)
      (report-stuck-plan job)
      (when (session-patient-p (plan-job-session job))
        (stop-plan runner (plan-job-task job))))
    (ars-magna.rpl:post-entry runner (lambda () (note-if-stuck job runner)))
    stuck))

(defun watch-plan (job runner)
  (loop with stuck = nil
        until (or (plan-over-p job) (plan-job-forgotten-p job))
        do (cond ((wait-on-semaphore (plan-job-over job) 0.2))
                 ((and (live-p (plan-job-simulation job)) (eq runner (current-plan-runner)))
                  (setf stuck (report-if-stuck job runner)))
                 (t (return)))
        finally (unless (or (plan-job-forgotten-p job)
                            (and stuck (session-patient-p (plan-job-session job))))
                  (report-plan-end job)))
  (close-job job))

(defun start-watching-plan (job)
  (let ((runner (current-plan-runner)))
    ;; The thread would see the run of the terminal's prompt; this may be that of a window.
    (start-thread (lambda ()
                    (let* ((*simulation* (plan-job-simulation job))
                           (*world* (simulation-world *simulation*)))
                      (watch-plan job runner)))
                  (format nil "prompt's watch of ~A" (plan-job-plan job)))))

;;; Headless.

(defun await-plan-headless (job)
  (let ((runner (current-plan-runner)))
    (await-test (lambda () (or (plan-over-p job) (note-if-stuck job runner))))
    (let ((finished-p (cond ((plan-over-p job) (report-plan-end job) t)
                            ((plan-job-stuck job)
                             (report-stuck-plan job)
                             (end-plan (plan-job-task job))
                             t))))
      (close-job job)
      (unless finished-p
        (reject-line "~(~A~) has not ended within ~D ticks; it continues."
                     (plan-job-plan job) *wait-limit*)))))

(defmethod await-job ((job plan-job))
  (cond ((live-p (plan-job-simulation job))
         (loop until (or (serve-and-wait-once (plan-job-told job) 0.2)
                         (paused-for-good-p (plan-job-simulation job))))
         (show-messages (plan-job-session job)))
        (t (await-plan-headless job))))

;;; A run that was rewound has other running plans.

(defun adopt-plan (session task)
  "Make SESSION wait for TASK, a running plan, as if SESSION had just started the plan."
  (let ((job (make-plan-job (task-name task) session *simulation*)))
    (setf (plan-job-task job) task)
    (with-lock (*plan-jobs-lock*) (push job *plan-jobs*))
    (push job (session-jobs session))
    (when (live-p *simulation*) (start-watching-plan job))))

(defun adopt-plans (session)
  "Make SESSION wait for the plans of the new run that have replaced its plans after a rewind."
  (flet ((forgotten-p (job) (and (plan-job-p job) (plan-job-forgotten-p job))))
    (mapc #'close-job (remove-if-not #'forgotten-p (session-jobs session)))
    (setf (session-jobs session) (remove-if #'forgotten-p (session-jobs session))))
  (dolist (task (plans))
    (when (and (member (task-name task) (session-plans session))
               (not (find task *plan-jobs* :key #'plan-job-task)))
      (adopt-plan session task))))
