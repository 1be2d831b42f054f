;;;; under-way.lisp -- commands of plans in progress, and how plans learn of their ends.

(in-package :ars-magna.rpl-robot)

;;; A command that a plan has issued is an ACTION until its last answer has been applied.

(defstruct (action (:constructor make-action (command resource outcome task cleanup-p issue tick))
                   (:copier nil))
  "A record that COMMAND, issued by a plan, is in progress on RESOURCE. TASK issued the command at
TICK; TASK is NIL for calls from outside of plans. CLEANUP-P is true if the command is part of a
cleanup. OUTCOME returns the settings of fluents for an answer."
  (command nil :type command :read-only t)
  (resource nil :read-only t)
  (outcome nil :type function :read-only t)
  (task nil :type (or null task) :read-only t)
  (cleanup-p nil :read-only t)
  ;; Its record in the trace, or NIL.
  (issue nil :read-only t)
  (tick 0 :type fixnum :read-only t)
  ;; Its identity in the simulator.
  (continuation nil :type (or null function))
  ;; It goes on in the background, as a track that has begun.
  (begun-p nil)
  ;; Plans have been told that it was interrupted.
  (told-p nil)
  ;; Its last answer has come.
  (over-p nil))

(defun action-name (action)
  (command-name (action-command action)))

