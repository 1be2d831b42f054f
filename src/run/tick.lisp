;;;; tick.lisp -- what happens in a tick, in order.

(in-package :ars-magna.run)

(export '(tick))

;;; TICK is the order of a tick. While the world changes, no program runs but users' kickers,
;;; manipulations and events; then come continuations, then observers. So everything else that a
;;; program does happens between ticks, and a journal can repeat it. User code may leave a tick by a
;;; non-local exit such as THROW; the timeline records which phases have begun, and the others are
;;; done first.

(defmacro in-phases ((place) &body phases)
  "Run PHASES, (name form...), in order, but for those that the number in PLACE, which is 0 before
and after, says have been begun."
  `(progn
     ,@(loop for (name . forms) in phases
             collect `(when (< ,place (phase-number ,name))
                        (setf ,place (phase-number ,name))
                        ,@forms))
     (setf ,place 0)))

(declaim (inline begin-changing end-changing))
(defun begin-changing (timeline world)
  "Let this thread change WORLD in a tick of TIMELINE."
  (setf (timeline-ticking-p timeline) t
        (timeline-moments timeline) 0
        (world-writer world) (current-thread))
  (begin-tick-dice (timeline-tick-dice timeline) (world-seed world) (timeline-tick timeline)))

(defun end-changing (timeline world)
  (setf (timeline-ticking-p timeline) nil
        (world-writer world) nil))

(declaim (inline notice-parameters))
(defun notice-parameters (simulation timeline)
  "Look after the parameters of SIMULATION, at least when there is a command that may read them."
  (when (or (timeline-pacing timeline)
            (timeline-inbox timeline)
            (noting-p simulation))
    (follow-settings simulation)))

(defun set-parameter (name value)
  "Give the parameter NAME the VALUE, as somebody did in the current run, which is repeated. Its
journal has that in the same place."
  (setf (parameter-value name) value)
  (follow-settings *simulation*))

(define-operator 'parameter '(name datum) #'set-parameter)

(defun set-cleaning (settings)
  "Let DIRTY-SIMULATION restore SETTINGS, lists (name value), as in the run that is repeated."
  (setf *noise-before-cleaning* (settings-by-symbol settings))
  (follow-settings *simulation*))

(define-operator 'cleaning '(datum) #'set-cleaning)

(defun perform-requests (simulation timeline)
  "Perform the requests made of SIMULATION since the last tick, oldest first."
  (call-each (lambda (request)
               (when (noting-p simulation)
                 (destructuring-bind (operator . arguments) (request-entry request)
                   (note simulation operator arguments request)))
               (perform request timeline))
             (take-requests timeline)))

(defun settled-robot-p (robot)
  "True if a tick has nothing to settle for ROBOT, as WORLD-SETTLED-P says."
  (flet ((unsettled-hand-p (hand)
           (or (hand-location hand) (rest (hand-contents hand)) (grip-watched-p hand))))
    (not (or (plusp (length (robot-designators robot)))
             (robot-ended-tracks robot)
             (some #'camera-location (robot-cameras robot))
             (some #'unsettled-hand-p (robot-hands robot))))))

(defun settle (world)
  "Settle what is inside of what in WORLD, tracks and grips."
  (settle-robots world)
  (tend-tracks world)
  (check-grips world)
  (setf (world-settled-p world) (every #'settled-robot-p (world-robots world))))

(declaim (inline prolong-journal))
(defun prolong-journal (simulation)
  "Let the journal of SIMULATION, if it keeps one that is not full, reach to now."
  (let ((journal (simulation-journal simulation)))
    (when (and journal (not (journal-full-p journal)))
      (setf (journal-end journal) (simulation-tick simulation)))))

(defun tell-observers (simulation)
  (let ((*tick-dice* nil))
    (call-each (lambda (observer) (call-user-code observer "an observer" simulation))
               (simulation-observers simulation))))

(defun let-participants-act (simulation)
  (let ((*tick-dice* nil))
    (flet ((act (participant)
             (call-user-code #'participant-after-tick (participant-origin participant)
                             participant simulation)))
      (declare (dynamic-extent #'act))
      (call-each #'act (simulation-participants simulation)))))

(declaim (inline keep-fork-if-due))
(defun keep-fork-if-due (simulation)
  "Let SIMULATION, whose tick has ended, keep a fork of itself if it is to, and it is time."
  (let ((past (simulation-past simulation)))
    (when past
      ;; What plans have rolled they will roll again.
      (look-at-dice simulation past)
      (when (>= (simulation-tick simulation) (past-next past))
        (keep-fork-in-time simulation past)))))

(defun tick (simulation)
  "Pass one tick of SIMULATION, or what is left of one. To be called by its owner only."
  (declare #.*hot* (type simulation simulation))
  (let ((timeline (simulation-timeline simulation))
        (world (simulation-world simulation)))
    (declare (type timeline timeline) (type world world))
    (let ((*tick-dice* (timeline-tick-dice timeline)))
      (unwind-protect
           (in-phases ((timeline-phase timeline))
             (:requests (when (simulation-past simulation) (note-dice simulation))
                        (begin-changing timeline world)
                        (notice-parameters simulation timeline)
                        (when (timeline-inbox timeline) (perform-requests simulation timeline)))
             (:events (advance-agenda (timeline-agenda timeline)))
             (:kickers (run-kickers world))
             (:settling (unless (world-settled-p world) (settle world)))
             (:continuations (end-changing timeline world)
                             (prolong-journal simulation)
                             (deliver-notifications timeline))
             (:observers (when (simulation-observers simulation) (tell-observers simulation))
                         (when (simulation-past simulation) (note-dice simulation)))
             (:participants (when (simulation-participants simulation)
                              (let-participants-act simulation)))
             (:keeping (keep-fork-if-due simulation)))
        (unless (zerop (timeline-phase timeline)) (tick simulation))))))
