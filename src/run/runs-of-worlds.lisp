;;;; runs-of-worlds.lisp -- the one run that each world has, made when it is first needed.

(in-package :ars-magna.run)

(defvar *simulations-lock* (make-lock "simulations"))

(defun ensure-timeline (world)
  "Return the timeline of WORLD, also if it has no robot yet."
  (or (world-timeline world)
      (setf (world-timeline world) (make-timeline (map-name (world-map world))))))

(defun world-simulation (world)
  "Return the simulation of WORLD, made if there is none, with a journal."
  (let ((timeline (ensure-timeline world)))
    (or (timeline-run timeline)
        (with-lock (*simulations-lock*)
          (or (timeline-run timeline)
              (let ((simulation (make-simulation world)))
                (begin-journal simulation)
                simulation))))))

(defun resident-simulation (map)
  "Return the simulation of the resident world of MAP, or of the map so named."
  (world-simulation (map-resident-world (find-map map))))

(addition robot-simulation)
(defun robot-simulation (robot)
  "Return the simulation of the world that ROBOT is in."
  (world-simulation (robot-world robot)))
