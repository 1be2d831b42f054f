;;;; participant.lisp -- how something else takes part in a run, such as a runner of plans.

(in-package :ars-magna.run)

;;; A participant acts on what happens in a run, by way of requests only. It may keep ticks coming,
;;; has chance of its own, and knows when the run ends. What it asks for is in the journal, so a
;;; run is repeated without it.

(defgeneric participant-after-tick (participant simulation)
  (:documentation "Let PARTICIPANT act, after each tick of SIMULATION. Called by the owner.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    (values)))

(defgeneric participant-busy-p (participant simulation)
  (:documentation "True if PARTICIPANT needs the ticks of SIMULATION to go on.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    nil))

(defgeneric participant-reseed (participant seed)
  (:documentation "Let all chance of PARTICIPANT come from the integer SEED from now on.")
  (:method (participant seed)
    (declare (ignore participant seed))
    (values)))

(defgeneric participant-digest (participant digest)
  (:documentation "Add the state of PARTICIPANT to DIGEST.")
  (:method (participant digest)
    (declare (ignore participant digest))
    (values)))

(defgeneric participant-copy (participant simulation table)
  (:documentation
   "Return what takes the part of PARTICIPANT in SIMULATION, a copy of its run, or NIL if it does
not go on there. TABLE has what was copied; see COPY-RUNNING.")
  (:method (participant simulation table)
    (declare (ignore participant simulation table))
    nil))

(defgeneric participant-end (participant simulation)
  (:documentation "Let PARTICIPANT know that SIMULATION is over.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    (values)))
