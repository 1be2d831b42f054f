;;;; game-picture.lisp -- a picture of a game of a testbed.

(in-package :ars-magna.experiment)

(defun claimed-agent (testbed)
  "Return the agent that the first claim of TESTBED is about, or else its last agent."
  (let ((claim (first (testbed-claims testbed))))
    (if claim
        (first (ensure-list (second (first (claim-relations claim)))))
        (first (first (last (testbed-agents testbed)))))))

(addition save-game-picture)
(defun save-game-picture (name file &key agent (trial 1) until)
  "Save a picture of a game of the testbed NAME in FILE, with the score so far: TRIAL, a number, of
AGENT, at the tick UNTIL, or in the middle of the game. AGENT is as for RUN-TESTBED, by default the
one that the first claim is about. The picture is the same on each machine. Return the truename of
FILE. Signals UNKNOWN-NAME, and the errors of SAVE-PICTURE."
  (let* ((testbed (find-testbed name))
         (agent (resolve-agent testbed (or agent (claimed-agent testbed))))
         (experiment (testbed-experiment testbed (list agent)))
         (until (or until (floor (getf (replay-trial experiment 1 trial) :ticks) 2)))
         (saved nil))
    (picture-kind 'save-game-picture file)
    (replay-trial experiment 1 trial
                  :until until
                  :then (lambda ()
                          (setf saved (save-picture
                                       (first (simulation-robots (current-simulation))) file
                                       :title (format nil "~(~A~), ~(~A~), trial ~D, tick ~D"
                                                      (testbed-name testbed) agent trial
                                                      (simulation-tick (current-simulation)))
                                       :measures (list (testbed-score testbed))))))
    saved))
