;;;; plans.lisp -- plans started by the prompt: waiting for them and reporting how they end.

(in-package :ars-magna.cli)

;;; A plan is an errand like a command to the robot. Live, a thread watches each plan and reports
;;; its end. Now and then, between two reactions of the plans, it checks whether they can still
;;; continue; a plan that cannot is ended if the session waits for it. Headless, the prompt checks
;;; after each tick.
;;;
;;; A plan should recover from errors of its commands. So a session that waits for a plan does not
;;; count those errors, only the plan's own failure: see VERDICT.

(defstruct (plan-errand (:include errand) (:copier nil)
                        (:constructor make-plan-errand (plan session simulation)))
  "A plan that the prompt has started. STUCK is a list of two texts, what keeps it from ever
continuing and what could be done, or NIL."
  (plan nil :type symbol :read-only t)
  (session nil :type session :read-only t)
  (simulation nil :read-only t)
  ;; Who has started it, as messages tell.
  (asker *asker* :read-only t)
  (task nil)
  ;; Its end is not to be reported, as the run has been rewound.
  (let-go-p nil)
  (stuck nil :type list)
  ;; The last message on that.
  (told-stuck nil :type list)
  (over (make-semaphore "plan over") :read-only t)
  (told (make-semaphore "plan's end told") :read-only t))

