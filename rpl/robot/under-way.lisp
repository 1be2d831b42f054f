;;;; under-way.lisp -- commands of plans in progress, and how plans learn of their ends.

(in-package :ars-magna.rpl-robot)

;;; A command that a plan has issued is an ACTION until its last answer has been applied.

(defstruct (action (:constructor make-action
                       (driver command resource outcome task cleanup-p issue tick))
                   (:copier nil))
  "A record that COMMAND, issued by a plan, is in progress on RESOURCE, of the robot of DRIVER. TASK
issued the command at TICK; TASK is NIL for calls from outside of plans. CLEANUP-P is true if the
command is part of a cleanup. OUTCOME returns the settings of fluents for an answer."
  (driver nil :type (or null driver) :read-only t)
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

(defun add-action (action driver)
  (with-lock ((driver-actions-lock driver))
    (setf (driver-actions driver) (append (driver-actions driver) (list action))))
  action)

(defun forget-action (action driver)
  (with-lock ((driver-actions-lock driver))
    (removef (driver-actions driver) action)))

(defvar *answered-driver* nil
  "The driver of the robot whose fluents an outcome sets, while the outcome is computed.")

(defun outcome-settings (outcome driver resource err &rest results)
  "Return the settings of fluents of DRIVER when a command with OUTCOME ends."
  (let ((*answered-driver* driver))
    (apply outcome resource err results)))

(defun action-settings (action err &rest results)
  "Return the settings of fluents when ACTION ends with the error code ERR and RESULTS."
  (apply #'outcome-settings (action-outcome action) (action-driver action)
         (action-resource action) err results))

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

(defun add-answer (answer driver)
  (with-lock ((driver-actions-lock driver))
    (setf (driver-answers driver) (append (driver-answers driver) (list answer)))))

(defun take-answer (answer driver)
  "Remove ANSWER from the answers not yet applied. If ANSWER is the last of its action, remove the
action, too. Return true if ANSWER was not yet applied."
  (with-lock ((driver-actions-lock driver))
    (when (member answer (driver-answers driver))
      (removef (driver-answers driver) answer)
      (when (answer-last-p answer) (removef (driver-actions driver) (answer-action answer)))
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

(defun note-pulses (driver action settings)
  "Record which fluents are pulsed in this tick by SETTINGS at the end of ACTION of DRIVER."
  (when (action-task action)
    (loop with plan = (task-serial (task-top (action-task action)))
          for (kind fluent) in settings
          for name = (and (eq :pulse kind) (fluent-name fluent))
          when name
            do (setf (driver-pulses driver)
                     (cons (list name plan (simulation-tick (driver-simulation driver)))
                           (remove name (driver-pulses driver)
                                   :key #'first :test #'equal))))))

(defun driver-of-fluent (fluent interface)
  "Return the driver in INTERFACE to whose robot FLUENT belongs, or NIL."
  (find-if (lambda (driver)
             (loop for (nil . value) in (driver-fluents driver)
                     thereis (if (vectorp value) (find fluent value) (eq fluent value))))
           (interface-drivers interface)))

(defmethod last-pulse-tick ((driver driver) task fluent)
  (let ((driver (driver-of-fluent fluent (driver-interface driver))))
    (destructuring-bind (&optional name plan tick)
        (and driver (assoc (fluent-name fluent) (driver-pulses driver) :test #'equal))
      (and name (eql plan (task-serial (task-top task))) tick))))

(defun apply-answer (answer driver)
  "Apply ANSWER to fluents, unless ANSWER was already applied. The caller holds the plans."
  (when (take-answer answer driver)
    (let ((action (answer-action answer)) (settings (answer-settings answer)))
      (setf (action-begun-p action) t)
      (record-unread-end driver action (answer-err answer))
      (unless (action-told-p action) (note-pulses driver action settings))
      (with-answer ((action-issue action) (answer-err answer))
        (apply-settings (if (action-told-p action)
                            ;; What the robot is or has.
                            (remove :set settings :key #'first :test-not #'eq)
                            (settings-to-apply settings)))))))

(defun note-end-in-trace (action err)
  (let ((issue (action-issue action)))
    (when (and issue (null err))
      (setf (issue-end-tick issue) (simulation-tick (driver-simulation (action-driver action)))))))

(defun post-answer (driver action err results)
  "In the simulator's thread, post an answer to ACTION (ERR and RESULTS) to plans of DRIVER,
unless the plans are about to end because their robot is gone."
  (let ((settings '()))
    (in-any-case
      (setf settings (apply #'action-settings action err results))
      (let ((answer (make-answer action err settings (final-answer-p (action-command action) err))))
        (unless (driver-closing-p driver)
          (add-answer answer driver)
          (post-entry (driver-runner driver) (lambda () (apply-answer answer driver))
                      (driver-agent driver)))
        (when (answer-last-p answer)
          (note-end-in-trace action err)
          (setf (action-over-p action) t))))))

(defun make-action-continuation (driver action)
  (setf (action-continuation action)
        (lambda (err resource &rest results)
          (declare (ignore resource))
          (post-answer driver action err results))))

;;; Interruptions, reported before the simulator does.

(defun report-interrupted (action)
  "Report to plans that ACTION was interrupted, as soon as the task of ACTION has reached its wait."
  (setf (action-told-p action) t)
  (notify-at-rest (action-task action)
                  (lambda ()
                    (with-answer ((action-issue action) :interrupt)
                      (apply-settings (settings-to-apply
                                       (action-settings action :interrupt)))))))

(defun apply-answers-on (resource driver except)
  (dolist (answer (driver-answers driver))
    (let ((action (answer-action answer)))
      (when (and (eq resource (action-resource action)) (not (eq action except)))
        (notify-at-rest (action-task action) (lambda () (apply-answer answer driver)))))))

(defun reacting-p (driver)
  (eq *runner* (driver-runner driver)))

(defun task-at-work (driver)
  (let ((task (and (reacting-p driver) (current-task))))
    (and task (eq :running (task-state task)) task)))

(defun interrupt-older-actions (driver resource &key except (test #'interrupted-by-command-p))
  "Report to plans the actions on RESOURCE that the running plan has interrupted: those that pass
TEST, except the action EXCEPT. Do nothing outside of plans."
  (when (reacting-p driver)
    (apply-answers-on resource driver except)
    (dolist (action (driver-actions driver))
      (when (and (eq resource (action-resource action))
                 (not (eq action except))
                 (action-open-p action)
                 (funcall test action))
        (warn-of-clash driver action except)
        (warn-of-hasty-command driver action except)
        (report-interrupted action)
        (count-takeover driver resource (action-task action) (task-at-work driver))))))

;;; Issuing.

(defun call-on-robot (driver function)
  "Call FUNCTION, which does something with the robot of DRIVER. If FUNCTION signals an error
because the robot is gone, end the plan at work."
  (handler-bind ((error (lambda (condition)
                          (declare (ignore condition))
                          (unless (driver-valid-p driver) (leave-plan)))))
    (funcall function)))

(defun issue-action (driver command resource arguments outcome issue)
  "Issue COMMAND on RESOURCE. OUTCOME returns fluent settings for its end; ISSUE is for the trace."
  (let* ((task (task-at-work driver))
         (occupied (occupied-resource command resource))
         (cleanup-p (and task (some #'task-cleaning (lineage task)) t))
         (action (make-action driver command occupied outcome task cleanup-p issue
                              (simulation-tick (driver-simulation driver))))
         (issued-p nil))
    (when (and task (not cleanup-p)) (count-command task driver command outcome resource))
    (add-action action driver)
    (in-any-case
      (progn (call-on-robot driver
                            (lambda ()
                              (apply (command-name command) resource
                                     (append arguments
                                             (list (make-action-continuation driver action))))))
             (setf issued-p t))
      (unless issued-p (forget-action action driver)))
    (interrupt-older-actions driver occupied :except action)))

(defun grab (driver resource)
  "Interrupt all commands on RESOURCE, including those that take no time or run in the background."
  (call-on-robot driver
                 (lambda () (grab-resource resource (driver-simulation driver))))
  (interrupt-older-actions driver resource :test (constantly t)))

;;; When a plan ends.

;; Another thread may end the run at any time, and the robot may be in another run by now: then the
;; end of the run has interrupted the command, or will.
(defun interrupt-action (action driver)
  "Interrupt the command of ACTION, unless the run of DRIVER is over."
  (let ((simulation (driver-simulation driver)))
    (flet ((over-p ()
             (or (simulation-over simulation)
                 (not (eq simulation (robot-simulation (driver-robot driver)))))))
      (unless (over-p)
        (handler-case (withdraw-command (action-resource action) (action-continuation action))
          (misuse (condition) (unless (over-p) (error condition))))))))

;; Commands that were issued to clean up go on.
(defun interrupt-actions-on (driver task)
  "Interrupt the commands in progress on the robot of DRIVER that the top-level TASK has issued."
  (dolist (action (driver-actions driver))
    (when (and (action-open-p action)
               (action-task action)
               (eq task (task-top (action-task action)))
               (not (action-cleanup-p action))
               (not (command-instant-p (action-command action))))
      (interrupt-action action driver)
      (report-interrupted action))))

(defun interrupt-actions-of-others (driver)
  "Interrupt the commands in progress on the robot of DRIVER, whose fluents are to be replaced, that
plans of other robots have issued."
  (with-owned-home ((driver-runner driver))
    (dolist (action (driver-actions driver))
      (when (and (action-open-p action)
                 (action-task action)
                 (not (eq driver (driver-of-plan (action-task action))))
                 (not (command-instant-p (action-command action))))
        (interrupt-action action driver)
        (report-interrupted action)))))

(defun interrupt-actions (interface task)
  "Interrupt the commands in progress of the top-level TASK, which has failed or evaporated."
  (dolist (driver (interface-drivers interface)) (interrupt-actions-on driver task)))

;;; Fluents are set by the commands of plans only. The end of a command of the prompt or a program
;;; sets none, so a plan such as (whenever robot-stopped* ...) does not react to it. A wait for one
;;; event is treated in warnings.lisp.

(defun task-watching-end (driver command)
  "Return a top-level task that watches for the end of commands such as COMMAND to the robot of
DRIVER, or NIL. This thread holds the plans."
  (let ((pulse (driver-fluent (pulse-of-command command) driver)))
    (find-if (lambda (task)
               (let ((parts (waiting-parts task)))
                 (and (some #'waits-on-purpose-p parts) (member pulse (fluents-awaited parts)))))
             (tasks-of-interface (driver-interface driver)))))

(defun warn-of-outside-command (driver command)
  (let ((task (call-with-plans-if-free (lambda () (task-watching-end driver command))
                                       (driver-interface driver))))
    (when task
      (warn-once-in-run
       (driver-interface driver) (list :outside (task-label task))
       "~(~A~) has ended. No plan has issued it, so the plan ~A, which waits for ~A, is not woken. ~
        Issue the command in a plan: ~A."
       command (task-label task)
       (fluent-text (driver-fluent (pulse-of-command command) driver))
       (plan-call-text command)))))

(defun note-outside-command (driver)
  (let* ((robot (driver-robot driver))
         (event (resource-event robot))
         (command (and (operation-p event)
                       (not (find robot (driver-actions driver) :key #'action-resource))
                       (command-name (operation-command event))))
         (before (shiftf (driver-outside driver) command)))
    (when (and before
               (null command)
               (pulse-of-command before)
               (tasks-of-interface (driver-interface driver)))
      (warn-of-outside-command driver before))))
