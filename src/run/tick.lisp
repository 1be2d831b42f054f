;;;; tick.lisp -- what happens in a tick, in order.

(in-package :ars-magna.run)

(export '(tick))

;;; The function TICK lists the phases of a tick in order. While the world changes, the only users'
;;; code that runs is kickers, manipulations and events; then come continuations, then observers.
;;; Everything else that a program does happens between ticks, so a journal can repeat it. User code
;;; may leave a tick by a non-local exit such as THROW. The timeline records which phases have
;;; begun, and the others are run first.

(defmacro run-phases ((place) &body phases)
  "Run PHASES, lists (name form...), in order. PLACE holds the number of the last phase that has
begun; skip the phases up to this number. PLACE is 0 before the first phase and after the last."
  `(progn
     ,@(loop for (name . forms) in phases
             collect `(when (< ,place (phase-number ,name))
                        (setf ,place (phase-number ,name))
                        ,@forms))
     (setf ,place 0)))

(declaim (inline begin-world-changes end-world-changes))
(defun begin-world-changes (timeline world)
  "Allow this thread to change WORLD in a tick of TIMELINE."
  (setf (timeline-ticking-p timeline) t
        (timeline-moments timeline) 0
        (world-writer world) (current-thread))
  (when (world-dice-names world)
    (setf (agenda-salt (timeline-agenda timeline))
          (turn-salt world (1+ (timeline-tick timeline)))))
  (begin-tick-dice (timeline-tick-dice timeline) (world-seed world) (timeline-tick timeline)))

(defun end-world-changes (timeline world)
  (setf (timeline-ticking-p timeline) nil
        (world-writer world) nil))

(declaim (inline record-changed-parameters))
(defun record-changed-parameters (simulation timeline)
  "Check and record the parameters of SIMULATION if a command may read them in this tick, or if
SIMULATION keeps a journal or forks."
  (when (or (timeline-pacing timeline)
            (timeline-inbox timeline)
            (recording-p simulation))
    (record-settings simulation)))

(defun set-parameter (name value)
  "Set the parameter NAME to VALUE. A replay calls this function for a journal entry; the change is
recorded at the same point of the new journal."
  (setf (parameter-value name) value)
  (record-settings *simulation*))

(define-operator 'parameter '(name datum) #'set-parameter)

(defun set-noise-to-restore (settings)
  "Make DIRTY-SIMULATION restore SETTINGS, lists (name value), for a replayed journal entry."
  (setf *noise-before-cleaning* (settings-with-symbols settings))
  (record-settings *simulation*))

(define-operator 'cleaning '(datum) #'set-noise-to-restore)

(defun perform-requests (simulation timeline)
  "Perform the requests to SIMULATION that were made since the last tick, the oldest first."
  (call-each (lambda (request)
               (when (recording-p simulation)
                 (destructuring-bind (operator . arguments) (request-journal-entry request)
                   (record-operation simulation operator arguments request)))
               (perform request timeline))
             (take-requests timeline)))

(defun settling-skippable-p (robot)
  "True if the phase :SETTLING of a tick can be skipped for ROBOT, see WORLD-SETTLED-P."
  (flet ((unsettled-hand-p (hand)
           (or (hand-location hand) (rest (hand-contents hand)) (grip-watched-p hand))))
    (not (or (plusp (length (robot-designators robot)))
             (robot-ended-tracks robot)
             (some #'camera-location (robot-cameras robot))
             (some #'unsettled-hand-p (robot-hands robot))))))

(defun update-tracks-and-grips (world)
  "Update the records of parts inside things in WORLD, and the tracks and grips."
  (enforce-containment world)
  (update-tracks world)
  (end-lost-grips world)
  (setf (world-settled-p world) (every #'settling-skippable-p (world-robots world))))

(declaim (inline extend-journal))
(defun extend-journal (simulation)
  (let ((journal (simulation-journal simulation)))
    (when (and journal (not (journal-full-p journal)))
      (setf (journal-end journal) (simulation-tick simulation)))))

(defun call-observers (simulation)
  (let ((*tick-dice* nil))
    (call-each (lambda (observer) (call-user-code observer "an observer" simulation))
               (simulation-observers simulation))))

(defun participants-in-order (simulation)
  "Return the participants of SIMULATION in the order in which they react to this tick: the turns of
their robots if there are several robots, else the order in which they joined."
  (let ((participants (simulation-participants simulation))
        (salt (agenda-salt (simulation-agenda simulation))))
    (if (and salt (rest participants))
        (sorted-by-turn participants #'participant-robot salt)
        participants)))

(defun let-participants-act (simulation)
  (let ((*tick-dice* nil))
    (flet ((act (participant)
             (call-user-code #'participant-after-tick (participant-origin participant)
                             participant simulation)))
      (declare (dynamic-extent #'act))
      (call-each #'act (participants-in-order simulation)))))

(declaim (inline keep-fork-if-due))
(defun keep-fork-if-due (simulation)
  (let ((past (simulation-past simulation)))
    (when past
      ;; Forks repeat what plans have rolled, so this is not recorded.
      (update-rolled-dice simulation past)
      (when (>= (simulation-tick simulation) (past-next past))
        (keep-fork-if-affordable simulation past)))))

(defun tick (simulation)
  "Pass one tick of SIMULATION, or the rest of a tick that a non-local exit has interrupted. The
thread that owns the world calls this function."
  (declare #.*hot* (type simulation simulation))
  (let ((timeline (simulation-timeline simulation))
        (world (simulation-world simulation)))
    (declare (type timeline timeline) (type world world))
    (let ((*tick-dice* (timeline-tick-dice timeline)))
      (unwind-protect
           (run-phases ((timeline-phase timeline))
             (:requests (when (simulation-past simulation) (record-dice simulation))
                        (begin-world-changes timeline world)
                        (record-changed-parameters simulation timeline)
                        (when (timeline-inbox timeline) (perform-requests simulation timeline)))
             (:events (advance-agenda (timeline-agenda timeline)))
             (:kickers (run-kickers world))
             (:settling (unless (world-settled-p world) (update-tracks-and-grips world)))
             (:continuations (end-world-changes timeline world)
                             (extend-journal simulation)
                             (deliver-notifications timeline))
             (:observers (when (simulation-observers simulation) (call-observers simulation))
                         (when (simulation-past simulation) (record-dice simulation)))
             (:participants (when (simulation-participants simulation)
                              (let-participants-act simulation)))
             (:keeping (keep-fork-if-due simulation)))
        (unless (zerop (timeline-phase timeline)) (tick simulation))))))
