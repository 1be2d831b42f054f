;;;; runs-of-worlds.lisp -- the one run that each world has, made when it is first needed.

(in-package :ars-magna.run)

(defvar *simulations-lock* (make-lock "simulations"))

(defun residents-queue ()
  "Return the message queue for the runs of resident worlds: not that of a headless run which may be
the first to need one."
  (if (and *simulation* (headless-p *simulation*))
      (global-value '*message-queue*)
      *message-queue*))

(defun world-simulation (world)
  "Return the simulation of WORLD, made if there is none, with a journal."
  (let ((timeline (ensure-timeline world)))
    (or (timeline-run timeline)
        (with-lock (*simulations-lock*)
          (or (timeline-run timeline)
              (make-simulation world (lambda (simulation)
                                       (setf (simulation-messages simulation) (residents-queue))
                                       (begin-journal simulation))))))))

(defun simulation-meant (designator operator)
  "Return the simulation DESIGNATOR, or that of the robot DESIGNATOR, for OPERATOR. Signals
WRONG-ARGUMENT."
  (cond ((simulation-p designator) designator)
        ((robot-p designator) (robot-simulation designator))
        (t (reject-argument operator 'simulation designator "a simulation, or a robot in one"))))

(addition robot-simulation)
(defun robot-simulation (robot)
  "Return the simulation of the world that ROBOT is in."
  (world-simulation (robot-world robot)))
