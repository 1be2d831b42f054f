;;;; status-data.lisp -- what STATUS tells other programs.

(in-package :ars-magna.cli)

(defun point-data (x y) (vector x y))

(defun designator-data-of (designator)
  (list :number (designator-number designator)
        :type (designator-type designator)
        :distance (designator-distance designator)
        :angle (designator-angle designator)))

(defun robot-data (robot)
  "Return what STATUS tells of ROBOT, as data."
  (list :tick (now)
        :robot (string-downcase (robot-name robot))
        :world (string-downcase (simulation-name *simulation*))
        :position (multiple-value-call #'point-data (robot-position robot))
        :last-move (multiple-value-call #'point-data (robot-last-move robot))
        :last-move-estimate (multiple-value-call #'point-data (robot-last-move-estimate robot))
        :angle (robot-angle robot)
        :speed (robot-speed robot)
        :turn-angle (robot-turn-angle robot)
        :place (robot-last-place robot)
        :views (map 'vector (lambda (camera) (coerce (glance camera) 'vector))
                    (robot-cameras robot))
        :hands (map 'vector (lambda (hand)
                              (and (hand-holding hand) (princ-to-string (hand-holding hand))))
                    (robot-hands robot))
        :designators (map 'vector #'designator-data-of (live-designators robot))))

(defun report-status (session robot)
  "Report how ROBOT is, whose world stands still, if SESSION reports by objects. True if it does."
  (let ((account (session-account session)))
    (when (reports-p account)
      (apply #'report-object account "status" (robot-data robot)))))
