;;;; run.lisp -- one run: a timeline, a world, and what goes with them.

(in-package :ars-magna.run)

(export '(simulation simulation-over simulation-agenda simulation-inside-tick-p simulation-thread
          latest-successor add-participant remove-participant headless-p end-simulation))

(addition state-digest)

;;; The state of a run is in its timeline and its world, except for the values of parameters.

(addition simulation-p)
(define-kind (simulation :constructor (%make-simulation (timeline world)))
    "A run of a world: its timeline and world, journal, messages, observers and participants."
  (:fixed
   (timeline nil (or null timeline) "the timeline of the simulation" :part :export)
   (world nil (or null world) "the world that the simulation changes" :part :addition))
  (:memory
   ;; State as well, but digested by the method below.
   (known-parameters (parameter-values) simple-vector
                     "the values of the parameters that were recorded last"))
  (:link
   (known-noise *noise-before-cleaning* list
                "the parameter values that DIRTY-SIMULATION would restore, as recorded last")
   (journal nil t "the journal that the simulation keeps, or NIL" :addition)
   (variables '() list "the symbols that the headless simulation binds")
   (environment '() list "the values of the variables, a list (symbol . value): in a fork the
current values, else the values that a thread in the simulation has stored last")
   (dice nil (or null random-state)
         "the random state for CL:RANDOM in the simulation's programs, from a saved run, or NIL")
   (plans-dice-p nil boolean "true if the simulation's plans have their own random state for
CL:RANDOM: the threads of a run that is or was live do not share one" :export)
   (past nil t "the forks and acts that the simulation keeps for rewinding, or NIL" :export)
   (line nil list "a list of one element, the latest successor of the simulation, shared by all runs
that were rewound to it; or NIL if there was no rewinding")
   (shared-warnings nil t "the record of warnings about variables that the simulation shares with
its forks, or NIL; see shared-variables.lisp")
   (output nil (or null stream) "the stream of an editor to which the simulation's threads write, or
NIL")
   (messages *message-queue* message-queue
             "the message queue of the simulation" :export)
   (forked-p nil boolean "true if the simulation was forked, perhaps to look ahead")
   (gate nil (or null function) "a function of the simulation that returns how many ticks may pass
before it is called again" :export)
   (observers '() list "the functions that are called after each tick" :export)
   (trails '() list "the earlier positions of robots, for displays; the list is replaced, never
altered, because forks share it"
           :export)
   (participants '() list "the participants of the simulation, see participant.lisp" :export)))

(defmethod digest-state :after ((simulation simulation) digest)
  (digest-parameters (simulation-known-parameters simulation) digest))

(defmethod timeline-of ((simulation simulation))
  (simulation-timeline simulation))

(addition simulation-name)
(defun simulation-name (simulation)
  "Return the name of SIMULATION, which is the name of its map."
  (timeline-name (simulation-timeline simulation)))

(addition simulation-tick)
(declaim (inline simulation-tick))
(defun simulation-tick (&optional (simulation (current-simulation)))
  "Return the number of passed ticks of SIMULATION; inside a tick, the number of that tick."
  (timeline-tick (simulation-timeline simulation)))

(defmethod print-object ((simulation simulation) stream)
  (print-unreadable-object (simulation stream :type t)
    (format stream "~A at tick ~D" (simulation-name simulation) (simulation-tick simulation))))

(addition simulation-seed)
(defun simulation-seed (simulation)
  "Return the integer that seeds all randomness in SIMULATION."
  (world-seed (simulation-world simulation)))

(addition simulation-rate)
(defun simulation-rate (&optional (simulation (current-simulation)))
  "Return the pace of the live clock of SIMULATION: ticks per second, or :FREE."
  (pace simulation))

(addition simulation-thinking)
(defun simulation-thinking (&optional (simulation (current-simulation)))
  "Return how much time thinking costs in SIMULATION: :FREE, :REAL, :CHARGED or (:CHARGED :BUDGET
steps). See SET-THINKING."
  (timeline-thinking (simulation-timeline simulation)))

(addition simulation-robots)
(declaim (inline simulation-robots))
(defun simulation-robots (&optional (simulation (current-simulation)))
  "Return a list of the robots in SIMULATION."
  (world-robots (simulation-world simulation)))

(defmethod robot-text ((simulation simulation) (name symbol))
  (let ((robots (simulation-robots simulation)))
    (and name
         (rest robots)
         (string-downcase (name-label name (mapcar #'robot-name robots))))))

(declaim (inline simulation-over))
(defun simulation-over (simulation)
  "Return the reason why the run of SIMULATION is over, a string, or NIL if it is not over."
  (timeline-over (simulation-timeline simulation)))

(declaim (inline simulation-thread))
(defun simulation-thread (simulation)
  "Return the thread that passes the ticks of SIMULATION, or NIL if it is headless."
  (timeline-thread (simulation-timeline simulation)))

(declaim (inline simulation-inside-tick-p))
(defun simulation-inside-tick-p (simulation)
  "True inside a tick of SIMULATION, while its world changes."
  (timeline-ticking-p (simulation-timeline simulation)))

(declaim (inline recording-p))
(defun recording-p (simulation)
  "True if requests to SIMULATION are recorded, in a journal or for rewinding."
  (or (simulation-journal simulation) (simulation-past simulation)))

(defun simulation-agenda (simulation)
  "Return the agenda of SIMULATION."
  (timeline-agenda (simulation-timeline simulation)))

;;; Making.

(defun make-simulation (world &optional (prepare (constantly nil)))
  "Return a new simulation of WORLD, which has a timeline. The new simulation replaces an earlier
simulation of WORLD. PREPARE is called with the new simulation before other threads can find it."
  (let* ((timeline (world-timeline world))
         (simulation (%make-simulation timeline world)))
    (funcall prepare simulation)
    (setf (timeline-run timeline) simulation)))

(defun headless-p (simulation)
  "True if SIMULATION is headless: its world is not the resident world of top-level code."
  (let ((world (simulation-world simulation)))
    (not (eq world (map-resident (world-map world))))))

(defun latest-successor (simulation)
  "Return SIMULATION or, if it was rewound, its successor."
  (let ((line (simulation-line simulation)))
    (if line (first line) simulation)))

(defun link-successor (new old)
  "Make NEW the successor of OLD and of the predecessors of OLD. All these runs share one list and
do not refer to each other, so all but the last can be garbage-collected."
  (let ((line (or (simulation-line old) (list old))))
    (setf (first line) new
          (simulation-line old) line
          (simulation-line new) line)))

;;; Each world has one run, made when it is first needed.

(defvar *simulations-lock* (make-lock "simulations"))

(defun resident-message-queue ()
  "Return the resident runs' message queue: *MESSAGE-QUEUE*, in a headless run its global value."
  (if (and *simulation* (headless-p *simulation*))
      (global-value '*message-queue*)
      *message-queue*))

(defun world-simulation (world)
  "Return the simulation of WORLD; if there is none, make a simulation that keeps a journal."
  (let ((timeline (ensure-timeline world)))
    (or (timeline-run timeline)
        (with-lock (*simulations-lock*)
          (or (timeline-run timeline)
              (make-simulation world (lambda (simulation)
                                       (setf (simulation-messages simulation)
                                             (resident-message-queue))
                                       (begin-journal simulation))))))))

(defun resolve-simulation (designator operator)
  "Return the simulation DESIGNATOR, or the simulation of the robot DESIGNATOR. Signals
WRONG-ARGUMENT, which names OPERATOR, for other objects."
  (cond ((simulation-p designator) designator)
        ((robot-p designator) (robot-simulation designator))
        (t (reject-argument operator 'simulation designator
                            "a simulation, or a robot in a simulation"))))

(addition robot-simulation)
(defun robot-simulation (robot)
  "Return the simulation of the world that ROBOT is in."
  (world-simulation (robot-world robot)))

;;; Observers and participants.

(addition add-observer)
(defun add-observer (function &optional (simulation (current-simulation)))
  "Call FUNCTION with SIMULATION after each of its ticks. Return FUNCTION. Signals WRONG-ARGUMENT."
  (check-argument add-observer function (typep function '(or function (and symbol (not null))))
                  "a function with one argument, the simulation")
  (asking (simulation)
    (setf (simulation-observers simulation)
          (append (simulation-observers simulation) (list function))))
  function)

(addition remove-observer)
(defun remove-observer (function &optional (simulation (current-simulation)))
  "Stop calling FUNCTION after the ticks of SIMULATION or, if it was rewound, of its successor."
  (let ((simulation (latest-successor simulation)))
    (asking (simulation)
      (removef (simulation-observers simulation) function)))
  (values))

(defun add-participant (participant simulation)
  "Add PARTICIPANT to SIMULATION. Return PARTICIPANT. Signals MISUSE in code secluded from it."
  (check-not-secluded simulation)
  (asking (simulation)
    (setf (simulation-participants simulation)
          (append (simulation-participants simulation) (list participant))))
  participant)

(defun remove-participant (participant simulation)
  "Remove PARTICIPANT from SIMULATION. Return nothing."
  (asking (simulation)
    (removef (simulation-participants simulation) participant))
  (values))

(defun unfinished-work-texts (simulation)
  "Return a list of texts about unfinished work of the participants of SIMULATION."
  (loop for participant in (simulation-participants simulation)
        append (participant-unfinished participant)))

(addition idle-p)
(defun no-work-left-p (simulation)
  "True if nothing in SIMULATION is in progress or waiting. Kickers and tracks do not count."
  (let ((timeline (simulation-timeline simulation)))
    (and (zerop (agenda-pending (timeline-agenda timeline)))
         (null (timeline-inbox timeline))
         (notany (lambda (participant) (participant-busy-p participant simulation))
                 (simulation-participants simulation)))))

(defun idle-p (&optional (simulation (current-simulation)))
  "True if nothing can happen in SIMULATION until a request is made. In a live simulation at the
rate :FREE, kickers wait for a request, too; otherwise millions of ticks would pass before it."
  (let ((world (simulation-world simulation)))
    (and (or (and (eq :free (pace simulation)) (live-p simulation))
             (not (or (world-has-kickers-p world) (tracks-in-progress-p world))))
         (no-work-left-p simulation))))

;;; Chance.

(addition set-seed)
(defun set-seed (seed &optional (simulation (current-simulation)))
  "Seed all dice of SIMULATION and its plans with the integer SEED. Return SEED. See reading 218."
  (check-argument set-seed seed (integerp seed) "an integer")
  (changing ((simulation-world simulation) set-seed seed)
    (seed-world (simulation-world simulation) seed)
    (dolist (robot (simulation-robots simulation))
      (setf (mind-plan-times (robot-mind robot)) 0))
    (dolist (participant (simulation-participants simulation))
      (participant-reseed participant seed))
    (cond ((member *random-state-variable* (simulation-variables simulation))
           (reseed-random-state seed))
          ((simulation-dice simulation) (reseed-random-state seed (simulation-dice simulation)))))
  seed)

(define-operator 'set-seed '(integer) #'set-seed)

;;; Thinking.

(addition set-thinking)
(defun set-thinking (mode &optional (simulation (current-simulation)))
  "Set the cost of thinking in SIMULATION to MODE, also for thinking in progress (manual 1.2).
Return MODE. The modes and their costs:
  :FREE                      no ticks: plans react after each tick, for as long as they need
  :CHARGED                   the ticks that THINK and WITH-CHARGE say
  (:CHARGED :BUDGET steps)   these ticks, and one tick for every STEPS steps of plans
  :REAL                      no ticks: in a live run, plans have a thread, and ticks go on passing
If a plan calls SET-THINKING, the mode applies from the plan's next reaction on, which is usually in
the next tick. Runs in the modes :FREE and :CHARGED are the same on every machine. In a headless run
:REAL is the same as :FREE. The journal records the mode. Signals WRONG-ARGUMENT."
  (check-thinking-mode 'set-thinking mode)
  (let ((simulation (resolve-simulation simulation 'set-thinking)))
    (changing ((simulation-world simulation) set-thinking mode)
      (set-timeline-thinking (simulation-timeline simulation) mode)))
  mode)

(define-operator 'set-thinking '(datum) #'set-thinking)

;;; The end.

;; A time limit may come at any moment. It must not keep plans from being told of the end.
(defun notify-of-end (simulation)
  "Notify the robots and participants of SIMULATION that the run is over. Interrupts are deferred."
  (in-any-case
    (call-each #'call-run-enders (simulation-robots simulation))
    (call-each (lambda (participant)
                 (participant-end participant simulation))
               (simulation-participants simulation))))

(defun end-simulation (simulation reason)
  "End the run of SIMULATION, for REASON, a sentence without its full stop. Requests to its robots,
in progress or waiting, are interrupted; further requests are refused."
  (let ((timeline (simulation-timeline simulation))
        (robots (robots-in-order (simulation-world simulation))))
    (call-without-clock
     timeline
     (lambda ()
       (unless (timeline-over timeline)
         (let ((*message-queue* (simulation-messages simulation)))
           (deferring-interrupts
             (setf (timeline-over timeline) reason)
             (in-any-case
               (stop-pacing timeline)
               (notify-of-end simulation)
               (progn (call-each (lambda (request) (perform request timeline))
                                 (take-requests timeline))
                      (interrupt-resources timeline (mapcan #'robot-resources robots)))))))))))

;;; The digest.

(defun state-digest (&optional (simulation (current-simulation)) participants)
  "Return a 64-bit number computed from the exact state of SIMULATION. Two runs with the same digest
at a tick continue in the same way, given the same requests. The digest covers the world, robots and
parts, commands in progress, parameters and dice: everything that DEFINE-KIND declares as state.
- Requests made since the last tick count only after the next tick.
- Continuations of commands do not count.
- Plans count if PARTICIPANTS is true.
- Functions, such as the body of an event of SCHEDULE, count, but their code does not.
SIMULATION may be one of its robots. Signals WRONG-ARGUMENT."
  (let ((simulation (resolve-simulation simulation 'state-digest)))
    (asking (simulation)
      (when (eq simulation *simulation*) (record-settings simulation))
      (let ((digest (make-digest)))
        (digest-state simulation digest)
        (when participants
          (dolist (participant (simulation-participants simulation))
            (participant-digest participant digest)))
        (digest-value digest)))))
