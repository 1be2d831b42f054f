;;;; clashes.lisp -- tasks that interrupt each other's commands, or issue commands without waiting.

(in-package :ars-magna.rpl-robot)

(addition *plan-command-limit*)

;;; A plan whose command was interrupted may reissue it, and so interrupt the other plan, which does
;;; the same. No time passes. After *MOST-TAKEOVERS* in a tick each further one ends the reaction.

(defparameter *most-takeovers* 100
  "The number of times that plans may take a part of the robot from each other in one tick.")

(defconstant +takeover-warning-ticks+ 5
  "After this many ticks, a second warning names plans that still take a part from each other.
Messages of takeovers may have pushed the first warning out of the queue.")

(defun takeover-entry (driver resource)
  (let ((tick (simulation-tick (driver-simulation driver))))
    (unless (eql tick (driver-takeover-tick driver))
      (setf (driver-takeover-tick driver) tick
            (driver-takeovers driver) '()))
    (or (assoc resource (driver-takeovers driver))
        (first (push (cons resource 0) (driver-takeovers driver))))))

(defun taker-text (task)
  (if task
      (format nil "~{~A~^ > ~} (task ~D)" (task-path task) (task-serial task))
      "somebody outside of plans"))

(defun takeover-text (resource older newer)
  "Return a text that says that the tasks OLDER and NEWER, perhaps the same task, take RESOURCE from
each other for ever. The text does not depend on their order."
  (when (and older newer (> (task-serial older) (task-serial newer)))
    (rotatef older newer))
  (if (eq older newer)
      (format nil "~A takes ~A from itself for ever: each time its command is interrupted, it ~
                   issues another command"
              (taker-text newer) resource)
      (format nil "~A and ~A take ~A from each other for ever: each time the command of a task is ~
                   interrupted, the task issues another"
              (taker-text older) (taker-text newer) resource)))

(defun warn-of-takeovers (driver text)
  "Queue the warning TEXT, unless it was queued within the last +TAKEOVER-WARNING-TICKS+ ticks."
  (let ((tick (simulation-tick (driver-simulation driver)))
        (said (assoc text (driver-warned driver) :test #'string=)))
    (unless (and said (< tick (+ (cdr said) +takeover-warning-ticks+)))
      (setf (driver-warned driver)
            (acons text tick (remove said (driver-warned driver))))
      (queue-notable-warning text ". The takeovers continue in each tick. Let one task at a time "
                             "own the robot's valve: see RPL-ROBOT-VALVE."))))

(defun count-takeover (driver resource older newer)
  "Count that the task NEWER has taken over RESOURCE from the task OLDER. NIL stands for code
outside of plans. After too many takeovers, let time pass."
  (let ((count (takeover-entry driver resource))
        (agent (and newer (task-agent newer)))
        (same-plan-p (and older newer (eq (task-top older) (task-top newer)))))
    ;; Commands of plans that take a part from each other are no endless commands of one plan.
    (unless same-plan-p
      (dolist (task (remove nil (list older newer)))
        (setf (agent-note (task-agent task) 'commands) nil)))
    (when (< *most-takeovers* (incf (cdr count)))
      (warn-of-takeovers driver (takeover-text resource older newer))
      ;; One plan has not waited for the tick; see COMMAND-COUNT-ENTRY.
      (when same-plan-p
        (setf (agent-note agent 'cut-short) (plan-runner-tick (task-runner newer))))
      (exhaust-reaction agent))))

(defun taken-over-too-often-p (driver)
  "True if plans have taken over a part of the robot of DRIVER too often in this tick."
  (and (eql (simulation-tick (driver-simulation driver)) (driver-takeover-tick driver))
       (loop for (nil . count) in (driver-takeovers driver)
               thereis (< *most-takeovers* count))))

(defun must-wait-for-tick-p (interface)
  "True if plans have taken over a part too often in this tick and must wait for the next tick."
  (some #'taken-over-too-often-p (interface-drivers interface)))

;;;; Commands without end

(defparameter *plan-command-limit* 500
  "How many commands a plan may issue to its robot before time passes. A plan that issues more fails
with class :TOO-MANY-COMMANDS. Commands of cleanups do not count.")

(defun command-count-entry (task)
  "Return a cons of TASK, a top-level task, and the number of commands that TASK has issued in this
tick. If takeovers cut short an earlier tick, its commands count, too."
  (let* ((agent (task-agent task)) (tick (plan-runner-tick (task-runner task)))
         (note (agent-note agent 'commands)))
    (unless (and note (member (first note) (list tick (agent-note agent 'cut-short))))
      (setf note (setf (agent-note agent 'commands) (list tick))))
    (setf (first note) tick)
    (or (assoc task (rest note))
        (first (push (cons task 0) (rest note))))))

(defun fluent-form-text (fluent)
  "Return text that shows how plans write FLUENT, a fluent of the robot or of a part."
  (let* ((name (fluent-text fluent)) (space (position #\Space name)))
    (if space
        (format nil "(vref ~A)" name)
        name)))

(defun wait-for-action-text (outcome driver resource)
  "Return the text of a form that waits for the end of a command on RESOURCE, of the robot of
DRIVER. The function OUTCOME returns the settings of fluents at that end. Return NIL if no fluent is
pulsed."
  (let ((pulse (assoc :pulse (outcome-settings outcome driver resource :interrupt))))
    (and pulse (format nil "(wait-for ~A)" (fluent-form-text (second pulse))))))

(defun count-command (task driver command outcome resource)
  "Count that TASK issues COMMAND on RESOURCE, of the robot of DRIVER. Fail if the plan of TASK has
issued more than *PLAN-COMMAND-LIMIT* commands in this tick. OUTCOME is as in
WAIT-FOR-ACTION-TEXT."
  (let ((count (command-count-entry (task-top task))))
    (when (< *plan-command-limit* (incf (cdr count)))
      (fail :class :too-many-commands :limit *plan-command-limit*
            :remedy (format nil "A loop issues rpl-~(~A~) without waiting, and no time passes. Put ~
                                 a wait into it, such as ~:[~;~:*~A or ~](wait-time 1); or, if ~
                                 parts of a plan take the robot from one another, let each own it: ~
                                 (with-valve ((rpl-robot-valve)) ...)"
                            (command-name command)
                            (wait-for-action-text outcome driver resource))))))

;;; The newer command counts (manual 3.1.2), and that is often what a plan is for: a policy, or what
;;; waits for an event, takes the robot on purpose. But branches of a PAR are all to succeed, and
;;; plans that were begun one after the other know nothing of each other.

(defun all-subtasks-must-succeed-p (task)
  (let ((frame (task-frame task)))
    (and frame
         (operator-called-p (node-form (frame-node frame)) "PAR" "PAR-LOOP" "PARTIAL-ORDER"))))

(defun reacting-to-events-p (task whole)
  "True if TASK runs a reaction to an event, as in WHENEVER. Reactions outside of WHOLE, a task
around TASK or NIL, do not count."
  (loop for each in (lineage task)
        until (eq each whole)
        thereis (loop for frame in (frame-chain (task-frame each))
                      thereis (operator-called-p (node-form (frame-node frame))
                                                 "WHENEVER" "AT-LOCATION"))))

(defun waits-on-purpose-p (task)
  "True if TASK waits inside of a LOOP or WHENEVER, so that waiting is its purpose."
  (find-if (lambda (form) (operator-called-p form "LOOP" "WHENEVER"))
           (plan-backtrace task (task-frame task))))

(defun unexpected-interruption-p (older newer)
  "True if the task NEWER has interrupted a command of the task OLDER, most likely by mistake."
  (and older newer
       (not (eq older newer))
       (not (task-over-p older))
       (not (evaporating-p older))
       (<= (task-level newer) (task-level older))
       (let ((common (find-if (lambda (whole) (part-of-p newer whole)) (lineage older))))
         (and (not (member common (list older newer)))
              (or (null common) (all-subtasks-must-succeed-p common))
              (not (reacting-to-events-p newer common))))))

(defun action-text (action)
  "Return the text of ACTION with its task, the named task around that, and the plan."
  (let* ((task (action-task action))
         (parts (butlast (lineage task)))
         (named (find-if #'task-name (rest parts))))
    (format nil "rpl-~(~A~) of ~@[~A in ~]~@[~A in ~]the plan ~A"
            (action-name action)
            (and parts (task-label task))
            (and named (not (task-name task)) (task-label named))
            (task-label (task-top task)))))

(defun harmless-action-p (action)
  "True if ACTION takes no time, stops the robot, or cleans up."
  (or (action-cleanup-p action)
      (command-instant-p (action-command action))
      (trait-p :stops (action-command action))))

(defun warn-of-clash (driver older newer)
  "Warn once if the action NEWER of DRIVER has interrupted OLDER, an action of a parallel task."
  (when (and newer
             (unexpected-interruption-p (action-task older) (action-task newer))
             (not (harmless-action-p newer))
             ;; A task that gives way to a higher priority expects it.
             (notany (lambda (loser) (part-of-p (action-task older) loser))
                     (valve-losers (driver-valve driver))))
    (let ((interrupted (action-text older)) (by (action-text newer)))
      (warn-once-in-run
       (driver-interface driver) (list :clash interrupted by)
       "~A was interrupted by ~A, which runs beside it: ~A carries out one command at a time. ~
        Issue the commands one after the other, or let each task own the robot's valve while it ~
        needs the robot: (with-valve ((rpl-robot-valve)) ...)."
       interrupted by (action-resource older)))))

;;; A task that gives one command after the other has forgotten to wait, or waits for a tick only.

(defun previous-step (task)
  "Return the form before the current form of TASK in the innermost SEQ around this form."
  (dolist (frame (frame-chain (task-frame task)))
    (let ((form (node-form (frame-node frame))))
      (when (operator-called-p form "SEQ")
        (let ((at (current-form (frame-node frame) frame)))
          (return (first (last (ldiff (rest form) (member at form :test #'equal))))))))))

(defun ticks-before-replacement (older newer)
  "Return how many ticks, 0 or 1, OLDER had before NEWER, an action of the same task, cut it short.
Return NIL if that was probably intended, as in a reaction to an event."
  (let ((task (action-task older)) (ticks (- (action-tick newer) (action-tick older))))
    (and task
         (eq task (action-task newer))
         (not (harmless-action-p older))
         (not (harmless-action-p newer))
         (not (reacting-to-events-p task nil))
         (or (= 0 ticks)
             (and (= 1 ticks)
                  ;; One may drive on for a tick, too.
                  (not (trait-p :drives (action-command older)))
                  (operator-called-p (previous-step task) "WAIT-TIME")
                  (not (waits-on-purpose-p task))))
         ticks)))

(defun warn-of-hasty-command (driver older newer)
  "Warn once if action NEWER of DRIVER has cut OLDER short before or just after OLDER began."
  (let ((ticks (and newer (ticks-before-replacement older newer))))
    (when ticks
      (warn-once-in-run
       (driver-interface driver) (list :hurry-in-plan (action-name older) (action-name newer))
       "rpl-~(~A~) of the plan ~A ~:[was cut off after a tick, because rpl-~(~A~) was issued~;does ~
        nothing: rpl-~(~A~) was issued before a tick had passed~], and ~A carries out one command ~
        at a time.~@[ Wait for the end of the first command before the second: ~A.~]"
       (action-name older) (task-label (task-top (action-task older))) (= 0 ticks)
       (action-name newer) (action-resource older)
       (wait-for-action-text (action-outcome older) (action-driver older)
                             (action-resource older))))))
