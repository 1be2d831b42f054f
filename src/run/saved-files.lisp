;;;; saved-files.lisp -- runs saved in files, none of which LOAD-SIMULATION would refuse.

(in-package :ars-magna.run)

;;; A file is loaded before it takes the place of what was there: so saving refuses what loading
;;; would refuse, by the same checks.

(defun check-loadable (path name)
  "Signal MISUSE unless the saved run in the file PATH, that of the run called NAME, can be loaded."
  (handler-case (read-simulation path)
    ((or damaged-simulation unknown-name) (trouble)
      (reject-use "The run in ~(~A~) cannot be saved, since it could not be loaded again: ~A. What ~
                   was there is as before; (simulator ROBOT) starts a run that can be saved."
                  name (reason-of-refusal trouble)))))

(defun write-simulation (simulation file without-p)
  "Write SIMULATION, which stands still, to FILE; if WITHOUT-P, without what no file can hold.
Return the truename of FILE."
  (when (simulation-ticking-p simulation)
    (reject-use "save-simulation: a tick is under way. Save the run between ticks."))
  (check-not-over simulation 'save-simulation)
  (when (eq simulation *simulation*) (follow-settings simulation))
  (note-looked-after (simulation-world simulation))
  (let ((programs (programs-head simulation)))
    (call-with-savable
     (lambda (simulation journal)
       (write-file-anew (lambda (out) (write-saved simulation journal programs out)) file
                        "the run" :kind :run
                        :check (lambda (path)
                                 (check-loadable path (simulation-name simulation)))))
     simulation without-p)))

;; The restart is here, where whoever saves the run can see it: another thread may have the run in
;; its hands.
(defun save-deciding (simulation file)
  "Do what SAVE-SIMULATION says."
  (flet ((save (without-p)
           (asking (simulation) (write-simulation simulation file without-p))))
    (handler-case (save nil)
      (unsavable (condition)
        (restart-case (error condition)
          (save-without ()
            :report "Save the run without them."
            (save t)))))))

(addition save-simulation)
(defun save-simulation (file &optional (simulation (current-simulation)))
  "Write the state of SIMULATION, between two ticks, to FILE, from which LOAD-SIMULATION has it go
on as it would have: world, things, kickers, robots and their parts, designators, tracks, odometers,
commands under way and asked for, parameters, seed and dice, of a headless run also those that its
programs roll by CL:RANDOM; and the journal, so that a replay still repeats all of the run. Who is
told of the ends of commands and tracks, as programs of
continuations are, observers and messages are left out. FILE is replaced when all is written and has
been loaded on trial. Return its truename. Signals UNSAVABLE, with the restart SAVE-WITHOUT, where
plans or events of SCHEDULE are under way or the journal has functions in it; MISUSE if the run is
over or inside a tick, has what has no printed form, such as a kicker of PUT-KICKER's, could not be
loaded again, or cannot be written, as where FILE is something else than a saved run; and
WRONG-ARGUMENT unless FILE is a name. Whatever it signals, FILE is as it was."
  (check-argument save-simulation file (typep file '(or string pathname)) "the name of a file")
  (check-argument save-simulation simulation (simulation-p simulation) "a simulation")
  (check-not-foreign file :run "saved run")
  (save-deciding simulation file))
