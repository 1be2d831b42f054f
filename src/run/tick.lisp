;;;; tick.lisp -- what happens in a tick, in order.

(in-package :ars-magna.run)

;;; TICK is the order of a tick. While the world changes, no program runs but users' kickers,
;;; manipulations and events; continuations come after that, and then whoever looks on. So
;;; whatever else a program does happens between ticks, and a journal can repeat it. Users' code
;;; may leave a tick, as by THROW; the timeline knows which phases have begun, and the others follow
;;; first.

(defmacro in-phases ((place) &body forms)
  "Run FORMS in order, but for those that the number in PLACE, which is 0 before and after, says
have been begun."
  `(progn
     ,@(loop for form in forms
             for number from 1
             collect `(when (< ,place ,number)
                        (setf ,place ,number)
                        ,form))
     (setf ,place 0)))

(declaim (inline begin-changing end-changing))
(defun begin-changing (timeline world)
  "Let this thread change WORLD in a tick of TIMELINE."
  (setf (timeline-ticking-p timeline) t
        (world-writer world) (current-thread)))

(defun end-changing (timeline world)
  (setf (timeline-ticking-p timeline) nil
        (world-writer world) nil))

(declaim (inline notice-parameters))
(defun notice-parameters (simulation timeline)
  "Look after the parameters of SIMULATION, at least when there is a command that may read them."
  (when (or (timeline-pacing timeline)
            (timeline-inbox timeline)
            (simulation-journal simulation))
    (follow-settings simulation)))

(defun set-parameter (name value)
  "Give the parameter NAME the VALUE, as somebody did in a run that is repeated."
  (setf (parameter-value name) value))

(define-operator 'parameter '(name datum) #'set-parameter)

(defun note-request (simulation request)
  (destructuring-bind (operator . arguments) (request-entry request)
    (note simulation operator arguments)))

(defun perform-all (simulation timeline)
  (call-each (lambda (request)
               (when (simulation-journal simulation) (note-request simulation request))
               (perform request timeline))
             (take-requests timeline)))

(declaim (inline perform-requests run-due-events prolong-journal tell-observers
                 let-participants-act))
(defun perform-requests (simulation timeline)
  "Perform what has been asked of SIMULATION since the last tick, in the order of asking."
  (when (timeline-inbox timeline) (perform-all simulation timeline)))

(defun run-due-events (timeline)
  "Let the tick begin that TIMELINE is to pass, and run what is due in it."
  (advance-agenda (timeline-agenda timeline)))

(defun prolong-journal (simulation)
  "Let the journal of SIMULATION, if it keeps one that is not full, reach to now."
  (let ((journal (simulation-journal simulation)))
    (when (and journal (not (journal-full-p journal)))
      (setf (journal-end journal) (simulation-tick simulation)))))

(defun tell-all-observers (simulation)
  (call-each (lambda (observer) (call-user-code observer "an observer" simulation))
             (simulation-observers simulation)))

(defun tell-observers (simulation)
  (when (simulation-observers simulation) (tell-all-observers simulation)))

(defun let-all-participants-act (simulation)
  (call-each (lambda (participant)
               (call-user-code #'participant-after-tick "a participant" participant simulation))
             (simulation-participants simulation)))

(defun let-participants-act (simulation)
  (when (simulation-participants simulation) (let-all-participants-act simulation)))

(defun tick (simulation)
  "Pass one tick of SIMULATION, or what is left of one. To be called by its owner only."
  (declare #.*hot* (type simulation simulation))
  (let ((timeline (simulation-timeline simulation))
        (world (simulation-world simulation)))
    (declare (type timeline timeline) (type world world))
    (in-any-case
      (in-phases ((timeline-phase timeline))
        (progn (begin-changing timeline world)
               (notice-parameters simulation timeline)
               (perform-requests simulation timeline))
        (run-due-events timeline)
        (run-kickers world)
        (progn (settle-robots world)
               (tend-tracks world)
               (check-grips world))
        (progn (end-changing timeline world)
               (prolong-journal simulation)
               (deliver-notifications timeline))
        (tell-observers simulation)
        (let-participants-act simulation))
      (unless (zerop (timeline-phase timeline)) (tick simulation)))))
