;;;; participant.lisp -- the interface of participants of a run, such as a runner of plans.

(in-package :ars-magna.run)

(export '(participant-after-tick participant-after-ticks participant-origin participant-busy-p
          participant-at-work-p participant-reseed participant-digest participant-copy
          participant-end participant-clock-stopped participant-unfinished participant-cut-off
          participant-around-p participant-at-rest check-forkable call-as-participant-makes-way
          participant-place participant-robot))

;;; A participant reacts to a run, by requests only. It may keep an idle run ticking, may have its
;;; own dice, and is told when the run ends. Its requests are in the journal, so a run is repeated
;;; without it. A participant needs a method for PARTICIPANT-AFTER-TICK; the others are optional. If
;;; it is of a kind (DEFINE-KIND), the roles of its slots determine how it is copied and digested.

(defmacro define-participant-function (name lambda-list documentation &body otherwise)
  "Define the generic function NAME for participants. OTHERWISE is the body of its default method."
  `(defgeneric ,name ,lambda-list
     (:documentation ,documentation)
     (:method ,lambda-list
       (declare (ignorable ,@lambda-list))
       ,@otherwise)))

(define-participant-function participant-after-tick (participant simulation)
  "Let PARTICIPANT act after a tick of SIMULATION, in the thread that owns the world."
  (values))

(define-participant-function participant-after-ticks (participant simulation)
  "Let PARTICIPANT act when RUN-TICKS or RUN-UNTIL has passed ticks of the headless SIMULATION."
  (values))

(define-participant-function participant-robot (participant)
  "Return the robot that PARTICIPANT commands, or NIL. In a tick, participants react in the order of
their robots' turns."
  nil)

(define-participant-function participant-origin (participant)
  "Return the name of PARTICIPANT for messages and restarts, in the form that CALL-USER-CODE takes."
  "a participant of the run")

(define-participant-function participant-busy-p (participant simulation)
  "True if PARTICIPANT needs further ticks of SIMULATION, so that SIMULATION is not idle."
  nil)

(define-participant-function participant-at-work-p (participant)
  "True if PARTICIPANT works, has notifications, or waits for a time. Any thread may call this."
  nil)

(define-participant-function participant-reseed (participant seed)
  "Seed all dice of PARTICIPANT with the integer SEED."
  (values))

(define-participant-function participant-digest (participant digest)
  "Add the state of PARTICIPANT to DIGEST."
  (digest-state participant digest))

(define-participant-function participant-copy (participant simulation copier)
  "Return the copy of PARTICIPANT, made by COPIER, for the fork SIMULATION; NIL if it is not needed.
By default, participants defined by DEFINE-KIND are copied. See COPY-PLAN-VALUE."
  (and (kind-of participant) (forked participant copier)))

(define-participant-function participant-place (participant value)
  "Return a text that says where PARTICIPANT refers to VALUE, or NIL."
  nil)

(define-participant-function check-forkable (participant)
  "Signal MISUSE if code of PARTICIPANT calls this function: then its run cannot be forked now."
  (values))

(define-participant-function participant-at-rest (participant function)
  "Call FUNCTION while PARTICIPANT is at rest, and return the value of FUNCTION. Return :BUSY if
PARTICIPANT is working in another thread."
  (funcall function))

(define-participant-function call-as-participant-makes-way (participant function)
  "Call FUNCTION, which waits until PARTICIPANT is at rest, and return the value of FUNCTION.
Meanwhile, PARTICIPANT stops working in another thread as soon as possible."
  (funcall function))

(define-participant-function participant-clock-stopped (participant)
  "Let PARTICIPANT act when the clock of the run has stopped. Any thread may call this function."
  (values))

(define-participant-function participant-end (participant simulation)
  "Let PARTICIPANT act when SIMULATION is over."
  (values))

(define-participant-function participant-unfinished (participant)
  "Return a list of texts about unfinished work of PARTICIPANT, such as \"the plan p\". Unfinished
work cannot be saved to a file."
  '())

(define-participant-function participant-around-p (participant)
  "True if this function is called by code of PARTICIPANT, for example by a step of a plan."
  nil)

(define-participant-function participant-cut-off (participant)
  "Return a list of texts about work of PARTICIPANT that would have ended by itself but is cut off
by the end of the run, such as \"the plan p\"."
  '())