(defvar *plan-errands* '() "The plans that the prompt has started and whose ends it has not reported
yet.")
(defvar *plan-errands-lock* (make-lock "plans of prompts"))

(defun plan-over-p (errand)
  (let ((task (plan-errand-task errand)))
    (and task (task-over-p task))))

(defun plan-runner-now ()
  (handler-case (rpl-runner) (misuse () nil)))

;;; A plan may end before BEGIN-PLAN has returned its task.

(defun note-plan-end (task)
  "Notify the waiting sessions that TASK, a plan, is over. True if the prompt has started it."
  (flet ((started-p (errand)
           (if (plan-errand-task errand)
               (eq task (plan-errand-task errand))
               (eq (task-name task) (plan-errand-plan errand)))))
    (let ((errand (with-lock (*plan-errands-lock*)
                    (let ((errand (find-if #'started-p *plan-errands*)))
                      (when errand (setf (plan-errand-task errand) task))
                      errand))))
      (when errand
        (signal-semaphore (plan-errand-over errand))
        t))))

(attend *plan-end-hooks* note-plan-end)

;;; What is told.

(defun in-user-words (function)
  "Return the string that FUNCTION makes, with names and numbers as users would read them."
  (let ((*package* (user-package))
        (*read-default-float-format* 'double-float)
        (*print-pretty* nil))
    (printing-words () (funcall function))))

(defun user-text (function object)
  "Return the string that FUNCTION makes of OBJECT, as users would read it, on a line."
  (cut (one-line (in-user-words (lambda () (funcall function object)))) 300))

(defun reason-text (failure)
  (if (eq (type-of failure) 'plan-failure)
      (format nil "~:[no reason given~;~:*~A~]~{ ~A~}"
              (and (failure-class failure) (safe-text (failure-class failure)))
              (mapcar #'safe-text (failure-data failure)))
      (condition-text failure)))

(defun verdict-of (errand control &rest arguments)
  (make-verdict (format nil "~(~A~) ~?" (plan-errand-plan errand) control arguments)
                (plan-errand-session errand)))

(defmacro with-messages-to ((errand) &body body)
  "Run BODY, whose messages belong to the simulation of ERRAND and to its line."
  `(let ((*message-queue* (simulation-messages (plan-errand-simulation ,errand)))
         (*told-of* (plan-errand-asker ,errand)))
     ,@body))

(defun waiting-for-plan-p (session)
  (and (session-patient-p session)
       (with-lock (*plan-errands-lock*)
         (find session *plan-errands* :key #'plan-errand-session))))

;; Errors in a trial belong to the trial. Those of commands issued by a plan, GO-TO or a program
;; that gets them belong to that.
(defmethod error-counts-p (message (session session))
  (and (null (session-visit session))
       (or (verdict-p (first (message-items message)))
           (not (or (left-to-program-p message)
                    (and (waiting-for-plan-p session) (not (of-line-p message)))
                    (and (others-p message)
                         (some #'errand-verdict-p (errands-under-way session))))))))

(defun note-failure (errand failure)
  "Make PLANS report FAILURE, of the plan of ERRAND, in each session that shows it."
  (dolist (session (adjoin (plan-errand-session errand)
                           (sessions-hearing (plan-errand-simulation errand))))
    (setf (session-failure session) (list failure (plan-errand-plan errand)))))

(defun tell-end (errand)
  (let ((result (task-result (plan-errand-task errand))))
    (with-messages-to (errand)
      (case (task-state (plan-errand-task errand))
        (:succeeded (message-set (verdict-of errand "succeeded: ~A"
                                             (user-text #'safe-text result))))
        (:failed (note-failure errand result)
                 (error-set (verdict-of errand "failed: ~A. PLANS tells more."
                                        (string-right-trim "." (user-text #'reason-text result)))))
        (t (message-set (verdict-of errand "was stopped.")))))))

(defun tell-stuck (errand)
  "Queue a message that says what the plan of ERRAND waits for in vain, and what could be done."
  (with-messages-to (errand)
    (destructuring-bind (waits advice) (plan-errand-stuck errand)
      (if (session-patient-p (plan-errand-session errand))
          (error-set (verdict-of errand "is in a deadlock: it ~A, which nothing will bring about; ~
                                         it was stopped.~@[ ~A~]" waits advice))
          (warning-set (verdict-of errand "~A, which neither the robot nor time will bring about, ~
                                           but you may. STOP-PLAN ends it.~@[ ~A~]"
                                 waits advice))))))

(defun close-errand (errand)
  (with-lock (*plan-errands-lock*) (removef *plan-errands* errand))
  ;; There is no task if the plan has not begun.
  (let ((task (plan-errand-task errand)))
    (end-errand errand (not (and task (eq :succeeded (task-state task))))))
  (signal-semaphore (plan-errand-told errand)))

;;; Deadlocks.

(defun stuck-texts (runner task)
  "Return in words what TASK of RUNNER waits for, and what could be done, if no plan of RUNNER can
ever continue; else NIL. Call it while no plan reacts."
  (when (and (not (task-over-p task)) (plan-deadlocked-p runner))
    (let ((tasks (waiting-parts task)))
      (list (user-text (lambda (tasks)
                         (format nil "waits for ~A" (or (text-of-waits tasks) "what cannot come")))
                       tasks)
            (let ((advice (one-line (in-user-words (lambda () (advice-on-stillness tasks))))))
              (and (string/= "" advice) (cut advice 1000)))))))

(defun note-if-stuck (errand runner)
  (setf (plan-errand-stuck errand) (stuck-texts runner (plan-errand-task errand))))

;;; Live.

(defun tell-if-stuck (errand runner)
  "Find out whether the plan of ERRAND is stuck; report it, unless it was reported last. Return the
answer to the last check."
  (let ((stuck (plan-errand-stuck errand)))
    (unless (or (null stuck) (equal stuck (plan-errand-told-stuck errand)))
      (setf (plan-errand-told-stuck errand) stuck)
      (tell-stuck errand)
      (when (session-patient-p (plan-errand-session errand))
        (stop-plan runner (plan-errand-task errand))))
    (ars-magna.rpl:post runner (lambda () (note-if-stuck errand runner)))
    stuck))

(defun watch-plan (errand runner)
  (loop with stuck = nil
        until (or (plan-over-p errand) (plan-errand-let-go-p errand))
        do (cond ((wait-on-semaphore (plan-errand-over errand) 0.2))
                 ((and (live-p (plan-errand-simulation errand)) (eq runner (plan-runner-now)))
                  (setf stuck (tell-if-stuck errand runner)))
                 (t (return)))
        finally (unless (or (plan-errand-let-go-p errand)
                            (and stuck (session-patient-p (plan-errand-session errand))))
                  (tell-end errand)))
  (close-errand errand))

(defun start-watching-plan (errand)
  (let ((runner (plan-runner-now)))
    ;; The thread would see the run of the terminal's prompt; this may be that of a window.
    (start-thread (lambda ()
                    (let* ((*simulation* (plan-errand-simulation errand))
                           (*world* (simulation-world *simulation*)))
                      (watch-plan errand runner)))
                  (format nil "prompt's watch of ~A" (plan-errand-plan errand)))))

;;; Headless.

(defun await-plan-headless (errand)
  (let ((runner (plan-runner-now)))
    (await (lambda () (or (plan-over-p errand) (note-if-stuck errand runner))))
    (let ((finished-p (cond ((plan-over-p errand) (tell-end errand) t)
                            ((plan-errand-stuck errand)
                             (tell-stuck errand)
                             (end-plan (plan-errand-task errand))
                             t))))
      (close-errand errand)
      (unless finished-p
        (reject-line "~(~A~) has not ended within ~D ticks; it goes on."
                     (plan-errand-plan errand) *patience*)))))

(defmethod await-errand ((errand plan-errand))
  (cond ((live-p (plan-errand-simulation errand))
         (loop until (or (wait-a-while (plan-errand-told errand) 0.2)
                         (held-up-p (plan-errand-simulation errand))))
         (show-messages (plan-errand-session errand)))
        (t (await-plan-headless errand))))

;;; A run that was rewound has other running plans.

(defun take-up-plan (session task)
  "Let SESSION wait for TASK, a running plan, as if its PLAN had just started that."
  (let ((errand (make-plan-errand (task-name task) session *simulation*)))
    (setf (plan-errand-task errand) task)
    (with-lock (*plan-errands-lock*) (push errand *plan-errands*))
    (push errand (session-errands session))
    (when (live-p *simulation*) (start-watching-plan errand))))

(defun take-up-plans (session)
  "Make SESSION wait for the plans that have replaced its own, whose run was rewound."
  (flet ((let-go-p (errand) (and (plan-errand-p errand) (plan-errand-let-go-p errand))))
    (mapc #'close-errand (remove-if-not #'let-go-p (session-errands session)))
    (setf (session-errands session) (remove-if #'let-go-p (session-errands session))))
  (dolist (task (plans))
    (when (and (member (task-name task) (session-plans session))
               (not (find task *plan-errands* :key #'plan-errand-task)))
      (take-up-plan session task))))
