;;;; message-lines.lisp -- MESSAGES and NEXT-MESSAGE: the mailbox of the robot.

(in-package :ars-magna.cli)

;;; A line MESSAGES ON in any session of this process shows arrivals in all of them.

(defvar *show-arrivals-p* nil "When true, each message that a robot receives is shown.")

(defun show-arrivals (robot sender tick)
  "If asked for, queue a message about the newest message, of SENDER, that has arrived at ROBOT."
  (declare (ignore tick))
  (when *show-arrivals-p*
    (let ((message (caar (last (last-arrivals robot (world-tick (robot-world robot))))))
          (*reported-robot* (robot-name robot)))
      (message-set (format nil "heard ~A from ~(~A~)" (safe-text message) sender)))))

(add-listener *message-hooks* show-arrivals)

(defun write-message-entry (entry)
  (destructuring-bind (message sender tick) entry
    (write-trimmed-line "~A from ~(~A~), sent at tick ~D" (safe-text message) sender tick)))

(defun message-entry-for-json (entry)
  (destructuring-bind (message sender tick) entry
    (list :message (safe-text message) :from (string-downcase sender) :sent tick)))

(defun show-message-entries (session robot entries)
  "Print ENTRIES, lists (message sender tick) for ROBOT, or report them if SESSION reports objects."
  (cond ((report-object (session-account session) "messages"
                        :robot (string-downcase (robot-label robot))
                        :messages (map 'vector #'message-entry-for-json entries)))
        (entries (mapc #'write-message-entry entries))
        (t (format t "No message for ~A.~%" robot))))

(define-line "MESSAGES" (session (switch :switch "ON or OFF" :optional))
    (:seeing)
    "List the messages in the robot's mailbox, the oldest first, and leave them there. With ON, show
each message that arrives at a robot of a run; with OFF, do not. In Lisp: (robot-messages ROBOT)."
  (cond (switch (setf *show-arrivals-p* (parse-switch "MESSAGES" switch))
                (format t "Messages that arrive are ~:[not ~;~]shown.~%" *show-arrivals-p*))
        (t (let ((robot (session-robot)))
             (with-time-stopped
               (show-message-entries session robot (robot-messages robot)))))))

(define-line "NEXT-MESSAGE" (session)
    (:seeing)
    "Take the oldest message from the robot's mailbox. In Lisp: (next-message ROBOT)."
  (let ((robot (session-robot)))
    (show-message-entries session robot
                          (multiple-value-bind (message sender tick) (next-message robot)
                            (and sender (list (list message sender tick)))))))
