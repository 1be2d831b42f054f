;;;; messages.lisp -- messages to and from the robot of plans.

(in-package :ars-magna.rpl-robot)

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

;;; The simulator calls this in its own thread, inside the tick in which the message arrives.

(defun note-arrival (robot)
  "A message has arrived at ROBOT. Pulse ROBOT-HEARD* in its plans, if it has any."
  (let* ((interface (interface-of-simulation (robot-simulation robot)))
         (driver (and interface (find-driver robot interface))))
    (when (and driver (not (driver-closing-p driver)))
      (post-entry (driver-runner driver)
                  `((:pulse ,(driver-fluent 'robot-heard* driver)))
                  (driver-agent driver)))))

(add-listener *message-hooks* note-arrival)
