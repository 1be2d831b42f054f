;;;; opening.lisp -- how a robot gets a window, or its user a line about why it has none.

(in-package :ars-magna.display)

(defvar *display-opener* nil
  "A function of a robot that opens its display in a window, or NIL if nothing that can is loaded.")

(defun no-display-text ()
  "Return what to do to get a display, or why there can be none."
  (if *display-opener*
      "open one with (open-display ROBOT), where an X server is to be had"
      (concatenate 'string "for a window load the system ars-magna/clim, which needs McCLIM; "
                   "or use (save-picture ROBOT \"world.svg\")")))

(defun open-display (robot)
  "Show ROBOT and its world in a window that follows what happens there (manual B). Return ROBOT.
Signals MISUSE where no window is to be had: see ars-magna/clim."
  (check-argument open-display robot (robot-p robot) "a robot")
  (unless *display-opener* (reject-use "No display: ~A." (no-display-text)))
  (funcall *display-opener* robot)
  robot)

(defun announce-display (robot options)
  "When SIMULATOR has started ROBOT, open its display, or say in a line that there is none and how
to get one. The option :DISPLAY NIL of SIMULATOR leaves both out."
  (when (getf options :display t)
    (handler-case (open-display robot)
      (misuse (condition)
        (out (robot-name robot) " runs without a display. "
             (substitute #\Space #\Newline (princ-to-string condition)) t)))))

(pushnew 'announce-display *simulator-hooks*)
