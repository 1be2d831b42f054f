;;;; participant.lisp -- how something else takes part in a run, such as a runner of plans.

(in-package :ars-magna.run)

(export '(participant-after-tick participant-after-ticks participant-origin participant-busy-p
          participant-at-work-p participant-reseed participant-digest participant-copy
          participant-end participant-clock-stopped participant-unfinished participant-cut-off
          participant-around-p participant-at-rest check-forkable call-as-participant-makes-way
          participant-place))

;;; A participant acts on what happens in a run, by way of requests only. It may keep ticks coming,
;;; has chance of its own, and knows when the run ends. What it asks for is in the journal, so a
;;; run is repeated without it. Of what follows, a participant needs only PARTICIPANT-AFTER-TICK. If
;;; it is of a kind (see DEFINE-KIND), the roles of its slots say what digests and forks make of it.

(defgeneric participant-after-tick (participant simulation)
  (:documentation "Let PARTICIPANT act, after each tick of SIMULATION. Called by the owner.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    (values)))

(defgeneric participant-after-ticks (participant simulation)
  (:documentation "Let PARTICIPANT look at SIMULATION, headless, when somebody has let ticks pass.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    (values)))

(defgeneric participant-origin (participant)
  (:documentation "Return how messages and restarts call PARTICIPANT, as for CALL-USER-CODE.")
  (:method (participant)
    (declare (ignore participant))
    "what takes part in the run"))

(defgeneric participant-busy-p (participant simulation)
  (:documentation "True if PARTICIPANT needs the ticks of SIMULATION to go on.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    nil))

(defgeneric participant-at-work-p (participant)
  (:documentation "True if PARTICIPANT is at something, has something to hear, or waits for time.
For any thread.")
  (:method (participant)
    (declare (ignore participant))
    nil))

(defgeneric participant-reseed (participant seed)
  (:documentation "Let all chance of PARTICIPANT come from the integer SEED from now on.")
  (:method (participant seed)
    (declare (ignore participant seed))
    (values)))

(defgeneric participant-digest (participant digest)
  (:documentation "Add the state of PARTICIPANT to DIGEST.")
  (:method (participant digest)
    (digest-state participant digest)))

(defgeneric participant-copy (participant simulation copier)
  (:documentation
   "Return what takes the part of PARTICIPANT in SIMULATION, a fork of its run that COPIER makes, or
NIL if it does not go on there. One of a kind does. See COPY-PLAN-VALUE.")
  (:method (participant simulation copier)
    (declare (ignore simulation))
    (and (kind-of participant) (forked participant copier))))

(defgeneric participant-place (participant value)
  (:documentation "Return a text that says where PARTICIPANT has VALUE, or NIL if it does not.")
  (:method (participant value)
    (declare (ignore participant value))
    nil))

(defgeneric check-forkable (participant)
  (:documentation "Signal MISUSE if PARTICIPANT does something around this call, so that its run
cannot be forked here.")
  (:method (participant) (declare (ignore participant)) (values)))

(defgeneric participant-at-rest (participant function)
  (:documentation "Call FUNCTION while PARTICIPANT does nothing, and return its value; or :BUSY if
it does something just now in another thread.")
  (:method (participant function)
    (declare (ignore participant))
    (funcall function)))

(defgeneric call-as-participant-makes-way (participant function)
  (:documentation "Call FUNCTION, which tries until PARTICIPANT is at rest, and return its value.
Meanwhile what PARTICIPANT does in another thread stops as soon as it can.")
  (:method (participant function)
    (declare (ignore participant))
    (funcall function)))

(defgeneric participant-clock-stopped (participant)
  (:documentation "Let PARTICIPANT know that no ticks pass by themselves any more. For any thread.")
  (:method (participant)
    (declare (ignore participant))
    (values)))

(defgeneric participant-end (participant simulation)
  (:documentation "Let PARTICIPANT know that SIMULATION is over.")
  (:method (participant simulation)
    (declare (ignore participant simulation))
    (values)))

(defgeneric participant-unfinished (participant)
  (:documentation "Return in words, in a list, what PARTICIPANT has begun and not finished, such as
\"the plan p\". No file can hold it.")
  (:method (participant)
    (declare (ignore participant))
    '()))

(defgeneric participant-around-p (participant)
  (:documentation "True if PARTICIPANT does something around this call, as a step of a plan.")
  (:method (participant)
    (declare (ignore participant))
    nil))

(defgeneric participant-cut-off (participant)
  (:documentation "Return in words, in a list, what PARTICIPANT has begun that the end of the run
cuts off, though it would have ended by itself, such as \"the plan p\".")
  (:method (participant)
    (declare (ignore participant))
    '()))
