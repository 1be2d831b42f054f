;;;; warnings.lisp -- warnings of plans that wait in vain, ignore errors, or do not end.

(in-package :ars-magna.rpl-robot)

;;; A plan that waits for a fluent waits in vain if nothing is left that could change that. Kickers
;;; run on by themselves; most of them move things, and know no fluents. So their code is looked
;;; through, and that of users' functions which it calls.

(defparameter *fluent-setters*
  '(set-value pulse (setf fluent-value) begin-plan)
  "The names of functions by which code may change a fluent, or have a plan do so.")

(defun may-set-fluents-p (object seen)
  "True if OBJECT, in the code of a function, or what that calls, may change a fluent. SEEN is a
table of what has been looked through."
  (cond ((member object *fluent-setters* :test #'equal))
        ((gethash object seen) nil)
        ((functionp object)
         (setf (gethash object seen) t)
         (some (lambda (part) (may-set-fluents-p part seen)) (code-references object)))
        ((and (symbolp object) (users-symbol-p object) (fboundp object)
              (not (macro-function object)))
         (setf (gethash object seen) t)
         (may-set-fluents-p (fdefinition object) seen))))

(defvar *known-kickers* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "For each interface an alist of kickers: whether they may change fluents.")

(defun kicker-sets-fluents-p (kicker interface)
  (let ((known (assoc kicker (gethash interface *known-kickers*) :test #'eq)))
    (if known
        (cdr known)
        (let* ((seen (make-hash-table :test 'eq))
               (answer (and (or (may-set-fluents-p (kicker-body kicker) seen)
                                (may-set-fluents-p (kicker-test kicker) seen))
                            t)))
          (push (cons kicker answer) (gethash interface *known-kickers*))
          answer))))

(defun kickers-may-set-fluents-p (interface)
  (some-kicker-p (lambda (kicker) (kicker-sets-fluents-p kicker interface))
                 (simulation-world (interface-simulation interface))))

;;; Commands do not fail: fluents such as ROBOT-MOVEMENT-ERROR* tell how they have ended. A plan
;;; that reads none of these may succeed though nothing was done. Reading, waiting and networks all
;;; count as looking; being blocked and interrupted are left out, as plans make use of both.

(defparameter *codes-of-no-trouble*
  '(:interrupt :not-moving :goto-local :already-tracking
    :lost-track :grasping :not-grasping :grasp-lost :not-inside :bin-open)
  "Codes with which commands end that plans use, as those of the manual's appendix D do.")

(defun came-to-nothing-p (command err)
  "True if COMMAND, which ended with ERR, could not do what it is for."
  (and err
       (not (member err *codes-of-no-trouble*))
       (not (member err (command-expected command)))))

;; Plain data, so that forks have it, too.
(defstruct (unread-end (:type list) (:conc-name unread-)
                       (:constructor make-unread (plan command part err)) (:copier nil))
  "That COMMAND, a name, of the plan numbered PLAN on the part PART (NIL: robot) ended with ERR."
  plan command part err)

(defun number-of-part (resource)
  (and (part-p resource) (part-index resource)))

(defun unread-fluents (unread)
  "Return the fluents that tell of UNREAD, that of its error the last."
  (loop for variable in (get (unread-command unread) 'result-fluents)
        for value = (symbol-value variable)
        collect (if (simple-vector-p value) (svref value (unread-part unread)) value)))

(defun still-unread-p (unread)
  (notany #'was-read-p (unread-fluents unread)))

(defun note-unread (interface action err)
  "Note that ACTION of INTERFACE has ended with ERR, before this can be read. It supersedes the last
end of the same command."
  (let ((command (action-name action)) (task (action-task action))
        (part (number-of-part (action-resource action))))
    (when (or err (interface-unread interface))
      (setf (interface-unread interface)
            (remove-if (lambda (unread)
                         (or (not (still-unread-p unread))
                             (and (eq command (unread-command unread))
                                  (eql part (unread-part unread)))))
                       (interface-unread interface))))
    (when (and task
               (came-to-nothing-p (action-command action) err)
               (not (action-told-p action))
               (not (action-cleanup-p action)))
      (let ((unread (make-unread (task-serial (task-top task)) command part err)))
        (mapc #'forget-reading (unread-fluents unread))
        ;; A task that waits for one of them will be woken.
        (when (still-unread-p unread) (push unread (interface-unread interface)))))))

(defun warn-of-unread (interface task)
  "Say once if a command of TASK, which has succeeded, came to nothing and that was not read."
  (let* ((serial (task-serial task))
         (all (interface-unread interface))
         (unread (find-if #'still-unread-p (remove serial all :key #'unread-plan :test-not #'eql)))
         (simulation (interface-simulation interface)))
    (setf (interface-unread interface) (remove serial all :key #'unread-plan))
    (when (and unread (not (message-queue-listener *message-queue*)))
      (warn-once (list :unread (task-label task)) (simulation-world simulation)
                 (format nil "The plan ~A succeeded, though its command rpl-~(~A~) ended with ~S, ~
                              and did not look at ~A. After the wait write (if (fluent-value ~
                              ~:*~A) (fail ...)), or what is to be done then."
                         (task-label task) (unread-command unread) (unread-err unread)
                         (fluent-form-text (first (last (unread-fluents unread)))))
                 :notable (or (live-p simulation) (lambda () (still-unread-p unread)))))))

;;;; Commands that go on after their plan

;;; That is allowed (reading 185), but most often a wait has been forgotten. Not counted are
;;; commands that take no time and do more than look, go on in the background, stop the robot, or
;;; were given to clean up.

(defun unawaited-actions (interface task)
  "Return what the top-level TASK, of INTERFACE, has asked for and is under way."
  (remove-if-not (lambda (action)
                   (and (action-open-p action)
                        (or (ends-by-command-p action)
                            (trait-p :asks (action-command action)))
                        (not (trait-p :stops (action-command action)))
                        (not (action-cleanup-p action))
                        (action-task action)
                        (eq task (task-top (action-task action)))))
                 (interface-actions interface)))

(defun unawaited-advice (action)
  "Return in a sentence what to do if ACTION is to end with its plan; or NIL."
  (if (eq :evaporated (task-state (action-task action)))
      (format nil "The task that issued it was ended before, as by a deadline. ~
                   If the command is to end as well, stop it: (rpl-robot-stop).")
      (let ((wait (end-wait-text (action-outcome action) (action-resource action))))
        (and wait (format nil "If the plan is to end with it, let it ~A." wait)))))

(defun warn-of-unawaited (interface task)
  (let ((action (first (unawaited-actions interface task))))
    (when action
      (warn-once-in-run interface (list :unawaited (task-label task))
                        "The plan ~A succeeded while its command rpl-~(~A~) was under way, which ~
                         continues.~@[ ~A~]"
                        (task-label task) (action-name action) (unawaited-advice action)))))

;;; Programs may set fluents between two calls of RUN-TICKS. So it is a warning, once for each plan
;;; and run; without a reader of messages it is shown if the plan still waits when the run ends.

(defun others-may-help-p (interface)
  "True if what the run calls besides plans may set fluents: kickers, observers, other plans."
  (let ((simulation (interface-simulation interface)))
    (or (world-has-kickers-p (simulation-world simulation))
        (simulation-observers simulation)
        (rest (simulation-participants simulation)))))

(defun robots-wait-p (task)
  "True if TASK waits for nothing but what only the robot changes, or for what never changes."
  (or (eq +no-fluent+ (task-awaiting task))
      (let ((fluents (fluents-awaited (list task))))
        (and fluents (every #'robots-fluent-p fluents)))))

(defun stranded-parts (interface task)
  "Return the parts of TASK, a plan of INTERFACE, that wait in vain; NIL if it may go on."
  (let ((parts (waiting-parts task)))
    (and (notany #'watches-p parts)
         (or (every #'robots-wait-p parts)
             (not (others-may-help-p interface)))
         parts)))

(defun text-of-stranded (task parts)
  (format nil "~A, which nothing in the run will change.~A"
          (text-of-plans (list task)) (advice-on-stillness parts)))

(defun warn-of-stranded (interface task parts)
  "Say once that TASK, of the plans of INTERFACE, will not go on, as PARTS of it wait in vain."
  (let ((simulation (interface-simulation interface))
        (awaited (mapcar #'task-awaiting parts)))
    (warn-once (list :stranded (task-label task))
               (simulation-world simulation)
               (list "At tick " (simulation-tick simulation) " " (text-of-stranded task parts)
                     (if (and (live-p simulation) (notany #'robots-wait-p parts))
                         " So it waits until you do, as from a REPL."
                         ""))
               :notable (or (live-p simulation)
                            ;; Whether they still wait for that at the end.
                            (lambda () (equal awaited (mapcar #'task-awaiting parts)))))))

(defun deadlocked-p (interface)
  "True if plans of INTERFACE wait and nothing can ever wake them. For any thread."
  (and (null (hog-of interface))
       ;; What is published tells most cases apart without the lock.
       (not (ready-p interface))
       (with-plans (interface) (plan-deadlocked-p (interface-runner interface)))))

(defun stranded-plans (interface)
  "Return lists (task parts) of plans of INTERFACE that wait in vain; () if any of them can go on."
  (when (and (null (interface-awaited interface))
             (interface-valid-p interface)
             (tasks-of interface)
             (deadlocked-p interface))
    (with-plans (interface)
      (loop for task in (tasks-of interface)
            for parts = (stranded-parts interface task)
            when parts collect (list task parts)))))

(defun warn-of-stranded-plans (interface)
  "Say so if plans of INTERFACE were begun and wait in vain."
  (loop for (task parts) in (stranded-plans interface)
        do (warn-of-stranded interface task parts)))

(defmethod participant-after-ticks ((interface interface) simulation)
  (unless (simulation-over simulation) (warn-of-stranded-plans interface)))

(defun stranded-plan-text ()
  "Return in a sentence that a plan that was begun in the current simulation waits in vain, or NIL."
  (let ((interface (usable-interface)))
    (destructuring-bind (&optional task parts) (and interface (first (stranded-plans interface)))
      (and task (format nil "At the end ~A" (text-of-stranded task parts))))))

;;; Programs begin plans that never end, and stop when they have seen enough. Loops and policies say
;;; so, and RUN-UNTIL, PRINT-PLANS and the like do, see RECORD-PROGRESS-CHECKED. What is left are
;;; plans that would have ended, had more ticks passed.

(defun cut-off-p (interface task)
  "True if TASK, of the plans of INTERFACE, is under way and would have ended by itself."
  (not (or (task-parent task)
           (task-over-p task)
           (member task (interface-ends-requested interface))
           (warning-given-p (list :stranded (task-label task))
                            (simulation-world (interface-simulation interface)))
           (some #'watches-p (all-tasks task)))))

(defmethod note-plans-shown ((interface interface))
  (record-progress-checked (simulation-world (interface-simulation interface))))

(defmethod participant-cut-off ((interface interface))
  (when (interface-valid-p interface)
    (with-plans (interface)
      (loop for task in (tasks-of interface)
            when (cut-off-p interface task)
              collect (format nil "the plan ~A" (task-label task))))))
