;;;; reacting.lisp -- reactions of a plan runner: turns of its agents, and what is posted.

(in-package :ars-magna.rpl.tasks)

(export '(react-to-all apply-next-batch agents-in-order slices-spent))

;;; A reaction runs ready tasks until none is ready. Only then is the next posted batch applied, and
;;; time passes only when there is none. So a task that issues a command and waits for its pulse has
;;; reached the wait before the pulse can come.
;;;
;;; In a round every ready task runs until it waits, ends or has used its slice. The agents take
;;; turns. If a task of one makes a task of another ready, the other gets another turn in the same
;;; round. Then the next post is applied. Tasks that have used their slices get new ones only when
;;; there are no more posts. So a plan that never waits does not keep others from reacting. Where a
;;; tick has a budget, slices are shares of it. A plan may then need several from a command to its
;;; wait, so there another limit than slices decides when posts are applied.
;;;
;;; An agent that has used its steps, or is stopped, is out of the reaction: its tasks and the posts
;;; for it wait, while other agents go on.

(defgeneric agents-in-order (client agents)
  (:documentation "Return the list AGENTS in the order of their turns in a reaction. CLIENT is the
client of their plan runner.")
  (:method (client agents)
    (declare (ignore client))
    agents))

(defgeneric slices-spent (client runner)
  (:documentation "Called in a reaction of RUNNER, the plan runner of CLIENT, when tasks have used
their slices. Time may have passed meanwhile. Return true if the reaction is to end now.")
  (:method (client runner)
    (declare (ignore client runner))
    nil))

;;; Rounds.

(defun run-ready-tasks (agent)
  "Run the ready tasks of AGENT. Return :idle when no ready task has steps left in its slice.
Return :budget when the steps of the reaction are used up, or when all tasks stop while one thinks."
  (let ((runner (agent-runner agent)))
    (loop
      (when (runner-ends-requested runner) (end-requested-tasks runner))
      (when (agent-out-p agent) (return :budget))
      (when (runner-notices runner) (deliver-due-notices runner))
      (let ((task (take-ready-task agent)))
        (cond (task (run-task task))
              ((and (runner-notices runner) (deliver-due-notices runner)))
              (t (return :idle)))))))

(defun begin-round (agent)
  "Begin a round of AGENT. But if a tick's budget has ended during a round, continue that round, so
that no task loses its turn."
  (unless (shiftf (agent-broken-off-p agent) nil)
    (incf (agent-round agent))))

(defmacro with-dice-of-agent ((agent) &body body)
  "Run BODY with the random state of AGENT for CL:RANDOM. If AGENT is NIL, or has none, just run
BODY, which is faster."
  (once-only (agent)
    `(flet ((body () ,@body))
       (declare (dynamic-extent #'body))
       (if (and ,agent (agent-lisps-dice ,agent))
           (with-random-state ((agent-lisps-dice ,agent)) (body))
           (body)))))

(defun take-turn (agent)
  "Run the ready tasks of AGENT, even if some meet trouble."
  (with-dice-of-agent (agent)
    (let ((outcome (loop thereis (call-handling-trouble agent #'run-ready-tasks))))
      (when (and (eq outcome :budget) (agent-charged-p agent))
        (setf (agent-broken-off-p agent) t)))))

(defun work-left-p (agent)
  "True if AGENT is not out and, in this round, can run a task or deliver a notice."
  (let ((runner (agent-runner agent)))
    (and (or (task-queued-p agent)
             (and (runner-notices runner) (due-notices runner)))
         (not (agent-out-p agent)))))

(defun run-round (runner agents)
  "Let AGENTS, agents of RUNNER, take turns until no ready task has steps left in its slice."
  (dolist (agent agents) (begin-round agent))
  (dolist (agent agents) (take-turn agent))
  (when (rest agents)
    (loop while (loop for agent in agents thereis (work-left-p agent))
          do (dolist (agent agents)
               (when (work-left-p agent) (take-turn agent)))))
  (when (and (null agents) (runner-ends-requested runner)) (end-requested-tasks runner)))

(defun renew-slices (agents)
  "Give new slices to the tasks of AGENTS that have used theirs. Return true if there are any."
  (let ((some-p nil))
    (dolist (agent agents some-p)
      (when (and (agent-spent agent) (not (agent-out-p agent)))
        (requeue-spent-tasks agent)
        (setf some-p t)))))

;;; Posting: any thread may POST a function of no arguments, or a batch of settings that are applied
;;; at one instant, see APPLY-SETTINGS. Each is done between two rounds, in the order of posting,
;;; but a post for an agent that is out waits.

(defun apply-next-batch (runner &optional (due-p (constantly t)))
  "Apply the oldest post of RUNNER, a batch or call, for whose agent (or NIL) the function DUE-P
returns true. Return true if there is one. Errors become messages."
  (multiple-value-bind (entry there agent) (take-posted-entry runner due-p)
    (when there
      (with-dice-of-agent (agent)
        (with-owned-home (runner)
          (if (functionp entry)
              (call-user-code entry "a call posted to a plan runner")
              (call-user-code #'apply-settings "a batch posted to a plan runner" entry))))
      t)))

(defun some-out-p (agents)
  (loop for agent in agents thereis (agent-out-p agent)))

(defun batch-due-p (agent)
  "True if AGENT, at the end of its round, does not keep posts from being applied."
  (or (null (agent-spent agent))
      (null (agent-budget agent))
      (not (agent-charged-p agent))
      (>= (- (agent-steps agent) (agent-batch-applied-at agent)) +steps-before-changes+)))

(defun apply-due-batch (runner agents)
  "Apply the next posted batch if it is due at the end of a round of AGENTS, all agents of RUNNER.
Return true if so."
  (let ((free-p (null agents)))
    (dolist (agent agents)
      (unless (agent-out-p agent)
        (unless (batch-due-p agent) (return-from apply-due-batch nil))
        (setf free-p t)))
    (when free-p
      (dolist (agent agents)
        (unless (agent-out-p agent)
          (setf (agent-batch-applied-at agent) (agent-steps agent))))
      (flet ((due-p (agent)
               (not (and agent (agent-out-p agent) (member agent agents)))))
        (declare (dynamic-extent #'due-p))
        (and (posted-p runner) (apply-next-batch runner #'due-p))))))

;;; Reactions.

(defun run-rounds (runner only)
  "Run the ready tasks of RUNNER, and apply its posts, until none are left. If ONLY is a list of
agents, run only their tasks, and apply no posts. Return :budget if an agent is out, or else :idle."
  (let ((known '()) (agents '()))
    (loop
      (let ((all (or only (runner-agents runner))))
        (unless (eq all known)
          (dolist (agent all) (unless (member agent known) (give-budget agent)))
          (setf known all
                agents (if (rest all) (agents-in-order (runner-client runner) all) all))))
      (run-round runner agents)
      (cond ((and (null only) (apply-due-batch runner agents)))
            ((renew-slices agents)
             (when (and (null only) (slices-spent (runner-client runner) runner))
               (return :budget)))
            ((and (null only) (not (eq known (runner-agents runner)))))
            (t (return (if (some-out-p agents) :budget :idle)))))))

(defun form-using-operator (name form)
  (cond ((operator-called-p form name) form)
        ((consp form)
         (or (form-using-operator name (car form)) (form-using-operator name (cdr form))))))

(defun runaway-remedy (task)
  (let* ((form (find-if (lambda (form)
                          (operator-called-p form "LOOP" "HANDLE-FAILURE" "WITH-FAILURE-HANDLING"))
                        (plan-backtrace task (task-frame task))))
         (loop-p (operator-called-p form "LOOP"))
         (wait (and loop-p (form-using-operator "WAIT-FOR" form))))
    (cond (wait
           (format nil "~A does not wait if its condition is true already. Also wait until it ~
                        is false, or write (wait-time 1)." (form-text wait)))
          ((and form (not loop-p) (form-using-operator "RETRY" form))
           (one-line "If it fails again at once, write (wait-time 1) before (retry), or count how
often: (do-retry tries (retry)) in (with-retry-counters ((tries 3)) ...)."))
          (t (format nil "If the plan is to wait, write (wait-time 1) there~:[~;; if the loop is ~
                          to end, write (return)~]. Ctrl-C interrupts RUN-PLAN." loop-p)))))

(defun runaway-p (agent)
  "True if AGENT, without a budget, has taken *RUNAWAY-LIMIT* steps in this reaction."
  (and (null (agent-budget agent))
       (agent-out-p agent)
       (not (agent-exhausted agent))
       (not (agent-stopped-p agent))))

(defun warn-of-runaway (agent)
  (let* ((task (find :ready (append (agent-spent agent)
                                    (remove nil (coerce (ring-items (svref (agent-rings agent) 0))
                                                        'list)))
                     :key #'task-state))
         (form (and task (task-form task))))
    (when (and task (first-warning-p form (agent-runner agent)))
      (warn-at-once "A plan took " *runaway-limit* " steps without waiting, at " (form-text form)
                    " in " (task-label task) "; time passes all the same. "
                    (runaway-remedy task)))))

(defun react (runner &optional only)
  "Let RUNNER react as RUN-ROUNDS does, with the list of agents ONLY. Warn of agents that run away."
  (with-owned-home (runner)
    (prog1 (let ((*leaves-offer-restarts* *break-on-user-error*))
             (run-rounds runner only))
      (dolist (agent (or only (runner-agents runner)))
        (when (runaway-p agent) (warn-of-runaway agent))))))

(defun react-to-all (runner)
  "Let RUNNER run its ready tasks and apply all posts, one after the other, and return :idle. If the
budget of steps of some agent is used up first, return :budget; the rest of its tasks wait for the
next reaction. Without a budget, an agent stops after *RUNAWAY-LIMIT* steps, with a warning."
  (react runner))
