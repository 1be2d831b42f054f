;;;; run.lisp -- one run: a timeline, a world, and what goes with them.

(in-package :ars-magna.run)

(export '(simulation simulation-over simulation-agenda simulation-ticking-p simulation-thread
          latest add-participant remove-participant headless-p end-simulation))

(addition state-digest)

;;; A run has no state of its own but the values of the parameters as it knows them: the rest is its
;;; timeline's and its world's.

(addition simulation-p)
(define-kind (simulation :constructor (%make-simulation (timeline world)))
    "One run: a timeline, a world, and what goes with them."
  (:fixed
   (timeline nil (or null timeline) "the timeline of the simulation" :part :export)
   (world nil (or null world) "the world that the simulation changes" :part :addition))
  (:memory
   ;; It decides the future, but is digested in a way of its own, below.
   (known-parameters (parameter-values) simple-vector
                     "the values of the parameters as the journal knows them"))
  (:link
   (known-noise *noise-before-cleaning* list
                "what DIRTY-SIMULATION would restore, as the journal knows it")
   (journal nil t "the journal that the simulation keeps, or NIL" :addition)
   (variables '() list "the symbols that are bound for the headless simulation")
   (environment '() list "what they are in a fork, a list (symbol . value), or else what they were
when a thread at work in the simulation last said so")
   (dice nil (or null random-state)
         "what its programs roll by CL:RANDOM, if it comes from a file that says that, or NIL")
   (plans-dice-p nil boolean "its plans roll dice of their own by CL:RANDOM: a run that is or was
live has no dice that all its threads roll" :export)
   (past nil t "what is kept of the past, or NIL" :export)
   (line nil list "the simulation that goes on, in a list that all share of which one was rewound
to the next, or NIL if there was no rewinding")
   (output nil (or null stream) "where its threads write, if an editor wants that, or NIL")
   (messages *message-queue* message-queue
             "the message queue that the simulation reports to" :export)
   (forked-p nil boolean "somebody has forked it, perhaps to look at what would come")
   (gate nil (or null function) "a function of the simulation that says how many ticks may pass
before it is asked again" :export)
   (observers '() list "the functions that are called after each tick" :export)
   (trails '() list "what displays keep of where robots were; replaced, never altered, as forks
share it" :export)
   (participants '() list "what takes part in the simulation, see participant.lisp" :export)))

(defmethod digest-state :after ((simulation simulation) digest)
  (digest-parameters (simulation-known-parameters simulation) digest))

(defmethod timeline-of ((simulation simulation))
  (simulation-timeline simulation))

(addition simulation-name)
(defun simulation-name (simulation)
  "Return what SIMULATION is called, the name of its map."
  (timeline-name (simulation-timeline simulation)))

(addition simulation-tick)
(declaim (inline simulation-tick))
(defun simulation-tick (&optional (simulation (current-simulation)))
  "Return how many ticks of SIMULATION have passed; inside a tick, its number."
  (timeline-tick (simulation-timeline simulation)))

(defmethod print-object ((simulation simulation) stream)
  (print-unreadable-object (simulation stream :type t)
    (format stream "~A at tick ~D" (simulation-name simulation) (simulation-tick simulation))))

(addition simulation-seed)
(defun simulation-seed (simulation)
  "Return the integer from which all chance in SIMULATION comes."
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

(declaim (inline simulation-over))
(defun simulation-over (simulation)
  "Return why the run of SIMULATION is over, a string, or NIL as long as it is not."
  (timeline-over (simulation-timeline simulation)))

(declaim (inline simulation-thread))
(defun simulation-thread (simulation)
  "Return the thread that passes the ticks of SIMULATION, or NIL if it is headless."
  (timeline-thread (simulation-timeline simulation)))

(declaim (inline simulation-ticking-p))
(defun simulation-ticking-p (simulation)
  "True inside a tick of SIMULATION, while its world changes."
  (timeline-ticking-p (simulation-timeline simulation)))

(declaim (inline noting-p))
(defun noting-p (simulation)
  "True if somebody wants to know what is done to SIMULATION."
  (or (simulation-journal simulation) (simulation-past simulation)))

(defun simulation-agenda (simulation)
  "Return the agenda of SIMULATION."
  (timeline-agenda (simulation-timeline simulation)))

;;; Making.

(defun make-simulation (world &optional (prepare (constantly nil)))
  "Return a new simulation of WORLD, which has a timeline, instead of any that it had before. No
other thread can find it before PREPARE, a function, has been called with it."
  (let* ((timeline (world-timeline world))
         (simulation (%make-simulation timeline world)))
    (funcall prepare simulation)
    (setf (timeline-run timeline) simulation)))

(defun headless-p (simulation)
  "True if SIMULATION is one of WITH-SIMULATION: not of the world that top-level code works in."
  (let ((world (simulation-world simulation)))
    (not (eq world (map-resident (world-map world))))))

(defun latest (simulation)
  "Return SIMULATION or, if it was rewound, the one that goes on instead."
  (let ((line (simulation-line simulation)))
    (if line (first line) simulation)))

(defun succeed-in-line (new old)
  "Let NEW be what goes on in the place of OLD, and of what that went on in the place of. None of
these leads to the next, so that all but the last can be forgotten."
  (let ((line (or (simulation-line old) (list old))))
    (setf (first line) new
          (simulation-line old) line
          (simulation-line new) line)))

;;; The one run that each world has, made when it is first needed.

(defvar *simulations-lock* (make-lock "simulations"))

(defun residents-queue ()
  "Return the message queue for the runs of resident worlds: not that of a headless run which may be
the first to need one."
  (if (and *simulation* (headless-p *simulation*))
      (global-value '*message-queue*)
      *message-queue*))

(defun world-simulation (world)
  "Return the simulation of WORLD, made if there is none, with a journal."
  (let ((timeline (ensure-timeline world)))
    (or (timeline-run timeline)
        (with-lock (*simulations-lock*)
          (or (timeline-run timeline)
              (make-simulation world (lambda (simulation)
                                       (setf (simulation-messages simulation) (residents-queue))
                                       (begin-journal simulation))))))))

(defun simulation-meant (designator operator)
  "Return the simulation DESIGNATOR, or that of the robot DESIGNATOR, for OPERATOR. Signals
WRONG-ARGUMENT."
  (cond ((simulation-p designator) designator)
        ((robot-p designator) (robot-simulation designator))
        (t (reject-argument operator 'simulation designator "a simulation, or a robot in one"))))

(addition robot-simulation)
(defun robot-simulation (robot)
  "Return the simulation of the world that ROBOT is in."
  (world-simulation (robot-world robot)))

;;; Who looks on, and who takes part.

(addition add-observer)
(defun add-observer (function &optional (simulation (current-simulation)))
  "Call FUNCTION with SIMULATION after each of its ticks. Return FUNCTION. Signals WRONG-ARGUMENT."
  (check-argument add-observer function (typep function '(or function (and symbol (not null))))
                  "a function of a simulation")
  (asking (simulation)
    (setf (simulation-observers simulation)
          (append (simulation-observers simulation) (list function))))
  function)

(addition remove-observer)
(defun remove-observer (function &optional (simulation (current-simulation)))
  "Stop calling FUNCTION after the ticks of SIMULATION, also if it has been rewound since."
  (let ((simulation (latest simulation)))
    (asking (simulation)
      (removef (simulation-observers simulation) function)))
  (values))

(defun add-participant (participant simulation)
  "Let PARTICIPANT take part in SIMULATION from now on."
  (asking (simulation)
    (setf (simulation-participants simulation)
          (append (simulation-participants simulation) (list participant))))
  participant)

(defun remove-participant (participant simulation)
  "Let PARTICIPANT take part in SIMULATION no more."
  (asking (simulation)
    (removef (simulation-participants simulation) participant))
  (values))

(defun unfinished-in-participants (simulation)
  "Return in words, in a list, what those who take part in SIMULATION have begun and not finished."
  (loop for participant in (simulation-participants simulation)
        append (participant-unfinished participant)))

(addition idle-p)
(defun settled-p (simulation)
  "True if SIMULATION has nothing in progress or waiting to begin that ends. Kickers and tracks
continue as long as the run does."
  (let ((timeline (simulation-timeline simulation)))
    (and (zerop (agenda-pending (timeline-agenda timeline)))
         (null (timeline-inbox timeline))
         (notany (lambda (participant) (participant-busy-p participant simulation))
                 (simulation-participants simulation)))))

(defun idle-p (&optional (simulation (current-simulation)))
  "True if nothing can happen in SIMULATION until somebody asks for something. In a live one at the
rate :FREE, things with kickers wait for that, too: else a million ticks, which nobody wants, would
be over before anybody could ask."
  (let ((world (simulation-world simulation)))
    (and (or (and (eq :free (pace simulation)) (live-p simulation))
             (not (or (world-has-kickers-p world) (tracks-busy-p world))))
         (settled-p simulation))))

;;; Chance.

(addition set-seed)
(defun set-seed (seed &optional (simulation (current-simulation)))
  "Make all chance in SIMULATION, that of plans too, depend on the integer SEED from now on. Return
SEED. See reading 218."
  (check-argument set-seed seed (integerp seed) "an integer")
  (changing ((simulation-world simulation) set-seed seed)
    (seed-world (simulation-world simulation) seed)
    (dolist (participant (simulation-participants simulation))
      (participant-reseed participant seed))
    (cond ((member *lisps-dice* (simulation-variables simulation)) (reseed-lisps-dice seed))
          ((simulation-dice simulation) (reseed-lisps-dice seed (simulation-dice simulation)))))
  seed)

(define-operator 'set-seed '(integer) #'set-seed)

;;; Thinking.

(addition set-thinking)
(defun set-thinking (mode &optional (simulation (current-simulation)))
  "Set the cost of thinking in SIMULATION from now on, also of thinking in progress, to MODE (manual
1.2), and return it:
  :FREE                      no ticks: plans react after each tick, as long as it takes them
  :CHARGED                   the ticks that THINK and WITH-CHARGE say
  (:CHARGED :BUDGET steps)   these, and a tick for each STEPS of plans: the rest waits
  :REAL                      no ticks: where a clock runs, plans have a thread and the clock goes on
If a plan calls it, the mode applies from its next reaction on, mostly in the next tick. Free and
charged runs are the same on every machine. Without a clock :REAL is the same as :FREE. The journal
records it. Signals WRONG-ARGUMENT."
  (check-thinking 'set-thinking mode)
  (let ((simulation (simulation-meant simulation 'set-thinking)))
    (changing ((simulation-world simulation) set-thinking mode)
      (set-timeline-thinking (simulation-timeline simulation) mode)))
  mode)

(define-operator 'set-thinking '(datum) #'set-thinking)

;;; The end.

;; A time limit may come at any moment: that must not keep plans from hearing of the end.
(defun tell-of-end (simulation)
  "Let the robots and participants of SIMULATION, which is over, know that. Interrupts wait."
  (in-any-case
    (call-each #'close-robot (simulation-robots simulation))
    (call-each (lambda (participant)
                 (participant-end participant simulation))
               (simulation-participants simulation))))

(defun end-simulation (simulation reason)
  "End the run of SIMULATION for good, for REASON, a sentence without its full stop. All requests to
its robots, begun or not, are interrupted; further ones are refused."
  (let ((timeline (simulation-timeline simulation))
        (robots (simulation-robots simulation)))
    (call-alone
     timeline
     (lambda ()
       (unless (timeline-over timeline)
         (let ((*message-queue* (simulation-messages simulation)))
           (deferring-interrupts
             (setf (timeline-over timeline) reason)
             (in-any-case
               (stop-pacing timeline)
               (tell-of-end simulation)
               (progn (call-each (lambda (request) (perform request timeline))
                                 (take-requests timeline))
                      (abandon timeline (mapcan #'robot-resources robots)))))))))))

;;; One number for its state.

(defun state-digest (&optional (simulation (current-simulation)) participants)
  "Return a 64-bit number computed from the exact state of SIMULATION. Two runs with the same digest
at a tick go the same way from there, given the same requests. It covers the world, robots and
parts, commands in progress, parameters and dice: all that the definitions of kinds declare as
state.
- Requests since the last tick count from the next one on.
- Continuations of commands do not count.
- Plans count if PARTICIPANTS is true.
- Functions, such as those given to SCHEDULE, count only as such, not by what they do.
SIMULATION may be one of its robots. Signals WRONG-ARGUMENT."
  (let ((simulation (simulation-meant simulation 'state-digest)))
    (asking (simulation)
      (when (eq simulation *simulation*) (follow-settings simulation))
      (let ((digest (make-digest)))
        (digest-state simulation digest)
        (when participants
          (dolist (participant (simulation-participants simulation))
            (participant-digest participant digest)))
        (digest-value digest)))))
