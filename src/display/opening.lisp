;;;; opening.lisp -- how a robot gets a window, or its user a line about why it has none.

(in-package :ars-magna.display)

(export '(*display-opener* *displays-waiter* announce-display))

(defvar *display-opener* nil
  "A function of a robot that opens its display in a window, or NIL if nothing that can is loaded.")

(defvar *displays-waiter* nil
  "A function that waits until all windows are closed, or NIL if nothing that opens any is loaded.")

(addition open-display)
(defun open-display (robot)
  "Show ROBOT and its world in a window that follows what happens there (manual B). A robot has one
window: if it is open, it comes to the front, and shows ROBOT where this is, be it in a fork or
trial. Return ROBOT.
Signals MISUSE where no window is to be had: see ars-magna/clim."
  (check-argument open-display robot (robot-p robot) "a robot")
  (unless *display-opener*
    (reject-use "No display: it needs McCLIM, and the system ars-magna/clim to be loaded. The line ~
                 WINDOW at the prompt does that. See also PICTURE and MAP."))
  (funcall *display-opener* robot)
  robot)

(defvar *told-reasons* '()
  "Why no display could be opened, texts, as far as the user has been told.")

(defun announce-display (robot options)
  "When SIMULATOR has started ROBOT, open its display, or say in a line, once, that there is none
and how to get one. The option :DISPLAY NIL of SIMULATOR leaves both out."
  (when (getf options :display t)
    (handler-case (open-display robot)
      (error (condition)
        (let ((text (format nil "Note: the run goes on without a window. ~A"
                            (one-line (text-of-condition condition)))))
          (unless (member text *told-reasons* :test #'string=)
            (push text *told-reasons*)
            (out text t)))))))

(attend *simulator-hooks* announce-display)
(pushnew 'display *hook-options*)
