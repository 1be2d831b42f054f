;;;; warnings.lisp -- warnings of plans that wait in vain, ignore errors, or do not end.

(in-package :ars-magna.rpl-robot)

;;; A plan that waits for a fluent waits in vain if nothing is left that could change that. Kickers
;;; run on by themselves; most of them move things, and know no fluents. So their code is looked
;;; through, and that of users' functions which it calls.

(defparameter *fluent-setters*
  '(set-value pulse (setf fluent-value) begin-plan robot-send)
  "The names of functions that change fluents, or cause changes, as plans and messages do.")

(defun may-set-fluents-p (object seen)
  "True if OBJECT, found in the code of a function, may change a fluent, directly or through
functions that OBJECT calls. SEEN is a table of objects that have been examined."
  (cond ((member object *fluent-setters* :test #'equal))
        ((gethash object seen) nil)
        ((functionp object)
         (setf (gethash object seen) t)
         (some (lambda (part) (may-set-fluents-p part seen)) (code-references object)))
        ((and (symbolp object) (users-symbol-p object) (fboundp object)
              (not (macro-function object)))
         (setf (gethash object seen) t)
         (may-set-fluents-p (fdefinition object) seen))))

(defvar *kicker-sets-fluents-cache* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "A table of alists by interface. Each alist says which kickers may change fluents.")

(defun kicker-sets-fluents-p (kicker interface)
  (let ((known (assoc kicker (gethash interface *kicker-sets-fluents-cache*) :test #'eq)))
    (if known
        (cdr known)
        (let* ((seen (make-hash-table :test 'eq))
               (answer (and (or (may-set-fluents-p (kicker-body kicker) seen)
                                (may-set-fluents-p (kicker-test kicker) seen))
                            t)))
          (push (cons kicker answer) (gethash interface *kicker-sets-fluents-cache*))
          answer))))

(defun kickers-may-set-fluents-p (interface)
  (some-kicker-p (lambda (kicker) (kicker-sets-fluents-p kicker interface))
                 (simulation-world (interface-simulation interface))))

;;; Commands do not fail: fluents such as ROBOT-MOVEMENT-ERROR* tell how they have ended. A plan
;;; that reads none of these may succeed though nothing was done. Reading, waiting and networks all
;;; count as looking; being blocked and interrupted are left out, as plans make use of both.

(defparameter *harmless-error-codes*
  '(:interrupt :not-moving :goto-local :already-tracking
    :lost-track :grasping :not-grasping :grasp-lost :not-inside :bin-open)
  "Error codes that are not failures, because plans use them, as in appendix D of the manual.")

(defun command-failed-p (command err)
  "True if ERR, the error code of COMMAND at its end, means a failure."
  (and err
       (not (member err *harmless-error-codes*))
       (not (member err (command-expected command)))))

;; Plain data, so that forks have it, too.
(defstruct (unread-end (:type list) (:conc-name unread-)
                       (:constructor make-unread (plan command part err)) (:copier nil))
  "A record that the command with the name COMMAND of plan number PLAN ended with the error code
ERR. PART is the index of the part; NIL stands for the robot."
  plan command part err)

(defun part-number (resource)
  (and (part-p resource) (part-index resource)))

(defun unread-fluents (unread driver)
  "Return the fluents that hold the results of the command in UNREAD, a record of DRIVER. The error
fluent comes last."
  (loop for variable in (get (unread-command unread) 'result-fluents)
        for value = (driver-fluent variable driver)
        collect (if (simple-vector-p value) (svref value (unread-part unread)) value)))

(defun still-unread-p (unread driver)
  (notany #'was-read-p (unread-fluents unread driver)))

(defun record-unread-end (driver action err)
  "Record that ACTION of DRIVER has ended with ERR, before plans can read ERR. The record replaces
the record of an earlier end of the same command."
  (let ((command (action-name action)) (task (action-task action))
        (part (part-number (action-resource action))))
    (when (or err (driver-unread driver))
      (setf (driver-unread driver)
            (remove-if (lambda (unread)
                         (or (not (still-unread-p unread driver))
                             (and (eq command (unread-command unread))
                                  (eql part (unread-part unread)))))
                       (driver-unread driver))))
    (when (and task
               (command-failed-p (action-command action) err)
               (not (action-told-p action))
               (not (action-cleanup-p action)))
      (let ((unread (make-unread (task-serial (task-top task)) command part err)))
        (mapc #'forget-reading (unread-fluents unread driver))
        ;; A task that waits for one of them will be woken.
        (when (still-unread-p unread driver) (push unread (driver-unread driver)))))))

(defun warn-of-unread-error (driver task)
  "Warn once if a command of TASK to the robot of DRIVER failed, and TASK succeeded without reading
the error."
  (let* ((serial (task-serial task))
         (all (driver-unread driver))
         (unread (find-if (lambda (unread)
                            (and (eql serial (unread-plan unread))
                                 (still-unread-p unread driver)))
                          all))
         (simulation (driver-simulation driver)))
    (setf (driver-unread driver) (remove serial all :key #'unread-plan))
    (when (and unread (not (message-queue-listener *message-queue*)))
      (warn-once (list :unread (task-label task)) (simulation-world simulation)
                 (format nil "The plan ~A succeeded, though its command rpl-~(~A~) ended with ~S, ~
                              and the plan did not look at ~A. After the wait write (if ~
                              (fluent-value ~:*~A) (fail ...)), or another reaction to the error."
                         (task-label task) (unread-command unread) (unread-err unread)
                         (fluent-form-text (first (last (unread-fluents unread driver)))))
                 :notable (or (live-p simulation)
                              (lambda () (still-unread-p unread driver)))))))

;;;; Commands that go on after their plan

;;; That is allowed (reading 185), but most often a wait was forgotten. Excluded: commands that take
;;; no time and do more than look, go on in the background, stop the robot, or clean up.

(defun unawaited-actions (interface task)
  "Return the actions in progress of the top-level TASK of INTERFACE that a plan should wait for."
  (remove-if-not (lambda (action)
                   (and (action-open-p action)
                        (or (interrupted-by-command-p action)
                            (trait-p :asks (action-command action)))
                        (not (trait-p :stops (action-command action)))
                        (not (action-cleanup-p action))
                        (action-task action)
                        (eq task (task-top (action-task action)))))
                 (actions-of-interface interface)))

(defun unawaited-advice (action)
  "Return a sentence that says what to do if ACTION should end with its plan; or NIL."
  (if (eq :evaporated (task-state (action-task action)))
      (format nil "The task that issued it was ended before, for example by a deadline. If the ~
                   command should end as well, stop the robot: (rpl-robot-stop).")
      (let ((wait (wait-for-action-text (action-outcome action) (action-driver action)
                                        (action-resource action))))
        (and wait (format nil "If the plan should end with the command, let the plan ~A." wait)))))

(defun warn-of-unawaited-action (interface task)
  (let ((action (first (unawaited-actions interface task))))
    (when action
      (warn-once-in-run interface (list :unawaited (task-label task))
                        "The plan ~A succeeded while its command rpl-~(~A~) was under way; the ~
                         command continues.~@[ ~A~]"
                        (task-label task) (action-name action) (unawaited-advice action)))))

;;; Programs may set fluents between two calls of RUN-TICKS. So it is a warning, once for each plan
;;; and run; without a reader of messages it is shown if the plan still waits when the run ends.

(defun others-may-set-fluents-p (interface)
  "True if the run has kickers, observers or other plans, which may set fluents."
  (let ((simulation (interface-simulation interface)))
    (or (world-has-kickers-p (simulation-world simulation))
        (simulation-observers simulation)
        (rest (simulation-participants simulation)))))

(defun waits-for-robot-only-p (task)
  "True if TASK waits only for fluents that only the robot changes, or for an unchanging value."
  (or (eq +no-fluent+ (task-awaiting task))
      (let ((fluents (fluents-awaited (list task))))
        (and fluents (every #'robot-fluent-p fluents)))))

(defun waits-for-rollout-p (task)
  "True if TASK waits for the end of the rollout that it runs in, which a text names."
  (let ((awaited (task-awaiting task)))
    (and (stringp awaited) (not (eq awaited +no-fluent+)))))

(defun stranded-parts (interface task)
  "Return the parts of TASK, a plan of INTERFACE, that wait in vain; NIL if TASK may go on."
  (let ((parts (waiting-parts task)))
    (and (notany #'waits-on-purpose-p parts)
         (notany #'waits-for-message-p parts)
         (notany #'waits-for-rollout-p parts)
         (or (every #'waits-for-robot-only-p parts)
             (not (others-may-set-fluents-p interface)))
         parts)))

(defun stranded-task-text (task parts)
  (format nil "~A, which nothing in the run will change.~A"
          (waiting-plans-text (list task)) (advice-on-endless-waits parts)))

(defun warn-of-stranded-task (interface task parts)
  "Warn once that TASK, a plan of INTERFACE, will not go on because PARTS of TASK wait in vain."
  (let ((simulation (interface-simulation interface))
        (awaited (mapcar #'task-awaiting parts)))
    (warn-once (list :stranded (task-label task))
               (simulation-world simulation)
               (list "At tick " (simulation-tick simulation) " " (stranded-task-text task parts)
                     (if (and (live-p simulation) (notany #'waits-for-robot-only-p parts))
                         " Only you can wake the plan, for example from a REPL."
                         ""))
               :notable (or (live-p simulation)
                            ;; Whether they still wait for that at the end.
                            (lambda () (equal awaited (mapcar #'task-awaiting parts)))))))

(defun deadlocked-p (interface)
  "True if plans of INTERFACE wait and nothing can ever wake them. For any thread."
  (and (null (blocking-task interface))
       ;; What is published tells most cases apart without the lock.
       (not (plans-ready-p interface))
       (with-plans (interface) (plan-deadlocked-p (interface-runner interface)))))

(defun stranded-plans (interface)
  "Return lists (task parts) of plans of INTERFACE that wait in vain; () if any of them can go on."
  (when (and (null (interface-awaited interface))
             (interface-valid-p interface)
             (tasks-of-interface interface)
             (deadlocked-p interface))
    (with-plans (interface)
      (loop for task in (tasks-of-interface interface)
            for parts = (stranded-parts interface task)
            when parts collect (list task parts)))))

(defun warn-of-stranded-plans (interface)
  (loop for (task parts) in (stranded-plans interface)
        do (let ((*reported-robot* (robot-name-of-plan task)))
             (warn-of-stranded-task interface task parts))))

(defmethod participant-after-ticks ((interface interface) simulation)
  (unless (simulation-over simulation) (warn-of-stranded-plans interface)))

(defun stranded-plan-text ()
  "Return a sentence on a plan, begun in the current simulation, that waits in vain, or NIL."
  (let ((interface (usable-interface)))
    (destructuring-bind (&optional task parts) (and interface (first (stranded-plans interface)))
      (and task (format nil "At the end ~A" (stranded-task-text task parts))))))

;;; Programs begin plans that never end, and stop when they have seen enough. Loops and policies say
;;; so, and RUN-UNTIL, PRINT-PLANS and the like do, see RECORD-PROGRESS-CHECKED. What is left are
;;; plans that would have ended, had more ticks passed.

(defun plan-cut-off-p (interface task)
  "True if TASK, of the plans of INTERFACE, is under way and would have ended by itself."
  (not (or (task-parent task)
           (task-over-p task)
           (member task (interface-ends-requested interface))
           (warning-given-p (list :stranded (task-label task))
                            (simulation-world (interface-simulation interface)))
           (some #'waits-on-purpose-p (all-tasks task)))))

(defmethod note-plans-shown ((interface interface))
  (record-progress-checked (simulation-world (interface-simulation interface))))

(defmethod participant-cut-off ((interface interface))
  (when (interface-valid-p interface)
    (with-plans (interface)
      (loop for task in (tasks-of-interface interface)
            when (plan-cut-off-p interface task)
              collect (format nil "the plan ~A" (task-label task))))))
