;;;; takeovers.lisp -- plans that keep taking the robot from each other are named and slowed down.

(in-package :ars-magna.rpl-robot)

;;; A plan that hears that its command was interrupted may issue it again, and so interrupt who did
;;; that, who then does the same. No time passes meanwhile. After *MOST-TAKEOVERS* in a tick
;;; each further one ends the reaction.

(defparameter *most-takeovers* 100
  "How often plans may take one part of the robot from each other before time has to pass.")

(defconstant +takeover-warning-ticks+ 5
  "After how many ticks plans that go on so are named again. Meanwhile each takeover may be a
message, and the queue of these forgets the oldest.")

(defun takeover-count (interface resource)
  (let ((tick (simulation-tick (interface-simulation interface))))
    (unless (eql tick (interface-takeover-tick interface))
      (setf (interface-takeover-tick interface) tick
            (interface-takeovers interface) '()))
    (or (assoc resource (interface-takeovers interface))
        (first (push (cons resource 0) (interface-takeovers interface))))))

(defun taker-text (task)
  (if task
      (format nil "~{~A~^ > ~} (task ~D)" (task-path task) (task-serial task))
      "somebody outside of plans"))

(defun takeover-text (resource older newer)
  "Return in words that the tasks OLDER and NEWER, perhaps the same, take RESOURCE over for ever,
the same words whichever of them it is that takes it."
  (when (and older newer (> (task-serial older) (task-serial newer)))
    (rotatef older newer))
  (if (eq older newer)
      (format nil "~A takes ~A from itself for ever: each time it hears that its command was ~
                   interrupted it issues another"
              (taker-text newer) resource)
      (format nil "~A and ~A take ~A from each other for ever: each time one hears that its ~
                   command was interrupted it issues another"
              (taker-text older) (taker-text newer) resource)))

(defun warn-of-takeovers (interface text)
  "Queue the warning TEXT, unless that was done just before."
  (let ((tick (simulation-tick (interface-simulation interface)))
        (said (assoc text (interface-warned interface) :test #'string=)))
    (unless (and said (< tick (+ (cdr said) +takeover-warning-ticks+)))
      (setf (interface-warned interface)
            (acons text tick (remove said (interface-warned interface))))
      (warn-notably text ". They go on with the ticks. Let one at a time have it: see "
                   "RPL-ROBOT-VALVE."))))

(defun cut-short (runner older newer)
  "Let time pass for RUNNER. Note it if the tasks OLDER and NEWER are of one plan, which has not
waited for that; see rushing.lisp."
  (when (and older newer (eq (task-top older) (task-top newer)))
    (setf (runner-note runner 'cut-short) (plan-runner-tick runner)))
  (exhaust-reaction runner))

(defun count-takeover (interface resource older newer)
  "Note that the task NEWER has taken over RESOURCE from OLDER (NIL: no task), and let time pass if
that was too often."
  (let ((count (takeover-count interface resource)))
    (unless (and older newer (eq (task-top older) (task-top newer)))
      ;; Plans that take a part from one another make way in the end: that is no rush of one.
      (setf (runner-note (interface-runner interface) 'commands) nil))
    (when (< *most-takeovers* (incf (cdr count)))
      (warn-of-takeovers interface (takeover-text resource older newer))
      (cut-short (interface-runner interface) older newer))))

(defun waits-for-tick-p (interface)
  "True if plans have taken a part from each other so often in this tick that another is to come."
  (and (eql (simulation-tick (interface-simulation interface)) (interface-takeover-tick interface))
       (loop for (nil . count) in (interface-takeovers interface)
               thereis (< *most-takeovers* count))))
