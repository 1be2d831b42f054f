;;;; messages.lisp -- messages to and from the robot of plans.

(in-package :ars-magna.rpl-robot)

(export '(waits-for-message-p))

(define-fluents robot
  (robot-sent* "Pulsed when the robot has sent a message, or was interrupted." :addition)
  (robot-radio-error* "The error code of the last ROBOT-SEND to end; NIL after success." :addition)
  (robot-heard* "Pulsed when a message has arrived in the robot's mailbox." :addition))

(define-outcome (robot-send) ()
  (:error robot-radio-error*)
  (:pulse robot-sent*))

(addition rpl-next-message)
(defun rpl-next-message ()
  "Take the oldest message from the mailbox of the plans' robot. Return the message, the name of its
sender and the tick in which it was sent; or NIL if the mailbox is empty. See NEXT-MESSAGE. To wait
for a message: (if (null (rpl-messages)) (wait-for robot-heard*)). Signals MISUSE
without a robot."
  (next-message (rpl-robot)))

(addition rpl-messages)
(defun rpl-messages ()
  "Return a list of the messages in the mailbox of the plans' robot, which keeps them: lists
(message sender tick), the oldest first. Signals MISUSE without a robot."
  (robot-messages (rpl-robot)))

;;; Pulses of ROBOT-HEARD* in a trace have the message as their cause.

(define-record (sent-message (:constructor make-sent-message (sender tick)))
  "A message that has arrived. The robot SENDER sent it in TICK."
  (sender nil symbol "the name of the robot that sent a message")
  (tick 0 fixnum "the tick in which a message was sent"))
(define-shared-types sent-message)

(defmethod asker-note ((message sent-message))
  (format nil "a message of ~(~A~), sent at tick ~D"
          (sent-message-sender message) (sent-message-tick message)))

(defun sent-by-p (entry message)
  "True if ENTRY of a trace is the command that sent MESSAGE. A robot sends only one in a tick."
  (let ((issue (trace-entry-subject entry)))
    (and (eq :command (trace-entry-event entry))
         (eq 'rpl-robot-send (issue-name issue))
         (eq (sent-message-sender message) (issue-robot issue))
         (eql (sent-message-tick message) (issue-end-tick issue)))))

(defmethod asker-description ((message sent-message) trace)
  (let ((entry (find-if (lambda (entry) (sent-by-p entry message)) trace :from-end t)))
    (format nil "~A~@[ by ~A~]" (asker-note message)
            (and entry (issue-description (trace-entry-subject entry) trace)))))

;;; The simulator calls this in its own thread, inside the tick in which the message arrives.

(defun note-arrival (robot sender tick)
  "A message that SENDER sent in TICK has arrived at ROBOT. Pulse ROBOT-HEARD* in its plans, if it
has any."
  (let* ((interface (interface-of-simulation (robot-simulation robot)))
         (driver (and interface (find-driver robot interface))))
    (when (and driver (not (driver-closing-p driver)))
      (let ((*asker* (make-sent-message sender tick)))
        (post-entry (driver-runner driver)
                    `((:pulse ,(driver-fluent 'robot-heard* driver)))
                    (driver-agent driver))))))

(add-listener *message-hooks* note-arrival)

;;; Advice for plans that wait for messages in vain.

(defun plan-start-text (task)
  "Return the text of a form that begins the plan of TASK, or of the function's name."
  (let ((name (task-name (task-top task))))
    (if name
        (format nil "(begin-plan '~A~@[ :robot ~A~])" (task-label (task-top task))
                (owner-text (driver-of-plan task)))
        "BEGIN-PLAN")))

(defun remedy-for-no-message (tasks client awaited)
  "Return a text on how to get messages sent to TASKS of CLIENT's run. Return NIL if RUN-PLAN waits
for other plans only, so that advice on TASKS is of no use. AWAITED is as for ADVICE-ON-EVENT."
  (let* ((run-plans (interface-awaited (driver-interface client)))
         (task (find-if (lambda (task) (member (task-top task) (cons awaited run-plans))) tasks)))
    (cond ((null (rest (simulation-robots (driver-simulation client))))
           "The run has no other robot that could send one.")
          (task
           (format nil "First start what sends messages; or begin this plan by ~A, which does not ~
                        wait for its end, and send messages afterwards."
                   (plan-start-text task)))
          ((null run-plans)
           "To wake the plan, send a message by ROBOT-SEND, or begin a plan that sends one."))))

(defun mailbox-advice (driver)
  (let* ((robot (driver-robot driver)) (count (length (robot-messages robot))))
    (and (plusp count)
         (format nil "The mailbox of ~(~A~) already has ~D message~:P. Look into it before you ~
                      wait: (if (null (rpl-messages)) (wait-for robot-heard*))."
                 (robot-label robot) count))))

;; A program may send one at any time, so only what waits for the end of the plan is stuck.
(defun waits-for-message-p (task)
  "True if TASK waits for a message, its robot has none, and another robot of the run could send
one."
  (let ((interface (driver-interface (driver-of-plan task))))
    (and (rest (simulation-robots (interface-simulation interface)))
         (some (lambda (fluent)
                 (let ((driver (driver-of-fluent fluent interface)))
                   (and driver
                        (eq fluent (driver-fluent 'robot-heard* driver))
                        (null (robot-messages (driver-robot driver))))))
               (fluents-awaited (list task))))))

(defmethod advice-on-event ((client driver) fluent tasks awaited)
  (let ((driver (driver-of-fluent fluent (driver-interface client))))
    (and driver
         (eq fluent (driver-fluent 'robot-heard* driver))
         (list (format nil "robot-heard* is pulsed when a message arrives at the robot. No message ~
                            is on its way, and no plan or command in progress can send one.")
               (or (mailbox-advice driver)
                   (remedy-for-no-message tasks client awaited))))))
