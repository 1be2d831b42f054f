;;;; copies.lisp -- a run copied in its present state, to go on by itself.

(in-package :ars-magna.run)

(defun copy-simulation (simulation)
  "Return a headless copy of SIMULATION, which must stand still, in its present state: from here on
it goes as the original would, given the same requests and parameters, which are those of this
moment. The continuations of commands under way, observers, the journal and plans stay with the
original. Functions are shared: what SCHEDULE was given acts on the things that it has closed over,
also if these are the original's. Signals MISUSE inside a tick."
  (asking (simulation)
    (when (simulation-ticking-p simulation)
      (reject-use "copy-simulation: a tick is under way. Copy the run between ticks."))
    (when (eq simulation *simulation*) (follow-settings simulation))
    (let* ((table (make-copy-table))
           (copy (copy-running simulation table)))
      (setf (timeline-run (simulation-timeline copy)) copy
            (simulation-messages copy) (make-message-queue)
            (simulation-participants copy)
            (loop for participant in (simulation-participants simulation)
                  for twin = (participant-copy participant copy table)
                  when twin collect twin))
      copy)))
