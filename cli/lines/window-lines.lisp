;;;; window-lines.lisp -- WINDOW and DISPLAY.

(in-package :ars-magna.cli)

(defun robot-at-work-called (name)
  "Return the robot called NAME, of this run or of another that is live. Signals BAD-LINE if there
is none."
  (let* ((name (robot-called name))
         (robot (or (find name (and *simulation* (simulation-robots *simulation*))
                          :key #'robot-name)
                    (find-robot name nil)))
         (simulation (and robot (robot-simulation robot))))
    (if (and simulation
             (not (simulation-over simulation))
             (or (eq simulation *simulation*) (live-p simulation)))
        robot
        (reject-elsewhere name))))

(define-line "WINDOW" (session (name :robot-name "the robot; the one commanded if left out"
                                     :optional))
    (:seeing)
    "Open a window that shows the robot NAME in its world while it runs, and takes commands to it;
one that is open already comes to the front. McCLIM has to be installed; where it is not, this says
how it is. Closing the window changes nothing here. It closes by itself when the run is over."
  (let ((robot (if name (robot-at-work-called name) (session-robot))))
    (ensure-windows)
    (open-display robot)
    (format t "The window of ~A is open.~%" (robot-name robot))))

(define-line "DISPLAY" (session) (:seeing)
    "Show the robot and its world in a window, as WINDOW does."
  (let ((robot (session-robot)))
    (ensure-windows)
    (open-display robot)))
