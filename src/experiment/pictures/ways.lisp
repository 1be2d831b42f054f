;;;; ways.lisp -- where robots went in trials, from running these again.

(in-package :ars-magna.experiment)

(defun ways-of-trial (experiment condition trial)
  "Run TRIAL of CONDITION of EXPERIMENT again. Return a list of the ways of its robots."
  (let ((trails '()) (watched-p nil))
    (flet ((look (simulation)
             (setf trails (note-places simulation trails))))
      (let ((result (run-trial experiment condition trial
                               :gate (lambda (simulation)
                                       (unless watched-p
                                         (setf watched-p t)
                                         (look simulation)
                                         (add-observer #'look simulation))
                                       +largest+))))
        (ways-along trails trial (result-outcome result))))))

(defun ways-of-trials (experiment condition trials)
  "Run the TRIALS, a list of numbers, of CONDITION of EXPERIMENT again. Return the ways of all."
  (prepare-trials experiment condition)
  (call-in-silence (lambda ()
                     (loop for trial in trials
                           append (ways-of-trial experiment condition trial)))))

(defun start-of-trial (experiment condition trial)
  "Return a snapshot of the world in which TRIAL begins."
  (call-in-silence (lambda ()
                     (call-in-trial (lambda ()
                                      (take-snapshot (simulation-world (current-simulation))))
                                    experiment condition trial))))
