;;;; state.lisp -- one number for the state of a simulation.

(in-package :ars-magna.run)

(addition state-digest)
(defun state-digest (&optional (simulation (current-simulation)) participants)
  "Return a 64-bit number that stands for the state of SIMULATION to the bit: two runs that have the
same digest at a tick go the same way from there, given the same requests. It covers the world,
robots and parts, what is under way, parameters and dice: all that is said to be state where the
kinds are defined. What has been asked for since the last tick counts from the next one on, and who
is told of the end of a command does not count. What plans are about to do counts if PARTICIPANTS
is true. Functions, such as SCHEDULE is given, count only as such. SIMULATION may be a robot in one.
Signals WRONG-ARGUMENT."
  (let ((simulation (simulation-meant simulation 'state-digest)))
    (asking (simulation)
      (when (eq simulation *simulation*) (follow-settings simulation))
      (let ((digest (make-digest)))
        (digest-state simulation digest)
        (when participants
          (dolist (participant (simulation-participants simulation))
            (participant-digest participant digest)))
        (digest-value digest)))))
