;;;; agents.lisp -- what a plan runner keeps for each robot: ready tasks, steps they may take.

(in-package :ars-magna.rpl.tasks)

(export '(agent agent-p make-agent))

;;; A plan runner has an agent for each robot that has plans. Each task belongs to an agent, and so
;;; do its parts. The agents of a runner take turns; see reacting.lisp. Each has its own budget of
;;; steps, and can be stopped by itself.
;;;
;;; Ready tasks queue first-in first-out by level; the highest level runs first. Bit n of MASK is
;;; set while tasks of level n may be queued. The bit +INTERRUPT-BIT+, above all of these, is set
;;; when the running task must check its own signal.

(defconstant +levels+ 8 "The number of levels of tasks: the level of the plan, and those of nested
policies.")
(defconstant +interrupt-bit+ (ash 1 +levels+))

(defconstant +slice+ 10000
  "The number of steps that a task may take before other tasks and posted changes get their turn.
The slice is a tenth of the steps of a reaction if that is less.")

(define-record (charges (:conc-name agent-) (:constructor nil))
  "What the thinking of an agent's tasks costs; see charging.lisp."
  (charged-p nil boolean "thinking with a stated cost takes ticks in the agent's
tasks" :writable :export)
  (budget nil (or null (integer 1)) "the number of steps that the agent's tasks may take in a
reaction or, if CHARGED-P, in a tick; NIL for no limit" :writable :export)
  (allotted nil (or null real) :writable)
  (debt 0 (integer 0) :writable)
  (still-until nil (or null real) :writable)
  (unpaid 0 (rational 0 (1)) "the fraction of a tick that thoughts have yet to be charged; 0 if the
agent runs plans for a robot, which keeps it" :writable)
  (uncounted 0 (integer 0) :writable)
  (uncovered 0 integer "the number of counted steps minus STEPS" :writable))

(define-record (agent (:include charges)
                      (:constructor make-agent (&key client dice budget charged-p)
                       "Return a new agent for CLIENT, whose tasks roll DICE. BUDGET and CHARGED-P
are as in SET-CHARGES. ADD-AGENT adds the agent to a plan runner."))
  "What a plan runner keeps for one robot: ready tasks, and the steps they may take."
  (runner nil (or null home) "the plan runner of the agent, or NIL" :writable :export)
  (client nil t "the object for which the agent runs plans, such as a robot's driver" :export)
  ;; The ready tasks.
  (rings (coerce (loop repeat +levels+ collect (make-ring)) 'simple-vector) (simple-vector 8))
  (mask 0 fixnum :writable)
  (held '() list "the ready tasks that were put aside because they are blocked" :writable)
  (spent '() list
         "the ready tasks that have used their slice in this round, the newest first" :writable)
  (blocks 0 fixnum "the number of blocks of the agent's tasks" :writable :export)
  ;; The steps they may take.
  (steps 0 (unsigned-byte 62) "the number of steps that the agent's tasks have taken. A step begins
or ends an expression" :writable :export)
  (pause 0 (unsigned-byte 62) "the number of steps at which the running task must pause" :writable)
  (limit 0 (unsigned-byte 62) "the number of steps at which the reaction must end" :writable)
  (slice +slice+ fixnum :writable)
  (round 0 fixnum :writable)
  (exhausted nil boolean :writable)
  (broken-off-p nil boolean :writable)
  (batch-applied-at 0 (unsigned-byte 62) :writable)
  (dice nil (or null dice)
        "the dice for random choices of the agent's tasks, or NIL" :writable :export)
  (lisps-dice nil (or null random-state) "the random state for CL:RANDOM in plans of the agent; NIL
for the state of all programs" :writable :export)
  (notes '() list "a property list of the data that constructs keep for all tasks" :writable))
(declaim-final agent)

(defmethod print-object ((agent agent) stream)
  (print-unreadable-object (agent stream :type t)
    (format stream "of ~A, ~D step~:P" (form-text (agent-client agent) 40) (agent-steps agent))))

(defmethod copy-plan-value ((agent agent) fork)
  (if (and (agent-runner agent) (home-forked-p (agent-runner agent) fork))
      (copy-slots agent fork)
      agent))