(defstruct (answer (:constructor make-answer (action err settings last-p)) (:copier nil))
  "An answer to ACTION with the error code ERR, whose SETTINGS of fluents are not yet applied."
  (action nil :type action :read-only t)
  (err nil :read-only t)
  (settings '() :type list :read-only t)
  (last-p nil :read-only t))

(defun add-action (action interface)
  (with-lock ((interface-actions-lock interface))
    (setf (interface-actions interface) (append (interface-actions interface) (list action))))
  action)

(defun forget-action (action interface)
  (with-lock ((interface-actions-lock interface))
    (removef (interface-actions interface) action)))

(defun action-open-p (action)
  (not (or (action-told-p action) (action-over-p action))))

;;; Settings. (:error fluent code) sets a fluent as :SET does.

(defun settings-to-apply (settings)
  (loop for (kind . more) in settings
        collect (cons (if (eq kind :error) :set kind) more)))

;;; Answers.

(defun final-answer-p (command err)
  "True if ERR comes with the last answer to COMMAND: a track is answered at its beginning and end."
  (or err (not (trait-p :begins command))))

(defun add-answer (answer interface)
  (with-lock ((interface-actions-lock interface))
    (setf (interface-answers interface) (append (interface-answers interface) (list answer)))))

(defun take-answer (answer interface)
  "Remove ANSWER from the answers not yet applied. If ANSWER is the last of its action, remove the
action, too. Return true if ANSWER was not yet applied."
  (with-lock ((interface-actions-lock interface))
    (when (member answer (interface-answers interface))
      (removef (interface-answers interface) answer)
      (when (answer-last-p answer) (removef (interface-actions interface) (answer-action answer)))
      t)))

(defun interrupted-by-command-p (action)
  "True if a new command on the same resource interrupts ACTION at once. A command that takes no
time is carried out first, and a command in the background goes on."
  (not (or (action-begun-p action)
           (command-instant-p (action-command action)))))

;;; The simulator answers in its own thread. An answer, a list of settings of fluents, is applied
;;; between two reactions of plans. When a plan's command interrupts older ones on its resource,
;;; their answers are applied at once: those that have come in already, else :INTERRUPT. So a wait
;;; after a command gets the end of that command. The simulator's own later answer to an
;;; interrupted command sets only the fluents for the state of the robot: no error fluent, no pulse.

(defun note-pulses (interface action settings)
  "Record which fluents are pulsed in this tick by SETTINGS at the end of ACTION of INTERFACE."
  (when (action-task action)
    (loop with plan = (task-serial (task-top (action-task action)))
          for (kind fluent) in settings
          for name = (and (eq :pulse kind) (fluent-name fluent))
          when name
            do (setf (interface-pulses interface)
                     (cons (list name plan (simulation-tick (interface-simulation interface)))
                           (remove name (interface-pulses interface)
                                   :key #'first :test #'equal))))))

(defmethod last-pulse-tick ((interface interface) task fluent)
  (destructuring-bind (&optional name plan tick)
      (assoc (fluent-name fluent) (interface-pulses interface) :test #'equal)
    (and name (eql plan (task-serial (task-top task))) tick)))

(defun apply-answer (answer interface)
  "Apply ANSWER to fluents, unless ANSWER was already applied. The caller holds the plans."
  (when (take-answer answer interface)
    (let ((action (answer-action answer)) (settings (answer-settings answer)))
      (setf (action-begun-p action) t)
      (record-unread-end interface action (answer-err answer))
      (unless (action-told-p action) (note-pulses interface action settings))
      (with-answer ((action-issue action) (answer-err answer))
        (apply-settings (if (action-told-p action)
                            ;; What the robot is or has.
                            (remove :set settings :key #'first :test-not #'eq)
                            (settings-to-apply settings)))))))

(defun post-answer (interface action err results)
  "In the simulator's thread, post an answer to ACTION (ERR and RESULTS) to plans of INTERFACE,
unless the plans are about to end because their robot is gone."
  (let ((settings '()))
    (in-any-case
      (setf settings (apply (action-outcome action) (action-resource action) err results))
      (let ((answer (make-answer action err settings (final-answer-p (action-command action) err))))
        (unless (interface-closing-p interface)
          (add-answer answer interface)
          (post-entry (interface-runner interface) (lambda () (apply-answer answer interface))))
        (when (answer-last-p answer) (setf (action-over-p action) t))))))

(defun make-action-continuation (interface action)
  (setf (action-continuation action)
        (lambda (err resource &rest results)
          (declare (ignore resource))
          (post-answer interface action err results))))

;;; Interruptions, reported before the simulator does.

(defun report-interrupted (action)
  "Report to plans that ACTION was interrupted, as soon as the task of ACTION has reached its wait."
  (setf (action-told-p action) t)
  (notify-at-rest (action-task action)
                  (lambda ()
                    (with-answer ((action-issue action) :interrupt)
                      (apply-settings (settings-to-apply
                                       (funcall (action-outcome action) (action-resource action)
                                                :interrupt)))))))

(defun apply-answers-on (resource interface except)
  (dolist (answer (interface-answers interface))
    (let ((action (answer-action answer)))
      (when (and (eq resource (action-resource action)) (not (eq action except)))
        (notify-at-rest (action-task action) (lambda () (apply-answer answer interface)))))))

(defun reacting-p (interface)
  (eq *runner* (interface-runner interface)))

(defun task-at-work (interface)
  (let ((task (and (reacting-p interface) (current-task))))
    (and task (eq :running (task-state task)) task)))

(defun interrupt-older-actions (interface resource &key except (test #'interrupted-by-command-p))
  "Report to plans the actions on RESOURCE that the running plan has interrupted: those that pass
TEST, except the action EXCEPT. Do nothing outside of plans."
  (when (reacting-p interface)
    (apply-answers-on resource interface except)
    (dolist (action (interface-actions interface))
      (when (and (eq resource (action-resource action))
                 (not (eq action except))
                 (action-open-p action)
                 (funcall test action))
        (warn-of-clash interface action except)
        (warn-of-hasty-command interface action except)
        (report-interrupted action)
        (count-takeover interface resource (action-task action) (task-at-work interface))))))

;;; Issuing.

(defun call-on-robot (interface function)
  "Call FUNCTION, which does something with the robot of INTERFACE. If FUNCTION signals an error
because the robot is gone, end the plan at work."
  (handler-bind ((error (lambda (condition)
                          (declare (ignore condition))
                          (unless (interface-valid-p interface) (leave-plan)))))
    (funcall function)))

(defun issue-action (interface command resource arguments outcome issue)
  "Issue COMMAND on RESOURCE. OUTCOME returns fluent settings for its end; ISSUE is for the trace."
  (let* ((task (task-at-work interface))
         (cleanup-p (and task (some #'task-cleaning (lineage task)) t))
         (action (make-action command resource outcome task cleanup-p issue
                              (simulation-tick (interface-simulation interface))))
         (issued-p nil))
    (when (and task (not cleanup-p)) (count-command task command outcome resource))
    (add-action action interface)
    (in-any-case
      (progn (call-on-robot interface
                            (lambda ()
                              (apply (command-name command) resource
                                     (append arguments
                                             (list (make-action-continuation interface action))))))
             (setf issued-p t))
      (unless issued-p (forget-action action interface)))
    (interrupt-older-actions interface resource :except action)))

(defun grab (interface resource)
  "Interrupt all commands on RESOURCE, including those that take no time or run in the background."
  (call-on-robot interface
                 (lambda () (grab-resource resource (interface-simulation interface))))
  (interrupt-older-actions interface resource :test (constantly t)))

;;; When a plan ends.

;; Another thread may end the run at any time, and the robot may be in another run by now: then the
;; end of the run has interrupted the command, or will.
(defun interrupt-action (action interface)
  "Interrupt the command of ACTION, unless the run of INTERFACE is over."
  (let ((simulation (interface-simulation interface)))
    (flet ((over-p ()
             (or (simulation-over simulation)
                 (not (eq simulation (robot-simulation (interface-robot interface)))))))
      (unless (over-p)
        (handler-case (withdraw-command (action-resource action) (action-continuation action))
          (misuse (condition) (unless (over-p) (error condition))))))))

;; Commands that were issued to clean up go on.
(defun interrupt-actions (interface task)
  "Interrupt the commands in progress of the top-level TASK, which has failed or evaporated."
  (dolist (action (interface-actions interface))
    (when (and (action-open-p action)
               (action-task action)
               (eq task (task-top (action-task action)))
               (not (action-cleanup-p action))
               (not (command-instant-p (action-command action))))
      (interrupt-action action interface)
      (report-interrupted action))))

;;; Fluents are set by the commands of plans only. The end of a command of the prompt or a program
;;; sets none, so a plan such as (whenever robot-stopped* ...) does not react to it. A wait for one
;;; event is treated in warnings.lisp.

(defun task-watching-end (interface command)
  "Return a top-level task of INTERFACE that watches for the end of robot commands such as COMMAND,
or NIL. This thread holds the plans of INTERFACE."
  (let ((pulse (symbol-value (pulse-of-command command))))
    (find-if (lambda (task)
               (let ((parts (waiting-parts task)))
                 (and (some #'waits-on-purpose-p parts) (member pulse (fluents-awaited parts)))))
             (tasks-of-interface interface))))

(defun warn-of-outside-command (interface command)
  (let ((task (call-with-plans-if-free (lambda () (task-watching-end interface command))
                                       interface)))
    (when task
      (warn-once-in-run
       interface (list :outside (task-label task))
       "~(~A~) has ended. No plan has issued it, so the plan ~A, which waits for ~A, is not woken. ~
        Issue the command in a plan: ~A."
       command (task-label task)
       (fluent-text (symbol-value (pulse-of-command command)))
       (plan-call-text command)))))

(defun note-outside-command (interface)
  (let* ((robot (interface-robot interface))
         (event (resource-event robot))
         (command (and (operation-p event)
                       (not (find robot (interface-actions interface) :key #'action-resource))
                       (command-name (operation-command event))))
         (before (shiftf (interface-outside interface) command)))
    (when (and before (null command) (pulse-of-command before) (tasks-of-interface interface))
      (warn-of-outside-command interface before))))
