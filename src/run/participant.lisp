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

(defmacro define-participation (name lambda-list documentation &body otherwise)
  "Define the generic function NAME, what a participant does or answers; and OTHERWISE, what holds
of one that has no method for it."
  `(defgeneric ,name ,lambda-list
     (:documentation ,documentation)
     (:method ,lambda-list
       (declare (ignorable ,@lambda-list))
       ,@otherwise)))

(define-participation participant-after-tick (participant simulation)
  "Let PARTICIPANT act, after each tick of SIMULATION. Called by the owner."
  (values))

(define-participation participant-after-ticks (participant simulation)
  "Let PARTICIPANT look at SIMULATION, headless, when somebody has let ticks pass."
  (values))

(define-participation participant-origin (participant)
  "Return how messages and restarts call PARTICIPANT, as for CALL-USER-CODE."
  "what takes part in the run")

(define-participation participant-busy-p (participant simulation)
  "True if PARTICIPANT needs the ticks of SIMULATION to go on."
  nil)

(define-participation participant-at-work-p (participant)
  "True if PARTICIPANT is at something, has something to hear, or waits for time.
For any thread."
  nil)

(define-participation participant-reseed (participant seed)
  "Let all chance of PARTICIPANT come from the integer SEED from now on."
  (values))

(define-participation participant-digest (participant digest)
  "Add the state of PARTICIPANT to DIGEST."
  (digest-state participant digest))

(define-participation participant-copy (participant simulation copier)
  "Return what takes the part of PARTICIPANT in SIMULATION, a fork of its run that COPIER makes, or
NIL if it does not go on there. One of a kind does. See COPY-PLAN-VALUE."
  (and (kind-of participant) (forked participant copier)))

(define-participation participant-place (participant value)
  "Return a text that says where PARTICIPANT has VALUE, or NIL if it does not."
  nil)

(define-participation check-forkable (participant)
  "Signal MISUSE if PARTICIPANT does something around this call, so that its run
cannot be forked here."
  (values))

(define-participation participant-at-rest (participant function)
  "Call FUNCTION while PARTICIPANT does nothing, and return its value; or :BUSY if
it does something just now in another thread."
  (funcall function))

(define-participation call-as-participant-makes-way (participant function)
  "Call FUNCTION, which tries until PARTICIPANT is at rest, and return its value.
Meanwhile what PARTICIPANT does in another thread stops as soon as it can."
  (funcall function))

(define-participation participant-clock-stopped (participant)
  "Let PARTICIPANT know that no ticks pass by themselves any more. For any thread."
  (values))

(define-participation participant-end (participant simulation)
  "Let PARTICIPANT know that SIMULATION is over."
  (values))

(define-participation participant-unfinished (participant)
  "Return in words, in a list, what PARTICIPANT has begun and not finished, such as
\"the plan p\". No file can hold it."
  '())

(define-participation participant-around-p (participant)
  "True if PARTICIPANT does something around this call, as a step of a plan."
  nil)

(define-participation participant-cut-off (participant)
  "Return in words, in a list, what PARTICIPANT has begun that the end of the run
cuts off, though it would have ended by itself, such as \"the plan p\"."
  '())
